"""Passes make what cells have of their own where no list of tiles or gap does, and note what films have lost.

See `sources`.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import FIELD, LISTED, OF_CELLS, TABLE, CellProperties, Sources
from warpwear.kernels.sliding import SLIDES

native_pass = native_code.passes_of(__name__, "running_in/sources.h")


#: See which cells are bare as a step begins, and what that makes of them.
look = native_pass("look_at_rows", slides=SLIDES, **OF_CELLS)
#: Store 1/c of the cells in an implicit step: their own compliance and the wear of both bodies, K ΔL/φ.
#:
#: φ is as it is at the step's start.
stiffness = native_pass("stiffen_rows", slides=SLIDES, **OF_CELLS)
#: Make what the cells of the tiles listed have of their own as a step begins.
make = native_pass("make_listed", **LISTED, slides=SLIDES, **OF_CELLS)
#: Note the distance at the end of a step where bodies were worn in it; of films that form anew.
rub_tiles = native_pass("rub_listed", **LISTED, slides=SLIDES, sources=Sources)
#: Do the same in the columns ever touched, where more is worn than the tiles listed.
rub = native_pass("rub_rows", slides=SLIDES, sources=Sources, rows=wp.int32)
#: Count bare cells among those with a pressure, of the rows visited.
bare_under_pressure = native_pass(
    "count_bare", slides=SLIDES, cells=CellProperties, pressure=FIELD, sums=TABLE
)
