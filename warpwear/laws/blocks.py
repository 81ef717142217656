"""A programme is blocks one after another, each with its load and speed over a part of the distance."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Block:
    """Holds what one block of a programme is; a test without a programme is one block."""

    number: int  # from 1
    start: float  # sliding distance at which it begins [mm]
    end: float  # and at which it ends [mm]
    load: float  # F [N]
    speed: float | None  # mean sliding speed [mm/s]; None where it is not known
    since: tuple[float, float]  # distance [mm] and time [s] from which its speed has held; NaN: not known

    @property
    def length(self) -> float:
        """Return what it slides [mm]."""
        return self.end - self.start

    def time(self, distance: float) -> float:
        """Return the time [s] at a sliding distance [mm] within it; NaN where that is not known."""
        start, begins = self.since
        return begins + (distance - start) / self.speed if self.speed else math.nan

    def slides(self, distance: float) -> float:
        """Return what it slides of the test's first distance [mm]."""
        return max(min(self.end, distance) - self.start, 0.0)
