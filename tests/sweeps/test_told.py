"""What a sweep tells while it runs and where runs of it fail."""

import logging
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cases_sweeps import small

import warpwear
from warpwear import InputError
from warpwear.cli.main import main
from warpwear.engine.workers import Here


@pytest.fixture
def few_dots(quick_pictures: Any) -> Iterator[None]:
    """Have pictures drawn in few dots."""
    with quick_pictures(blank=True):
        yield


FAILING = {"contact.hardness": ["0.001 MPa", "590 MPa", "-1 MPa"]}


def test_failed_run_is_a_row_with_its_sentence_and_a_warning() -> None:
    says = "^2 of 3 runs failed, rows 0, 2 from 0: the column status of the result's table says why.$"
    with pytest.warns(warpwear.StudyWarning, match=says) as warned:
        found = warpwear.sweep(small(), vary=FAILING, executor=Here())
    assert [Path(w.filename).name for w in warned if w.category is warpwear.StudyWarning] == [
        Path(__file__).name
    ]
    table = found.table
    assert table["status"][1] == "done"
    assert table["status"][0].startswith("failed: ")
    assert table["status"][2].startswith("failed: contact.hardness")
    assert math.isnan(table["cof [1]"][0])
    with pytest.raises(InputError, match=r"not kept: give sweep\(\) a folder, out"):
        found.open(1)


@pytest.mark.usefixtures("few_dots")
def test_a_command_of_which_runs_failed_ends_with_1(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "s.toml"
    study.write_text(small().to_toml(), encoding="utf-8")
    command = ["sweep", str(study), "--out", str(tmp_path / "out"), "--workers", "1", "--vary"]
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.hardness=0.001 MPa,590 MPa"])
    assert ended.value.code == 1
    (told,) = (line for line in capfd.readouterr().err.splitlines() if line.startswith("warpwear: "))
    assert told.startswith("warpwear: 1 of 2 runs failed, row 0 from 0: the column status of ")
    assert f"{tmp_path / 'out' / 'table.csv'} says why" in told
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.hardness=590 MPa", "--resume"])
    assert ended.value.code == 0


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"vary": {"contact.lod": ["1 N"]}}, "contact.lod"),
        ({"vary": {"contact.load": ["1 N"]}, "band_over": "grid.cell"}, "not varied"),
        ({"vary": {"contact.load": ["1 N"]}, "design": "cross"}, "sweep.design"),
        ({"vary": {"disc.crop": {"positions": 3}}}, "measured disc"),
    ],
)
def test_what_makes_no_sweep_is_refused(asked: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        warpwear.sweep(small(), executor=Here(), **asked)


def test_a_sweep_from_python_tells_the_log_how_far_it_is(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="warpwear")
    found = warpwear.sweep(small(), vary={"contact.load": ["4 N", "8 N"]}, executor=Here())
    told = [record.getMessage() for record in caplog.records if " of 2 runs, " in record.getMessage()]
    assert [line.partition(";")[0] for line in told] == [f"{n} of 2 runs, the last done" for n in (1, 2)]
    assert told[1].endswith("about 0 s left")
    assert repr(found) == "<sweep over contact.load: 2 of 2 runs done>"


@pytest.mark.usefixtures("few_dots")
def test_a_sweep_in_a_log_tells_how_far_it_is(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("warpwear.sweeps.sweep.EVERY_SECONDS", 0.0)
    study = tmp_path / "s.toml"
    study.write_text(small().to_toml(), encoding="utf-8")
    command = ["sweep", str(study), "--out", str(tmp_path / "out"), "--workers", "1", "--vary"]
    with pytest.raises(SystemExit):
        main([*command, "contact.load=4 N,8 N"])
    assert "1 of 2 runs, the last done; " in capfd.readouterr().err
    with pytest.raises(SystemExit) as ended:
        main([*command, "contact.load=4 N,8 N"])
    assert ended.value.code == 2
    told = capfd.readouterr().err
    assert "already holds a sweep; resume it (--resume), or give another folder (--out)." in told
    assert "overwrite" not in told  # the command has no such option
