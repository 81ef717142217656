"""Roughness settles in running-in towards one that the conditions of friction set, whatever it was.

Kragelsky, Dobychin and Kombalov (Friction and Wear: Calculation Methods, Pergamon, 1982) call it the
equilibrium roughness. What is fitted here is the exponential way there; their formulas are not used.
"""

from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray

#: Three constants go through fewer places by chance.
FEWEST_PLACES = 6
#: Standard error of a constant from which a fit tells nothing: over ℓ, and over the change of the roughness.
LARGEST_ERROR = 0.5
#: Change of the roughness over the largest, below which it has no course.
LEAST_CHANGE = 0.05
#: Lengths ℓ that are tried, over the whole distance, how many at once, and how often between the best ones.
SHORTEST, LONGEST, TRIED, ROUNDS = 1e-6, 1e3, 201, 5


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
    lengths = span * np.geomspace(SHORTEST, LONGEST, TRIED)
    for _ in range(ROUNDS):
        best = int(np.argmin(_levels(lengths, distance, roughness)[2]))
        lengths = np.geomspace(lengths[max(best - 1, 0)], lengths[min(best + 1, TRIED - 1)], TRIED)
    length = float(lengths[TRIED // 2])
    levels = _levels(np.array([length]), distance, roughness)
    equilibrium, initial = float(levels[0][0]), float(levels[1][0])
    gone = np.exp(-distance / length)
    slope = (initial - equilibrium) * gone * distance / length  # by the relative change of ℓ
    slopes = np.stack([1.0 - gone, gone, slope], axis=1)
    if np.linalg.matrix_rank(slopes) < slopes.shape[1]:
        return "its course is too scattered, or levels off before its second place"
    inverse = np.linalg.pinv(slopes)
    variance = float(levels[2][0]) / (distance.size - 3)
    errors = np.sqrt(variance * np.square(inverse).sum(axis=1)) * np.array([1.0, 1.0, length])
    if not (np.isfinite(errors).all() and length < span and errors[2] <= LARGEST_ERROR * length):
        return "its course is too short to level off, or too scattered"
    if not errors[0] <= LARGEST_ERROR * abs(initial - equilibrium):
        return "its course is too scattered"
    left = float(np.sqrt(levels[2][0] / distance.size))
    return Settling(equilibrium, initial, length, float(errors[0]), float(errors[2]), left)


def _course(distance: FloatArray, equilibrium: float, initial: float, length: float) -> FloatArray:
    return np.asarray(equilibrium + (initial - equilibrium) * np.exp(-distance / length))


def _levels(
    lengths: FloatArray, distance: FloatArray, roughness: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the R_eq and R0, from 0 up, that fit best with each length ℓ [mm], and their sums of squares.

    With ℓ given the course is linear in both; where one would be negative it is 0.
    """
    gone = np.exp(-distance / lengths[:, None])
    here = 1.0 - gone
    aa, ab, bb = ((p * q).sum(axis=1) for p, q in ((here, here), (here, gone), (gone, gone)))
    ay, by = ((p * roughness).sum(axis=1) for p in (here, gone))
    with np.errstate(invalid="ignore", divide="ignore"):
        both = np.stack([bb * ay - ab * by, aa * by - ab * ay]) / (aa * bb - ab * ab)
        either = np.stack([[ay / aa, 0.0 * ay], [0.0 * by, by / bb]])
    trials = np.maximum(np.nan_to_num([both, *either], posinf=0.0, neginf=0.0), 0.0)
    left = [((p[:, None] * here + q[:, None] * gone - roughness) ** 2).sum(axis=1) for p, q in trials]
    best, every = np.argmin(left, axis=0), np.arange(lengths.size)
    return trials[best, 0, every], trials[best, 1, every], np.asarray(left)[best, every]
