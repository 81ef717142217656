"""A ball over a disc leaves a gap, and a cell of it bears a pressure by a law.

A trial approach is given as base + offset. One ulp of an approach of 0.07 mm changes the load of a worn
contact by more than 1e-12 of it; `base − gap` is exact near contact, so the offset adds the missing digits.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Layout, fields

native_pass = native_code.passes_of(__name__, "bodies.h")


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


@wp.struct
class Indenter:
    """Tells where the first cell of a domain lies under a ball, or a rigid flat."""

    cell: wp.float64  # [mm]
    x_first: wp.float64
    y_first: wp.float64
    curvature: wp.float64  # 1/R [1/mm]


#: What `gap` takes: the columns of a line, the ball, where rows of the fields lie, and these.
OF_GAP = {"columns": wp.int32, "ball": Indenter, "layout": Layout, **fields("roughness", "gap")}
#: Store the gap of the unworn bodies from the mean planes: height of the ball over its apex − roughness.
gap = native_pass("gap_under_ball", **OF_GAP)
