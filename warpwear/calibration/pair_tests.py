"""One number of several tests of a pair: mean, scatter, trend, and each test beside what the others say."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.calibration.measurements import Value
from warpwear.calibration.scatter import Scatter, ScatterModel, count_needed
from warpwear.ensembles.datum import Datum
from warpwear.ensembles.ensemble import Curve
from warpwear.grid import FloatArray
from warpwear.measured.friction.analysis import RecordStep

#: Conditions over which there may be a trend -> their units.
CONDITIONS = {"load": "N", "speed": "mm/s", "radius": "mm", "track_radius": "mm"}


@dataclass(frozen=True, eq=False)
class PairTest:
    """A test of a pair: its conditions, its numbers with their errors, and its course of friction [m].

    Conditions are those of `CONDITIONS`, distance and length of the track [mm], where they are known. Numbers
    of a part under one load of several end in that: "level at 5 N".
    """

    name: str
    conditions: Mapping[str, float]
    values: Mapping[str, Value]
    course: Curve | None = None
    laps: float | None = None  # of the incubation
    notes: tuple[str, ...] = ()
    steps: tuple[RecordStep, ...] = ()


@dataclass(frozen=True, eq=False)
class RepeatedNumber:
    """One number of several tests. over: conditions of its trend; at: those of the next test."""

    kind: str
    tests: tuple[PairTest, ...]
    over: tuple[str, ...]
    at: Mapping[str, float]
    label: str = ""
    unit: str = ""

    @cached_property
    def values(self) -> FloatArray:
        """Return the measured numbers, (tests,)."""
        return np.array([test.values[self.kind].value for test in self.tests])

    @cached_property
    def scale(self) -> float | None:
        """Return the unit of numbers that are no logarithms, as some are zero; else None."""
        return None if self.values.min() > 0.0 else float(self.values.mean())

    @cached_property
    def pair(self) -> ScatterModel:
        """Return what the tests tell of the pair, in logarithms or in `scale`."""
        errors = np.array([test.values[self.kind].error or 0.0 for test in self.tests])
        y = np.log(self.values) if self.scale is None else self.values / self.scale
        x = np.array([self.place(test.conditions) for test in self.tests])
        return ScatterModel(y, errors / (self.values if self.scale is None else self.scale), x)

    def place(self, conditions: Mapping[str, float]) -> FloatArray:
        """Return conditions of a test as those of `ScatterModel`: logarithms over those of the next test."""
        return np.array([1.0, *(math.log(conditions[name] / self.at[name]) for name in self.over)])

    def back(self, y: float) -> float:
        """Return a number in its unit."""
        return math.exp(y) if self.scale is None else max(0.0, y * self.scale)

    def size(self, y: float) -> float:
        """Return what an error of `ScatterModel` is in the unit of the number."""
        return self.back(y) if self.scale is None else self.scale

    @cached_property
    def next(self) -> FloatArray:
        """Return the conditions of the next test, of which every trend is taken from there."""
        return self.place(self.at)

    @cached_property
    def corrected(self) -> Scatter:
        """Return the numbers of the tests as if all were made under the next one's conditions."""
        slopes = [self.pair.mean(row)[0] for row in np.eye(self.next.size)[1:]]
        shift = self.pair.conditions[:, 1:] @ np.array(slopes)
        values = [self.back(float(y)) for y in self.pair.y - shift] if self.over else self.values.tolist()
        return Scatter(values, [test.values[self.kind].error for test in self.tests])

    @property
    def s(self) -> float | None:
        """Return the standard deviation of the tests about their mean, or trend; None of too few."""
        free, deviation = len(self.tests) - self.next.size, self.corrected.deviation
        return None if free < 1 or deviation is None else deviation * math.sqrt((len(self.tests) - 1) / free)

    @property
    def interval(self) -> tuple[float, float]:
        """Return where the next test lies."""
        low, high = self.pair.interval(self.next, float(np.median(self.pair.errors)))
        return self.back(low), self.back(high)

    @cached_property
    def data(self) -> list[tuple[Datum, bool]]:
        """Set each test beside what the others say of it, and whether it lies in their interval."""
        rows = []
        for number, (test, value) in enumerate(zip(self.tests, self.values.tolist(), strict=True)):
            others, x, u = self.pair.without(number), self.pair.conditions[number], self.pair.errors[number]
            if others.is_known:
                mean, deviation = others.next(x, u)
                computed, off = self.back(mean), (self.pair.y[number] - mean) / deviation
                low, high = (self.back(end) for end in others.interval(x, u))
                error = float((value - computed) / off) if off else self.size(mean) * deviation
                name = ", ".join(filter(None, (test.name, self.label)))
                rows.append((Datum(name, value, computed, error, self.unit), low <= value <= high))
        return rows

    def numbers(self, wanted: float) -> dict[str, Any]:
        """Return all that is told of it. wanted: error of the mean as a part of it."""
        scatter, trend = self.pair.scatter, np.eye(self.next.size)[1:]
        mean, deviation = self.pair.mean(self.next)
        each = float(np.median(self.pair.errors))
        needed, most = (count_needed(math.hypot(s, each), wanted) for s in (scatter[0], scatter[2]))
        return {
            "unit": self.unit,
            "mean": self.corrected.mean,
            "s": self.s,
            "n": len(self.tests),
            "pair": self.back(mean),
            "pair_error": self.size(mean) * deviation,
            "scatter": dict(zip(("median", "low", "high"), scatter, strict=True)),
            "next_low": self.interval[0],
            "next_high": self.interval[1],
            "at": {name: self.at[name] for name in self.over},
            "trend": {name: self.pair.mean(row) for name, row in zip(self.over, trend, strict=True)},
            "tests_needed": needed,
            "tests_needed_at_most": most,
            "left_out_within": sum(within for _, within in self.data),
            "left_out": len(self.data),
        }
