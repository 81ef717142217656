"""Archard's wear of both bodies, cell by cell, and the figures of the step that wore them.

Both bodies open one gap and wear in one proportion: what is worn of them together is the gap less the gap of
the bodies as they were.
"""

import warp as wp

from warpwear.kernels.cells import (
    ABSENT,
    LANES,
    NO_INDEX,
    ONE,
    TILE_VECTORS,
    ZERO,
    Cells,
    TileSums,
    WearMost,
    WearSum,
)
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.wear_loops import Increment, Tables, wear

wp.set_module_options({"enable_backward": False})


@wp.func
def wear_slot(
    slot: wp.int32,
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
    """One increment of wear of the tiles listed of a slot; arguments as of `wear_step`."""
    row = slot // slots_per_row
    lane = slot % slots_per_row

    rest = rest_in[row]
    part = wp.where(lane == 0, ONE, ZERO)
    if lane >= count_in[row]:  # nothing to do: most rows of an early contact
        for i in range(wp.static(len(WearSum))):
            tables.sums[i, slot] = ZERO
        tables.sums[WearSum.TOUCHED, slot] = part * rest[0]
        tables.sums[WearSum.WORN, slot] = part * rest[1]
        for i in range(wp.static(len(WearMost))):
            tables.maxima[i, slot] = NO_INDEX
        tables.maxima[WearMost.PRESSURE, slot] = ZERO
        tables.maxima[WearMost.WORN, slot] = ZERO
        tables.ahead[0, slot] = ZERO
        tables.ahead[1, slot] = ZERO
        tables.ahead[2, slot] = ABSENT
        return
    wear(slot, slots_per_row, tiles_in, count_in, law, step, unworn_in, gap_out, tables)
    here = tables.sums[WearSum.TOUCHED, slot] > ZERO
    tables.sums[WearSum.TOUCHED, slot] = tables.sums[WearSum.TOUCHED, slot] + part * rest[0]
    tables.sums[WearSum.WORN, slot] = tables.sums[WearSum.WORN, slot] + part * rest[1]
    first_column = NO_INDEX + ZERO  # a variable of its own
    last_column = NO_INDEX + ZERO
    vectors = gap_out.shape[1]
    if here:
        n = lane
        while (
            n < count_in[row]
            and first_column == NO_INDEX
            and tiles_in[row, n] * TILE_VECTORS * LANES < step.first_column
        ):
            t = tiles_in[row, n]
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, vectors)):
                g = gap_out[row, k]
                u = unworn_in[row, k]
                for j in range(LANES):
                    # Where nothing wears the gap is as it was, and what touched does so still.
                    p = pressure_of(law, g[j], step.stiffness)
                    if first_column == NO_INDEX and p + (g[j] - u[j]) > ZERO:
                        first_column = -wp.float64(k * LANES + j)
            n += slots_per_row
        n = lane + (count_in[row] - 1 - lane) // slots_per_row * slots_per_row
        while (
            n >= 0
            and last_column == NO_INDEX
            and (tiles_in[row, n] + 1) * TILE_VECTORS * LANES > step.last_column + 1
        ):
            t = tiles_in[row, n]
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, vectors)):
                g = gap_out[row, k]
                u = unworn_in[row, k]
                for j in range(LANES):
                    p = pressure_of(law, g[j], step.stiffness)
                    if p + (g[j] - u[j]) > ZERO:
                        last_column = wp.float64(k * LANES + j)
            n -= slots_per_row
    tables.maxima[WearMost.FIRST_ROW, slot] = wp.where(here, -wp.float64(row), NO_INDEX)
    tables.maxima[WearMost.LAST_ROW, slot] = wp.where(here, wp.float64(row), NO_INDEX)
    tables.maxima[WearMost.FIRST_COLUMN, slot] = first_column
    tables.maxima[WearMost.LAST_COLUMN, slot] = last_column


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
    wear_slot(slot, slots_per_row, tiles_in, count_in, law, step, unworn_in, rest_in, gap_out, tables)
