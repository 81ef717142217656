"""The columns of a run's history: names, units, meanings. One row is one step.

A row holds the state solved in the step and the wear of its increment; `distance` is at its end.
"""

import math
from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray
from warpwear.study.study import Study


@dataclass(frozen=True)
class Column:
    name: str
    units: str
    meaning: str


COLUMNS = (
    Column("distance", "mm", "sliding distance at the end of the step"),
    Column("time", "s", "distance over speed; NaN without a speed"),
    Column("increment", "mm", "sliding distance of the step"),
    Column("approach", "mm", "rigid approach from the mean planes"),
    Column("load", "N", "normal load"),
    Column("load_residual", "N", "load carried at the hardness minus load asked for"),
    Column("area_contact", "mm^2", "real area of contact: cells with pressure"),
    Column("area_plastic", "mm^2", "cells at the hardness"),
    Column("area_touched", "mm^2", "cells that were ever in contact"),
    Column("area_cumulative", "mm^2", "running sum of area_contact over the steps"),
    Column(
        "area_nominal", "mm^2", "ellipse in the extents of the touched cells: the scar as one measures it"
    ),
    Column("patch_along", "mm", "extent of the touched cells along the sliding direction"),
    Column("patch_across", "mm", "extent of the touched cells across it"),
    Column("pressure_mean", "MPa", "mean over the cells in contact"),
    Column("pressure_std", "MPa", "standard deviation over the cells in contact"),
    Column("pressure_max", "MPa", "largest pressure of a cell"),
    Column("wear_volume_sphere", "mm^3", "volume worn off the sphere, summed over its wear field"),
    Column("wear_volume_disc", "mm^3", "volume worn off the disc, summed over its wear field"),
    Column("wear_depth_sphere", "mm", "deepest cell of the sphere"),
    Column("wear_depth_disc", "mm", "deepest cell of the disc"),
    Column("cof", "1", "coefficient of friction; NaN until its shear strength is calibrated"),
    Column("cells_in_contact", "1", "cells with pressure"),
    Column("archard_volume_sphere", "mm^3", "K F ΔL summed: what Archard's law asks of the sphere"),
    Column("archard_volume_disc", "mm^3", "the same of the disc, with its distance factor"),
    Column(
        "evaluations",
        "1",
        "passes over the gap that the balance took; of the half-space, pairs of transforms",
    ),
)

#: Of a swept run.
SWEPT = (
    Column("position", "mm", "place of the sphere's apex along the track, 0 in the middle of the stroke"),
    Column("plastic_volume_disc", "mm^3", "volume displaced of the disc for good, not worn"),
)


def columns_of(study: "Study") -> tuple[Column, ...]:
    """The columns that a run of the study has."""
    return COLUMNS + SWEPT if study.is_swept else COLUMNS


class Rows:
    """The rows of a run so far: as dictionaries for those who add and read them, as numbers in memory.

    A whole track makes hundreds of thousands. All have the columns of the first.
    """

    def __init__(self, rows: Iterable[dict[str, float]] = ()) -> None:
        self._names: list[str] = []
        self._values = array("d")
        for row in rows:
            self.append(row)

    def append(self, row: dict[str, float]) -> None:
        if not self._names:
            self._names = [*row]
        self._values.extend([row[name] for name in self._names])

    def __len__(self) -> int:
        return len(self._values) // max(len(self._names), 1)

    def __getitem__(self, index: int) -> dict[str, float]:
        start = range(len(self))[index] * len(self._names)
        return dict(zip(self._names, self._values[start : start + len(self._names)], strict=True))

    def __iter__(self) -> Iterator[dict[str, float]]:
        return (self[index] for index in range(len(self)))

    def column(self, name: str) -> FloatArray:
        """Shape (rows,); NaN for a column that the rows do not have."""
        if name not in self._names:
            return np.full(len(self), math.nan)
        table = np.frombuffer(self._values).reshape(len(self), len(self._names))
        return table[:, self._names.index(name)].copy()
