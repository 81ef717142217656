"""Patches of a contact, each at an approach of its own: what they carry, their pressures, their wear.

All patches lie in one field of shape (patches, lines · vectors of a line): a row is a patch, its lines of
cells (along axis 1 of the domain) one after another, each padded to whole vectors. A tile is `types.WIDTH`
vectors of one line, or what is left of it. A slot is a place in the list of patches visited (one of several
that share a patch on a GPU); tiles whose lowest gap, before any wear, is above the patch's approach are
skipped.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, NOWHERE, ONE, WIDTH, ZERO, Cells, lowest_of, sum_of
from warpwear.kernels.contact import pressure_of
from warpwear.kernels.gap import sag
from warpwear.kernels.wear_loops import wear_patches

wp.set_module_options({"enable_backward": False})


@wp.kernel
def gap(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    vectors: wp.int32,
    columns: wp.int32,
    cell: wp.float64,
    x_first: wp.float64,
    y_first: wp.float64,
    curvature: wp.float64,
    first_row_in: wp.array(dtype=wp.int32),
    first_column_in: wp.array(dtype=wp.int32),
    roughness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
):
    """Gap of the unworn bodies from the mean planes, and its lowest in every tile.

    vectors, columns: of a line. x_first, y_first: the domain's first cell. first_row, first_column: of the
    domain's cells, where a patch begins.
    """
    slot = first_slot + wp.tid()
    patch = slot // slots_per_row
    tiles = (vectors + WIDTH - 1) // WIDTH
    for n in range(slot % slots_per_row, lowest_out.shape[1], slots_per_row):
        line = n // tiles
        first = (n - line * tiles) * WIDTH
        x = x_first + wp.float64(first_row_in[patch] + line) * cell
        low = Cells(ABSENT)
        for v in range(first, wp.min(first + WIDTH, vectors)):
            z = roughness_in[patch, line * vectors + v]
            g = Cells(ABSENT)
            for j in range(LANES):
                column = v * LANES + j
                y = y_first + wp.float64(first_column_in[patch] + column) * cell
                if column < columns:
                    g[j] = sag(x, y, curvature) - z[j]
            gap_out[patch, line * vectors + v] = g
            low = wp.min(low, g)
        lowest_out[patch, n] = lowest_of(low)


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    vectors: wp.int32,
    patches_in: wp.array(dtype=wp.int32),
    base_in: wp.array(dtype=wp.float64),
    offset_in: wp.array(dtype=wp.float64),
    cap: wp.float64,
    stiffness: wp.float64,
    lowest_in: wp.array2d(dtype=wp.float64),
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the pressures, and of the stiffnesses of the cells that are neither open nor capped.

    Third: the change of pressure that the cell nearest to it needs to open, close or reach the cap. As far as
    that the sum of the pressures is a straight line.
    """
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    base = base_in[patch]
    offset = offset_in[patch]
    tiles = (vectors + WIDTH - 1) // WIDTH
    pressure = Cells(ZERO)
    between = Cells(ZERO)
    nearest = Cells(ABSENT)
    beside = ABSENT  # of the tiles that are skipped
    for n in range(slot % slots_per_row, lowest_in.shape[1], slots_per_row):
        overlap = (base - lowest_in[patch, n]) + offset
        if overlap <= ZERO:
            beside = wp.min(beside, -overlap)
        else:
            line = n // tiles
            first = (n - line * tiles) * WIDTH
            last = line * vectors + wp.min(first + WIDTH, vectors)
            for k in range(line * vectors + first, last):
                g = gap_in[patch, k]
                p = Cells(ZERO)
                b = Cells(ZERO)
                near = Cells(ZERO)
                for j in range(LANES):
                    q = ((base - g[j]) + offset) * stiffness
                    p[j] = wp.min(wp.max(q, ZERO), cap)
                    b[j] = wp.where(q > ZERO and q < cap, ONE, ZERO)
                    near[j] = wp.min(wp.abs(q), wp.abs(q - cap))
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
    base_in: wp.array(dtype=wp.float64),
    offset_in: wp.array(dtype=wp.float64),
    cap: wp.float64,
    stiffness: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    pressure_out: wp.array2d(dtype=Cells),
):
    """The pressure field of solved approaches, in the patches visited."""
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[patch, k]
        p = Cells(ZERO)
        for j in range(LANES):
            p[j] = pressure_of((base_in[patch] - g[j]) + offset_in[patch], stiffness, cap, ZERO, ZERO)
        pressure_out[patch, k] = p


