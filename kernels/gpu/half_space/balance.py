"""Passes of a search on a GPU that lead to a pressure which carries the load.

They measure the gap, begin with a foundation, and shift a trial until it carries the load, by the rules of
`contact.balance.newton_in_bracket`.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, NONE, ONE, ZERO
from warpwear.kernels.gpu.half_space.solve import (
    HALF,
    UNBALANCED,
    Numbers,
    Rules,
    Solve,
    add,
    cap_of,
    most,
    most_found,
    sum_found,
    threads_of,
)
from warpwear.kernels.half_space.search import clipped, shifted

wp.set_module_options({"enable_backward": False})


@wp.kernel
def start(solve: Solve):
    """The numbers of a search that begins. One thread."""
    n = Numbers()
    n.asked = solve.asked[0]
    n.stiffness = solve.asked[1]
    solve.numbers[0] = n


@wp.kernel
def moments(solve: Solve):
    """Where there is a surface, sums of cells, g − mean and its square. Maximum: −g."""
    thread = wp.tid()
    mean = solve.numbers[0].mean
    count = ZERO
    first = ZERO
    second = ZERO
    lowest = -NONE
    for i in range(thread, solve.gap.shape[0], threads_of(solve)):
        g = solve.gap[i]
        if i % solve.columns < solve.ny and g < ABSENT:
            count += ONE
            first += g - mean
            second += (g - mean) * (g - mean)
            lowest = wp.max(lowest, -g)
    add(solve, thread, 0, count)
    add(solve, thread, 1, first)
    add(solve, thread, 2, second)
    most(solve, thread, 3, lowest)


@wp.kernel
def reckon_moments(solve: Solve):
    """Mean, rms height and lowest point of the gap: about 0, then about the mean. One block."""
    thread = wp.tid()
    count = sum_found(solve, thread, 0)
    first = sum_found(solve, thread, 1) / count
    second = sum_found(solve, thread, 2) / count
    lowest = most_found(solve, thread, 3)
    if thread == 0:
        n = solve.numbers[0]
        n.mean = n.mean + first
        n.rms = wp.sqrt(wp.max(second - first * first, ZERO))
        n.deepest = -lowest
        n.unit = n.stiffness * (n.mean - n.deepest)
        solve.numbers[0] = n


@wp.kernel
def spring(solve: Solve):
    """Trial pressure of a foundation at the gap's mean; far below zero in the padding. Sums: `weigh`'s."""
    thread = wp.tid()
    n = solve.numbers[0]
    total = ZERO
    between = ZERO
    for i in range(thread, solve.gap.shape[0], threads_of(solve)):
        x = -NONE
        if i % solve.columns < solve.ny:
            x = (n.mean - solve.gap[i]) * n.stiffness
        solve.trial[i] = x
        cap = cap_of(solve, i)
        q = clipped(x, cap)
        total += q
        between += wp.where(q > ZERO and q < cap, ONE, ZERO)
    add(solve, thread, 0, total)
    add(solve, thread, 1, between)


@wp.kernel
def carried(solve: Solve):
    """Sums of the trial pressures, shifted and clipped, and of the cells between the bounds."""
    thread = wp.tid()
    shift = solve.numbers[0].shift
    total = ZERO
    between = ZERO
    for i in range(thread, solve.trial.shape[0], threads_of(solve)):
        cap = cap_of(solve, i)
        q = shifted(solve.trial[i], shift, cap)
        total += q
        between += wp.where(q > ZERO and q < cap, ONE, ZERO)
    add(solve, thread, 0, total)
    add(solve, thread, 1, between)


@wp.func
def weighed(rules: Rules, before: Numbers, total: wp.float64, between: wp.float64):
    """The numbers with the next shift by what the last one carries; `evaluation` is negative at the end."""
    n = before
    if n.evaluation == 0:
        n.unit = wp.max(n.unit, wp.where(between > ZERO, total / wp.max(between, ONE), ZERO))
        n.unit = wp.max(n.unit, n.asked / rules.cells)
        n.offset = ZERO
        n.low = -NONE
        n.high = NONE
        n.reach = ONE
        n.width = NONE
    n.evaluation = n.evaluation + 1
    residual = total - n.asked
    ends = wp.abs(residual) <= rules.of_load * n.asked or n.evaluation >= rules.evaluations
    ends = ends or not (wp.abs(n.offset) < rules.hopeless)
    offset = n.offset
    if not ends:
        if residual < ZERO:
            n.low = offset
        else:
            n.high = offset
        slope = between * n.unit
        newton = offset - residual / wp.where(slope > ZERO, slope, ONE)
        if n.low <= -NONE or n.high >= NONE:
            n.offset = offset + wp.where(residual < ZERO, n.reach, -n.reach)
            if slope > ZERO and wp.abs(newton - offset) <= n.reach:
                n.offset = newton
            n.reach = wp.float64(4.0) * n.reach
        else:
            even = n.evaluation % 2 == 0
            stalled = even and n.high - n.low > HALF * n.width
            if even:
                n.width = n.high - n.low
            n.offset = HALF * (n.low + n.high)
            if slope > ZERO and newton > n.low and newton < n.high and not stalled:
                n.offset = newton
            if n.offset <= n.low or n.offset >= n.high:
                n.offset = offset
                ends = True
    if ends:
        n.evaluation = -1
        if not (wp.abs(residual) <= rules.rough_balance * n.asked):
            n.status = UNBALANCED
    n.shift = n.offset * n.unit
    return n


@wp.kernel
def weigh(solve: Solve):
    """The next shift of the trial, or the end of the search for it. One block."""
    thread = wp.tid()
    total = sum_found(solve, thread, 0)
    between = sum_found(solve, thread, 1)
    if thread == 0:
        n = solve.numbers[0]
        if n.failed == 1:
            n.evaluation = -1
            n.shift = ZERO
        else:
            n = weighed(solve.rules, n, total, between)
        solve.balancing[0] = wp.where(n.evaluation < 0, 0, 1)
        solve.numbers[0] = n


@wp.kernel
def take(solve: Solve):
    """The trial, shifted and clipped, becomes the pressure."""
    thread = wp.tid()
    shift = solve.numbers[0].shift
    for i in range(thread, solve.trial.shape[0], threads_of(solve)):
        solve.pressure[i] = shifted(solve.trial[i], shift, cap_of(solve, i))
