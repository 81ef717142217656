"""Archard removal from both bodies, cell by cell, and the figures of the step that wore them.

Both bodies open one gap. What is worn of them together is the gap less the gap of the bodies as they were;
`share` says how much of it was the sphere's.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, NOWHERE, ONE, WIDTH, ZERO, Cells, Kept
from warpwear.kernels.contact import pressure_of
from warpwear.kernels.wear_loops import wear

wp.set_module_options({"enable_backward": False})


@wp.kernel
def divide(
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
    stiffness_in: wp.array2d(dtype=Cells),
    distance_factor_in: wp.array2d(dtype=Cells),
    unworn_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    share_out: wp.array2d(dtype=Cells),
):
    """The sphere's share in what is worn after the next `remove`, where the two do not wear in proportion."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    factor_row = wp.min(row, distance_factor_in.shape[0] - 1)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            f = distance_factor_in[factor_row, k]
            u = unworn_in[row, k]
            g = gap_in[row, k]
            h = share_out[row, k]
            for j in range(LANES):
                q = pressure_of((base - g[j]) + offset, s[j], cap, tie_width, tie_pressure)
                before = g[j] - u[j]
                after = before + (removal_sphere + removal_disc * f[j]) * q
                sphere = h[j] * before + removal_sphere * q
                h[j] = wp.where(after > ZERO, sphere / after, ZERO)
            share_out[row, k] = h


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
    base_next: wp.float64,
    offset_next: wp.float64,
    alike: wp.int32,
    first_known: wp.int32,
    last_known: wp.int32,
    stiffness_in: wp.array2d(dtype=Cells),
    stiffness_next_in: wp.array2d(dtype=Cells),
    distance_factor_in: wp.array2d(dtype=Cells),
    share_in: wp.array2d(dtype=Cells),
    unworn_in: wp.array2d(dtype=Cells),
    rest_in: wp.array(dtype=Kept),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
    ahead_out: wp.array2d(dtype=wp.float64),
):
    """One increment of wear in place: each body loses K p ΔL (`removal_*` = K ΔL), the gap opens by both.

    Sums and maxima of the step, a column a slot, in the order of `types.SUMS` and `types.MAXIMA`. Squares are
    those of the deviation from `pressure_reference`, which keeps the scatter of nearly equal pressures.
    alike: 1 where every cell has the same stiffness, share and a factor of 1. *_known: columns between which
    cells are known to be touched; only beyond them it is looked for the first and the last one. share_in: of
    the sphere in what is worn, after this step. rest_in: of the tiles of each row that are not listed.
    ahead_out: what `contact.carried` would find in the worn gap at the approach of `*_next`.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    lane = slot % slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    next_row = wp.min(row, stiffness_next_in.shape[0] - 1)
    factor_row = wp.min(row, distance_factor_in.shape[0] - 1)
    share_row = wp.min(row, share_in.shape[0] - 1)

    rest = rest_in[row]
    part = wp.where(lane == 0, ONE, ZERO)
    if lane >= count_in[row]:  # nothing to do: most rows of an early contact
        for i in range(5):
            sums_out[i, slot] = ZERO
            maxima_out[i, slot] = ZERO
        for i in range(3):
            sums_out[5 + i, slot] = part * rest[i]
        for i in range(3, 7):
            maxima_out[i, slot] = NOWHERE
        ahead_out[0, slot] = ZERO
        ahead_out[1, slot] = ZERO
        ahead_out[2, slot] = ABSENT
        return
    wear(
        slot,
        slots_per_row,
        row,
        lane,
        stiffness_row,
        next_row,
        factor_row,
        share_row,
        tiles_in,
        count_in,
        base,
        offset,
        cap,
        tie_width,
        tie_pressure,
        removal_sphere,
        removal_disc,
        pressure_reference,
        base_next,
        offset_next,
        alike,
        stiffness_in,
        stiffness_next_in,
        distance_factor_in,
        share_in,
        unworn_in,
        gap_out,
        sums_out,
        maxima_out,
        ahead_out,
    )
    here = sums_out[5, slot] > ZERO
    for i in range(3):
        sums_out[5 + i, slot] = sums_out[5 + i, slot] + part * rest[i]
    first_column = NOWHERE + ZERO  # a variable of its own
    last_column = NOWHERE + ZERO
    vectors = gap_out.shape[1]
    if here:
        n = lane
        while (
            n < count_in[row] and first_column == NOWHERE and tiles_in[row, n] * WIDTH * LANES < first_known
        ):
            t = tiles_in[row, n]
            for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, vectors)):
                s = stiffness_in[stiffness_row, k]
                g = gap_out[row, k]
                u = unworn_in[row, k]
                for j in range(LANES):
                    # Where nothing wears the gap is as it was, and what touched does so still.
                    p = pressure_of((base - g[j]) + offset, s[j], cap, tie_width, tie_pressure)
                    if first_column == NOWHERE and p + (g[j] - u[j]) > ZERO:
                        first_column = -wp.float64(k * LANES + j)
            n += slots_per_row
        n = lane + (count_in[row] - 1 - lane) // slots_per_row * slots_per_row
        while n >= 0 and last_column == NOWHERE and (tiles_in[row, n] + 1) * WIDTH * LANES > last_known + 1:
            t = tiles_in[row, n]
            for k in range(t * WIDTH, wp.min((t + 1) * WIDTH, vectors)):
                s = stiffness_in[stiffness_row, k]
                g = gap_out[row, k]
                u = unworn_in[row, k]
                for j in range(LANES):
                    p = pressure_of((base - g[j]) + offset, s[j], cap, tie_width, tie_pressure)
                    if p + (g[j] - u[j]) > ZERO:
                        last_column = wp.float64(k * LANES + j)
            n -= slots_per_row
    maxima_out[3, slot] = wp.where(here, -wp.float64(row), NOWHERE)
    maxima_out[4, slot] = wp.where(here, wp.float64(row), NOWHERE)
    maxima_out[5, slot] = first_column
    maxima_out[6, slot] = last_column
