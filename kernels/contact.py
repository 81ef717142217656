"""Gap of a sphere over a disc, contact indicator, pressure of a cell, and what a trial approach carries.

A trial approach is given as base + offset. One ulp of an approach of 0.07 mm changes the load of a worn
contact by more than 1e-12 of it; `base − gap` is exact near contact, so the offset adds the missing digits.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, ONE, TILE_VECTORS, ZERO, Cells, sum_of

wp.set_module_options({"enable_backward": False})


@wp.struct
class Law:
    """What the pressure of a cell follows from, beside its gap and stiffness."""

    base: wp.float64  # approach = base + offset [mm]
    offset: wp.float64
    cap: wp.float64  # largest pressure [MPa]
    tie_width: wp.float64  # [mm]
    tie_pressure: wp.float64  # of cells tied with the approach [MPa]


@wp.func
def in_contact(gap: wp.float64, approach: wp.float64):
    """1 where the bodies overlap at this approach, else 0."""
    return wp.where(gap < approach, ONE, ZERO)


@wp.func
def pressure_of(law: Law, gap: wp.float64, stiffness: wp.float64):
    """Capped foundation; cells tied with the approach (overlap within ± tie_width) share one pressure."""
    overlap = (law.base - gap) + law.offset
    p = wp.min(wp.max((overlap - law.tie_width) * stiffness, ZERO), law.cap)
    return wp.where(wp.abs(overlap) <= law.tie_width, law.tie_pressure, p)


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the pressures, and of the stiffnesses of the cells that are neither open nor capped.

    Third: the change of pressure that the cell nearest to it needs to open, close or reach the cap. As far as
    that the sum of the pressures is a straight line.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    pressure = Cells(ZERO)
    slope = Cells(ZERO)
    nearest = Cells(ABSENT)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            g = gap_in[row, k]
            p = Cells(ZERO)
            between = Cells(ZERO)
            near = Cells(ZERO)
            for j in range(LANES):
                q = ((law.base - g[j]) + law.offset) * s[j]
                p[j] = wp.min(wp.max(q, ZERO), law.cap)
                between[j] = wp.where(q > ZERO and q < law.cap, s[j], ZERO)
                near[j] = wp.min(wp.abs(q), wp.abs(q - law.cap))
            pressure += p
            slope += between
            nearest = wp.min(nearest, near)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(slope)
    sums_out[2, slot] = wp.min(nearest)


@wp.kernel
def count_below(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    approach: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Number of cells in contact: the bearing area of the gap at this approach, in cells."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    count = Cells(ZERO)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            g = gap_in[row, k]
            indicator = Cells(ZERO)
            for j in range(LANES):
                indicator[j] = in_contact(g[j], approach)
            count += indicator
    sums_out[0, slot] = sum_of(count)


@wp.kernel
def pressures(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    pressure_out: wp.array2d(dtype=Cells),
):
    """The pressure field of a solved approach, in the tiles visited."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            g = gap_in[row, k]
            p = Cells(ZERO)
            for j in range(LANES):
                p[j] = pressure_of(law, g[j], s[j])
            pressure_out[row, k] = p


@wp.func
def sag(x: wp.float64, y: wp.float64, curvature: wp.float64):
    """Height of the sphere over its apex. Written so that neither a small r nor a flat loses digits."""
    r2 = x * x + y * y
    under_root = ONE - r2 * curvature * curvature
    return wp.where(under_root > ZERO, r2 * curvature / (ONE + wp.sqrt(wp.max(under_root, ZERO))), ABSENT)


@wp.kernel
def gap(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    cell: wp.float64,
    x_first: wp.float64,
    y_first: wp.float64,
    curvature: wp.float64,
    roughness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    unworn_out: wp.array2d(dtype=Cells),
):
    """Gap of the unworn bodies from the mean planes, twice: sag − roughness of the disc."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    x = x_first + wp.float64(row) * cell
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        z = roughness_in[row, k]
        g = Cells(ABSENT)
        for j in range(LANES):
            column = k * LANES + j
            y = y_first + wp.float64(column) * cell
            if column < columns:
                g[j] = sag(x, y, curvature) - z[j]
        gap_out[row, k] = g
        unworn_out[row, k] = g


@wp.kernel
def bounds(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    gap_in: wp.array2d(dtype=Cells),
    extremes_out: wp.array2d(dtype=wp.float64),
):
    """Smallest and largest gap of the tiles visited; places without a surface do not count."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    low = Cells(ABSENT)
    high = Cells(-ABSENT)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            g = gap_in[row, k]
            there = Cells(-ABSENT)
            for j in range(LANES):
                there[j] = wp.where(g[j] < ABSENT / wp.float64(2.0), g[j], -ABSENT)
            low = wp.min(low, g)
            high = wp.max(high, there)
    extremes_out[0, slot] = wp.min(low)
    extremes_out[1, slot] = wp.max(high)
