"""Running-in of a rough surface that the grid does not resolve: it recedes faster than its volume goes.

The share of the area that bears at a depth z below the highest peak is φ(z) = 1/(1 + e^(−(z − m)/s)).
A depth z has then lost the volume v(z) = ∫ φ dz of each unit of area, and back:
z(v) = m + s ln(q + (1 + q)(e^(v/s) − 1)) with q = e^(−m/s).
"""

import warp as wp

from warpwear.kernels.cells import LANES, ONE, ZERO, Cells

wp.set_module_options({"enable_backward": False})

#: Beyond so many scales s the rest of the curve is a straight line to rounding, and e^(v/s) may overflow.
STRAIGHT = wp.constant(wp.float64(60.0))


@wp.func
def depth_beyond(volume: wp.float64, middle: wp.float64, scale: wp.float64):
    """z(v) − v: how much deeper the surface stands than its mean worn depth."""
    q = wp.exp(-middle / scale)
    worn = wp.min(volume / scale, STRAIGHT)
    bent = middle + scale * wp.log(q + (ONE + q) * (wp.exp(worn) - ONE)) - volume
    straight = middle + scale * wp.log(ONE + q)
    return wp.where(volume > scale * STRAIGHT, straight, bent)


@wp.func
def bearing(volume: wp.float64, middle: wp.float64, scale: wp.float64):
    """φ(z(v))"""
    z = volume + depth_beyond(volume, middle, scale)
    return ONE / (ONE + wp.exp(-(z - middle) / scale))


@wp.kernel
def stiffness(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    compliance: wp.float64,
    removal_disc: wp.float64,
    middle: wp.float64,
    scale: wp.float64,
    distance_factor_in: wp.array2d(dtype=Cells),
    wear_disc_in: wp.array2d(dtype=Cells),
    stiffness_out: wp.array2d(dtype=Cells),
):
    """1/c of an implicit step: `compliance` and K ΔL/φ of the disc, φ as it is at the step's start."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    factor_row = wp.min(row, distance_factor_in.shape[0] - 1)
    for k in range(slot % slots_per_row, stiffness_out.shape[1], slots_per_row):
        f = distance_factor_in[factor_row, k]
        v = wear_disc_in[row, k]
        c = Cells()
        for j in range(LANES):
            c[j] = ONE / (compliance + removal_disc * f[j] / bearing(v[j], middle, scale))
        stiffness_out[row, k] = c


@wp.kernel
def recede(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    middle: wp.float64,
    scale: wp.float64,
    wear_disc_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    unworn_out: wp.array2d(dtype=Cells),
    beyond_out: wp.array2d(dtype=Cells),
):
    """Opens the gap, already opened by the mean worn depth, by what the surface stands deeper than that.

    No volume goes with it, so that the gap of the bodies as they were opens as well.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        v = wear_disc_in[row, k]
        g = gap_out[row, k]
        u = unworn_out[row, k]
        b = beyond_out[row, k]
        for j in range(LANES):
            now = depth_beyond(v[j], middle, scale)
            g[j] = g[j] + (now - b[j])
            u[j] = u[j] + (now - b[j])
            b[j] = now
        gap_out[row, k] = g
        unworn_out[row, k] = u
        beyond_out[row, k] = b


@wp.kernel
def borne(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    base: wp.float64,
    offset: wp.float64,
    middle: wp.float64,
    scale: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    wear_disc_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of φ over the cells in contact: how many cells' area bears."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    share = ZERO
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        v = wear_disc_in[row, k]
        for j in range(LANES):
            if (base - g[j]) + offset > ZERO:
                share += bearing(v[j], middle, scale)
    sums_out[0, slot] = share
