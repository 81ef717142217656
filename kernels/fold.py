"""Tables of partial results, brought to fewer columns before a GPU's are read."""

import warp as wp

from warpwear.kernels.cells import NONE

wp.set_module_options({"enable_backward": False})


@wp.kernel
def fold(
    first_thread: wp.int32,
    slots_per_row: wp.int32,
    width: wp.int32,
    sums: wp.int32,
    slots: wp.int32,
    spans: wp.vec3i,
    sums_in: wp.array2d(dtype=wp.float64),
    maxima_in: wp.array2d(dtype=wp.float64),
    folded_out: wp.array2d(dtype=wp.float64),
):
    """The first `sums` rows of a table of sums, then rows of one of maxima, each reduced to `width` columns.

    Only the first `slots` columns count. spans: a column of the result takes every y-th of a span of z of
    them, and spans begin x apart. A thread is a row of the result and a column of it.
    """
    thread = first_thread + wp.tid()
    row = thread // width
    column = thread % width
    first = column * spans.x
    end = wp.min(slots, first + spans.z)
    if row < sums:
        total = wp.float64(0.0)
        for slot in range(first, end, spans.y):
            total += sums_in[row, slot]
        folded_out[row, column] = total
    else:
        largest = -NONE
        for slot in range(first, end, spans.y):
            largest = wp.max(largest, maxima_in[row - sums, slot])
        folded_out[row, column] = largest
