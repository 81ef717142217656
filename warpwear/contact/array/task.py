"""The solvers of an array's contact get tasks and return solutions.

They work on cells of width 1 that a unit of pressure displaces by a unit of length, so that none of their
thresholds is a length or a pressure of the caller's: see `Task`.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from warpwear.contact.certificate import Certificate
from warpwear.engine.staging import each
from warpwear.grid import FloatArray, Grid, blocks_of_rows
from warpwear.laws.form import Form

#: Cells looked at together, which stay in the cache of a core.
TOGETHER = 2**16
#: Relative rounding of a load: it may exceed as much what the hardness carries.
ROUNDING = 1.0e-12


class Gap(NamedTuple):
    """A gap before contact is made in the caller's units, from the heights' mean plane, by blocks of rows."""

    heights: FloatArray
    middle: float  # of the mean plane
    grid: Grid
    form: Form | FloatArray | None  # of the counter-body, or its heights; None for a plane

    def __call__(self, rows: slice, out: FloatArray | None = None) -> FloatArray:
        """Return the gap in some rows, infinite beyond the ball's edge. out: where it is to be laid."""
        gap = np.subtract(self.middle, self.heights[rows], out=out)
        if isinstance(self.form, Form):
            gap += self.form.heights(self.grid.x[rows], self.grid.y)
        elif self.form is not None:
            gap += self.form[rows]
        return gap


@dataclass(frozen=True, kw_only=True)
class Task:
    """A contact has units in which its cells are 1 wide and a unit of pressure displaces by a unit of length.

    length: the caller's lengths over those here, of the order of what heights and displacements span.
    pressure: the caller's pressures over those here, so that E* or the stiffness is 1 here, or the hardness
    where there is neither.
    """

    unscaled: Gap
    length: float
    pressure: float
    mean: float | None  # pressure; None at an approach
    approach: float | None
    cap: float
    response: float  # displacement under a unit of pressure: 1, or 0 for the bearing area
    edge: str | None  # boundary of the half-space; None: the cells do not feel each other
    threads: int

    @property
    def shape(self) -> tuple[int, int]:
        """Return the number of cells of all fields along both axes."""
        return self.unscaled.grid.shape

    def gap_of(self, rows: slice, out: FloatArray | None = None) -> FloatArray:
        """Return the gap in some rows, infinite beyond the ball's edge. out: where it is to be laid."""
        gap = self.unscaled(rows, out)
        return np.divide(gap, self.length, out=gap)

    @cached_property
    def gap(self) -> FloatArray:
        """Return the gap of all cells, shape (nx, ny)."""
        gap = np.empty(self.shape)
        each(lambda rows: self.gap_of(rows, gap[rows]), self.shape, self.threads)
        return gap

    @cached_property
    def rms(self) -> float:
        """Return the rms height of the gap."""
        return rms_of(self.gap)


class Solution(NamedTuple):
    """Holds a solved task, in its units. Its fields are arrays of NumPy, or of Warp on a GPU."""

    pressure: Any
    displacement: Any
    approach: float
    evaluations: int
    allowed: float = 0.0  # violation that its solver allowed itself
    certificate: Certificate | None = None  # of all cells, where its solver has made one


def surface_of(gap: FloatArray) -> FloatArray:
    """Return the gap where there is a surface; the array itself where there is one everywhere."""
    return gap if math.isfinite(gap.max()) else gap[np.isfinite(gap)]


def rms_of(gap: FloatArray) -> float:
    """Return the rms height of a gap where there is a surface, block by block; 0 of a flat, to the digit."""
    blocks = [
        surface_of(gap[rows]) for rows in blocks_of_rows(len(gap), values=gap.shape[1], together=TOGETHER)
    ]
    blocks = [block for block in blocks if block.size]
    if not blocks or max(block.max() for block in blocks) == min(block.min() for block in blocks):
        return 0.0
    count = sum(block.size for block in blocks)
    mean = sum(block.sum() for block in blocks) / count
    return math.sqrt(sum(float(np.square(block - mean).sum()) for block in blocks) / count)
