"""The load balance of cells that do not yield: bearing area × hardness = load.

The area rises with the approach in steps, cell by cell, so the approach is looked for in a bracket. The first
approach that meets the tolerance is taken, and the pressure is load/area. Where cells tie, so that no
approach meets it, the tied cells share what is missing.

A pass over the listed tiles counts the cells below a trial and gathers those inside the bracket. Where they
all have room, the decision after it counts the next trials among them, up to the last one; else a pass
follows, on a smaller bracket. Few cells take one pass, many cells a few.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import BalanceSearch, Springs, ask_for, start_search
from warpwear.kernels.cells import LISTED, NONE, ZERO, fields
from warpwear.kernels.contact import Law
from warpwear.kernels.native_code import most_of, sum_of
from warpwear.kernels.newton import EVALUATIONS, GROWS, HALF, HOPELESS, LOOKS, MET, STUCK, bracket_at
from warpwear.kernels.tiles import TWO, Listing, reached

native_pass = native_code.passes_of(__name__, "springs.h")

#: Gaps that differ by less are tied [mm]: a picometre-thousandth, below anything a surface has.
TIE = wp.constant(wp.float64(1.0e-12))
#: Stands for 1/c where c = 0: any overlap reaches the cap.
RIGID = wp.constant(wp.float64(1.0e300))
#: More than half of the distance to the next number, over a number.
HALF_ULP = wp.constant(wp.float64(1.2e-16))
#: Every third trial halves the bracket.
HALVES = wp.constant(wp.int32(3))
#: What a pass counts: all cells; those below a trial; those below a tie, and those up to its end.
ALL = wp.constant(wp.int32(0))
TRIAL = wp.constant(wp.int32(1))
BELOW_TIE = wp.constant(wp.int32(2))
UP_TO_TIE = wp.constant(wp.int32(3))


@wp.func
def area_between(springs: Springs, start: wp.float64, scatter: wp.float64):
    """Begin a search in a bracket of all that lies up to the highest gap before wear, whatever is expected.

    scatter: how far from the start the approach may be; 0 where that is not known [mm].
    """
    s = BalanceSearch()
    s.bracket = bracket_at(springs.highest + TWO * TIE, ZERO)  # so that the highest cell counts
    s.start = start
    s.scatter = scatter
    s.margin = scatter
    s.is_cold = 1
    s.stiffness = RIGID
    s.above = NONE
    s.phase = ALL
    return s


@wp.func
def area_near(approach: wp.float64, scatter: wp.float64):
    """Return a search in growing steps from an approach that may be off by a scatter."""
    s = BalanceSearch()
    s.bracket = bracket_at(approach, scatter)
    s.margin = scatter
    s.stiffness = RIGID
    s.above = NONE
    s.phase = TRIAL
    return s


@wp.func
def bracketed(
    springs: Springs,
    s: BalanceSearch,
    lists: Listing,
    count: wp.float64,
    lowest: wp.float64,
    highest: wp.float64,
):
    """Return the search of which nothing was known, with a bracket, or all tiles that it needs for that.

    count: of cells listed. lowest, highest: gap of them [mm].
    """
    b = s.bracket
    needed = springs.load / (springs.cap * springs.cell_area)
    if count < needed and lists.limit < NONE:
        lists.limit = NONE
        lists.asked = NONE
    else:
        # What is listed may be worn beyond the limit of the list, where lower tiles that are not may lie.
        b.low = wp.min(lowest, lists.limit)
        b.high = b.offset
        if count < needed:  # all cells are worn beyond it
            b.high = highest + TWO * TIE
        b.offset = HALF * (b.low + b.high)
        s.phase = TRIAL
        s.bracket = b
    return s, lists


@wp.func
def counted(springs: Springs, s: BalanceSearch, law: Law, count: wp.float64):
    """Return the search after a trial, and the law at its end. count: of cells below the trial."""
    b = s.bracket
    level = b.offset
    full = springs.cap * springs.cell_area  # load of a cell
    needed = springs.load / full
    s.evaluations = s.evaluations + 1
    if s.phase == TRIAL:
        width = b.high - b.low
        if wp.abs(count - needed) < springs.tolerance / full and count > ZERO:
            b.state = MET
            s.residual = (count - needed) * full
            law.base = level
            law.offset = ZERO
            law.cap = springs.load / (count * springs.cell_area)
            law.tie_width = ZERO
            law.tie_pressure = ZERO
        else:
            if count > needed:
                b.high = level
                s.above = count
            else:
                b.low = level
                s.below = count
            if s.is_cold == 0:
                width = b.high - b.low
            if width <= TIE:
                s.phase = BELOW_TIE
                s.start = level
                b.offset = level - TIE
            elif b.low <= -NONE or b.high >= NONE:
                b.offset = level + wp.where(count < needed, b.reach, -b.reach)
                b.reach = GROWS * b.reach
                if not (b.reach < HOPELESS):
                    b.state = STUCK
            else:
                # Over the whole of a surface the counts at the ends say nothing of what lies between.
                b.offset = HALF * (b.low + b.high)
                if s.is_cold == 0 and s.evaluations % HALVES != 0:
                    straight = b.low + (needed - s.below) / (s.above - s.below) * (b.high - b.low)
                    if straight > b.low and straight < b.high:
                        b.offset = straight
            if s.evaluations >= EVALUATIONS and s.phase == TRIAL:
                b.state = STUCK
    elif s.phase == BELOW_TIE:
        s.below = count
        s.phase = UP_TO_TIE
        up = s.start + TIE
        b.offset = up + HALF_ULP * wp.abs(up)  # the next number
    else:
        s.above = count
        tied = count - s.below
        part = (needed - s.below) / tied
        b.state = STUCK
        if tied > ZERO and part >= ZERO and part <= wp.float64(1.0):
            # The full cells carry the hardness, so the load is met without a rescaling of the pressure.
            b.state = MET
            law.base = s.start
            law.offset = ZERO
            law.cap = springs.cap
            law.tie_width = TIE
            law.tie_pressure = part * springs.cap
            s.residual = (s.below + part * tied) * full - springs.load
    s.bracket = b
    return s, law


@wp.func_native("return are_gathered(springs);")
def _are_gathered(springs: Springs) -> wp.bool: ...


@wp.func_native("return count_gathered(springs, level);")
def _count_gathered(springs: Springs, level: wp.float64) -> wp.float64: ...


@wp.func_native("return inside_up_to(springs);")
def _inside_up_to(springs: Springs) -> wp.float64: ...


@wp.func
def judged_area(springs: Springs):
    """Return the search after a pass, the tiles that it needs, and the law of pressures at its end.

    Every thread of the deciding slot follows it.
    """
    s = springs.search[0]
    lists = springs.lists[0]
    law = springs.law[0]
    count = sum_of(springs.trial, 0)
    lowest = -most_of(springs.trial, 1)
    highest = most_of(springs.trial, 2)
    is_gathered = _are_gathered(springs)
    below = s.below  # below the bracket
    low = s.bracket.low
    high = _inside_up_to(springs)
    up_to_high = below + sum_of(springs.trial, 3)
    full = springs.cap * springs.cell_area
    # A bracket that begins far up is halved without counting until it is down to where cells are looked at.
    is_beyond = s.is_cold == 1 and up_to_high - springs.load / full >= springs.tolerance / full
    if s.phase == ALL:
        s, lists = bracketed(springs, s, lists, count, lowest, highest)
    elif s.bracket.offset <= lists.limit:
        s, law = counted(springs, s, law, count)
    is_known = s.phase != ALL
    while is_known and s.bracket.state == LOOKS:
        level = s.bracket.offset
        if level > high:
            is_known = is_beyond and s.phase == TRIAL
            count = up_to_high
        else:
            is_known = is_gathered and level >= low
            if is_known:
                count = below + _count_gathered(springs, level)
        if is_known:
            s, law = counted(springs, s, law, count)
    if s.bracket.state == LOOKS and s.phase != ALL:
        level = s.bracket.offset
        if s.is_cold == 1 and s.scatter > ZERO and level > high and springs.near.shape[0] > 0:
            s.scatter = GROWS * s.scatter  # too few lie within: look further
            level = wp.min(level, s.start + s.scatter)
        lists = reached(lists, level, s.margin)
    return s, lists, law


@wp.func
def conclude_area(springs: Springs, s: BalanceSearch, lists: Listing, law: Law):
    """Keep a search, and where it has ended, the law of the pressures."""
    ask_for(springs, lists)
    springs.search[0] = s
    springs.law[0] = law
    springs.searching[0] = wp.where(s.bracket.state == LOOKS, 1, 0)


@wp.kernel
def begin(springs: Springs, lowest: wp.float64):
    """Begins a search of which nothing is known, on any list. lowest: gap [mm]."""
    if wp.tid() == 0:
        start_search(springs, lowest, area_between(springs, lowest, ZERO))


#: Count cells in contact at the trial, in cells at the cap: of each its part of it, if it has one.
#:
#: Those inside the bracket are gathered; the lowest and the highest gap are found.
counted_below = native_pass("count_level", **LISTED, springs=Springs, **fields("gap", "cap_ratio"))


@wp.kernel
def judge_area(springs: Springs):
    """Decides what follows from a pass over a bearing area."""
    s, lists, law = judged_area(springs)
    if wp.tid() == 0:
        conclude_area(springs, s, lists, law)
