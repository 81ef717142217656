"""Pass over the patches of a contact, each at an approach of its own.

What is decided between passes stands in `two_scale`.

All patches lie in one field of shape (patches, lines · vectors of a line): a row is a patch, its lines of
cells (along axis 1 of the domain) one after another, each padded to whole vectors. A tile is `TILE_VECTORS`
vectors of one line, or what is left of it. A slot is a patch; tiles whose lowest gap, before any wear, is
above the patch's approach are skipped.
"""

import warp as wp

from warpwear.kernels.cells import LANES, ONE, ZERO, Cells, Layout
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.native_code import native_pass
from warpwear.kernels.two_scale.curves import TOGETHER, Curves
from warpwear.kernels.two_scale.steps import Books, Courses, Steps


@wp.struct
class Surfaces:
    """Surfaces hold the cells of all patches."""

    layout: Layout
    lowest: wp.array2d(dtype=wp.float64)  # gap in every tile of a patch before any wear [mm]
    cells: wp.float64  # of a patch
    gap: wp.array2d(dtype=Cells)  # [mm]
    unworn: wp.array2d(dtype=Cells)
    parts: wp.array2d(dtype=Cells)  # of the cap, that cells bear; no rows where all bear it
    trial: wp.array2d(dtype=wp.float64)  # what a pass adds up for `Curves.answer`


@native_pass("carry_patch", module=TOGETHER)
def carried(steps: Steps, curves: Curves, surfaces: Surfaces):
    """Add up what the cells of every patch carry at its trial approach, and give its `Curves.answer`.

    As far as the change of pressure that the cell nearest to it needs to open, close or reach the cap, the
    pressure is a straight line.
    """


@wp.kernel(module=TOGETHER)
def pressures(
    first_slot: wp.int32,
    slots: wp.int32,
    steps: Steps,
    curves: Curves,
    surfaces: Surfaces,
    pressure_out: wp.array2d(dtype=Cells),
):
    """Lay the pressure field of solved approaches."""
    patch = first_slot + wp.tid() // wp.block_dim()
    law = Law()
    law.base = curves.base[patch]
    law.offset = curves.offset[patch]
    cap = steps.load.hardness
    stiffness = steps.now[0].stiffness
    touches = (law.base - curves.lowest[patch]) + law.offset > ZERO
    for k in range(wp.tid() % wp.block_dim(), surfaces.gap.shape[1], wp.block_dim()):
        p = Cells(ZERO)
        if touches:
            g = surfaces.gap[patch, k]
            part = Cells(ONE)
            if surfaces.parts.shape[0] > 0:
                part = surfaces.parts[patch, k]
            for j in range(LANES):
                law.cap = cap * part[j]
                p[j] = pressure_of(law, g[j], stiffness)
        pressure_out[patch, k] = p


@native_pass("wear_patch", module=TOGETHER)
def wear(steps: Steps, curves: Curves, courses: Courses, surfaces: Surfaces, books: Books):
    """Wear the cells in place: the gap opens by K p ΔL of both bodies; evaluate them for the next step.

    Sums and maxima are those of the step and of each patch. A tile above the largest approach that its patch
    has had was never touched; every other one is visited, so that the sums of what was touched and worn are
    those of the whole patch.
    """


@wp.kernel(module=TOGETHER)
def worn(first_slot: wp.int32, slots: wp.int32, surfaces: Surfaces, worn_out: wp.array2d(dtype=Cells)):
    """Lay what both bodies have lost so far: how far the gap has opened."""
    patch = first_slot + wp.tid() // wp.block_dim()
    for k in range(wp.tid() % wp.block_dim(), surfaces.gap.shape[1], wp.block_dim()):
        worn_out[patch, k] = surfaces.gap[patch, k] - surfaces.unworn[patch, k]
