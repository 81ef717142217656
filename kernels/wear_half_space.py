"""Archard removal from both bodies by a stored pressure, and the figures of the step that wore them."""

import warp as wp

from warpwear.kernels.cells import LANES, NOWHERE, ONE, ZERO, Cells, largest_of, sum_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    cap: wp.float64,
    removal_sphere: wp.float64,
    removal_disc: wp.float64,
    pressure_reference: wp.float64,
    share_changes: wp.int32,
    pressure_in: wp.array2d(dtype=Cells),
    unworn_in: wp.array2d(dtype=Cells),
    share_out: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place, as `removal.remove` of every cell, with the same sums and maxima.

    share_changes: 1 where sphere and disc do not wear in proportion, so that the share is a field.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    share_row = wp.min(row, share_out.shape[0] - 1)
    pressure = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    touched = Cells(ZERO)
    worn_sphere = Cells(ZERO)
    worn_disc = Cells(ZERO)
    highest = Cells(ZERO)
    deepest_sphere = Cells(ZERO)
    deepest_disc = Cells(ZERO)
    first = Cells(NOWHERE)
    last = Cells(NOWHERE)
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        p = pressure_in[row, k]
        u = unworn_in[row, k]
        g = gap_out[row, k]
        h = share_out[share_row, k]
        for j in range(LANES):
            before = g[j] - u[j]
            g[j] += (removal_sphere + removal_disc) * p[j]
            w = g[j] - u[j]
            if share_changes == 1:
                h[j] = wp.where(w > ZERO, (h[j] * before + removal_sphere * p[j]) / w, ZERO)
            a = h[j] * w
            b = w - a
            pressure[j] += p[j]
            d = wp.where(p[j] > ZERO, p[j] - pressure_reference, ZERO)
            deviation[j] += d * d
            contact[j] += wp.where(p[j] > ZERO, ONE, ZERO)
            capped[j] += wp.where(p[j] >= cap, ONE, ZERO)
            reached = p[j] > ZERO or w > ZERO
            column = wp.float64(k * LANES + j)
            touched[j] += wp.where(reached, ONE, ZERO)
            first[j] = wp.max(first[j], wp.where(reached, -column, NOWHERE))
            last[j] = wp.max(last[j], wp.where(reached, column, NOWHERE))
            worn_sphere[j] += a
            worn_disc[j] += b
            highest[j] = wp.max(highest[j], p[j])
            deepest_sphere[j] = wp.max(deepest_sphere[j], a)
            deepest_disc[j] = wp.max(deepest_disc[j], b)
        gap_out[row, k] = g
        if share_changes == 1:
            share_out[row, k] = h
    total = sum_of(pressure)
    reached_here = sum_of(touched)
    sums_out[0, slot] = total
    sums_out[1, slot] = total  # every cell slides as far
    sums_out[2, slot] = sum_of(deviation)
    sums_out[3, slot] = sum_of(contact)
    sums_out[4, slot] = sum_of(capped)
    sums_out[5, slot] = reached_here
    sums_out[6, slot] = sum_of(worn_sphere)
    sums_out[7, slot] = sum_of(worn_disc)
    maxima_out[0, slot] = largest_of(highest)
    maxima_out[1, slot] = largest_of(deepest_sphere)
    maxima_out[2, slot] = largest_of(deepest_disc)
    maxima_out[3, slot] = wp.where(reached_here > ZERO, -wp.float64(row), NOWHERE)
    maxima_out[4, slot] = wp.where(reached_here > ZERO, wp.float64(row), NOWHERE)
    maxima_out[5, slot] = largest_of(first)
    maxima_out[6, slot] = largest_of(last)
