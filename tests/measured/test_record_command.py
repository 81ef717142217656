"""The command `warpwear record`: what it prints and writes, read back, and what it refuses."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_courses import made
from cases_records import RECORDS, ROWS, cetr, written
from click.testing import CliRunner

from warpwear.cli.main import commands
from warpwear.cli.record import describe
from warpwear.errors import InputError
from warpwear.measured.course import read_experiment

pytest.importorskip("ruptures")


def jumping(folder: Path) -> Path:
    """Write a record with a jump: 20 points a lap of a track of 5 mm."""
    cof, _ = made(5)
    points = np.repeat(cof, 20) + 0.01 * np.random.default_rng(0).normal(size=20 * cof.size)
    distance = (np.arange(points.size) + 0.5) * 0.5 * np.pi
    path = folder / "jump.csv"
    rows = "".join(f"{a:.6f},3.0,{b:.5f}\n" for a, b in zip(distance, points, strict=True))
    path.write_text("Distance [mm],Fz [N],CoF\n" + rows)
    return path


def printed(path: Path, **options: Any) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(describe([path], as_json=True, **options))
    return content


def test_json_says_what_happens_in_a_record(tmp_path: Path) -> None:
    _, truth = made(5)
    found = printed(jumping(tmp_path), radius="5 mm")
    assert found["incubation_laps"] == pytest.approx(truth.start, abs=1.0)
    assert found["jump_laps"] == pytest.approx(truth.width, abs=1.0)
    assert found["incubation_mm"] == pytest.approx(10.0 * np.pi * found["incubation_laps"])
    assert abs(found["steady_cof"] - truth.level) < found["steady_cof_error_95"]
    assert found["scatter"] == pytest.approx(0.01, rel=0.1)
    assert found["load_N"] == 3.0
    course = read_experiment(tmp_path / "jump.csv")
    work = 3e-3 * np.trapezoid(course.cof, course.distance)
    assert found["energy_J"] == pytest.approx(work, rel=1e-12)
    assert found["warnings"] == []


def test_a_folder_is_written_and_its_table_is_the_course_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = jumping(tmp_path)
    result = CliRunner().invoke(commands, ["record", str(path), "--radius", "5 mm"])
    assert result.exit_code == 0, result.output
    assert "written to jump-record/: record.html, record.csv, record.json, figures" in result.output
    folder = tmp_path / "jump-record"
    written_files = {"course.png", "record.csv", "record.html", "record.json", "manifest.json"}
    assert {p.name for p in folder.iterdir()} == written_files
    again = read_experiment(folder / "record.csv")
    with (folder / "record.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["CoF [-]"]) for row in rows] == again.cof.tolist()
    assert float(rows[3]["Lap [-]"]) == 3.5
    assert json.loads((folder / "record.json").read_text()) == printed(path, radius="5 mm")
    assert printed(path, radius="5 mm")["flash_unknown"].startswith("not known: no conductivity of the disc")
    page = (folder / "record.html").read_text()
    assert "steady value" in page
    assert "http" not in page.split("<script")[0].replace("http-equiv", "")
    again_text = describe([path], radius="5 mm")
    last = again_text.splitlines()[-1]
    assert last.startswith(
        "jump-record is there already and was not written again: --overwrite replaces it; "
    )
    assert again_text.count("\n") < 10
    whole = describe([path], radius="5 mm", details=True).splitlines()
    assert last.endswith(f"; {len(whole) - again_text.count(chr(10)) - 1} more lines with --details")
    describe([path], radius="5 mm", overwrite=True)
    with pytest.raises(InputError, match="already holds a record"):
        describe([path], out=folder)


def test_steps_of_a_recipe_are_blocks(tmp_path: Path) -> None:
    path = tmp_path / "rtec.csv"
    path.write_bytes(written(RECORDS["rtec.csv"][0]()))
    found = printed(path, radius="6 mm, 9 mm")
    assert [step["step"] for step in found["steps"]] == ["4", "7"]
    assert [step["load_N"] for step in found["steps"]] == [3.0, 3.0]
    laps = 0.2 * (ROWS - 1)
    assert found["steps"][1]["distance_mm"] == pytest.approx(18.0 * np.pi * laps)
    text = describe([path], radius="6 mm, 9 mm", out=tmp_path / "out", details=True)
    assert text.count("\n  step ") == 2
    with (tmp_path / "out" / "record.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["Step"] for row in rows} == {"4", "7"}
    assert np.all(np.diff([float(row["Distance [mm]"]) for row in rows]) > 0.0)


def test_loops_are_drawn_and_hold_the_energy_of_a_cycle(tmp_path: Path) -> None:
    path = tmp_path / "trb3.txt"
    path.write_bytes(written(RECORDS["trb3.txt"][0]()))
    text = describe([path], out=tmp_path / "out", details=True)
    assert (tmp_path / "out" / "loops.png").exists()
    loops = printed(path)["loops_mJ"]
    assert list(loops) == ["1", "3", "6"]
    assert loops["1"] == pytest.approx(4.0 * 0.30 * 5.0 * 2.0, rel=0.02)  # 4 mm there and back
    assert "loop of cycle 6" in text


def test_a_folder_of_strokes_is_one_record(tmp_path: Path) -> None:
    for number in range(1, 31):
        (tmp_path / f"wear_{number}.csv").write_text(cetr(number))
    found = printed(tmp_path, stroke="8 mm")
    assert found["distance_cycles"] == pytest.approx(29.5)
    assert found["energy_J"] == pytest.approx(
        16e-3 * 200 * 0.00980665 * sum(0.3 + 0.001 * k for k in range(1, 31))
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"radius": "6"}, "--radius = '6': needs its unit"),
        ({"radius": "6 mm, 7 mm, 8 mm"}, "--radius has 3 values where .* has 2 steps"),
        ({"columns": "9,2"}, "has the unit s, where a plain number"),
        ({"load": "3 mm", "radius": "6 mm"}, "--load = '3 mm'"),
        ({"out": "record.txt/x"}, "record.txt is a file"),
        ({"file_format": "bmp"}, "bmp"),
        ({}, "such as --radius '6 mm', or one for each of its 2 steps"),
    ],
)
def test_what_is_wrong_is_refused(
    tmp_path: Path, options: dict[str, Any], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "record.txt"
    path.write_bytes(written(RECORDS["rtec.csv"][0]()))
    if "out" in options:
        options = {"out": Path(options["out"]), "radius": "6 mm"}
    with pytest.raises(InputError) as refused:
        describe([path], **options)
    assert re.search(words, refused.value.sentence)
    assert list(tmp_path.iterdir()) == [path]
