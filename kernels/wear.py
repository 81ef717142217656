"""Archard's wear of both bodies, cell by cell, and the figures of the step that wore them.

Both bodies open one gap and wear in one proportion: what is worn of them together is the gap less the gap of
the bodies as they were.
"""

import warp as wp

from warpwear.kernels.cells import LANES, NO_INDEX, TILE_VECTORS, ZERO, Cells, TileSums, WearMost, WearSum
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.wear_loops import Increment, Tables, wear

wp.set_module_options({"enable_backward": False})


@wp.kernel
def wear_step(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    step: Increment,
    unworn_in: wp.array2d(dtype=Cells),
    rest_in: wp.array(dtype=TileSums),
    gap_out: wp.array2d(dtype=Cells),
    tables: Tables,
):
    """One increment of wear in place: the gap opens by K p ΔL of both bodies.

    rest_in: of the tiles of each row that are not listed. Sums and maxima of the step go to `tables`.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    lane = slot % slots_per_row
    wear(slot, slots_per_row, tiles_in, count_in, law, step, unworn_in, gap_out, tables)
    here = tables.sums[WearSum.TOUCHED, slot] > ZERO
    if lane == 0:
        rest = rest_in[row]
        tables.sums[WearSum.TOUCHED, slot] = tables.sums[WearSum.TOUCHED, slot] + rest[0]
        tables.sums[WearSum.WORN, slot] = tables.sums[WearSum.WORN, slot] + rest[1]
    first_column = NO_INDEX + ZERO  # a variable of its own
    last_column = NO_INDEX + ZERO
    if here:
        for n in range(lane, count_in[row], slots_per_row):
            first = tiles_in[row, n] * TILE_VECTORS
            last = wp.min(first + TILE_VECTORS, gap_out.shape[1])
            if first * LANES < step.first_column or last * LANES - 1 > step.last_column:
                for k in range(first, last):
                    g = gap_out[row, k]
                    u = unworn_in[row, k]
                    for j in range(LANES):
                        # Where nothing wears the gap is as it was, and what touched does so still.
                        p = pressure_of(law, g[j], step.stiffness)
                        if p + (g[j] - u[j]) > ZERO:
                            first_column = wp.max(first_column, -wp.float64(k * LANES + j))
                            last_column = wp.max(last_column, wp.float64(k * LANES + j))
    tables.maxima[WearMost.FIRST_ROW, slot] = wp.where(here, -wp.float64(row), NO_INDEX)
    tables.maxima[WearMost.LAST_ROW, slot] = wp.where(here, wp.float64(row), NO_INDEX)
    tables.maxima[WearMost.FIRST_COLUMN, slot] = first_column
    tables.maxima[WearMost.LAST_COLUMN, slot] = last_column
