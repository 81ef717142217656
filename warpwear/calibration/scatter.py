"""How tests of one pair scatter, and where the next one will lie: the one scatter of all that has repeats.

    y_i = θ + Σ β_j x_ij + t_i + ε_i,  t ~ N(0, s²),  ε_i ~ N(0, u_i²) with u_i known

For each scatter s of a grid θ and β are generalised least squares, exact; p(s | y) weighs them, and the next
test is a mixture of normal distributions (Gelman, Bayesian Analysis 1 (2006) 515, for the half-normal prior).
"""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

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
