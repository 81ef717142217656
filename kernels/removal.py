"""Archard removal from both bodies, cell by cell, and the figures of the step that wore them."""

import warp as wp

from warpwear.kernels.contact import pressure_of
from warpwear.kernels.types import LANES, ONE, ZERO, Cells

wp.set_module_options({"enable_backward": False})

#: Stands for "no cell" among first and last indices.
NOWHERE = wp.constant(wp.float64(-1.0e9))


@wp.kernel
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
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
    gap_out: wp.array2d(dtype=Cells),
    wear_sphere_out: wp.array2d(dtype=Cells),
    wear_disc_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: each body loses K p ΔL (`removal_*` = K ΔL), the gap opens by both.

    Sums and maxima of the step, a row a slot, in the order of `types.SUMS` and `types.MAXIMA`. Squares are
    those of the deviation from `pressure_reference`, which keeps the scatter of nearly equal pressures.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    factor_row = wp.min(row, distance_factor_in.shape[0] - 1)

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
    first = Cells(NOWHERE)
    last = Cells(NOWHERE)

    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        s = stiffness_in[stiffness_row, k]
        f = distance_factor_in[factor_row, k]
        g = gap_out[row, k]
        a = wear_sphere_out[row, k]
        b = wear_disc_out[row, k]
        for j in range(LANES):
            p = pressure_of((base - g[j]) + offset, s[j], cap, tie_width, tie_pressure)
            da = removal_sphere * p
            db = removal_disc * f[j] * p
            g[j] = g[j] + (da + db)
            a[j] = a[j] + da
            b[j] = b[j] + db
            d = wp.where(p > ZERO, p - pressure_reference, ZERO)
            ever = p + a[j] + b[j] > ZERO
            pressure[j] = pressure[j] + p
            factored[j] = factored[j] + f[j] * p
            deviation[j] = deviation[j] + d * d
            contact[j] = contact[j] + wp.where(p > ZERO, ONE, ZERO)
            capped[j] = capped[j] + wp.where(p >= cap, ONE, ZERO)
            touched[j] = touched[j] + wp.where(ever, ONE, ZERO)
            worn_sphere[j] = worn_sphere[j] + a[j]
            worn_disc[j] = worn_disc[j] + b[j]
            highest_pressure[j] = wp.max(highest_pressure[j], p)
            deepest_sphere[j] = wp.max(deepest_sphere[j], a[j])
            deepest_disc[j] = wp.max(deepest_disc[j], b[j])
            first[j] = wp.max(first[j], wp.where(ever, -wp.float64(k), NOWHERE))
            last[j] = wp.max(last[j], wp.where(ever, wp.float64(k), NOWHERE))
        gap_out[row, k] = g
        wear_sphere_out[row, k] = a
        wear_disc_out[row, k] = b

    total = Cells(ZERO)
    first_column = NOWHERE
    last_column = NOWHERE
    for j in range(LANES):
        total[0] = total[0] + pressure[j]
        total[1] = total[1] + factored[j]
        total[2] = total[2] + deviation[j]
        total[3] = total[3] + contact[j]
        total[4] = total[4] + capped[j]
        total[5] = total[5] + touched[j]
        total[6] = total[6] + worn_sphere[j]
        total[7] = total[7] + worn_disc[j]
        lane = wp.float64(j)
        width = wp.float64(LANES)
        if last[j] >= ZERO:
            first_column = wp.max(first_column, first[j] * width - lane)
            last_column = wp.max(last_column, last[j] * width + lane)
    for column in range(sums_out.shape[1]):
        sums_out[slot, column] = total[column]
    here = total[5] > ZERO
    maxima_out[slot, 0] = wp.max(highest_pressure)
    maxima_out[slot, 1] = wp.max(deepest_sphere)
    maxima_out[slot, 2] = wp.max(deepest_disc)
    maxima_out[slot, 3] = wp.where(here, -wp.float64(row), NOWHERE)
    maxima_out[slot, 4] = wp.where(here, wp.float64(row), NOWHERE)
    maxima_out[slot, 5] = first_column
    maxima_out[slot, 6] = last_column
