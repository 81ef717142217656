"""The passes over all cells of a search of the half-space solver, each with the sums that the next one needs.

Symbols: p pressure, t = Gp + g its gradient (gap after deformation, from the mean planes), λ the rigid
approach, H the cap. At the solution t = λ on cells with 0 < p < H, t ≥ λ where p = 0, t ≤ λ where p = H.
A cell is free if it may move: p > 0 or t < λ, and p < H or t > λ. Levels and shifts are one for all rows, or
one a row. H is one for all cells, or a part of it of each.
"""

import warp as wp

from warpwear.kernels.cells import LANES, NONE, ONE, ZERO, Cells, largest_of, of_row, sum_of

wp.set_module_options({"enable_backward": False})

#: Rounding of a sum of two numbers, relatively.
EPSILON = wp.constant(wp.float64(4.0e-16))


@wp.struct
class Fields:
    """What a search moves, and the caps."""

    pressure: wp.array2d(dtype=Cells)  # p [MPa]
    gradient: wp.array2d(dtype=Cells)  # t [mm]
    trial: wp.array2d(dtype=Cells)  # pressure that a step aims at, before it is shifted and clipped [MPa]
    step: wp.array2d(dtype=Cells)  # the last one [MPa]
    response: wp.array2d(dtype=Cells)  # of the gradient to it [mm]
    cap: wp.float64  # H [MPa]
    parts: wp.array2d(dtype=Cells)  # of H, that cells bear; no rows where all bear it


@wp.func
def caps_of(fields: Fields, row: wp.int32, k: wp.int32):
    """H of eight cells."""
    caps = Cells(fields.cap)
    if fields.parts.shape[0] > 0:
        caps = fields.cap * fields.parts[row, k]
    return caps


@wp.func
def clipped(x: wp.float64, cap: wp.float64):
    """x between 0 and the cap."""
    return wp.min(wp.max(x, ZERO), cap)


@wp.func
def shifted(x: wp.float64, shift: wp.float64, cap: wp.float64):
    """x + shift between 0 and the cap; at a bound where it is off it by the rounding of the sum alone."""
    y = x + shift
    rounding = EPSILON * wp.abs(shift)
    return wp.where(y < rounding, ZERO, wp.where(y > cap - rounding, cap, y))


@wp.func
def free(p: wp.float64, t: wp.float64, approach: wp.float64, cap: wp.float64):
    """1 where the pressure of a cell may change, else 0."""
    return wp.where((p > ZERO or t < approach) and (p < cap or t > approach), ONE, ZERO)


