"""Pass over the patches of a contact, each at an approach of its own.

What is decided between passes stands in `two_scale`.

All patches lie in one field of shape (patches, lines · vectors of a line): a row is a patch, its lines of
cells (along axis 1 of the domain) one after another, each padded to whole vectors. A tile is `TILE_VECTORS`
vectors of one line, or what is left of it. A slot is a patch; tiles whose lowest gap, before any wear, is
above the patch's approach are skipped.
"""

import warp as wp

from warpwear.kernels.cells import FIELD, CellProperties, Cells, Layout
from warpwear.kernels.two_scale.curves import Curves, native_pass
from warpwear.kernels.two_scale.steps import Books, Courses, Steps


@wp.struct
class Surfaces:
    """Surfaces hold the cells of all patches."""

    layout: Layout
    lowest: wp.array2d(dtype=wp.float64)  # gap in every tile of a patch before any wear [mm]
    cells_of_patch: wp.float64
    cap: wp.float64  # largest pressure of an unworn cell [MPa]
    gap: wp.array2d(dtype=Cells)  # [mm]
    unworn: wp.array2d(dtype=Cells)
    cells: CellProperties
    trial: wp.array2d(dtype=wp.float64)  # what a pass adds up for `Curves.answer`


#: Add up what the cells of every patch carry at its trial approach, and give its `Curves.answer`.
#:
#: As far as the change of pressure that the cell nearest to it needs to open, close or reach the cap, the
#: pressure is a straight line.
carried = native_pass("carry_patch", steps=Steps, curves=Curves, surfaces=Surfaces)
#: Lay the pressure field of solved approaches.
pressures = native_pass("press_patch", steps=Steps, curves=Curves, surfaces=Surfaces, pressure_out=FIELD)
#: Wear the cells in place: the gap opens by K p ΔL of both bodies; evaluate them for the next step.
#:
#: Sums and maxima are those of the step and of each patch. A tile above the largest approach that its patch
#: has had was never touched; every other one is visited, so that the sums of what was touched and worn are
#: those of the whole patch.
wear = native_pass("wear_patch", steps=Steps, curves=Curves, courses=Courses, surfaces=Surfaces, books=Books)
#: Lay what both bodies have lost so far: how far the gap has opened.
worn = native_pass("worn_of_patch", surfaces=Surfaces, worn_out=FIELD)
