"""A Gaussian process between the runs of a design: courses by principal components, with their variance.

The mean is linear in the inputs, the covariance Matérn's with ν = 5/2 and a length for each input; both after
Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sections 2.7, 4.2 and 5.4.
"""

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

linalg, optimize = lazy.module("scipy.linalg"), lazy.module("scipy.optimize")

#: Part of the variance between runs that the components leave out.
LEFT_OUT = 1e-7
#: Most components of a course.
MOST_COMPONENTS = 8
#: Bounds of the logarithms of length scales, in standard deviations of the input, and of the nugget.
LENGTHS, NUGGETS = (math.log(0.2), math.log(30.0)), (math.log(1e-8), math.log(0.5))
#: Starting lengths of the search for the best ones.
STARTS = (0.7, 3.0)


@dataclass(eq=False)
class GaussianProcess:
    """One number over inputs: places (runs, inputs), values (runs,)."""

    places: FloatArray
    values: FloatArray
    _logs: FloatArray = field(init=False)  # of the length scales and the nugget

    def __post_init__(self) -> None:
        inputs = self.places.shape[1]
        bounds = [LENGTHS] * inputs + [NUGGETS]
        starts = [np.append(np.full(inputs, math.log(length)), math.log(1e-4)) for length in STARTS]
        fits = [optimize.minimize(self._misfit, start, bounds=bounds, method="L-BFGS-B") for start in starts]
        self._logs = min(fits, key=lambda fit: float(fit.fun)).x
        self._solve(self._logs)
        self.lengths, self.nugget = np.exp(self._logs[:-1]), math.exp(self._logs[-1])

    @property
    def left_out(self) -> tuple[FloatArray, FloatArray]:
        """Error and its expected variance of every run, predicted from the others, both (runs,).

        Closed form with the lengths of all runs (Dubrule, Mathematical Geology 15, 1983, 687).
        """
        basis, weighted = self._basis, linalg.cho_solve(self._factor, self._basis)
        inverse = linalg.cho_solve(self._factor, np.eye(self.values.size))
        inverse -= weighted @ np.linalg.solve(basis.T @ weighted, weighted.T)
        diagonal = np.diag(inverse)
        return inverse @ self.values / diagonal, self.scale / diagonal

    @property
    def numbers(self) -> tuple[Any, ...]:
        """Return what predicts: R⁻¹, R⁻¹ times the basis, C, R⁻¹ times the values, and what was fitted.

        R Rᵀ is the covariance of the runs, (runs, runs), C Cᵀ that of the trend, (terms, terms). The second
        has the shape (runs, terms), the fourth (runs,).
        """
        count = self.values.size
        whitened = np.column_stack([np.eye(count), self._basis, self.values])
        whitened = linalg.solve_triangular(self._factor[0], whitened, lower=True)
        trend = np.linalg.cholesky(np.linalg.inv(self._of_trend))
        factors = whitened[:, :count], whitened[:, count:-1], trend, whitened[:, -1]
        return *factors, self.lengths, [self.nugget], self.trend, [self.scale]

    def _solve(self, logs: FloatArray) -> float:
        """Solve with length scales and nugget; return the logarithm of the likelihood."""
        self._logs = logs
        count = self.values.size
        among = _correlation(self.places, self.places, np.exp(logs[:-1])) + math.exp(logs[-1]) * np.eye(count)
        among[np.diag_indices(count)] += 1e-10
        self._factor = linalg.cho_factor(among, lower=True)
        self._basis = np.column_stack([np.ones(count), self.places])
        weighted = linalg.cho_solve(self._factor, self._basis)
        self._of_trend = self._basis.T @ weighted
        self.trend = np.linalg.solve(self._of_trend, weighted.T @ self.values)
        rest = self.values - self._basis @ self.trend
        self.freedom = count - self._basis.shape[1]
        self.scale = max(float(rest @ linalg.cho_solve(self._factor, rest)) / self.freedom, 1e-300)
        determinants = 2.0 * np.log(np.diag(self._factor[0])).sum() + np.linalg.slogdet(self._of_trend)[1]
        return -0.5 * (self.freedom * math.log(self.scale) + float(determinants))

    def _misfit(self, logs: FloatArray) -> float:
        """Return minus the logarithm of the likelihood; very much where the covariance has no root."""
        try:
            return -self._solve(logs)
        except np.linalg.LinAlgError:
            return 1e10


