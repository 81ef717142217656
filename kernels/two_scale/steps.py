"""Decisions between the passes of a step of patches: where its search begins, and what the step leaves."""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import most_of, sum_of
from warpwear.kernels.cells import NONE, ONE, ZERO, WearMost, WearSum
from warpwear.kernels.newton import HALF
from warpwear.kernels.two_scale.sharing import (
    PRESSURE,
    Curves,
    Flags,
    Load,
    Search,
    lane,
    search_from,
    wait_for_slot,
    width,
)

wp.set_module_options(native_code.options("springs.h", "wear.h", "patches.h"))

#: Columns of a row that a step leaves, before its sums and maxima.
HEADER = ("base", "offset", "reference", "evaluations")
FIRST = wp.constant(wp.int32(len(HEADER)))
#: Columns of a plan: K ΔL of both bodies, 1/c of the cells, 1/K_N.
REMOVAL = wp.constant(wp.int32(0))
STIFFNESS = wp.constant(wp.int32(1))
FLEXIBILITY = wp.constant(wp.int32(2))


@wp.struct
class Rules:
    """What all steps of a contact have in common."""

    load: Load
    lowest: wp.float64  # of all cells before any wear [mm]
    cell_area: wp.float64  # [mm²]
    weight: wp.float64  # area that a cell stands for over its own
    sprung: wp.int32  # whether springs lie behind the patches
    looks_ahead: wp.int32  # whether the pass that wears evaluates for the next step as well
    #: Largest extents of what may be touched before the host is asked, by `kernels.cells.EXTENTS`.
    within: wp.vec4d


@wp.struct
class Now:
    """The step that is made."""

    removal: wp.float64  # K ΔL of both bodies [mm³/N]
    stiffness: wp.float64  # 1/c of the cells [N/mm³]
    stiffness_next: wp.float64  # for which the pass that wears looks ahead
    reference: wp.float64  # pressure from which the scatter counts [MPa]
    mean: wp.float64  # pressure of the last step [MPa]
    extents: wp.vec4d  # of what was touched so far, by `kernels.cells.EXTENTS`
    answered: wp.int32  # whether its first evaluation was made by the step before
    number: wp.int32  # of the step in the plan
    steps: wp.int32  # of the plan


@wp.struct
class Memory:
    """What the next step goes by of those before, one number each; rates are those of the last two steps."""

    steps: wp.float64  # made so far
    approach: wp.float64  # of the bodies [mm]
    slid: wp.float64  # Σ K ΔL of both bodies [mm³/N]
    rates: wp.float64  # how many are known
    where_0: wp.float64  # of each, the earlier one first [mm³/N]
    rate_0: wp.float64  # of the approach [MPa]
    where_1: wp.float64
    rate_1: wp.float64
    gives: wp.float64  # 1 where it is known how fast springs give way
    ahead: wp.float64  # K ΔL for which the patches have answered ahead; negative where they have not


@wp.struct
class Courses:
    """What the next step goes by of every patch, one number each."""

    start: wp.array(dtype=wp.float64)  # from which it counts; without pressure it hangs on the bodies [mm]
    deflection: wp.array(dtype=wp.float64)  # of its spring [mm]
    giving: wp.array(dtype=wp.float64)  # how fast that grew, over what a unit of pressure removes [MPa]
    reached: wp.array(dtype=wp.float64)  # largest approach so far [mm]
    base_next: wp.array(dtype=wp.float64)  # at which it is evaluated ahead [mm]
    offset_next: wp.array(dtype=wp.float64)


@wp.struct
class Books:
    """What steps leave: a row a step."""

    sums: wp.array2d(dtype=wp.float64)  # of the last step, lines of `WearSum`, a column a patch
    maxima: wp.array2d(dtype=wp.float64)  # lines of `WearMost`
    ahead: wp.array2d(dtype=wp.float64)  # what was added up for the next step, as `Surfaces.trial`
    rows: wp.array2d(dtype=wp.float64)  # HEADER, sums, maxima
    loads: wp.array2d(dtype=wp.float64)  # of every patch [N]
    areas: wp.array2d(dtype=wp.float64)  # [mm²]


