"""The result comes first: then three notes on a terminal, and all of them on the page and in the record."""

import html
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import warpwear
from warpwear import Study
from warpwear.cli.main import commands
from warpwear.runs import doubts
from warpwear.runs.console import Progress

#: A study with more than three things to be said of it, one of which takes all trust.
MANY = {
    "grid.cell": "20 um",
    "sliding.distance": "3 mm",
    "contact.load": "1 N",
    "contact.boundary": "free",
    "wear.decay": "0.1 1/mm",
    "output.snapshots": ["10 mm"],
    "disc.hardness": "200 HV",
}


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "many.toml"
    path.write_text(Study.load("v3-fine").replace(MANY).to_toml(), encoding="utf-8")
    return path


def test_a_terminal_ends_in_ten_lines(study: Path, tmp_path: Path, quick_pictures: Any) -> None:
    """With what weighs most against the result; the page, the record and the log have every note."""
    out = tmp_path / "run"
    with quick_pictures(blank=True):
        shown = CliRunner().invoke(commands, ["run", str(study), "--out", str(out)])
    assert shown.exit_code == 0
    lines = shown.stdout.splitlines()
    assert len(lines) <= 10
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert lines[0].startswith(f"{summary['name']}: 3 mm slid, ")
    rows = {line[2:18].strip(): line[18:].strip() for line in lines[1:]}
    notes = summary["warnings"]
    heavy = sum(" not apply " not in text and "no step ends at" not in text for text in notes)
    assert rows["trust"] == f"none; the heaviest of {heavy} warnings follows"
    assert "cells are in contact, so its area, pressure and friction mean nothing" in rows["warning"]
    assert rows["page"].startswith(f"{out}/report.html (")
    assert not any(line.startswith(("note: ", "warning: ")) for line in shown.stderr.splitlines())
    page = html.unescape((out / "report.html").read_text(encoding="utf-8"))
    places = [page.index(note) for note in notes]
    verdict = summary["verdict"]["text"]
    assert page.index(f"{verdict[0].upper()}{verdict[1:]}.") < min(places)
    log = (out / "log.txt").read_text(encoding="utf-8")
    assert all(note in log for note in notes)


def test_all_numbers_and_notes_on_request(study: Path, tmp_path: Path) -> None:
    """They come before the ten lines, so that a terminal ends alike."""
    out = tmp_path / "run"
    arguments = ["run", str(study), "--out", str(out), "--no-plots"]
    shown = CliRunner().invoke(commands, [*arguments, "--details"])
    notes = json.loads((out / "summary.json").read_text(encoding="utf-8"))["warnings"]
    told = [line.split(": ", 1)[1] for line in shown.stderr.splitlines() if ": " in line]
    assert sorted(notes) == sorted(line for line in told if line in notes)
    assert "more note" not in shown.stderr
    assert "  area_mm2: contact " in shown.stdout
    last = shown.stdout.splitlines()[-10:]
    again = CliRunner().invoke(commands, [*arguments, "--resume"]).stdout.splitlines()
    assert again[1:-1] == last[-len(again) + 1 : -1]
    assert again[-1].endswith("summary.json (finished before: nothing was left to do)")


def test_the_first_contacts_say_how_long_a_run_takes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    coarse, four = ("--set", "grid.cell=20 um"), ("--set", "sliding.cycles=4")
    for name, changes in (("first", (*coarse, *four)), ("track", ())):
        shown = CliRunner().invoke(commands, ["run", name, *changes, "--dry-run"])
        assert shown.exit_code == 0, shown.exception
        assert re.fullmatch(rf"{name}: about [\d.]+ (s|min), without figures\n", shown.stdout), shown.stdout
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", ["note", "warning"])
def test_every_kind_reaches_the_page(kind: str, study: Path) -> None:
    result = warpwear.run(study)
    summary = result.summary
    mine = [text for text in summary["warnings"] if (text in summary["notes"]) == (kind == "note")]
    assert mine
    page = html.unescape(result._repr_html_())
    assert re.findall(rf"<li><b>{kind.capitalize()}\.</b> (.*?)</li>", page) == mine


def test_a_long_run_tells_its_warnings_early(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """They are told once, and one line is kept for what the end brings."""
    row = {"distance": 1.0, "area_contact": 1.0}
    with Progress("long", pace=(-1.0, 30.0)) as progress:
        progress.note("This key does not apply.")
        for number in range(3):
            progress.note(f"Warning {number}.", kind="warning")
        progress.start(10, (lambda: 1, lambda: (9.0, 9.0)))
        progress.step(row)
        early = capsys.readouterr().err.splitlines()
        assert early[:2] == ["warning: Warning 0.", "warning: Warning 1."]
        assert not any("Warning 2" in line or "apply" in line for line in early)
        progress.note("All numbers mean nothing.", kind="warning")
    late = capsys.readouterr().err.splitlines()
    assert late == [
        "warning: All numbers mean nothing.",
        "2 more notes: in the run's summary and log",
    ]


def test_a_size_of_cells_that_would_do_divides_the_domain() -> None:
    study = Study.load("v3").replace({"grid.cell": "20 um", "grid.extent": "0.4 mm", "contact.load": "2 N"})
    (told,) = doubts.of_count(study, 19.8, "To begin with")
    assert told.startswith("To begin with only 19.8 cells are in contact")
    assert "16 µm would do (20 cells)" in told  # 19 µm would be enough, and is no part of 0.4 mm


def test_the_hardest_layer_says_what_shear_is_borne() -> None:
    """A coat of 20 GPa under a ball of 7.3 GPa bears what the ball does, not what steel below it would."""
    study = Study.load("coat")
    assert study.pair.shear_limit == pytest.approx(study.counter.hardness / (3.0 * math.sqrt(3.0)), rel=1e-12)
    softer = study.replace({"disc.hardness": "1 GPa", "disc.layers": None})
    assert softer.pair.shear_limit == pytest.approx(1000.0 / (3.0 * math.sqrt(3.0)), rel=1e-12)
