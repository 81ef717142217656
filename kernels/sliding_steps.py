"""Steps of a ball on a disc that moves under it, or lies still, have a plan, searches and a history.

A step is a list of tiles, as each displacement has its own, a search for the load balance, see `balance` and
`bearing`, a pass that wears, see `sliding`, and a row of the history. The search begins at the last approach,
which it may be off by as much as it has lately changed.
"""

import warp as wp

from warpwear.kernels.balance import Springs, ask_for, search_from, search_from_lowest
from warpwear.kernels.bearing import area_between, area_near
from warpwear.kernels.cells import NONE, ONE, ZERO, TrackMost, TrackSum
from warpwear.kernels.native_code import total_of
from warpwear.kernels.newton import HALF, STUCK
from warpwear.kernels.sliding import RowSums, Slide, StepTables
from warpwear.kernels.tiles import reached
from warpwear.kernels.wear import BALANCE, enter_balance, is_within

#: All kernels of a step are compiled together.
TOGETHER = wp.get_module("warpwear.kernels.sliding")

#: Sums over tiles and rows: columns of the history after those of `BALANCE`, `TrackSum` and `TrackMost`.
ROW_SUMS = ("touched", "worn_counter", "worn_disc", "pressed_disc")
#: What follows them.
LAST = ("first_row", "last_row", "bearing")
SUMS_AT = wp.constant(wp.int32(len(BALANCE)))
MAXIMA_AT = wp.constant(wp.int32(len(BALANCE) + len(TrackSum)))
ROW_SUMS_AT = wp.constant(wp.int32(len(BALANCE) + len(TrackSum) + len(TrackMost)))
#: Changes of the approach from which the next is expected, and how many times the largest it may be.
CHANGES = wp.constant(wp.int32(8))
SCATTER_FACTOR = wp.constant(wp.float64(2.0))
#: Of a list that serves several steps: how many times further it reaches.
REACH_FACTOR = wp.constant(wp.float64(1.0))
#: What the approach may change by when nothing is known of it, and at least [mm].
FIRST_SCATTER = wp.constant(wp.float64(1.0e-4))
LEAST_SCATTER = wp.constant(wp.float64(1.0e-6))


@wp.struct
class SlidingMemory:
    """What steps remember, and how far they are."""

    approach: wp.float64  # of the last step [mm]
    is_begun: wp.int32  # 0 before the first step
    mean: wp.float64  # pressure of the last step [MPa]
    oldest: wp.int32  # of the last changes of the approach
    extents: wp.vec4d  # of what was ever touched, by `kernels.cells.EXTENTS`
    step: wp.int32  # row of the plan
    steps: wp.int32  # to be made
    smallest: wp.float64  # before the first step: no gap is lower [mm]
    first_limit: wp.float64  # and what a list reaches that holds enough [mm]
    softest: wp.float64  # stiffness of a cell then [N/mm³]


@wp.struct
class SlidingSteps:
    """Steps of a pair of bodies: their plan, what they leave, and what lies between."""

    plan: wp.array(dtype=Slide)  # a row a step
    history: wp.array2d(dtype=wp.float64)  # a row a step
    within: wp.array(dtype=wp.float64)  # extents of a contact that is neither at the edge nor at the rim
    changes: wp.array(dtype=wp.float64)  # the last ones of the approach, −1 for none [mm]
    memory: wp.array(dtype=SlidingMemory)  # one
    slides: wp.array(dtype=Slide)  # one
    stepping: wp.array(dtype=wp.int32)  # flag: there is a step to be made
    solved: wp.array(dtype=wp.int32)  # flag: its balance was found
    is_rigid: wp.int32  # 1 for a bearing area
    moves: wp.int32  # 1 where the disc does
    reuses_list: wp.int32  # 1 where a list may serve several steps
    columns: wp.int32  # of the grid
    margin: wp.int32  # columns beside those touched that are worn too


@wp.func
def scatter_of(changes: wp.array(dtype=wp.float64)):
    """Return what the approach may be off by from the last one."""
    most = -ONE
    for n in range(CHANGES):
        most = wp.max(most, changes[n])
    return wp.max(SCATTER_FACTOR * wp.where(most < ZERO, HALF * FIRST_SCATTER, most), LEAST_SCATTER)


@wp.func
def least_shear(slide: Slide):
    """Return what of a depth [mm] that shear wears all cells lose, at least."""
    return (slide.removal.shear_counter + slide.removal.shear_disc) * slide.removal.least_shear_ratio


@wp.func
def begin_step(springs: Springs, steps: SlidingSteps):
    """Begin the search of a step, and tell its passes what they need."""
    memory = steps.memory[0]
    slide = steps.plan[memory.step]
    lends = wp.where(slide.compliance > slide.own, ONE, ZERO)  # implicit wear does
    springs.bends.step[0] = slide.own
    springs.bends.step[1] = lends * slide.removal.k_counter
    springs.bends.step[2] = lends * slide.removal.k_disc
    steps.slides[0] = with_columns(slide, memory, steps)
    scatter = scatter_of(steps.changes)
    lists = springs.lists[0]
    # How near a spring is to its cap depends on the list, so that each of their steps has its own.
    reuses_list = steps.reuses_list == 1 and steps.is_rigid == 1
    if not reuses_list:
        lists.limit = -NONE  # the list of another displacement is none
        lists.asked = -NONE
        springs.listing[0] = 1
    if memory.is_begun == 0 and steps.is_rigid * steps.moves == 0:
        lists.limit = memory.first_limit
        if steps.is_rigid == 1:
            springs.search[0] = area_between(springs, memory.first_limit, scatter)
        else:
            springs.search[0] = search_from_lowest(springs, memory.smallest, slide.stiffness, memory.softest)
    else:
        approach = wp.where(memory.is_begun == 1, memory.approach, memory.smallest)
        if reuses_list:
            lists = reached(lists, approach + scatter, REACH_FACTOR * scatter)
        else:
            lists = reached(lists, approach, scatter)
        if steps.is_rigid == 0:
            springs.search[0] = search_from(approach, ZERO, scatter, slide.stiffness)
        elif steps.moves == 1:
            springs.search[0] = area_near(approach, scatter)
        else:
            springs.search[0] = area_between(springs, approach, scatter)
    ask_for(springs, lists)
    springs.searching[0] = 1


