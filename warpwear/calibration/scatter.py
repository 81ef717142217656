"""How tests of one pair scatter, and where the next one will lie: the one scatter of all that has repeats.

    y_i = θ + Σ β_j x_ij + t_i + ε_i,  t ~ N(0, s²),  ε_i ~ N(0, u_i²) with u_i known

For each scatter s of a grid θ and β are generalised least squares, exact; p(s | y) weighs them, and the next
test is a mixture of normal distributions (Gelman, Bayesian Analysis 1 (2006) 515, for the half-normal prior).
"""

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.calibration.measurements import Value
from warpwear.ensembles.datum import Datum
from warpwear.ensembles.ensemble import Curve
from warpwear.grid import FloatArray
from warpwear.measured.friction.analysis import RecordStep

special = lazy.module("scipy.special")

#: Scale of the half-normal prior of the scatter between tests, of logarithms.
PRIOR = 0.5
#: Scatters that are looked at, and their ends in that scale; none at all is one of them.
GRID, ENDS = 120, (1e-3, 6.0)
#: Least uncertainty of a logarithm: what rounding leaves.
ROUNDING = 1e-5
#: Part of the next tests that an interval is to hold.
HELD = 0.90
#: Halvings of an interval for a quantile.
HALVINGS = 60
#: Conditions over which there may be a trend -> their units.
CONDITIONS = {"load": "N", "speed": "mm/s", "radius": "mm", "track_radius": "mm"}


@dataclass(frozen=True)
class Scatter:
    """Hold what several values of one number come to, with the standard uncertainty of each, None if unknown.

    Places of one test come together so, and tests where no next one is asked for.
    """

    values: Sequence[float]
    errors: Sequence[float | None]

    @property
    def mean(self) -> float:
        """Return the mean of the values."""
        return statistics.fmean(self.values)

    @property
    def deviation(self) -> float | None:
        """Return their standard deviation, divided by n − 1; None of a single one."""
        return statistics.stdev(self.values) if len(self.values) > 1 else None

    @property
    def propagated(self) -> float | None:
        """Return the uncertainty of the mean by those of the values; None where one is not known."""
        known = [error for error in self.errors if error is not None]
        return math.hypot(*known) / len(known) if len(known) == len(self.values) else None

    @property
    def error(self) -> float | None:
        """Return the standard uncertainty of the mean: the larger of those by scatter and by the values'."""
        both = self.deviation and self.deviation / math.sqrt(len(self.values)), self.propagated
        return max((error for error in both if error is not None), default=None)

    @property
    def source(self) -> str:
        """Say of several values which of both it is."""
        by_values = self.error is not None and self.error == self.propagated
        return "" if len(self.values) < 2 else f" by {'those of the tests' if by_values else 'their scatter'}"

    @property
    def weighted(self) -> tuple[float, float, float] | None:
        """Return the mean by 1/u², its standard uncertainty, and Birge's ratio.

        They are mean and deviation of the posterior under a flat prior and normal errors; the ratio is how
        much more the values scatter than these say. None of a single one, and where an error is not known.
        """
        values, weights = self.values, [error**-2.0 for error in self.errors if error]
        if not 1 < len(values) == len(weights):
            return None
        total, each = math.fsum(weights), list(zip(values, weights, strict=True))
        mean = math.fsum(w * v for v, w in each) / total
        return (
            mean,
            total**-0.5,
            math.sqrt(math.fsum(w * (v - mean) ** 2 for v, w in each) / (len(values) - 1)),
        )


