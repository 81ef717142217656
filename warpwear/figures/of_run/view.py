"""What figures show, as plain arrays: reduced snapshots, lines through them, and the window they lie in.

Nothing here reads a result or draws one, so that a process that only draws starts quickly.

How a block of cells is reduced follows from what is asked of it. Pressure and state of contact are drawn as
the block's *largest*: contact is islands of a few cells, which means would fade out; islands look larger by
up to a block, so areas are written out as numbers. Heights and depths are *means*, which keep volumes. Where
pressure is shown as a height (in 3-D) or along a line it is the mean too, cells without contact included: the
volume under it is then the load at any block size.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from warpwear.figures.coarse import over_blocks
from warpwear.grid import FloatArray, Grid

#: From this number of whole passes on, their means are drawn over the steps.
PASSES = 8
#: The largest pressure falls where it ends below this part of what it was.
FALL = 0.9


class State(IntEnum):
    """What a cell does, by rank: a block shows the highest of its cells."""

    UNTOUCHED = 0
    TOUCHED = 1
    IN_CONTACT = 2
    AT_HARDNESS = 3


class FilmState(IntEnum):
    """What a cell has of a film, by rank, as `State`."""

    ELSEWHERE = 0
    BARE_BESIDE = 1
    ON_FILM = 2
    ON_METAL = 3


@dataclass(frozen=True)
class Cutout:
    """Cut out a part of the grid, cut into blocks of factor × factor cells."""

    x: slice
    y: slice
    factor: int
    extent: tuple[float, float, float, float]  # first x, last x, first y, last y [mm], edges of cells

    @classmethod
    def of(cls, grid: Grid, x: slice, y: slice, *, factor: int = 1) -> Self:
        """Make the window of these rows and columns of a grid, whose middle is the origin."""
        x0, x1 = ((row - 0.5 * grid.nx) * grid.cell for row in (x.start, x.stop))
        y0, y1 = ((column - 0.5 * grid.ny) * grid.cell for column in (y.start, y.stop))
        return cls(x, y, factor, (x0, x1, y0, y1))

    def means(self, field: FloatArray) -> FloatArray:
        """Return the mean of every block of a field of the grid, shape (blocks, blocks)."""
        return over_blocks(np.add, field[self.x, self.y], self.factor) / self.factor**2

    def largest(self, field: "NDArray[Any]") -> "NDArray[Any]":
        """Return the largest of every block of a field of the grid, shape (blocks, blocks)."""
        return over_blocks(np.maximum, field[self.x, self.y], self.factor)


#: Heights "counter" and "disc", depths "wear_counter" and "wear_disc" of both bodies [mm]: blocks or lines.
Fields: TypeAlias = dict[str, FloatArray]


@dataclass(frozen=True)
class View:
    """Hold the contact at one snapshot, reduced to blocks and to lines through the middle.

    cuts: "along" and "across" -> lines over "place" [mm], the counter-body's height over the apex it had, its
    material above, the disc's over its mean plane; over "bins" [mm] "pressure", the mean of a strip [MPa].
    """

    distance: float  # [mm]
    row: int  # of the history
    pressure: FloatArray  # largest of each block [MPa]
    state: "NDArray[np.uint8]"  # highest `State` of each block
    cuts: dict[str, Fields]
    film: "NDArray[np.uint8] | None" = None  # highest `FilmState` of each block; None without a film


@dataclass(frozen=True)
class PatchLoads:
    """Hold loads of the patches around the macro contact over their area [MPa], (snapshots shown, x, y)."""

    of: dict[str, FloatArray]  # "patches", and "smooth contact" where the study has one
    apart: tuple[float, ...]  # parts of the load that both put on other patches
    window: Cutout
    prescribed: bool  # the smooth contact's are the patches'


def positive(values: FloatArray) -> FloatArray:
    """Return values with NaN, which is not drawn, where they are not above zero."""
    return np.where(values > 0.0, values, np.nan)


def or_nan(heights: FloatArray) -> FloatArray:
    """Return heights of a body [mm], NaN instead of infinite where there is none."""
    return np.where(np.isinf(heights), np.nan, heights)


def last_at_hardness(course: Mapping[str, FloatArray]) -> int | None:
    """Return the row after which no cell bears the hardness, where the largest pressure then falls; or None.

    Asperities that stand out bear the hardness until wear has taken off what stands out of them. When the
    last one, often a single cell, is as low as those around it the largest pressure falls to theirs.
    """
    largest, rows = course["pressure_max"], np.flatnonzero(course["area_plastic"] > 0.0)
    if rows.size == 0 or rows[-1] == largest.size - 1:
        return None
    last = int(rows[-1])
    return last if largest[-1] < FALL * largest[last] else None
