"""Where the approach of the next step will be, from those of the last ones."""

from collections import deque
from typing import ClassVar

#: Steps remembered: a line through their rates is continued, as a parabola amplifies the noise of the area.
REMEMBERED = 2


class Foresight:
    """Continues the rate at which the approach grows with what a unit of pressure removes.

    That rate is the mean pressure where wear alone moves the contact, so it changes as slowly as the area.
    """

    STATE: ClassVar = {"_slid": float, "_approach": float, "_rates": deque}

    def __init__(self) -> None:
        self._slid = 0.0  # Σ K ΔL of both bodies [mm³/N]
        self._approach: float | None = None
        self._rates: deque[tuple[float, float]] = deque(maxlen=REMEMBERED)  # where [mm³/N], rate [MPa]

    def note(self, approach: float, removal: float) -> None:
        """Learn from a step that ended at an approach [mm]; removal: its K ΔL of both bodies [mm³/N]."""
        where = self._slid + 0.5 * removal
        # A law that decays ends with steps too small to be told apart by where they are.
        is_new = not self._rates or where > self._rates[-1][0]
        if self._approach is not None and removal > 0.0 and is_new:
            self._rates.append((where, (approach - self._approach) / removal))
        self._approach = approach
        self._slid += removal

    def expected(self, removal: float) -> float | None:
        """Tell how far a step of K ΔL = removal [mm³/N] goes on [mm]; None before it can be told."""
        if not self._rates:
            return None
        where = self._slid + 0.5 * removal
        rate = 0.0  # Lagrange's polynomial through what is remembered
        for i, (place, value) in enumerate(self._rates):
            for j, (other, _) in enumerate(self._rates):
                if i != j:
                    value *= (where - other) / (place - other)
            rate += value
        return removal * rate
