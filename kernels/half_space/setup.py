"""The passes of the half-space solver before a search, and those that a search does without fields to change.

Symbols as in `search`: p pressure, t = Gp + g its gradient.
"""

import warp as wp

from warpwear.kernels.cells import (
    LANES,
    NONE,
    ZERO,
    Cells,
    largest_of,
    lowest_of,
    of_row,
)
from warpwear.kernels.wear_loops import LANES_IN_C

wp.set_module_options({"enable_backward": False})

# What follows is put together to functions in C++, whose arguments are those of the kernels below.
_BEGIN = (
    LANES_IN_C
    + """
{
#if defined(__CUDA_ARCH__)
    const Lanes places = 0.0;
#else
    #pragma clang fp contract(fast)
    const Lanes places = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
#endif
    const int row = slot / slots_per_row, of_vector = 8 / lanes;
    const Lanes none = 1.0e300, absent = 1.0e30;
    const auto line = [&](const auto& field) { return (Stored*)&wp::index(field, row, 0); };
"""
)
_EACH = """
    for (int k = slot % slots_per_row; k < vectors; k += slots_per_row)
        for (int i = k * of_vector; i < (k + 1) * of_vector; ++i) {
"""
_MOMENTS = (
    """
    const int vectors = gap_in.shape[1];
    const Stored* const gap = line(gap_in);
    const int levels = level_in.shape[0];
    const Lanes end = double(columns), level = wp::index(level_in, row < levels ? row : levels - 1);
    Counts cells = 0;
    Lanes first = 0.0, second = 0.0, lowest = -none;
"""
    + _EACH
    + """
            const Lanes g = gap[i];
            const auto there = (places + double(lanes * i) < end) & (g < absent);
            const Lanes above = there ? g - level : zero, down = there ? -g : -none;
            cells += there ? yes : no;
            first += above;
            second += above * above;
            lowest = lowest > down ? lowest : down;
        }
    wp::index(sums_out, 0, slot) = count(cells);
    wp::index(sums_out, 1, slot) = total(first);
    wp::index(sums_out, 2, slot) = total(second);
    wp::index(maxima_out, 0, slot) = most(lowest);
}
"""
)
_GRADIENT = (
    """
    const int vectors = gap_in.shape[1];
    const Stored *const gap = line(gap_in), *const response = line(response_in);
    Stored* const gradient = line(gradient_out);
    const Lanes end = double(columns);
    Lanes largest = 0.0;
"""
    + _EACH
    + """
            const Lanes u = response[i];
            const auto there = places + double(lanes * i) < end;
            gradient[i] = there ? gap[i] + u : none;
            const Lanes size = there ? size_of(u) : zero;
            largest = largest > size ? largest : size;
        }
    wp::index(maxima_out, 0, slot) = most(largest);
}
"""
)
_PRODUCT = (
    """
    const int vectors = first_in.shape[1];
    const Stored *const first = line(first_in), *const second = line(second_in);
    Lanes sum = 0.0, largest = 0.0;
"""
    + _EACH
    + """
            const Lanes b = second[i], size = size_of(b);
            sum += first[i] * b;
            largest = largest > size ? largest : size;
        }
    wp::index(sums_out, 0, slot) = total(sum);
    wp::index(maxima_out, 0, slot) = most(largest);
}
"""
)


@wp.func_native(_BEGIN + _MOMENTS)
def moments_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    level_in: wp.array(dtype=wp.float64),
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Sums up the gap of a slot; arguments as of `moments`."""
    ...


@wp.kernel
def moments(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    level_in: wp.array(dtype=wp.float64),
    gap_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Where there is a surface, sums of cells, g − level and its square. Maximum: −g."""
    slot = first_slot + wp.tid()
    moments_row(slot, slots_per_row, columns, level_in, gap_in, sums_out, maxima_out)


@wp.kernel
def extents(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    level: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """First and last row, first and last column of the cells with g ≤ level; the first ones negated."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    first = Cells(-NONE)
    last = Cells(-NONE)
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        if lowest_of(g) <= level:  # as in few vectors
            for j in range(LANES):
                column = wp.float64(k * LANES + j)
                below = k * LANES + j < columns and g[j] <= level
                first[j] = wp.max(first[j], wp.where(below, -column, -NONE))
                last[j] = wp.max(last[j], wp.where(below, column, -NONE))
    furthest = largest_of(last)
    maxima_out[0, slot] = wp.where(furthest >= ZERO, -wp.float64(row), -NONE)
    maxima_out[1, slot] = wp.where(furthest >= ZERO, wp.float64(row), -NONE)
    maxima_out[2, slot] = largest_of(first)
    maxima_out[3, slot] = furthest


@wp.kernel
def spring(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    stiffness: wp.float64,
    level_in: wp.array(dtype=wp.float64),
    gap_in: wp.array2d(dtype=Cells),
    trial_out: wp.array2d(dtype=Cells),
):
    """Trial pressure of a foundation, (level − g) × stiffness; far below zero in the padding."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    level = of_row(level_in, row)
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        x = Cells(ZERO)
        for j in range(LANES):
            x[j] = wp.where(k * LANES + j < columns, (level - g[j]) * stiffness, -NONE)
        trial_out[row, k] = x


@wp.kernel
def bound(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    cap: wp.float64,
    parts_in: wp.array2d(dtype=Cells),
    pressure_out: wp.array2d(dtype=Cells),
):
    """Pressure of each cell down to its part of the cap, which may have fallen since it was solved."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(slot % slots_per_row, pressure_out.shape[1], slots_per_row):
        p = pressure_out[row, k]
        caps = cap * parts_in[row, k]
        pressure_out[row, k] = wp.min(p, caps)


@wp.func_native(_BEGIN + _GRADIENT)
def gradient_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    gap_in: wp.array2d(dtype=Cells),
    response_in: wp.array2d(dtype=Cells),
    gradient_out: wp.array2d(dtype=Cells),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Makes the gradient of a slot; arguments as of `gradient`."""
    ...


@wp.kernel
def gradient(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    gap_in: wp.array2d(dtype=Cells),
    response_in: wp.array2d(dtype=Cells),
    gradient_out: wp.array2d(dtype=Cells),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """t = Gp + g; without end in the padding, which therefore stays open. Maximum: |Gp|."""
    slot = first_slot + wp.tid()
    gradient_row(slot, slots_per_row, columns, gap_in, response_in, gradient_out, maxima_out)


@wp.func_native(_BEGIN + _PRODUCT)
def product_row(
    slot: wp.int32,
    slots_per_row: wp.int32,
    first_in: wp.array2d(dtype=Cells),
    second_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Sums up the products of a slot; arguments as of `product`."""
    ...


@wp.kernel
def product(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    first_in: wp.array2d(dtype=Cells),
    second_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
):
    """Sum of the products of two fields. Maximum: |second|."""
    slot = first_slot + wp.tid()
    product_row(slot, slots_per_row, first_in, second_in, sums_out, maxima_out)


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
