"""A stored run of a sweep is used again only where it is what was asked for, and whole."""

import os
from pathlib import Path

import numpy as np
import pytest
from cases_sweeps import small

import warpwear
from warpwear import InputError, Result, Study
from warpwear.batches.batch import RUNS, make_runs
from warpwear.batches.plan import Plan, section_of
from warpwear.batches.run_one import RunRow
from warpwear.engine.workers import Here


def rough(path: Path, seed: int) -> None:
    """Write a surface, with a time that does not tell it from another."""
    np.save(path, np.random.default_rng(seed).normal(scale=1.0e-3, size=(120, 120)))
    os.utime(path, (1.0e9, 1.0e9))


def measured(path: Path) -> Study:
    cell = {"disc.pixel": "10 um", "disc.height_unit": "mm", "disc.level": "none"}
    return small(**{"disc.surface": str(path), "disc.synthetic": None, **cell})


def planned(path: Path) -> Plan:
    return Plan(measured(path), section_of({"vary": {"contact.load": ["8 N"]}}, {}))


def only(rows: list[RunRow]) -> RunRow:
    (row,) = rows
    return row


@pytest.fixture
def surface(tmp_path: Path) -> Path:
    rough(tmp_path / "disc.npy", 1)
    return tmp_path / "disc.npy"


def test_a_surface_that_is_replaced_after_planning_fails(surface: Path, tmp_path: Path) -> None:
    plan = planned(surface)
    rough(surface, 2)
    row = only(make_runs(plan, tmp_path, Here()))
    assert row.status.startswith(f"failed: disc.surface '{surface}' is not the file any more that the sweep")
    rough(surface, 1)
    again = only(make_runs(plan, tmp_path, Here()))
    assert (again.status, again.was_there) == ("done", False)


def test_another_surface_of_the_same_path_and_time_is_another_run(surface: Path) -> None:
    first = planned(surface).points[0]
    rough(surface, 2)
    assert planned(surface).points[0].run != first.run


def test_a_run_on_another_surface_under_this_name_is_made_again(surface: Path, tmp_path: Path) -> None:
    """As versions stored them that did not compare."""
    plan = planned(surface)
    right = only(make_runs(plan, tmp_path / "right", Here()))
    rough(surface, 2)
    other = planned(surface)
    wrong = only(make_runs(other, tmp_path / "wrong", Here()))
    assert wrong.ends != right.ends
    runs = tmp_path / "wrong" / RUNS
    (runs / other.points[0].run).rename(runs / plan.points[0].run)
    rough(surface, 1)
    again = only(make_runs(plan, tmp_path / "wrong", Here()))
    assert again.ends == right.ends
    assert not again.was_there
    with Result.open(runs / plan.points[0].run) as result:
        assert result.record["surface"]["sha256"] == plan.points[0].files["disc.surface"]


def test_a_finished_run_is_not_that_of_a_file_that_changed(surface: Path, tmp_path: Path) -> None:
    warpwear.run(measured(surface), out=tmp_path / "out", plots=False).close()
    warpwear.run(measured(surface), out=tmp_path / "out", plots=False, resume=True).close()
    rough(surface, 2)
    with pytest.raises(InputError, match=r"holds a run on what .*disc\.npy was before"):
        warpwear.run(measured(surface), out=tmp_path / "out", plots=False, resume=True)


@pytest.mark.parametrize("place", [600, -100])
def test_a_damaged_run_is_made_again(place: int, tmp_path: Path) -> None:
    plan = Plan(small(), section_of({"vary": {"contact.load": ["8 N"]}}, {}))
    first = only(make_runs(plan, tmp_path, Here()))
    path = tmp_path / RUNS / plan.points[0].run / "result.h5"
    content = bytearray(path.read_bytes())
    content[place] ^= 255
    path.write_bytes(content)
    again = only(make_runs(plan, tmp_path, Here()))
    assert (again.status, again.was_there) == ("done", False)
    assert again.ends == first.ends