@wp.kernel
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    vectors: wp.int32,
    patches_in: wp.array(dtype=wp.int32),
    base_in: wp.array(dtype=wp.float64),
    offset_in: wp.array(dtype=wp.float64),
    reached_in: wp.array(dtype=wp.float64),
    base_next_in: wp.array(dtype=wp.float64),
    offset_next_in: wp.array(dtype=wp.float64),
    cap: wp.float64,
    stiffness: wp.float64,
    stiffness_next: wp.float64,
    removal: wp.float64,
    pressure_reference: wp.float64,
    first_row_known: wp.int32,
    last_row_known: wp.int32,
    first_column_known: wp.int32,
    last_column_known: wp.int32,
    first_row_in: wp.array(dtype=wp.int32),
    first_column_in: wp.array(dtype=wp.int32),
    lowest_in: wp.array2d(dtype=wp.float64),
    initial_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
    ahead_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: the gap opens by K p ΔL of both bodies (`removal` = K ΔL).

    Sums and maxima of the step and of each patch, a column a slot, in the order of `types.PATCH_SUMS` and
    `types.PATCH_MAXIMA`. Squares are those of the deviation from `pressure_reference`. reached: the largest
    approach that a patch has had: a tile above it was never touched, every other one is visited, so that the
    sums of what was touched and worn are those of the whole patch. *_known: rows and columns of the domain
    between which cells are known to be touched; only beyond them it is looked for the first and the last
    ones. first_row_in, first_column_in: of the domain's cells, where a patch begins. ahead_out: what
    `carried` would find in the worn gap at the approaches of `*_next`.
    """
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    lane = slot % slots_per_row
    base = base_in[patch]
    offset = offset_in[patch]
    reached = reached_in[patch]
    wear_patches(
        slot,
        slots_per_row,
        patch,
        lane,
        vectors,
        base,
        offset,
        reached,
        base_next_in[patch],
        offset_next_in[patch],
        cap,
        stiffness,
        stiffness_next,
        removal,
        pressure_reference,
        lowest_in,
        initial_in,
        gap_out,
        sums_out,
        maxima_out,
        ahead_out,
    )
    first_row = NOWHERE + ZERO  # a variable of its own
    last_row = NOWHERE + ZERO
    first_column = NOWHERE + ZERO
    last_column = NOWHERE + ZERO
    if sums_out[4, slot] > ZERO:
        tiles = (vectors + WIDTH - 1) // WIDTH
        for n in range(lane, lowest_in.shape[1], slots_per_row):
            low = lowest_in[patch, n]
            line = n // tiles
            first = (n - line * tiles) * WIDTH
            last = wp.min(first + WIDTH, vectors)
            row = first_row_in[patch] + line
            column = first_column_in[patch]
            known = row >= first_row_known and row <= last_row_known
            known = known and column + first * LANES >= first_column_known
            known = known and column + last * LANES - 1 <= last_column_known
            if not known and (low < reached or (base - low) + offset > ZERO):
                for v in range(first, last):
                    g = gap_out[patch, line * vectors + v]
                    u = initial_in[patch, line * vectors + v]
                    for j in range(LANES):
                        # Where nothing wears the gap is as it was, and what touched does so still.
                        p = pressure_of((base - g[j]) + offset, stiffness, cap, ZERO, ZERO)
                        if p + (g[j] - u[j]) > ZERO:
                            at = wp.float64(column + v * LANES + j)
                            first_row = wp.max(first_row, -wp.float64(row))
                            last_row = wp.max(last_row, wp.float64(row))
                            first_column = wp.max(first_column, -at)
                            last_column = wp.max(last_column, at)
    maxima_out[2, slot] = first_row
    maxima_out[3, slot] = last_row
    maxima_out[4, slot] = first_column
    maxima_out[5, slot] = last_column
