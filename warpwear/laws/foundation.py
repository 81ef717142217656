"""The contact law is one formula, from the Winkler foundation to the bearing area."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class CappedFoundation:
    """Every cell carries the pressure p = clip((approach − gap) / c, 0, hardness).

    c = 1/stiffness for an explicit step. An implicit Archard step eliminates the gap after the step,
    gap + K p ΔL, and obeys the same law with c = 1/stiffness + K ΔL: unconditionally stable, cap and
    conservation unchanged. c = 0 leaves the bearing area: every overlapping cell carries the hardness.
    """

    stiffness: float = math.inf  # k [N/mm³] (mattress of independent springs)
    hardness: float = math.inf  # H [MPa]

    @property
    def compliance(self) -> float:
        """Return the compliance c = 1/k of an explicit step [mm³/N]."""
        return 1.0 / self.stiffness

    def stable_increment(self, wear_coefficient: float) -> float:
        """Return the largest stable sliding increment of explicit Archard wear, 2c/K [mm].

        Infinite without a foundation: there the step has no stability limit, only an accuracy of K H ΔL.
        wear_coefficient: K of both bodies together [mm²/N].
        """
        if self.compliance == 0.0 or wear_coefficient == 0.0:
            return math.inf
        return 2.0 * self.compliance / wear_coefficient
