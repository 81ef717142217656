"""Running-in of a rough surface that the grid does not resolve: it recedes faster than its volume goes.

The fraction of the area that bears at a depth z below the highest peak is φ(z) = 1/(1 + e^(−(z − m)/s)).
A depth z has then lost the volume v(z) = ∫ φ dz of each unit of area, and back:
z(v) = m + s ln(q + (1 + q)(e^(v/s) − 1)) with q = e^(−m/s).
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import LANES, ZERO, Cells, Curve
from warpwear.kernels.contact import Law

wp.set_module_options(native_code.options("running_in/recession.h"))


@wp.func_native("return depth_beyond(volume, curve);")
def depth_beyond(volume: wp.float64, curve: Curve) -> wp.float64:
    """Return z(v) − v: how much deeper the surface stands than its mean worn depth."""


@wp.func_native("return bearing_ratio(volume, curve);")
def bearing_ratio(volume: wp.float64, curve: Curve) -> wp.float64:
    """Return the fraction φ of the area that bears where a mean depth v [mm] was worn off."""


@wp.kernel
def recede(
    first_slot: wp.int32,
    slots: wp.int32,
    curve: Curve,
    wear_disc_in: wp.array2d(dtype=Cells),
    disc_out: wp.array2d(dtype=Cells),
    beyond_out: wp.array2d(dtype=Cells),
):
    """Lowers the disc, already lowered by its mean worn depth, by what it stands deeper than that.

    No volume goes with it.
    """
    slot = first_slot + wp.tid() // wp.block_dim()
    for row in range(slot, disc_out.shape[0], slots):
        for k in range(wp.tid() % wp.block_dim(), disc_out.shape[1], wp.block_dim()):
            v = wear_disc_in[row, k]
            d = disc_out[row, k]
            b = beyond_out[row, k]
            for j in range(LANES):
                now = depth_beyond(v[j], curve)
                d[j] = d[j] - (now - b[j])
                b[j] = now
            disc_out[row, k] = d
            beyond_out[row, k] = b


@wp.func_native("store_sum(table, 0, slot, value);")
def _leave(slot: wp.int32, value: wp.float64, table: wp.array2d(dtype=wp.float64)): ...


@wp.kernel
def borne(
    first_slot: wp.int32,
    slots: wp.int32,
    laws: wp.array(dtype=Law),
    curve: Curve,
    counter_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    wear_disc_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of φ over the cells in contact, before they wear: how many cells' area bears."""
    slot = first_slot + wp.tid() // wp.block_dim()
    law = laws[0]
    bears = ZERO + ZERO
    for row in range(slot, counter_in.shape[0], slots):
        for k in range(wp.tid() % wp.block_dim(), counter_in.shape[1], wp.block_dim()):
            g = counter_in[row, k] - disc_in[row, k]
            v = wear_disc_in[row, k]
            for j in range(LANES):
                if (law.base - g[j]) + law.offset > ZERO:
                    bears += bearing_ratio(v[j], curve)
    _leave(slot, bears, sums_out)
