"""The last undecided cells of a half-space contact are solved by their active set.

`native/half_space/active_set.h` has its arithmetic.
"""

import warp as wp

from warpwear.kernels.cells import ONE, ZERO
from warpwear.kernels.half_space.solve import TOGETHER, ActiveSet, Flag, Solve, all_lines
from warpwear.kernels.half_space.steps import drifted
from warpwear.kernels.native_code import native_pass
from warpwear.kernels.newton import HALF


@native_pass("open_cells<false>", module=TOGETHER)
def count_open(solve: Solve, few: ActiveSet):
    """Count the cells whose place between the bounds is open."""


@native_pass("open_cells<true>", module=TOGETHER)
def list_open(solve: Solve, few: ActiveSet):
    """List them; the trial becomes the pressure."""


@wp.kernel(module=TOGETHER)
def place_open(solve: Solve, few: ActiveSet):
    """Give the open cells of every slot their places in the list; tell whether there are few enough."""
    if wp.tid() == 0:
        place = ZERO
        for slot in range(wp.min(solve.visited[0], solve.table.shape[1])):
            cells = solve.table[0, slot]
            solve.table[1, slot] = place
            place += cells
        few.count[0] = wp.int32(place)
        is_few = place > ZERO and place <= wp.float64(solve.rules[0].few)
        solve.flags[Flag.AIMED_AT_FEW] = wp.where(is_few, 1, 0)


@wp.func_native("return move_few(solve, few, count);")
def move_few(solve: Solve, few: ActiveSet, count: wp.int32) -> wp.bool:
    """Move the few open cells in the trial; tell whether there is a way."""


@wp.kernel(module=TOGETHER)
def aim_few(solve: Solve, few: ActiveSet):
    """Make the trial pressure the best one for the few cells that are open."""
    if wp.tid() == 0:
        solve.flags[Flag.AIMED_AT_FEW] = wp.where(move_few(solve, few, few.count[0]), 1, 0)
        group = solve.groups[0]
        group.shift = ZERO
        solve.groups[0] = group


@wp.kernel(module=TOGETHER)
def go_few(solve: Solve):
    """Take the step of the few whole if it leads down; else a common step follows."""
    lines = all_lines(solve, 2, 4)
    if wp.tid() == 0:
        n = solve.numbers[0]
        slope = lines[0]
        curvature = lines[1]
        largest = lines[3]
        n.transforms = n.transforms + 1
        if curvature > ZERO and -slope > HALF * curvature:
            n.step_drift = solve.rules[0].single_rounding * largest
            n.last = -1
            n.moved = 1
            n.whole = 1
            n.length = ONE
            n = drifted(n)
            solve.flags[Flag.STEPS] = 0
        solve.numbers[0] = n