@wp.kernel
def advance(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    whole: wp.bool,
    length: wp.float64,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """p += length × step, t += length × response. A whole step takes the trial itself, exact at the bounds.

    Sums: p, cells in contact, cells between the bounds and their t. Maxima: t where p > 0, −t where p < H.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    shift = of_row(shift_in, row)
    total = Cells(ZERO)
    touching = Cells(ZERO)
    between = Cells(ZERO)
    level = Cells(ZERO)
    highest = Cells(-NONE)
    lowest = Cells(-NONE)
    for k in range(slot % slots_per_row, fields.pressure.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        p = fields.pressure[row, k]
        t = fields.gradient[row, k]
        if whole:
            x = fields.trial[row, k]
            for j in range(LANES):
                p[j] = shifted(x[j], shift, cap[j])
        else:
            s = fields.step[row, k]
            for j in range(LANES):
                p[j] = clipped(p[j] + length * s[j], cap[j])
        if length > ZERO:  # else there may be no response
            y = fields.response[row, k]
            t += length * y
        touch = Cells(ZERO)
        inside = Cells(ZERO)
        inside_level = Cells(ZERO)
        up = Cells(ZERO)
        down = Cells(ZERO)
        for j in range(LANES):
            touch[j] = wp.where(p[j] > ZERO, ONE, ZERO)
            inside[j] = wp.where(p[j] < cap[j], touch[j], ZERO)
            inside_level[j] = wp.where(inside[j] > ZERO, t[j], ZERO)
            up[j] = wp.where(p[j] > ZERO, t[j], -NONE)
            down[j] = wp.where(p[j] < cap[j], -t[j], -NONE)
        fields.pressure[row, k] = p
        fields.gradient[row, k] = t
        total += p
        touching += touch
        between += inside
        level += inside_level
        highest = wp.max(highest, up)
        lowest = wp.max(lowest, down)
    sums_out[0, slot] = sum_of(total)
    sums_out[1, slot] = sum_of(touching)
    sums_out[2, slot] = sum_of(between)
    sums_out[3, slot] = sum_of(level)
    maxima_out[0, slot] = largest_of(highest)
    maxima_out[1, slot] = largest_of(lowest)


@wp.kernel
def residual(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    fields: Fields,
):
    """t − λ on the free cells, 0 elsewhere, in the place of the trial."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    approach = of_row(approach_in, row)
    for k in range(slot % slots_per_row, fields.pressure.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        p = fields.pressure[row, k]
        t = fields.gradient[row, k]
        r = Cells(ZERO)
        for j in range(LANES):
            r[j] = wp.where(free(p[j], t[j], approach, cap[j]) > ZERO, t[j] - approach, ZERO)
        fields.trial[row, k] = r


@wp.kernel
def products(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Over the free cells, with z = descent − descent_level, r = t − λ, s, y the last step and its response.

    Sums: cells, z, r, y, z y, z r, s r. Maxima: |z|, |r|.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    approach = of_row(approach_in, row)
    descent_level = of_row(descent_level_in, row)
    count = Cells(ZERO)
    descent = Cells(ZERO)
    gradient = Cells(ZERO)
    response = Cells(ZERO)
    zy = Cells(ZERO)
    zr = Cells(ZERO)
    sr = Cells(ZERO)
    largest_z = Cells(ZERO)
    largest_r = Cells(ZERO)
    for k in range(slot % slots_per_row, fields.pressure.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        p = fields.pressure[row, k]
        t = fields.gradient[row, k]
        f = Cells(ZERO)
        for j in range(LANES):
            f[j] = free(p[j], t[j], approach, cap[j])
        if largest_of(f) > ZERO:  # where none is free the others are not read
            z = descent_in[row, k]
            s = fields.step[row, k]
            y = fields.response[row, k]
            fz = Cells(ZERO)
            fr = Cells(ZERO)
            fy = Cells(ZERO)
            fzy = Cells(ZERO)
            fzr = Cells(ZERO)
            fsr = Cells(ZERO)
            size_z = Cells(ZERO)
            size_r = Cells(ZERO)
            for j in range(LANES):
                fz[j] = wp.where(f[j] > ZERO, z[j] - descent_level, ZERO)
                fr[j] = wp.where(f[j] > ZERO, t[j] - approach, ZERO)
                fy[j] = wp.where(f[j] > ZERO, y[j], ZERO)
                fzy[j] = fz[j] * fy[j]
                fzr[j] = fz[j] * fr[j]
                fsr[j] = s[j] * fr[j]
                size_z[j] = wp.abs(fz[j])
                size_r[j] = wp.abs(fr[j])
            count += f
            descent += fz
            gradient += fr
            response += fy
            zy += fzy
            zr += fzr
            sr += fsr
            largest_z = wp.max(largest_z, size_z)
            largest_r = wp.max(largest_r, size_r)
    sums_out[0, slot] = sum_of(count)
    sums_out[1, slot] = sum_of(descent)
    sums_out[2, slot] = sum_of(gradient)
    sums_out[3, slot] = sum_of(response)
    sums_out[4, slot] = sum_of(zy)
    sums_out[5, slot] = sum_of(zr)
    sums_out[6, slot] = sum_of(sr)
    maxima_out[0, slot] = largest_of(largest_z)
    maxima_out[1, slot] = largest_of(largest_r)


@wp.kernel
def direction(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    descent_level_in: wp.array(dtype=wp.float64),
    memory: wp.float64,
    length: wp.float64,
    outward: wp.float64,
    fields: Fields,
    descent_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Trial pressure p + length × d, with d = −z + memory × last step on the free cells (z as in `products`).

    Elsewhere d = −outward × (t − λ), which points out of the bounds: such a cell moves only if the shift that
    restores the load is larger. Sums: the clipped trial, and cells between the bounds.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    approach = of_row(approach_in, row)
    descent_level = of_row(descent_level_in, row)
    total = Cells(ZERO)
    between = Cells(ZERO)
    for k in range(slot % slots_per_row, fields.pressure.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        p = fields.pressure[row, k]
        t = fields.gradient[row, k]
        z = descent_in[row, k]
        s = fields.step[row, k]
        x = Cells(ZERO)
        q = Cells(ZERO)
        inside = Cells(ZERO)
        for j in range(LANES):
            is_free = free(p[j], t[j], approach, cap[j])
            r = t[j] - approach
            d = wp.where(is_free > ZERO, memory * s[j] - (z[j] - descent_level), -outward * r)
            x[j] = p[j] + length * d
            q[j] = clipped(x[j], cap[j])
            inside[j] = wp.where(x[j] > ZERO and x[j] < cap[j], ONE, ZERO)
        fields.trial[row, k] = x
        total += q
        between += inside
    sums_out[0, slot] = sum_of(total)
    sums_out[1, slot] = sum_of(between)


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sums of the trial pressures, shifted and clipped, and of the cells between the bounds."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    shift = of_row(shift_in, row)
    total = Cells(ZERO)
    between = Cells(ZERO)
    for k in range(slot % slots_per_row, fields.trial.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        x = fields.trial[row, k]
        q = Cells(ZERO)
        inside = Cells(ZERO)
        for j in range(LANES):
            q[j] = shifted(x[j], shift, cap[j])
            inside[j] = wp.where(q[j] > ZERO and q[j] < cap[j], ONE, ZERO)
        total += q
        between += inside
    sums_out[0, slot] = sum_of(total)
    sums_out[1, slot] = sum_of(between)


@wp.kernel
def step(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    approach_in: wp.array(dtype=wp.float64),
    shift_in: wp.array(dtype=wp.float64),
    fields: Fields,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Feasible step to the trial. Sum: step × (t − λ). Maximum: fraction used of the room to a bound."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    approach = of_row(approach_in, row)
    shift = of_row(shift_in, row)
    slope = Cells(ZERO)
    used = Cells(ZERO)
    for k in range(slot % slots_per_row, fields.trial.shape[1], slots_per_row):
        cap = caps_of(fields, row, k)
        x = fields.trial[row, k]
        p = fields.pressure[row, k]
        t = fields.gradient[row, k]
        s = Cells(ZERO)
        sr = Cells(ZERO)
        fraction = Cells(ZERO)
        for j in range(LANES):
            s[j] = shifted(x[j], shift, cap[j]) - p[j]
            sr[j] = wp.where(s[j] == ZERO, ZERO, s[j] * (t[j] - approach))
            room = wp.where(s[j] < ZERO, p[j], cap[j] - p[j])
            fraction[j] = wp.where(s[j] == ZERO, ZERO, wp.abs(s[j]) / room)
        fields.step[row, k] = s
        slope += sr
        used = wp.max(used, fraction)
    sums_out[0, slot] = sum_of(slope)
    maxima_out[0, slot] = largest_of(used)
