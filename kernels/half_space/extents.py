"""Which cells a contact can reach: the extents of a gap below a level."""

import warp as wp

from warpwear.kernels.cells import LANES, NONE, ZERO, Cells, largest_of, lowest_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def extents(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    level: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """First and last row, first and last column of the cells with g ≤ level; the first ones negated."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    first = Cells(-NONE)
    last = Cells(-NONE)
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        if lowest_of(g) <= level:  # as in few vectors
            for j in range(LANES):
                column = wp.float64(k * LANES + j)
                below = k * LANES + j < columns and g[j] <= level
                first[j] = wp.max(first[j], wp.where(below, -column, -NONE))
                last[j] = wp.max(last[j], wp.where(below, column, -NONE))
    furthest = largest_of(last)
    maxima_out[0, slot] = wp.where(furthest >= ZERO, -wp.float64(row), -NONE)
    maxima_out[1, slot] = wp.where(furthest >= ZERO, wp.float64(row), -NONE)
    maxima_out[2, slot] = largest_of(first)
    maxima_out[3, slot] = furthest
