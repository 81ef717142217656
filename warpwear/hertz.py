"""Hertz's smooth elastic contact, and the stiffness of Winkler foundations matched to it."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray

#: C_W of K_N = C_W E*/a (thesis eq 2.7 for a sphere) -> what of Hertz's the foundation then reproduces. One
#: constant cannot match all three.
MATCHES = {"area": 16.0 / (3.0 * math.pi), "pressure": 3.0 / math.pi, "approach": 4.0 / (3.0 * math.pi)}


def effective_modulus(first: tuple[float, float], second: tuple[float, float]) -> float:
    """E* [MPa] of two bodies, each with Young's modulus [MPa] and Poisson's ratio."""
    return 1.0 / sum((1.0 - poisson**2) / young for young, poisson in (first, second))


@dataclass(frozen=True)
class Hertz:
    """A sphere pressed on a flat. Source: Johnson, Contact Mechanics (1985), section 4.2."""

    modulus: float  # E* [MPa]
    sphere_radius: float  # R [mm]
    load: float  # F [N]

    @property
    def radius(self) -> float:
        """a of the contact [mm]."""
        return float((0.75 * self.load * self.sphere_radius / self.modulus) ** (1.0 / 3.0))

    @property
    def area(self) -> float:
        """[mm²]"""
        return math.pi * self.radius**2

    @property
    def peak_pressure(self) -> float:
        """[MPa]"""
        return 1.5 * self.load / self.area

    @property
    def approach(self) -> float:
        """[mm]"""
        return self.radius**2 / self.sphere_radius

    def pressure(self, r: FloatArray) -> FloatArray:
        """Pressure [MPa] at distances r from the middle [mm], any shape."""
        inside = np.maximum(0.0, 1.0 - np.square(r / self.radius))
        return np.asarray(self.peak_pressure * np.sqrt(inside))

    def foundation(self, match: str, *, radius: float | None = None) -> float:
        """K_N = C_W E*/a [N/mm³] (thesis eq 2.7). match: of `MATCHES`. radius: a, Hertz's by default [mm]."""
        return MATCHES[match] * self.modulus / (radius or self.radius)
