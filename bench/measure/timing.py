"""How the benchmark times: medians of repeats, each beside a pass over memory of the same size."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np


class Unit:
    """One pass, `numpy.subtract(S, D, out=G)` on float64 fields of cells² cells: times are divided by it."""

    def __init__(self, cells: int) -> None:
        self.cells = cells
        self._arrays = [np.full((cells, cells), value) for value in (2.0, 1.0, 0.0)]

    def seconds(self) -> float:
        """Time of a pass now."""
        counter, disc, gap = self._arrays
        start = time.perf_counter()
        np.subtract(counter, disc, out=gap)
        return time.perf_counter() - start


@dataclass(frozen=True)
class Row:
    """One measured line of the table."""

    case: str
    cells: int  # along a side
    contender: str
    seconds: list[float]  # of every repeat
    unit_seconds: list[float]  # of the pass right before each
    note: str = ""
    extra: dict[str, Any] = field(default_factory=dict)  # for the JSON only

    @property
    def median(self) -> float:
        """[s]"""
        return statistics.median(self.seconds)

    @property
    def passes(self) -> float | None:
        """Median over the median pass beside it."""
        return self.median / statistics.median(self.unit_seconds) if self.unit_seconds else None

    def record(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "case": self.case,
            "cells": self.cells,
            "contender": self.contender,
            "median_s": self.median,
            "lowest_s": min(self.seconds),
            "highest_s": max(self.seconds),
            "repeats": len(self.seconds),
            "pass_s": statistics.median(self.unit_seconds) if self.unit_seconds else None,
            "passes": self.passes,
            "note": self.note,
            "seconds": self.seconds,
            "pass_seconds": self.unit_seconds,
            **self.extra,
        }


def measure(
    run: Callable[[], float | None],
    unit: Unit,
    repeats: int,
    *,
    prepare: Callable[[], object] | None = None,
    warm_ups: int = 1,
) -> tuple[list[float], list[float]]:
    """Pass, run, pass, run …: seconds of every repeat and of the pass before it.

    prepare: done before each run, not timed. A run that times itself returns its seconds.
    """
    seconds, units = [], []
    for i in range(warm_ups + repeats):
        if prepare is not None:
            prepare()
        one_pass = unit.seconds()
        start = time.perf_counter()
        own = run()
        took = time.perf_counter() - start if own is None else own
        if i >= warm_ups:
            seconds.append(took)
            units.append(one_pass)
    return seconds, units


def ratio_note(name: str, over: Row, under: Row) -> str:
    """'name: 1.85 (1.70–1.90)', of the medians and of the repeats taken in pairs."""
    pairs = [a / b for a, b in zip(over.seconds, under.seconds, strict=True)]
    return f"{name}: {over.median / under.median:.2f} ({min(pairs):.2f}–{max(pairs):.2f})"
