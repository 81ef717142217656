"""The scatter between tests: coverage of the next one, closed forms, and integration in another way."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from warpwear.calibration.scatter import PRIOR, Scatter, ScatterModel, count_needed

ONE = np.ones(1)
#: Tests, scatter between them, and next tests that the interval of 90 % holds [%].
TABLE = ((2, 0.3, 96), (3, 0.3, 93), (9, 0.3, 91), (2, 0.1, 100), (3, 0.1, 99), (9, 0.1, 90))
ERROR = 0.05


def held(tests: int, scatter: float, cases: int) -> float:
    """Next tests in their interval [%]; the cases' first numbers are alike whatever their count."""
    dice = np.random.default_rng(0)
    inside = 0
    for _ in range(cases):
        y = dice.normal(0.0, math.hypot(scatter, ERROR), tests + 1)
        low, high = ScatterModel(y[:-1], np.full(tests, ERROR), np.ones((tests, 1))).interval(ONE, ERROR)
        inside += low < y[-1] < high
    return 100.0 * inside / cases


@pytest.mark.parametrize(("tests", "scatter", "wanted"), TABLE)
def test_intervals_hold_the_next_test(tests: int, scatter: float, wanted: int) -> None:
    assert held(tests, scatter, 300) == pytest.approx(wanted, abs=5.0)


@pytest.mark.slow
@pytest.mark.parametrize(("tests", "scatter", "wanted"), TABLE)
def test_intervals_hold_the_next_test_of_many(tests: int, scatter: float, wanted: int) -> None:
    found = held(tests, scatter, 2000)
    print(f"{tests} tests, scatter {scatter:g}: {found:.1f} %")
    assert found == pytest.approx(wanted, abs=3.0)


def by_integration(y: np.ndarray, u: np.ndarray) -> tuple[float, float, float, float]:
    """Mean and ends of the next test, of θ its deviation: the posterior of (θ, s) on a plain grid."""
    s = np.linspace(0.0, 6.0 * PRIOR, 801)[1:]
    theta = np.linspace(y.mean() - 6.0, y.mean() + 6.0, 801)
    log = -0.5 * (s[:, None] / PRIOR) ** 2 + np.zeros(theta.size)
    for value, error in zip(y, u, strict=True):
        log += stats.norm.logpdf(value, theta, np.hypot(s, error)[:, None])
    joint = np.exp(log - log.max())
    joint /= joint.sum()
    mean = float(joint.sum(axis=0) @ theta)
    deviation = math.sqrt(float(joint.sum(axis=0) @ (theta - mean) ** 2))
    side = np.hypot(s, float(np.median(u)))
    at = np.linspace(mean - 4.0, mean + 4.0, 801)
    gaps, widths = at - mean, side[::4, None]  # the next test about θ, where θ is the mean, moved by θ − mean
    coarse = np.array([np.interp(at, theta, row) for row in joint[::4]])
    spread = np.exp(-0.5 * (gaps / widths) ** 2) / widths
    density = sum(np.convolve(row, kernel, mode="same") for row, kernel in zip(coarse, spread, strict=True))
    low, high = np.interp([0.05, 0.95], np.cumsum(density) / density.sum(), at)
    return mean, deviation, float(low), float(high)


@pytest.mark.parametrize("seed", range(20))
def test_a_plain_grid_says_the_same(seed: int) -> None:
    """An independent sum over θ and s, neither integrated out."""
    dice = np.random.default_rng(seed)
    tests, scatter = int(dice.integers(2, 8)), float(dice.uniform(0.05, 0.5))
    u = dice.uniform(0.02, 0.15, tests)
    y = dice.normal(0.0, np.hypot(scatter, u))
    pair = ScatterModel(y, u, np.ones((tests, 1)))
    mean, deviation, low, high = by_integration(y, u)
    found = pair.mean(ONE)
    assert found[0] == pytest.approx(mean, abs=0.02 * deviation)
    assert found[1] == pytest.approx(deviation, rel=0.02)
    ends = pair.interval(ONE, float(np.median(u)))
    assert ends == pytest.approx((low, high), abs=0.02 * (high - low))


