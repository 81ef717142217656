"""Whole steps on a GPU without a word to the host: the search for the balance, and a row of the history.

What a pass over the cells finds is reduced block by block, into one column a block of the tables `found` and
`trial`. The passes are a pair of kernels each: those of a gap at rest in `steps_rest`, those of a
displaced disc in `steps_sliding`. The rule of the search is that of `balance.newton_in_bracket`. Where
the approach of a gap at rest is expected next is what `foresight.Foresight` says, and the pass that wears has
looked there already: most steps need no other.
"""

import warp as wp

from warpwear.kernels.cells import NO_INDEX, NONE, ONE, ZERO, WearSum

wp.set_module_options({"enable_backward": False})

#: Searches, each from a base nearer the solution; evaluations of each; first step of one that starts there.
ROUNDS = wp.constant(wp.int32(3))
EVALUATIONS = wp.constant(wp.int32(400))
FIRST_REACH = wp.constant(wp.float64(1.0e-18))
#: Columns of a row of the history before the sums and maxima: base, offset, evaluations.
HEADER = wp.constant(wp.int32(3))
#: A displaced step may be off by this many times the largest change of late.
TIMES = wp.constant(wp.float64(2.0))
#: What of that change a step leaves.
FADES = wp.constant(wp.float64(0.9))
#: And by this much at least [mm].
LEAST = wp.constant(wp.float64(1.0e-6))
HALF = wp.constant(wp.float64(0.5))
#: Of Newton's step, as in `balance`: part of the way to the next change of state, and loads of digits.
SURELY = wp.constant(wp.float64(0.999))
DIGITS = wp.constant(wp.float64(1.0e3))


@wp.struct
class Search:
    """A search for the balance at approach = base + offset, and what the next one starts from."""

    base: wp.float64  # [mm]
    offset: wp.float64
    low: wp.float64  # bracket of the offset
    high: wp.float64
    reach: wp.float64  # a step without a bracket at most
    width: wp.float64  # of the bracket two evaluations ago
    evaluation: wp.int32
    round: wp.int32
    approach: wp.float64  # of the last step that was balanced [mm]
    wander: wp.float64  # how much it has changed of late [mm]
    ahead: wp.float64  # how much further the next one is expected [mm]
    slid: wp.float64  # Σ K ΔL of both bodies [mm³/N]
    place: wp.float64  # of it, in the middle of the last step; negative before one
    rate: wp.float64  # at which the approach grew with it there [MPa]
    trend: wp.float64  # of that rate
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
    step: wp.array(dtype=wp.int32)  # number of the step, and as the pass that wears leaves it
    searching: wp.array(dtype=wp.int32)  # one number, 1 until the search has ended
    search: wp.array(dtype=Search)  # one
    trial: wp.array2d(dtype=wp.float64)  # what a trial approach carries, one column a block, see `carried_of`
    found: wp.array2d(dtype=wp.float64)  # sums and maxima, one column a block
    rows: wp.array2d(dtype=wp.float64)  # of the history


@wp.func
def worn_by(steps: Steps, step: wp.int32):
    """K ΔL of both bodies in a step [mm³/N]."""
    both = steps.wear_per_pressure[wp.min(step, steps.wear_per_pressure.shape[0] - 1)]
    return both[0] + both[1]


@wp.func
def compliance_of(steps: Steps, step: wp.int32):
    """The compliance c [mm³/N] of the cells in a step."""
    return steps.compliance + steps.implicit * worn_by(steps, step)


@wp.func
def carried_of(steps: Steps, lane: wp.int32, blocks: wp.int32):
    """Sums of the pressures and of the stiffnesses of cells neither open nor capped, and how far they hold.

    The third is the change of pressure that the cell nearest to it needs to open, close or reach the cap; its
    parts are negative. A block of threads, the lane of which this is, reduces the columns of some blocks.
    """
    pressure = ZERO
    slope = ZERO
    nearest = -NONE
    for i in range(lane, blocks, wp.block_dim()):
        pressure += steps.trial[0, i]
        slope += steps.trial[1, i]
        nearest = wp.max(nearest, steps.trial[2, i])
    return wp.vec3d(
        wp.tile_extract(wp.tile_sum(wp.tile(pressure)), 0),
        wp.tile_extract(wp.tile_sum(wp.tile(slope)), 0),
        -wp.tile_extract(wp.tile_max(wp.tile(nearest)), 0),
    )


