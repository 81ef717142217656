"""A sweep in the folder of another: it may grow, and loses nothing."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import warpwear
from warpwear import InputError, Study, StudyWarning
from warpwear.batches.batch import Count
from warpwear.batches.plan import Plan, section_of
from warpwear.batches.run_one import RunRow
from warpwear.cli.main import commands
from warpwear.engine.workers import Here
from warpwear.results import manifest
from warpwear.sweeps.sweep import check_runs
from warpwear.sweeps.table import TABLES, SweepResult

#: A smooth contact of few cells and no sliding.
SMALL = {"grid.cell": "20 um", "sliding.distance": "0 mm", "output.snapshots": []}


def planned(*loads: str) -> Plan:
    study = Study.load("v3-fine").replace(SMALL)
    return Plan(study, section_of({"vary": {"contact.load": list(loads)}}, {}))


def written(folder: Path, plan: Plan) -> Path:
    """A folder with the table of a plan whose runs are said to be done."""
    rows = [RunRow("done", 0.1) if point.study else RunRow("failed") for point in plan.points]
    SweepResult(plan, rows, folder).write_tables(folder)
    manifest.write(folder, TABLES)
    return folder


def test_a_sweep_may_grow_and_lose_no_run(tmp_path: Path) -> None:
    check_runs(planned("4 N"), tmp_path / "new")  # nothing is there
    folder = written(tmp_path, planned("4 N", "-1 N", "8 N"))
    before = (folder / "table.csv").read_bytes()
    for loads in (("8 N", "4 N"), ("4 N", "6 N", "8 N"), ("4000 mN", "8 N")):
        check_runs(planned(*loads), folder)
    with pytest.raises(InputError, match="with 2 runs, 1 of which this one has not: its tables"):
        check_runs(planned("4 N", "9 N"), folder)
    (folder / "runs").mkdir()
    study = Study.load("v3-fine").replace(SMALL)
    with pytest.raises(InputError, match="1 of which this one has not"):
        warpwear.sweep(study, vary={"contact.load": ["4 N", "9 N"]}, out=folder, workers=1)
    changes = [part for key, value in SMALL.items() if value for part in ("--set", f"{key}={value}")]
    told = CliRunner().invoke(
        commands,
        ["sweep", "v3-fine", *changes, "--vary", "contact.load=4 N,9 N", "--out", str(folder), "--resume"],
    )
    assert isinstance(told.exception, InputError)
    assert "this one has not" in str(told.exception)
    assert (folder / "table.csv").read_bytes() == before


@pytest.mark.parametrize(
    ("encoding", "change"),
    [("utf-16", ("", "")), ("latin-1", ("done", "dône")), ("utf-8", (",", ";")), ("utf-8", ("run", "name"))],
)
def test_a_table_that_another_program_saved_is_not_overwritten(
    tmp_path: Path, encoding: str, change: tuple[str, str]
) -> None:
    table = written(tmp_path, planned("4 N", "8 N")) / "table.csv"
    text = table.read_text(encoding="utf-8")
    table.write_text(text, encoding="utf-8-sig")  # as by Excel
    check_runs(planned("4 N", "8 N"), tmp_path)
    with pytest.raises(InputError, match="1 of which this one has not"):
        check_runs(planned("4 N", "9 N"), tmp_path)
    table.write_text(text.replace(*change) if change[0] else text, encoding=encoding)
    with pytest.raises(InputError, match="cannot be read as the table of a sweep"):
        check_runs(planned("4 N", "8 N"), tmp_path)


def test_runs_that_failed_are_no_loss(tmp_path: Path) -> None:
    plan = planned("4 N", "8 N")
    SweepResult(plan, [RunRow("done", 0.1), RunRow("failed: no")], tmp_path).write_tables(tmp_path)
    check_runs(planned("4 N", "7 N"), tmp_path)


def test_what_was_varied_is_known_of_runs_that_cannot_be() -> None:
    """In the unit of the others, so that one sees where runs fail."""
    found = SweepResult(planned("4 N", "-5000 mN", "much", "8 N"), []).numbers("contact.load")
    assert found is not None
    assert found[1] == "N"
    np.testing.assert_array_equal(found[0], [4.0, -5.0, np.nan, 8.0])


def test_the_time_left_is_that_of_runs_that_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter([0.0, 1.0, 2.0, 12.0])
    monkeypatch.setattr("warpwear.batches.batch.time.monotonic", lambda: next(now))
    counted = Count(5)
    there = RunRow("done", 10.0, was_there=True)
    assert counted.one(there) == "1 of 5 runs, the last done; 1 s gone"
    assert counted.one(there).endswith("2 s gone")
    assert counted.one(RunRow("done", 10.0)).endswith("12 s gone, about 24 s left")


def test_a_failed_run_has_its_place(tmp_path: Path) -> None:
    xarray: Any = pytest.importorskip("xarray")
    study = Study.load("v3-fine").replace(SMALL)
    with pytest.warns(StudyWarning, match="1 of 2 runs failed"):
        found = warpwear.sweep(study, vary={"contact.load": ["8 N", "-1 N"]}, executor=Here())
    table = found.to_xarray()
    assert isinstance(table, xarray.Dataset)
    assert table["contact.load"].values.tolist() == [8.0, -1.0]
