"""Archard's wear of the gap of two bodies at rest, and the steps of it.

Both bodies bound one gap and wear in a fixed proportion: their wear together is the gap now less the gap
before any wear. A step is a search for the load balance, see `balance` and `bearing`, a pass that
wears, and a row of the history. The pass that wears also evaluates the load at the approach
expected next: most steps on springs need no further pass, see `foresight`.
"""

import warp as wp

from warpwear.kernels import balance, native_code
from warpwear.kernels.balance import BalanceSearch, Springs
from warpwear.kernels.bearing import area_between, conclude_area, judged_area
from warpwear.kernels.cells import FIELD, LISTED, NONE, ONE, ZERO, TileSums, WearMost, WearSum
from warpwear.kernels.contact import Law
from warpwear.kernels.foresight import Trend, foreseen_step, learnt
from warpwear.kernels.newton import LOOKS, STUCK
from warpwear.kernels.tiles import Listing, list_from, reached

native_pass = native_code.passes_of(__name__, "wear.h")

#: Columns of a row of the history before its sums and maxima.
BALANCE = ("base", "offset", "cap", "residual", "tie_width", "tie_pressure", "evaluations", "reference")
#: Columns of the plan: K ΔL of both bodies [mm³/N] and 1/c [N/mm³] of a step.
PLAN = ("removal", "stiffness")
SUMS_AT = wp.constant(wp.int32(len(BALANCE)))
EXTENTS_AT = wp.constant(wp.int32(len(BALANCE) + len(WearSum) + int(WearMost.FIRST_ROW)))
#: The pressures of a step may miss the load by this many tolerances.
ALLOWED_TOLERANCES = wp.constant(wp.float64(2.0))
LARGEST = wp.constant(wp.float64(1.0e308))


@wp.struct
class Increment:
    """What a step wears off a gap, and where the next one will look first."""

    wear_per_pressure: wp.float64  # K ΔL of both bodies [mm³/N]
    stiffness: wp.float64  # 1/c of the step [N/mm³]
    reference: wp.float64  # deviations are squared about it: near the mean that keeps digits [MPa]
    base_next: wp.float64  # approach of the next step [mm]
    offset_next: wp.float64
    stiffness_next: wp.float64
    first_column: wp.int32  # columns between which cells are known to be touched
    last_column: wp.int32
    is_ready: wp.int32  # 1 between a search that has ended and the row of its step


@wp.struct
class Tables:
    """Holds tables of partial results, one column a slot."""

    sums: wp.array2d(dtype=wp.float64)  # lines of `WearSum`
    maxima: wp.array2d(dtype=wp.float64)  # lines of `WearMost`
    ahead: wp.array2d(dtype=wp.float64)  # what a search would find in the worn gap at the next approach


@wp.struct
class RestMemory:
    """Holds what a step leaves to the next one, and how many are done."""

    trend: Trend  # of the approach
    mean: wp.float64  # pressure of the last step [MPa]
    is_ahead: wp.int32  # 1 where the next approach was evaluated before its step
    ahead: wp.float64  # how far beyond the last one it was expected [mm]
    stiffness_ahead: wp.float64  # 1/c that it was evaluated for [N/mm³]
    force: wp.float64  # what it carries, its slope, and how near a cell is to changing that
    slope: wp.float64
    near: wp.float64
    extents: wp.vec4d  # of what was ever touched, by `kernels.cells.EXTENTS`
    step: wp.int32  # row of the plan
    steps: wp.int32  # to be made
    known: wp.int32  # rows of the plan: one more where the step after is known
    failed: wp.int32  # 1 where a search has found no balance


@wp.struct
class RestSteps:
    """Steps of a gap at rest: their plan, what they leave, and what lies between."""

    plan: wp.array2d(dtype=wp.float64)  # a row a step, by `PLAN`
    history: wp.array2d(dtype=wp.float64)  # a row a step: `BALANCE`, `WearSum`, `WearMost`
    within: wp.array(dtype=wp.float64)  # extents of a contact that is neither at the edge nor at the rim
    memory: wp.array(dtype=RestMemory)  # one
    increment: wp.array(dtype=Increment)  # one
    stepping: wp.array(dtype=wp.int32)  # flag: there is a step to be made
    is_rigid: wp.int32  # 1 for a bearing area
    smallest: wp.float64  # lowest gap before any wear [mm]


