"""Cycles of a track that stand for many: volumes, stops, the error that is told, and runs that go on."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_track import small
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Result, Study
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES

#: A smooth disc under a ball, by each law of the contact.
SMOOTH = {"disc.synthetic.kind": "flat", "wear.counter": "1e-5 mm^3/N/m", "wear.disc": "3e-5 mm^3/N/m"}
LAWS = {"local": {}, "half-space": {"contact.law": "half-space", "sliding.shift": 10}}
FILM = {"friction.film.thickness": "20 nm", "friction.film.shear_strength": "40 MPa"}


def study_of(track: str = "rotating", **changes: Any) -> Study:
    """A smooth disc on one of the tracks of tests; changes: keys with __ for the dot."""
    return small(track).replace(SMOOTH | {k.replace("__", "."): v for k, v in changes.items()})


def worn(result: Result) -> dict[str, FloatArray]:
    fields = result.snapshot(-1)
    return {body: np.asarray(getattr(fields, f"wear_{body}")) for body in BODIES}


def distance_of(one: FloatArray, other: FloatArray) -> float:
    """Difference over the depth, rms."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(one))


@pytest.mark.parametrize("track", ["full", "representative", "rotating"])
def test_jumps_keep_volumes_and_meet_every_stop(track: str, device: str) -> None:
    study = study_of(track, stepping__jump=4, sliding__distance="60.3 mm", output__snapshots=["20 mm"])
    result = warpwear.run(study, device=device)
    history = result.history
    assert history["cycles"].max() == 4
    assert history["distance"][-1] == pytest.approx(60.3, rel=1e-15)
    assert_allclose(np.cumsum(history["increment"]), history["distance"], rtol=1e-12)
    for body in BODIES:
        expected = history[f"archard_volume_{body}"]
        assert_allclose(history[f"wear_volume_{body}"], expected, rtol=1e-12)
    last = result.summary["volume_mm3"]["disc"]
    assert last == pytest.approx(3e-8 * study.contact.load * 60.3, rel=1e-12)
    every = warpwear.run(study.replace({"stepping.jump": 1}), device=device)
    assert_array_equal(result.snapshot_distances, every.snapshot_distances)


@pytest.mark.parametrize("law", LAWS)
def test_the_error_that_is_told_holds(law: str, device: str) -> None:
    study = study_of(sliding__distance="400 mm", stepping__jump="auto").replace(LAWS[law])
    every, jumped = (warpwear.run(study.replace({"stepping.jump": j}), device=device) for j in (1, "auto"))
    told = jumped.summary["track"]["jumps"]
    assert told["contacts"] < 0.5 * told["contacts_of_every_cycle"]
    for body, depth in worn(every).items():
        assert distance_of(depth, worn(jumped)[body]) <= told["depth_error_percent"][body] / 100.0
        assert told["depth_error_percent"][body] <= 0.5


def test_a_run_that_cannot_jump_is_that_of_every_cycle(device: str) -> None:
    """The coarse state beside it changes nothing."""
    study = small("rotating", sliding__distance="110 mm", stepping__jump_error=1e-9).replace(FILM)
    every, none = (warpwear.run(study.replace({"stepping.jump": j}), device=device) for j in (1, "auto"))
    assert set(none.history) - set(every.history) == {"cycles"}
    for name, values in every.history.items():
        assert_array_equal(none.history[name], values)
    assert none.summary["track"]["jumps"]["depth_error_percent"] == {"counter": 0.0, "disc": 0.0}


def test_a_run_with_jumps_goes_on_bit_for_bit(tmp_path: Path) -> None:
    study = study_of(sliding__distance="150 mm", run__checkpoint="0 s", output__snapshots=["60 mm"])
    alone = warpwear.run(study)
    steps = alone.history["distance"].size

    class Stop(Exception):
        pass

    for index in (3, 17, steps // 2 + 3, steps - 5):

        def stop(step: warpwear.RunStep, index: int = index) -> None:
            if step.index == index:
                raise Stop

        with pytest.raises(Stop):
            warpwear.run(study, out=tmp_path / "run", plots=False, resume=True, callback=stop)
    again = warpwear.run(study, out=tmp_path / "run", plots=False, resume=True)
    for name, values in alone.history.items():
        assert_allclose(again.history[name], values, rtol=1e-9)
    assert again.record["cycle_jump"] == pytest.approx(alone.record["cycle_jump"], rel=1e-6)


def test_few_cycles_are_each_computed() -> None:
    study = study_of(sliding__distance="7 mm")
    assert not study.jumps
    assert study.replace({"stepping.jump": 3}).jumps
    with pytest.raises(InputError, match="stepping.jump"):
        study.replace({"stepping.jump": 0})
