"""The bearing area curve of a rough disc as a logistic function, whose two numbers a fit gives."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Logistic:
    """Bearing area curve φ(z) = 1/(1 + e^(−(z − middle)/scale)), z below the highest peak [mm]."""

    middle: float
    scale: float
    rms_error: float = 0.0  # of φ, over the curve it was fitted to
