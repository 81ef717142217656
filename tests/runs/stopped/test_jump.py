"""Cycles of a track that stand for many: volumes, stops, the error that is told, and runs that go on."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import differences, run_stopped
from cases_track import small
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Result, Study
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES
from warpwear.models.track.part_length import PartLength

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
    study = study_of(track, stepping__jump=3, sliding__distance="180.3 mm", output__snapshots=["90 mm"])
    result = warpwear.run(study, device=device)
    history, total = result.history, 180.3
    assert history["cycles"].max() == 3
    assert history["distance"][-1] == total
    assert_allclose(np.cumsum(history["increment"]), history["distance"], rtol=1e-12)
    for body, k in (("counter", 1e-8), ("disc", 3e-8)):
        expected = history[f"archard_volume_{body}"]
        assert_allclose(history[f"wear_volume_{body}"], expected, rtol=1e-12)
        assert expected[-1] == pytest.approx(k * study.contact.load * total, rel=1e-12)
    every = warpwear.run(study.replace({"stepping.jump": 1}), device=device)
    assert_allclose(result.snapshot_distances, every.snapshot_distances, rtol=1e-15)


def test_laws_of_the_distance_are_integrated_over_what_a_jump_stands_for() -> None:
    law = {"wear.law": "running-in", "wear.running_in": "9 mm", "wear.initial_disc": "3e-4 mm^3/N/m"}
    results = [
        warpwear.run(study_of(stepping__jump=j, sliding__distance="60 mm").replace(law)) for j in (1, 4)
    ]
    every, jumped = (result.history["wear_volume_disc"][-1] for result in results)
    assert jumped == pytest.approx(every, rel=1e-12)


@pytest.mark.parametrize(("law", "jump", "most"), [("local", 8, 2.0), ("half-space", "auto", 0.5)])
def test_the_error_that_is_told_holds(
    law: str, jump: Any, most: float, device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the local law a jump wears more at its own steps' places, which later cycles take off again."""
    study = study_of(sliding__distance="160 mm").replace(LAWS[law])
    monkeypatch.setattr(PartLength, "begins", False)  # both in parts of one cell
    every, jumped = (warpwear.run(study.replace({"stepping.jump": j}), device=device) for j in (1, jump))
    told = jumped.summary["track"]["jumps"]
    assert told["contacts"] < 0.6 * told["contacts_of_every_cycle"]
    largest = max(told["depth_error_percent"].values())
    assert 0.0 < largest <= most
    for body, depth in worn(every).items():
        assert distance_of(depth, worn(jumped)[body]) <= largest / 100.0


def test_a_run_that_cannot_jump_is_that_of_every_cycle(device: str) -> None:
    """The coarse state beside it changes nothing."""
    study = small("rotating", sliding__distance="110 mm", stepping__jump_error=1e-9).replace(FILM)
    every, none = (warpwear.run(study.replace({"stepping.jump": j}), device=device) for j in (1, "auto"))
    assert set(none.history) - set(every.history) == {"cycles"}
    for name, values in every.history.items():
        assert_array_equal(none.history[name], values)
    assert none.summary["track"]["jumps"]["depth_error_percent"] == {"counter": 0.0, "disc": 0.0}


@pytest.mark.parametrize("law", LAWS)
def test_a_run_with_jumps_goes_on_bit_for_bit(law: str, tmp_path: Path) -> None:
    """Stopped in the midst of both halves of a jump, and beside the coarse state."""
    study = study_of(stepping__jump=2, sliding__distance="14.3 mm").replace(LAWS[law])
    one, other = tmp_path / "alone", tmp_path / "stopped"
    warpwear.run(study, out=one, plots=False).close()
    for steps, resume in ((13, False), (9, True), (10, True)):
        run_stopped(study, other, steps, resume=resume)
    warpwear.run(study, out=other, plots=False, resume=True).close()
    assert differences(one, other) == []


def test_few_cycles_are_each_computed() -> None:
    study = study_of(sliding__distance="7 mm")
    assert not study.jumps
    assert study.replace({"stepping.jump": 3}).jumps
    with pytest.raises(InputError, match=r"stepping\.jump"):
        study.replace({"stepping.jump": 0})


@pytest.mark.parametrize(("track", "error"), [("full", 0.005), ("full", 1e-9), ("rotating", 1e-4)])
def test_a_coarse_state_that_never_pays_costs_a_tenth_at_most(track: str, error: float) -> None:
    rough = {"disc.synthetic.kind": "self-affine", "disc.synthetic.ra": "0.05 um"}
    study = study_of(track, sliding__distance="200 mm", stepping__jump_error=error).replace(rough)
    told = warpwear.run(study).summary["track"]["jumps"]
    assert told["contacts"] <= 1.1 * told["contacts_of_every_cycle"]


def test_what_is_allowed_decides_what_is_computed() -> None:
    """At the same error too a size grows at once by what the error allows."""
    study = study_of(sliding__distance="160 mm", contact__stiffness="2e4 N/mm^3")
    told = [
        warpwear.run(study.replace(LAWS[law] | {"stepping.jump_error": error})).summary["track"]["jumps"]
        for law in LAWS
        for error in (0.005, 0.05)
    ]
    contacts = [one["contacts"] / one["contacts_of_every_cycle"] for one in told]
    assert contacts[3] < 0.7 * contacts[2] < 0.35
    # By the local law cycles solve other places each, which a jump cannot: a tight error does not pay there.
    assert contacts[1] < 0.35 < contacts[0] <= 1.1
