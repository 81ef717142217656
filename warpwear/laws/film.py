"""Wear breaks films and junctions grow, which sets the shear strength of a cell and the cap that it leaves.

A film keeps the shear strength of a cell low until wear has taken it off; then metal meets metal. A junction
under shear flows at a smaller pressure and so grows: p² + α τ² = H² (Tabor, Proc. R. Soc. A 251, 1959, 378,
doi 10.1098/rspa.1959.0114; α is 9 to 27 there).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

optimize = lazy.module("scipy.optimize")

#: Fewer places of a course fit three constants by chance.
FEWEST_PLACES = 6
#: Standard error of a constant, over it, from which a fit tells nothing.
LARGEST_ERROR = 0.5


@dataclass(frozen=True)
class Film:
    """Describes a film on one body or both, and what is left of a cell's hardness with and without it."""

    thickness: float  # [mm]
    on: tuple[bool, bool]  # counter-body, disc: which carry one
    regrowth: float = math.inf  # sliding distance without wear after which it is whole again [mm]
    part_filmed: float = 1.0  # cap of a cell over the hardness of the task
    part_bare: float = 1.0
    part_shear: float = 1.0  # shear strength of a cell with it over that of a bare one

    @property
    def changes_caps(self) -> bool:
        """Tell whether the cap of a cell depends on its film."""
        return self.part_filmed != self.part_bare


def grown_cap(hardness: float, shear_strength: float, growth: float) -> float:
    """Return the cap √(H² − α τ²) [MPa] of a junction that is sheared, 0 where τ√α reaches the hardness.

    hardness: H, shear_strength: τ [MPa]. growth: α.
    """
    if growth == 0.0:
        return hardness
    left = 1.0 - growth * (shear_strength / hardness) ** 2
    return hardness * math.sqrt(max(left, 0.0))


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
        return _course(distance, self.plateau, self.start, self.length)


def fit_breaking(distance: FloatArray, fraction: FloatArray) -> Breaking | str:
    """Fit the course of a bare fraction by least squares; or say in half a sentence why it cannot be.

    A plateau that creeps makes the constants depend on where the course ends, which the scatter about it does
    not know: errors hold what changes without its second half. distance: [mm], rising. fraction: 0 to 1.
    """
    whole, half = _fitted(distance, fraction), max(distance.size // 2, FEWEST_PLACES)
    if isinstance(whole, str) or isinstance(early := _fitted(distance[:half], fraction[:half]), str):
        return whole
    return replace(
        whole,
        plateau_error=math.hypot(whole.plateau_error, whole.plateau - early.plateau),
        length_error=math.hypot(whole.length_error, whole.length - early.length),
    )


def _fitted(distance: FloatArray, fraction: FloatArray) -> Breaking | str:
    """Fit a course by least squares; errors are those of its scatter."""
    if distance.size < FEWEST_PLACES:
        return f"the course has {distance.size} places, where {FEWEST_PLACES} are needed"
    highest = float(fraction.max())
    if highest <= 0.0:
        return "no cell is bare"
    if float(fraction.min()) >= (1.0 - LARGEST_ERROR) * highest:
        return "the film was worn through within the first of the course"
    rises = int(np.argmax(fraction > 0.05 * highest))
    third = float(np.interp(0.63 * highest, np.maximum.accumulate(fraction), distance))
    begin = float(distance[max(rises - 1, 0)]) if rises else 0.0
    guess = highest, begin, max(third - begin, 0.1 * float(distance[-1] - distance[0]))
    span = float(distance[-1])
    try:
        constants, covariance = optimize.curve_fit(
            _course, distance, fraction, p0=guess, bounds=([0.0, -span, 1e-9 * span], [2.0, span, 1e3 * span])
        )
    except (RuntimeError, ValueError):
        return "least squares found no constants"
    plateau, start, length = (float(value) for value in constants)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    left = float(np.sqrt(np.mean((_course(distance, *constants) - fraction) ** 2)))
    known = np.isfinite(errors).all() and errors[0] <= LARGEST_ERROR * plateau
    if not known or not errors[2] <= LARGEST_ERROR * length or not length < span:
        return "the course is too short to show a plateau, or too scattered"
    return Breaking(plateau, start, length, float(errors[0]), float(errors[2]), left)


def _course(distance: FloatArray, plateau: float, start: float, length: float) -> FloatArray:
    return np.asarray(plateau * -np.expm1(-np.maximum(distance - start, 0.0) / length))
