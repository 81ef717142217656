"""The gap of two bodies at rest: which parts of it a contact can reach, and Archard's wear of them.

A tile is `TILE_VECTORS` neighbouring vectors of one row: memory in one piece, wherever a row of one field
lies against a row of another. A kernel over tiles runs a slot a row (several, on a GPU) and visits those that
the row's list names. Wear only opens gaps, so a list of all tiles whose lowest gap lies below some limit
serves every approach up to that limit.

Both bodies open one gap and wear in one proportion: what is worn of them together is the gap less the gap of
the bodies as they were. One file, as each is compiled by itself and most of that time goes to Warp's headers.
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
    sum_of,
)
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.wear_loops import Increment, Tables, wear

wp.set_module_options({"enable_backward": False})


@wp.kernel
def lowest(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    field_in: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
):
    """Smallest value of every tile."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for t in range(slot % slots_per_row, lowest_out.shape[1], slots_per_row):
        low = field_in[row, t * TILE_VECTORS]
        for k in range(t * TILE_VECTORS + 1, wp.min((t + 1) * TILE_VECTORS, field_in.shape[1])):
            low = wp.min(low, field_in[row, k])
        lowest_out[row, t] = wp.min(low)


@wp.func
def kept_of(row: wp.int32, t: wp.int32, gap: wp.array2d(dtype=Cells), unworn: wp.array2d(dtype=Cells)):
    """Number of worn cells of a tile, and the sum of their wear."""
    touched = ZERO
    both = Cells(ZERO)
    for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap.shape[1])):
        worn = gap[row, k] - unworn[row, k]
        both += worn
        for j in range(LANES):
            touched += wp.where(worn[j] > ZERO, ONE, ZERO)
    return TileSums(touched, sum_of(both))


@wp.kernel
def select(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    limit: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    unworn_in: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
    kept_out: wp.array2d(dtype=TileSums),
    rest_out: wp.array(dtype=TileSums),
    list_out: wp.array2d(dtype=wp.int32),
    count_out: wp.array(dtype=wp.int32),
):
    """Lists anew, row by row, the tiles whose smallest gap does not exceed the limit.

    Of a tile that leaves the list it is kept what `wear_step` sums over listed tiles only; `rest_out` is
    the sum of that over each row.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0:  # a list is written in order, by one slot
        return
    for n in range(count_out[row]):  # the gaps of other tiles are what they were
        t = list_out[row, n]
        low = Cells(ABSENT)
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            low = wp.min(low, gap_in[row, k])
        lowest = wp.min(low)
        lowest_out[row, t] = lowest
        if lowest > limit:
            kept_out[row, t] = kept_of(row, t, gap_in, unworn_in)
    count = wp.int32(0)
    rest = TileSums()
    for t in range(lowest_out.shape[1]):
        if lowest_out[row, t] <= limit:
            list_out[row, count] = t
            count += 1
        else:
            rest += kept_out[row, t]
    count_out[row] = count
    rest_out[row] = rest


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
