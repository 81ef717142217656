"""Newton's search finds a load inside a bracket, one trial after another.

What carries a load rises with the offset looked for, and piecewise linearly where cells follow springs.
Newton's step is taken while it stays inside the bracket and the bracket halves at least every second
evaluation: alone it crawls where the capped overlap is a few nanometres. Sides of the bracket that are not
known yet are looked for in growing steps. Where no cell changes its state on the way, Newton's step is the
solution and is not looked at again.
"""

import warp as wp

from warpwear.kernels.cells import NONE, ONE, ZERO

wp.set_module_options({"enable_backward": False})

#: How far a search is: it looks further; what is carried at the offset is the load; Newton's step surely is
#: it; the bracket is down to neighbouring numbers, or all evaluations are spent.
LOOKS = wp.constant(wp.int32(0))
MET = wp.constant(wp.int32(1))
SURE = wp.constant(wp.int32(2))
STUCK = wp.constant(wp.int32(3))

HALF = wp.constant(wp.float64(0.5))
#: Steps without a bracket grow by this factor.
GROWS = wp.constant(wp.float64(4.0))
#: First step of a search that starts where the solution is.
FIRST_REACH = wp.constant(wp.float64(1.0e-18))
#: An offset beyond that is none: the load cannot be carried.
HOPELESS = wp.constant(wp.float64(1.0e6))
EVALUATIONS = wp.constant(wp.int32(399))
#: Part of the way to the next change of state that Newton's step may take and be sure of it.
SURELY = wp.constant(wp.float64(0.999))
#: Load of the offset's length over the load, up to which the offset has digits enough for the tolerance.
DIGITS = wp.constant(wp.float64(1.0e3))


@wp.struct
class Bracket:
    """Holds a search: its trial offset, the bracket of the solution, and how far it is."""

    offset: wp.float64
    low: wp.float64
    high: wp.float64
    reach: wp.float64  # of a step without a bracket, at most
    width: wp.float64  # of the bracket two evaluations ago
    evaluation: wp.int32
    state: wp.int32  # LOOKS, MET, SURE or STUCK


@wp.func
def bracket_at(offset: wp.float64, reach: wp.float64):
    """Return a search that begins at an offset, with steps of a length at first; of 0 the shortest."""
    b = Bracket()
    b.offset = offset
    b.low = -NONE
    b.high = NONE
    b.reach = wp.where(reach > ZERO, reach, FIRST_REACH)
    b.width = NONE
    b.state = LOOKS
    return b


@wp.func
def is_closed(b: Bracket):
    """Tell whether both sides of the bracket are known."""
    return b.low > -NONE and b.high < NONE


@wp.func
def stepped(
    b: Bracket, residual: wp.float64, newton: wp.float64, rises: wp.bool, even: wp.bool, halves: wp.bool
):
    """Return the search with its next trial, by Newton's step and the bracket.

    residual: force less load at the last trial. rises: whether the slope gives a Newton's step. even: whether
    this is an evaluation, one in two, at which the bracket's width is noted. halves: whether the bracket has
    to be half as wide by then, or is halved.
    """
    if is_closed(b):
        stalled = halves and even and b.high - b.low > HALF * b.width
        if even:
            b.width = b.high - b.low
        b.offset = HALF * (b.low + b.high)
        if rises and newton > b.low and newton < b.high and not stalled:
            b.offset = newton
    else:
        way = wp.abs(newton - b.offset)
        b.offset = b.offset + wp.where(residual < ZERO, b.reach, -b.reach)
        if rises and way <= b.reach:
            b.offset = newton
        b.reach = GROWS * b.reach
    return b


@wp.func
def next_trial(
    b: Bracket,
    force: wp.float64,
    slope: wp.float64,
    load: wp.float64,
    tolerance: wp.float64,
    linear_range: wp.float64,
):
    """Return the search with its next trial, or at its end, by the force and its slope at the last one.

    tolerance: of the force. linear_range: way as far as which the force is surely a straight line; 0 where
    that is not known.
    """
    b.evaluation = b.evaluation + 1
    residual = force - load
    offset = b.offset
    if wp.abs(residual) <= tolerance:
        b.state = MET
    elif not (wp.abs(offset) < HOPELESS) or b.evaluation >= EVALUATIONS:
        b.state = STUCK
    else:
        if residual < ZERO:
            b.low = offset
        else:
            b.high = offset
        rises = slope > ZERO
        newton = offset - residual / wp.where(rises, slope, ONE)
        way = wp.abs(newton - offset)
        if rises and way < SURELY * linear_range and slope * wp.abs(newton) < DIGITS * load:
            b.offset = newton
            b.state = SURE
        else:
            b = stepped(b, residual, newton, rises, b.evaluation % 2 == 0, True)
            if is_closed(b) and (b.offset <= b.low or b.offset >= b.high):
                b.offset = offset
                b.state = STUCK
    return b
