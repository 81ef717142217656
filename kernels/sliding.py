"""A disc displaced under the ball by whole cells: which tiles can touch, their gap, and the wear of both.

Heights of the ball and of the disc are kept apart, as worn. Below the ball's row i lies the disc's row
i + shift, modulo the disc's length: the same vectors of another row, so nothing is copied. Of every tile of
the ball the lowest height is kept and of every tile of the disc the highest, eight tiles in one vector like
the cells of a field; their difference bounds the gap of a pair of tiles from below. The loops are C++:
native/sliding.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import Springs
from warpwear.kernels.cells import LISTED, NONE, OF_CELLS, CellProperties, Cells
from warpwear.kernels.tiles import LISTS

native_pass = native_code.passes_of(__name__, "sliding.h")

#: A list that holds too little reaches deeper by this much at first [mm], by this many times more each time,
#: and beyond some depth to every tile [mm].
FIRST_DEPTH = wp.constant(wp.float64(1.0e-5))
DEEPER = wp.constant(wp.float64(4.0))
DEEPEST = wp.constant(wp.float64(0.1))


@wp.struct
class Removal:
    """Tells what a step takes off cells, by the pressure that they bear and by their shear."""

    k_counter: wp.float64  # K ΔL of what leaves at once, of cells with a ratio of 1 [mm³/N]
    k_disc: wp.float64
    pending_counter: wp.float64  # K ΔL of what leaves in pieces [mm³/N]
    pending_disc: wp.float64
    shear_counter: wp.float64  # depth that a cell in contact all the step loses by its shear [mm]
    shear_disc: wp.float64
    least_shear_ratio: wp.float64  # of a cell, and the largest
    most_shear_ratio: wp.float64
    slipping_counter: wp.float64  # K ΔL over the distance of a cycle, of what slips by cells [mm²/N]
    slipping_disc: wp.float64
    slip_of_gap: wp.float64  # of a cycle [mm], over a gap [mm]
    growth_ahead: wp.float64  # of what slips grew by in the last jump, to the end of this one


@wp.struct
class Slide:
    """Describes a step of a pair of bodies, or a part of one; passes read it from an array of one."""

    number: wp.int32  # of the step in its replay
    rows: wp.int32  # of cells that are visited
    shift: wp.int32  # the disc's row under the counter-body's first
    window: wp.int32  # rows of the disc that pass over one of the counter-body
    first_column: wp.int32  # first column that was ever touched, and the one after the last
    end_column: wp.int32
    counter_moves: wp.int32  # 1 where pressures move with the counter-body, so that the disc sees their mean
    start: wp.float64  # sliding distance at its start and at its end [mm]
    end: wp.float64
    own: wp.float64  # compliance that is not wear [mm³/N]
    compliance: wp.float64  # of a cell that slides as far as the middle [mm³/N]
    stiffness: wp.float64  # 1/c where that is of all cells, else 0 [N/mm³]
    yield_depth: wp.float64  # overlap of a cell at the hardness [mm]; NONE: the disc springs back
    approach: wp.float64  # [mm]
    reference: wp.float64  # squares are those of the deviation from it [MPa]
    removal: Removal


#: Steps, of which passes read the first.
SLIDES = wp.array(dtype=Slide)


@wp.struct
class Bodies:
    """Fields of both bodies [mm], and the gap of the tiles listed."""

    counter: wp.array2d(dtype=Cells)  # height, as worn
    disc: wp.array2d(dtype=Cells)
    wear_counter: wp.array2d(dtype=Cells)
    wear_disc: wp.array2d(dtype=Cells)
    plastic_disc: wp.array2d(dtype=Cells)  # displaced for good; not looked at of a disc that springs back
    reached: wp.array2d(dtype=Cells)  # 1 where a ball that does not wear was in contact; else one row
    gap: wp.array2d(dtype=Cells)


@wp.struct
class RowSums:
    """Holds the sums of `TileBounds` over every row of the counter-body and of the disc."""

    touched: wp.array(dtype=wp.float64)
    worn_counter: wp.array(dtype=wp.float64)
    worn_disc: wp.array(dtype=wp.float64)
    pressed_disc: wp.array(dtype=wp.float64)


@wp.struct
class TileBounds:
    """Bounds and sums that are kept of every tile of either body, rows × tiles."""

    lowest: wp.array2d(dtype=wp.float64)  # height of the counter-body [mm]
    highest: wp.array2d(dtype=wp.float64)  # of the disc [mm]
    gap: wp.array2d(dtype=wp.float64)  # lowest, of tiles listed; none where more than wear changes it [mm]
    touched: wp.array2d(dtype=wp.float64)  # cells of the counter-body
    worn_counter: wp.array2d(dtype=wp.float64)  # sums [mm]
    worn_disc: wp.array2d(dtype=wp.float64)
    pressed_disc: wp.array2d(dtype=wp.float64)  # displaced for good; one row where the disc springs back
    rows: RowSums


@wp.struct
class Bounds:
    """Lower bounds of the gap [mm]. Invariant: gaps only grow. Whoever raises a surface refreshes them."""

    lowest_of_eight: wp.array2d(dtype=wp.float64)  # of neighbouring tiles of the counter-body
    highest_of_row: wp.array(dtype=wp.float64)  # of the disc
    lowest: wp.array2d(dtype=Cells)  # of the counter-body's tiles, eight in a vector
    highest: wp.array2d(dtype=Cells)  # of the disc's
    gap: wp.array2d(dtype=Cells)  # lowest of pairs of tiles; 0 where it was never made
    keeps_gap: wp.int32  # 1 where that and the gap stay as they are made and worn


@wp.struct
class StepTables:
    """Holds tables of partial results of a step, one column a slot."""

    sums: wp.array2d(dtype=wp.float64)  # lines of `TrackSum`
    maxima: wp.array2d(dtype=wp.float64)  # lines of `TrackMost`
    bearing: wp.array2d(dtype=wp.float64)  # cells' area that bears, where not all that is in contact does


#: A step whose balance is found: the tiles listed, what it is, and its search.
SOLVED = {**LISTED, "slides": SLIDES, "springs": Springs}
#: List, row by row, the tiles with a gap that does not exceed the limit, and write their gaps.
select = native_pass(
    "select_tiles", lists=LISTS, slides=SLIDES, bounds=Bounds, **OF_CELLS, bodies=Bodies, **LISTED
)


@wp.func_native("return count_listed(count);")
def _count_listed(count: wp.array(dtype=wp.int32)) -> wp.int32: ...


@wp.kernel
def check_list(
    lists: LISTS,
    listing: wp.array(dtype=wp.int32),
    depth: wp.array(dtype=wp.float64),
    count: wp.array(dtype=wp.int32),
    least: wp.int32,
):
    """Decides whether a list holds enough tiles, or must reach deeper. depth: by how much [mm]."""
    tiles = _count_listed(count)
    if wp.tid() == 0:
        now = lists[0]
        now.listed = tiles
        now.lists = now.lists + 1
        now.asked = -NONE  # a list that reaches too far is as good
        listing[0] = 0
        if tiles < least and now.limit < NONE:
            now.limit = wp.where(depth[0] < DEEPEST, now.limit + depth[0], NONE)
            depth[0] = DEEPER * depth[0]
            listing[0] = 1
        else:
            depth[0] = FIRST_DEPTH
        lists[0] = now


#: One increment of wear in place: each body loses K p ΔL.
#:
#: What goes beyond the full depth is displaced from the disc for good, not worn. Of the tiles listed the
#: gap, the bounds and the sums are made anew, also of their rows. Columns count that lie beyond the
#: known ones.
wear_step = native_pass(
    "wear_tiles", **SOLVED, cells=CellProperties, bodies=Bodies, tile_bounds=TileBounds, tables=StepTables
)
