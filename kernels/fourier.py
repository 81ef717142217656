"""Fields are convolved on a CPU by transforms of its own, on any device around those of a library.

The C++ is in `native/fourier.h`, which says how modes lie. Kernels of transforms are of single and of double
precision, by kind of number.
"""

from typing import Any

import numpy as np
import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import FIELD, TABLE

#: Whole registers, where compilers take half of each: a fifth less time.
FLAGS = "-march=native -mprefer-vector-width=512"
native_pass = native_code.passes_of(__name__, "transforms.h", "fourier.h", cpu_compiler_flags=FLAGS)

#: Lines that are transformed together, by type of number: as many as fill 64 bytes.
LINES = {np.float32: 16, np.float64: 8}


#: Numbers of a line, of double precision.
LINE = wp.array(dtype=wp.float64)


def of_both(function: str, **of: Any) -> dict[Any, Any]:
    """Make a pass for either kind of number; a type that is a number stands for an array of such dimensions.

    Each has a name of its own: overloads of one kernel are one and the same for a recording on a CPU.
    """
    passes = {}
    for kind in LINES:
        real = wp.dtype_from_numpy(kind)
        arrays = {n: wp.array(dtype=real, ndim=one) for n, one in of.items() if isinstance(one, int)}
        passes[kind] = native_pass(function, name=f"{function}_{kind.__name__}", **(of | arrays))
    return passes


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


#: What transforms take: their plan, and cosines and sines, first of what parts modes of rows, then of stages.
TRANSFORM = {"plan": FourierPlan, "turns": 1}
#: Compute modes of rows.
forward = of_both("transform_rows<false>", **TRANSFORM, field=FIELD, scratch=2, spectrum=3)
#: Multiply the modes of all columns by the table and the line of each row, in place.
across = of_both("across_columns", **TRANSFORM, table=3, line=LINE, scratch=2, spectrum=3)
#: Multiply the modes of all columns of two fields by a symmetric matrix of tables, in place.
across_pair = of_both("across_pairs", **TRANSFORM, table=4, signs=LINE, scratch=2, spectrum=3)
#: Compute the cells of the rows from their modes.
back = of_both("transform_rows<true>", **TRANSFORM, field=FIELD, scratch=2, spectrum=3)
#: Forward, across and back for one grid after another, each while it is in the cache.
convolve = of_both(
    "convolve_grids", **TRANSFORM, table=3, line=LINE, field_in=FIELD, scratch=2, spectrum=3, field_out=FIELD
)
#: Copy cells of grids into padded ones, whose padding stays zero.
pad = of_both("pad_rows<false>", grids=FourierPlan, field=FIELD, padded=3)
#: Copy the fields out of their padding.
crop = of_both("pad_rows<true>", grids=FourierPlan, field=FIELD, padded=3)
#: Multiply, or divide, modes by the table and the line of their row, in place.
multiply = of_both("multiply_modes", grids=FourierPlan, table=TABLE, line=LINE, modes=3)
#: Multiply modes of two grids by a symmetric matrix of tables, in place.
multiply_pair = of_both("multiply_pairs", grids=FourierPlan, table=wp.array3d(dtype=wp.float64), modes=3)
