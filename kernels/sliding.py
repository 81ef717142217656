"""A disc displaced under the sphere by whole cells: which tiles can touch, their gap, and the wear of both.

Heights of the sphere and of the disc are kept apart, as worn. Below the sphere's row i lies the disc's row
i + shift, modulo the disc's length: the same vectors of another row, so nothing is copied. Of every tile of
the sphere the lowest height is kept and of every tile of the disc the highest, eight tiles in one vector like
the cells of a field; their difference bounds the gap of a pair of tiles from below.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, NOWHERE, ONE, WIDTH, ZERO, Cells, lowest_of, sum_of
from warpwear.kernels.contact import pressure_of

wp.set_module_options({"enable_backward": False})

#: No depth is larger: of a disc that springs back.
INFINITE = wp.constant(wp.float64(1.0e300))


@wp.func
def beneath(row: wp.int32, shift: wp.int32, rows: wp.int32):
    """The disc's row under a row of the sphere; 0 ≤ shift < rows."""
    displaced = row + shift
    return wp.where(displaced < rows, displaced, displaced - rows)


@wp.kernel
def bounds(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    height_in: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
    highest_out: wp.array2d(dtype=wp.float64),
):
    """Lowest and highest height of every tile of a body; nothing for places beyond the last tile."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for t in range(slot % slots_per_row, lowest_out.shape[1], slots_per_row):
        low = Cells(ABSENT)
        high = Cells(-ABSENT)
        for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, height_in.shape[1])):
            low = wp.min(low, height_in[row, k])
            high = wp.max(high, height_in[row, k])
        lowest_out[row, t] = lowest_of(low)
        highest_out[row, t] = wp.max(high)


@wp.kernel
def select(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    limit: wp.float64,
    shift: wp.int32,
    lowest_of_eight_in: wp.array2d(dtype=wp.float64),
    highest_of_row_in: wp.array(dtype=wp.float64),
    lowest_in: wp.array2d(dtype=Cells),
    highest_in: wp.array2d(dtype=Cells),
    sphere_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    list_out: wp.array2d(dtype=wp.int32),
    count_out: wp.array(dtype=wp.int32),
):
    """Lists, row by row, the tiles with a gap that does not exceed the limit, and writes their gaps.

    Where the bounds of a pair of tiles let it touch, its gap is made and decides: a list holds no tile too
    many. Gaps of tiles that are not listed are left as they are. `lowest_of_eight_in`: of neighbouring tiles
    of the sphere; with the highest of the disc's row it spares most bounds. Either may be out of date: wear
    only lifts the one and lowers the other.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0:  # a list is written in order, by one slot
        return
    under = beneath(row, shift, disc_in.shape[0])
    highest = highest_of_row_in[under]
    count = wp.int32(0)
    for m in range(lowest_in.shape[1]):
        if lowest_of_eight_in[row, m] - highest <= limit:
            bound = lowest_in[row, m] - highest_in[under, m]
            if lowest_of(bound) <= limit:
                for j in range(LANES):
                    t = m * LANES + j
                    if bound[j] <= limit and t * WIDTH < gap_out.shape[1]:
                        low = Cells(ABSENT)
                        for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, gap_out.shape[1])):
                            g = sphere_in[row, k] - disc_in[under, k]
                            gap_out[row, k] = g
                            low = wp.min(low, g)
                        if lowest_of(low) <= limit:
                            list_out[row, count] = t
                            count += 1
    count_out[row] = count


