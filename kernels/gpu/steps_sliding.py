"""The passes of a displaced disc over its tiles, on a GPU: what it carries, and the wear of both bodies.

A thread visits single tiles and looks at their bounds first: most lie apart, and their cells are not read.
The gap is made on the fly from the sphere's row and the disc's row beneath it, by the displacement of the
step.
"""

import warp as wp

from warpwear.kernels.cells import (
    ABSENT,
    LANES,
    NO_INDEX,
    ONE,
    TILE_VECTORS,
    ZERO,
    Cells,
    PressureMost,
    PressureSum,
    lowest_of,
    sum_of,
)
from warpwear.kernels.gpu.steps import Steps, compliance_of
from warpwear.kernels.sliding import Bodies, OfRows, OfTiles, beneath

wp.set_module_options({"enable_backward": False})

#: Lines of `found`: those of `PressureSum`, then those of `PressureMost` from here on.
MOST = wp.constant(wp.int32(len(PressureSum)))


@wp.kernel
def carried(steps: Steps, bodies: Bodies, of_tiles: OfTiles):
    """What the trial approach carries, see `steps.carried_of`."""
    block = wp.tid() // wp.block_dim()
    tiles = steps.tiles
    cap = steps.cap
    shift = steps.shift[steps.step[0]]
    base = steps.search[0].base
    offset = steps.search[0].offset
    s = ONE / compliance_of(steps, steps.step[0])
    pressure = ZERO
    slope = ZERO
    nearest = -ABSENT
    for i in range(wp.tid(), bodies.sphere.shape[0] * tiles, steps.blocks * wp.block_dim()):
        row = i // tiles
        t = i % tiles
        under = beneath(row, shift, bodies.disc.shape[0])
        overlap = (base - (of_tiles.lowest[row, t] - of_tiles.highest[under, t])) + offset
        if overlap <= ZERO:
            nearest = wp.max(nearest, overlap * s)
        else:
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, bodies.sphere.shape[1])):
                gap = bodies.sphere[row, k] - bodies.disc[under, k]
                for j in range(LANES):
                    q = ((base - gap[j]) + offset) * s
                    pressure += wp.min(wp.max(q, ZERO), cap)
                    slope += wp.where(q > ZERO and q < cap, s, ZERO)
                    nearest = wp.max(nearest, -wp.min(wp.abs(q), wp.abs(q - cap)))
    wp.tile_store(steps.trial[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(steps.trial[1], wp.tile_sum(wp.tile(slope)), offset=block)
    wp.tile_store(steps.trial[2], wp.tile_max(wp.tile(nearest)), offset=block)


@wp.kernel
def wear_step(steps: Steps, bodies: Bodies, of_tiles: OfTiles):
    """One increment of wear of both bodies, and what their tiles keep, as `sliding.wear_step`."""
    block = wp.tid() // wp.block_dim()
    found = steps.found
    tiles = steps.tiles
    cap = steps.cap
    step = steps.step[0]
    if wp.tid() == 0:
        steps.step[1] = step
    shift = steps.shift[step]
    base = steps.search[0].base
    offset = steps.search[0].offset
    mean = steps.search[0].mean
    of_sphere = steps.wear_per_pressure[step][0]
    of_disc = steps.wear_per_pressure[step][1]
    c = compliance_of(steps, step)
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
    for i in range(wp.tid(), bodies.sphere.shape[0] * tiles, steps.blocks * wp.block_dim()):
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
                if steps.keeps_dents == 1:
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
            if steps.keeps_dents == 1:
                of_tiles.pressed_disc[under, t] = sum_of(pressed)
    wp.tile_store(found[PressureSum.PRESSURE], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(found[PressureSum.DEVIATION_SQUARED], wp.tile_sum(wp.tile(deviation)), offset=block)
    wp.tile_store(found[PressureSum.CONTACT], wp.tile_sum(wp.tile(contact)), offset=block)
    wp.tile_store(found[PressureSum.CAPPED], wp.tile_sum(wp.tile(capped)), offset=block)
    wp.tile_store(found[MOST + PressureMost.PRESSURE], wp.tile_max(wp.tile(highest)), offset=block)
    wp.tile_store(found[MOST + PressureMost.WEAR_SPHERE], wp.tile_max(wp.tile(deepest_sphere)), offset=block)
    wp.tile_store(found[MOST + PressureMost.WEAR_DISC], wp.tile_max(wp.tile(deepest_disc)), offset=block)
    wp.tile_store(found[MOST + PressureMost.FIRST_COLUMN], wp.tile_max(wp.tile(first_column)), offset=block)
    wp.tile_store(found[MOST + PressureMost.LAST_COLUMN], wp.tile_max(wp.tile(last_column)), offset=block)


@wp.kernel
def rows(steps: Steps, of_tiles: OfTiles, of_rows: OfRows):
    """Sums of the sphere's rows and of those beneath them, and by how much each has grown. A block a row.

    Differences of neighbouring sums are exact, so that a total of them does not drift.
    """
    row = wp.tid() // wp.block_dim()
    lane = wp.tid() % wp.block_dim()
    under = beneath(row, steps.shift[steps.step[0]], of_tiles.worn_disc.shape[0])
    touched = ZERO
    worn_sphere = ZERO
    worn_disc = ZERO
    pressed = ZERO
    for t in range(lane, steps.tiles, wp.block_dim()):
        touched += of_tiles.touched[row, t]
        worn_sphere += of_tiles.worn_sphere[row, t]
        worn_disc += of_tiles.worn_disc[under, t]
        if steps.keeps_dents == 1:
            pressed += of_tiles.pressed_disc[under, t]
    all_touched = wp.tile_extract(wp.tile_sum(wp.tile(touched)), 0)
    all_worn_sphere = wp.tile_extract(wp.tile_sum(wp.tile(worn_sphere)), 0)
    all_worn_disc = wp.tile_extract(wp.tile_sum(wp.tile(worn_disc)), 0)
    all_pressed = wp.tile_extract(wp.tile_sum(wp.tile(pressed)), 0)
    if lane == 0:
        found = steps.found
        found[PressureSum.TOUCHED, row] = all_touched - of_rows.touched[row]
        found[PressureSum.WEAR_SPHERE, row] = all_worn_sphere - of_rows.worn_sphere[row]
        found[PressureSum.WEAR_DISC, row] = all_worn_disc - of_rows.worn_disc[under]
        found[MOST + PressureMost.FIRST_ROW, row] = wp.where(all_touched > ZERO, -wp.float64(row), NO_INDEX)
        found[MOST + PressureMost.LAST_ROW, row] = wp.where(all_touched > ZERO, wp.float64(row), NO_INDEX)
        of_rows.touched[row] = all_touched
        of_rows.worn_sphere[row] = all_worn_sphere
        of_rows.worn_disc[under] = all_worn_disc
        if steps.keeps_dents == 1:
            found[PressureSum.PRESSED_DISC, row] = all_pressed - of_rows.pressed_disc[under]
            of_rows.pressed_disc[under] = all_pressed
