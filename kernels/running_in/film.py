"""Passes make what cells have of their own where no list of tiles or gap does, and note what films have lost.

See `sources`.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import CellProperties, Cells, Sources
from warpwear.kernels.sliding import Slide

wp.set_module_options(native_code.options("running_in/sources.h"))


@native_code.native_pass("look_at_rows")
def look(slides: wp.array(dtype=Slide), sources: Sources, cells: CellProperties):
    """See which cells are bare as a step begins, and what that makes of them."""


@native_code.native_pass("stiffen_rows")
def stiffness(slides: wp.array(dtype=Slide), sources: Sources, cells: CellProperties):
    """Store 1/c of the cells in an implicit step: their own compliance and the wear of both bodies, K ΔL/φ.

    φ is as it is at the step's start.
    """


@native_code.native_pass("make_listed")
def make(
    tiles: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    slides: wp.array(dtype=Slide),
    sources: Sources,
    cells: CellProperties,
):
    """Make what the cells of the tiles listed have of their own as a step begins."""


@native_code.native_pass("rub_listed")
def rub_tiles(
    tiles: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    slides: wp.array(dtype=Slide),
    sources: Sources,
):
    """Note the distance at the end of a step where bodies were worn in it; of films that form anew."""


@native_code.native_pass("rub_rows")
def rub(slides: wp.array(dtype=Slide), sources: Sources, rows: wp.int32):
    """Do the same in the columns ever touched, where more is worn than the tiles listed."""


@native_code.native_pass("count_bare")
def bare_under_pressure(
    slides: wp.array(dtype=Slide),
    cells: CellProperties,
    pressure_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Count bare cells among those with a pressure, of the rows visited."""
