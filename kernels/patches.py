"""Patches of a contact, each at an approach of its own: what they carry, their pressures, their wear.

All patches lie in one field of shape (patches, lines · vectors of a line): a row is a patch, its lines of
cells (along axis 1 of the domain) one after another, each padded to whole vectors. A tile is `types.WIDTH`
vectors of one line, or what is left of it. A slot is a place in the list of patches visited (one of several
that share a patch on a GPU); tiles whose lowest gap, before any wear, is above the patch's approach are
skipped.
"""

import warp as wp

from warpwear.kernels.contact import pressure_of
from warpwear.kernels.gap import sag
from warpwear.kernels.reductions import lowest_of, sum_of
from warpwear.kernels.types import ABSENT, LANES, ONE, WIDTH, ZERO, Cells

wp.set_module_options({"enable_backward": False})

#: Stands for "no cell" among first and last indices.
NOWHERE = wp.constant(wp.float64(-1.0e9))
EIGHT = wp.constant(wp.int32(LANES))


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
    cap: wp.float64,
    stiffness: wp.float64,
    removal: wp.float64,
    pressure_reference: wp.float64,
    lowest_in: wp.array2d(dtype=wp.float64),
    initial_in: wp.array2d(dtype=Cells),
    columns: wp.int32,
    full_out: wp.array2d(dtype=wp.int32),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: the gap opens by K p ΔL of both bodies (`removal` = K ΔL).

    Sums and maxima of the step and of each patch, a column a slot, in the order of `types.PATCH_SUMS` and
    `types.PATCH_MAXIMA`. Squares are those of the deviation from `pressure_reference`. reached: the largest
    approach that a patch has had: a tile above it was never touched, every other one is visited, so that the
    sums of what was touched and worn are those of the whole patch. columns: of a line. full: 1 for tiles
    whose cells have all touched, of which no more is looked for; their extents were told when they became so.
    """
    slot = first_slot + wp.tid()
    patch = patches_in[slot // slots_per_row]
    base = base_in[patch]
    offset = offset_in[patch]
    reached = reached_in[patch]
    tiles = (vectors + WIDTH - 1) // WIDTH
    pressure = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    touched = Cells(ZERO)
    worn = Cells(ZERO)
    highest_pressure = Cells(ZERO)
    deepest = Cells(ZERO)
    from_first = Cells(ZERO)  # vectors from the first one touched to a line's end, 0 for none
    to_last = Cells(ZERO)  # vectors from a line's start to the last one touched, 0 for none
    first_line = NOWHERE
    last_line = NOWHERE
    in_full = ZERO  # cells of full tiles
    # What a cell does is written lane by lane, what is summed over cells vector by vector: see `removal`.
    for n in range(slot % slots_per_row, lowest_in.shape[1], slots_per_row):
        low = lowest_in[patch, n]
        if low < reached or (base - low) + offset > ZERO:
            line = n // tiles
            first = (n - line * tiles) * WIDTH
            cells = wp.float64(wp.min(WIDTH * EIGHT, columns - first * EIGHT))
            if full_out[patch, n] == 1:
                in_full += cells
                for v in range(first, wp.min(first + WIDTH, vectors)):
                    k = line * vectors + v
                    g = gap_out[patch, k]
                    initial = initial_in[patch, k]
                    p = Cells(ZERO)
                    d = Cells(ZERO)
                    w = Cells(ZERO)
                    is_contact = Cells(ZERO)
                    is_capped = Cells(ZERO)
                    for j in range(LANES):
                        q = wp.min(wp.max(((base - g[j]) + offset) * stiffness, ZERO), cap)
                        p[j] = q
                        g[j] = g[j] + removal * q
                        w[j] = g[j] - initial[j]
                        d[j] = wp.where(q > ZERO, q - pressure_reference, ZERO)
                        is_contact[j] = wp.where(q > ZERO, ONE, ZERO)
                        is_capped[j] = wp.where(q >= cap, ONE, ZERO)
                    gap_out[patch, k] = g
                    pressure += p
                    deviation += wp.cw_mul(d, d)
                    contact += is_contact
                    capped += is_capped
                    worn += w
                    highest_pressure = wp.max(highest_pressure, p)
                    deepest = wp.max(deepest, w)
                continue
            of_tile = Cells(ZERO)
            for v in range(first, wp.min(first + WIDTH, vectors)):
                k = line * vectors + v
                g = gap_out[patch, k]
                initial = initial_in[patch, k]
                p = Cells(ZERO)
                d = Cells(ZERO)
                w = Cells(ZERO)
                is_contact = Cells(ZERO)
                is_capped = Cells(ZERO)
                is_touched = Cells(ZERO)
                to_end = Cells(ZERO)
                from_start = Cells(ZERO)
                vectors_to_end = wp.float64(vectors - v)
                vectors_from_start = wp.float64(v + 1)
                for j in range(LANES):
                    q = wp.min(wp.max(((base - g[j]) + offset) * stiffness, ZERO), cap)
                    p[j] = q
                    g[j] = g[j] + removal * q
                    w[j] = g[j] - initial[j]
                    d[j] = wp.where(q > ZERO, q - pressure_reference, ZERO)
                    is_contact[j] = wp.where(q > ZERO, ONE, ZERO)
                    is_capped[j] = wp.where(q >= cap, ONE, ZERO)
                    ever = q + w[j] > ZERO
                    is_touched[j] = wp.where(ever, ONE, ZERO)
                    to_end[j] = wp.where(ever, vectors_to_end, ZERO)
                    from_start[j] = wp.where(ever, vectors_from_start, ZERO)
                gap_out[patch, k] = g
                pressure += p
                deviation += wp.cw_mul(d, d)
                contact += is_contact
                capped += is_capped
                of_tile += is_touched
                worn += w
                highest_pressure = wp.max(highest_pressure, p)
                deepest = wp.max(deepest, w)
                from_first = wp.max(from_first, to_end)
                to_last = wp.max(to_last, from_start)
            touched += of_tile
            count = sum_of(of_tile)
            full_out[patch, n] = wp.where(count == cells, 1, 0)
            here = count > ZERO
            first_line = wp.max(first_line, wp.where(here, -wp.float64(line), NOWHERE))
            last_line = wp.max(last_line, wp.where(here, wp.float64(line), NOWHERE))
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(deviation)
    sums_out[2, slot] = sum_of(contact)
    sums_out[3, slot] = sum_of(capped)
    sums_out[4, slot] = sum_of(touched) + in_full
    sums_out[5, slot] = sum_of(worn)
    first_column = NOWHERE
    last_column = NOWHERE
    for j in range(LANES):
        if to_last[j] > ZERO:
            first_vector = wp.float64(vectors) - from_first[j]
            last_vector = to_last[j] - ONE
            first_column = wp.max(first_column, -(first_vector * wp.float64(LANES) + wp.float64(j)))
            last_column = wp.max(last_column, last_vector * wp.float64(LANES) + wp.float64(j))
    maxima_out[0, slot] = wp.max(highest_pressure)
    maxima_out[1, slot] = wp.max(deepest)
    maxima_out[2, slot] = first_line
    maxima_out[3, slot] = last_line
    maxima_out[4, slot] = first_column
    maxima_out[5, slot] = last_column