@wp.func
def begin_step(springs: Springs, steps: RestSteps):
    """Begin the search of a step at the approach expected, and use what was evaluated there before."""
    memory = steps.memory[0]
    removal = steps.plan[memory.step, 0]
    stiffness = steps.plan[memory.step, 1]
    lists = springs.lists[0]
    last = memory.trend
    if last.is_begun == 0 or steps.is_rigid == 1:
        lists = list_from(lists, steps.smallest)
    steps.stepping[0] = 1
    if steps.is_rigid == 1:
        balance.ask_for(springs, lists)
        start = wp.where(last.is_begun == 1, last.approach, steps.smallest)
        springs.search[0] = area_between(springs, start, balance.STEPS_AHEAD * removal * springs.cap)
        springs.searching[0] = 1
    elif last.is_begun == 0:
        balance.ask_for(springs, lists)
        springs.search[0] = balance.search_from_lowest(springs, steps.smallest, stiffness, stiffness)
        springs.searching[0] = 1
    else:
        is_known = memory.is_ahead == 1 and memory.stiffness_ahead == stiffness
        # A worn contact recedes by K p ΔL: where the last mean pressure puts it is a close first guess.
        step = wp.where(is_known, memory.ahead, removal * memory.mean)
        s = balance.search_from(last.approach, step, ZERO, stiffness)
        lists = reached(lists, last.approach + step, s.margin)
        if is_known:
            s, lists = balance.judged(springs, s, lists, memory.force, memory.slope, memory.near)
        conclude_step(springs, steps, s, lists)


@wp.func
def conclude_step(springs: Springs, steps: RestSteps, s: BalanceSearch, lists: Listing):
    """Keep a search on springs, and at its end tell the pass that wears what to do."""
    if s.bracket.state == LOOKS:
        balance.conclude(springs, s, lists)
    else:
        balance.conclude(springs, s, prepare(steps, s, lists, s.base + s.bracket.offset, springs.cap))


@wp.func
def prepare(steps: RestSteps, s: BalanceSearch, lists: Listing, approach: wp.float64, cap: wp.float64):
    """Prepare the wear of a step at its approach, and the list for the approach that is expected next."""
    memory = steps.memory[0]
    removal = steps.plan[memory.step, 0]
    now = Increment()
    now.is_ready = 1
    now.wear_per_pressure = removal
    now.stiffness = steps.plan[memory.step, 1]
    now.reference = wp.where(memory.mean > ZERO, memory.mean, wp.where(cap < NONE, cap, ZERO))
    if steps.is_rigid == 1:
        now.reference = cap
    now.base_next = approach
    now.stiffness_next = now.stiffness
    now.first_column = -wp.int32(memory.extents[2])
    now.last_column = wp.int32(memory.extents[3])
    if s.bracket.state == STUCK:
        memory.failed = 1
        now.wear_per_pressure = ZERO
    else:
        trend = learnt(memory.trend, approach, removal)
        memory.trend = trend
        memory.ahead = ZERO
        if memory.step + 1 < memory.known and steps.is_rigid == 0:
            now.stiffness_next = steps.plan[memory.step + 1, 1]
            ahead = foreseen_step(trend, steps.plan[memory.step + 1, 0])
            memory.ahead = ahead
            lists = reached(lists, approach + wp.max(ahead, ZERO), balance.STEPS_AHEAD * wp.abs(ahead))
        now.offset_next = memory.ahead
        memory.stiffness_ahead = now.stiffness_next
    steps.increment[0] = now
    steps.memory[0] = memory
    return lists


@wp.kernel
def judge(springs: Springs, steps: RestSteps):
    """Decides what follows from a pass of the search of a step."""
    s, lists = balance.judged_pass(springs)
    if wp.tid() == 0:
        conclude_step(springs, steps, s, lists)


@wp.kernel
def judge_area(springs: Springs, steps: RestSteps):
    """Decides what follows from a pass of the search of a step over a bearing area."""
    s, lists, law = judged_area(springs)
    if wp.tid() == 0:
        if s.bracket.state != LOOKS:
            lists = prepare(steps, s, lists, law.base, law.cap)
        conclude_area(springs, s, lists, law)


