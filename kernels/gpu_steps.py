"""Whole steps on a GPU without a word to the host: the search for the balance, and a row of the history.

What a pass over the cells finds is reduced block by block, into one column a block of the table `found`. The
passes themselves are a pair of kernels each: those of a gap at rest in `gpu_steps_rest`, those of a displaced
disc in `gpu_steps_sliding`. The rule of the search is that of `balance.newton_in_bracket`.
"""

import warp as wp

from warpwear.kernels.cells import NO_INDEX, ONE, ZERO, WearSum

wp.set_module_options({"enable_backward": False})

#: Searches, each from a base nearer the solution; evaluations of each; first step of one that starts there.
ROUNDS = wp.constant(wp.int32(3))
EVALUATIONS = wp.constant(wp.int32(400))
FIRST_REACH = wp.constant(wp.float64(1.0e-18))
INFINITE = wp.constant(wp.float64(1.0e300))
#: Columns of a row of the history before the sums and maxima: base, offset, residual, evaluations.
HEADER = wp.constant(wp.int32(4))
#: A displaced step may be off by this many times the largest change of late.
TIMES = wp.constant(wp.float64(2.0))
#: What of that change a step leaves.
FADES = wp.constant(wp.float64(0.9))
#: And by this much at least [mm].
LEAST = wp.constant(wp.float64(1.0e-6))
HALF = wp.constant(wp.float64(0.5))
FOUR_TIMES = wp.constant(wp.float64(4.0))


@wp.struct
class Search:
    """A search for the balance at approach = base + offset, and what the next one starts from."""

    base: wp.float64  # [mm]
    offset: wp.float64
    low: wp.float64  # bracket of the offset
    high: wp.float64
    reach: wp.float64  # a step without a bracket at most
    width: wp.float64  # of the bracket two evaluations ago
    force: wp.float64  # carried [N]
    evaluation: wp.int32
    round: wp.int32
    approach: wp.float64  # of the last two steps [mm]
    previous: wp.float64
    wander: wp.float64  # how much it has changed of late [mm]
    mean: wp.float64  # pressure of the last step [MPa]


@wp.struct
class Steps:
    """What steps on the device know, and what they change."""

    columns: wp.int32  # of a row of the field, padding included
    tiles: wp.int32  # of a row
    blocks: wp.int32  # of a pass over the cells
    sums: wp.int32  # lines of `found` that are added up; of the others the largest is looked for
    moves: wp.int32  # 1 where the disc is displaced
    keeps_dents: wp.int32
    compliance: wp.float64  # 1/k [mm³/N]
    implicit: wp.float64  # 1 where the wear of a step adds to its compliance
    cap: wp.float64  # [MPa]
    load: wp.float64  # [N]
    tolerance: wp.float64  # of the load [N]
    cell_area: wp.float64  # [mm²]
    wear_per_pressure: wp.array(dtype=wp.vec2d)  # K ΔL of sphere and disc in every step [mm³/N]
    shift: wp.array(dtype=wp.int32)  # the disc's row under the sphere's first, in every step
    step: wp.array(dtype=wp.int32)  # number of the step, and as `record` sees it
    searching: wp.array(dtype=wp.int32)  # one number, 1 until the search has ended
    search: wp.array(dtype=Search)  # one
    found: wp.array2d(dtype=wp.float64)  # sums and maxima, one column a block
    rows: wp.array2d(dtype=wp.float64)  # of the history


@wp.func
def compliance_of(steps: Steps):
    """The compliance c [mm³/N] of the cells in the step at hand."""
    worn = steps.wear_per_pressure[steps.step[0]]
    return steps.compliance + steps.implicit * (worn[0] + worn[1])


@wp.func
def begin_step(steps: Steps, step: wp.int32, last: Search):
    """Begin the search of a step.

    A contact at rest recedes by K p ΔL: the search begins where the last mean pressure puts it. A displaced
    one begins at the last approach, which it may be off by as much as it has lately wandered.
    """
    worn = steps.wear_per_pressure[wp.min(step, steps.wear_per_pressure.shape[0] - 1)]
    here = Search()
    here.mean = last.mean
    here.approach = last.approach
    here.previous = last.approach
    here.wander = wp.max(wp.abs(last.approach - last.previous), FADES * last.wander)
    here.base = last.approach
    here.low = -INFINITE
    here.high = INFINITE
    here.width = INFINITE
    if steps.moves == 1:
        here.reach = wp.max(TIMES * here.wander, LEAST)
    else:
        here.offset = (worn[0] + worn[1]) * last.mean
        here.reach = wp.where(here.offset != ZERO, wp.abs(here.offset), FIRST_REACH)
    steps.search[0] = here
    steps.searching[0] = 1


