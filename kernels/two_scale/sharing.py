"""The search for the approaches at which patches share a load: one decision after each pass over the cells.

A patch k carries the mean pressure p_k at its approach u_k; behind it is a spring, so that all have

    u_k + p_k / K_N = δ,   A Σ p_k = F

with one δ. A pass evaluates all patches at trial approaches u_k = base_k + offset_k, and so finds a point of
the curve p_k(δ) of each, at δ_k = u_k + p_k / K_N. Newton's method follows all curves to a common δ; where
it takes too long δ is held, and the patches are solved at it in brackets. Lengths are offsets from bases near
the solution, which together hold more digits than their sum.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import most_of, sum_of
from warpwear.kernels.cells import NONE, ONE, ZERO
from warpwear.kernels.newton import DIGITS, FIRST_REACH, GROWS, HALF, HOPELESS, SURELY
from warpwear.kernels.two_scale.curves import (
    AT,
    CARRIES,
    POINT,
    PRESSURE,
    SLOPE,
    STRAIGHT,
    Curves,
    clear_bracket,
    enter_point,
    lane,
    next_number,
    width,
)

wp.set_module_options(native_code.options("patches.h"))

#: Evaluations after which the approach of the bodies is held while the patches are solved at it, in brackets.
JOINT = wp.constant(wp.int32(12))
#: Of them, one in this many halves a bracket.
BISECT_EVERY = wp.constant(wp.int32(3))
#: Searches, each from bases nearer the solution: where cells are almost rigid, patches get digits in turns.
SEARCHES = wp.constant(wp.int32(8))

#: How far a search is.
LOOKS = wp.constant(wp.int32(0))
SHARED = wp.constant(wp.int32(1))
FAILED = wp.constant(wp.int32(2))


@wp.struct
class Load:
    """What patches carry together."""

    load: wp.float64  # F [N]
    area: wp.float64  # that each stands for [mm²]
    hardness: wp.float64  # that no patch exceeds [MPa]
    tolerance: wp.float64  # of the load, and of the largest deflection of a spring
    evaluations: wp.int32  # of a search, at most


@wp.struct
class Search:
    """Numbers of a search. Lengths are offsets from its bases [mm]."""

    flexibility: wp.float64  # 1/K_N [mm³/N], 0 without a spring
    common_base: wp.float64  # of the bodies' approach δ [mm]
    common: wp.float64  # its offset: the last trial, or the solution
    low: wp.float64  # bracket of it
    high: wp.float64
    reach: wp.float64  # of a step without a bracket, at most
    width: wp.float64  # of the bracket two steps ago
    residual: wp.float64  # carried − load [N]
    spring_residual: wp.float64  # largest |u_k + p_k / K_N − δ| [mm]
    spring_allowed: wp.float64
    evaluation: wp.int32  # of this search
    evaluations: wp.int32  # of all searches
    bracketed: wp.int32  # evaluations inside a bracket
    waited: wp.int32  # evaluations at an approach that is held
    number: wp.int32  # of the search
    state: wp.int32  # LOOKS, SHARED or FAILED


@wp.struct
class Flags:
    """What loops and branches of a program go by, one number each."""

    searching: wp.array(dtype=wp.int32)
    unanswered: wp.array(dtype=wp.int32)  # whether the patches must be asked at the trial approaches
    balanced: wp.array(dtype=wp.int32)  # whether a search has ended well
    stepping: wp.array(dtype=wp.int32)  # whether steps follow


@wp.func
def point_of(curves: Curves, s: Search, k: wp.int32):
    """The point of a patch's curve: δ at which it is where it was evaluated, as an offset."""
    p = curves.answer[PRESSURE, k]
    shift = s.common_base - curves.base[k]  # exact where both are of one size
    point = (curves.offset[k] - shift) + s.flexibility * p
    if p == ZERO:
        # A free patch is free up to its lowest cell: that point of its curve is known as well.
        point = wp.max(point, curves.lowest[k] - s.common_base)
    return point


@wp.func
def apart_of(free: wp.bool, point: wp.float64, common: wp.float64):
    """How far a patch is from a common approach; none is that it does not reach."""
    return wp.where(free and point >= common, ZERO, wp.abs(point - common))


