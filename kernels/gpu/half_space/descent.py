"""Passes of a search on a GPU that judge a pressure and step towards the solution.

The rules are those of `contact.half_space.search`, symbols those of `half_space.search`.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, NONE, ONE, ZERO
from warpwear.kernels.gpu.half_space.solve import (
    CONVERGED,
    HALF,
    LED_NOWHERE,
    TWO,
    Numbers,
    Rules,
    Solve,
    Told,
    add,
    cap_of,
    most,
    most_found,
    sum_found,
    threads_of,
)
from warpwear.kernels.half_space.search import clipped, free, shifted

wp.set_module_options({"enable_backward": False})


@wp.kernel
def present(solve: Solve):
    """Give the pressure to the transforms, down to caps of cells that have fallen since it was solved."""
    thread = wp.tid()
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        column = i % solve.columns
        if solve.parts.shape[0] > 0:
            solve.pressure[i] = wp.min(solve.pressure[i], cap_of(solve, i))
        if column < solve.ny:
            solve.given[i // solve.columns * solve.pitch + column] = solve.pressure[i]


@wp.kernel
def begin(solve: Solve):
    """t = Gp + g; without end in the padding. The step is none, and the numbers of a step are reset."""
    thread = wp.tid()
    for i in range(thread, solve.gap.shape[0], threads_of(solve)):
        column = i % solve.columns
        t = NONE
        if column < solve.ny:
            t = solve.gap[i] + solve.made[i // solve.columns * solve.pitch + column]
        solve.gradient[i] = t
        solve.step[i] = ZERO
        solve.response[i] = ZERO
    if thread == 0:
        n = solve.numbers[0]
        n.length_plain = n.stiffness
        n.length_near = ONE
        n.length = ZERO
        n.last = -1
        n.transforms = 1
        solve.numbers[0] = n


@wp.kernel
def advance(solve: Solve):
    """p += length × step, t += length × response. A whole step takes the trial itself, exact at the bounds.

    Sums: p, cells in contact, cells between the bounds and their t. Maxima: t where p > 0, −t where p < H.
    """
    thread = wp.tid()
    n = solve.numbers[0]
    total = ZERO
    touching = ZERO
    between = ZERO
    level = ZERO
    highest = -NONE
    lowest = -NONE
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        cap = cap_of(solve, i)
        p = solve.pressure[i]
        t = solve.gradient[i] + n.length * solve.response[i]
        if n.whole == 1:
            p = shifted(solve.trial[i], n.shift, cap)
        else:
            p = clipped(p + n.length * solve.step[i], cap)
        solve.pressure[i] = p
        solve.gradient[i] = t
        total += p
        if p > ZERO:
            touching += ONE
            highest = wp.max(highest, t)
            if p < cap:
                between += ONE
                level += t
        if p < cap:
            lowest = wp.max(lowest, -t)
    add(solve, thread, 0, total)
    add(solve, thread, 1, touching)
    add(solve, thread, 2, between)
    add(solve, thread, 3, level)
    most(solve, thread, 4, highest)
    most(solve, thread, 5, lowest)


@wp.kernel
def judge(solve: Solve):
    """Whether the pressure is the solution, and if not of what kind the next step is. One block."""
    thread = wp.tid()
    total = sum_found(solve, thread, 0)
    touching = sum_found(solve, thread, 1)
    between = sum_found(solve, thread, 2)
    level = sum_found(solve, thread, 3)
    highest = most_found(solve, thread, 4)
    lowest = -most_found(solve, thread, 5)
    if thread == 0:
        rules = solve.rules
        n = solve.numbers[0]
        n.iteration = n.iteration + n.moved
        off = total / n.asked - ONE
        n.loaded = wp.where(wp.abs(off) <= rules.of_load, 1, 0)
        n.level = level / wp.max(between, ONE)
        if between == ZERO:  # the gap of the cell which is next to take load, or to give it
            high = wp.where(highest > -NONE, highest, lowest)
            low = wp.where(lowest < ABSENT, lowest, highest)
            n.level = wp.where(total < n.asked, low, high)
            if n.loaded == 1:
                n.level = HALF * (high + low)
        n.violation = wp.max(wp.max(highest - n.level, n.level - lowest), ZERO)
        yielded = wp.abs(n.level) + total / rules.cells / n.stiffness
        n.scale = wp.where(n.rms > ZERO, n.rms, yielded)
        allowed = wp.max(rules.tolerance * n.scale, rules.rounding * yielded)
        if n.status == 0:
            if n.loaded == 1 and n.violation <= allowed:
                n.status = CONVERGED
            elif n.iteration >= rules.iterations:
                n.status = LED_NOWHERE
        patient = n.plain_done < rules.patience or between == ZERO
        capped = between <= rules.elastic_fraction * touching
        n.plain = wp.where(n.plain_left > 0 or (capped and patient), 1, 0)
        n.plain_left = wp.max(n.plain_left - 1, 0)
        n.plain_done = n.plain_done + n.plain
        solve.near[0] = 1 - n.plain
        solve.searching[0] = wp.where(n.status == 0, 1, 0)
        solve.numbers[0] = n
        solve.told[wp.static(int(Told.STATUS))] = wp.float64(n.status)
        solve.told[wp.static(int(Told.LEVEL))] = n.level
        solve.told[wp.static(int(Told.TOTAL))] = total
        solve.told[wp.static(int(Told.TOUCHING))] = touching
        solve.told[wp.static(int(Told.VIOLATION))] = n.violation
        solve.told[wp.static(int(Told.SCALE))] = n.scale
        solve.told[wp.static(int(Told.ITERATION))] = wp.float64(n.iteration)
        solve.told[wp.static(int(Told.TRANSFORMS))] = wp.float64(n.transforms)


@wp.func
def descent_of(solve: Solve, n: Numbers, i: wp.int32):
    """z of a cell before its mean is taken off: of the preconditioner, or the gradient."""
    z = ZERO
    column = i % solve.columns
    if n.plain == 1:
        z = solve.gradient[i] - n.level
    elif column < solve.ny:
        z = wp.float64(solve.made_near[i // solve.columns * solve.ny + column])
    return z


@wp.kernel
def products(solve: Solve):
    """Over the free cells, with z descent, r = t − λ, s, y the last step and its response.

    Sums: cells, z, r, y, z y, z r, s r. Maxima: |z|, |r|.
    """
    thread = wp.tid()
    n = solve.numbers[0]
    count = ZERO
    z_sum = ZERO
    r_sum = ZERO
    y_sum = ZERO
    zy = ZERO
    zr = ZERO
    sr = ZERO
    largest_z = ZERO
    largest_r = ZERO
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        t = solve.gradient[i]
        if free(solve.pressure[i], t, n.level, cap_of(solve, i)) > ZERO:
            z = descent_of(solve, n, i)
            r = t - n.level
            y = solve.response[i]
            count += ONE
            z_sum += z
            r_sum += r
            y_sum += y
            zy += z * y
            zr += z * r
            sr += solve.step[i] * r
            largest_z = wp.max(largest_z, wp.abs(z))
            largest_r = wp.max(largest_r, wp.abs(r))
    add(solve, thread, 0, count)
    add(solve, thread, 1, z_sum)
    add(solve, thread, 2, r_sum)
    add(solve, thread, 3, y_sum)
    add(solve, thread, 4, zy)
    add(solve, thread, 5, zr)
    add(solve, thread, 6, sr)
    most(solve, thread, 7, largest_z)
    most(solve, thread, 8, largest_r)


@wp.kernel
def aim(solve: Solve):
    """How the next trial is made of descent and last step. One block."""
    thread = wp.tid()
    count = sum_found(solve, thread, 0)
    z = sum_found(solve, thread, 1)
    r = sum_found(solve, thread, 2)
    y = sum_found(solve, thread, 3)
    zy = sum_found(solve, thread, 4)
    zr = sum_found(solve, thread, 5)
    sr = sum_found(solve, thread, 6)
    largest_z = most_found(solve, thread, 7)
    largest_r = most_found(solve, thread, 8)
    if thread == 0:
        n = solve.numbers[0]
        mean = z / wp.max(count, ONE)
        n.memory = ZERO
        if n.last == n.plain:
            n.memory = wp.max(ZERO, (zy - mean * y) / n.curvature)
        downhill = zr - mean * r
        if n.memory * sr >= downhill:
            n.memory = ZERO
        n.failed = wp.where(n.plain == 0 and not (downhill > ZERO), 1, 0)
        n.outward = ONE
        n.length = n.length_plain
        if n.plain == 0:
            n.outward = wp.where(largest_r > ZERO, solve.rules.outward * largest_z / largest_r, ZERO)
            n.length = n.length_near
        n.descent_level = mean
        n.unit = n.length * wp.max(largest_z, largest_r * n.outward)
        n.evaluation = 0
        n.transforms = n.transforms + 2 - n.plain
        solve.numbers[0] = n


@wp.kernel
def direction(solve: Solve):
    """Trial pressure along −z + memory × last step on the free cells, outward elsewhere. Sums: `weigh`'s."""
    thread = wp.tid()
    n = solve.numbers[0]
    total = ZERO
    between = ZERO
    if n.failed == 0:
        for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
            cap = cap_of(solve, i)
            p = solve.pressure[i]
            t = solve.gradient[i]
            d = -n.outward * (t - n.level)
            if free(p, t, n.level, cap) > ZERO:
                d = n.memory * solve.step[i] - (descent_of(solve, n, i) - n.descent_level)
            x = p + n.length * d
            solve.trial[i] = x
            total += clipped(x, cap)
            between += wp.where(x > ZERO and x < cap, ONE, ZERO)
    add(solve, thread, 0, total)
    add(solve, thread, 1, between)


