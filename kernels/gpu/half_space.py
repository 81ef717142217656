"""The search of the half-space solver on a GPU without a word to the host, pass by pass.

The rules are those of `contact.half_space.search` and `balance.newton_in_bracket`, symbols those of
`half_space.search`.
A thread visits single cells; fields are those of the other kernels, seen as numbers. What a pass finds is
reduced block by block into `found`, a line each sum or maximum, and read by a kernel of one block that
decides what follows. On a CPU, where only tests run it, a block is one thread.
"""

from enum import IntEnum

import warp as wp

from warpwear.kernels.cells import ABSENT, NONE, ONE, ZERO
from warpwear.kernels.half_space.search import clipped, free, shifted

wp.set_module_options({"enable_backward": False})

HALF = wp.constant(wp.float64(0.5))
TWO = wp.constant(wp.float64(2.0))
#: How a search ended.
CONVERGED = wp.constant(wp.int32(1))
LED_NOWHERE = wp.constant(wp.int32(2))
UNBALANCED = wp.constant(wp.int32(3))


class Told(IntEnum):
    """What a search tells the host at its end."""

    STATUS = 0
    LEVEL = 1  # approach λ [mm]
    TOTAL = 2  # Σ p [MPa]
    TOUCHING = 3  # cells
    VIOLATION = 4  # of complementarity [mm]
    SCALE = 5  # of it [mm]
    ITERATION = 6
    TRANSFORMS = 7


@wp.struct
class Rules:
    """What a search goes by: constants of `contact.half_space` and `balance`."""

    elastic_fraction: wp.float64
    whole_step: wp.float64
    shortest_useful: wp.float64
    outward: wp.float64
    plain_steps: wp.int32
    patience: wp.int32
    tolerance: wp.float64  # of complementarity
    rounding: wp.float64
    of_load: wp.float64  # tolerance of the load
    rough_balance: wp.float64
    hopeless: wp.float64
    evaluations: wp.int32
    iterations: wp.int32
    scattered: wp.float64
    every: wp.int32
    cap: wp.float64  # H [MPa]
    cells: wp.float64  # of the surface


@wp.struct
class Numbers:
    """What a search knows so far."""

    asked: wp.float64  # Σ p [MPa]
    stiffness: wp.float64  # of a foundation to begin with [N/mm³]
    mean: wp.float64  # of the gap [mm]
    rms: wp.float64
    deepest: wp.float64
    level: wp.float64  # approach λ [mm]
    violation: wp.float64  # of complementarity [mm]
    scale: wp.float64  # of it [mm]
    length_plain: wp.float64  # of a trial step, plain or not
    length_near: wp.float64
    curvature: wp.float64
    memory: wp.float64
    outward: wp.float64
    descent_level: wp.float64
    length: wp.float64  # of the step, as far as it is gone
    unit: wp.float64  # of shifts [MPa]
    shift: wp.float64  # of the trial [MPa]
    offset: wp.float64  # of the trial, in units, its bracket, and the longest step without one
    low: wp.float64
    high: wp.float64
    reach: wp.float64
    width: wp.float64  # of the bracket two evaluations ago
    evaluation: wp.int32
    measured_plain: wp.int32  # whether a length has been
    measured_near: wp.int32
    last: wp.int32  # kind of the last step: 1 plain, 0 not, −1 none
    plain: wp.int32  # of this one
    plain_left: wp.int32
    plain_done: wp.int32  # plain steps so far
    loaded: wp.int32  # whether the pressure carries the load
    failed: wp.int32  # whether the preconditioned descent leads up
    whole: wp.int32  # whether the trial is taken itself
    moved: wp.int32  # whether this was an iteration
    iteration: wp.int32
    transforms: wp.int32
    status: wp.int32  # 0, or how it ended