@wp.kernel
def begin(steps: Steps):
    """Begins the first of many steps; `record` begins the others. One thread."""
    if wp.tid() == 0:
        begin_step(steps, 0, steps.search[0])


@wp.kernel
def decide(steps: Steps):
    """The next trial approach, or the end of the search, from the first two lines of `found`. One block."""
    tid = wp.tid()
    some_pressure = ZERO
    some_slope = ZERO
    for i in range(tid, steps.blocks, wp.block_dim()):
        some_pressure += steps.found[0, i]
        some_slope += steps.found[1, i]
    total_pressure = wp.tile_sum(wp.tile(some_pressure))
    total_slope = wp.tile_sum(wp.tile(some_slope))
    force = wp.tile_extract(total_pressure, 0) * steps.cell_area
    slope = wp.tile_extract(total_slope, 0) * steps.cell_area
    if tid > 0:
        return
    steps.step[1] = steps.step[0]
    s = steps.search[0]
    residual = force - steps.load
    s.evaluation = s.evaluation + 1
    s.force = force
    if wp.abs(residual) <= steps.tolerance or s.evaluation >= EVALUATIONS * (s.round + 1):
        steps.searching[0] = 0
    else:
        offset = s.offset
        newton = offset - residual / wp.where(slope > ZERO, slope, ONE)
        s.low = wp.where(residual < ZERO, offset, s.low)
        s.high = wp.where(residual < ZERO, s.high, offset)
        trial = HALF * (s.low + s.high)
        if s.low <= -INFINITE or s.high >= INFINITE:
            trial = offset + wp.where(residual < ZERO, s.reach, -s.reach)
            if slope > ZERO and wp.abs(newton - offset) <= s.reach:
                trial = newton
            s.reach = FOUR_TIMES * s.reach
        else:
            even = s.evaluation % 2 == 0
            stalled = even and s.high - s.low > HALF * s.width
            if even:
                s.width = s.high - s.low
            if slope > ZERO and newton > s.low and newton < s.high and not stalled:
                trial = newton
            if trial <= s.low or trial >= s.high:  # the bracket is down to neighbouring numbers: begin there
                s.base = s.base + offset
                s.round = s.round + 1
                s.reach = FIRST_REACH
                s.width = INFINITE
                s.low = -INFINITE
                s.high = INFINITE
                trial = ZERO
                if s.round >= ROUNDS:
                    steps.searching[0] = 0
        s.offset = trial
    steps.search[0] = s


@wp.kernel
def record(steps: Steps):
    """Writes the row of the step, a block each sum or maximum; the first block begins the next step."""
    quantity = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    step = steps.step[1]  # the first block changes the other
    total = ZERO
    most = NO_INDEX
    contact = ZERO
    for i in range(lane, steps.found.shape[1], wp.block_dim()):
        value = steps.found[quantity, i]
        total += value
        most = wp.max(most, value)
        contact += steps.found[wp.static(int(WearSum.CONTACT)), i]
    sum_of_all = wp.tile_extract(wp.tile_sum(wp.tile(total)), 0)
    most_of_all = wp.tile_extract(wp.tile_max(wp.tile(most)), 0)
    cells = wp.tile_extract(wp.tile_sum(wp.tile(contact)), 0)
    if lane == 0:
        steps.rows[step, HEADER + quantity] = wp.where(quantity < steps.sums, sum_of_all, most_of_all)
        if quantity == 0:
            s = steps.search[0]
            steps.rows[step, 0] = s.base
            steps.rows[step, 1] = s.offset
            steps.rows[step, 2] = s.force - steps.load
            steps.rows[step, 3] = wp.float64(s.evaluation)
            s.approach = s.base + s.offset
            s.mean = sum_of_all / wp.max(cells, ONE)
            begin_step(steps, step + 1, s)
            steps.step[0] = step + 1
