"""A search finds the approaches at which patches share a load, by a decision after each pass over the cells.

A patch k carries the mean pressure p_k at its approach u_k; behind it is a spring, so that all have

    u_k + p_k / K_N = δ,   A Σ p_k = F

with one δ. A pass evaluates all patches at trial approaches u_k = base_k + offset_k, and so finds a point of
the curve p_k(δ) of each, at δ_k = u_k + p_k / K_N. Newton's method follows all curves to a common δ; where
it takes too long δ is held, and the patches are solved at it in brackets. Lengths are offsets from bases near
the solution, which together hold more digits than their sum.
"""

import warp as wp

from warpwear.kernels import newton as roots
from warpwear.kernels.cells import NONE, ONE, ZERO
from warpwear.kernels.native_code import lane, most_of, sum_of, width
from warpwear.kernels.newton import HALF, Bracket
from warpwear.kernels.two_scale.curves import (
    PRESSURE,
    SLOPE,
    STRAIGHT,
    TOGETHER,
    Curves,
    End,
    clear_bracket,
    enter_point,
    next_number,
)

#: Evaluations after which the approach of the bodies is held while the patches are solved at it, in brackets.
JOINT = wp.constant(wp.int32(12))
#: Of them, one in this many halves a bracket.
BISECT_EVERY = wp.constant(wp.int32(3))
#: Searches, each from bases nearer the solution: where cells are almost rigid, patches get digits in turns.
SEARCHES = wp.constant(wp.int32(8))


@wp.struct
class SharedLoad:
    """Holds what patches carry together."""

    load: wp.float64  # F [N]
    area: wp.float64  # that each stands for [mm²]
    hardness: wp.float64  # that no patch exceeds [MPa]
    tolerance: wp.float64  # of the load, and of the largest deflection of a spring
    evaluations: wp.int32  # of a search, at most


@wp.struct
class SharingSearch:
    """Holds the numbers of a search. Lengths are offsets from its bases [mm]."""

    flexibility: wp.float64  # 1/K_N [mm³/N], 0 without a spring
    common_base: wp.float64  # of the bodies' approach δ [mm]
    bracket: Bracket  # of its offset: LOOKS, MET where the load is shared, or STUCK
    residual: wp.float64  # carried − load [N]
    spring_residual: wp.float64  # largest |u_k + p_k / K_N − δ| [mm]
    spring_allowed: wp.float64
    evaluations: wp.int32  # of all searches
    bracketed: wp.int32  # evaluations inside a bracket
    waited: wp.int32  # evaluations at an approach that is held
    number: wp.int32  # of the search


@wp.struct
class Flags:
    """Holds what loops and branches of a program go by, one number each."""

    searching: wp.array(dtype=wp.int32)
    unanswered: wp.array(dtype=wp.int32)  # whether the patches must be asked at the trial approaches
    balanced: wp.array(dtype=wp.int32)  # whether a search has ended well
    stepping: wp.array(dtype=wp.int32)  # whether steps follow


@wp.func
def set_flags(flags: Flags, state: wp.int32):
    """Say how far a search is, and end the steps where it has failed."""
    flags.searching[0] = wp.where(state == roots.LOOKS, 1, 0)
    flags.unanswered[0] = 1
    flags.balanced[0] = wp.where(state == roots.MET, 1, 0)
    if state == roots.STUCK:
        flags.stepping[0] = 0


@wp.func
def point_of(curves: Curves, s: SharingSearch, k: wp.int32):
    """Return the point of a patch's curve: δ at which it is where it was evaluated, as an offset."""
    p = curves.answer[PRESSURE, k]
    shift = s.common_base - curves.base[k]  # exact where both are of one size
    point = (curves.offset[k] - shift) + s.flexibility * p
    if p == ZERO:
        # A free patch is free up to its lowest cell: that point of its curve is known as well.
        point = wp.max(point, curves.lowest[k] - s.common_base)
    return point


@wp.func
def apart_of(free: wp.bool, point: wp.float64, common: wp.float64):
    """Return how far a patch is from a common approach; it is not from one that it does not reach."""
    return wp.where(free and point >= common, ZERO, wp.abs(point - common))


@wp.func
def search_from(
    curves: Curves,
    load: SharedLoad,
    s: SharingSearch,
    common_base: wp.float64,
    guess: wp.float64,
    low: wp.float64,
):
    """Begin a search at bases, with trial offsets that stand already. guess, low: of the bodies' offset."""
    s.common_base = common_base
    s.bracket = roots.bracket_at(guess, wp.abs(guess))
    s.bracket.low = low
    s.bracketed = wp.int32(0)
    s.waited = wp.int32(0)
    for k in range(lane(), curves.base.shape[0], width()):
        clear_bracket(curves, k, load.hardness)
    return s


