"""Whole steps of a displaced disc on a GPU without a word to the host, beside those of `device_steps`.

A thread visits single tiles and looks at their bounds first: most lie apart, and their cells are not read.
The gap is made on the fly from the sphere's row and the disc's row beneath it, by the displacement of the
step. The search for the balance is that of `device_steps`, from the last approach, which the next one may
be off by as much as it has lately wandered.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, NOWHERE, ONE, ZERO, Cells, lowest_of, sum_of
from warpwear.kernels.cells import WIDTH as VECTORS
from warpwear.kernels.gpu_steps import (
    APPROACH,
    BASE,
    EVALUATION,
    HIGH,
    INFINITE,
    LOW,
    MEAN,
    OFFSET,
    REACH,
    ROUND,
    SEARCH,
    WIDTH,
)
from warpwear.kernels.sliding import beneath

wp.set_module_options({"enable_backward": False})

#: What a search keeps after the quantities of `device_steps.SEARCH`: the approach before, and its wandering.
MORE = ("previous", "wander")
PREVIOUS, WANDER = (wp.constant(wp.int32(len(SEARCH) + i)) for i in range(len(MORE)))
#: A step may be off by so many times the largest change of late, which fades so much a step; at least [mm].
TIMES = wp.constant(wp.float64(2.0))
FADES = wp.constant(wp.float64(0.9))
LEAST = wp.constant(wp.float64(1.0e-6))
#: Rows of the table of partial results by block of `remove`, and by row of `rows`.
OF_STEP = (
    "pressure",
    "deviation_squared",
    "contact",
    "capped",
    "highest",
    "deepest_sphere",
    "deepest_disc",
    "first_column",
    "last_column",
)
OF_ROWS = ("touched", "worn_sphere", "worn_disc", "pressed_disc", "first_row", "last_row")
#: How `record` reduces a quantity.
ADDS, LARGEST, GROWS = (wp.constant(wp.int32(i)) for i in range(3))


@wp.kernel
def begin(search_out: wp.array(dtype=wp.float64), searching_out: wp.array(dtype=wp.int32)):
    """The search begins at the last approach. One thread."""
    approach = search_out[APPROACH]
    wander = wp.max(wp.abs(approach - search_out[PREVIOUS]), FADES * search_out[WANDER])
    search_out[PREVIOUS] = approach
    search_out[WANDER] = wander
    search_out[BASE] = approach
    search_out[OFFSET] = ZERO
    search_out[LOW] = -INFINITE
    search_out[HIGH] = INFINITE
    search_out[REACH] = wp.max(TIMES * wander, LEAST)
    search_out[WIDTH] = INFINITE
    search_out[EVALUATION] = ZERO
    search_out[ROUND] = ZERO
    searching_out[0] = 1


@wp.kernel
def carried(
    tiles: wp.int32,
    compliance: wp.float64,
    implicit: wp.float64,
    cap: wp.float64,
    blocks: wp.int32,
    removal_in: wp.array2d(dtype=wp.float64),
    shift_in: wp.array(dtype=wp.int32),
    step_in: wp.array(dtype=wp.int32),
    search_in: wp.array(dtype=wp.float64),
    lowest_in: wp.array2d(dtype=wp.float64),
    highest_in: wp.array2d(dtype=wp.float64),
    sphere_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    partial_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the pressures at the trial approach, and of the stiffnesses of cells neither open nor capped."""
    block = wp.tid() // wp.block_dim()
    step = step_in[0]
    shift = shift_in[step]
    base = search_in[BASE]
    offset = search_in[OFFSET]
    s = ONE / (compliance + implicit * (removal_in[step, 0] + removal_in[step, 1]))
    pressure = ZERO
    slope = ZERO
    for i in range(wp.tid(), sphere_in.shape[0] * tiles, blocks * wp.block_dim()):
        row = i // tiles
        t = i % tiles
        under = beneath(row, shift, disc_in.shape[0])
        if (base - (lowest_in[row, t] - highest_in[under, t])) + offset > ZERO:
            for k in range(t * VECTORS, wp.min((t + 1) * VECTORS, sphere_in.shape[1])):
                gap = sphere_in[row, k] - disc_in[under, k]
                for j in range(LANES):
                    q = ((base - gap[j]) + offset) * s
                    pressure += wp.min(wp.max(q, ZERO), cap)
                    slope += wp.where(q > ZERO and q < cap, s, ZERO)
    wp.tile_store(partial_out[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(partial_out[1], wp.tile_sum(wp.tile(slope)), offset=block)


@wp.kernel
def remove(
    tiles: wp.int32,
    compliance: wp.float64,
    implicit: wp.float64,
    cap: wp.float64,
    blocks: wp.int32,
    keeps: wp.int32,
    removal_in: wp.array2d(dtype=wp.float64),
    shift_in: wp.array(dtype=wp.int32),
    step_in: wp.array(dtype=wp.int32),
    search_in: wp.array(dtype=wp.float64),
    lowest_out: wp.array2d(dtype=wp.float64),
    highest_out: wp.array2d(dtype=wp.float64),
    sphere_out: wp.array2d(dtype=Cells),
    disc_out: wp.array2d(dtype=Cells),
    wear_sphere_out: wp.array2d(dtype=Cells),
    wear_disc_out: wp.array2d(dtype=Cells),
    plastic_disc_out: wp.array2d(dtype=Cells),
    reached_out: wp.array2d(dtype=Cells),
    touched_out: wp.array2d(dtype=wp.float64),
    worn_sphere_out: wp.array2d(dtype=wp.float64),
    worn_disc_out: wp.array2d(dtype=wp.float64),
    pressed_disc_out: wp.array2d(dtype=wp.float64),
    partial_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear of the tiles in reach, as `sliding.remove`: partial results by `OF_STEP`.

    keeps: 1 for a disc that keeps its dents. reached_out: as there. Bounds and sums of those tiles are made
    anew.
    """
    block = wp.tid() // wp.block_dim()
    step = step_in[0]
    shift = shift_in[step]
    removal_sphere = removal_in[step, 0]
    removal_disc = removal_in[step, 1]
    base = search_in[BASE]
    offset = search_in[OFFSET]
    mean = search_in[MEAN]
    c = compliance + implicit * (removal_sphere + removal_disc)
    stiffness = ONE / c
    pressure = ZERO
    deviation = ZERO
    contact = ZERO
    capped = ZERO
    highest = ZERO
    deepest_sphere = ZERO
    deepest_disc = ZERO
    first_column = NOWHERE
    last_column = NOWHERE
    for i in range(wp.tid(), sphere_out.shape[0] * tiles, blocks * wp.block_dim()):
        row = i // tiles
        t = i % tiles
        under = beneath(row, shift, disc_out.shape[0])
        if (base - (lowest_out[row, t] - highest_out[under, t])) + offset > ZERO:
            low = Cells(ABSENT)
            high = Cells(-ABSENT)
            worn_sphere = Cells(ZERO)
            worn_disc = Cells(ZERO)
            pressed = Cells(ZERO)
            touched = ZERO
            for k in range(t * VECTORS, wp.min((t + 1) * VECTORS, sphere_out.shape[1])):
                s = sphere_out[row, k]
                d = disc_out[under, k]
                a = wear_sphere_out[row, k]
                b = wear_disc_out[under, k]
                was = a
                if reached_out.shape[0] == sphere_out.shape[0]:
                    was = reached_out[row, k]
                gap = s - d
                if keeps == 1:
                    x = plastic_disc_out[under, k]
                    for j in range(LANES):
                        beyond = wp.max(((base - gap[j]) + offset) - c * cap, ZERO)
                        d[j] = d[j] - beyond
                        x[j] = x[j] + beyond
                    pressed += x
                    plastic_disc_out[under, k] = x
                for j in range(LANES):
                    p = wp.min(wp.max(((base - gap[j]) + offset) * stiffness, ZERO), cap)
                    s[j] = s[j] + removal_sphere * p
                    a[j] = a[j] + removal_sphere * p
                    d[j] = d[j] - removal_disc * p
                    b[j] = b[j] + removal_disc * p
                    pressure += p
                    highest = wp.max(highest, p)
                    if p > ZERO:
                        deviation += (p - mean) * (p - mean)
                        contact += ONE
                        capped += wp.where(p >= cap, ONE, ZERO)
                        column = wp.float64(k * LANES + j)
                        first_column = wp.max(first_column, -column)
                        last_column = wp.max(last_column, column)
                    was[j] = wp.where(p + was[j] > ZERO, ONE, ZERO)
                    touched += was[j]
                sphere_out[row, k] = s
                disc_out[under, k] = d
                wear_sphere_out[row, k] = a
                wear_disc_out[under, k] = b
                if reached_out.shape[0] == sphere_out.shape[0]:
                    reached_out[row, k] = was
                low = wp.min(low, s)
                high = wp.max(high, d)
                worn_sphere += a
                worn_disc += b
                deepest_sphere = wp.max(deepest_sphere, wp.max(a))
                deepest_disc = wp.max(deepest_disc, wp.max(b))
            lowest_out[row, t] = lowest_of(low)
            highest_out[under, t] = wp.max(high)
            touched_out[row, t] = touched
            worn_sphere_out[row, t] = sum_of(worn_sphere)
            worn_disc_out[under, t] = sum_of(worn_disc)
            if keeps == 1:
                pressed_disc_out[under, t] = sum_of(pressed)
    wp.tile_store(partial_out[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(partial_out[1], wp.tile_sum(wp.tile(deviation)), offset=block)
    wp.tile_store(partial_out[2], wp.tile_sum(wp.tile(contact)), offset=block)
    wp.tile_store(partial_out[3], wp.tile_sum(wp.tile(capped)), offset=block)
    wp.tile_store(partial_out[4], wp.tile_max(wp.tile(highest)), offset=block)
    wp.tile_store(partial_out[5], wp.tile_max(wp.tile(deepest_sphere)), offset=block)
    wp.tile_store(partial_out[6], wp.tile_max(wp.tile(deepest_disc)), offset=block)
    wp.tile_store(partial_out[7], wp.tile_max(wp.tile(first_column)), offset=block)
    wp.tile_store(partial_out[8], wp.tile_max(wp.tile(last_column)), offset=block)


@wp.kernel
def rows(
    tiles: wp.int32,
    keeps: wp.int32,
    shift_in: wp.array(dtype=wp.int32),
    step_in: wp.array(dtype=wp.int32),
    touched_in: wp.array2d(dtype=wp.float64),
    worn_sphere_in: wp.array2d(dtype=wp.float64),
    worn_disc_in: wp.array2d(dtype=wp.float64),
    pressed_disc_in: wp.array2d(dtype=wp.float64),
    touched_out: wp.array(dtype=wp.float64),
    worn_sphere_out: wp.array(dtype=wp.float64),
    worn_disc_out: wp.array(dtype=wp.float64),
    pressed_disc_out: wp.array(dtype=wp.float64),
    change_out: wp.array2d(dtype=wp.float64),
):
    """Sums of the sphere's rows and of those beneath them, and by how much each has grown. A block a row.

    Differences of neighbouring sums are exact, so that a total of them does not drift.
    """
    row = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    under = beneath(row, shift_in[step_in[0]], worn_disc_in.shape[0])
    touched = ZERO
    worn_sphere = ZERO
    worn_disc = ZERO
    pressed = ZERO
    for t in range(lane, tiles, wp.block_dim()):
        touched += touched_in[row, t]
        worn_sphere += worn_sphere_in[row, t]
        worn_disc += worn_disc_in[under, t]
        if keeps == 1:
            pressed += pressed_disc_in[under, t]
    all_touched = wp.tile_extract(wp.tile_sum(wp.tile(touched)), 0)
    all_worn_sphere = wp.tile_extract(wp.tile_sum(wp.tile(worn_sphere)), 0)
    all_worn_disc = wp.tile_extract(wp.tile_sum(wp.tile(worn_disc)), 0)
    all_pressed = wp.tile_extract(wp.tile_sum(wp.tile(pressed)), 0)
    if lane == 0:
        change_out[0, row] = all_touched - touched_out[row]
        change_out[1, row] = all_worn_sphere - worn_sphere_out[row]
        change_out[2, row] = all_worn_disc - worn_disc_out[under]
        change_out[3, row] = ZERO
        change_out[4, row] = wp.where(all_touched > ZERO, -wp.float64(row), NOWHERE)
        change_out[5, row] = wp.where(all_touched > ZERO, wp.float64(row), NOWHERE)
        touched_out[row] = all_touched
        worn_sphere_out[row] = all_worn_sphere
        worn_disc_out[under] = all_worn_disc
        if keeps == 1:
            change_out[3, row] = all_pressed - pressed_disc_out[under]
            pressed_disc_out[under] = all_pressed


@wp.kernel
def record(
    how_in: wp.array2d(dtype=wp.int32),
    partial_in: wp.array2d(dtype=wp.float64),
    change_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    total_out: wp.array2d(dtype=wp.float64),
    rows_out: wp.array2d(dtype=wp.float64),
):
    """The row of the step, after what `device_steps.finish` writes. A block a quantity.

    how_in: of each quantity its table (0: by block, 1: by row), its line there, and how it is reduced.
    total_out: sums of those that grow, and what rounding has cost each so far.
    """
    quantity = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    line = how_in[quantity, 1]
    reduction = how_in[quantity, 2]
    total = ZERO
    most = NOWHERE
    if how_in[quantity, 0] == 0:
        for i in range(lane, partial_in.shape[1], wp.block_dim()):
            total += partial_in[line, i]
            most = wp.max(most, partial_in[line, i])
    else:
        for i in range(lane, change_in.shape[1], wp.block_dim()):
            total += change_in[line, i]
            most = wp.max(most, change_in[line, i])
    sum_of_all = wp.tile_extract(wp.tile_sum(wp.tile(total)), 0)
    most_of_all = wp.tile_extract(wp.tile_max(wp.tile(most)), 0)
    if lane == 0:
        found = wp.where(reduction == LARGEST, most_of_all, sum_of_all)
        if reduction == GROWS:
            before = total_out[quantity, 0]
            after = before + found
            larger = wp.where(wp.abs(before) >= wp.abs(found), before, found)
            smaller = wp.where(wp.abs(before) >= wp.abs(found), found, before)
            lost = total_out[quantity, 1] + ((larger - after) + smaller)
            total_out[quantity, 0] = after
            total_out[quantity, 1] = lost
            found = after + lost
        rows_out[step_in[0], 4 + quantity] = found
