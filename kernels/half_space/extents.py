"""Which cells a contact can reach: the extents of a gap below a level."""

import warp as wp

from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.solve import TOGETHER


@wp.func_native("extents(slot, slots, columns, level.data[0], gap, table);")
def _extents(
    slot: wp.int32,
    slots: wp.int32,
    columns: wp.int32,
    level: wp.array(dtype=wp.float64),
    gap: wp.array2d(dtype=Cells),
    table: wp.array2d(dtype=wp.float64),
): ...


@wp.kernel(module=TOGETHER)
def extents(
    first_slot: wp.int32,
    slots: wp.int32,
    columns: wp.int32,
    level_in: wp.array(dtype=wp.float64),
    gap_in: wp.array2d(dtype=Cells),
    table_out: wp.array2d(dtype=wp.float64),
):
    """Find first and last row, first and last column of the cells with g ≤ level; the first ones negated."""
    _extents(first_slot + wp.tid() // wp.block_dim(), slots, columns, level_in, gap_in, table_out)