@wp.func
def search_from(
    curves: Curves, load: Load, before: Search, common_base: wp.float64, guess: wp.float64, low: wp.float64
):
    """A search from bases, with trial offsets that stand already. guess, low: of the bodies' offset."""
    s = before
    s.common_base = common_base
    s.common = guess
    s.low = low
    s.high = NONE
    s.reach = wp.where(guess == ZERO, FIRST_REACH, wp.abs(guess))
    s.width = NONE
    s.evaluation = wp.int32(0)
    s.bracketed = wp.int32(0)
    s.waited = wp.int32(0)
    s.state = LOOKS
    for k in range(lane(), curves.base.shape[0], width()):
        clear_bracket(curves, k, load.hardness)
    return s


@wp.func
def search_again(curves: Curves, load: Load, before: Search):
    """The next search: from bases at the last approaches the offsets have digits again."""
    s = before
    s.number += 1
    if s.number >= SEARCHES or not (wp.abs(s.common) < HOPELESS):
        s.state = FAILED
        return s
    for k in range(lane(), curves.base.shape[0], width()):
        curves.base[k] = curves.base[k] + curves.offset[k]
        curves.offset[k] = ZERO
    return search_from(curves, load, s, s.common_base + s.common, ZERO, -NONE)


@wp.func
def take_sure_step(curves: Curves, load: Load, before: Search, newton: wp.float64):
    """Newton's step, where no patch leaves its straight line on the way: it needs no second look."""
    s = before
    for k in range(lane(), curves.base.shape[0], width()):
        p = curves.answer[PRESSURE, k]
        slope = curves.answer[SLOPE, k]
        free = p == ZERO
        shift = s.common_base - curves.base[k]
        point = (curves.offset[k] - shift) + s.flexibility * p
        move = (newton - point) / (ONE + s.flexibility * slope)
        leaves = wp.abs(move) >= SURELY * curves.answer[STRAIGHT, k] and not (free and move <= ZERO)
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
    if leaving or digits > DIGITS * load.load:
        return s
    if wp.abs(residual) > load.tolerance * load.load or apart > allowed:
        return s
    for k in range(lane(), curves.base.shape[0], width()):
        curves.offset[k] = curves.room[2, k]
        curves.answer[PRESSURE, k] = curves.room[3, k]
    s.residual = residual
    s.spring_residual = apart
    s.spring_allowed = allowed
    s.common = newton
    s.state = SHARED
    return s


@wp.func
def total_at(curves: Curves, load: Load, s: Search, hardness: wp.float64):
    """Sum of the pressures at the common approach [MPa], on its side of the load; negative while it is open.

    Where a patch's approach is down to neighbouring numbers, its cells are almost rigid and the curve between
    them is straight.
    """
    wanted = load.load / load.area
    for k in range(lane(), curves.base.shape[0], width()):
        point = point_of(curves, s, k)
        p = curves.answer[PRESSURE, k]
        at = wp.where(p == ZERO, point + (s.common_base - curves.base[k]), curves.offset[k])
        enter_point(curves, k, s.common, at, point, hardness)
        far = apart_of(p == ZERO, point, s.common) > s.spring_allowed
        low = curves.low[AT, k]
        high = curves.high[AT, k]
        below = curves.low[POINT, k]
        least = curves.low[CARRIES, k]
        part = (s.common - below) / (curves.high[POINT, k] - below)
        curves.room[0, k] = wp.where(far and next_number(low, high) < high, ONE, ZERO)
        curves.room[1, k] = wp.where(far, least + part * (curves.high[CARRIES, k] - least), p)
    least_of_all = sum_of(curves.low, CARRIES)
    most_of_all = sum_of(curves.high, CARRIES)
    is_open = most_of(curves.room, 0) > ZERO
    total = sum_of(curves.room, 1)
    if is_open:
        total = -ONE
    if most_of_all < wanted:
        total = most_of_all
    if least_of_all > wanted:
        total = least_of_all
    return total