@wp.struct
class Solve:
    """Fields of a search, shape (rows × columns,) with the padding of a row, and where it writes."""

    ny: wp.int32  # columns without padding
    columns: wp.int32
    pitch: wp.int32  # of a row of `given`
    gap: wp.array(dtype=wp.float64)
    pressure: wp.array(dtype=wp.float64)
    gradient: wp.array(dtype=wp.float64)
    trial: wp.array(dtype=wp.float64)
    step: wp.array(dtype=wp.float64)
    response: wp.array(dtype=wp.float64)
    parts: wp.array(dtype=wp.float64)  # of H, that cells bear; none where all bear it
    given: wp.array(dtype=wp.float64)  # to the transforms of the response, and what they make of it
    made: wp.array(dtype=wp.float64)
    given_near: wp.array(dtype=wp.float32)  # of the preconditioner
    made_near: wp.array(dtype=wp.float32)
    bound: wp.array(dtype=wp.uint8)  # 1 where a cell is not free, shape (rows × ny,)
    weights: wp.array(dtype=wp.float32)  # of neighbours along x, along y and across corners
    wraps: wp.bool  # whether the surface repeats beyond its edges
    found: wp.array2d(dtype=wp.float64)  # a line a sum or maximum, a column a block
    rules: Rules
    asked: wp.array(dtype=wp.float64)  # Σ p [MPa], and stiffness of a foundation to begin with [N/mm³]
    told: wp.array(dtype=wp.float64)  # by the places of `Told`
    numbers: wp.array(dtype=Numbers)  # one
    searching: wp.array(dtype=wp.int32)  # one number each, 1 while it goes on
    balancing: wp.array(dtype=wp.int32)
    near: wp.array(dtype=wp.int32)  # 1 where the step is preconditioned
    extends: wp.array(dtype=wp.int32)  # 1 where that extends values


@wp.func
def cap_of(solve: Solve, i: wp.int32):
    """H of a cell."""
    cap = solve.rules.cap
    if solve.parts.shape[0] > 0:
        cap = cap * solve.parts[i]
    return cap


@wp.func
def threads_of(solve: Solve):
    """All threads of a pass."""
    return solve.found.shape[1] * wp.block_dim()


@wp.func
def add(solve: Solve, thread: wp.int32, line: wp.int32, value: wp.float64):
    """Keep the sum of a value over the block of a thread."""
    block = thread // wp.block_dim()
    wp.tile_store(solve.found[line], wp.tile_sum(wp.tile(value)), offset=block)


@wp.func
def most(solve: Solve, thread: wp.int32, line: wp.int32, value: wp.float64):
    """Keep the maximum of a value over the block of a thread."""
    block = thread // wp.block_dim()
    wp.tile_store(solve.found[line], wp.tile_max(wp.tile(value)), offset=block)


@wp.func
def sum_found(solve: Solve, thread: wp.int32, line: wp.int32):
    """The sum over all blocks; called by the threads of one."""
    total = ZERO
    for i in range(thread, solve.found.shape[1], wp.block_dim()):
        total += solve.found[line, i]
    return wp.tile_extract(wp.tile_sum(wp.tile(total)), 0)


@wp.func
def most_found(solve: Solve, thread: wp.int32, line: wp.int32):
    """The maximum over all blocks; called by the threads of one."""
    largest = -NONE
    for i in range(thread, solve.found.shape[1], wp.block_dim()):
        largest = wp.max(largest, solve.found[line, i])
    return wp.tile_extract(wp.tile_max(wp.tile(largest)), 0)


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


@wp.kernel
def residual(solve: Solve):
    """t − λ on the free cells, 0 elsewhere, for the preconditioner."""
    thread = wp.tid()
    level = solve.numbers[0].level
    for i in range(thread, solve.pressure.shape[0], threads_of(solve)):
        column = i % solve.columns
        if column < solve.ny:
            r = solve.gradient[i] - level
            is_free = free(solve.pressure[i], solve.gradient[i], level, cap_of(solve, i))
            place = i // solve.columns * solve.ny + column
            solve.given_near[place] = wp.float32(wp.where(is_free > ZERO, r, ZERO))
            solve.bound[place] = wp.uint8(wp.where(is_free > ZERO, 0, 1))


@wp.kernel
def scatter(solve: Solve):
    """In some rows, sums of cells between the bounds and of the ends of their lines."""
    thread = wp.tid()
    cells = ZERO
    ends = ZERO
    rows = solve.pressure.shape[0] // solve.columns
    looked_at = (rows + solve.rules.every - 1) // solve.rules.every * solve.columns
    for k in range(thread, looked_at, threads_of(solve)):
        column = k % solve.columns
        i = k + k // solve.columns * (solve.rules.every - 1) * solve.columns
        if column < solve.ny:
            between = solve.pressure[i] > ZERO and solve.pressure[i] < cap_of(solve, i)
            cells += wp.where(between, ONE, ZERO)
            if column + 1 < solve.ny:
                beside = solve.pressure[i + 1] > ZERO and solve.pressure[i + 1] < cap_of(solve, i + 1)
                ends += wp.where(between == beside, ZERO, ONE)
    add(solve, thread, 0, cells)
    add(solve, thread, 1, ends)