@wp.func
def started(steps: Steps, last: Search):
    """The search of the next step.

    A gap at rest begins where its approach is expected. A displaced one begins at the last approach, which it
    may be off by as much as it has lately wandered.
    """
    s = last
    s.base = last.approach
    s.low = -NONE
    s.high = NONE
    s.width = NONE
    s.evaluation = 0
    s.round = 0
    s.offset = wp.where(steps.moves == 1, ZERO, last.ahead)
    s.reach = wp.where(s.offset != ZERO, wp.abs(s.offset), FIRST_REACH)
    if steps.moves == 1:
        s.reach = wp.max(TIMES * last.wander, LEAST)
    return s


@wp.func
def judged(steps: Steps, step: wp.int32, before: Search, carried: wp.vec3d):
    """The search of a step with its next trial approach, or at its end, by what the last one carries.

    Where no cell changes its state on the way Newton's step is the solution and is not looked at again.
    """
    s = before
    residual = carried[0] * steps.cell_area - steps.load
    slope = carried[1] * steps.cell_area
    offset = s.offset
    newton = offset - residual / wp.where(slope > ZERO, slope, ONE)
    change = wp.abs(newton - offset) / compliance_of(steps, step)
    searching = wp.int32(0)
    if wp.abs(residual) > steps.tolerance and s.evaluation < EVALUATIONS * (s.round + 1):
        s.low = wp.where(residual < ZERO, offset, s.low)
        s.high = wp.where(residual < ZERO, s.high, offset)
        trial = HALF * (s.low + s.high)
        if slope > ZERO and change < SURELY * carried[2] and slope * wp.abs(newton) < DIGITS * steps.load:
            trial = newton
        else:
            searching = 1
            if s.low <= -NONE or s.high >= NONE:
                trial = offset + wp.where(residual < ZERO, s.reach, -s.reach)
                if slope > ZERO and wp.abs(newton - offset) <= s.reach:
                    trial = newton
                s.reach = wp.float64(4.0) * s.reach
            else:
                even = s.evaluation % 2 == 0
                stalled = even and s.high - s.low > HALF * s.width
                if even:
                    s.width = s.high - s.low
                if slope > ZERO and newton > s.low and newton < s.high and not stalled:
                    trial = newton
                if trial <= s.low or trial >= s.high:  # down to neighbouring numbers: begin from there
                    s.base = s.base + offset
                    s.round = s.round + 1
                    s.reach = FIRST_REACH
                    s.width = NONE
                    s.low = -NONE
                    s.high = NONE
                    trial = ZERO
                    if s.round >= ROUNDS:
                        searching = 0
        s.offset = trial
    if searching == 0:
        approach = s.base + s.offset
        removal = worn_by(steps, step)
        where = s.slid + HALF * removal
        if removal > ZERO and where > s.place:  # a law that decays ends with steps too small to tell apart
            rate = (approach - s.approach) / removal
            s.trend = wp.where(s.place < ZERO, ZERO, (rate - s.rate) / (where - s.place))
            s.rate = rate
            s.place = where
        s.slid = s.slid + removal
        removal_next = worn_by(steps, step + 1)
        s.ahead = removal_next * (s.rate + s.trend * (s.slid + HALF * removal_next - s.place))
        s.wander = wp.max(wp.abs(approach - s.approach), FADES * s.wander)
        s.approach = approach
    steps.searching[0] = searching
    return s


@wp.kernel
def begin(steps: Steps):
    """Begins the first of many steps; `record` begins the others. One thread."""
    if wp.tid() == 0:
        steps.search[0] = started(steps, steps.search[0])
        steps.searching[0] = 1


@wp.kernel
def decide(steps: Steps):
    """The next trial approach, or the end of the search. One block."""
    carried = carried_of(steps, wp.tid(), steps.blocks)
    if wp.tid() == 0:
        s = steps.search[0]
        s.evaluation = s.evaluation + 1
        steps.search[0] = judged(steps, steps.step[0], s, carried)


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
    ahead = carried_of(steps, lane, wp.where(quantity == 0, steps.blocks, 0))
    if lane == 0:
        steps.rows[step, HEADER + quantity] = wp.where(quantity < steps.sums, sum_of_all, most_of_all)
        if quantity == 0:
            s = steps.search[0]
            steps.rows[step, 0] = s.base
            steps.rows[step, 1] = s.offset
            steps.rows[step, 2] = wp.float64(s.evaluation)
            s.mean = sum_of_all / wp.max(cells, ONE)
            s = started(steps, s)
            if steps.moves == 1:
                steps.searching[0] = 1
            else:
                s = judged(steps, step + 1, s, ahead)
            steps.search[0] = s
            steps.step[0] = step + 1
