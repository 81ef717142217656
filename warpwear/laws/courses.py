"""Courses over the distance slid level off: a fraction that becomes bare, a roughness that settles.

Roughness settles in running-in towards one that the conditions of friction set, whatever it was. Kragelsky,
Dobychin and Kombalov (Friction and Wear: Calculation Methods, Pergamon, 1982) call it the equilibrium
roughness. What is fitted here is the exponential way there; their formulas are not used.
"""

import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

optimize = lazy.module("scipy.optimize")

#: Three constants go through fewer places by chance.
FEWEST_PLACES = 6
#: Standard error of a constant, over it, or over the change of what settles, from which a fit tells nothing.
LARGEST_ERROR = 0.5
#: Change of a roughness over the largest, below which it has no course.
LEAST_CHANGE = 0.05
#: Lengths ℓ from which a fit starts, over the whole distance.
STARTS = (0.01, 0.1, 1.0)
#: Places are a length apart that a course falls off in by so much: nothing but the second tells ℓ.
SUDDEN = 1.0e-8
#: Trials of a fit at most; it ends where one gains no more than this part of the squares that are left.
MOST_TRIALS, NO_GAIN, LEAST_DAMPING, TINY = 300, 1.0e-12, 1.0e-9, 1.0e-300


@dataclass(frozen=True)
class Breaking:
    """A bare fraction runs as φ = φ∞ (1 − e^(−(L − L0)/ℓ)), 0 before L0; errors are standard ones."""

    plateau: float  # φ∞
    start: float  # L0 [mm]
    length: float  # ℓ [mm]
    plateau_error: float
    length_error: float  # [mm]
    rms: float  # of what is left

    def at(self, distance: FloatArray) -> FloatArray:
        """Return φ at sliding distances [mm]."""
        return _breaks(distance, self.plateau, self.start, self.length)


@dataclass(frozen=True)
class Settling:
    """A roughness settles as R(L) = R_eq + (R0 − R_eq) e^(−L/ℓ); errors are standard ones."""

    equilibrium: float  # R_eq, in the unit of the roughness, as are the next and the errors
    initial: float  # R0
    length: float  # ℓ [mm]
    equilibrium_error: float
    length_error: float  # [mm]
    rms: float  # of what is left

    def at(self, distance: FloatArray) -> FloatArray:
        """Return R at sliding distances [mm]."""
        return _settles(distance, self.equilibrium, self.initial, self.length)


