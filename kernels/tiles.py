"""Tiles of a gap that a contact can reach, and the list of them.

A tile is `TILE_VECTORS` neighbouring vectors of one row: memory in one piece, wherever a row of one field
lies against a row of another. Passes visit those that the row's list names. Wear only opens gaps, so a list
of all tiles whose lowest gap lies below some limit serves every approach up to that limit.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import ABSENT, LANES, NONE, ONE, TILE_VECTORS, ZERO, Cells, TileSums, sum_of

wp.set_module_options(native_code.options("tiles.h"))

#: Tiles beyond which a sample of the rows, every so-many-th, tells how deep a list must reach to hold enough.
SAMPLED = wp.constant(wp.int32(20_000))
SAMPLE = wp.constant(wp.int32(4))
TWO = wp.constant(wp.float64(2.0))


@wp.struct
class Listing:
    """What a list of tiles serves: it holds all with a gap up to its limit."""

    limit: wp.float64  # [mm]
    asked: wp.float64  # approach that it was asked to serve; to hold enough it may serve more [mm]
    is_fixed: wp.int32  # 1 where every tile is listed for good
    is_fresh: wp.int32  # 1 before the first list is made
    listed: wp.int32  # tiles
    lists: wp.int32  # made so far


@wp.struct
class Tiles:
    """Tiles of a gap, and which of them are listed, row by row."""

    list: wp.array2d(dtype=wp.int32)
    count: wp.array(dtype=wp.int32)
    lowest: wp.array2d(dtype=wp.float64)  # gap, before what was worn since a tile was listed [mm]
    kept: wp.array2d(dtype=TileSums)  # of the tiles that are not listed
    rest: wp.array(dtype=TileSums)  # the sum of that over each row


@wp.func
def reached(before: Listing, approach: wp.float64, margin: wp.float64):
    """The list as an approach needs it; a new one reaches a margin beyond.

    One that reaches much further than that is made anew as well: it costs more than it saves.
    """
    lists = before
    if lists.is_fixed == 0 and (approach > lists.limit or approach + TWO * margin < lists.asked):
        lists.limit = approach + margin
        lists.asked = lists.limit
    return lists


@wp.kernel
def lowest(
    first_slot: wp.int32,
    slots: wp.int32,
    field: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
):
    """Smallest value of every tile."""
    slot = first_slot + wp.tid() // wp.block_dim()
    for row in range(slot, field.shape[0], slots):
        for t in range(wp.tid() % wp.block_dim(), lowest_out.shape[1], wp.block_dim()):
            low = field[row, t * TILE_VECTORS]
            for k in range(t * TILE_VECTORS + 1, wp.min((t + 1) * TILE_VECTORS, field.shape[1])):
                low = wp.min(low, field[row, k])
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
    slots: wp.int32,
    lists: wp.array(dtype=Listing),
    gap: wp.array2d(dtype=Cells),
    unworn: wp.array2d(dtype=Cells),
    tiles: Tiles,
):
    """Lists anew, row by row, the tiles whose smallest gap does not exceed the limit. On a CPU.

    Of a tile that leaves the list it is kept what the pass that wears sums over listed tiles only.
    """
    row = first_slot + wp.tid()
    limit = lists[0].limit
    for n in range(
        wp.where(lists[0].is_fresh == 1, 0, tiles.count[row])
    ):  # gaps of others are what they were
        t = tiles.list[row, n]
        low = Cells(ABSENT)
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap.shape[1])):
            low = wp.min(low, gap[row, k])
        smallest = wp.min(low)
        tiles.lowest[row, t] = smallest
        if smallest > limit:
            tiles.kept[row, t] = kept_of(row, t, gap, unworn)
    count = wp.int32(0)
    rest = TileSums()
    for t in range(tiles.lowest.shape[1]):
        if tiles.lowest[row, t] <= limit:
            tiles.list[row, count] = t
            count += 1
        else:
            rest += tiles.kept[row, t]
    tiles.count[row] = count
    tiles.rest[row] = rest


@wp.func_native("return limit_of_rank(lowest, rows_apart, tiles, limit);")
def limit_of(
    lowest: wp.array2d(dtype=wp.float64), rows_apart: wp.int32, tiles: wp.int32, limit: wp.float64
) -> wp.float64:
    """The limit up to which so many tiles of a sample of the rows have a cell."""
    ...


@wp.kernel
def listed(
    first_slot: wp.int32,
    slots: wp.int32,
    lists: wp.array(dtype=Listing),
    listing: wp.array(dtype=wp.int32),
    tiles: Tiles,
    least: wp.int32,
):
    """Decides whether a list holds enough tiles, or must reach deeper than it was asked to. On a CPU."""
    now = lists[0]
    now.is_fresh = 0
    now.lists = now.lists + 1
    now.listed = 0
    rows = tiles.count.shape[0]
    for row in range(rows):
        now.listed = now.listed + tiles.count[row]
    listing[0] = 0
    if now.listed < least and now.limit == now.asked and now.limit < NONE:
        apart = wp.where(rows * tiles.lowest.shape[1] > SAMPLED, SAMPLE, 1)
        deeper = limit_of(tiles.lowest, apart, least / apart + 1, now.limit)
        if deeper > now.limit:
            now.limit = deeper
            listing[0] = 1
    lists[0] = now
