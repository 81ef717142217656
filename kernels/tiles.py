"""Tiles of a gap that a contact can reach, and the list of them.

A tile is `TILE_VECTORS` neighbouring vectors of one row: memory in one piece, wherever a row of one field
lies against a row of another. Passes visit those that the row's list names. Wear only opens gaps, so a list
of all tiles whose lowest gap lies below some limit serves every approach up to that limit.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import TileSums

wp.set_module_options(native_code.options("tiles.h"))

#: Tiles beyond which a sample of the rows, every so-many-th, tells how deep a list must reach to hold enough.
SAMPLED = wp.constant(wp.int32(20_000))
SAMPLE = wp.constant(wp.int32(4))
TWO = wp.constant(wp.float64(2.0))


@wp.struct
class Listing:
    """Tells what a list of tiles serves: it holds all with a gap up to its limit."""

    limit: wp.float64  # [mm]
    asked: wp.float64  # approach that it was asked to serve; to hold enough it may serve more [mm]
    is_fixed: wp.int32  # 1 where every tile is listed for good
    is_fresh: wp.int32  # 1 before the first list is made
    listed: wp.int32  # tiles
    lists: wp.int32  # made so far


#: One list.
LISTS = wp.array(dtype=Listing)


@wp.struct
class TileLists:
    """Tiles of a gap, and which of them are listed, row by row."""

    list: wp.array2d(dtype=wp.int32)
    count: wp.array(dtype=wp.int32)
    lowest: wp.array2d(dtype=wp.float64)  # gap, before what was worn since a tile was listed [mm]
    kept: wp.array2d(dtype=TileSums)  # of the tiles that are not listed
    rest: wp.array(dtype=TileSums)  # the sum of that over each row


@wp.func
def reached(lists: Listing, approach: wp.float64, margin: wp.float64):
    """Return the list as an approach needs it; a new one reaches a margin beyond.

    One that reaches much further than that is made anew as well: it costs more than it saves.
    """
    if lists.is_fixed == 0 and (approach > lists.limit or approach + TWO * margin < lists.asked):
        lists.limit = approach + margin
        lists.asked = lists.limit
    return lists


@wp.func
def list_from(lists: Listing, lowest: wp.float64):
    """Return the list that a first search begins with, from the lowest gap [mm]; else the one made before."""
    if lists.is_fixed == 0 and lists.is_fresh == 1:
        lists.limit = lowest
        lists.asked = lowest
    return lists


@wp.func_native("return limit_of_rank(lowest, rows_apart, tiles, limit);")
def limit_of(
    lowest: wp.array2d(dtype=wp.float64), rows_apart: wp.int32, tiles: wp.int32, limit: wp.float64
) -> wp.float64:
    """Return the limit up to which so many tiles of a sample of the rows have a cell."""