@wp.func
def ended(s: SharingSearch, common: wp.float64, state: wp.int32):
    """End a search at an offset of the bodies."""
    s.bracket.offset = common
    s.bracket.state = state
    return s


@wp.func
def search_again(curves: Curves, load: SharedLoad, s: SharingSearch, common: wp.float64):
    """Begin the next search: from bases at the last approaches the offsets have digits again."""
    s.number += 1
    if s.number >= SEARCHES or not (wp.abs(common) < roots.HOPELESS):
        return ended(s, common, roots.STUCK)
    for k in range(lane(), curves.base.shape[0], width()):
        curves.base[k] = curves.base[k] + curves.offset[k]
        curves.offset[k] = ZERO
    return search_from(curves, load, s, s.common_base + common, ZERO, -NONE)


@wp.func
def take_sure_step(curves: Curves, load: SharedLoad, s: SharingSearch, newton: wp.float64):
    """Take Newton's step where no patch leaves its straight line on the way: it needs no second look."""
    for k in range(lane(), curves.base.shape[0], width()):
        p = curves.answer[PRESSURE, k]
        slope = curves.answer[SLOPE, k]
        free = p == ZERO
        shift = s.common_base - curves.base[k]
        point = (curves.offset[k] - shift) + s.flexibility * p
        move = (newton - point) / (ONE + s.flexibility * slope)
        leaves = wp.abs(move) >= roots.SURELY * curves.answer[STRAIGHT, k] and not (free and move <= ZERO)
        after = curves.offset[k] + move
        carries = p + slope * move
        curves.room[0, k] = wp.where(leaves, ONE, ZERO)
        curves.room[1, k] = slope * wp.abs(after)
        curves.room[2, k] = after
        curves.room[3, k] = carries
        curves.room[4, k] = apart_of(free, (after - shift) + s.flexibility * carries, newton)
    leaving = most_of(curves.room, 0) > ZERO
    digits = load.area * sum_of(curves.room, 1)
    residual = load.area * sum_of(curves.room, 3) - load.load
    apart = most_of(curves.room, 4)
    allowed = load.tolerance * s.flexibility * most_of(curves.room, 3)
    if leaving or digits > roots.DIGITS * load.load:
        return s
    if wp.abs(residual) > load.tolerance * load.load or apart > allowed:
        return s
    for k in range(lane(), curves.base.shape[0], width()):
        curves.offset[k] = curves.room[2, k]
        curves.answer[PRESSURE, k] = curves.room[3, k]
    s.residual = residual
    s.spring_residual = apart
    s.spring_allowed = allowed
    return ended(s, newton, roots.MET)


@wp.func
def evaluated_end(curves: Curves, s: SharingSearch, k: wp.int32):
    """Return the point at which a patch was evaluated; one that carries nothing is at its lowest cell."""
    point = point_of(curves, s, k)
    p = curves.answer[PRESSURE, k]
    approach = wp.where(p == ZERO, point + (s.common_base - curves.base[k]), curves.offset[k])
    return End(approach, point, p)


@wp.func
def total_at(curves: Curves, load: SharedLoad, s: SharingSearch, common: wp.float64):
    """Sum the pressures at the common approach [MPa], on its side of the load; negative while it is open.

    Where a patch's approach is down to neighbouring numbers, its cells are almost rigid and the curve between
    them is straight.
    """
    wanted = load.load / load.area
    for k in range(lane(), curves.base.shape[0], width()):
        here = evaluated_end(curves, s, k)
        enter_point(curves, k, common, here, load.hardness)
        far = apart_of(here.pressure == ZERO, here.point, common) > s.spring_allowed
        low = curves.low[k]
        high = curves.high[k]
        part = (common - low.point) / (high.point - low.point)
        between = low.pressure + part * (high.pressure - low.pressure)
        curves.room[0, k] = wp.where(
            far and next_number(low.approach, high.approach) < high.approach, ONE, ZERO
        )
        curves.room[1, k] = wp.where(far, between, here.pressure)
        curves.room[2, k] = low.pressure
        curves.room[3, k] = high.pressure
    is_open = most_of(curves.room, 0) > ZERO
    total = sum_of(curves.room, 1)
    least = sum_of(curves.room, 2)
    most = sum_of(curves.room, 3)
    if is_open:
        total = -ONE
    if most < wanted:
        total = most
    if least > wanted:
        total = least
    return total