@wp.kernel
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    base: wp.float64,
    offset: wp.float64,
    cap: wp.float64,
    tie_width: wp.float64,
    tie_pressure: wp.float64,
    removal_sphere: wp.float64,
    removal_disc: wp.float64,
    pressure_reference: wp.float64,
    shift: wp.int32,
    first_known: wp.int32,
    last_known: wp.int32,
    full_depth: wp.float64,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sphere_out: wp.array2d(dtype=Cells),
    disc_out: wp.array2d(dtype=Cells),
    wear_sphere_out: wp.array2d(dtype=Cells),
    wear_disc_out: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
    highest_out: wp.array2d(dtype=wp.float64),
    touched_out: wp.array2d(dtype=wp.float64),
    worn_sphere_out: wp.array2d(dtype=wp.float64),
    worn_disc_out: wp.array2d(dtype=wp.float64),
    plastic_disc_out: wp.array2d(dtype=Cells),
    pressed_disc_out: wp.array2d(dtype=wp.float64),
    reached_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: each body loses K p ΔL (`removal_*` = K ΔL).

    full_depth: overlap c H at which a cell is at the hardness [mm]. What goes beyond it is displaced from the
    disc for good, into `plastic_disc_out` (its sums over tiles into `pressed_disc_out`), not worn. INFINITE:
    the disc springs back, and those two are not looked at.

    reached_out: 1 where the contact has been, of a sphere that does not wear; of one whose wear shows it one
    row, which is not looked at.

    Of the tiles listed, the bounds and what `totals` sums are made anew from their cells: cells of the
    sphere ever touched, wear of the sphere, wear of the disc. Sums of the step in the order of `types.STEP`,
    maxima in that of `types.STEP_MAXIMA`, where columns count that lie beyond the known ones.
    The gap of the tiles listed gives way to their pressure.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    lane = slot % slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    under = beneath(row, shift, disc_out.shape[0])
    vectors = gap_out.shape[1]

    if lane >= count_in[row]:  # nothing to do: most rows
        for i in range(4):
            sums_out[i, slot] = ZERO
        for i in range(3):
            maxima_out[i, slot] = ZERO
        for i in range(3, 5):
            maxima_out[i, slot] = NOWHERE
        return

    pressure = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    highest_pressure = Cells(ZERO)
    deepest_sphere = Cells(ZERO)
    deepest_disc = Cells(ZERO)
    first_column = NOWHERE
    last_column = NOWHERE

    for n in range(lane, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        first = t * WIDTH
        end = wp.min(first + WIDTH, vectors)
        if full_depth < INFINITE:
            pressed = Cells(ZERO)
            for k in range(first, end):
                g = gap_out[row, k]
                d = disc_out[under, k]
                x = plastic_disc_out[under, k]
                for j in range(LANES):
                    beyond = wp.max(((base - g[j]) + offset) - full_depth, ZERO)
                    d[j] = d[j] - beyond
                    x[j] = x[j] + beyond
                disc_out[under, k] = d
                plastic_disc_out[under, k] = x
                pressed += x
            pressed_disc_out[under, t] = sum_of(pressed)
        for k in range(first, end):
            stiffness = stiffness_in[stiffness_row, k]
            g = gap_out[row, k]
            s = sphere_out[row, k]
            d = disc_out[under, k]
            a = wear_sphere_out[row, k]
            b = wear_disc_out[under, k]
            p = Cells(ZERO)
            for j in range(LANES):
                q = pressure_of((base - g[j]) + offset, stiffness[j], cap, tie_width, tie_pressure)
                da = removal_sphere * q
                db = removal_disc * q
                p[j] = q
                s[j] = s[j] + da
                a[j] = a[j] + da
                d[j] = d[j] - db
                b[j] = b[j] + db
            gap_out[row, k] = p
            sphere_out[row, k] = s
            disc_out[under, k] = d
            wear_sphere_out[row, k] = a
            wear_disc_out[under, k] = b
        low = Cells(ABSENT)
        high = Cells(-ABSENT)
        worn_sphere = Cells(ZERO)
        worn_disc = Cells(ZERO)
        for k in range(first, end):
            low = wp.min(low, sphere_out[row, k])
            high = wp.max(high, disc_out[under, k])
            a = wear_sphere_out[row, k]
            b = wear_disc_out[under, k]
            worn_sphere += a
            worn_disc += b
            deepest_sphere = wp.max(deepest_sphere, a)
            deepest_disc = wp.max(deepest_disc, b)
        lowest_out[row, t] = lowest_of(low)
        highest_out[under, t] = wp.max(high)
        worn_sphere_out[row, t] = sum_of(worn_sphere)
        worn_disc_out[under, t] = sum_of(worn_disc)
        touched = Cells(ZERO)
        for k in range(first, end):
            p = gap_out[row, k]
            a = wear_sphere_out[row, k]
            if reached_out.shape[0] == gap_out.shape[0]:
                a = reached_out[row, k]
            from_reference = Cells(ZERO)
            is_contact = Cells(ZERO)
            is_capped = Cells(ZERO)
            is_touched = Cells(ZERO)
            for j in range(LANES):
                from_reference[j] = wp.where(p[j] > ZERO, p[j] - pressure_reference, ZERO)
                is_contact[j] = wp.where(p[j] > ZERO, ONE, ZERO)
                is_capped[j] = wp.where(p[j] >= cap, ONE, ZERO)
                is_touched[j] = wp.where(p[j] + a[j] > ZERO, ONE, ZERO)
            highest_pressure = wp.max(highest_pressure, p)
            pressure += p
            deviation += wp.cw_mul(from_reference, from_reference)
            contact += is_contact
            capped += is_capped
            touched += is_touched
            if reached_out.shape[0] == gap_out.shape[0]:
                reached_out[row, k] = is_touched
        touched_out[row, t] = sum_of(touched)
        # Extents are known up to tiles that lie beyond them: all but a few of the first steps'.
        if first * LANES < first_known or end * LANES - 1 > last_known:
            for k in range(first, end):
                p = gap_out[row, k]
                a = wear_sphere_out[row, k]
                for j in range(LANES):
                    if p[j] + a[j] > ZERO:
                        column = wp.float64(k * LANES + j)
                        first_column = wp.max(first_column, -column)
                        last_column = wp.max(last_column, column)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(deviation)
    sums_out[2, slot] = sum_of(contact)
    sums_out[3, slot] = sum_of(capped)
    maxima_out[0, slot] = wp.max(highest_pressure)
    maxima_out[1, slot] = wp.max(deepest_sphere)
    maxima_out[2, slot] = wp.max(deepest_disc)
    maxima_out[3, slot] = first_column
    maxima_out[4, slot] = last_column


@wp.kernel
def totals(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    shift: wp.int32,
    touched_in: wp.array2d(dtype=Cells),
    worn_sphere_in: wp.array2d(dtype=Cells),
    worn_disc_in: wp.array2d(dtype=Cells),
    pressed_disc_in: wp.array2d(dtype=Cells),
    touched_out: wp.array(dtype=wp.float64),
    worn_sphere_out: wp.array(dtype=wp.float64),
    worn_disc_out: wp.array(dtype=wp.float64),
    pressed_disc_out: wp.array(dtype=wp.float64),
):
    """Sums over the rows with listed tiles, of the sphere and of the disc beneath it.

    Sums over the fields as they are: increments added up would drift. pressed_disc_in: of a disc that springs
    back one row, which is not looked at.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0 or count_in[row] == 0:
        return
    under = beneath(row, shift, worn_disc_in.shape[0])
    touched = Cells(ZERO)
    worn_sphere = Cells(ZERO)
    worn_disc = Cells(ZERO)
    if pressed_disc_in.shape[0] == worn_disc_in.shape[0]:
        pressed = Cells(ZERO)
        for m in range(touched_in.shape[1]):
            pressed += pressed_disc_in[under, m]
        pressed_disc_out[under] = sum_of(pressed)
    for m in range(touched_in.shape[1]):
        touched += touched_in[row, m]
        worn_sphere += worn_sphere_in[row, m]
        worn_disc += worn_disc_in[under, m]
    touched_out[row] = sum_of(touched)
    worn_sphere_out[row] = sum_of(worn_sphere)
    worn_disc_out[under] = sum_of(worn_disc)
