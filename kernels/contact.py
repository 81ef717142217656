"""A ball over a disc leaves a gap, and a cell of it bears a pressure.

A trial approach is given as base + offset. One ulp of an approach of 0.07 mm changes the load of a worn
contact by more than 1e-12 of it; `base − gap` is exact near contact, so the offset adds the missing digits.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import ABSENT, LANES, ONE, ZERO, Cells, Layout

wp.set_module_options(native_code.options("law.h"))


@wp.struct
class Law:
    """Holds what the pressure of a cell follows from, beside its gap and stiffness."""

    base: wp.float64  # approach = base + offset [mm]
    offset: wp.float64
    cap: wp.float64  # largest pressure [MPa]
    tie_width: wp.float64  # [mm]
    tie_pressure: wp.float64  # of cells tied with the approach [MPa]


@wp.struct
class Bends:
    """Tells how K of a cell goes with its pressure; without knots it does not."""

    knots: wp.array2d(dtype=wp.float64)  # rows of a pressure, and K of counter and disc over that of the step
    step: wp.array(dtype=wp.float64)  # compliance that is not wear, and what K of both adds to it [mm³/N]


@wp.func_native("return pressure_by(law, gap, stiffness);")
def pressure_of(law: Law, gap: wp.float64, stiffness: wp.float64) -> wp.float64:
    """Return a capped foundation's pressure; cells tied with the approach (within ± tie_width) share one."""


@wp.func_native("return pressure_by(law, gap, bend_of(bends));")
def bent_pressure_of(law: Law, gap: wp.float64, bends: Bends) -> wp.float64:
    """Return the pressure of a cell whose K goes with it, likewise."""


@wp.func
def sag(x: wp.float64, y: wp.float64, curvature: wp.float64):
    """Return the height of the ball over its apex, so that neither a small r nor a flat loses digits."""
    r2 = x * x + y * y
    under_root = ONE - r2 * curvature * curvature
    return wp.where(under_root > ZERO, r2 * curvature / (ONE + wp.sqrt(wp.max(under_root, ZERO))), ABSENT)


@wp.struct
class Indenter:
    """Tells where the first cell of a domain lies under a ball, or a rigid flat."""

    cell: wp.float64  # [mm]
    x_first: wp.float64
    y_first: wp.float64
    curvature: wp.float64  # 1/R [1/mm]


@wp.kernel
def gap(
    first_slot: wp.int32,
    slots: wp.int32,
    columns: wp.int32,
    ball: Indenter,
    layout: Layout,
    roughness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
):
    """Store the gap of the unworn bodies from the mean planes: sag − roughness. columns: of a line."""
    slot = first_slot + wp.tid() // wp.block_dim()
    vectors = layout.vectors
    for row in range(slot, gap_out.shape[0], slots):
        for k in range(wp.tid() % wp.block_dim(), gap_out.shape[1], wp.block_dim()):
            line = k // vectors
            x = ball.x_first + wp.float64(layout.first_row[row] + line) * ball.cell
            z = roughness_in[row, k]
            g = Cells(ABSENT)
            for j in range(LANES):
                column = (k - line * vectors) * LANES + j
                y = ball.y_first + wp.float64(layout.first_column[row] + column) * ball.cell
                if column < columns:
                    g[j] = sag(x, y, ball.curvature) - z[j]
            gap_out[row, k] = g