@wp.kernel
def judge_scatter(solve: Solve):
    """Whether extending values pays, as `contact.half_space.passes` says. One block."""
    thread = wp.tid()
    cells = sum_found(solve, thread, 0)
    ends = sum_found(solve, thread, 1)
    if thread == 0:
        solve.extends[0] = wp.where(ends > solve.rules.scattered * cells, 1, 0)


@wp.func
def counted(solve: Solve, values: wp.array(dtype=wp.float32), place: wp.int32, bound: wp.bool):
    """A value; nothing of a free cell if those that are not are asked for."""
    value = values[place]
    if bound and solve.bound[place] == wp.uint8(0):
        value = wp.float32(0.0)
    return value


@wp.func
def around(solve: Solve, values: wp.array(dtype=wp.float32), place: wp.int32, bound: wp.bool):
    """Weighted sum of the neighbours of a cell. bound: of those alone that are not free."""
    row = place // solve.ny
    column = place % solve.ny
    rows = solve.bound.shape[0] // solve.ny
    # Beyond the edges is the other side, which counts if the surface repeats.
    up = wp.where(row > 0, place - solve.ny, place + (rows - 1) * solve.ny)
    down = wp.where(row < rows - 1, place + solve.ny, column)
    left = wp.where(column > 0, -1, solve.ny - 1)
    right = wp.where(column < solve.ny - 1, 1, 1 - solve.ny)
    is_up = wp.float32(wp.where(solve.wraps or row > 0, 1, 0))
    is_down = wp.float32(wp.where(solve.wraps or row < rows - 1, 1, 0))
    is_left = wp.float32(wp.where(solve.wraps or column > 0, 1, 0))
    is_right = wp.float32(wp.where(solve.wraps or column < solve.ny - 1, 1, 0))
    beside = is_left * counted(solve, values, place + left, bound)
    beside += is_right * counted(solve, values, place + right, bound)
    along = is_up * counted(solve, values, up, bound) + is_down * counted(solve, values, down, bound)
    corner = is_up * is_left * counted(solve, values, up + left, bound)
    corner += is_up * is_right * counted(solve, values, up + right, bound)
    corner += is_down * is_left * counted(solve, values, down + left, bound)
    corner += is_down * is_right * counted(solve, values, down + right, bound)
    return solve.weights[0] * along + solve.weights[1] * beside + solve.weights[2] * corner


@wp.kernel
def extend(solve: Solve, values_in: wp.array(dtype=wp.float32), values_out: wp.array(dtype=wp.float32)):
    """Values of free cells as they are, of others the weighted sum of their neighbours; see `extension`."""
    for place in range(wp.tid(), solve.bound.shape[0], threads_of(solve)):
        value = values_in[place]
        if solve.bound[place] == wp.uint8(1):
            value = around(solve, values_in, place, False)
        values_out[place] = value


@wp.kernel
def gather(solve: Solve):
    """What the cells that are not free give back, in the place of what was transformed; see `extension`."""
    for place in range(wp.tid(), solve.bound.shape[0], threads_of(solve)):
        value = wp.float32(0.0)
        if solve.bound[place] == wp.uint8(1):
            value = solve.made_near[place] + around(solve, solve.made_near, place, True)
        solve.given_near[place] = value


@wp.kernel
def give(solve: Solve):
    """Add what `gather` found to the descent of the free cells beside."""
    for place in range(wp.tid(), solve.bound.shape[0], threads_of(solve)):
        if solve.bound[place] == wp.uint8(0):
            solve.made_near[place] = solve.made_near[place] + around(solve, solve.given_near, place, False)


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


@wp.kernel
def pass_waves(
    elastic_in: wp.array2d(dtype=wp.float64),
    line_in: wp.array(dtype=wp.float64),
    scale: wp.float64,
    waves: wp.array2d(dtype=wp.vec2d),
):
    """Modes × (elastic + line of the row) × scale, in place. A thread a mode."""
    i, j = wp.tid()
    waves[i, j] = ((elastic_in[i, j] + line_in[i]) * scale) * waves[i, j]


@wp.kernel
def divide_waves(
    elastic_in: wp.array2d(dtype=wp.float64),
    line_in: wp.array(dtype=wp.float64),
    scale: wp.float64,
    waves: wp.array2d(dtype=wp.vec2f),
):
    """Modes ÷ (elastic + line of the row) × scale, in place; 0 where that is 0. A thread a mode."""
    i, j = wp.tid()
    response = elastic_in[i, j] + line_in[i]
    factor = wp.where(response > ZERO, scale / wp.where(response > ZERO, response, ONE), ZERO)
    waves[i, j] = wp.float32(factor) * waves[i, j]