@wp.func
def foreseen_step(m: Memory, removal: wp.float64):
    """How far a step goes on [mm], on the line through the rates at which the approach grew."""
    where = m.slid + HALF * removal
    rate = m.rate_0
    if m.rates > ONE:  # Lagrange's line
        rate = m.rate_0 * ((where - m.where_1) / (m.where_0 - m.where_1))
        rate = rate + m.rate_1 * ((where - m.where_0) / (m.where_1 - m.where_0))
    return removal * rate


@wp.func
def noted(before: Memory, approach: wp.float64, removal: wp.float64):
    """What is known after a step that ended at an approach [mm], and removed K ΔL [mm³/N]."""
    m = before
    where = m.slid + HALF * removal
    last = wp.where(m.rates > ONE, m.where_1, m.where_0)
    # A law that decays ends with steps too small to be told apart by where they are.
    is_new = m.rates == ZERO or where > last
    if m.steps > ZERO and removal > ZERO and is_new:
        rate = (approach - m.approach) / removal
        if m.rates > ONE:
            m.where_0 = m.where_1
            m.rate_0 = m.rate_1
        if m.rates == ZERO:
            m.where_0 = where
            m.rate_0 = rate
        else:
            m.where_1 = where
            m.rate_1 = rate
        m.rates = wp.min(m.rates + ONE, ONE + ONE)
    m.approach = approach
    m.slid += removal
    m.steps += ONE
    return m


@wp.func
def guess_of(m: Memory, now: Now):
    """How far the solution is expected from where a search begins [mm]."""
    guess = now.removal * now.mean
    if m.rates > ZERO:
        guess = foreseen_step(m, now.removal)
    return guess


@wp.func
def first_guess(rules: Rules, now: Now):
    """First step of a search from the lowest cell [mm]."""
    pressure = wp.min(rules.load.hardness, rules.load.load / rules.cell_area)
    return HALF * pressure / now.stiffness


@wp.func
def begun(rules: Rules, plan: wp.array2d(dtype=wp.float64), before: Now):
    """The next step of the plan."""
    now = before
    now.removal = plan[now.number, REMOVAL]
    now.stiffness = plan[now.number, STIFFNESS]
    now.stiffness_next = now.stiffness
    now.reference = now.mean
    if now.mean == ZERO and rules.load.hardness < NONE:
        now.reference = rules.load.hardness
    return now


@wp.kernel
def begin(
    first_slot: wp.int32,
    slots: wp.int32,
    rules: Rules,
    plan: wp.array2d(dtype=wp.float64),
    curves: Curves,
    courses: Courses,
    memory: wp.array(dtype=Memory),
    now_out: wp.array(dtype=Now),
    search_out: wp.array(dtype=Search),
    flags: Flags,
):
    """Begin a step whose load is shared: a search from the last approaches, or from the lowest cell."""
    m = memory[0]
    now = begun(rules, plan, now_out[0])
    s = Search()
    s.flexibility = plan[now.number, FLEXIBILITY]
    is_first = m.steps == ZERO
    guess = guess_of(m, now)
    if is_first:
        guess = first_guess(rules, now)
    for k in range(lane(), curves.base.shape[0], width()):
        curves.base[k] = wp.where(is_first, rules.lowest, courses.start[k])
        curves.offset[k] = guess
        if m.rates > ZERO and m.gives > ZERO:
            curves.offset[k] = guess - now.removal * courses.giving[k]
    now.answered = wp.where(m.ahead == now.removal, 1, 0)
    common_base = wp.where(is_first, rules.lowest, m.approach)
    s = search_from(curves, rules.load, s, common_base, guess, wp.where(is_first, ZERO, -NONE))
    wait_for_slot()
    if lane() == 0:
        now_out[0] = now
        search_out[0] = s
        flags.searching[0] = 1
        flags.unanswered[0] = 1 - now.answered
        flags.balanced[0] = 0


