"""What other steps change of an area at a run's end: from one state, and nothing else of the run changes."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import run_stopped
from cases_track import TRACKS, small
from numpy.testing import assert_array_equal

import warpwear
from warpwear import Study
from warpwear.errors import ConvergenceError
from warpwear.models.track.local import SlidingContact
from warpwear.runs import probe

#: Distances of whole cycles of the tracks of tests [mm].
CYCLES = {"full": 1.8, "representative": 6.0, "rotating": 2.0 * math.pi * 0.161}


def study_of(track: str, cycles: float, **changes: Any) -> Study:
    return small(track, sliding__distance=f"{cycles * CYCLES[track]:.12g} mm", **changes)


def change(study: Study, **options: Any) -> float | None:
    return warpwear.run(study, **options).record["change_by_step"]


@pytest.mark.parametrize("track", TRACKS)
def test_steps_of_the_run_are_those_of_its_next_cycle(track: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """And shorter ones cover the same way: as long, to the last step, and as many as it takes."""
    monkeypatch.setattr(probe, "LEAST", 100)  # a whole cycle
    made, area = [], probe._area

    def kept(model: Any, way: Any, *about: Any) -> float:
        made.append((way, area(model, way, *about)))
        return made[-1][1]

    monkeypatch.setattr(probe, "_area", kept)
    found = change(study_of(track, 2))
    (own, same), (other, shorter) = made
    assert found == shorter / same - 1.0 != 0.0
    assert (other.shift, other.cells) == (own.shift // 2, own.cells)
    longer = warpwear.run(study_of(track, 3))
    last = longer.history["distance"] > (2.0 + 1e-9) * CYCLES[track]
    means = np.average(longer.history["area_contact"][last], weights=longer.history["increment"][last])
    assert same == pytest.approx(means, rel=1e-14)


@pytest.mark.parametrize("track", TRACKS)
def test_the_run_is_that_without_it(track: str, tmp_path: Path, device: str) -> None:
    """Rows, fields and what is told beside; two cells follow where steps are of one."""
    study = study_of(track, 2, sliding__shift=1)
    with_it = warpwear.run(study, device=device)
    without = warpwear.run(study.replace({"checks.step_probe": False}), device=device)
    assert without.record["change_by_step"] is without.summary["verdict"]["area_parts"]["step"] is None
    assert with_it.record["change_by_step"] > 0.0
    part = with_it.summary["verdict"]["area_parts"]["step"]
    assert part == 3.0 * with_it.summary["track"]["change_by_step"] > 0.0
    for name, values in without.history.items():
        assert_array_equal(with_it.history[name], values, err_msg=name)
    ends = with_it.snapshot(-1), without.snapshot(-1)
    for name in ("pressure", "wear_counter", "wear_disc"):
        assert_array_equal(*(getattr(end, name) for end in ends), err_msg=name)


def test_a_few_steps_of_a_long_way_are_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two lengths of the domain, or a step for a hundred of the run."""
    study, counts = study_of("full", 2, sliding__shift=1), []
    one = SlidingContact.replay

    def counted(self: Any, shifts: Any, increments: Any) -> Any:
        count, steps = one(self, shifts, increments)
        counts.append(count)
        return count, steps

    monkeypatch.setattr(SlidingContact, "replay", counted)
    change(study.replace({"checks.step_probe": False}))
    alone = sum(counts)
    counts.clear()
    change(study)
    assert sum(counts) - alone == 62 + 32  # of one cell, and of two but for the last of a pass
    monkeypatch.setattr(probe, "OF_RUN", 2)  # of 180 steps
    counts.clear()
    change(study)
    assert sum(counts) - alone == 90 + 46


def test_what_cannot_be_looked_at_is_not_known() -> None:
    assert change(study_of("full", 0.9)) is None
    assert change(study_of("full", 1, contact__law="half-space")) is None
    assert change(study_of("rotating", 2, wear__particle="40 um", wear__particle_thickness="0.6 um")) is None
    blocks = [{"load": "8 N", "cycles": 2}, {"load": "4 N", "passes": 1}]
    programme = study_of("full", 1)
    assert change(programme.replace(block=blocks)) is None
    assert change(programme.replace(block=blocks[::-1])) is not None


def test_a_probe_that_fails_leaves_the_run_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    study = study_of("rotating", 2)
    expected = warpwear.run(study)

    def fails(*_: Any) -> float:
        raise ConvergenceError("no cell is in contact")

    monkeypatch.setattr(probe, "_area", fails)
    found = warpwear.run(study)
    assert found.record["change_by_step"] is None
    assert found.finished
    assert_array_equal(found.snapshot(-1).wear_disc, expected.snapshot(-1).wear_disc)


@pytest.mark.parametrize("track", TRACKS)
def test_a_run_that_was_stopped_tells_the_same(track: str, tmp_path: Path, threads: int) -> None:
    study = study_of(track, 2)
    alone = warpwear.run(study, threads=1)
    run_stopped(study, tmp_path / "run", len(alone.history["distance"]) - 2, threads=threads)
    again = warpwear.run(study, out=tmp_path / "run", resume=True, plots=False, threads=threads)
    assert again.record["change_by_step"] == alone.record["change_by_step"] != 0.0
    assert again.summary["verdict"] == alone.summary["verdict"]