@dataclass(frozen=True, eq=False)
class ScatterModel:
    """Hold what tests tell of a pair: y, (tests,), their uncertainties, and conditions, (tests, terms).

    The first condition is one. prior: scale of the half-normal prior of the scatter.
    """

    y: FloatArray
    errors: FloatArray
    conditions: FloatArray
    prior: float = PRIOR

    @property
    def is_known(self) -> bool:
        """Tell whether the tests tell all terms apart."""
        return bool(np.linalg.matrix_rank(self.conditions) == self.conditions.shape[1])

    @cached_property
    def _of_grid(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return scatters, their probabilities, and terms with covariances for each."""
        s = np.append(0.0, self.prior * np.geomspace(*ENDS, GRID - 1))
        x, variance = self.conditions, s[:, None] ** 2 + np.maximum(self.errors, ROUNDING) ** 2
        covariance = np.linalg.inv(np.einsum("kn,ni,nj->kij", 1.0 / variance, x, x))
        terms = np.einsum("kij,nj,kn,n->ki", covariance, x, 1.0 / variance, self.y)
        squares = ((self.y - terms @ x.T) ** 2 / variance).sum(axis=1)
        log = (
            np.linalg.slogdet(covariance)[1] - np.log(variance).sum(axis=1) - squares - (s / self.prior) ** 2
        )
        weights = np.exp(0.5 * (log - log.max())) * np.gradient(s)
        return s, weights / weights.sum(), terms, covariance

    @property
    def scatter(self) -> tuple[float, float, float]:
        """Return median, 5th and 95th percentile of the scatter between tests."""
        s, weights, *_ = self._of_grid
        below = np.cumsum(weights) - 0.5 * weights
        median, low, high = np.interp([0.5, 0.5 - 0.5 * HELD, 0.5 + 0.5 * HELD], below, s)
        return float(median), float(low), float(high)

    def mean(self, at: FloatArray) -> tuple[float, float]:
        """Return the mean of all tests under conditions, (terms,), and its standard uncertainty."""
        return self._moments(at, None)

    def next(self, at: FloatArray, error: float) -> tuple[float, float]:
        """Return mean and deviation of the next test. error: its measurement's standard uncertainty."""
        return self._moments(at, error)

    def interval(self, at: FloatArray, error: float, held: float = HELD) -> tuple[float, float]:
        """Return the ends between which the next test lies with the probability `held`."""
        weights, (means, variances) = self._of_grid[1], self._mixture(at, error)
        sides, wanted = np.sqrt(variances), np.array([0.5 - 0.5 * held, 0.5 + 0.5 * held])
        low, high = (np.full(2, f) for f in ((means - 9.0 * sides).min(), (means + 9.0 * sides).max()))
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            below = special.ndtr((middle[:, None] - means) / sides) @ weights < wanted
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return float(low[0]), float(low[1])

    def _mixture(self, at: FloatArray, error: float | None) -> tuple[FloatArray, FloatArray]:
        """Return means and variances for each scatter, (grid,); error None: of the mean of all tests."""
        s, _, terms, covariance = self._of_grid
        variances = np.einsum("i,kij,j->k", at, covariance, at)
        return terms @ at, variances if error is None else variances + s**2 + max(error, ROUNDING) ** 2

    def _moments(self, at: FloatArray, error: float | None) -> tuple[float, float]:
        weights, (means, variances) = self._of_grid[1], self._mixture(at, error)
        mean = float(weights @ means)
        return mean, math.sqrt(float(weights @ (variances + (means - mean) ** 2)))

    def without(self, test: int) -> "ScatterModel":
        """Leave a test out."""
        kept: Any = np.arange(self.y.size) != test
        return ScatterModel(self.y[kept], self.errors[kept], self.conditions[kept], self.prior)


def count_needed(scatter: float, wanted: float) -> int:
    """Return how many tests bring the standard error of a mean to a part of it, at a scatter in parts."""
    return max(1, math.ceil((scatter / wanted) ** 2 * (1.0 - 1e-9)))


@dataclass(frozen=True, eq=False)
class PairTest:
    """A test of a pair: its conditions, its numbers with their errors, and its course of friction [m].

    Conditions are those of `CONDITIONS`, distance and length of the track [mm], where they are known. Numbers
    of a part under one load of several end in that: "level at 5 N".
    """

    name: str
    conditions: Mapping[str, float]
    values: Mapping[str, Value]
    course: Curve | None = None
    laps: float | None = None  # of the incubation
    notes: tuple[str, ...] = ()
    steps: tuple[RecordStep, ...] = ()


@dataclass(frozen=True, eq=False)
class RepeatedNumber:
    """One number of several tests. over: conditions of its trend; at: those of the next test."""

    kind: str
    tests: tuple[PairTest, ...]
    over: tuple[str, ...]
    at: Mapping[str, float]
    label: str = ""
    unit: str = ""

    @cached_property
    def values(self) -> FloatArray:
        """Return the measured numbers, (tests,)."""
        return np.array([test.values[self.kind].value for test in self.tests])

    @cached_property
    def scale(self) -> float | None:
        """Return the unit of numbers that are no logarithms, as some are zero; else None."""
        return None if self.values.min() > 0.0 else float(self.values.mean())

    @cached_property
    def pair(self) -> ScatterModel:
        """Return what the tests tell of the pair, in logarithms or in `scale`."""
        errors = np.array([test.values[self.kind].error or 0.0 for test in self.tests])
        y = np.log(self.values) if self.scale is None else self.values / self.scale
        x = np.array([self.place(test.conditions) for test in self.tests])
        return ScatterModel(y, errors / (self.values if self.scale is None else self.scale), x)

    def place(self, conditions: Mapping[str, float]) -> FloatArray:
        """Return conditions of a test as those of `ScatterModel`: logarithms over those of the next test."""
        return np.array([1.0, *(math.log(conditions[name] / self.at[name]) for name in self.over)])

    def back(self, y: float) -> float:
        """Return a number in its unit."""
        return math.exp(y) if self.scale is None else max(0.0, y * self.scale)

    def size(self, y: float) -> float:
        """Return what an error of `ScatterModel` is in the unit of the number."""
        return self.back(y) if self.scale is None else self.scale

    @cached_property
    def next(self) -> FloatArray:
        """Return the conditions of the next test, of which every trend is taken from there."""
        return self.place(self.at)

    @cached_property
    def corrected(self) -> Scatter:
        """Return the numbers of the tests as if all were made under the next one's conditions."""
        slopes = [self.pair.mean(row)[0] for row in np.eye(self.next.size)[1:]]
        shift = self.pair.conditions[:, 1:] @ np.array(slopes)
        values = [self.back(float(y)) for y in self.pair.y - shift] if self.over else self.values.tolist()
        return Scatter(values, [test.values[self.kind].error for test in self.tests])

    @property
    def s(self) -> float | None:
        """Return the standard deviation of the tests about their mean, or trend; None of too few."""
        free, deviation = len(self.tests) - self.next.size, self.corrected.deviation
        return None if free < 1 or deviation is None else deviation * math.sqrt((len(self.tests) - 1) / free)

    @property
    def interval(self) -> tuple[float, float]:
        """Return where the next test lies."""
        low, high = self.pair.interval(self.next, float(np.median(self.pair.errors)))
        return self.back(low), self.back(high)

    @cached_property
    def data(self) -> list[tuple[Datum, bool]]:
        """Set each test beside what the others say of it, and whether it lies in their interval."""
        rows = []
        for number, (test, value) in enumerate(zip(self.tests, self.values.tolist(), strict=True)):
            others, x, u = self.pair.without(number), self.pair.conditions[number], self.pair.errors[number]
            if others.is_known:
                mean, deviation = others.next(x, u)
                computed, off = self.back(mean), (self.pair.y[number] - mean) / deviation
                low, high = (self.back(end) for end in others.interval(x, u))
                error = float((value - computed) / off) if off else self.size(mean) * deviation
                name = ", ".join(filter(None, (test.name, self.label)))
                rows.append((Datum(name, value, computed, error, self.unit), low <= value <= high))
        return rows

    def numbers(self, wanted: float) -> dict[str, Any]:
        """Return all that is told of it. wanted: error of the mean as a part of it."""
        scatter, trend = self.pair.scatter, np.eye(self.next.size)[1:]
        mean, deviation = self.pair.mean(self.next)
        each = float(np.median(self.pair.errors))
        needed, most = (count_needed(math.hypot(s, each), wanted) for s in (scatter[0], scatter[2]))
        return {
            "unit": self.unit,
            "mean": self.corrected.mean,
            "s": self.s,
            "n": len(self.tests),
            "pair": self.back(mean),
            "pair_error": self.size(mean) * deviation,
            "scatter": dict(zip(("median", "low", "high"), scatter, strict=True)),
            "next_low": self.interval[0],
            "next_high": self.interval[1],
            "at": {name: self.at[name] for name in self.over},
            "trend": {name: self.pair.mean(row) for name, row in zip(self.over, trend, strict=True)},
            "tests_needed": needed,
            "tests_needed_at_most": most,
            "left_out_within": sum(within for _, within in self.data),
            "left_out": len(self.data),
        }
