"""A stored pressure wears both bodies by Archard's law: of a grid at rest, on a track, and of patches.

While a disc moves under the ball, its asperities and the pressure move with it during a step. A cell of the
disc is worn by its own pressure, one of the counter-body by the mean of those that pass over it along x.

A row of the fields is a row of a grid, which is one line of a `Layout`, or a patch with its lines one after
another. The loops are C++: native/wear_from_pressure.h.

Beside that stand films, with which these kernels are compiled: cells are bare of film where they wore, and
that changes their caps. A body's cell has lost its film where more than the film's thickness was worn off it
since the film was last whole. A cell of the contact is bare where that holds of every body that carries one.
Fields are those of the counter-body, or of patches; the disc's rows lie under them displaced, as in
`sliding`. These loops are C++, too: native/film.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import CellProperties, Cells, Layout
from warpwear.kernels.sliding import Bodies, OfRows, Slide

wp.set_module_options(native_code.options("film.h", "wear_from_pressure.h"))


@wp.struct
class Pressed:
    """Holds what a search leaves of a contact, and what its cells have of their own."""

    pressure: wp.array2d(dtype=Cells)  # [MPa]
    means: wp.array2d(dtype=Cells)  # of the pressure along x, see `means`; one row where no disc moves
    gradient: wp.array2d(dtype=Cells)  # gap after the step, from the mean planes [mm]
    slips: wp.array2d(dtype=Cells)  # of a cycle, by cells [mm]; no rows where all slide alike
    grown: wp.array2d(dtype=Cells)  # by how much they did in the last jump [mm]
    rubbed: wp.array2d(dtype=Cells)  # part of the step in contact, and its means; no rows without shear
    rubbed_means: wp.array2d(dtype=Cells)
    cells: CellProperties
    cap: wp.float64  # largest pressure [MPa]


@native_code.native_pass("mean_along")
def means(
    slides: wp.array(dtype=Slide),
    field_in: wp.array2d(dtype=Cells),
    means_out: wp.array2d(dtype=Cells),
):
    """Means of a field over the rows that pass over each, `Slide.window` of them; of one row none is made."""


@native_code.native_pass("meet")
def gaps(
    slides: wp.array(dtype=Slide),
    bodies: Bodies,
    cells: CellProperties,
    means_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
):
    """Return the gap that a cell of the displaced disc meets on its way through a step.

    means_in: of the counter-body's wear along that way, instead of the wear at its middle.
    """


@native_code.native_pass("part_of_step")
def part_of_step(slides: wp.array(dtype=Slide), pressed: Pressed):
    """Find which part of a step each cell was in contact, where its shear wears it.

    Cells that bear were so all of it; those whose gap at its end is less than what shear wears, for a part.
    """


@native_code.native_pass("wear_by_pressure")
def wear(
    slides: wp.array(dtype=Slide),
    layout: Layout,
    pressed: Pressed,
    bodies: Bodies,
    of_rows: OfRows,
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Wear an increment in place: the disc loses K ΔL p, the counter-body K ΔL times the mean that passes it.

    Where the pressure moves with the counter-body it is the other way round. Cells with slips of their own
    lose more by them, and slip by as much more as they have lost.

    Without a disc all wear is the ball's, whose height is then the gap. A disc that keeps its dents is
    displaced for good by what is beyond the gap after the step. Sums are lines of `PressureSum`, maxima of
    `PressureMost`, over what is visited; those of the disc are left in `of_rows`, a sum a row.
    """


@native_code.native_pass("slip_of_gaps")
def slip(
    slides: wp.array(dtype=Slide),
    gap_in: wp.array2d(dtype=Cells),
    pressure_in: wp.array2d(dtype=Cells),
    slips_inout: wp.array2d(dtype=Cells),
    grown_out: wp.array2d(dtype=Cells),
):
    """Return what cells slip in a cycle by their gap beyond the approach, and how much that grew [mm]."""


@native_code.native_pass("yields_of_slips")
def yields(
    slides: wp.array(dtype=Slide),
    slips_in: wp.array2d(dtype=Cells),
    grown_in: wp.array2d(dtype=Cells),
    yields_out: wp.array2d(dtype=Cells),
):
    """Return the compliance that a jump lends cells by their slips at its end [mm/MPa]."""


@wp.struct
class Coat:
    """Holds one body's film by fields; these have no rows where there is none, or it never forms anew."""

    wear: wp.array2d(dtype=Cells)  # of the body, from its unworn surface [mm]
    whole: wp.array2d(dtype=Cells)  # that wear, when the film was last whole [mm]
    seen: wp.array2d(dtype=Cells)  # that wear, at the end of the last step that could change it [mm]
    rubbed: wp.array2d(dtype=Cells)  # sliding distance at which it last changed [mm]


@wp.struct
class Films:
    """Holds the films of both bodies, and what they make of the cells of the contact."""

    counter: Coat
    disc: Coat
    thickness: wp.float64  # [mm]
    regrowth: wp.float64  # sliding distance without wear after which a film is whole again [mm]
    cap_filmed: wp.float64  # over the hardness
    cap_bare: wp.float64
    shear_filmed: wp.float64  # shear strength over that of a bare cell
    cells: CellProperties  # as the last step began


@native_code.native_pass("look_at_film")
def look(slides: wp.array(dtype=Slide), films: Films):
    """See which of the cells ever touched are bare as a step begins, and what that makes of them."""


@native_code.native_pass("rub_film")
def rub(slides: wp.array(dtype=Slide), films: Films):
    """Note the distance at the end of a step where the bodies were worn in it; of films that form anew."""


@native_code.native_pass("count_bare")
def bare_under_pressure(
    slides: wp.array(dtype=Slide),
    films: Films,
    pressure_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Count bare cells among those with a pressure, of the rows visited."""
