"""Newton's search within a bracket finds the load, also where force is no smooth function of the offset."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import warp as wp

from warpwear.grid import FloatArray
from warpwear.kernels import newton
from warpwear.kernels.newton import Bracket, bracket_at, next_trial

wp.set_module_options({"enable_backward": False})

LOOKS, MET, SURE, STUCK = (int(state) for state in (newton.LOOKS, newton.MET, newton.SURE, newton.STUCK))
#: Force and slope at an offset.
Curve = Callable[[float], tuple[float, float]]


@wp.kernel
def begin(offset: wp.float64, reach: wp.float64, bracket: wp.array(dtype=Bracket)):
    """Begin a search."""
    bracket[0] = bracket_at(offset, reach)


@wp.kernel
def go_on(
    force: wp.float64,
    slope: wp.float64,
    load: wp.float64,
    tolerance: wp.float64,
    linear_range: wp.float64,
    bracket: wp.array(dtype=Bracket),
):
    """Look at one trial."""
    bracket[0] = next_trial(bracket[0], force, slope, load, tolerance, linear_range)


class Search:
    """A search as a program makes it, trial after trial."""

    def __init__(self, curve: Curve, load: float, *, start: float = 0.0, reach: float = 0.0) -> None:
        self.curve, self.load = curve, load
        self._bracket = wp.zeros(1, dtype=Bracket, device="cpu")
        wp.launch(begin, dim=1, inputs=[start, reach, self._bracket], device="cpu")
        self.trials: list[Any] = [self._bracket.numpy()[0].copy()]

    def go_on(self, *, tolerance: float = 0.0, linear_range: float = 0.0) -> Any:
        """Return the bracket with its next trial."""
        force, slope = self.curve(float(self.trials[-1]["offset"]))
        numbers = [force, slope, self.load, tolerance, linear_range]
        wp.launch(go_on, dim=1, inputs=[*numbers, self._bracket], device="cpu")
        self.trials.append(self._bracket.numpy()[0].copy())
        return self.trials[-1]

    def end(self, **options: float) -> Any:
        """Return the bracket of the search at its end."""
        while (bracket := self.go_on(**options))["state"] == LOOKS:
            pass
        return bracket


def springs(gaps: FloatArray, stiffness: FloatArray, cap: float) -> Curve:
    """Springs that come into contact one after another, and yield at a force."""

    def curve(offset: float) -> tuple[float, float]:
        force = np.clip(stiffness * (offset - gaps), 0.0, cap)
        return float(force.sum()), float(stiffness[(force > 0.0) & (force < cap)].sum())

    return curve


def drawn(seed: int) -> tuple[FloatArray, FloatArray, Curve, float]:
    """Gaps and stiffnesses of springs, their curve, and a force at which all of them yield."""
    rng = np.random.default_rng(seed)
    gaps, stiffness = rng.gamma(2.0, 1e-3, 300), 10.0 ** rng.uniform(2.0, 4.0, 300)
    return gaps, stiffness, springs(gaps, stiffness, 0.5), 150.0


def solution(gaps: FloatArray, stiffness: FloatArray, load: float, cap: float = 0.5) -> float:
    """The offset at which springs carry a load: force is linear between the points where one changes."""
    points = np.sort(np.concatenate([gaps, gaps + cap / stiffness]))
    forces = [np.clip(stiffness * (point - gaps), 0.0, cap).sum() for point in points]
    return float(np.interp(load, forces, points))


@pytest.mark.parametrize("start", ["below", "near", "above"])
@pytest.mark.parametrize("share", [1e-6, 0.01, 0.5, 0.999])
@pytest.mark.parametrize("seed", range(3))
def test_springs_that_come_and_yield(seed: int, share: float, start: str) -> None:
    """The load is carried to the tolerance, at the offset of a search without Newton's method."""
    gaps, stiffness, curve, most = drawn(seed)
    load = share * most
    place = {"below": 0.0, "near": solution(gaps, stiffness, 0.9 * load), "above": 1.0}[start]
    search = Search(curve, load, start=place, reach=1e-3 if start == "below" else 0.0)
    bracket = search.end(tolerance=1e-12 * load)
    assert bracket["state"] == MET
    assert curve(float(bracket["offset"]))[0] == pytest.approx(load, rel=2e-12)
    assert bracket["offset"] == pytest.approx(solution(gaps, stiffness, load), rel=1e-9)
    assert bracket["evaluation"] < 80