@wp.func
def with_columns(slide: Slide, memory: SlidingMemory, steps: SlidingSteps):
    """Give a step the columns that were touched before it, and those beside them that are worn too."""
    slide.first_column = 0
    slide.end_column = 0
    if memory.extents[3] >= ZERO:
        slide.first_column = wp.max(-wp.int32(memory.extents[2]) - steps.margin, 0)
        slide.end_column = wp.min(wp.int32(memory.extents[3]) + 1 + steps.margin, steps.columns)
    return slide


@wp.kernel(module=TOGETHER)
def begin(steps: SlidingSteps):
    """Begins the steps of a plan, or goes on with them."""
    if wp.tid() == 0:
        steps.stepping[0] = wp.where(steps.memory[0].step < steps.memory[0].steps, 1, 0)


@wp.kernel(module=TOGETHER)
def begin_search(springs: Springs, steps: SlidingSteps):
    """Begins the search of a step."""
    if wp.tid() == 0:
        begin_step(springs, steps)


@wp.kernel(module=TOGETHER)
def end_search(springs: Springs, steps: SlidingSteps):
    """Learns from the balance of a step, and tells the pass that wears of it."""
    if wp.tid() == 0:
        memory = steps.memory[0]
        law = springs.law[0]
        steps.solved[0] = wp.where(springs.search[0].bracket.state == STUCK, 0, 1)
        if steps.solved[0] == 1:
            slide = steps.slides[0]
            slide.approach = law.base + law.offset + least_shear(slide)
            slide.reference = wp.where(steps.is_rigid == 0 and memory.mean > ZERO, memory.mean, law.cap)
            if not (slide.reference < NONE):
                slide.reference = ZERO
            steps.slides[0] = slide
            if memory.is_begun == 1:
                steps.changes[memory.oldest] = wp.abs(slide.approach - memory.approach)
                memory.oldest = (memory.oldest + 1) % CHANGES
            memory.approach = slide.approach
            memory.is_begun = 1
            steps.memory[0] = memory


@wp.func_native("return sum_of_numbers(values.data, values.shape[0]);")
def _sum_of(values: wp.array(dtype=wp.float64)) -> wp.float64: ...


@wp.func_native("return end_of_rows(row_sums, is_last != 0);")
def _end_of(row_sums: wp.array(dtype=wp.float64), is_last: wp.int32) -> wp.float64: ...


@wp.kernel(module=TOGETHER)
def record(springs: Springs, steps: SlidingSteps, tables: StepTables, row_sums: RowSums):
    """Write the row of a step, and tells whether another one follows.

    Steps end where the contact reaches the edge or the rim, as a run may stop there and be kept as it is, and
    where no balance was found.
    """
    row = steps.slides[0].number
    history = steps.history
    total_of(tables.sums, 1, history, row, SUMS_AT)
    total_of(tables.maxima, 0, history, row, MAXIMA_AT)
    total_of(tables.bearing, 1, history, row, ROW_SUMS_AT + 6)
    touched = _sum_of(row_sums.touched)
    worn_counter = _sum_of(row_sums.worn_counter)
    worn_disc = _sum_of(row_sums.worn_disc)
    pressed_disc = _sum_of(row_sums.pressed_disc)
    first_row = _end_of(row_sums.touched, 0)
    last_row = _end_of(row_sums.touched, 1)
    if wp.tid() == 0:
        memory = steps.memory[0]
        enter_balance(history, row, springs, steps.slides[0].reference)
        history[row, 1] += least_shear(steps.slides[0])
        history[row, ROW_SUMS_AT] = touched
        history[row, ROW_SUMS_AT + 1] = worn_counter
        history[row, ROW_SUMS_AT + 2] = worn_disc
        history[row, ROW_SUMS_AT + 3] = pressed_disc
        history[row, ROW_SUMS_AT + 4] = first_row
        history[row, ROW_SUMS_AT + 5] = last_row
        pressure = history[row, SUMS_AT + wp.static(int(TrackSum.PRESSURE))]
        contact = history[row, SUMS_AT + wp.static(int(TrackSum.CONTACT))]
        first_column = history[row, MAXIMA_AT + wp.static(int(TrackMost.FIRST_COLUMN))]
        last_column = history[row, MAXIMA_AT + wp.static(int(TrackMost.LAST_COLUMN))]
        now = wp.max(memory.extents, wp.vec4d(first_row, last_row, first_column, last_column))
        goes_on = steps.solved[0] == 1 and contact > ZERO and pressure < NONE
        goes_on = goes_on and is_within(memory.extents, now, steps.within)
        memory.extents = now
        if steps.solved[0] == 1:
            memory.mean = pressure / wp.max(contact, ONE)
            memory.step = row + 1
        steps.memory[0] = memory
        steps.slides[0] = with_columns(steps.slides[0], memory, steps)  # a film records its wear there
        steps.stepping[0] = wp.where(goes_on and memory.step < memory.steps, 1, 0)
