"""Wear laws: how much of each body a pressure removes between two sliding distances."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from warpwear.grid import FloatArray, Grid


@dataclass(frozen=True)
class WearLaw:
    """Archard's K of one body [mm²/N] is constant or follows an empirical law of the distance slid.

    decay: α [1/mm] of V = K F (1 − e^(−αL))/α (thesis eq 2.4). running_in: L0 [mm] of K + (K0 − K) e^(−L/L0)
    with K0 = initial. Both are integrated over a step, not sampled: volumes do not depend on its size.
    """

    steady: float
    decay: float | None = None
    initial: float | None = None
    running_in: float | None = None

    @property
    def fastest(self) -> float:
        """The largest K at any distance [mm²/N]."""
        return max(self.steady, self.initial or 0.0)

    def in_proportion_to(self, other: "WearLaw") -> bool:
        """Tell whether this K and the `other` are in one proportion at every distance."""
        if self.fastest == 0.0 or other.fastest == 0.0:
            return True
        if self.decay != other.decay or self.running_in != other.running_in:
            return False
        if self.running_in is None or self.initial is None or other.initial is None:
            return self.initial == other.initial
        return self.initial * other.steady == other.initial * self.steady

    def removal(self, start: float, increment: float) -> float:
        """Return ∫ K dL, the depth that a unit of pressure wears [mm³/N].

        start: distance slid before [mm]. increment: slid while the pressure acts [mm].
        """
        if self.decay is not None:
            return self.steady * _of_decay(start, increment, 1.0 / self.decay)
        found = self.steady * increment
        if self.running_in is not None and self.initial is not None:
            found += (self.initial - self.steady) * _of_decay(start, increment, self.running_in)
        return found


def removals_of(
    laws: tuple[WearLaw, WearLaw], start: float, increments: Sequence[float]
) -> list[tuple[float, float]]:
    """Return what a unit of pressure removes from sphere and disc in each of the increments [mm³/N].

    laws: of sphere and disc. start: distance slid before the first of the increments [mm], which follow each
    other.
    """
    sphere, disc = laws
    starts = itertools.accumulate(increments, initial=start)
    return [(sphere.removal(*slid), disc.removal(*slid)) for slid in zip(starts, increments, strict=False)]


def _of_decay(start: float, increment: float, length: float) -> float:
    """Return ∫ e^(−L/length) dL from start over an increment [mm], exact for small ones too."""
    return -length * math.exp(-start / length) * math.expm1(-increment / length)


def distance_factor(grid: Grid, kind: Literal["none", "across", "radial"], *, curvature: float) -> FloatArray:
    """Return how far disc cells slide relative to the middle one: cos θ with sin θ = d/R.

    Thesis eqs 4.21 and 4.22, used relative to the value at the centre. d is the distance from the middle
    across the sliding direction (as its figure 4.30b shows) or radially (as its text says). It is the chord
    of the ball, not of the contact: a published option, not geometry.

    grid: of nx × ny cells. kind: "none", "across" or "radial". curvature: 1/R of the sphere [1/mm].
    The factors have no unit and the shape (1, 1), (1, ny) or (nx, ny), by kind.
    """
    if kind == "none":
        return np.ones((1, 1))
    d2 = grid.y[None, :] ** 2
    if kind == "radial":
        d2 = d2 + grid.x[:, None] ** 2
    return np.sqrt(np.maximum(0.0, 1.0 - d2 * curvature**2))
