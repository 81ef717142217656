"""How likely measurements are, for many values of the unknowns at once; what is linear is integrated.

Residuals of a course of friction go together: r_{i+1} = r_i e^(−ΔL/ℓ) + noise, the first order autoregression
of any spacing (Ornstein and Uhlenbeck). Repeated tests differ in their level too. What an emulator does not
know, levels of repeats, and strengths with a normal prior are linear: they are integrated out (Woodbury's
identity). Areas of whole cells scatter on their own from point to point: with them the residuals are whitened
by the innovations of Kalman's filter.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from warpwear.calibration.bayes.data import Data
from warpwear.calibration.bayes.model import ForwardModel
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.grid import FloatArray
from warpwear.laws.friction import FILM_STRENGTH, PLOUGHING, STATES, STRENGTH

#: Keys that friction is linear in.
LINEAR = tuple(f"friction.{key}" for key in (PLOUGHING, STRENGTH, FILM_STRENGTH, *STATES))
#: Scatter of areas, as a part of them, that is rounding.
EXACT = 1e-9
#: Correlation lengths beyond which residuals are independent to the last digit.
INDEPENDENT = 40.0


@dataclass(eq=False)
class Posterior:
    """The unknowns of a model and of the scatter, given data.

    closed_form: whether linear unknowns with a normal prior are integrated out; else all are sampled.
    """

    model: ForwardModel
    noise: tuple[Unknown, ...]
    data: Data
    closed_form: bool = True

    @cached_property
    def linear(self) -> tuple[Unknown, ...]:
        """Unknowns that are found in closed form."""
        if not self.closed_form:
            return ()
        # else the strength decides how uncertain a coefficient is
        exact = self.model.error == 0.0 and self.model.scatter <= EXACT
        in_closed_form = LINEAR if exact else LINEAR[:1]
        known = [u for u in self.model.unknowns if u not in self.model.runs.inputs]
        return tuple(u for u in known if u.key in in_closed_form and u.is_normal)

    @cached_property
    def sampled(self) -> tuple[Unknown, ...]:
        """Unknowns that are sampled, those of the scatter last."""
        return (*(u for u in self.model.unknowns if u not in self.linear), *self.noise)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Return all unknowns, in the order of `values`."""
        return (*self.model.unknowns, *self.noise)

    def values(self, z: FloatArray) -> dict[str, FloatArray]:
        """Turn standard normal numbers (samples, sampled) into key -> values (samples,)."""
        return {u.key: u.values(z[:, place]) for place, u in enumerate(self.sampled)}

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return the log of the density of standard normal numbers (samples, sampled), but for a constant."""
        with np.errstate(all="ignore"):
            density = -0.5 * np.sum(z**2, axis=1) + self.log_likelihood(z)
        return np.where(np.isfinite(density), density, -np.inf)

    def log_likelihood(self, z: FloatArray) -> FloatArray:
        """Return the logarithm of the likelihood, (samples,)."""
        known = self._with_linear(self.values(z), len(z))
        logs = np.where(self.model.allowed(known), 0.0, -np.inf)
        for measured in self.data.values:
            mean, variance = self.model.value(known, measured.kind)
            variance = variance + measured.error**2
            logs = logs - 0.5 * ((measured.value - mean) ** 2 / variance + np.log(variance))
        if self.data.distance.size:
            residual, columns, logarithm = self._whitened(known)
            logs = logs - logarithm - 0.5 * np.einsum("sn,sn->s", residual, residual)
            if columns.shape[1]:
                inner, right = _products(columns, residual)
                solved = np.linalg.solve(inner, right)
                logs += 0.5 * (np.sum(right * solved, axis=(1, 2)) - np.linalg.slogdet(inner)[1])
        return np.asarray(logs)

    def complete(
        self, z: FloatArray, random: np.random.Generator
    ) -> tuple[dict[str, FloatArray], FloatArray]:
        """Draw what is linear beside sampled numbers; return all values, and z of (samples, unknowns)."""
        values = self.values(z)
        drawn = np.zeros((len(z), 0))
        if self.linear:
            drawn = random.standard_normal((len(z), len(self.linear)))
            if self.data.distance.size:
                residual, columns, _ = self._whitened(self._with_linear(values, len(z)))
                inner, right = _products(columns, residual)
                spread = np.linalg.inv(inner)
                mean = (spread @ right)[..., 0]
                count = len(self.linear)
                root = np.linalg.cholesky(spread[:, :count, :count])
                drawn = mean[:, :count] + np.einsum("spq,sq->sp", root, drawn)
            values |= {u.key: u.values(drawn[:, place]) for place, u in enumerate(self.linear)}
        by_key = {u.key: z[:, place] for place, u in enumerate(self.sampled)}
        by_key |= {u.key: drawn[:, place] for place, u in enumerate(self.linear)}
        ordered = [u.key for u in self.unknowns]
        return {key: values[key] for key in ordered}, np.column_stack([by_key[key] for key in ordered])

    def _with_linear(self, values: dict[str, FloatArray], count: int) -> dict[str, FloatArray]:
        """Return values with the prior means of what is linear, all (count,)."""
        return values | {u.key: np.full(count, u.prior.first) for u in self.linear}

    def _whitened(self, values: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return residuals (samples, points) and lines of unit normal unknowns (samples, lines, points).

        Both are divided by the noise, so that it is one; the third is the logarithm of what divided them,
        (samples,). Linear unknowns come first.
        """
        friction = self.model.friction(values, self.data.distance)
        mean = sum(self.model.number(values, key)[:, None] * term for key, term in friction.terms.items())
        residual = self.data.cof - np.asarray(mean)
        linear = [(friction.terms[u.key] * u.prior.second)[:, None] for u in self.linear]
        stacked = np.concatenate([residual[:, None], *linear, self._shared(values, friction.errors)], axis=1)
        logarithm = self._divide(values, stacked, friction.scatter)
        return stacked[:, 0], stacked[:, 1:], logarithm

    def whiten(self, values: dict[str, FloatArray], slopes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return slopes of the coefficients (samples, unknowns, points), and what they share, at noise 1."""
        friction = self.model.friction(values, self.data.distance)
        stacked = np.concatenate([slopes, self._shared(values, friction.errors)], axis=1)
        self._divide(values, stacked, friction.scatter)
        return stacked[:, : slopes.shape[1]], stacked[:, slopes.shape[1] :]

    def _shared(self, values: dict[str, FloatArray], errors: FloatArray) -> FloatArray:
        """Return lines of what is unknown beside: errors of an emulator, and the level of every repeat."""
        if "noise.repeat" not in values:
            return errors
        levels = np.zeros((len(errors), len(self.data.courses), errors.shape[2]))
        for place, rows in enumerate(self.data.rows):
            levels[:, place, rows] = values["noise.repeat"][:, None]
        return np.concatenate([errors, levels], axis=1)

    def _divide(self, values: dict[str, FloatArray], stacked: FloatArray, scatter: FloatArray) -> FloatArray:
        """Give lines (samples, lines, points) unit noise, in place.

        Returns the logarithm of what divided them, (samples,). scatter: of each point on its own, (samples,
        points).
        """
        count = self._gaps.size
        errors = np.hypot([point.error for point in self.data.points], scatter[:, count:])
        stacked[..., count:] /= errors[:, None]
        alone = np.sum(np.log(errors), axis=1)
        if not count:
            return np.asarray(alone)
        rows = stacked[..., :count]
        memory = np.exp(-np.minimum(self._gaps / values["noise.length"][:, None], INDEPENDENT))
        left = values["noise.deviation"][:, None] * np.sqrt(np.maximum(1.0 - memory**2, 1e-15))
        if scatter.any():
            left = _innovations(rows, memory, left**2, scatter[:, :count] ** 2)
        else:
            rows[..., 1:] -= memory[:, None, 1:] * rows[..., :-1]
            rows /= left[:, None]
        return np.asarray(np.sum(np.log(left), axis=1) + alone)

    @cached_property
    def _gaps(self) -> FloatArray:
        """Return distances [mm] to the point before on the course, infinite at its first, (points,)."""
        gaps = [np.diff(course.distance, prepend=-np.inf) for course in self.data.courses]
        return np.concatenate([np.zeros(0), *gaps])


def _innovations(rows: FloatArray, memory: FloatArray, fresh: FloatArray, alone: FloatArray) -> FloatArray:
    """Turn rows (samples, lines, points) into Kalman's innovations of unit variance, in place.

    An autoregression keeps a part of the point before, `memory`, and gets a variance `fresh`, both (samples,
    points); every point has the variance `alone` besides. Returns what divided the rows, (samples, points).
    """
    square = np.empty_like(memory)
    gain = np.empty_like(memory)
    variance = np.zeros(len(memory))
    for place in range(memory.shape[1]):
        variance = memory[:, place] ** 2 * variance + fresh[:, place]
        square[:, place] = variance + alone[:, place]
        gain[:, place] = variance / square[:, place]
        variance = gain[:, place] * alone[:, place]
    by_point = np.ascontiguousarray(rows.transpose(2, 0, 1))
    expected = np.zeros(by_point.shape[1:])
    keeps, gains = memory.T[..., None], gain.T[..., None]
    for place, row in enumerate(by_point):
        if place:
            expected += gains[place - 1] * by_point[place - 1]
            expected *= keeps[place]
        row -= expected
    root = np.sqrt(square)
    rows[:] = by_point.transpose(1, 2, 0) / root[:, None]
    return root


def _products(lines: FloatArray, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return 1 + CCᵀ and Cr of lines (samples, lines, points) and residuals (samples, points)."""
    return np.eye(lines.shape[1]) + lines @ lines.transpose(0, 2, 1), lines @ residual[..., None]
