"""Wear breaks films and junctions grow, which sets the shear strength of a cell and the cap that it leaves.

A film keeps the shear strength of a cell low until wear has taken it off; then metal meets metal. A junction
under shear flows at a smaller pressure and so grows: p² + α τ² = H² (Tabor, Proc. R. Soc. A 251, 1959, 378,
doi 10.1098/rspa.1959.0114; α is 9 to 27 there).
"""

import math
from dataclasses import dataclass

from warpwear.laws.archard import Scales


@dataclass(frozen=True)
class Film(Scales):
    """Describes a film on one body or both, and what is left of a cell's hardness with and without it."""

    thickness: float  # [mm]
    on: tuple[bool, bool]  # counter-body, disc: which carry one
    regrowth: float = math.inf  # sliding distance without wear after which it is whole again [mm]
    cap_ratio_filmed: float = 1.0  # cap of a cell over the hardness of the task
    cap_ratio_bare: float = 1.0
    shear_ratio: float = 1.0  # shear strength of a cell with it over that of a bare one

    @property
    def changes_caps(self) -> bool:
        """Tell whether the cap of a cell depends on its film."""
        return self.cap_ratio_filmed != self.cap_ratio_bare


def grown_cap(
    hardness: float, shear_strength: float, growth: float, largest_coefficient: float = math.inf
) -> float:
    """Return the cap √(H² − α τ²) [MPa] of a junction that is sheared, 0 where τ√α reaches the hardness.

    hardness: H, shear_strength: τ [MPa]. growth: α. largest_coefficient: μ, where τ is at most μ p: the cap
    is then no less than H/√(1 + α μ²), at which τ is μ p.
    """
    if growth == 0.0:
        return hardness
    left = 1.0 - growth * (shear_strength / hardness) ** 2
    return hardness * math.sqrt(max(left, 1.0 / (1.0 + growth * largest_coefficient**2)))
