"""Decide between the passes of a step of patches where its search begins, and book what the step leaves."""

import math

import warp as wp

from warpwear.kernels.cells import NO_INDEX, NONE, ONE, ZERO, WearMost, WearSum
from warpwear.kernels.contact import Bends
from warpwear.kernels.foresight import Trend, foreseen_step, learnt
from warpwear.kernels.native_code import lane, total_of, width
from warpwear.kernels.newton import HALF, LOOKS
from warpwear.kernels.two_scale.curves import PRESSURE, TOGETHER, Curves, wait_for_slot
from warpwear.kernels.two_scale.sharing import Flags, SharedLoad, SharingSearch, search_from, set_flags

#: Columns of a row that a step leaves, before its sums and maxima.
HEADER = ("base", "offset", "reference", "evaluations")
FIRST = wp.constant(wp.int32(len(HEADER)))
#: Columns of a plan.
REMOVAL = wp.constant(wp.int32(0))
STIFFNESS = wp.constant(wp.int32(1))
FLEXIBILITY = wp.constant(wp.int32(2))
PI = wp.constant(wp.float64(math.pi))
QUARTER = wp.constant(wp.float64(math.pi / 4.0))


@wp.struct
class CurrentStep:
    """Holds the step that is being computed."""

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
    """Holds what the next step goes by of those before."""

    trend: Trend  # of the bodies' approach
    gives: wp.float64  # 1 where it is known how fast springs give way
    ahead: wp.float64  # K ΔL for which the patches have answered ahead; negative where they have not


@wp.struct
class Steps:
    """Holds what steps of a contact have in common, their plan, and what lies between them."""

    load: SharedLoad
    lowest: wp.float64  # of all cells before any wear [mm]
    cell: wp.float64  # [mm]
    cell_area: wp.float64  # [mm²]
    weight: wp.float64  # area that a cell stands for over its own
    follows: wp.float64  # K_N times the radius of the contact that it follows [N/mm²]; 0 where it does not
    sprung: wp.int32  # whether springs lie behind the patches
    looks_ahead: wp.int32  # whether the pass that wears evaluates for the next step as well
    #: Largest extents of what may be touched before the host is asked, by `kernels.cells.EXTENTS`.
    within: wp.vec4d
    #: Of a step: compliance of cells that is not wear, and 1 where wear lends one.
    bends: Bends
    plan: wp.array2d(dtype=wp.float64)  # a row a step: K ΔL of both bodies, 1/c of the cells, 1/K_N
    now: wp.array(dtype=CurrentStep)  # one
    memory: wp.array(dtype=Memory)  # one
    search: wp.array(dtype=SharingSearch)  # one
    flags: Flags


@wp.struct
class Courses:
    """Holds what the next step goes by of every patch, one number each."""

    start: wp.array(dtype=wp.float64)  # from which it counts; without pressure it hangs on the bodies [mm]
    deflection: wp.array(dtype=wp.float64)  # of its spring [mm]
    giving: wp.array(dtype=wp.float64)  # how fast that grew, over what a unit of pressure removes [MPa]
    reached: wp.array(dtype=wp.float64)  # largest approach so far [mm]
    base_next: wp.array(dtype=wp.float64)  # at which it is evaluated ahead [mm]
    offset_next: wp.array(dtype=wp.float64)


@wp.struct
class Books:
    """Books keep what steps leave, a row a step."""

    sums: wp.array2d(dtype=wp.float64)  # of the last step, lines of `WearSum`, a column a patch
    maxima: wp.array2d(dtype=wp.float64)  # lines of `WearMost`
    ahead: wp.array2d(dtype=wp.float64)  # what was added up for the next step, as `Surfaces.trial`
    rows: wp.array2d(dtype=wp.float64)  # HEADER, sums, maxima
    loads: wp.array2d(dtype=wp.float64)  # of every patch [N]
    areas: wp.array2d(dtype=wp.float64)  # [mm²]


@wp.func
def guess_of(trend: Trend, now: CurrentStep):
    """Return how far the solution is expected from where a search begins [mm]."""
    guess = now.removal * now.mean
    if trend.rates > 0:
        guess = foreseen_step(trend, now.removal)
    return guess


@wp.func
def first_guess(steps: Steps, now: CurrentStep):
    """Return the first step of a search from the lowest cell [mm]."""
    pressure = wp.min(steps.load.hardness, steps.load.load / steps.cell_area)
    return HALF * pressure / now.stiffness


@wp.func
def next_step(steps: Steps):
    """Return the next step of the plan."""
    now = steps.now[0]
    now.removal = steps.plan[now.number, REMOVAL]
    now.stiffness = steps.plan[now.number, STIFFNESS]
    now.stiffness_next = now.stiffness
    now.reference = now.mean
    if now.mean == ZERO and steps.load.hardness < NONE:
        now.reference = steps.load.hardness
    return now


