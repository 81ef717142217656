"""A disc displaced under the sphere by whole cells: which tiles can touch, their gap, and the wear of both.

Heights of the sphere and of the disc are kept apart, as worn. Below the sphere's row i lies the disc's row
i + shift, modulo the disc's length: the same vectors of another row, so nothing is copied. Of every tile of
the sphere the lowest height is kept and of every tile of the disc the highest, eight tiles in one vector like
the cells of a field; their difference bounds the gap of a pair of tiles from below.

A step is a list of tiles, as each displacement has its own, a search for the load balance, see `balance`
and `bearing`, a pass that wears, and a row of the history. The search begins at the last approach, which it
may be off by as much as it has lately changed. The loops are C++: native/sliding.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import Springs, ask_for, search_from, search_from_lowest
from warpwear.kernels.bearing import area_between, area_near
from warpwear.kernels.cells import (
    ABSENT,
    NONE,
    ONE,
    TILE_VECTORS,
    ZERO,
    Cells,
    TrackMost,
    TrackSum,
    lowest_of,
)
from warpwear.kernels.newton import HALF, STUCK
from warpwear.kernels.slide import Slide
from warpwear.kernels.tiles import Listing, reached
from warpwear.kernels.wear import BALANCE, total_of

wp.set_module_options(native_code.options("wear.h", "bodies.h", "sliding.h"))

#: Columns of the plan, a row a step: of `Slide`, the compliance of a cell that slides as far as the middle
#: [mm³/N], and 1/c where that is of all cells, else 0 [N/mm³].
PLAN = (
    *("shift", "start", "end", "of_sphere", "of_disc", "pending_sphere", "pending_disc", "own"),
    *("compliance", "stiffness"),
)
#: Sums over tiles and rows: columns of the history after those of `BALANCE`, `TrackSum` and `TrackMost`.
KEPT = ("touched", "worn_sphere", "worn_disc", "pressed_disc")
#: What follows them.
LAST = ("first_row", "last_row", "bearing")
TOTALS = wp.constant(wp.int32(len(BALANCE)))
MAXIMA = wp.constant(wp.int32(len(BALANCE) + len(TrackSum)))
OF_ROWS = wp.constant(wp.int32(len(BALANCE) + len(TrackSum) + len(TrackMost)))
#: Changes of the approach from which the next is expected, and how many times the largest it may be.
CHANGES = wp.constant(wp.int32(8))
TIMES = wp.constant(wp.float64(2.0))
#: Of a list that serves several steps: how many times further it reaches.
AHEAD = wp.constant(wp.float64(1.0))
#: What the approach may change by when nothing is known of it, and at least [mm].
FIRST_SCATTER = wp.constant(wp.float64(1.0e-4))
LEAST_SCATTER = wp.constant(wp.float64(1.0e-6))
#: A list that holds too little reaches deeper by this much at first [mm], by this many times more each time,
#: and beyond some depth to every tile [mm].
FIRST_DEPTH = wp.constant(wp.float64(1.0e-5))
DEEPER = wp.constant(wp.float64(4.0))
DEEPEST = wp.constant(wp.float64(0.1))


@wp.struct
class OfCells:
    """What cells may have one each of, or one row for all; none where it is the same for all."""

    stiffness: wp.array2d(dtype=Cells)  # 1/c [N/mm³]
    factor: wp.array2d(dtype=Cells)  # of the sliding distance of the disc's cells
    parts: wp.array2d(dtype=Cells)  # of the cap, that cells bear
    bare: wp.array2d(dtype=Cells)  # 1 where a cell is bare of film
    factored: wp.int32  # 1 where the sliding distance of the disc's cells has a factor each


@wp.struct
class Bodies:
    """Fields of both bodies [mm], and the gap of the tiles listed."""

    sphere: wp.array2d(dtype=Cells)  # height, as worn
    disc: wp.array2d(dtype=Cells)
    wear_sphere: wp.array2d(dtype=Cells)
    wear_disc: wp.array2d(dtype=Cells)
    plastic_disc: wp.array2d(dtype=Cells)  # displaced for good; not looked at of a disc that springs back
    reached: wp.array2d(dtype=Cells)  # 1 where a sphere that does not wear was in contact; else one row
    gap: wp.array2d(dtype=Cells)


@wp.struct
class OfRows:
    """The sums of `OfTiles` over every row of the sphere and of the disc."""

    touched: wp.array(dtype=wp.float64)
    worn_sphere: wp.array(dtype=wp.float64)
    worn_disc: wp.array(dtype=wp.float64)
    pressed_disc: wp.array(dtype=wp.float64)


@wp.struct
class OfTiles:
    """Bounds and sums that are kept of every tile of either body, rows × tiles."""

    lowest: wp.array2d(dtype=wp.float64)  # height of the sphere [mm]
    highest: wp.array2d(dtype=wp.float64)  # of the disc [mm]
    gap: wp.array2d(dtype=wp.float64)  # lowest, of tiles listed; none where more than wear changes it [mm]
    touched: wp.array2d(dtype=wp.float64)  # cells of the sphere
    worn_sphere: wp.array2d(dtype=wp.float64)  # sums [mm]
    worn_disc: wp.array2d(dtype=wp.float64)
    pressed_disc: wp.array2d(dtype=wp.float64)  # displaced for good; one row where the disc springs back
    rows: OfRows


@wp.struct
class Bounds:
    """What gaps of pairs of tiles are bounded by [mm]. It may be out of date: wear only opens gaps."""

    lowest_of_eight: wp.array2d(dtype=wp.float64)  # of neighbouring tiles of the sphere
    highest_of_row: wp.array(dtype=wp.float64)  # of the disc
    lowest: wp.array2d(dtype=Cells)  # of the sphere's tiles, eight in a vector
    highest: wp.array2d(dtype=Cells)  # of the disc's
    gap: wp.array2d(dtype=Cells)  # lowest of pairs of tiles; 0 where it was never made
    stays: wp.int32  # 1 where that and the gap stay as they are made and worn


@wp.struct
class StepTables:
    """Tables of partial results of a step, one column a slot."""

    sums: wp.array2d(dtype=wp.float64)  # lines of `TrackSum`
    maxima: wp.array2d(dtype=wp.float64)  # lines of `TrackMost`
    bearing: wp.array2d(dtype=wp.float64)  # cells' area that bears, where not all that is in contact does


@wp.struct
class Course:
    """What steps remember, and how far they are."""

    approach: wp.float64  # of the last step [mm]
    is_begun: wp.int32  # 0 before the first step
    mean: wp.float64  # pressure of the last step [MPa]
    oldest: wp.int32  # of the last changes of the approach
    first_row: wp.float64  # extents of what was ever touched, the first ones negated
    last_row: wp.float64
    first_column: wp.float64
    last_column: wp.float64
    step: wp.int32  # row of the plan
    steps: wp.int32  # to be made
    smallest: wp.float64  # before the first step: no gap is lower [mm]
    first_limit: wp.float64  # and what a list reaches that holds enough [mm]
    softest: wp.float64  # stiffness of a cell then [N/mm³]


@wp.struct
class Steps:
    """Steps of a pair of bodies: their plan, what they leave, and what lies between."""

    plan: wp.array2d(dtype=wp.float64)  # a row a step, by `PLAN`
    history: wp.array2d(dtype=wp.float64)  # a row a step
    within: wp.array(dtype=wp.float64)  # extents of a contact that is neither at the edge nor at the rim
    changes: wp.array(dtype=wp.float64)  # the last ones of the approach, −1 for none [mm]
    course: wp.array(dtype=Course)  # one
    slides: wp.array(dtype=Slide)  # one
    stepping: wp.array(dtype=wp.int32)  # flag: there is a step to be made
    solved: wp.array(dtype=wp.int32)  # flag: its balance was found
    is_rigid: wp.int32  # 1 for a bearing area
    moves: wp.int32  # 1 where the disc does
    stays: wp.int32  # 1 where a list serves several steps
    hardness: wp.float64  # of a disc that keeps its dents; else NONE [MPa]
    rows: wp.int32  # and columns, of the grid
    columns: wp.int32
    margin: wp.int32  # columns beside those touched that are worn too


@wp.kernel
def bounds(
    first_slot: wp.int32,
    slots: wp.int32,
    height_in: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
    highest_out: wp.array2d(dtype=wp.float64),
):
    """Lowest and highest height of every tile of a body; nothing for places beyond the last tile."""
    slot = first_slot + wp.tid() // wp.block_dim()
    for row in range(slot, height_in.shape[0], slots):
        for t in range(wp.tid() % wp.block_dim(), lowest_out.shape[1], wp.block_dim()):
            low = Cells(ABSENT)
            high = Cells(-ABSENT)
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, height_in.shape[1])):
                low = wp.min(low, height_in[row, k])
                high = wp.max(high, height_in[row, k])
            lowest_out[row, t] = lowest_of(low)
            highest_out[row, t] = wp.max(high)


@wp.func_native("select_tiles(slot, slots, lists, slides, bounds, bodies, list_out, count_out);")
def _select(
    slot: wp.int32,
    slots: wp.int32,
    lists: wp.array(dtype=Listing),
    slides: wp.array(dtype=Slide),
    bounds: Bounds,
    bodies: Bodies,
    list_out: wp.array2d(dtype=wp.int32),
    count_out: wp.array(dtype=wp.int32),
): ...


@wp.kernel
def select(
    first_slot: wp.int32,
    slots: wp.int32,
    lists: wp.array(dtype=Listing),
    slides: wp.array(dtype=Slide),
    bounds: Bounds,
    bodies: Bodies,
    list_out: wp.array2d(dtype=wp.int32),
    count_out: wp.array(dtype=wp.int32),
):
    """Lists, row by row, the tiles with a gap that does not exceed the limit, and writes their gaps."""
    slot = first_slot + wp.tid() // wp.block_dim()
    _select(slot, slots, lists, slides, bounds, bodies, list_out, count_out)


@wp.func_native("return count_listed(count);")
def _count_listed(count: wp.array(dtype=wp.int32)) -> wp.int32: ...


@wp.kernel
def listed(
    first_slot: wp.int32,
    slots: wp.int32,
    lists: wp.array(dtype=Listing),
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


@wp.func
def scatter_of(changes: wp.array(dtype=wp.float64)):
    """What the approach may be off by from the last one."""
    most = -ONE
    for n in range(CHANGES):
        most = wp.max(most, changes[n])
    return wp.max(TIMES * wp.where(most < ZERO, HALF * FIRST_SCATTER, most), LEAST_SCATTER)


@wp.func
def begin_step(springs: Springs, steps: Steps):
    """Begin the search of a step, and tell its passes what they need."""
    c = steps.course[0]
    n = c.step
    stiffness = steps.plan[n, wp.static(PLAN.index("stiffness"))]
    slide = Slide()
    slide.number = n
    slide.rows = steps.rows
    slide.shift = wp.int32(steps.plan[n, 0])
    slide.start = steps.plan[n, 1]
    slide.end = steps.plan[n, 2]
    slide.of_sphere = steps.plan[n, 3]
    slide.of_disc = steps.plan[n, 4]
    slide.pending_sphere = steps.plan[n, 5]
    slide.pending_disc = steps.plan[n, 6]
    slide.own = steps.plan[n, 7]
    slide.full_depth = NONE
    if steps.hardness < NONE:
        slide.full_depth = steps.plan[n, 8] * steps.hardness
    steps.slides[0] = with_columns(slide, c, steps)
    scatter = scatter_of(steps.changes)
    lists = springs.lists[0]
    if steps.stays == 0:
        lists.limit = -NONE  # the list of another displacement is none
        lists.asked = -NONE
    if c.is_begun == 0 and steps.is_rigid * steps.moves == 0:
        lists.limit = c.first_limit
        if steps.is_rigid == 1:
            springs.search[0] = area_between(springs, c.first_limit, scatter)
        else:
            springs.search[0] = search_from_lowest(springs, c.smallest, stiffness, c.softest)
    else:
        approach = wp.where(c.is_begun == 1, c.approach, c.smallest)
        ahead = wp.where(steps.stays == 1, AHEAD * scatter, ZERO)
        lists = reached(lists, approach + scatter, ahead)
        if steps.is_rigid == 0:
            springs.search[0] = search_from(approach, ZERO, scatter, stiffness)
        elif steps.moves == 1:
            springs.search[0] = area_near(approach, scatter)
        else:
            springs.search[0] = area_between(springs, approach, scatter)
    ask_for(springs, lists)
    springs.searching[0] = 1


@wp.func
def with_columns(before: Slide, c: Course, steps: Steps):
    """A step with the columns that were touched before it, and those beside them that are worn too."""
    slide = before
    slide.first_column = 0
    slide.end_column = 0
    if c.last_column >= ZERO:
        slide.first_column = wp.max(-wp.int32(c.first_column) - steps.margin, 0)
        slide.end_column = wp.min(wp.int32(c.last_column) + 1 + steps.margin, steps.columns)
    return slide


@wp.kernel
def begin(first_slot: wp.int32, slots: wp.int32, steps: Steps):
    """Begins the steps of a plan, or goes on with them."""
    if wp.tid() == 0:
        steps.stepping[0] = wp.where(steps.course[0].step < steps.course[0].steps, 1, 0)


@wp.kernel
def begin_search(first_slot: wp.int32, slots: wp.int32, springs: Springs, steps: Steps):
    """Begins the search of a step."""
    if wp.tid() == 0:
        begin_step(springs, steps)


@wp.kernel
def end_search(first_slot: wp.int32, slots: wp.int32, springs: Springs, steps: Steps):
    """Learns from the balance of a step, and tells the pass that wears of it."""
    if wp.tid() == 0:
        c = steps.course[0]
        law = springs.law[0]
        steps.solved[0] = wp.where(springs.search[0].bracket.state == STUCK, 0, 1)
        if steps.solved[0] == 1:
            slide = steps.slides[0]
            slide.approach = law.base + law.offset
            slide.reference = wp.where(steps.is_rigid == 0 and c.mean > ZERO, c.mean, law.cap)
            if not (slide.reference < NONE):
                slide.reference = ZERO
            steps.slides[0] = slide
            if c.is_begun == 1:
                steps.changes[c.oldest] = wp.abs(slide.approach - c.approach)
                c.oldest = (c.oldest + 1) % CHANGES
            c.approach = slide.approach
            c.is_begun = 1
            steps.course[0] = c


@wp.func_native("wear_tiles(slot, slots, tiles, count, slides, springs, of_cells, bodies, of_tiles, tables);")
def _wear_tiles(
    slot: wp.int32,
    slots: wp.int32,
    tiles: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    slides: wp.array(dtype=Slide),
    springs: Springs,
    of_cells: OfCells,
    bodies: Bodies,
    of_tiles: OfTiles,
    tables: StepTables,
): ...


@wp.kernel
def wear_step(
    first_slot: wp.int32,
    slots: wp.int32,
    tiles: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    slides: wp.array(dtype=Slide),
    springs: Springs,
    of_cells: OfCells,
    bodies: Bodies,
    of_tiles: OfTiles,
    tables: StepTables,
):
    """One increment of wear in place: each body loses K p ΔL.

    What goes beyond the full depth is displaced from the disc for good, not worn. Of the tiles listed the
    gap, the bounds and the sums are made anew, also of their rows. Columns count that lie beyond the
    known ones.
    """
    slot = first_slot + wp.tid() // wp.block_dim()
    _wear_tiles(slot, slots, tiles, count, slides, springs, of_cells, bodies, of_tiles, tables)


@wp.func_native("return sum_of_array(values);")
def _sum_of(values: wp.array(dtype=wp.float64)) -> wp.float64: ...


@wp.func_native("return end_of_rows(of_rows, is_last != 0);")
def _end_of(of_rows: wp.array(dtype=wp.float64), is_last: wp.int32) -> wp.float64: ...


@wp.func
def is_within(steps: Steps, c: Course, row: wp.int32):
    """Whether a contact does not grow to the edge or the rim in a step."""
    found = steps.history
    within = steps.within
    row_first = found[row, OF_ROWS + 4] > wp.max(c.first_row, within[0])
    row_last = found[row, OF_ROWS + 5] > wp.max(c.last_row, within[1])
    column_first = found[row, MAXIMA + wp.static(int(TrackMost.FIRST_COLUMN))] > wp.max(
        c.first_column, within[2]
    )
    column_last = found[row, MAXIMA + wp.static(int(TrackMost.LAST_COLUMN))] > wp.max(
        c.last_column, within[3]
    )
    return not (row_first or row_last or column_first or column_last)


@wp.kernel
def record(
    first_slot: wp.int32,
    slots: wp.int32,
    springs: Springs,
    steps: Steps,
    tables: StepTables,
    of_rows: OfRows,
):
    """Writes the row of a step, and tells whether another one follows.

    Steps end where the contact reaches the edge or the rim, as a run may stop there and be kept as it is, and
    where no balance was found.
    """
    row = steps.slides[0].number
    history = steps.history
    total_of(tables.sums, 1, history, row, TOTALS)
    total_of(tables.maxima, 0, history, row, MAXIMA)
    total_of(tables.bearing, 1, history, row, OF_ROWS + 6)
    touched = _sum_of(of_rows.touched)
    worn_sphere = _sum_of(of_rows.worn_sphere)
    worn_disc = _sum_of(of_rows.worn_disc)
    pressed_disc = _sum_of(of_rows.pressed_disc)
    first_row = _end_of(of_rows.touched, 0)
    last_row = _end_of(of_rows.touched, 1)
    if wp.tid() == 0:
        c = steps.course[0]
        law = springs.law[0]
        s = springs.search[0]
        history[row, 0] = law.base
        history[row, 1] = law.offset
        history[row, 2] = law.cap
        history[row, 3] = s.residual
        history[row, 4] = law.tie_width
        history[row, 5] = law.tie_pressure
        history[row, 6] = wp.float64(s.evaluations)
        history[row, 7] = steps.slides[0].reference
        history[row, OF_ROWS] = touched
        history[row, OF_ROWS + 1] = worn_sphere
        history[row, OF_ROWS + 2] = worn_disc
        history[row, OF_ROWS + 3] = pressed_disc
        history[row, OF_ROWS + 4] = first_row
        history[row, OF_ROWS + 5] = last_row
        pressure = history[row, TOTALS + wp.static(int(TrackSum.PRESSURE))]
        contact = history[row, TOTALS + wp.static(int(TrackSum.CONTACT))]
        goes_on = steps.solved[0] == 1 and contact > ZERO and pressure < NONE and is_within(steps, c, row)
        c.first_row = wp.max(c.first_row, first_row)
        c.last_row = wp.max(c.last_row, last_row)
        c.first_column = wp.max(c.first_column, history[row, MAXIMA + wp.static(int(TrackMost.FIRST_COLUMN))])
        c.last_column = wp.max(c.last_column, history[row, MAXIMA + wp.static(int(TrackMost.LAST_COLUMN))])
        if steps.solved[0] == 1:
            c.mean = pressure / wp.max(contact, ONE)
            c.step = row + 1
        steps.course[0] = c
        steps.slides[0] = with_columns(steps.slides[0], c, steps)  # a film is rubbed there
        steps.stepping[0] = wp.where(goes_on and c.step < c.steps, 1, 0)
