"""End values of a track are of the last cycle, whichever way its last pass went."""

import numpy as np
import pytest
from cases_track import small
from numpy.testing import assert_allclose

from warpwear.laws.passes import Laps, directions, mean_over
from warpwear.results.track import doubt_of_directions

STROKE, STEPS = 2.0, 40


def history_of(passes: float, *, at_ends: bool = False, difference: float = 0.4) -> dict[str, np.ndarray]:
    """A track whose area is 1 forward, and more backward: everywhere, or beside its ends alone."""
    increment = np.full(round(passes * STEPS), STROKE / STEPS)
    distance = np.cumsum(increment)
    slid = distance - 0.5 * increment
    back, place = (slid // STROKE) % 2 == 1, slid % STROKE
    beside_ends = np.minimum(place, STROKE - place) < 0.1
    more = difference * back * (beside_ends if at_ends else 1.0)
    scatter = 0.02 * np.random.default_rng(1).standard_normal(slid.size)
    area = 1.0 + more + scatter
    return {
        "increment": increment,
        "distance": distance,
        "area_contact": area,
        "patch_along": 0.2 + 0.0 * area,
    }


@pytest.mark.parametrize("passes", [6.0, 7.0, 6.5])
def test_the_end_does_not_depend_on_the_parity_of_the_last_pass(passes: float) -> None:
    history = history_of(passes)
    end = mean_over(history, history["area_contact"], "end", Laps(STROKE, reverses=True))
    assert end == pytest.approx(1.2, abs=0.01)
    ways = directions(history, history["area_contact"], Laps(STROKE, reverses=True))
    assert_allclose(ways[:2], (1.0, 1.4), atol=0.01)


def test_a_rotation_and_a_first_pass_have_no_cycle() -> None:
    history = history_of(4.0)
    assert directions(history, history["area_contact"], Laps(STROKE, reverses=False)) is None
    assert directions(history, history["area_contact"], None) is None
    short = history_of(1.5)
    laps = Laps(STROKE, reverses=True)
    assert directions(short, short["area_contact"], laps) is None
    last = short["area_contact"][-STEPS:].mean()
    assert mean_over(short, short["area_contact"], "end", laps) == pytest.approx(last, rel=1e-12)


@pytest.mark.parametrize(("at_ends", "cause"), [(True, "most of it at the seam"), (False, "not at the seam")])
def test_directions_that_differ_are_told_with_their_cause(at_ends: bool, cause: str) -> None:
    study = small("representative", sliding__stroke=f"{STROKE} mm")
    difference = 4.0 if at_ends else 0.4
    sentence = doubt_of_directions(study, history_of(6.0, at_ends=at_ends, difference=difference))
    assert sentence is not None
    assert cause in sentence
    assert "mm² forward and 1.4 mm² backward" in sentence


def test_directions_that_only_scatter_are_not_told() -> None:
    study = small("representative", sliding__stroke=f"{STROKE} mm")
    assert doubt_of_directions(study, history_of(6.0, difference=0.0)) is None
