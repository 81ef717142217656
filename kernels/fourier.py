"""Convolutions of fields: on a CPU by transforms of its own, on any device around those of a library.

The C++ is in `native/fourier.h`, which says how modes lie. Kernels of transforms are of single and of double
precision, by kind of number.
"""

from typing import Any

import numpy as np
import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Cells

#: Whole registers, where compilers take half of each: a fifth less time.
FLAGS = "-march=native -mprefer-vector-width=512"
wp.set_module_options(native_code.options("transforms.h", "fourier.h") | {"cpu_compiler_flags": FLAGS})

#: Lines that are transformed together, by type of number: as many as fill 64 bytes.
LINES = {np.float32: 16, np.float64: 8}


def of_both(function: Any) -> dict[Any, Any]:
    """Kernels of a function, with arrays of either type of number wherever any will do.

    Each has a name of its own: overloads of one kernel are one and the same for a recording on a CPU.
    """
    kernels = {}
    for kind in LINES:
        kernel = wp.kernel(function, name=f"{function.__name__}_{kind.__name__}")
        arrays = {a.label: a.type for a in kernel.adj.args if getattr(a.type, "dtype", None) is Any}
        real = wp.dtype_from_numpy(kind)
        types = {name: wp.array(dtype=real, ndim=array.ndim) for name, array in arrays.items()}
        kernels[kind] = wp.overload(kernel, types)
    return kernels


@wp.struct
class Plan:
    """A convolution of grids that lie one after another, by the order of its modes."""

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


@wp.func_native("forward_rows(slot, slots, plan, turns, field, scratch, spectrum);")
def forward_rows(
    slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns: wp.array(dtype=Any),
    field: wp.array2d(dtype=Cells),
    scratch: wp.array2d(dtype=Any),
    spectrum: wp.array3d(dtype=Any),
):
    """Modes of rows."""
    ...


@wp.func_native("across_columns(slot, slots, plan, turns, table, line, scratch, spectrum);")
def across_columns(
    slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns: wp.array(dtype=Any),
    table: wp.array3d(dtype=Any),
    line: wp.array(dtype=wp.float64),
    scratch: wp.array2d(dtype=Any),
    spectrum: wp.array3d(dtype=Any),
):
    """Transforms columns of modes, multiplies them and transforms them back."""
    ...


@wp.func_native("back_rows(slot, slots, plan, turns, scratch, spectrum, field);")
def back_rows(
    slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns: wp.array(dtype=Any),
    scratch: wp.array2d(dtype=Any),
    spectrum: wp.array3d(dtype=Any),
    field: wp.array2d(dtype=Cells),
):
    """Cells of rows from their modes."""
    ...


@of_both
def forward(
    first_slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns_in: wp.array(dtype=Any),
    field_in: wp.array2d(dtype=Cells),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
):
    """Modes of the rows. turns: cosines and sines, first those that part modes of rows, then of stages."""
    forward_rows(first_slot + wp.tid(), slots, plan, turns_in, field_in, scratch_out, spectrum_out)


@of_both
def across(
    first_slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns_in: wp.array(dtype=Any),
    table_in: wp.array3d(dtype=Any),
    line_in: wp.array(dtype=wp.float64),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
):
    """Multiply the modes of all columns by the table and the line of each row, in place."""
    across_columns(first_slot + wp.tid(), slots, plan, turns_in, table_in, line_in, scratch_out, spectrum_out)


@of_both
def back(
    first_slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns_in: wp.array(dtype=Any),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_in: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """Cells of the rows from their modes."""
    back_rows(first_slot + wp.tid(), slots, plan, turns_in, scratch_out, spectrum_in, field_out)


@wp.func_native(
    "convolve_grids(slot, slots, plan, turns, table, line, field_in, scratch, spectrum, field_out);"
)
def convolve_grids(
    slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns: wp.array(dtype=Any),
    table: wp.array3d(dtype=Any),
    line: wp.array(dtype=wp.float64),
    field_in: wp.array2d(dtype=Cells),
    scratch: wp.array2d(dtype=Any),
    spectrum: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """Convolves grids, each while it is in the cache."""
    ...


@of_both
def convolve(
    first_slot: wp.int32,
    slots: wp.int32,
    plan: Plan,
    turns_in: wp.array(dtype=Any),
    table_in: wp.array3d(dtype=Any),
    line_in: wp.array(dtype=wp.float64),
    field_in: wp.array2d(dtype=Cells),
    scratch_out: wp.array2d(dtype=Any),
    spectrum_out: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """Forward, across and back for one grid after another."""
    convolve_grids(
        first_slot + wp.tid(),
        slots,
        plan,
        turns_in,
        table_in,
        line_in,
        field_in,
        scratch_out,
        spectrum_out,
        field_out,
    )


@wp.struct
class Around:
    """Grids that lie one after another, and what is done with their modes, around transforms of a library."""

    visited: wp.array(dtype=wp.int32)  # grids that are convolved, the first ones; one number
    rows: wp.int32  # of a grid
    columns: wp.int32
    stride: wp.int32  # numbers from one row to the next
    divides: wp.bool  # instead of multiplying
    scale: wp.float64  # of a factor


@wp.func_native("pad_rows(slot, slots, grids, field, padded);")
def pad_rows(
    slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    field: wp.array2d(dtype=Cells),
    padded: wp.array3d(dtype=Any),
):
    """Cells of grids into padded ones."""
    ...


@wp.func_native("crop_rows(slot, slots, grids, padded, field);")
def crop_rows(
    slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    padded: wp.array3d(dtype=Any),
    field: wp.array2d(dtype=Cells),
):
    """The way back."""
    ...


@wp.func_native("multiply_modes(slot, slots, grids, table, line, modes);")
def multiply_modes(
    slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    table: wp.array2d(dtype=wp.float64),
    line: wp.array(dtype=wp.float64),
    modes: wp.array3d(dtype=Any),
):
    """Multiplies, or divides, modes by the table and the line."""
    ...


@of_both
def pad(
    first_slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    field_in: wp.array2d(dtype=Cells),
    padded_out: wp.array3d(dtype=Any),
):
    """Cells of grids into padded ones, whose padding stays zero."""
    pad_rows(first_slot + wp.tid() // wp.block_dim(), slots, grids, field_in, padded_out)


@of_both
def crop(
    first_slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    padded_in: wp.array3d(dtype=Any),
    field_out: wp.array2d(dtype=Cells),
):
    """The way back."""
    crop_rows(first_slot + wp.tid() // wp.block_dim(), slots, grids, padded_in, field_out)


@of_both
def multiply(
    first_slot: wp.int32,
    slots: wp.int32,
    grids: Around,
    table_in: wp.array2d(dtype=wp.float64),
    line_in: wp.array(dtype=wp.float64),
    modes: wp.array3d(dtype=Any),
):
    """Multiply, or divide, modes by the table and the line of their row, in place."""
    multiply_modes(first_slot + wp.tid() // wp.block_dim(), slots, grids, table_in, line_in, modes)
