"""Whole steps of a displaced disc on a GPU without a word to the host, beside those of `gpu_steps`.

A thread visits single tiles and looks at their bounds first: most lie apart, and their cells are not read.
The gap is made on the fly from the sphere's row and the disc's row beneath it, by the displacement of the
step. The search for the balance is that of `gpu_steps`, from the last approach, which the next one may
be off by as much as it has lately wandered.
"""

from enum import IntEnum

import warp as wp

from warpwear.kernels.cells import (
    ABSENT,
    LANES,
    NO_INDEX,
    ONE,
    TILE_VECTORS,
    ZERO,
    Cells,
    TrackMost,
    TrackSum,
    lowest_of,
    sum_of,
)
from warpwear.kernels.gpu_steps import (
    APPROACH,
    BASE,
    EVALUATION,
    HEADER,
    HIGH,
    INFINITE,
    LOW,
    MEAN,
    OFFSET,
    REACH,
    ROUND,
    SEARCH,
    WIDTH,
    stiffness_of,
)
from warpwear.kernels.gpu_wear_loop import Known
from warpwear.kernels.sliding import Bodies, OfRows, OfTiles, beneath

wp.set_module_options({"enable_backward": False})

#: What a search keeps after the quantities of `gpu_steps.SEARCH`: the approach before, and its wandering.
MORE = ("previous", "wander")
PREVIOUS, WANDER = (wp.constant(wp.int32(len(SEARCH) + i)) for i in range(len(MORE)))
#: A step may be off by this many times the largest change of late.
TIMES = wp.constant(wp.float64(2.0))
#: What of that change a step leaves.
FADES = wp.constant(wp.float64(0.9))
#: And by this much at least [mm].
LEAST = wp.constant(wp.float64(1.0e-6))
#: Rows of the table of partial results by block: those of `TrackSum`, then those of `TrackMost` from here on.
MOST = wp.constant(wp.int32(len(TrackSum)))


class RowSum(IntEnum):
    """Rows of the table of what rows of the sphere, and those beneath, have grown by, or lie at."""

    TOUCHED = 0
    WEAR_SPHERE = 1
    WEAR_DISC = 2
    PRESSED_DISC = 3
    FIRST_ROW = 4
    LAST_ROW = 5


@wp.struct
class Now:
    """What a step finds on the device."""

    wear_per_pressure: wp.array2d(
        dtype=wp.float64
    )  # K ΔL of sphere and disc in every step of the block [mm³/N]
    shift: wp.array(dtype=wp.int32)  # the disc's row under the sphere's first
    step: wp.array(dtype=wp.int32)  # one number
    search: wp.array(dtype=wp.float64)  # in the order of `SEARCH` and `MORE`


