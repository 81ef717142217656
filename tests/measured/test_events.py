"""Steady value, incubation and jump of courses that are known, with noise that goes together."""

import numpy as np
import pytest
import scipy.signal
from cases_courses import in_laps, made

from warpwear.measured.experiment import Experiment
from warpwear.measured.friction.events import events_of, laps_of, line_with_error

ruptures = pytest.importorskip("ruptures")


def shares(seeds: range, drift: float = 0.0) -> dict[str, float]:
    """Return how many of made courses have their value within the bands, and their jump within a lap."""
    counts = {"68 %": 0, "95 %": 0, "incubation": 0, "jump": 0}
    for seed in seeds:
        cof, truth = made(seed, drift)
        events = events_of(in_laps(cof))
        assert events.steady is not None
        off = abs(events.steady.value - truth.level)
        counts["68 %"] += off <= events.steady.error
        counts["95 %"] += off <= events.steady.error_95
        if events.jump is not None:
            counts["incubation"] += abs(events.jump.start - truth.start) <= 1.0
            counts["jump"] += abs(events.jump.end - events.jump.start - truth.width) <= 1.0
    return {what: count / len(seeds) for what, count in counts.items()}


@pytest.mark.slow
@pytest.mark.parametrize("drift", [0.0, 0.02, 0.05, 0.15, 0.4])
def test_the_errors_of_200_courses_hold_what_they_say(drift: float) -> None:
    """The table of docs/how-to/your-record.md: what a course comes to, steady or not."""
    found = shares(range(200), drift)
    print(drift, found)
    assert 0.60 <= found["68 %"] <= 0.76
    assert 0.91 <= found["95 %"] <= 0.99
    assert found["incubation"] >= 0.9
    assert found["jump"] >= 0.9


@pytest.mark.parametrize("drift", [0.0, 0.1])
def test_the_errors_of_a_few_courses_hold(drift: float) -> None:
    found = shares(range(40), drift)
    assert 0.5 <= found["68 %"] <= 0.86
    assert found["95 %"] >= 0.85
    assert min(found["incubation"], found["jump"]) >= 0.9


def test_the_error_of_a_line_counts_what_goes_together() -> None:
    """Of first-order noise a mean has the variance σ²/n (1 + φ)/(1 − φ), a line's rise 12 times as much."""
    dice = np.random.default_rng(3)
    rise = np.linspace(-0.5, 0.5, 4000)
    for together in (0.0, 0.5, 0.8):
        errors = []
        for _ in range(50):
            steps = dice.normal(size=5000) * np.sqrt(1.0 - together**2)
            noise = scipy.signal.lfilter([1.0], [1.0, -together], steps)[1000:]
            errors.append(line_with_error(noise + rise))
        expected = np.sqrt((1.0 + together) / (1.0 - together) / 4000.0)
        middles, of_middle, rises, of_rise, _ = np.array(errors).T
        assert of_middle.mean() == pytest.approx(expected, rel=0.06)
        np.testing.assert_allclose(of_rise, np.sqrt(12.0) * of_middle, rtol=1e-3)
        assert np.mean(((rises - 1.0) / of_rise) ** 2) == pytest.approx(1.0, abs=0.5)
        assert np.mean((middles / of_middle) ** 2) == pytest.approx(1.0, abs=0.5)
    assert line_with_error(np.full(30, 0.5))[:2] == (0.5, 0.0)
    assert line_with_error(np.full(30, 0.5))[3:] == (0.0, 30.0)


def test_an_overshoot_is_what_stands_above_the_steady_value() -> None:
    cof = np.concatenate([np.full(40, 0.2), 0.6 + 0.1 * np.exp(-np.arange(400) / 20.0)])
    cof += 0.002 * np.random.default_rng(1).normal(size=cof.size)
    events = events_of(in_laps(cof))
    assert events.steady is not None
    assert events.steady.value == pytest.approx(0.6, abs=0.001)
    assert events.overshoot == pytest.approx(0.1 * np.exp(-np.arange(5) / 20.0).mean(), abs=0.004)
    level = events_of(in_laps(np.where(np.arange(440) < 40, 0.2, 0.6) + 0.002 * np.sin(np.arange(440))))
    assert level.overshoot is None
    assert level.jump is not None
    assert level.jump.start == pytest.approx(39.5 + 0.1, abs=0.2)


def test_a_slow_rise_is_no_jump_and_a_late_one_no_steady_value() -> None:
    place = np.arange(400.0)
    noise = 0.002 * np.random.default_rng(2).normal(size=place.size)
    rise = events_of(in_laps(0.2 + 0.4 * (1.0 - np.exp(-place / 150.0)) + noise))
    assert rise.jump is None
    late = events_of(in_laps(np.where(place < 395, 0.2, 0.6) + noise))
    assert late.steady is None
    ramp = events_of(in_laps(np.where(place < 40, 0.1, 0.4) + 1e-5 * place + 0.02 * noise))
    assert ramp.steady is not None
    assert ramp.steady.share == pytest.approx(0.9, abs=0.02)  # one level, and no stairs
    assert ramp.steady.value == pytest.approx(0.404, abs=1e-5)
    assert ramp.steady.drift > 100.0 * ramp.steady.drift_95  # which is said: it is not steady
    assert ramp.changes[-1] == 40.0
    assert events_of(in_laps(np.full(10, 0.3))).steady is None
    constant = events_of(in_laps(np.full(100, 0.3))).steady
    assert constant is not None
    assert (constant.value, constant.error) == (pytest.approx(0.3), 0.0)


def test_points_are_gathered_in_laps_and_laps_with_few_in_groups() -> None:
    distance = np.arange(0.5, 100.0)
    laps = laps_of(Experiment("a", distance, 0.01 * distance), 10.0)
    np.testing.assert_allclose(laps.distance, np.arange(5.0, 100.0, 10.0))
    np.testing.assert_allclose(laps.cof, 0.01 * laps.distance)
    np.testing.assert_allclose(laps.scatter, 0.01 * np.arange(10).std(ddof=1))
    assert (laps.laps, laps.unit, laps.count(25.0)) == (1.0, "lap", 2.5)
    assert laps_of(Experiment("a", distance, distance), 1.5).laps == 3.0  # of four points and more
    parts = laps_of(Experiment("a", distance, distance), None)
    assert (parts.cof.size, parts.unit, parts.count(1.0)) == (25, "part", None)
    cycles = laps_of(Experiment("a", distance, distance, cycles=np.arange(1.0, 101.0)), None)
    assert (cycles.unit, cycles.length) == ("cycle", 1.0)