@dataclass(eq=False)
class Emulator:
    """A course over inputs: places (runs, inputs), positive courses (runs, points), of one run a constant.

    They are emulated by their logarithms; `together` takes others. Errors larger than expected widen the
    variance. scatter: standard deviation of what no component holds, (points,), of each point on its own.
    """

    places: FloatArray
    courses: FloatArray

    def __post_init__(self) -> None:
        self.logarithmic, scaled = True, np.log(self.courses)
        self.mean = scaled.mean(axis=0)
        self.shapes = np.zeros((0, self.mean.size))
        self._processes: list[GaussianProcess] = []
        self.error, self._wider, self.scatter = 0.0, np.zeros(0), np.zeros(self.mean.size)
        varying = scaled - self.mean
        if len(scaled) == 1 or not np.ptp(varying, axis=0).max() > 1e-12 * max(1.0, np.abs(scaled).max()):
            return
        _, sizes, shapes = np.linalg.svd(varying, full_matrices=False)
        part = np.cumsum(sizes**2) / np.sum(sizes**2)
        count = min(int(np.searchsorted(part, 1.0 - LEFT_OUT)) + 1, MOST_COMPONENTS)
        self.shapes = shapes[:count]
        weights = varying @ self.shapes.T
        freedom = max(len(scaled) - 1 - count, 1)
        self.scatter = np.sqrt(np.sum((varying - weights @ self.shapes) ** 2, axis=0) / freedom)
        self._processes = [GaussianProcess(self.places, column) for column in weights.T]
        self._stacked = [np.stack(some) for some in zip(*(p.numbers for p in self._processes), strict=True)]
        errors, variances = map(np.array, zip(*(p.left_out for p in self._processes), strict=True))
        self._wider = np.maximum(1.0, np.mean(errors**2 / variances, axis=1))
        predicted = self.mean + (weights - errors.T) @ self.shapes
        self.error = float(np.sqrt(np.mean((predicted - scaled) ** 2)))

    @classmethod
    def together(cls, places: FloatArray, courses: Sequence[FloatArray]) -> list["Emulator"]:
        """Emulate several courses of the same runs, each (runs, points): one a course, of the same weights.

        What one surface adds to a course it adds to the others, so their errors are shared.
        """
        positive = [bool((course > 0.0).all()) for course in courses]
        sizes = [
            1.0 if log else max(float(np.abs(c).max()), 1e-300)
            for c, log in zip(courses, positive, strict=True)
        ]
        plain = [
            c if log else np.exp(c / size) for c, log, size in zip(courses, positive, sizes, strict=True)
        ]
        whole = cls(places, np.concatenate(plain, axis=1))
        parts, end = [], 0
        for course, log, size in zip(courses, positive, sizes, strict=True):
            part, rows = copy(whole), slice(end, end := end + course.shape[1])
            part.courses, part.logarithmic, part.mean = course, log, size * whole.mean[rows]
            part.shapes, part.scatter = size * whole.shapes[:, rows], size * whole.scatter[rows]
            parts.append(part)
        return parts

    def weights(self, places: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Predict weights of the shapes and their variances at places (n, inputs), both (n, shapes)."""
        if not self._processes:
            return np.zeros((len(places), 0)), np.zeros((len(places), 0))
        among, basis, trend, values, lengths, nuggets, trends, scales = self._stacked
        near = _correlation(places, self.places, lengths[:, None, None]) @ among.transpose(0, 2, 1)
        rest = np.column_stack([np.ones(len(places)), places]) - near @ basis
        mean = (near @ values[..., None] + rest @ trends[..., None])[..., 0]
        variance = 1.0 + nuggets - np.sum(near**2, axis=-1) + np.sum((rest @ trend) ** 2, axis=-1)
        return mean.T, (scales * np.maximum(variance, 0.0)).T * self._wider


def _correlation(first: FloatArray, second: FloatArray, lengths: FloatArray) -> FloatArray:
    """Return Matérn's correlations of places (n, inputs) and (m, inputs), (…, n, m)."""
    apart = (first[:, None, :] - second[None, :, :]) / lengths
    r = math.sqrt(5.0) * np.sqrt(np.sum(apart**2, axis=-1))
    return np.asarray((1.0 + r + r**2 / 3.0) * np.exp(-r))
