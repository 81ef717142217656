"""Cells of a contact are bare of film where it wore, and that changes their caps.

A body's cell has lost its film where more than the film's thickness was worn off it since the film was last
whole. A cell of the contact is bare where that holds of every body that carries one. Fields are those of the
counter-body, or of patches; the disc's rows lie under them displaced, as in `sliding`. The loops are C++:
native/film.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Cells
from warpwear.kernels.sliding import Slide

#: Where wear by a stored pressure is compiled, too: a file of its own would compile Warp's headers again.
TOGETHER = wp.get_module("warpwear.kernels.wear_from_pressure")
wp.set_module_options(native_code.options("film.h", "wear_from_pressure.h"), module=TOGETHER)


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
    bare: wp.array2d(dtype=Cells)  # 1 where a cell was bare as the last step began, else 0
    parts: wp.array2d(dtype=Cells)  # cap over the hardness; no rows where it is the same for all


@native_code.native_pass("look_at_film", module=TOGETHER)
def look(slides: wp.array(dtype=Slide), films: Films):
    """See which of the cells ever touched are bare as a step begins, and what their caps are."""


@native_code.native_pass("rub_film", module=TOGETHER)
def rub(slides: wp.array(dtype=Slide), films: Films):
    """Note the distance at the end of a step where the bodies were worn in it; of films that form anew."""


@native_code.native_pass("count_bare", module=TOGETHER)
def bare_under_pressure(
    slides: wp.array(dtype=Slide),
    films: Films,
    pressure_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Count bare cells among those with a pressure, of the rows visited."""
