"""Blocks of a programme, and passes over a track: the first and the last, and what either direction has."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from warpwear.grid import FloatArray

When = Literal["initial", "end"]
WHEN: tuple[When, When] = ("initial", "end")
#: Stretches of a track whose differences between directions are compared, and how many are needed.
STRETCHES, FEWEST = 16, 4
#: Standard errors, and the part of their mean, beyond which both directions differ.
BEYOND, LEAST = 3.0, 0.03
TO_SIGMA = 1.4826  # median absolute deviation to standard deviation, of Gaussian values
Steps = np.ndarray[tuple[int], np.dtype[np.bool_]]


class Laps(NamedTuple):
    """Tell how a test repeats itself: what is slid in a pass [mm], and whether the next one slides back."""

    length: float  # of its last blocks
    reverses: bool
    start: float = 0.0  # distance from which passes are that long [mm]
    first: float | None = None  # length of the first ones, where that is another [mm]

    def last(self, distance: float) -> float:
        """Return what is slid in the last whole cycle of a distance [mm]; a pass within the first cycle."""
        turned = self.reverses and distance - self.start >= 2.0 * self.length * (1.0 - 1.0e-9)
        return self.length * (2.0 if turned else 1.0)


@dataclass(frozen=True)
class Block:
    """Holds what one block of a programme is; a test without a programme is one block."""

    number: int  # from 1
    start: float  # sliding distance at which it begins [mm]
    end: float  # and at which it ends [mm]
    load: float  # F [N]
    speed: float | None  # mean sliding speed [mm/s]; None where it is not known
    lap: float | None  # what it slides in a pass [mm]
    since: tuple[float, float]  # distance [mm] and time [s] from which its speed has held; NaN: not known

    @property
    def length(self) -> float:
        """Return what it slides [mm]."""
        return self.end - self.start

    def time(self, distance: Any) -> Any:
        """Return the time [s] at a sliding distance [mm] within it; NaN where that is not known."""
        start, begins = self.since
        return begins + (distance - start) / self.speed if self.speed else math.nan * distance

    @classmethod
    def in_a_row(
        cls, blocks: Iterable[tuple[float, float, float | None, float | None]]
    ) -> "tuple[Block, ...]":
        """Return blocks in a row, each of a load [N], a length [mm], a mean speed [mm/s] and a pass [mm]."""
        row: list[Block] = []
        start, since = 0.0, (0.0, 0.0)
        for number, (load, length, speed, lap) in enumerate(blocks, 1):
            if row and speed != row[-1].speed:
                since = start, row[-1].time(start)
            row.append(cls(number, start, start + length, load, speed, lap, since))
            start += length
        return tuple(row)

    def slides(self, distance: float) -> float:
        """Return what it slides of the test's first distance [mm]."""
        return max(min(self.end, distance) - self.start, 0.0)


class Directions(NamedTuple):
    """Compare both directions of a last cycle."""

    forward: float
    backward: float
    error: float  # standard, of their difference, by how it scatters along the track
    away: float  # their difference where the contact is away from the ends of the track

    @property
    def differ(self) -> bool:
        """Tell whether both directions differ beyond the scatter."""
        difference, middle = abs(self.forward - self.backward), 0.5 * abs(self.forward + self.backward)
        return difference > max(BEYOND * self.error, LEAST * middle)

    @property
    def by_ends(self) -> bool:
        """Tell whether the ends of the track, or its seam, make most of the difference."""
        return abs(self.away) < 0.5 * abs(self.forward - self.backward)


def within(history: Mapping[str, FloatArray], when: When, laps: Laps | None) -> Steps:
    """Return which steps are of the first pass or the last cycle; the first or the last step without laps."""
    distance = history["distance"]
    if laps is None or distance[-1] == 0.0:
        inside = np.zeros(distance.size, dtype=bool)
        inside[-1 if when == "end" else 0] = True
        return inside
    increment, last = history["increment"], laps.last(float(distance[-1]))
    if "cycles" in history:  # a step that stands for many is one of a pass
        increment = increment / history["cycles"]
        distance = np.cumsum(increment)
    middle = distance - 0.5 * increment
    return middle > distance[-1] - last if when == "end" else middle < (laps.first or laps.length)


def mean_over(history: Mapping[str, FloatArray], values: FloatArray, when: When, laps: Laps | None) -> float:
    """Return the mean of a column over the steps `within`."""
    inside = within(history, when, laps)
    if np.count_nonzero(inside) == 1:
        return float(values[inside][0])
    return float(np.average(values[inside], weights=history["increment"][inside]))


def directions(
    history: Mapping[str, FloatArray], values: FloatArray, laps: Laps | None, *, margin: float = 0.0
) -> Directions | None:
    """Return the means of a column in both directions of the last cycle; None where there is no cycle.

    margin: length beside the ends of a pass [mm] in which the contact lies across them.
    """
    total = float(history["distance"][-1])
    if laps is None or laps.last(total) == laps.length:
        return None
    inside = within(history, "end", laps)
    weights, values = history["increment"][inside], values[inside]
    slid = (history["distance"][inside] - 0.5 * weights - laps.start) % (2.0 * laps.length)
    back = slid > laps.length
    place = np.where(back, 2.0 * laps.length - slid, slid)

    def means(part: Steps) -> list[float]:
        ways = part & ~back, part & back
        return [float(np.average(values[w], weights=weights[w])) for w in ways if w.any()]

    forward, backward = means(np.ones(place.size, dtype=bool))
    stretch = (place / laps.length * STRETCHES).astype(int)
    pairs = [means(stretch == number) for number in range(STRETCHES)]
    differences = np.array([pair[0] - pair[1] for pair in pairs if len(pair) == 2])
    error = math.inf
    if differences.size >= FEWEST:  # a seam is in few stretches: the median leaves it out
        spread = TO_SIGMA * float(np.median(np.abs(differences - np.median(differences))))
        error = spread / math.sqrt(differences.size)
    away = means((place > margin) & (place < laps.length - margin))
    return Directions(forward, backward, error, away[0] - away[1] if len(away) == 2 else forward - backward)
