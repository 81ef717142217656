"""Wear laws: how much of each body a pressure removes between two sliding distances."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class WearLaw:
    """Archard's K of one body [mm²/N], constant or by an empirical law of the distance slid.

    decay: α [1/mm] of V = K F (1 − e^(−αL))/α (thesis eq 2.4). running_in: L0 [mm] of K + (K0 − K) e^(−L/L0)
    with K0 = initial. Both are integrated over a step, not sampled: volumes do not depend on its size.
    """

    steady: float
    decay: float | None = None
    initial: float | None = None
    running_in: float | None = None

    @property
    def fastest(self) -> float:
        """Largest K at any distance [mm²/N]."""
        return max(self.steady, self.initial or 0.0)

    def in_proportion_to(self, other: "WearLaw") -> bool:
        """Whether the two K are in one proportion at every distance."""
        if self.fastest == 0.0 or other.fastest == 0.0:
            return True
        if self.decay != other.decay or self.running_in != other.running_in:
            return False
        if self.running_in is None or self.initial is None or other.initial is None:
            return self.initial == other.initial
        return self.initial * other.steady == other.initial * self.steady

    def removal(self, start: float, increment: float) -> float:
        """∫ K dL from a distance over an increment [mm]: depth worn by a unit of pressure [mm³/N]."""
        if self.decay is not None:
            return self.steady * _of_decay(start, increment, 1.0 / self.decay)
        found = self.steady * increment
        if self.running_in is not None and self.initial is not None:
            found += (self.initial - self.steady) * _of_decay(start, increment, self.running_in)
        return found


def removals_of(
    laws: tuple[WearLaw, WearLaw], start: float, increments: Sequence[float]
) -> list[tuple[float, float]]:
    """Of sphere and disc [mm³/N] over increments that follow each other from a distance [mm]."""
    sphere, disc = laws
    starts = itertools.accumulate(increments, initial=start)
    return [
        (sphere.removal(at, increment), disc.removal(at, increment))
        for at, increment in zip(starts, increments, strict=False)
    ]


def _of_decay(start: float, increment: float, length: float) -> float:
    """∫ e^(−L/length) dL from start over an increment [mm], exact for small ones too."""
    return -length * math.exp(-start / length) * math.expm1(-increment / length)
