"""Passes of a search on a GPU around its transforms: response and preconditioner, which extends values.

The extension is that of `half_space.extension`.
"""

import warp as wp

from warpwear.kernels.cells import ONE, ZERO
from warpwear.kernels.gpu.half_space.solve import Solve, add, cap_of, sum_found, threads_of
from warpwear.kernels.half_space.search import free

wp.set_module_options({"enable_backward": False})


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
