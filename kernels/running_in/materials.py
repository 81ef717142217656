"""Books of the materials of two bodies by worn depth: what each bears and loses in a step.

They follow from pressures and from the materials that meet as a step begins, not from the pass that wears: by
them its depths are checked. The loops are C++: native/running_in/materials.h.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import FIELD, OF_CELLS, TABLE, Sources
from warpwear.kernels.native_code import total_of
from warpwear.kernels.sliding import SLIDES, SOLVED, Slide
from warpwear.kernels.wear_from_pressure import Pressed

native_pass = native_code.passes_of(__name__, "running_in/materials.h", "wear.h")

#: Materials of a body that have books of their own, and what is booked of each, in this order.
BOOKED = 8
BOOKS = ("cells", "pressure", "lost")
#: Lines of the table of books: of the counter-body, of the disc, and the sum of the shear ratios.
LINES = 2 * len(BOOKS) * BOOKED + 1


#: Books, of the tiles listed and before they are worn, what each material bears and loses.
book = native_pass("book_materials", **SOLVED, **OF_CELLS, gap=FIELD, sums=TABLE)
#: Books the same of a stored pressure.
book_pressed = native_pass("book_pressed", slides=SLIDES, pressed=Pressed, sources=Sources, sums=TABLE)


@wp.kernel
def record(
    slides: wp.array(dtype=Slide),
    sums_in: wp.array2d(dtype=wp.float64),
    history_out: wp.array2d(dtype=wp.float64),
    first_column: wp.int32,
):
    """Write the sums of the books into the row of the step."""
    total_of(sums_in, 1, history_out, slides[0].number, first_column)