@wp.kernel
def foresee(
    first_slot: wp.int32,
    slots: wp.int32,
    rules: Rules,
    plan: wp.array2d(dtype=wp.float64),
    curves: Curves,
    courses: Courses,
    search: wp.array(dtype=Search),
    memory: wp.array(dtype=Memory),
    now_out: wp.array(dtype=Now),
):
    """Learn from the approaches of a step, and tell at which ones the pass that wears looks ahead."""
    s = search[0]
    now = now_out[0]
    m = memory[0]
    approach = s.common_base + s.common
    gives = rules.sprung != 0 and m.steps > ZERO and now.removal > ZERO
    m = noted(m, approach, now.removal)
    m.gives = wp.where(gives, ONE, ZERO)
    m.ahead = -ONE
    if rules.looks_ahead != 0 and m.rates > ZERO and plan[now.number + 1, REMOVAL] >= ZERO:
        m.ahead = plan[now.number + 1, REMOVAL]
        now.stiffness_next = plan[now.number + 1, STIFFNESS]
    step = foreseen_step(m, m.ahead)
    for k in range(lane(), curves.base.shape[0], width()):
        start = wp.where(curves.answer[PRESSURE, k] > ZERO, curves.base[k] + curves.offset[k], approach)
        deflection = approach - start
        courses.start[k] = start
        if gives:
            courses.giving[k] = (deflection - courses.deflection[k]) / now.removal
        courses.deflection[k] = deflection
        courses.base_next[k] = curves.base[k]
        courses.offset_next[k] = curves.offset[k]
        if m.ahead >= ZERO:
            courses.base_next[k] = start
            courses.offset_next[k] = step
            if gives:
                courses.offset_next[k] = step - m.ahead * courses.giving[k]
    wait_for_slot()
    if lane() == 0:
        now_out[0] = now
        memory[0] = m


@wp.kernel
def end(
    first_slot: wp.int32,
    slots: wp.int32,
    rules: Rules,
    curves: Curves,
    courses: Courses,
    search: wp.array(dtype=Search),
    now_out: wp.array(dtype=Now),
    books: Books,
    flags: Flags,
):
    """Enter a step that has worn into the books, and see whether another one follows."""
    s = search[0]
    now = now_out[0]
    row = now.number
    of_cell = rules.cell_area * rules.weight
    for k in range(lane(), curves.base.shape[0], width()):
        courses.reached[k] = wp.max(courses.reached[k], curves.base[k] + curves.offset[k])
        books.loads[row, k] = books.sums[WearSum.PRESSURE, k] * of_cell
        books.areas[row, k] = books.sums[WearSum.CONTACT, k] * of_cell
    sums = books.sums.shape[0]
    for line in range(sums):
        total = sum_of(books.sums, line)
        if lane() == 0:
            books.rows[row, FIRST + line] = total
    for line in range(books.maxima.shape[0]):
        largest = most_of(books.maxima, line)
        if lane() == 0:
            books.rows[row, FIRST + sums + line] = largest
    wait_for_slot()
    if lane() == 0:
        books.rows[row, 0] = s.common_base
        books.rows[row, 1] = s.common
        books.rows[row, 2] = now.reference
        books.rows[row, 3] = wp.float64(s.evaluations - now.answered)
        pressure = books.rows[row, FIRST + WearSum.PRESSURE]
        contact = books.rows[row, FIRST + WearSum.CONTACT]
        now.mean = pressure / contact
        now.number = row + 1
        follows = now.number < now.steps and contact > ZERO
        left = wp.abs(pressure * of_cell - rules.load.load)
        follows = follows and left <= (ONE + ONE) * rules.load.tolerance * rules.load.load
        for i in range(4):
            extent = books.rows[row, FIRST + sums + WearMost.FIRST_ROW + i]
            now.extents[i] = wp.max(now.extents[i], extent)
            follows = follows and extent <= rules.within[i]
        now_out[0] = now
        flags.stepping[0] = wp.where(follows, 1, 0)