@wp.kernel
def step(solve: Solve):
    """Feasible step to the trial, given to the transforms. Sum: step × (t − λ). Maximum: fraction of room."""
    thread = wp.tid()
    n = solve.numbers[0]
    slope = ZERO
    used = ZERO
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        cap = cap_of(solve, i)
        p = solve.pressure[i]
        s = shifted(solve.trial[i], n.shift, cap) - p
        if s != ZERO:
            slope += s * (solve.gradient[i] - n.level)
            used = wp.max(used, wp.abs(s) / wp.where(s < ZERO, p, cap - p))
        solve.step[i] = s
        column = i % solve.columns
        if column < solve.ny:
            solve.given[i // solve.columns * solve.pitch + column] = s
    add(solve, thread, 0, slope)
    most(solve, thread, 1, used)


@wp.kernel
def respond(solve: Solve):
    """Response to the step, as the transforms made it. Sum: step × response."""
    thread = wp.tid()
    product = ZERO
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        column = i % solve.columns
        if column < solve.ny:
            y = solve.made[i // solve.columns * solve.pitch + column]
            solve.response[i] = y
            product += solve.step[i] * y
    add(solve, thread, 2, product)


@wp.func
def gone(rules: Rules, before: Numbers, best: wp.float64, used: wp.float64):
    """The numbers that take a step as far as is best, which is where the minimum along it lies."""
    n = before
    far = best > ONE and best * used > ONE
    n.moved = 1
    n.whole = wp.where(n.loaded == 0 or (best > rules.whole_step and best <= ONE) or far, 1, 0)
    n.length = wp.where(n.whole == 1, ONE, best)
    if n.loaded == 1:
        if n.plain == 0 and best <= rules.shortest_useful:
            n.plain_left = rules.plain_steps
        factor = wp.min(best, TWO)
        if n.plain == 1:
            # The best length of a step that the bounds cut short may say nothing.
            factor = wp.where(n.measured_plain == 1, wp.max(factor, HALF), factor)
            n.length_plain = n.length_plain * factor
            n.measured_plain = 1
        else:
            factor = wp.where(n.measured_near == 1, wp.max(factor, HALF), factor)
            n.length_near = n.length_near * factor
            n.measured_near = 1
        n.last = n.plain
    return n


@wp.kernel
def go(solve: Solve):
    """How far to go along the step. One block."""
    thread = wp.tid()
    slope = sum_found(solve, thread, 0)
    used = most_found(solve, thread, 1)
    curvature = sum_found(solve, thread, 2)
    if thread == 0:
        n = solve.numbers[0]
        best = wp.where(curvature > ZERO, -slope / wp.where(curvature > ZERO, curvature, ONE), ZERO)
        remembers = n.last == n.plain
        n.whole = 0
        n.moved = 0
        n.length = ZERO
        if n.status == 0:
            if n.failed == 0 and (best > ZERO or n.loaded == 0):
                n.curvature = curvature
                n = gone(solve.rules, n, best, used)
            elif n.plain == 1 and not remembers:
                # It leads up, which without memory and preconditioner it cannot, but for rounding; see
                # `contact.half_space.search`.
                if used < ONE:
                    n.status = LED_NOWHERE
                else:
                    n = gone(solve.rules, n, ONE, used)
            else:
                n.last = -1
                n.plain_left = solve.rules.plain_steps
        solve.numbers[0] = n
