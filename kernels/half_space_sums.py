"""The product of two fields, and the tables of partial results reduced on a device."""

import warp as wp

from warpwear.kernels.reductions import sum_of
from warpwear.kernels.types import LANES, NONE, ZERO, Cells

wp.set_module_options({"enable_backward": False})


@wp.kernel
def product(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    first_in: wp.array2d(dtype=Cells),
    second_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the products of two fields."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    total = Cells(ZERO)
    for k in range(slot % slots_per_row, first_in.shape[1], slots_per_row):
        a = first_in[row, k]
        b = second_in[row, k]
        ab = Cells(ZERO)
        for j in range(LANES):
            ab[j] = a[j] * b[j]
        total += ab
    sums_out[0, slot] = sum_of(total)


@wp.kernel
def fold(
    first_thread: wp.int32,
    slots_per_row: wp.int32,
    width: wp.int32,
    sums: wp.int32,
    slots: wp.int32,
    apart: wp.int32,
    stride: wp.int32,
    span: wp.int32,
    sums_in: wp.array2d(dtype=wp.float64),
    maxima_in: wp.array2d(dtype=wp.float64),
    folded_out: wp.array2d(dtype=wp.float64),
):
    """So many first rows of the table of sums, then rows of that of maxima, each reduced to width columns.

    slots: so many first columns count. A column of the result takes every stride-th one of a span of them;
    these spans begin so far apart. A thread is a row of the result and a column of it.
    """
    thread = first_thread + wp.tid()
    row = thread // width
    column = thread % width
    first = column * apart
    end = wp.min(slots, first + span)
    if row < sums:
        total = wp.float64(0.0)
        for slot in range(first, end, stride):
            total += sums_in[row, slot]
        folded_out[row, column] = total
    else:
        largest = -NONE
        for slot in range(first, end, stride):
            largest = wp.max(largest, maxima_in[row - sums, slot])
        folded_out[row, column] = largest