@wp.func
def next_common(before: Search, residual: wp.float64, newton: wp.float64, rises: wp.bool, exact: wp.bool):
    """The search with its next trial approach of the bodies, by Newton's step and the bracket of it.

    exact: whether the bracket is as narrow as what is known. While patches move as well, it is wide and what
    halves it no measure.
    """
    s = before
    x = s.common
    if s.low <= -NONE or s.high >= NONE:
        s.common = x + wp.where(residual < ZERO, s.reach, -s.reach)
        if rises and wp.abs(newton - x) <= s.reach:
            s.common = newton
        s.reach = GROWS * s.reach
        return s
    s.bracketed += 1
    even = s.bracketed % 2 == 0
    stalled = exact and even and s.high - s.low > HALF * s.width
    if even:
        s.width = s.high - s.low
    s.common = HALF * (s.low + s.high)
    if rises and newton > s.low and newton < s.high and not stalled:
        s.common = newton
    return s


@wp.func
def guess_offsets(curves: Curves, load: Load, s: Search, last: wp.float64, bisects: wp.bool):
    """Trial offsets of the patches at the next approach of the bodies. last: at which they were evaluated."""
    # There may be no hardness.
    deepest = wp.where(s.flexibility > ZERO, s.flexibility * load.hardness, ZERO)
    for k in range(lane(), curves.base.shape[0], width()):
        shift = s.common_base - curves.base[k]
        point = point_of(curves, s, k)
        p = curves.answer[PRESSURE, k]
        at = wp.where(p == ZERO, point + shift, curves.offset[k])
        enter_point(curves, k, s.common, at, point, load.hardness)
        # Where nothing is carried, and where the hardness is.
        bound = s.common + shift
        highest = wp.min(curves.high[AT, k], bound)
        lowest = wp.max(curves.lowest[k] - curves.base[k], bound - deepest)
        lowest = wp.min(wp.max(curves.low[AT, k], lowest), highest)
        way = s.common - point
        guess = at + way / (ONE + s.flexibility * curves.answer[SLOPE, k])
        if guess == at and way != ZERO:
            # A step too short for another number goes to the next one, so that brackets close.
            guess = next_number(at, wp.where(way > ZERO, NONE, -NONE))
        if guess < lowest or guess > highest or (bisects and wp.abs(way) > s.spring_allowed):
            guess = HALF * (lowest + highest)
        curves.offset[k] = guess


@wp.func
def evaluated(curves: Curves, load: Load, before: Search):
    """The search after an evaluation: at its end, or with the next trial approaches."""
    s = before
    s.evaluation += 1
    s.evaluations += 1
    x = s.common
    rigid = s.flexibility == ZERO
    held = not rigid and s.evaluation > JOINT
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
        s.common = common
        s.state = SHARED
        return s
    if rises:
        s = take_sure_step(curves, load, s, newton)
    if s.state == SHARED:
        return s
    if not (wp.abs(x) < HOPELESS) or s.evaluation >= load.evaluations:
        return search_again(curves, load, s)
    if held and not solved:
        total = total_at(curves, load, s, load.hardness)
        if total >= ZERO:
            solved = True
            residual = load.area * total - load.load
    # No curve falls, so beyond the range of these points the common approach cannot lie.
    if residual < ZERO:
        s.low = wp.max(s.low, wp.where(held and solved, x, nearest))
    else:
        s.high = wp.min(s.high, wp.where(held and solved, x, furthest))
    s.waited += 1
    if not held or solved:
        s.waited = 0
        s = next_common(s, residual, newton, rises, rigid or held)
        known = s.low > -NONE and s.high < NONE
        if (rigid or held) and known and not (s.common > s.low and s.common < s.high):
            s.common = x
            return search_again(curves, load, s)  # down to neighbouring numbers
    bisects = held and s.waited % BISECT_EVERY == BISECT_EVERY - 1
    guess_offsets(curves, load, s, x, bisects)
    return s


@wp.func
def judge_shares(load: Load, curves: Curves, search_out: wp.array(dtype=Search), flags: Flags):
    """Decide after an evaluation whether the load is shared, and at what approaches to look next."""
    s = evaluated(curves, load, search_out[0])
    if lane() == 0:
        search_out[0] = s
        flags.searching[0] = wp.where(s.state == LOOKS, 1, 0)
        flags.unanswered[0] = 1
        flags.balanced[0] = wp.where(s.state == SHARED, 1, 0)
        if s.state == FAILED:
            flags.stepping[0] = 0
