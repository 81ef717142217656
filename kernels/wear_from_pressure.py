"""A stored pressure wears both bodies by Archard's law: of a grid at rest, on a track, and of patches.

While a disc moves under the ball, its asperities and the pressure move with it during a step. A cell of the
disc is worn by its own pressure, one of the counter-body by the mean of those that pass over it along x.

A row of the fields is a row of a grid, which is one line of a `Layout`, or a patch with its lines one after
another. The loops are C++: native/wear_from_pressure.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import OF_CELLS, TABLE, CellProperties, Cells, Layout, fields
from warpwear.kernels.contact import Bends
from warpwear.kernels.sliding import SLIDES, Bodies, RowSums

native_pass = native_code.passes_of(__name__, "wear_from_pressure.h")


@wp.struct
class Pressed:
    """Holds what a search leaves of a contact, and what its cells have of their own."""

    pressure: wp.array2d(dtype=Cells)  # [MPa]
    means: wp.array2d(dtype=Cells)  # of the pressure along x, see `means`; one row where no disc moves
    gradient: wp.array2d(dtype=Cells)  # gap after the step, from the mean planes [mm]
    slips: wp.array2d(dtype=Cells)  # of a cycle, by cells [mm]; no rows where all slide alike
    grown: wp.array2d(dtype=Cells)  # by how much they did in the last jump [mm]
    sheared: wp.array2d(dtype=Cells)  # part of the step in contact, and its means; no rows without shear
    sheared_means: wp.array2d(dtype=Cells)
    on_counter: wp.array2d(dtype=Cells)  # by which bodies wear at K of the step; no rows where that is the
    on_disc: wp.array2d(dtype=Cells)  # pressure itself [MPa]
    cells: CellProperties
    cap: wp.float64  # largest pressure [MPa]


#: Means of a field over the rows that pass over each, `Slide.window` of them; of one row none is made.
means = native_pass("mean_along", slides=SLIDES, **fields("field", "means"))
#: Return the gap that a cell of the displaced disc meets on its way through a step.
#:
#: means: of the counter-body's wear along that way, instead of the wear at its middle.
gaps = native_pass("make_gaps", slides=SLIDES, bodies=Bodies, **OF_CELLS, **fields("means", "gap"))
#: Find which part of a step each cell was in contact, where its shear wears it.
#:
#: Cells that bear were so all of it; those whose gap at its end is less than what shear wears, for a part.
part_of_step = native_pass("part_of_step", slides=SLIDES, pressed=Pressed)
#: Wear an increment in place: the disc loses K ΔL p, the counter-body K ΔL times the mean that passes it.
#:
#: Where the pressure moves with the counter-body it is the other way round. Cells with slips of their own
#: lose more by them, and slip by as much more as they have lost.
#:
#: Without a disc all wear is the ball's, whose height is then the gap. A disc that keeps its dents is
#: displaced for good by what is beyond the gap after the step. Sums are lines of `PressureSum`, maxima of
#: `PressureMost`, over what is visited; those of the disc are left in `rows`, a sum a row.
wear = native_pass(
    "wear_by_pressure",
    slides=SLIDES,
    layout=Layout,
    pressed=Pressed,
    bodies=Bodies,
    rows=RowSums,
    sums=TABLE,
    maxima=TABLE,
)
#: Return what cells slip in a cycle by their gap beyond the approach, and how much that grew [mm].
slip = native_pass("slip_of_gaps", slides=SLIDES, **fields("gap", "pressure", "slips", "grown"))
#: Return the compliance that a jump lends cells by their slips at its end [mm/MPa].
yields = native_pass("yields_of_slips", slides=SLIDES, **fields("slips", "grown", "yields"))
#: Find the pressures that wear both bodies at the K of a step, where K goes with the pressure.
#:
#: passing: the pressure that the counter-body sees.
wearing_pressures = native_pass(
    "wearing_pressures", bends=Bends, **fields("passing", "pressure", "counter", "disc"), sums=TABLE
)
#: Return the mean of a field over a window along x at every cell, added to another field.
add_mean = native_pass("add_mean", window=wp.int32, **fields("field", "to", "out"))
#: Make a straight line over the pressure of what wear takes off each cell; say how far the last was off.
#:
#: last: the pressures before, which become the present ones. far: where chords end. keeps: the part of the
#: last slope that the next has at least.
drawn = fields("pressure", "last", "far", "gap", "gap_out", "yields")
linearise = native_pass("linearise", bends=Bends, keeps=wp.float64, **drawn, off=TABLE)
