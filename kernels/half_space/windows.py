"""Fields move between the grid of a search and others: a larger grid, and cells twice as wide.

The loops over cells are in `native/half_space/windows.h`.
"""

import warp as wp

from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.certificate import Proven
from warpwear.kernels.half_space.solve import TOGETHER, Group
from warpwear.kernels.native_code import native_pass


@wp.struct
class Transfer:
    """Holds a field, and the one of another grid that it goes to."""

    field: wp.array2d(dtype=Cells)
    target: wp.array2d(dtype=Cells)
    columns: wp.int32  # of the finer grid
    first: wp.array(dtype=wp.int32)  # row and vector of the larger grid where the window begins


@wp.struct
class Reach:
    """Tells what a contact reaches: its cells below its approach, and the level of its certificate."""

    gap: wp.array2d(dtype=Cells)
    columns: wp.int32
    groups: wp.array(dtype=Group)
    proven: wp.array(dtype=Proven)
    extents: wp.array2d(dtype=wp.float64)  # first and last row, first and last column; a column a slot


@native_pass("take_window", module=TOGETHER)
def take(transfer: Transfer):
    """Copy what a field of the larger grid holds in a window."""


@native_pass("give_window", module=TOGETHER)
def give(transfer: Transfer):
    """Copy a field of a window to where it lies in the larger grid."""


@native_pass("restrict_cells", module=TOGETHER)
def restrict(transfer: Transfer):
    """Give cells twice as wide the means of four, or of fewer at an edge; no surface where one has none."""


@native_pass("prolong_cells", module=TOGETHER)
def prolong(transfer: Transfer):
    """Give each cell the value of the wide cell that it lies in."""


@native_pass("extents", module=TOGETHER)
def extents(reach: Reach):
    """Find the extents of the cells that a contact reaches; the first ones negated."""
