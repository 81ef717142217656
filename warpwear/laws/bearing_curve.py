"""The bearing area curve of a rough disc is a logistic function, whose two numbers a fit gives."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Logistic:
    """A bearing area curve φ(z) = 1/(1 + e^(−(z − middle)/scale)) gives the part of the area above a depth.

    z: depth below the highest peak [mm].
    """

    middle: float  # depth that half of the area lies above [mm]
    scale: float  # [mm]
