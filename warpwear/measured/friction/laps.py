"""Gather a course of friction in laps or cycles: the mean of each, and how the points within it scatter."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray
from warpwear.measured.experiment import Experiment

#: Fewest points on average in a group that has a scatter; a group is of several laps where laps have fewer.
POINTS = 4
#: Most groups, which the search for changes takes a second for.
MOST = 1500
#: Groups of a course whose laps are not known.
PARTS = 400


@dataclass(frozen=True, eq=False)
class Laps:
    """A course is means over groups of points, one after another.

    distance: of the groups' middles [mm]; cof: means; scatter: standard deviations within, NaN for single
    points; points: how many; all of shape (groups,). length: of a group [mm]. laps: in a group, None where it
    is not known how long one is. unit: what is counted, "lap", "cycle" or "part".
    """

    distance: FloatArray
    cof: FloatArray
    scatter: FloatArray
    points: FloatArray
    length: float
    laps: float | None
    unit: str

    def count(self, length: float) -> float | None:
        """Return how many laps or cycles a length [mm] is, None where that is not known."""
        return None if self.laps is None else self.laps * length / self.length


def laps_of(course: Experiment, lap: float | None) -> Laps:
    """Gather a course in laps. lap: distance of one [mm], None where it is not known."""
    distance, cof = course.distance, course.cof
    if course.cycles is not None:
        length = float(np.median(np.diff(distance) / np.diff(course.cycles)))
        nothing = np.full(cof.size, np.nan)
        return Laps(distance, cof, nothing, np.ones(cof.size), length, 1.0, "cycle")
    start, size = float(distance[0]), float(np.ptp(distance))
    if lap is None or lap > size / 2.0:
        groups = max(min(PARTS, distance.size // POINTS), 1)
        length, laps, unit = size / groups, None, "part"
    else:
        start = 0.0 if start < lap else start
        together = max(POINTS * size / (distance.size * lap), size / (lap * MOST), 1.0)
        laps = float(math.ceil(together - 1e-9))
        length, unit = laps * lap, "lap"
    group = np.floor((distance - start) / length * (1.0 - 1e-12)).astype(np.intp)
    places, which, number = np.unique(group, return_inverse=True, return_counts=True)
    means: FloatArray = (np.bincount(which, weights=cof) / number).astype(np.float64)
    squares = np.bincount(which, weights=(cof - means[which]) ** 2)
    with np.errstate(invalid="ignore", divide="ignore"):
        scatter = np.where(number > 1, np.sqrt(squares / (number - 1)), np.nan)
    whole = number >= 0.5 * np.median(number)  # the last one ends with the record
    middles: FloatArray = (start + (places + 0.5) * length).astype(np.float64)
    return Laps(
        middles[whole], means[whole], scatter[whole], number[whole].astype(np.float64), length, laps, unit
    )
