"""Curves of patches: what each carries over its approach, and the nearest points of it that are known.

An evaluation finds a point, at the approach of the bodies at which the patch, on its spring, is where it was
evaluated. Points below and above a common approach are the ends of a bracket.
"""

import math

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import ZERO

wp.set_module_options(native_code.options("patches.h"))

#: Lines of what patches answer: mean pressure [MPa], its slope [N/mm³], and how far an approach may move
#: while the pressure follows that slope [mm].
PRESSURE = wp.constant(wp.int32(0))
SLOPE = wp.constant(wp.int32(1))
STRAIGHT = wp.constant(wp.int32(2))
#: Lines of the ends of brackets: approach and point on the curve (offsets [mm]), pressure [MPa].
AT = wp.constant(wp.int32(0))
POINT = wp.constant(wp.int32(1))
CARRIES = wp.constant(wp.int32(2))
#: Lines of `Curves.room`.
LINES = 6
#: Stands for an end that is not known [mm].
FAR = wp.constant(wp.float64(math.inf))


@wp.struct
class Curves:
    """The patches and the nearest points of their curves; arrays of one number a patch, or lines of them."""

    lowest: wp.array(dtype=wp.float64)  # below that approach a patch carries nothing [mm]
    base: wp.array(dtype=wp.float64)  # of the trial approach [mm]
    offset: wp.array(dtype=wp.float64)
    answer: wp.array2d(dtype=wp.float64)  # at the trial approach
    low: wp.array2d(dtype=wp.float64)  # nearest point below a common approach
    high: wp.array2d(dtype=wp.float64)  # and above it
    room: wp.array2d(dtype=wp.float64)  # where numbers lie that are added up


@wp.func_native("return lane_of_slot();")
def lane() -> wp.int32:
    """Return the thread of the slot."""
    ...


@wp.func_native("return width_of_slot();")
def width() -> wp.int32:
    """Return how many threads the slot has."""
    ...


@wp.func_native("return next_number(number, to);")
def next_number(number: wp.float64, to: wp.float64) -> wp.float64:
    """Return the number after another one in a direction."""
    ...


@wp.func_native("wait_for_slot();")
def wait_for_slot():
    """Wait for all threads of the slot: what they have read may change then."""
    ...


@wp.func
def set_end(
    end: wp.array2d(dtype=wp.float64), k: wp.int32, at: wp.float64, point: wp.float64, carries: wp.float64
):
    """Take a point as an end of the bracket of a patch."""
    end[AT, k] = at
    end[POINT, k] = point
    end[CARRIES, k] = carries


@wp.func
def clear_bracket(curves: Curves, k: wp.int32, hardness: wp.float64):
    """Forget the points of a patch."""
    set_end(curves.low, k, -FAR, -FAR, ZERO)
    set_end(curves.high, k, FAR, FAR, hardness)


@wp.func
def enter_point(
    curves: Curves, k: wp.int32, common: wp.float64, at: wp.float64, point: wp.float64, hardness: wp.float64
):
    """Keep the point of a patch that is evaluated, for another common approach."""
    low = curves.low
    high = curves.high
    if low[POINT, k] > common:
        set_end(high, k, low[AT, k], low[POINT, k], low[CARRIES, k])
        set_end(low, k, -FAR, -FAR, ZERO)
    elif high[POINT, k] <= common:
        set_end(low, k, high[AT, k], high[POINT, k], high[CARRIES, k])
        set_end(high, k, FAR, FAR, hardness)
    p = curves.answer[PRESSURE, k]
    if point <= common and point >= low[POINT, k]:
        set_end(low, k, at, point, p)
    if point > common and point <= high[POINT, k]:
        set_end(high, k, at, point, p)
