"""Curves of patches: what each carries over its approach, and the nearest points of it that are known.

An evaluation finds a point, at the approach of the bodies at which the patch, on its spring, is where it was
evaluated. Points below and above a common approach are the ends of a bracket.
"""

import math

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import ZERO

native_pass = native_code.passes_of(__name__, "patches.h")

#: All kernels of a step are compiled together.
TOGETHER = wp.get_module(__name__)
#: Lines of what patches answer: mean pressure [MPa], its slope [N/mm³], and how far an approach may move
#: while the pressure follows that slope [mm].
PRESSURE = wp.constant(wp.int32(0))
SLOPE = wp.constant(wp.int32(1))
STRAIGHT = wp.constant(wp.int32(2))
#: Lines of `Curves.room`.
LINES = 5
#: Stands for an end that is not known [mm].
FAR = wp.constant(wp.float64(math.inf))


@wp.struct
class End:
    """An end of the bracket of a patch is a point of its curve."""

    approach: wp.float64  # of the patch, an offset [mm]
    point: wp.float64  # of the bodies, an offset [mm]
    pressure: wp.float64  # [MPa]


@wp.struct
class Curves:
    """Patches have curves, whose nearest points are known: arrays of one number a patch, or lines of them."""

    lowest: wp.array(dtype=wp.float64)  # below that approach a patch carries nothing [mm]
    base: wp.array(dtype=wp.float64)  # of the trial approach [mm]
    offset: wp.array(dtype=wp.float64)
    answer: wp.array2d(dtype=wp.float64)  # at the trial approach
    low: wp.array(dtype=End)  # nearest point below a common approach
    high: wp.array(dtype=End)  # and above it
    room: wp.array2d(dtype=wp.float64)  # where numbers lie that are added up


@wp.func_native("return next_number(number, to);")
def next_number(number: wp.float64, to: wp.float64) -> wp.float64:
    """Return the number after another one in a direction."""


@wp.func_native("wait_for_slot();")
def wait_for_slot():
    """Wait for all threads of the slot: what they have read may change then."""


@wp.func
def clear_bracket(curves: Curves, k: wp.int32, hardness: wp.float64):
    """Forget the points of a patch."""
    curves.low[k] = End(-FAR, -FAR, ZERO)
    curves.high[k] = End(FAR, FAR, hardness)


@wp.func
def enter_point(curves: Curves, k: wp.int32, common: wp.float64, evaluated: End, hardness: wp.float64):
    """Keep the point of a patch that is evaluated, for another common approach."""
    low = curves.low[k]
    high = curves.high[k]
    if low.point > common:
        high = low
        low = End(-FAR, -FAR, ZERO)
    elif high.point <= common:
        low = high
        high = End(FAR, FAR, hardness)
    if evaluated.point <= common and evaluated.point >= low.point:
        low = evaluated
    if evaluated.point > common and evaluated.point <= high.point:
        high = evaluated
    curves.low[k] = low
    curves.high[k] = high
