"""Running-in of a rough surface that the grid does not resolve: it recedes faster than its volume goes.

The fraction of the area that bears at a depth z below the highest peak is φ(z) = 1/(1 + e^(−(z − m)/s)).
A depth z has then lost the volume v(z) = ∫ φ dz of each unit of area, and back:
z(v) = m + s ln(q + (1 + q)(e^(v/s) − 1)) with q = e^(−m/s).
"""

import warp as wp

from warpwear.kernels.cells import LANES, ONE, ZERO, Cells
from warpwear.kernels.contact import Law

wp.set_module_options({"enable_backward": False})

#: Beyond this many scales s the rest of the curve is a straight line to rounding, and e^(v/s) may overflow.
STRAIGHT = wp.constant(wp.float64(60.0))


@wp.struct
class Curve:
    """A logistic bearing area curve φ(z)."""

    middle: wp.float64  # m [mm]
    scale: wp.float64  # s [mm]


@wp.func
def depth_beyond(volume: wp.float64, curve: Curve):
    """z(v) − v: how much deeper the surface stands than its mean worn depth."""
    q = wp.exp(-curve.middle / curve.scale)
    worn = wp.min(volume / curve.scale, STRAIGHT)
    bent = curve.middle + curve.scale * wp.log(q + (ONE + q) * (wp.exp(worn) - ONE)) - volume
    straight = curve.middle + curve.scale * wp.log(ONE + q)
    return wp.where(volume > curve.scale * STRAIGHT, straight, bent)


@wp.func
def bearing_ratio(volume: wp.float64, curve: Curve):
    """The fraction φ of the area that bears where a mean depth v [mm] was worn off."""
    z = volume + depth_beyond(volume, curve)
    return ONE / (ONE + wp.exp(-(z - curve.middle) / curve.scale))


@wp.kernel
def stiffness(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    compliance: wp.float64,
    wear_per_pressure_disc: wp.float64,
    curve: Curve,
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
            c[j] = ONE / (compliance + wear_per_pressure_disc * f[j] / bearing_ratio(v[j], curve))
        stiffness_out[row, k] = c


@wp.kernel
def recede(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    curve: Curve,
    wear_disc_in: wp.array2d(dtype=Cells),
    disc_out: wp.array2d(dtype=Cells),
    beyond_out: wp.array2d(dtype=Cells),
):
    """Lowers the disc, already lowered by its mean worn depth, by what it stands deeper than that.

    No volume goes with it.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(slot % slots_per_row, disc_out.shape[1], slots_per_row):
        v = wear_disc_in[row, k]
        d = disc_out[row, k]
        b = beyond_out[row, k]
        for j in range(LANES):
            now = depth_beyond(v[j], curve)
            d[j] = d[j] - (now - b[j])
            b[j] = now
        disc_out[row, k] = d
        beyond_out[row, k] = b


@wp.kernel
def borne(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    law: Law,
    curve: Curve,
    sphere_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    wear_disc_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of φ over the cells in contact: how many cells' area bears."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    bears = ZERO
    for k in range(slot % slots_per_row, sphere_in.shape[1], slots_per_row):
        g = sphere_in[row, k] - disc_in[row, k]
        v = wear_disc_in[row, k]
        for j in range(LANES):
            if (law.base - g[j]) + law.offset > ZERO:
                bears += bearing_ratio(v[j], curve)
    sums_out[0, slot] = bears