#: One increment of wear in place: the gap opens by K p ΔL of both bodies.
#:
#: rest: sums of the tiles of each row that are not listed. Sums and maxima of the step go to `tables`.
wear_step = native_pass(
    "wear_rows",
    **LISTED,
    law=wp.array(dtype=Law),
    step=wp.array(dtype=Increment),
    unworn=FIELD,
    rest=wp.array(dtype=TileSums),
    gap=FIELD,
    tables=Tables,
)


@wp.func_native("return total_step(tables, &wp::index(history, row, column));")
def total_step(
    tables: Tables, history: wp.array2d(dtype=wp.float64), row: wp.int32, column: wp.int32
) -> wp.vec3d:
    """Reduces the tables to numbers, in a row from a column on; returns those evaluated ahead."""


@wp.func
def enter_balance(
    history: wp.array2d(dtype=wp.float64), row: wp.int32, springs: Springs, reference: wp.float64
):
    """Enter what a search has found in the first columns of a row, by `BALANCE`."""
    law = springs.law[0]
    s = springs.search[0]
    history[row, 0] = law.base
    history[row, 1] = law.offset
    history[row, 2] = law.cap
    history[row, 3] = s.residual
    history[row, 4] = law.tie_width
    history[row, 5] = law.tie_pressure
    history[row, 6] = wp.float64(s.evaluations)
    history[row, 7] = reference


@wp.func
def is_within(before: wp.vec4d, now: wp.vec4d, within: wp.array(dtype=wp.float64)):
    """Whether a contact does not grow to the edge or the rim: extents before a step, now, and allowed."""
    grows = wp.int32(0)
    for end in range(4):
        grows += wp.where(now[end] > wp.max(before[end], within[end]), 1, 0)
    return grows == 0


@wp.func
def write_row(springs: Springs, steps: RestSteps, tables: Tables, thread: wp.int32):
    """Write the row of a step, and end the steps where none may follow. All threads of the slot call it."""
    row = steps.memory[0].step
    history = steps.history
    ahead = total_step(tables, history, row, SUMS_AT)
    force = ahead[0] * springs.cell_area
    slope = ahead[1] * springs.cell_area
    near = -ahead[2]
    if thread == 0:
        memory = steps.memory[0]
        enter_balance(history, row, springs, steps.increment[0].reference)
        pressure = history[row, SUMS_AT + wp.static(int(WearSum.PRESSURE))]
        contact = history[row, SUMS_AT + wp.static(int(WearSum.CONTACT))]
        goes_on = memory.failed == 0 and contact > ZERO and pressure < LARGEST
        if steps.is_rigid == 0:
            left = wp.abs(pressure * springs.cell_area - springs.load)
            goes_on = goes_on and left <= ALLOWED_TOLERANCES * springs.tolerance
        now = wp.vec4d()
        for end in range(4):
            now[end] = wp.max(memory.extents[end], history[row, EXTENTS_AT + end])
        goes_on = goes_on and is_within(memory.extents, now, steps.within)
        memory.extents = now
        memory.is_ahead = wp.where(memory.ahead != ZERO, 1, 0)
        memory.force = force
        memory.slope = slope
        memory.near = near
        if memory.failed == 0:
            memory.mean = pressure / wp.max(contact, ONE)
            memory.step = row + 1
        if not goes_on:
            memory.steps = memory.step
        steps.memory[0] = memory
        steps.increment[0].is_ready = 0


@wp.kernel
def record(springs: Springs, steps: RestSteps, tables: Tables):
    """Write the row of a step that was worn, if any, and begins the next one, if there is one.

    It does nothing while a search goes on. Steps end where the contact reaches the edge or the rim, as a run
    may stop there and be kept as it is, and at a step whose pressures do not carry the load.
    """
    if springs.searching[0] == 1:
        return
    if steps.increment[0].is_ready == 1:
        write_row(springs, steps, tables, wp.tid())
    if wp.tid() == 0:
        steps.stepping[0] = 0
        if steps.memory[0].step < steps.memory[0].steps:
            begin_step(springs, steps)
