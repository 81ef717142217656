"""A Gaussian process between the runs of a design: courses by their principal components, with their
variance.

The mean is linear in the inputs, the covariance Matérn's with ν = 5/2 and a length for each input; both after
Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sections 2.7, 4.2 and 5.4.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

linalg, optimize = lazy.module("scipy.linalg"), lazy.module("scipy.optimize")

#: Part of the variance between runs that the components leave out.
LEFT_OUT = 1e-5
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
        found = [optimize.minimize(self._misfit, start, bounds=bounds, method="L-BFGS-B") for start in starts]
        self._logs = min(found, key=lambda fit: float(fit.fun)).x
        self._solve(self._logs)

    @property
    def left_out(self) -> tuple[FloatArray, FloatArray]:
        """Error and its expected variance of every run, predicted from the others, both (runs,).

        Closed form with the lengths of all runs (Dubrule, Mathematical Geology 15, 1983, 687).
        """
        basis, weighted = self._basis, linalg.cho_solve(self._factor, self._basis)
        inverse = linalg.cho_solve(self._factor, np.eye(self.values.size))
        inverse -= weighted @ np.linalg.solve(basis.T @ weighted, weighted.T)
        diagonal = np.diag(inverse)
        return inverse @ self.values / diagonal, self._scale / diagonal

    def at(self, places: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean and variance at places (n, inputs), both (n,)."""
        near = self._correlation(places, self.places)
        basis = np.column_stack([np.ones(len(places)), places])
        mean = basis @ self._trend + near @ self._weights
        solved = linalg.cho_solve(self._factor, near.T)
        rest = basis.T - self._basis.T @ solved
        of_trend = np.einsum("in,in->n", rest, np.linalg.solve(self._of_trend, rest))
        variance = 1.0 + math.exp(self._logs[-1]) - np.einsum("ni,in->n", near, solved) + of_trend
        return mean, self._scale * np.maximum(variance, 0.0)

    def _correlation(self, first: FloatArray, second: FloatArray) -> FloatArray:
        apart = (first[:, None, :] - second[None, :, :]) / np.exp(self._logs[:-1])
        r = math.sqrt(5.0) * np.sqrt(np.maximum(np.sum(apart**2, axis=-1), 0.0))
        return np.asarray((1.0 + r + r**2 / 3.0) * np.exp(-r))

    def _solve(self, logs: FloatArray) -> float:
        """Solve with length scales and nugget; return the logarithm of the likelihood."""
        self._logs = logs
        count = self.values.size
        among = self._correlation(self.places, self.places) + math.exp(logs[-1]) * np.eye(count)
        among[np.diag_indices(count)] += 1e-10
        self._factor = linalg.cho_factor(among, lower=True)
        self._basis = np.column_stack([np.ones(count), self.places])
        weighted = linalg.cho_solve(self._factor, self._basis)
        self._of_trend = self._basis.T @ weighted
        self._trend = np.linalg.solve(self._of_trend, weighted.T @ self.values)
        rest = self.values - self._basis @ self._trend
        self._weights = linalg.cho_solve(self._factor, rest)
        freedom = count - self._basis.shape[1]
        self._scale = max(float(rest @ self._weights) / freedom, 1e-300)
        determinants = 2.0 * np.log(np.diag(self._factor[0])).sum() + np.linalg.slogdet(self._of_trend)[1]
        return -0.5 * (freedom * math.log(self._scale) + float(determinants))

    def _misfit(self, logs: FloatArray) -> float:
        try:
            return -self._solve(logs)
        except np.linalg.LinAlgError:
            return 1e10


@dataclass(eq=False)
class Emulator:
    """A course over inputs: places (runs, inputs), courses (runs, points), of one run a constant.

    Positive courses are emulated by their logarithms. Errors larger than expected widen the variance.
    """

    places: FloatArray
    courses: FloatArray

    def __post_init__(self) -> None:
        self.logarithmic = bool((self.courses > 0.0).all())
        scaled = np.log(self.courses) if self.logarithmic else self.courses
        self.mean = scaled.mean(axis=0)
        self.shapes = np.zeros((0, self.mean.size))
        self._processes: list[GaussianProcess] = []
        self.error, self._wider = 0.0, np.zeros(0)
        varying = scaled - self.mean
        if len(scaled) == 1 or not np.ptp(varying, axis=0).max() > 1e-12 * max(
            1.0, float(np.abs(scaled).max())
        ):
            return
        _, sizes, shapes = np.linalg.svd(varying, full_matrices=False)
        part = np.cumsum(sizes**2) / np.sum(sizes**2)
        count = min(int(np.searchsorted(part, 1.0 - LEFT_OUT)) + 1, MOST_COMPONENTS)
        self.shapes = shapes[:count]
        weights = varying @ self.shapes.T
        self._processes = [GaussianProcess(self.places, column) for column in weights.T]
        found = [process.left_out for process in self._processes]
        errors = np.column_stack([errors for errors, _ in found])
        self._wider = np.array([max(1.0, float(np.mean(e**2 / v))) for e, v in found])
        predicted = self.mean + (weights - errors) @ self.shapes
        if self.logarithmic:
            self.error = float(np.sqrt(np.mean((predicted - scaled) ** 2)))
        else:
            self.error = float(np.sqrt(np.mean((predicted - scaled) ** 2)) / np.abs(scaled).max())

    def weights(self, places: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weights of the shapes and their variances at places (n, inputs), both (n, shapes)."""
        if not self._processes:
            return np.zeros((len(places), 0)), np.zeros((len(places), 0))
        found = [process.at(places) for process in self._processes]
        return np.column_stack([m for m, _ in found]), np.column_stack([v for _, v in found]) * self._wider
