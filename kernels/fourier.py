"""Fields are convolved on a CPU by transforms of its own, on any device around those of a library.

The C++ is in `native/fourier.h`, which says how modes lie. Kernels of transforms are of single and of double
precision, by kind of number.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Cells
from warpwear.kernels.native_code import native_pass

#: Whole registers, where compilers take half of each: a fifth less time.
FLAGS = "-march=native -mprefer-vector-width=512"
wp.set_module_options(native_code.options("transforms.h", "fourier.h") | {"cpu_compiler_flags": FLAGS})

#: Lines that are transformed together, by type of number: as many as fill 64 bytes.
LINES = {np.float32: 16, np.float64: 8}


def of_both(function: str) -> Callable[[Callable[..., None]], dict[Any, Any]]:
    """Make kernels as `native_pass` does, with arrays of either type of number wherever any will do.

    Each has a name of its own: overloads of one kernel are one and the same for a recording on a CPU.
    """
    return lambda declared: {kind: native_pass(function, kind=kind)(declared) for kind in LINES}


@wp.struct
class FourierPlan:
    """Describes a convolution of grids that lie one after another, by the order of its modes.

    Around the transforms of a library only the visited grids, their sizes and what is done with modes count.
    """

    visited: wp.array(dtype=wp.int32)  # grids that are convolved, the first ones; one number
    rows: wp.int32  # of a grid
    columns: wp.int32
    stride: wp.int32  # numbers from one row to the next
    groups: wp.int32  # of columns of modes
    divides: wp.bool  # instead of multiplying
    scale: wp.float64  # of a factor
    is_odd: wp.bool  # a row, which is transformed cell by cell; an even one pair by pair
    along: wp.array(dtype=wp.int32)  # stages of a row: 4 and primes; −2: 2, half of it zeros
    across: wp.array(dtype=wp.int32)  # stages of a column
    partners: wp.array(dtype=wp.int32)  # place of mode n − k of a row, by that of k; of mode 0 its own
    folded: wp.array(dtype=wp.int32)  # line of the table, by the place of a mode of a column
    turns_across: wp.int32  # where the factors of columns begin


@of_both("forward_rows")
def forward(
    plan: FourierPlan,
    turns_in: wp.array(dtype=Any),
    field_in: wp.array2d(dtype=Cells),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
):
    """Compute modes of rows. turns: cosines and sines, first of what parts modes of rows, then of stages."""


@of_both("across_columns")
def across(
    plan: FourierPlan,
    turns_in: wp.array(dtype=Any),
    table_in: wp.array3d(dtype=Any),
    line_in: wp.array(dtype=wp.float64),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
):
    """Multiply the modes of all columns by the table and the line of each row, in place."""


@of_both("across_pairs")
def across_pair(
    plan: FourierPlan,
    turns_in: wp.array(dtype=Any),
    table_in: wp.array4d(dtype=Any),
    signs_in: wp.array(dtype=wp.float64),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
):
    """Multiply the modes of all columns of two fields by a symmetric matrix of tables, in place."""


@of_both("back_rows")
def back(
    plan: FourierPlan,
    turns_in: wp.array(dtype=Any),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_in: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """Compute the cells of the rows from their modes."""


@of_both("convolve_grids")
def convolve(
    plan: FourierPlan,
    turns_in: wp.array(dtype=Any),
    table_in: wp.array3d(dtype=Any),
    line_in: wp.array(dtype=wp.float64),
    field_in: wp.array2d(dtype=Cells),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """Forward, across and back for one grid after another, each while it is in the cache."""


@of_both("pad_rows")
def pad(grids: FourierPlan, field_in: wp.array2d(dtype=Cells), padded_out: wp.array3d(dtype=Any)):
    """Copy cells of grids into padded ones, whose padding stays zero."""


@of_both("crop_rows")
def crop(grids: FourierPlan, padded_in: wp.array3d(dtype=Any), field_out: wp.array2d(dtype=Cells)):
    """Copy the fields out of their padding."""


@of_both("multiply_modes")
def multiply(
    grids: FourierPlan,
    table_in: wp.array2d(dtype=wp.float64),
    line_in: wp.array(dtype=wp.float64),
    modes: wp.array3d(dtype=Any),
):
    """Multiply, or divide, modes by the table and the line of their row, in place."""


@of_both("multiply_pairs")
def multiply_pair(grids: FourierPlan, table_in: wp.array3d(dtype=wp.float64), modes: wp.array3d(dtype=Any)):
    """Multiply modes of two grids by a symmetric matrix of tables, in place."""
