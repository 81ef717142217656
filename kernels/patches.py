"""Patches of a contact, each at an approach of its own: what they carry, their pressures, their wear.

All patches lie in one field of shape (patches, lines · vectors of a line): a row is a patch, its lines of
cells (along axis 1 of the domain) one after another, each padded to whole vectors. A tile is `TILE_VECTORS`
vectors of one line, or what is left of it. A slot is a place in the list of patches visited (one of several
that share a patch on a GPU); tiles whose lowest gap, before any wear, is above the patch's approach are
skipped.
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
    WearMost,
    WearSum,
    lowest_of,
    sum_of,
)
from warpwear.kernels.contact import Law, pressure_of, sag
from warpwear.kernels.wear_loops import Approaches, Increment, Layout, Tables, wear_patches

wp.set_module_options({"enable_backward": False})


@wp.struct
class Ball:
    """Where the domain's first cell lies under the sphere, or a rigid flat."""

    cell: wp.float64  # [mm]
    x_first: wp.float64
    y_first: wp.float64
    curvature: wp.float64  # 1/R [1/mm]


@wp.kernel
def gap(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    ball: Ball,
    layout: Layout,
    roughness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
):
    """Gap of the unworn bodies from the mean planes, and its lowest in every tile, in `layout`.

    columns: of a line.
    """
    slot = first_slot + wp.tid()
    patch = slot // slots_per_row
    vectors = layout.vectors
    tiles = (vectors + TILE_VECTORS - 1) // TILE_VECTORS
    for n in range(slot % slots_per_row, layout.lowest.shape[1], slots_per_row):
        line = n // tiles
        first = (n - line * tiles) * TILE_VECTORS
        x = ball.x_first + wp.float64(layout.first_row[patch] + line) * ball.cell
        low = Cells(ABSENT)
        for v in range(first, wp.min(first + TILE_VECTORS, vectors)):
            z = roughness_in[patch, line * vectors + v]
            g = Cells(ABSENT)
            for j in range(LANES):
                column = v * LANES + j
                y = ball.y_first + wp.float64(layout.first_column[patch] + column) * ball.cell
                if column < columns:
                    g[j] = sag(x, y, ball.curvature) - z[j]
            gap_out[patch, line * vectors + v] = g
            low = wp.min(low, g)
        layout.lowest[patch, n] = lowest_of(low)


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    patches_in: wp.array(dtype=wp.int32),
    layout: Layout,
    at: Approaches,
    law: Law,
    step: Increment,
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the pressures, and of the stiffnesses of the cells that are neither open nor capped.

    Third: the change of pressure that the cell nearest to it needs to open, close or reach the cap. As far as
    that the sum of the pressures is a straight line.
    """
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    base = at.base[patch]
    offset = at.offset[patch]
    cap = law.cap
    stiffness = step.stiffness
    parted = at.parts.shape[0] > 0
    vectors = layout.vectors
    tiles = (vectors + TILE_VECTORS - 1) // TILE_VECTORS
    pressure = Cells(ZERO)
    between = Cells(ZERO)
    nearest = Cells(ABSENT)
    beside = ABSENT  # of the tiles that are skipped
    for n in range(slot % slots_per_row, layout.lowest.shape[1], slots_per_row):
        overlap = (base - layout.lowest[patch, n]) + offset
        if overlap <= ZERO:
            beside = wp.min(beside, -overlap)
        else:
            line = n // tiles
            first = (n - line * tiles) * TILE_VECTORS
            last = line * vectors + wp.min(first + TILE_VECTORS, vectors)
            for k in range(line * vectors + first, last):
                g = gap_in[patch, k]
                p = Cells(ZERO)
                b = Cells(ZERO)
                near = Cells(ZERO)
                caps = Cells(cap)
                if parted:
                    caps = cap * at.parts[patch, k]
                for j in range(LANES):
                    q = ((base - g[j]) + offset) * stiffness
                    p[j] = wp.min(wp.max(q, ZERO), caps[j])
                    b[j] = wp.where(q > ZERO and q < caps[j], ONE, ZERO)
                    near[j] = wp.min(wp.abs(q), wp.abs(q - caps[j]))
                pressure += p
                between += b
                nearest = wp.min(nearest, near)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(between) * stiffness
    sums_out[2, slot] = wp.min(wp.min(nearest), beside * stiffness)


@wp.kernel
def pressures(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    patches_in: wp.array(dtype=wp.int32),
    at: Approaches,
    law: Law,
    step: Increment,
    gap_in: wp.array2d(dtype=Cells),
    pressure_out: wp.array2d(dtype=Cells),
):
    """The pressure field of solved approaches, in the patches visited."""
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    law_here = law
    law_here.base = at.base[patch]
    law_here.offset = at.offset[patch]
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[patch, k]
        part = Cells(ONE)
        if at.parts.shape[0] > 0:
            part = at.parts[patch, k]
        p = Cells(ZERO)
        for j in range(LANES):
            p[j] = wp.min(pressure_of(law_here, g[j], step.stiffness), law_here.cap * part[j])
        pressure_out[patch, k] = p


@wp.kernel
def wear_step(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    patches_in: wp.array(dtype=wp.int32),
    layout: Layout,
    at: Approaches,
    law: Law,
    step: Increment,
    initial_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    tables: Tables,
):
    """One increment of wear in place: the gap opens by K p ΔL of both bodies.

    Sums and maxima are those of the step and of each patch. A tile above the largest approach that its patch
    has had was never touched; every other one is visited, so that the sums of what was touched and worn are
    those of the whole patch. Rows and columns count in the domain.
    """
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    lane = slot % slots_per_row
    wear_patches(slot, slots_per_row, patch, layout, at, law, step, initial_in, gap_out, tables)
    here = law
    here.base = at.base[patch]
    here.offset = at.offset[patch]
    first_row = NO_INDEX + ZERO  # a variable of its own
    last_row = NO_INDEX + ZERO
    first_column = NO_INDEX + ZERO
    last_column = NO_INDEX + ZERO
    if tables.sums[WearSum.TOUCHED, slot] > ZERO:
        vectors = layout.vectors
        tiles = (vectors + TILE_VECTORS - 1) // TILE_VECTORS
        for n in range(lane, layout.lowest.shape[1], slots_per_row):
            low = layout.lowest[patch, n]
            line = n // tiles
            first = (n - line * tiles) * TILE_VECTORS
            last = wp.min(first + TILE_VECTORS, vectors)
            row = layout.first_row[patch] + line
            column = layout.first_column[patch]
            known = row >= step.first_row and row <= step.last_row
            known = known and column + first * LANES >= step.first_column
            known = known and column + last * LANES - 1 <= step.last_column
            if not known and (low < at.reached[patch] or (here.base - low) + here.offset > ZERO):
                for v in range(first, last):
                    g = gap_out[patch, line * vectors + v]
                    u = initial_in[patch, line * vectors + v]
                    for j in range(LANES):
                        # Where nothing wears the gap is as it was, and what touched does so still.
                        p = pressure_of(here, g[j], step.stiffness)
                        if p + (g[j] - u[j]) > ZERO:
                            place = wp.float64(column + v * LANES + j)
                            first_row = wp.max(first_row, -wp.float64(row))
                            last_row = wp.max(last_row, wp.float64(row))
                            first_column = wp.max(first_column, -place)
                            last_column = wp.max(last_column, place)
    tables.maxima[WearMost.FIRST_ROW, slot] = first_row
    tables.maxima[WearMost.LAST_ROW, slot] = last_row
    tables.maxima[WearMost.FIRST_COLUMN, slot] = first_column
    tables.maxima[WearMost.LAST_COLUMN, slot] = last_column