@wp.func
def flexibility_of(steps: Steps, now: CurrentStep):
    """Return 1/K_N of the step [mm³/N], which may follow the contact as it grows."""
    flexibility = steps.plan[now.number, FLEXIBILITY]
    extents = now.extents
    if steps.follows > ZERO and extents[1] > NO_INDEX:
        along = (extents[1] + extents[0] + ONE) * steps.cell
        across = (extents[3] + extents[2] + ONE) * steps.cell
        flexibility = ONE / (steps.follows / wp.sqrt(QUARTER * along * across / PI))
    return flexibility


@wp.kernel(module=TOGETHER)
def begin(steps: Steps, curves: Curves, courses: Courses):
    """Begin a step whose load is shared: a search from the last approaches, or from the lowest cell."""
    m = steps.memory[0]
    now = next_step(steps)
    s = SharingSearch()
    s.flexibility = flexibility_of(steps, now)
    trend = m.trend
    is_first = trend.is_begun == 0
    guess = guess_of(trend, now)
    if is_first:
        guess = first_guess(steps, now)
    for k in range(lane(), curves.base.shape[0], width()):
        curves.base[k] = wp.where(is_first, steps.lowest, courses.start[k])
        curves.offset[k] = guess
        if trend.rates > 0 and m.gives > ZERO:
            curves.offset[k] = guess - now.removal * courses.giving[k]
    now.answered = wp.where(m.ahead == now.removal, 1, 0)
    common_base = wp.where(is_first, steps.lowest, trend.approach)
    s = search_from(curves, steps.load, s, common_base, guess, wp.where(is_first, ZERO, -NONE))
    wait_for_slot()
    if lane() == 0:
        steps.now[0] = now
        steps.search[0] = s
        set_flags(steps.flags, LOOKS)
        steps.flags.unanswered[0] = 1 - now.answered


@wp.kernel(module=TOGETHER)
def foresee(steps: Steps, curves: Curves, courses: Courses):
    """Learn from the approaches of a step, and tell at which ones the pass that wears looks ahead."""
    s = steps.search[0]
    now = steps.now[0]
    m = steps.memory[0]
    approach = s.common_base + s.bracket.offset
    trend = m.trend
    gives = steps.sprung != 0 and trend.is_begun == 1 and now.removal > ZERO
    trend = learnt(trend, approach, now.removal)
    m.trend = trend
    m.gives = wp.where(gives, ONE, ZERO)
    m.ahead = -ONE
    if steps.looks_ahead != 0 and trend.rates > 0 and steps.plan[now.number + 1, REMOVAL] >= ZERO:
        m.ahead = steps.plan[now.number + 1, REMOVAL]
        now.stiffness_next = steps.plan[now.number + 1, STIFFNESS]
    step = foreseen_step(trend, m.ahead)
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
        steps.now[0] = now
        steps.memory[0] = m


@wp.kernel(module=TOGETHER)
def end(steps: Steps, curves: Curves, courses: Courses, books: Books):
    """Enter a step that has worn into the books, and see whether another one follows."""
    s = steps.search[0]
    now = steps.now[0]
    row = now.number
    of_cell = steps.cell_area * steps.weight
    for k in range(lane(), curves.base.shape[0], width()):
        courses.reached[k] = wp.max(courses.reached[k], curves.base[k] + curves.offset[k])
        books.loads[row, k] = books.sums[WearSum.PRESSURE, k] * of_cell
        books.areas[row, k] = books.sums[WearSum.CONTACT, k] * of_cell
    sums = books.sums.shape[0]
    total_of(books.sums, 1, books.rows, row, FIRST)
    total_of(books.maxima, 0, books.rows, row, FIRST + sums)
    if lane() == 0:
        books.rows[row, 0] = s.common_base
        books.rows[row, 1] = s.bracket.offset
        books.rows[row, 2] = now.reference
        books.rows[row, 3] = wp.float64(s.evaluations - now.answered)
        pressure = books.rows[row, FIRST + WearSum.PRESSURE]
        contact = books.rows[row, FIRST + WearSum.CONTACT]
        now.mean = pressure / contact
        now.number = row + 1
        follows = now.number < now.steps and contact > ZERO
        left = wp.abs(pressure * of_cell - steps.load.load)
        follows = follows and left <= (ONE + ONE) * steps.load.tolerance * steps.load.load
        extents = now.extents
        for i in range(4):
            extent = books.rows[row, FIRST + sums + WearMost.FIRST_ROW + i]
            extents[i] = wp.max(extents[i], extent)
            follows = follows and extent <= steps.within[i]
        now.extents = extents
        steps.now[0] = now
        steps.flags.stepping[0] = wp.where(follows, 1, 0)
