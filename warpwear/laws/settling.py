"""Roughness that settles in running-in: towards one that the conditions of friction set, whatever it was.

Kragelsky, Dobychin and Kombalov (Friction and Wear: Calculation Methods, Pergamon, 1982) call it the
equilibrium roughness. What is fitted here is the exponential way there; their formulas are not used.
"""

from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

optimize = lazy.module("scipy.optimize")

#: Three constants go through fewer places by chance.
FEWEST_PLACES = 6
#: Standard error of a constant from which a fit tells nothing: over ℓ, and over the change of the roughness.
LARGEST_ERROR = 0.5
#: Change of the roughness over the largest, below which it has no course.
LEAST_CHANGE = 0.05


@dataclass(frozen=True)
class Settling:
    """The course R(L) = R_eq + (R0 − R_eq) e^(−L/ℓ) of a roughness; errors are standard ones."""

    equilibrium: float  # R_eq, in the unit of the roughness, as are the next and the errors
    initial: float  # R0
    length: float  # ℓ [mm]
    equilibrium_error: float
    length_error: float  # [mm]
    rms: float  # of what is left

    def at(self, distance: FloatArray) -> FloatArray:
        """Return R at sliding distances [mm]."""
        return _course(distance, self.equilibrium, self.initial, self.length)


def fit_settling(distance: FloatArray, roughness: FloatArray) -> Settling | str:
    """Fit the course of a roughness by least squares; or say in half a sentence why it cannot be.

    distance: [mm], rising from 0. roughness: such as Sq, in any unit; places where it is NaN are left out.
    """
    known = np.isfinite(roughness)
    distance, roughness = distance[known], roughness[known]
    if distance.size < FEWEST_PLACES:
        return f"its course has {distance.size} places, where {FEWEST_PLACES} are needed (output.snapshots)"
    change = float(np.ptp(roughness))
    if change <= LEAST_CHANGE * float(np.abs(roughness).max()):
        return "it hardly changes"
    span = float(distance[-1])
    nearly = np.abs(roughness - roughness[0]) >= 0.63 * abs(float(roughness[-1] - roughness[0]))
    guess = (
        float(roughness[-1]),
        float(roughness[0]),
        max(float(distance[int(np.argmax(nearly))]), 0.01 * span),
    )
    try:
        found, covariance = optimize.curve_fit(
            _course,
            distance,
            roughness,
            p0=guess,
            bounds=([0.0, 0.0, 1e-6 * span], [np.inf, np.inf, 1e3 * span]),
        )
    except (RuntimeError, ValueError):
        return "least squares found no constants"
    equilibrium, initial, length = (float(value) for value in found)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if not (np.isfinite(errors).all() and length < span and errors[2] <= LARGEST_ERROR * length):
        return "its course is too short to level off, or too scattered"
    if not errors[0] <= LARGEST_ERROR * abs(initial - equilibrium):
        return "its course is too scattered"
    left = float(np.sqrt(np.mean((_course(distance, *found) - roughness) ** 2)))
    return Settling(equilibrium, initial, length, float(errors[0]), float(errors[2]), left)


def _course(distance: FloatArray, equilibrium: float, initial: float, length: float) -> FloatArray:
    return np.asarray(equilibrium + (initial - equilibrium) * np.exp(-distance / length))
