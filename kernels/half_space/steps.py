"""A search of the half-space solver makes its next trial, and goes some way along the step to it.

These are rules of `contact.half_space.search`; `decisions` has the others. Symbols as in
`native/half_space/search.h`. The last undecided cells are solved by their active set, whose arithmetic is in
`active_set.h` beside it.
"""

import warp as wp

from warpwear.kernels.cells import ONE, ZERO
from warpwear.kernels.half_space import solve as search
from warpwear.kernels.half_space.solve import TOGETHER, ActiveSet, Flag, Solve, native_pass
from warpwear.kernels.newton import HALF

TWO = wp.constant(wp.float64(2.0))


@wp.kernel(module=TOGETHER)
def judge_scatter(solve: Solve):
    """Decide whether extending the gradient pays: cells between the bounds lie in small spots then."""
    lines = search.all_lines(solve, 2, 2)
    if search.lane() == 0:
        extends = wp.where(lines[1] > solve.rules[0].scattered * lines[0], 1, 0)
        solve.numbers[0].extended = extends * solve.rules[0].tiled
        solve.flags[Flag.EXTENDS] = extends
        solve.flags[Flag.EXTENDS_NOT] = 1 - extends


@wp.kernel(module=TOGETHER)
def aim(solve: Solve):
    """Decide how the next trial is made of descent and last step, and whether that leads down at all."""
    n = solve.numbers[0]
    zy = ZERO
    zr = ZERO
    sr = ZERO
    largest_z = ZERO
    largest_r = ZERO
    for i in range(search.first_group(solve), search.groups_of(solve), search.stride(solve)):
        lines = search.lines_of(solve, i, 7, 9)
        mean = wp.where(n.at_load == 1, lines[1] / wp.max(lines[0], ONE), ZERO)
        zy += lines[4] - mean * lines[3]
        zr += lines[5] - mean * lines[2]
        sr += lines[6]
        largest_z = wp.max(largest_z, lines[7])
        largest_r = wp.max(largest_r, lines[8])
        if search.writes(solve):
            solve.groups[i].descent_mean = mean
    zy = search.over_groups(solve, zy, True)
    downhill = search.over_groups(solve, zr, True)
    sr = search.over_groups(solve, sr, True)
    largest_z = search.over_groups(solve, largest_z, False)
    largest_r = search.over_groups(solve, largest_r, False)
    n.memory = ZERO
    if n.last == n.plain:
        n.memory = wp.max(ZERO, zy / n.curvature)
    if n.memory * sr >= downhill:
        n.memory = ZERO
    n.outward = ONE
    n.trial_length = n.plain_length
    if n.plain == 0:
        n.outward = wp.where(largest_r > ZERO, solve.rules[0].outward * largest_z / largest_r, ZERO)
        n.trial_length = n.near_length
        n.transforms = n.transforms + 1
    leads_down = n.plain == 1 or downhill > ZERO
    for i in range(search.first_group(solve), search.groups_of(solve), search.stride(solve)):
        lines = search.lines_of(solve, i, 7, 9)
        reach = wp.max(lines[7], lines[8] * n.outward)
        if search.writes(solve):
            solve.groups[i].unit = n.trial_length * reach
    if search.lane() == 0:
        if not leads_down:
            n = without_memory(solve.rules[0], n)
        solve.flags[Flag.DESCENDS] = wp.where(leads_down, 1, 0)
        solve.numbers[0] = n


@wp.func
def without_memory(rules: search.Rules, n: search.SearchNumbers):
    """Stay where the pressure is, and follow the plain gradient next, without memory."""
    n.last = -1
    n.plain_left = rules.plain_steps
    n.whole = 0
    n.length = ZERO
    return n


@wp.func
def gone(rules: search.Rules, n: search.SearchNumbers, best: wp.float64, used: wp.float64):
    """Go along a step as far as is best, which is where the minimum along it lies.

    best: in steps. used: largest fraction of its room to a bound that a cell uses in a whole step.
    """
    far = best > ONE and best * used > ONE
    n.moved = 1
    n.whole = wp.where(n.loaded == 0 or (best > rules.whole_step and best <= ONE) or far, 1, 0)
    n.length = wp.where(n.whole == 1, ONE, best)
    if n.loaded == 1:
        if n.plain == 0 and best <= rules.shortest_useful_step:
            n.plain_left = rules.plain_steps
        factor = wp.min(best, TWO)
        # The best length of a step that the bounds cut short may say nothing.
        if n.plain == 1:
            factor = wp.where(n.measured_plain == 1, wp.max(factor, HALF), factor)
            n.plain_length = n.plain_length * factor
            n.measured_plain = 1
        else:
            factor = wp.where(n.measured_near == 1, wp.max(factor, HALF), factor)
            n.near_length = n.near_length * factor
            n.measured_near = 1
        n.last = n.plain
    return n


@wp.func
def drifted(n: search.SearchNumbers):
    """Note how far off the gradient may be once the step is gone."""
    n.drift = n.drift + n.length * n.step_drift
    return n


@wp.kernel(module=TOGETHER)
def go(solve: Solve):
    """Decide how far to go along the step."""
    lines = search.all_lines(solve, 2, 4)
    if search.lane() == 0:
        n = solve.numbers[0]
        slope = lines[0]
        curvature = lines[1]
        used = lines[2]
        largest = lines[3]
        n.transforms = n.transforms + 1
        n.step_drift = solve.rules[0].single_rounding * largest
        best = wp.where(curvature > ZERO, -slope / wp.where(curvature > ZERO, curvature, ONE), ZERO)
        remembers = n.last == n.plain
        if best > ZERO or n.loaded == 0:
            n.curvature = curvature
            n = gone(solve.rules[0], n, best, used)
        elif n.plain == 1 and not remembers:
            # The step leads up, which without memory and preconditioner it cannot, but for rounding: a
            # pressure off its bound by the last digit of the load hides where the others want to go.
            if used < ONE:
                n.status = search.LED_NOWHERE
                n = without_memory(solve.rules[0], n)
                solve.flags[Flag.SEARCHING] = 0
            else:
                n = gone(solve.rules[0], n, ONE, used)
        else:
            n = without_memory(solve.rules[0], n)
        solve.numbers[0] = drifted(n)


#: Count the cells whose place between the bounds is open.
count_open = native_pass("open_cells<false>", solve=Solve, few=ActiveSet)
#: List them; the trial becomes the pressure.
list_open = native_pass("open_cells<true>", solve=Solve, few=ActiveSet)


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
        solve.groups[0].shift = ZERO


@wp.kernel(module=TOGETHER)
def go_few(solve: Solve):
    """Take the step of the few whole if it leads down; else a common step follows."""
    lines = search.all_lines(solve, 2, 4)
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