@pytest.mark.parametrize(
    "seed", [*range(5), *(pytest.param(n, marks=pytest.mark.slow) for n in range(5, 20))]
)
def test_a_plain_grid_says_the_same_of_a_trend(seed: int) -> None:
    """An independent sum over mean, slope and scatter: the mean under another load, and the slope."""
    dice = np.random.default_rng(100 + seed)
    tests, scatter = int(dice.integers(4, 9)), float(dice.uniform(0.05, 0.4))
    u, x = dice.uniform(0.02, 0.1, tests), np.log(dice.choice([2.0, 5.0, 10.0], tests))
    x = np.where(np.arange(tests) < 2, np.log([2.0, 10.0] * tests)[:tests], x)
    y = -0.4 * x + dice.normal(0.0, np.hypot(scatter, u))
    slope, start = np.polyfit(x - x.mean(), y, 1)
    s = np.linspace(0.0, 6.0 * PRIOR, 301)[1:, None, None]
    wide = 8.0 * max(scatter, 0.15)
    theta = np.linspace(start - wide, start + wide, 121)[:, None]
    beta = np.linspace(slope - 1.5 * wide, slope + 1.5 * wide, 121)
    log = -0.5 * (s / PRIOR) ** 2 + np.zeros((1, 121, 121))
    for value, error, place in zip(y, u, x - x.mean(), strict=True):
        log += stats.norm.logpdf(value, theta + beta * place, np.hypot(s, error))
    joint = np.exp(log - log.max()).sum(axis=0)
    joint /= joint.sum()
    pair = ScatterModel(y, u, np.column_stack([np.ones(tests), x - x.mean()]))
    at = float(np.log(20.0) - x.mean())
    for row, values in (([0.0, 1.0], beta + 0.0 * theta), ([1.0, at], theta + at * beta)):
        mean = float((joint * values).sum())
        deviation = math.sqrt(float((joint * (values - mean) ** 2).sum()))
        found = pair.mean(np.array(row))
        assert found[0] == pytest.approx(mean, abs=0.02 * deviation)
        assert found[1] == pytest.approx(deviation, rel=0.02)


def test_no_scatter_is_the_mean_by_the_errors() -> None:
    """s → 0: mean and error by 1/u², and of the next test their and its own error."""
    y, u = np.array([1.0, 1.2, 0.9, 1.1]), np.array([0.1, 0.2, 0.15, 0.05])
    pair = ScatterModel(y, u, np.ones((4, 1)), prior=1e-9)
    weighted = Scatter(y.tolist(), u.tolist()).weighted
    assert weighted is not None
    assert pair.mean(ONE) == pytest.approx(weighted[:2], rel=1e-6)
    side = stats.norm.ppf(0.95) * math.hypot(weighted[1], 0.1)
    assert pair.interval(ONE, 0.1) == pytest.approx((weighted[0] - side, weighted[0] + side), rel=1e-6)
    assert pair.scatter[2] < 1e-8


def test_many_tests_show_their_scatter() -> None:
    y = np.random.default_rng(3).normal(0.0, 0.2, 400)
    pair = ScatterModel(y, np.zeros(400), np.ones((400, 1)))
    assert pair.scatter[0] == pytest.approx(y.std(), rel=0.01)
    side = stats.norm.ppf(0.95) * y.std()
    assert pair.interval(ONE, 0.0) == pytest.approx((y.mean() - side, y.mean() + side), abs=0.01)


def test_a_trend_is_least_squares() -> None:
    """Of one error the terms are those of a line, whatever the scatter is."""
    x = np.log([2.0, 2.0, 5.0, 5.0, 10.0, 10.0])
    y = 0.3 - 0.7 * x + np.array([0.02, -0.01, 0.03, 0.0, -0.02, 0.01])
    pair = ScatterModel(y, np.full(6, 0.02), np.column_stack([np.ones(6), x]))
    slope, start = np.polyfit(x, y, 1)
    assert [pair.mean(row)[0] for row in np.eye(2)] == pytest.approx([start, slope])
    assert pair.next(np.array([1.0, math.log(20.0)]), 0.02)[1] > pair.next(np.array([1.0, x.mean()]), 0.02)[1]
    assert not ScatterModel(y[:2], y[:2], pair.conditions[:2]).is_known


def test_one_test_tells_no_more_than_the_prior() -> None:
    """The next of a single one: both scatter, by the half-normal prior, integrated by quadrature."""
    low, high = ScatterModel(np.zeros(1), np.array([0.05]), np.ones((1, 1))).interval(ONE, 0.05)
    outside, _ = integrate.quad(
        lambda s: (
            2.0 * stats.norm.pdf(s, 0.0, PRIOR) * stats.norm.cdf(low / math.sqrt(2.0) / math.hypot(s, 0.05))
        ),
        0.0,
        6.0 * PRIOR,
    )
    assert -low == pytest.approx(high)
    assert outside == pytest.approx(0.05, abs=0.002)


@pytest.mark.parametrize(
    ("scatter", "tests"), [(0.1, 4), (0.2, 16), (0.23, 22), (0.3, 36), (0.5, 100), (0.001, 1)]
)
def test_tests_needed_for_five_percent(scatter: float, tests: int) -> None:
    assert count_needed(scatter, 0.05) == tests


@pytest.mark.parametrize(
    ("values", "errors", "error", "source"),
    [
        ((0.0180, 0.0181), (0.003, 0.003), 0.003 / math.sqrt(2.0), " by those of the tests"),
        ((1.0, 1.0), (0.1, 0.2), math.hypot(0.1, 0.2) / 2.0, " by those of the tests"),
        ((1.0, 2.0), (0.1, 0.2), 0.5, " by their scatter"),
        ((1.0, 2.0), (None, 0.2), 0.5, " by their scatter"),
        ((1.0,), (0.2,), 0.2, ""),
        ((1.0,), (None,), None, ""),
    ],
)
def test_a_mean_is_as_uncertain_as_scatter_or_errors_say(values, errors, error, source) -> None:  # type: ignore[no-untyped-def]
    found = Scatter(values, errors)
    assert found.error == (None if error is None else pytest.approx(error))
    assert found.source == source