def fit_breaking(distance: FloatArray, fraction: FloatArray) -> Breaking | str:
    """Fit the course of a bare fraction by least squares; or say in half a sentence why it cannot be.

    A plateau that creeps makes the constants depend on where the course ends, which the scatter about it does
    not know: errors hold what changes without its second half. distance: [mm], rising. fraction: 0 to 1.
    """
    whole, half = _broken(distance, fraction), max(distance.size // 2, FEWEST_PLACES)
    if isinstance(whole, str) or isinstance(early := _broken(distance[:half], fraction[:half]), str):
        return whole
    return replace(
        whole,
        plateau_error=math.hypot(whole.plateau_error, whole.plateau - early.plateau),
        length_error=math.hypot(whole.length_error, whole.length - early.length),
    )


def _broken(distance: FloatArray, fraction: FloatArray) -> Breaking | str:
    """Fit a course by least squares; errors are those of its scatter."""
    if distance.size < FEWEST_PLACES:
        return f"the course has {distance.size} places, where {FEWEST_PLACES} are needed"
    highest, span = float(fraction.max()), float(distance[-1])
    if highest <= 0.0:
        return "no cell is bare"
    if float(fraction.min()) >= (1.0 - LARGEST_ERROR) * highest:
        return "the film was worn through within the first of the course"
    rises = int(np.argmax(fraction > 0.05 * highest))
    third = float(np.interp(0.63 * highest, np.maximum.accumulate(fraction), distance))
    begin = float(distance[max(rises - 1, 0)]) if rises else 0.0
    guess = highest, begin, max(third - begin, 0.1 * (span - float(distance[0])))
    bounds = ([0.0, -span, 1e-9 * span], [2.0, span, 1e3 * span])
    if (fit := fit_course(_breaks, distance, fraction, [guess], bounds)) is None:
        return "least squares found no constants"
    left, (plateau, start, length), (error, _, length_error) = fit
    known = error <= LARGEST_ERROR * plateau and length_error <= LARGEST_ERROR * length  # or one is NaN
    if not (known and length < span):
        return "the course is too short to show a plateau, or too scattered"
    return Breaking(plateau, start, length, error, length_error, left)


def fit_settling(distance: FloatArray, roughness: FloatArray) -> Settling | str:
    """Fit the course of a roughness by least squares; or say in half a sentence why it cannot be.

    distance: [mm], rising from 0. roughness: such as Sq, in any unit; places where it is NaN are left out.
    """
    known = np.isfinite(roughness)
    distance, roughness = distance[known], roughness[known]
    if distance.size < FEWEST_PLACES:
        return f"its course has {distance.size} places, where {FEWEST_PLACES} are needed (output.snapshots)"
    if float(np.ptp(roughness)) <= LEAST_CHANGE * float(np.abs(roughness).max()):
        return "it hardly changes"
    span = float(distance[-1])
    starts = [(float(roughness[-1]), float(roughness[0]), part * span) for part in STARTS]
    bounds = ([0.0, 0.0, 1e-6 * span], [np.inf, np.inf, 1e3 * span])
    fit = fit_course(_settles, distance, roughness, starts, bounds, by=descend)
    if fit is None:
        return "least squares found no constants"
    left, (equilibrium, initial, length), (error, _, length_error) = fit
    sudden = math.exp(-distance[1] / length) < SUDDEN
    known_by_now = error <= LARGEST_ERROR * abs(initial - equilibrium) and length < span
    if sudden or not (known_by_now and length_error <= LARGEST_ERROR * length):
        return "its course is too short to level off, does so before its second place, or is too scattered"
    return Settling(equilibrium, initial, length, error, length_error, left)


def fit_course(
    course: Callable[..., FloatArray],
    places: FloatArray,
    values: FloatArray,
    starts: Iterable[tuple[float, ...]],
    bounds: tuple[list[float] | float, list[float] | float],
    by: Callable[..., tuple[FloatArray, FloatArray]] | None = None,
) -> tuple[float, list[float], list[float]] | None:
    """Return the rms that is left by least squares, the constants, and their standard errors.

    course: gives the values at places for some constants. starts, bounds: of these. by: `descend` where the
    course is smooth, else SciPy's. None where none is found.
    """
    fits = []
    for start in starts:
        with suppress(RuntimeError, ValueError):
            constants, covariance = (by or optimize.curve_fit)(
                course, places, values, p0=start, bounds=bounds
            )
            errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
            left = float(np.sqrt(np.mean((course(places, *constants) - values) ** 2)))
            fits.append((left, constants.tolist(), errors.tolist()))
    return min(fits, default=None)


def descend(
    course: Callable[..., FloatArray], places: FloatArray, values: FloatArray, *, p0: Any, bounds: Any
) -> tuple[FloatArray, FloatArray]:
    """Fit a smooth course by Levenberg and Marquardt's method; called as SciPy's `curve_fit`.

    Slopes are exact, by a complex step; a constant stays at a bound while it leads out. SciPy's takes a tenth
    of a short run to be imported. Raises RuntimeError where it does not converge.
    """
    constants, (low, high), damping = np.array(p0), np.array(bounds), 1.0e-3
    left, units = course(places, *constants) - values, 1.0e-100j * np.eye(len(p0))
    for _ in range(MOST_TRIALS):
        slopes = np.stack([course(places, *(constants + unit)).imag for unit in units], axis=1) / 1.0e-100
        downhill = -left @ slopes
        out = np.where(downhill > 0.0, constants >= high, constants <= low)
        normal = slopes.T @ slopes * ~(out | out[:, None])
        scale = np.where(np.diag(normal) > 0.0, np.diag(normal), 1.0)
        step = np.linalg.solve(normal + np.diag(damping * scale), np.where(out, 0.0, downhill))
        trial = np.clip(constants + step, low, high)
        further = course(places, *trial) - values
        gain = float(left @ left - further @ further) / max(float(left @ left), TINY)
        if gain >= 0.0:
            constants, left, damping = trial, further, max(0.1 * damping, LEAST_DAMPING)
        else:
            damping *= 10.0
        if abs(gain) <= NO_GAIN or damping > 1.0 / NO_GAIN:
            inverse = np.linalg.pinv(slopes, rcond=places.size * float(np.finfo(float).eps))
            return constants, inverse @ inverse.T * (left @ left / max(places.size - len(p0), TINY))
    raise RuntimeError("least squares do not converge")


def _breaks(distance: FloatArray, plateau: float, start: float, length: float) -> FloatArray:
    return np.asarray(plateau * -np.expm1(-np.maximum(distance - start, 0.0) / length))


def _settles(distance: FloatArray, equilibrium: float, initial: float, length: float) -> FloatArray:
    return np.asarray(equilibrium + (initial - equilibrium) * np.exp(-distance / length))