@wp.func
def guess_offsets(curves: Curves, load: SharedLoad, s: SharingSearch, common: wp.float64, bisects: wp.bool):
    """Lay trial offsets of the patches at the next approach of the bodies."""
    # There may be no hardness.
    deepest = wp.where(s.flexibility > ZERO, s.flexibility * load.hardness, ZERO)
    for k in range(lane(), curves.base.shape[0], width()):
        here = evaluated_end(curves, s, k)
        enter_point(curves, k, common, here, load.hardness)
        # Where nothing is carried, and where the hardness is.
        bound = common + (s.common_base - curves.base[k])
        highest = wp.min(curves.high[k].approach, bound)
        lowest = wp.max(curves.lowest[k] - curves.base[k], bound - deepest)
        lowest = wp.min(wp.max(curves.low[k].approach, lowest), highest)
        way = common - here.point
        guess = here.approach + way / (ONE + s.flexibility * curves.answer[SLOPE, k])
        if guess == here.approach and way != ZERO:
            # A step too short for another number goes to the next one, so that brackets close.
            guess = next_number(here.approach, wp.where(way > ZERO, NONE, -NONE))
        if guess < lowest or guess > highest or (bisects and wp.abs(way) > s.spring_allowed):
            guess = HALF * (lowest + highest)
        curves.offset[k] = guess


@wp.func
def evaluated(curves: Curves, load: SharedLoad, s: SharingSearch):
    """Return the search after an evaluation: at its end, or with the next trial approaches."""
    s.bracket.evaluation += 1
    b = s.bracket
    s.evaluations += 1
    x = b.offset
    rigid = s.flexibility == ZERO
    held = not rigid and b.evaluation > JOINT
    for k in range(lane(), curves.base.shape[0], width()):
        slope = curves.answer[SLOPE, k]
        joined = slope / (ONE + s.flexibility * slope)
        curves.room[0, k] = joined
        curves.room[1, k] = joined * (point_of(curves, s, k) - x)
    carried = sum_of(curves.answer, PRESSURE)
    stiffness = sum_of(curves.room, 0)
    pull = sum_of(curves.room, 1)
    residual = load.area * carried - load.load
    rises = stiffness > ZERO
    newton = x + ((load.load / load.area - carried) + pull) / wp.where(rises, stiffness, ONE)
    common = wp.where(rigid or held or not rises, x, newton)
    for k in range(lane(), curves.base.shape[0], width()):
        point = point_of(curves, s, k)
        free = curves.answer[PRESSURE, k] == ZERO
        curves.room[0, k] = apart_of(free, point, common)
        curves.room[1, k] = -point
        curves.room[2, k] = wp.where(free, -NONE, point)
    s.residual = residual
    s.spring_residual = most_of(curves.room, 0)
    s.spring_allowed = load.tolerance * s.flexibility * most_of(curves.answer, PRESSURE)
    nearest = -most_of(curves.room, 1)
    furthest = most_of(curves.room, 2)
    solved = s.spring_residual <= s.spring_allowed
    if solved and wp.abs(residual) <= load.tolerance * load.load:
        return ended(s, common, roots.MET)
    if rises:
        s = take_sure_step(curves, load, s, newton)
    if s.bracket.state == roots.MET:
        return s
    if not (wp.abs(x) < roots.HOPELESS) or b.evaluation >= load.evaluations:
        return search_again(curves, load, s, x)
    if held and not solved:
        total = total_at(curves, load, s, x)
        if total >= ZERO:
            solved = True
            residual = load.area * total - load.load
    # No curve falls, so beyond the range of these points the common approach cannot lie.
    if residual < ZERO:
        b.low = wp.max(b.low, wp.where(held and solved, x, nearest))
    else:
        b.high = wp.min(b.high, wp.where(held and solved, x, furthest))
    s.waited += 1
    if not held or solved:
        s.waited = 0
        if roots.is_closed(b):
            s.bracketed += 1
        # While patches move as well the bracket is wide, and what halves it no measure.
        b = roots.stepped(b, residual, newton, rises, s.bracketed % 2 == 0, rigid or held)
        if (rigid or held) and roots.is_closed(b) and not (b.offset > b.low and b.offset < b.high):
            return search_again(curves, load, s, x)  # down to neighbouring numbers
    s.bracket = b
    bisects = held and s.waited % BISECT_EVERY == BISECT_EVERY - 1
    guess_offsets(curves, load, s, b.offset, bisects)
    return s


@wp.kernel(module=TOGETHER)
def judge(load: SharedLoad, curves: Curves, search_out: wp.array(dtype=SharingSearch), flags: Flags):
    """Decide after an evaluation whether the load is shared, and at what approaches to look next."""
    s = evaluated(curves, load, search_out[0])
    if lane() == 0:
        search_out[0] = s
        set_flags(flags, s.bracket.state)
