"""The device makes parts of a step one after another: decisions before, between and after their passes."""

from enum import IntEnum

import warp as wp

from warpwear.kernels.cells import ONE, PressureMost, PressureSum
from warpwear.kernels.half_space import solve as search
from warpwear.kernels.half_space.passes import Lap
from warpwear.kernels.half_space.solve import TOGETHER, Flag, Request, Solve
from warpwear.kernels.native_code import most_of, total_of
from warpwear.kernels.sliding import Slide

SUMS = wp.constant(wp.int32(len(PressureSum)))
MAXIMA = wp.constant(wp.int32(len(PressureMost)))
REQUESTS = wp.constant(wp.int32(len(Request)))


class PartFlag(IntEnum):
    """Names what a decision says of what follows: places in `StepParts.flags`."""

    GOES_ON = 0
    FROM_LAP = 1
    WEARS = 2
    KEEPS = 3


@wp.struct
class StepParts:
    """Holds the parts of a step that follow each other, and what each has left."""

    slides: wp.array(dtype=Slide)
    requests: wp.array2d(dtype=wp.float64)  # a row a part, by `Request`
    starts: wp.array2d(dtype=wp.int32)  # as of `passes.Lap.first`; 1 where it starts there, where it stays
    ahead: wp.array(dtype=wp.float64)  # of such a part, see `passes.Lap`
    left: wp.array2d(dtype=wp.float64)  # sums and maxima, approach [mm], pairs of transforms
    box: wp.array(dtype=wp.int32)  # of the window: first and last row, first and last column
    numbers: wp.array(dtype=wp.int32)  # of the next part, and of all
    flags: wp.array(dtype=wp.int32)  # by `PartFlag`


@wp.kernel(module=TOGETHER)
def begin_part(parts: StepParts, slides: wp.array(dtype=Slide), solve: Solve, lap: Lap):
    """Begin the next part."""
    if search.lane() == 0:
        n = parts.numbers[0]
        slide = parts.slides[n]
        if n > 0:
            slide.first_column = slides[0].first_column
            slide.end_column = slides[0].end_column
        slides[0] = slide
        for i in range(REQUESTS):
            solve.request[i] = parts.requests[n, i]
        lap.first[0] = parts.starts[n, 0]
        lap.first[1] = parts.starts[n, 1]
        lap.first[2] = parts.starts[n, 2]
        lap.ahead[0] = parts.ahead[n]
        parts.flags[PartFlag.FROM_LAP] = parts.starts[n, 3]
        parts.flags[PartFlag.KEEPS] = parts.starts[n, 4]


@wp.kernel(module=TOGETHER)
def settle(
    parts: StepParts, slides: wp.array(dtype=Slide), solve: Solve, extents: wp.array2d(dtype=wp.float64)
):
    """Let both bodies wear where the contact was found, and reaches nothing beyond the window."""
    first_row = -most_of(extents, 0)
    last_row = most_of(extents, 1)
    first = -most_of(extents, 2)
    last = most_of(extents, 3)
    if search.lane() == 0:
        inside = first_row >= wp.float64(parts.box[0]) and last_row <= wp.float64(parts.box[1])
        inside = inside and first >= wp.float64(parts.box[2]) and last <= wp.float64(parts.box[3])
        wears = wp.where(inside and solve.flags[Flag.HOLDS] == 1, 1, 0)
        slides[0].approach = solve.groups[0].level
        parts.flags[PartFlag.WEARS] = wears
        parts.flags[PartFlag.GOES_ON] = wears


@wp.kernel(module=TOGETHER)
def book_part(
    parts: StepParts,
    slides: wp.array(dtype=Slide),
    solve: Solve,
    sums: wp.array2d(dtype=wp.float64),
    maxima: wp.array2d(dtype=wp.float64),
):
    """Note what a part has left, and go on to the next."""
    n = parts.numbers[0]
    total_of(sums, 1, parts.left, n, 0)
    total_of(maxima, 0, parts.left, n, SUMS)
    if search.lane() == 0:
        numbers = solve.numbers[0]
        parts.left[n, SUMS + MAXIMA] = solve.groups[0].level
        parts.left[n, SUMS + MAXIMA + 1] = wp.float64(numbers.transforms_before + numbers.transforms)
        slides[0].first_column = wp.int32(-parts.left[n, SUMS + wp.static(int(PressureMost.FIRST_COLUMN))])
        slides[0].end_column = wp.int32(parts.left[n, SUMS + wp.static(int(PressureMost.LAST_COLUMN))] + ONE)
        parts.numbers[0] = n + 1
        parts.flags[PartFlag.GOES_ON] = wp.where(n + 1 < parts.numbers[1], 1, 0)
