"""Archard removal from the cells of patches by a stored pressure, and what the step did to each patch."""

import warp as wp

from warpwear.kernels.cells import LANES, NO_INDEX, ONE, ZERO, Cells, largest_of, sum_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def remove(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    vectors: wp.int32,
    cap: wp.float64,
    removal: wp.float64,
    pressure_reference: wp.float64,
    first_row_in: wp.array(dtype=wp.int32),
    first_column_in: wp.array(dtype=wp.int32),
    pressure_in: wp.array2d(dtype=Cells),
    initial_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: the gap opens by K p ΔL of both bodies (`removal` = K ΔL).

    Patches are stored, and sums and maxima ordered, as `patches.remove` has them. vectors: of a line.
    first_row_in, first_column_in: of the domain's cells, where a patch begins.
    """
    slot = first_slot + wp.tid()
    patch = slot // slots_per_row
    pressure = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    touched = Cells(ZERO)
    worn = Cells(ZERO)
    highest = Cells(ZERO)
    deepest = Cells(ZERO)
    first = Cells(NO_INDEX)
    last = Cells(NO_INDEX)
    first_row = NO_INDEX + ZERO  # variables of their own
    last_row = NO_INDEX + ZERO
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        line = k // vectors
        row = wp.float64(first_row_in[patch] + line)
        p = pressure_in[patch, k]
        u = initial_in[patch, k]
        g = gap_out[patch, k]
        reached_here = Cells(ZERO)
        for j in range(LANES):
            g[j] += removal * p[j]
            w = g[j] - u[j]
            d = wp.where(p[j] > ZERO, p[j] - pressure_reference, ZERO)
            deviation[j] += d * d
            contact[j] += wp.where(p[j] > ZERO, ONE, ZERO)
            capped[j] += wp.where(p[j] >= cap, ONE, ZERO)
            reached = p[j] > ZERO or w > ZERO
            column = wp.float64(first_column_in[patch] + (k - line * vectors) * LANES + j)
            reached_here[j] = wp.where(reached, ONE, ZERO)
            first[j] = wp.max(first[j], wp.where(reached, -column, NO_INDEX))
            last[j] = wp.max(last[j], wp.where(reached, column, NO_INDEX))
            worn[j] += w
            highest[j] = wp.max(highest[j], p[j])
            deepest[j] = wp.max(deepest[j], w)
        gap_out[patch, k] = g
        pressure += p
        touched += reached_here
        if wp.max(reached_here) > ZERO:
            first_row = wp.max(first_row, -row)
            last_row = wp.max(last_row, row)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(deviation)
    sums_out[2, slot] = sum_of(contact)
    sums_out[3, slot] = sum_of(capped)
    sums_out[4, slot] = sum_of(touched)
    sums_out[5, slot] = sum_of(worn)
    maxima_out[0, slot] = largest_of(highest)
    maxima_out[1, slot] = largest_of(deepest)
    maxima_out[2, slot] = first_row
    maxima_out[3, slot] = last_row
    maxima_out[4, slot] = largest_of(first)
    maxima_out[5, slot] = largest_of(last)
