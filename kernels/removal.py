"""Archard removal from both bodies, cell by cell, and the figures of the step that wore them."""

import warp as wp

from warpwear.kernels.contact import pressure_of
from warpwear.kernels.reductions import sum_of
from warpwear.kernels.types import LANES, ONE, WIDTH, ZERO, Cells, Kept

wp.set_module_options({"enable_backward": False})

#: Stands for "no cell" among first and last indices.
NOWHERE = wp.constant(wp.float64(-1.0e9))


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
    stiffness_in: wp.array2d(dtype=Cells),
    distance_factor_in: wp.array2d(dtype=Cells),
    rest_in: wp.array(dtype=Kept),
    gap_out: wp.array2d(dtype=Cells),
    wear_sphere_out: wp.array2d(dtype=Cells),
    wear_disc_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: each body loses K p ΔL (`removal_*` = K ΔL), the gap opens by both.

    Sums and maxima of the step, a column a slot, in the order of `types.SUMS` and `types.MAXIMA`. Squares are
    those of the deviation from `pressure_reference`, which keeps the scatter of nearly equal pressures.
    rest_in: of the tiles of each row that are not listed.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    lane = slot % slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    factor_row = wp.min(row, distance_factor_in.shape[0] - 1)

    rest = rest_in[row]
    share = wp.where(lane == 0, ONE, ZERO)
    if lane >= count_in[row]:  # nothing to do: most rows of an early contact
        for i in range(5):
            sums_out[i, slot] = ZERO
            maxima_out[i, slot] = ZERO
        for i in range(3):
            sums_out[5 + i, slot] = share * rest[i]
        for i in range(3, 7):
            maxima_out[i, slot] = NOWHERE
        return

    vectors = gap_out.shape[1]
    pressure = Cells(ZERO)
    factored = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    touched = Cells(ZERO)
    worn_sphere = Cells(ZERO)
    worn_disc = Cells(ZERO)
    highest_pressure = Cells(ZERO)
    deepest_sphere = Cells(ZERO)
    deepest_disc = Cells(ZERO)
    from_first = Cells(ZERO)  # vectors from the first one touched to the row's end, 0 for none
    to_last = Cells(ZERO)  # vectors from the row's start to the last one touched, 0 for none

    # What a cell does is written lane by lane, what is summed over cells vector by vector: only so does the
    # compiler keep all these sums in SIMD registers (half the time of sums written lane by lane; a product of
    # a vector and a scalar here doubles it: measure with bench/speed.py after a change).
    for n in range(lane, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, vectors)):
            s = stiffness_in[stiffness_row, k]
            f = distance_factor_in[factor_row, k]
            g = gap_out[row, k]
            a = wear_sphere_out[row, k]
            b = wear_disc_out[row, k]
            p = Cells(ZERO)
            d = Cells(ZERO)
            is_contact = Cells(ZERO)
            is_capped = Cells(ZERO)
            is_touched = Cells(ZERO)
            to_end = Cells(ZERO)
            from_start = Cells(ZERO)
            vectors_to_end = wp.float64(vectors - k)
            vectors_from_start = wp.float64(k + 1)
            for j in range(LANES):
                q = pressure_of((base - g[j]) + offset, s[j], cap, tie_width, tie_pressure)
                da = removal_sphere * q
                db = removal_disc * f[j] * q
                p[j] = q
                g[j] = g[j] + (da + db)
                a[j] = a[j] + da
                b[j] = b[j] + db
                d[j] = wp.where(q > ZERO, q - pressure_reference, ZERO)
                is_contact[j] = wp.where(q > ZERO, ONE, ZERO)
                is_capped[j] = wp.where(q >= cap, ONE, ZERO)
                ever = q + a[j] + b[j] > ZERO
                is_touched[j] = wp.where(ever, ONE, ZERO)
                to_end[j] = wp.where(ever, vectors_to_end, ZERO)
                from_start[j] = wp.where(ever, vectors_from_start, ZERO)
            gap_out[row, k] = g
            wear_sphere_out[row, k] = a
            wear_disc_out[row, k] = b
            pressure += p
            factored += wp.cw_mul(f, p)
            deviation += wp.cw_mul(d, d)
            contact += is_contact
            capped += is_capped
            touched += is_touched
            worn_sphere += a
            worn_disc += b
            highest_pressure = wp.max(highest_pressure, p)
            deepest_sphere = wp.max(deepest_sphere, a)
            deepest_disc = wp.max(deepest_disc, b)
            from_first = wp.max(from_first, to_end)
            to_last = wp.max(to_last, from_start)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(factored)
    sums_out[2, slot] = sum_of(deviation)
    sums_out[3, slot] = sum_of(contact)
    sums_out[4, slot] = sum_of(capped)
    sums_out[5, slot] = sum_of(touched) + share * rest[0]
    sums_out[6, slot] = sum_of(worn_sphere) + share * rest[1]
    sums_out[7, slot] = sum_of(worn_disc) + share * rest[2]
    first_column = NOWHERE
    last_column = NOWHERE
    for j in range(LANES):
        if to_last[j] > ZERO:
            first_vector = wp.float64(vectors) - from_first[j]
            last_vector = to_last[j] - ONE
            first_column = wp.max(first_column, -(first_vector * wp.float64(LANES) + wp.float64(j)))
            last_column = wp.max(last_column, last_vector * wp.float64(LANES) + wp.float64(j))
    here = sum_of(touched) > ZERO
    maxima_out[0, slot] = wp.max(highest_pressure)
    maxima_out[1, slot] = wp.max(deepest_sphere)
    maxima_out[2, slot] = wp.max(deepest_disc)
    maxima_out[3, slot] = wp.where(here, -wp.float64(row), NOWHERE)
    maxima_out[4, slot] = wp.where(here, wp.float64(row), NOWHERE)
    maxima_out[5, slot] = first_column
    maxima_out[6, slot] = last_column