@pytest.mark.parametrize("seed", range(3))
def test_the_bracket_holds_the_solution_and_halves(seed: int) -> None:
    """From the trial on that closes it, at least every second time."""
    gaps, stiffness, curve, most = drawn(seed)
    load = 0.7 * most
    expected = solution(gaps, stiffness, load)
    search = Search(curve, load, start=0.3, reach=1e-4)
    search.end(tolerance=1e-12 * load)
    for bracket in search.trials:
        assert bracket["low"] <= expected * (1.0 + 1e-12)
        assert bracket["high"] >= expected * (1.0 - 1e-12)
    closed = [b for b in search.trials if b["low"] > -1e299 and b["high"] < 1e299]
    assert len(closed) > 3
    widths = [b["high"] - b["low"] for b in closed]
    # Two trials after an even one that has found the bracket too wide, the middle has been looked at.
    assert all(later <= 0.5 * width * (1.0 + 1e-9) for width, later in zip(widths, widths[4:], strict=False))


def test_a_straight_way_is_gone_at_once() -> None:
    """Where no spring changes its state on the way, Newton's step is the solution and is not looked at."""
    curve = springs(np.array([0.0, 0.01]), np.array([100.0, 50.0]), 10.0)
    for linear_range, state in ((0.01 - 2e-3, SURE), (1e-3, LOOKS)):
        search = Search(curve, 0.5, start=2e-3)
        bracket = search.go_on(linear_range=linear_range)
        assert bracket["state"] == state
        if state == SURE:
            assert bracket["offset"] == pytest.approx(5e-3, rel=1e-14)


def test_an_offset_without_digits_enough_is_not_sure() -> None:
    """Its rounding is a force above any tolerance: the trial is looked at."""
    search = Search(lambda offset: (1e6 * (offset - 1.0), 1e6), 1e-3, start=1.0)
    assert search.go_on(linear_range=1.0)["state"] == LOOKS


@pytest.mark.parametrize("slope", [0.0, 1.0])
def test_a_force_that_jumps_over_the_load_ends_between_two_numbers(slope: float) -> None:
    """It is stuck: the sides of the bracket are neighbours, and the offset is one of them."""
    jump = 0.12345
    search = Search(lambda offset: (2.0 if offset >= jump else 0.0, slope), 1.0, start=0.0, reach=1e-3)
    bracket = search.end(tolerance=1e-9)
    assert bracket["state"] == STUCK
    assert np.nextafter(bracket["low"], 1.0) == bracket["high"] == jump
    assert bracket["offset"] in (bracket["low"], bracket["high"])
    assert bracket["evaluation"] < 150


@pytest.mark.parametrize("force", [0.5, np.nan])
def test_a_load_that_nothing_carries_ends_the_search(force: float) -> None:
    """Beyond any offset that makes sense, or with a force that is no number."""
    bracket = Search(lambda offset: (force, 0.0), 1.0, reach=1e-3).end(tolerance=1e-9)
    assert bracket["state"] == STUCK
    assert bracket["evaluation"] <= int(newton.EVALUATIONS)


def test_a_load_that_is_carried_is_met_where_it_is() -> None:
    bracket = Search(lambda offset: (1.0 + 1e-13, 1.0), 1.0, start=0.25).go_on(tolerance=1e-12)
    assert (bracket["state"], bracket["offset"], bracket["evaluation"]) == (MET, 0.25, 1)