#: How `record` reduces a quantity, as `models.track.on_gpu` has it.
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
    known: Known, now: Now, bodies: Bodies, of_tiles: OfTiles, partial_out: wp.array2d(dtype=wp.float64)
):
    """Sum of the pressures at the trial approach, and of the stiffnesses of cells neither open nor capped."""
    block = wp.tid() // wp.block_dim()
    tiles = known.tiles
    cap = known.cap
    step = now.step[0]
    shift = now.shift[step]
    base = now.search[BASE]
    offset = now.search[OFFSET]
    s = stiffness_of(known, now.wear_per_pressure[step, 0] + now.wear_per_pressure[step, 1])
    pressure = ZERO
    slope = ZERO
    for i in range(wp.tid(), bodies.sphere.shape[0] * tiles, known.blocks * wp.block_dim()):
        row = i // tiles
        t = i % tiles
        under = beneath(row, shift, bodies.disc.shape[0])
        if (base - (of_tiles.lowest[row, t] - of_tiles.highest[under, t])) + offset > ZERO:
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, bodies.sphere.shape[1])):
                gap = bodies.sphere[row, k] - bodies.disc[under, k]
                for j in range(LANES):
                    q = ((base - gap[j]) + offset) * s
                    pressure += wp.min(wp.max(q, ZERO), cap)
                    slope += wp.where(q > ZERO and q < cap, s, ZERO)
    wp.tile_store(partial_out[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(partial_out[1], wp.tile_sum(wp.tile(slope)), offset=block)


@wp.kernel
def wear_step(
    known: Known, now: Now, bodies: Bodies, of_tiles: OfTiles, partial_out: wp.array2d(dtype=wp.float64)
):
    """One increment of wear of both bodies, and what their tiles keep, as `sliding.wear_step`."""
    block = wp.tid() // wp.block_dim()
    tiles = known.tiles
    cap = known.cap
    step = now.step[0]
    shift = now.shift[step]
    base = now.search[BASE]
    offset = now.search[OFFSET]
    of_sphere = now.wear_per_pressure[step, 0]
    of_disc = now.wear_per_pressure[step, 1]
    mean = now.search[MEAN]
    c = known.compliance + known.implicit * (of_sphere + of_disc)
    stiffness = ONE / c
    keeps_reached = bodies.reached.shape[0] == bodies.sphere.shape[0]
    pressure = ZERO
    deviation = ZERO
    contact = ZERO
    capped = ZERO
    highest = ZERO
    deepest_sphere = ZERO
    deepest_disc = ZERO
    first_column = NO_INDEX
    last_column = NO_INDEX
    for i in range(wp.tid(), bodies.sphere.shape[0] * tiles, known.blocks * wp.block_dim()):
        row = i // tiles
        t = i % tiles
        under = beneath(row, shift, bodies.disc.shape[0])
        if (base - (of_tiles.lowest[row, t] - of_tiles.highest[under, t])) + offset > ZERO:
            low = Cells(ABSENT)
            high = Cells(-ABSENT)
            worn_sphere = Cells(ZERO)
            worn_disc = Cells(ZERO)
            pressed = Cells(ZERO)
            touched = ZERO
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, bodies.sphere.shape[1])):
                s = bodies.sphere[row, k]
                d = bodies.disc[under, k]
                a = bodies.wear_sphere[row, k]
                b = bodies.wear_disc[under, k]
                was = a
                if keeps_reached:
                    was = bodies.reached[row, k]
                gap = s - d
                if known.keeps_dents == 1:
                    x = bodies.plastic_disc[under, k]
                    for j in range(LANES):
                        beyond = wp.max(((base - gap[j]) + offset) - c * cap, ZERO)
                        d[j] = d[j] - beyond
                        x[j] = x[j] + beyond
                    pressed += x
                    bodies.plastic_disc[under, k] = x
                for j in range(LANES):
                    p = wp.min(wp.max(((base - gap[j]) + offset) * stiffness, ZERO), cap)
                    s[j] = s[j] + of_sphere * p
                    a[j] = a[j] + of_sphere * p
                    d[j] = d[j] - of_disc * p
                    b[j] = b[j] + of_disc * p
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
                bodies.sphere[row, k] = s
                bodies.disc[under, k] = d
                bodies.wear_sphere[row, k] = a
                bodies.wear_disc[under, k] = b
                if keeps_reached:
                    bodies.reached[row, k] = was
                low = wp.min(low, s)
                high = wp.max(high, d)
                worn_sphere += a
                worn_disc += b
                deepest_sphere = wp.max(deepest_sphere, wp.max(a))
                deepest_disc = wp.max(deepest_disc, wp.max(b))
            of_tiles.lowest[row, t] = lowest_of(low)
            of_tiles.highest[under, t] = wp.max(high)
            of_tiles.touched[row, t] = touched
            of_tiles.worn_sphere[row, t] = sum_of(worn_sphere)
            of_tiles.worn_disc[under, t] = sum_of(worn_disc)
            if known.keeps_dents == 1:
                of_tiles.pressed_disc[under, t] = sum_of(pressed)
    wp.tile_store(partial_out[TrackSum.PRESSURE], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(partial_out[TrackSum.DEVIATION_SQUARED], wp.tile_sum(wp.tile(deviation)), offset=block)
    wp.tile_store(partial_out[TrackSum.CONTACT], wp.tile_sum(wp.tile(contact)), offset=block)
    wp.tile_store(partial_out[TrackSum.CAPPED], wp.tile_sum(wp.tile(capped)), offset=block)
    wp.tile_store(partial_out[MOST + TrackMost.PRESSURE], wp.tile_max(wp.tile(highest)), offset=block)
    wp.tile_store(
        partial_out[MOST + TrackMost.WEAR_SPHERE], wp.tile_max(wp.tile(deepest_sphere)), offset=block
    )
    wp.tile_store(partial_out[MOST + TrackMost.WEAR_DISC], wp.tile_max(wp.tile(deepest_disc)), offset=block)
    wp.tile_store(
        partial_out[MOST + TrackMost.FIRST_COLUMN], wp.tile_max(wp.tile(first_column)), offset=block
    )
    wp.tile_store(partial_out[MOST + TrackMost.LAST_COLUMN], wp.tile_max(wp.tile(last_column)), offset=block)


@wp.kernel
def rows(
    known: Known, now: Now, of_tiles: OfTiles, of_rows: OfRows, change_out: wp.array2d(dtype=wp.float64)
):
    """Sums of the sphere's rows and of those beneath them, and by how much each has grown. A block a row.

    Differences of neighbouring sums are exact, so that a total of them does not drift.
    """
    row = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    under = beneath(row, now.shift[now.step[0]], of_tiles.worn_disc.shape[0])
    touched = ZERO
    worn_sphere = ZERO
    worn_disc = ZERO
    pressed = ZERO
    for t in range(lane, known.tiles, wp.block_dim()):
        touched += of_tiles.touched[row, t]
        worn_sphere += of_tiles.worn_sphere[row, t]
        worn_disc += of_tiles.worn_disc[under, t]
        if known.keeps_dents == 1:
            pressed += of_tiles.pressed_disc[under, t]
    all_touched = wp.tile_extract(wp.tile_sum(wp.tile(touched)), 0)
    all_worn_sphere = wp.tile_extract(wp.tile_sum(wp.tile(worn_sphere)), 0)
    all_worn_disc = wp.tile_extract(wp.tile_sum(wp.tile(worn_disc)), 0)
    all_pressed = wp.tile_extract(wp.tile_sum(wp.tile(pressed)), 0)
    if lane == 0:
        change_out[RowSum.TOUCHED, row] = all_touched - of_rows.touched[row]
        change_out[RowSum.WEAR_SPHERE, row] = all_worn_sphere - of_rows.worn_sphere[row]
        change_out[RowSum.WEAR_DISC, row] = all_worn_disc - of_rows.worn_disc[under]
        change_out[RowSum.PRESSED_DISC, row] = ZERO
        change_out[RowSum.FIRST_ROW, row] = wp.where(all_touched > ZERO, -wp.float64(row), NO_INDEX)
        change_out[RowSum.LAST_ROW, row] = wp.where(all_touched > ZERO, wp.float64(row), NO_INDEX)
        of_rows.touched[row] = all_touched
        of_rows.worn_sphere[row] = all_worn_sphere
        of_rows.worn_disc[under] = all_worn_disc
        if known.keeps_dents == 1:
            change_out[RowSum.PRESSED_DISC, row] = all_pressed - of_rows.pressed_disc[under]
            of_rows.pressed_disc[under] = all_pressed


@wp.kernel
def record(
    how_in: wp.array2d(dtype=wp.int32),
    partial_in: wp.array2d(dtype=wp.float64),
    change_in: wp.array2d(dtype=wp.float64),
    step_in: wp.array(dtype=wp.int32),
    total_out: wp.array2d(dtype=wp.float64),
    rows_out: wp.array2d(dtype=wp.float64),
):
    """The row of the step, after what `gpu_steps.finish` writes. A block a quantity.

    how_in: of each quantity its table (0: by block, 1: by row), its line there, and how it is reduced.
    total_out: sums of those that grow, and what rounding has cost each so far.
    """
    quantity = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    line = how_in[quantity, 1]
    reduction = how_in[quantity, 2]
    total = ZERO
    most = NO_INDEX
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
        rows_out[step_in[0], HEADER + quantity] = found
