"""The passes of the half-space solver before a search, and those that a search does without fields to change.

Symbols as in `half_space`: p pressure, t = Gp + g its gradient.
"""

import warp as wp

from warpwear.kernels.cells import (
    ABSENT,
    LANES,
    NONE,
    ONE,
    ZERO,
    Cells,
    largest_of,
    lowest_of,
    of_row,
    sum_of,
)

wp.set_module_options({"enable_backward": False})


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
    row = slot // slots_per_row
    level = of_row(level_in, row)
    count = Cells(ZERO)
    first = Cells(ZERO)
    second = Cells(ZERO)
    lowest = Cells(-NONE)
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        there = Cells(ZERO)
        above = Cells(ZERO)
        squared = Cells(ZERO)
        for j in range(LANES):
            there[j] = wp.where(k * LANES + j < columns and g[j] < ABSENT, ONE, ZERO)
            above[j] = wp.where(there[j] > ZERO, g[j] - level, ZERO)
            squared[j] = above[j] * above[j]
            lowest[j] = wp.max(lowest[j], wp.where(there[j] > ZERO, -g[j], -NONE))
        count += there
        first += above
        second += squared
    sums_out[0, slot] = sum_of(count)
    sums_out[1, slot] = sum_of(first)
    sums_out[2, slot] = sum_of(second)
    maxima_out[0, slot] = largest_of(lowest)


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
    row = slot // slots_per_row
    largest = Cells(ZERO)
    for k in range(slot % slots_per_row, gap_in.shape[1], slots_per_row):
        g = gap_in[row, k]
        u = response_in[row, k]
        t = Cells(ZERO)
        size = Cells(ZERO)
        for j in range(LANES):
            t[j] = wp.where(k * LANES + j < columns, g[j] + u[j], NONE)
            size[j] = wp.where(k * LANES + j < columns, wp.abs(u[j]), ZERO)
        gradient_out[row, k] = t
        largest = wp.max(largest, size)
    maxima_out[0, slot] = largest_of(largest)


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
    row = slot // slots_per_row
    total = Cells(ZERO)
    largest = Cells(ZERO)
    for k in range(slot % slots_per_row, first_in.shape[1], slots_per_row):
        a = first_in[row, k]
        b = second_in[row, k]
        ab = Cells(ZERO)
        size = Cells(ZERO)
        for j in range(LANES):
            ab[j] = a[j] * b[j]
            size[j] = wp.abs(b[j])
        total += ab
        largest = wp.max(largest, size)
    sums_out[0, slot] = sum_of(total)
    maxima_out[0, slot] = largest_of(largest)


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
