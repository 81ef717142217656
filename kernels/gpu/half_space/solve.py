"""What the passes of a search on a GPU share: rules, numbers, fields, and how blocks of threads add up.

A thread visits single cells; fields are those of the other kernels, seen as numbers. What a pass finds is
reduced block by block into `found`, a line each sum or maximum, and read by a kernel of one block that
decides what follows. On a CPU, where only tests run it, a block is one thread.
"""

from enum import IntEnum

import warp as wp

from warpwear.kernels.cells import NONE, ZERO

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
