"""Many of a kind beside each other: rows in groups, and bands over what rows of a group came to."""

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.end_values import Value
from warpwear.measured.experiment import Experiment
from warpwear.results.ensemble import at, band
from warpwear.results.track import shape_of_growth

#: Parts that a measured course of many more points is averaged in, before its shape is taken.
PARTS = 200
Curve = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class EnsembleRow:
    """Hold what one of many came to: a run, a point of a sweep, a measured record.

    ends: end values by name; names that it has none of may be left out. courses: values over places, (n,)
    both, by the names of columns.
    """

    name: str
    ends: Mapping[str, Value]
    courses: Mapping[str, Curve]


M = TypeVar("M", bound=EnsembleRow, covariant=True)


@dataclass(frozen=True, eq=False)
class Group(Generic[M]):
    """Hold rows that differ only in what bands are taken over, such as a seed, or in nothing: repeats."""

    name: str
    rows: tuple[M, ...]
    kind: Literal["run", "experiment"] = "run"

    @property
    def count(self) -> int | None:
        """Return the number of runs; None of a measured course."""
        return len(self.rows) if self.kind == "run" else None

    def courses(self, name: str) -> Curve | None:
        """Return places of the longest course, (places,), and all values there, (rows, places); None of none.

        NaN beyond the ends of a course.
        """
        known = [row.courses[name] for row in self.rows if name in row.courses]
        if not known:
            return None
        places = max((x for x, _ in known), key=lambda x: (x[-1], x.size))
        return places, np.array([at(places, x, values) for x, values in known])

    def numbers(self, name: str) -> list[float]:
        """Return the end values of rows that have a number."""
        values = (row.ends.get(name) for row in self.rows)
        return [value for value in values if isinstance(value, int | float)]

    def mean(self, name: str) -> Value:
        """Return the end value of one row; of several the mean of numbers, or their words."""
        values = dict.fromkeys(row.ends.get(name) for row in self.rows)
        known = [value for value in values if value is not None]
        if len(known) < 2:
            return known[0] if known else None
        numbers = self.numbers(name)
        return statistics.fmean(numbers) if numbers else ", ".join(map(str, known))

    def deviation(self, name: str) -> float | None:
        """Return the standard deviation of an end value of two rows or more."""
        numbers = self.numbers(name)
        return statistics.stdev(numbers) if len(numbers) > 1 else None

    def band(self, name: str) -> tuple[float, float, float]:
        """Return mean, 5th and 95th percentile of an end value; NaN of none known."""
        numbers = np.array(self.numbers(name) or [np.nan])
        mean, low, high = (float(values[0]) for values in band(numbers[:, None]))
        return mean, low, high


@dataclass(frozen=True, eq=False)
class Ensemble(Generic[M]):
    """Hold groups of rows beside each other, and measured courses of friction to hold them against."""

    groups: tuple[Group[M], ...]
    experiments: tuple[Experiment, ...] = ()

    @property
    def rows(self) -> tuple[M, ...]:
        """Return the rows of all groups."""
        return tuple(row for group in self.groups for row in group.rows)

    @property
    def all_groups(self) -> tuple[Group[EnsembleRow], ...]:
        """Return the groups, and behind them a group of each measured course."""
        return (*self.groups, *(Group(e.name, (row_of(e),), "experiment") for e in self.experiments))

    @property
    def has_bands(self) -> bool:
        """Tell whether any group has several rows."""
        return any(len(group.rows) > 1 for group in self.groups)

    @property
    def one_legend(self) -> tuple[str, ...]:
        """Return the sections of a page with one legend: where several lines lie over each other."""
        return ("courses", "profiles") if len(self.groups) + len(self.experiments) > 1 else ()


def row_of(experiment: Experiment) -> EnsembleRow:
    """Return a measured course of friction as a row: its end values, and its course.

    The shape is of means over 200 equal parts where it has many more points: its numbers are slopes, which
    noise would decide.
    """
    distance, cof = experiment.course
    ends = {"distance": float(distance[-1]), "steps": distance.size, "cof": experiment.final_cof}
    if distance.size > 2 * PARTS:
        distance, cof = means_of_parts(PARTS, distance, cof)
    return EnsembleRow(experiment.name, ends | shape_of_growth(distance, cof), {"cof": experiment.course})


def means_of_parts(parts: int, distance: FloatArray, *columns: FloatArray) -> list[FloatArray]:
    """Average distances and columns over them, (n,) each, in equal parts of the whole; empty ones go.

    Between rows a course is a line: each counts by the distance it stands for, however many there are.
    """
    edges = np.linspace(0.0, distance[-1], parts + 1)
    places = np.union1d(distance, edges[edges > distance[0]])
    gaps, part = np.diff(places), np.searchsorted(edges, places[:-1], side="right") - 1
    lengths = np.bincount(part, gaps, parts)
    inside = np.minimum(np.searchsorted(edges, distance, side="right") - 1, parts - 1)
    filled = (np.bincount(inside, minlength=parts) > 0) & (lengths > 0.0)
    ends = (np.interp(places, distance, values) for values in (distance, *columns))
    return [np.bincount(part, 0.5 * (e[1:] + e[:-1]) * gaps, parts)[filled] / lengths[filled] for e in ends]


def rms_difference(course: Curve, other: Curve) -> float | None:
    """Find how two courses differ: root mean square over the distances that both have, lines between points.

    None if they share no distance.
    """
    ends = [(float(distance[0]), float(distance[-1])) for distance, _ in (course, other)]
    start, end = max(first for first, _ in ends), min(last for _, last in ends)
    if end <= start:
        return None
    places = np.unique(np.concatenate([course[0], other[0], [start, end]]))
    places = places[(places >= start) & (places <= end)]
    gap = np.interp(places, *course) - np.interp(places, *other)
    # The integral of a squared straight line, exactly.
    parts = np.diff(places) * (gap[:-1] ** 2 + gap[:-1] * gap[1:] + gap[1:] ** 2) / 3.0
    return math.sqrt(float(parts.sum()) / (end - start))
