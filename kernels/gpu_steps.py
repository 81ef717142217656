"""Whole steps on a GPU without a word to the host: the search for the balance, wear, a row of the history.

Here a thread visits single cells, its neighbours the neighbouring ones, and every block reduces what its
threads found to one column of a table of partial results. Fields are those of the other kernels, seen as
numbers. What a search knows lies in `search`, in the order of `SEARCH`; the rule is that of
`balance.newton_in_bracket`.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, NO_INDEX, ONE, ZERO, WearSum
from warpwear.kernels.contact import Law
from warpwear.kernels.gpu_wear_loop import Known, wear
from warpwear.kernels.wear_loops import Increment

wp.set_module_options({"enable_backward": False})

#: What the search for a balance keeps: approach = base + offset, its bracket, and the mean pressure before.
SEARCH = (
    "base",
    "offset",
    "low",
    "high",
    "reach",
    "width",
    "evaluation",
    "round",
    "force",
    "approach",
    "mean",
)
BASE, OFFSET, LOW, HIGH, REACH, WIDTH, EVALUATION, ROUND, FORCE, APPROACH, MEAN = (
    wp.constant(wp.int32(i)) for i in range(len(SEARCH))
)
#: Searches, each from a base nearer the solution; evaluations of each; first step of one that starts there.
ROUNDS = wp.constant(wp.float64(3.0))
EVALUATIONS = wp.constant(wp.float64(400.0))
FIRST_REACH = wp.constant(wp.float64(1.0e-18))
INFINITE = wp.constant(wp.float64(1.0e300))
#: Columns of a row of the history before those of the table of partial results, in which pressure is first.
HEADER = wp.constant(wp.int32(4))
#: Cells that a thread loads at once.
FOUR = 4
HALF = wp.constant(wp.float64(0.5))


@wp.func
def stiffness_of(known: Known, wear_per_pressure: wp.float64):
    """1/c of a step that wears both bodies by K ΔL = wear_per_pressure [mm³/N]."""
    return ONE / (known.compliance + known.implicit * wear_per_pressure)


@wp.kernel
def begin(
    wear_per_pressure_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    search_out: wp.array(dtype=wp.float64),
    searching_out: wp.array(dtype=wp.int32),
):
    """A worn contact recedes by K p ΔL: where the last mean pressure puts it the search begins."""
    step = step_in[0]
    guess = (wear_per_pressure_in[step, 0] + wear_per_pressure_in[step, 1]) * search_out[MEAN]
    search_out[BASE] = search_out[APPROACH]
    search_out[OFFSET] = guess
    search_out[LOW] = -INFINITE
    search_out[HIGH] = INFINITE
    search_out[REACH] = wp.where(guess != ZERO, wp.abs(guess), FIRST_REACH)
    search_out[WIDTH] = INFINITE
    search_out[EVALUATION] = ZERO
    search_out[ROUND] = ZERO
    searching_out[0] = 1


@wp.kernel
def carried(
    known: Known,
    wear_per_pressure_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    search_in: wp.array(dtype=wp.float64),
    gap_in: wp.array(dtype=wp.float64),
    partial_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the pressures at the trial approach, and of the stiffnesses of cells neither open nor capped."""
    block = wp.tid() // wp.block_dim()
    columns = known.columns
    base = search_in[BASE]
    offset = search_in[OFFSET]
    s = stiffness_of(known, wear_per_pressure_in[step_in[0], 0] + wear_per_pressure_in[step_in[0], 1])
    width = wp.block_dim()
    pressure = ZERO
    slope = ZERO
    for row in range(block, gap_in.shape[0] // columns, known.blocks):
        for first in range(wp.tid() % width, columns, FOUR * width):
            gaps = wp.vec4d(ABSENT, ABSENT, ABSENT, ABSENT)
            for j in range(FOUR):  # loaded together: one at a time does not keep the memory busy
                if first + j * width < columns:
                    gaps[j] = gap_in[row * columns + first + j * width]
            for j in range(FOUR):
                q = ((base - gaps[j]) + offset) * s
                pressure += wp.min(wp.max(q, ZERO), known.cap)
                slope += wp.where(q > ZERO and q < known.cap, s, ZERO)
    wp.tile_store(partial_out[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(partial_out[1], wp.tile_sum(wp.tile(slope)), offset=block)


@wp.kernel
def decide(
    load: wp.float64,
    tolerance: wp.float64,
    cell_area: wp.float64,
    partial_in: wp.array2d(dtype=wp.float64),
    search_out: wp.array(dtype=wp.float64),
    searching_out: wp.array(dtype=wp.int32),
):
    """The next trial approach, or the end of the search. One block."""
    tid = wp.tid()
    some_pressure = ZERO
    some_slope = ZERO
    for i in range(tid, partial_in.shape[1], wp.block_dim()):
        some_pressure += partial_in[0, i]
        some_slope += partial_in[1, i]
    total_pressure = wp.tile_sum(wp.tile(some_pressure))
    total_slope = wp.tile_sum(wp.tile(some_slope))
    force = wp.tile_extract(total_pressure, 0) * cell_area
    slope = wp.tile_extract(total_slope, 0) * cell_area
    if tid > 0:
        return
    residual = force - load
    evaluation = search_out[EVALUATION] + ONE
    search_out[EVALUATION] = evaluation
    search_out[FORCE] = force
    if wp.abs(residual) <= tolerance * load or evaluation >= EVALUATIONS * (search_out[ROUND] + ONE):
        searching_out[0] = 0
        return
    offset = search_out[OFFSET]
    low = wp.where(residual < ZERO, offset, search_out[LOW])
    high = wp.where(residual < ZERO, search_out[HIGH], offset)
    newton = offset - residual / wp.where(slope > ZERO, slope, ONE)
    trial = HALF * (low + high)
    if low <= -INFINITE or high >= INFINITE:
        reach = search_out[REACH]
        trial = offset + wp.where(residual < ZERO, reach, -reach)
        if slope > ZERO and wp.abs(newton - offset) <= reach:
            trial = newton
        search_out[REACH] = wp.float64(4.0) * reach
    else:
        even = wp.int32(evaluation) % 2 == 0
        stalled = even and high - low > HALF * search_out[WIDTH]
        if even:
            search_out[WIDTH] = high - low
        if slope > ZERO and newton > low and newton < high and not stalled:
            trial = newton
        if trial <= low or trial >= high:  # the bracket is down to neighbouring numbers: begin from there
            search_out[BASE] = search_out[BASE] + offset
            search_out[ROUND] = search_out[ROUND] + ONE
            search_out[REACH] = FIRST_REACH
            search_out[WIDTH] = INFINITE
            trial = ZERO
            low = -INFINITE
            high = INFINITE
            if search_out[ROUND] >= ROUNDS:
                searching_out[0] = 0
    search_out[OFFSET] = trial
    search_out[LOW] = low
    search_out[HIGH] = high


@wp.kernel
def wear_step(
    known: Known,
    wear_per_pressure_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    search_in: wp.array(dtype=wp.float64),
    unworn_in: wp.array(dtype=wp.float64),
    gap_out: wp.array(dtype=wp.float64),
    partial_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear, as `wear.wear_step`: the rows of `WearSum`, then those of `WearMost`."""
    step = step_in[0]
    here = Law()
    here.base = search_in[BASE]
    here.offset = search_in[OFFSET]
    here.cap = known.cap
    now = Increment()
    now.wear_per_pressure = wear_per_pressure_in[step, 0] + wear_per_pressure_in[step, 1]
    now.stiffness = stiffness_of(known, now.wear_per_pressure)
    now.reference = search_in[MEAN]
    wear(wp.tid(), wp.block_dim(), known, here, now, unworn_in, gap_out, partial_out)


@wp.kernel
def record(
    sums: wp.int32,
    partial_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    rows_out: wp.array2d(dtype=wp.float64),
):
    """Writes the sums (the first `sums` lines) and maxima of the step into its row. A block each."""
    tid = wp.tid()
    quantity = tid // wp.block_dim()
    lane = tid % wp.block_dim()
    total = ZERO
    most = NO_INDEX
    for i in range(lane, partial_in.shape[1], wp.block_dim()):
        total += partial_in[quantity, i]
        most = wp.max(most, partial_in[quantity, i])
    sum_tile = wp.tile_sum(wp.tile(total))
    most_tile = wp.tile_max(wp.tile(most))
    found = wp.where(quantity < sums, wp.tile_extract(sum_tile, 0), wp.tile_extract(most_tile, 0))
    if lane == 0:
        rows_out[step_in[0], HEADER + quantity] = found


@wp.kernel
def finish(
    load: wp.float64,
    search_out: wp.array(dtype=wp.float64),
    step_out: wp.array(dtype=wp.int32),
    rows_out: wp.array2d(dtype=wp.float64),
):
    """Completes the row of a step, and leaves the search what the next step starts from. One thread."""
    step = step_out[0]
    rows_out[step, 0] = search_out[BASE]
    rows_out[step, 1] = search_out[OFFSET]
    rows_out[step, 2] = search_out[FORCE] - load
    rows_out[step, 3] = search_out[EVALUATION]
    search_out[APPROACH] = search_out[BASE] + search_out[OFFSET]
    search_out[MEAN] = rows_out[step, HEADER] / wp.max(rows_out[step, HEADER + WearSum.CONTACT], ONE)
    step_out[0] = step + 1
