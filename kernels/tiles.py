"""Tiles: which parts of a field a contact can reach.

A tile is `TILE_VECTORS` neighbouring vectors of one row: memory in one piece, wherever a row of one field
lies against a row of another. A kernel over tiles runs a slot a row (several, on a GPU) and visits those that
the row's list names. Wear only opens gaps, so a list of all tiles whose lowest gap lies below some limit
serves every approach up to that limit.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, ONE, TILE_VECTORS, ZERO, Cells, TileSums, sum_of

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

    Of a tile that leaves the list it is kept what `wear.wear_step` sums over listed tiles only; `rest_out` is
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
