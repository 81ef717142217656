#pragma once
// What moves fields between the grid of a search and others: a window of a larger grid, and cells twice as
// wide.
#include "lanes.h"

// First and last row, first and last column of the cells whose gap exceeds neither the approach of a contact
// nor the level of its certificate; the first ones negated.
template <typename Reach> WARPWEAR_FN void extents(int slot, int slots, const Reach& reach)
{
    const double approach = reach.groups.data[0].level, above = reach.proven.data[0].level;
    const double level = approach > above ? approach : above;
    double first_row = -NO_LIMIT, last_row = -NO_LIMIT, first = -NO_LIMIT, last = -NO_LIMIT;
    for (int row = slot; row < reach.gap.shape[0]; row += slots) {
        const Stored* const cells = row_of(reach.gap, row);
        for (int i = lane_of_slot(); i < reach.gap.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes g = cells[i];
            if (!any(g <= Lanes(level))) continue; // as in most vectors
            for (int j = 0; j < LANES; ++j) {
                const int column = i * LANES + j;
                if (column >= reach.columns || !(((const double*)&g)[j] <= level)) continue;
                first_row = first_row > -row ? first_row : -row;
                last_row = row;
                first = first > -column ? first : -column;
                last = last > column ? last : column;
            }
        }
    }
    store_lines(reach.extents, slot, 0, {first_row, last_row, first, last});
}

// Copy what a field of the larger grid holds in a window, or the other way.
template <bool GIVES, typename Transfer>
WARPWEAR_FN void copy_window(int slot, int slots, const Transfer& transfer)
{
    const auto &whole = GIVES ? transfer.target : transfer.field,
               &part = GIVES ? transfer.field : transfer.target;
    const int* const first = transfer.first.data;
    for (int row = slot; row < part.shape[0]; row += slots) {
        Stored* const there = row_of(whole, first[0] + row) + first[1] * OF_VECTOR;
        Stored* const here = row_of(part, row);
        for (int i = lane_of_slot(); i < part.shape[1] * OF_VECTOR; i += width_of_slot())
            (GIVES ? there : here)[i] = (GIVES ? here : there)[i];
    }
}

// The pressure of a place in the last lap, and as far ahead of that as it came since the lap before.
template <typename Lap> WARPWEAR_FN void take_lap(int slot, int slots, const Lap& lap)
{
    const double ahead = lap.ahead.data[0], cap = lap.cap;
    const Lanes zero = 0.0, most = cap;
    for (int row = slot; row < lap.pressure.shape[0]; row += slots) {
        const int offset = lap.first.data[1] * OF_VECTOR;
        const Stored* const before = row_of(lap.laps, lap.first.data[0] + row) + offset;
        const Stored* const last = row_of(lap.laps, lap.first.data[2] + row) + offset;
        Stored* const here = row_of(lap.pressure, row);
        for (int i = lane_of_slot(); i < lap.pressure.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes p = last[i], q = p + ahead * (p - before[i]);
            here[i] = p > zero ? smaller_of(larger_of(q, zero), most) : zero;
        }
    }
}

// Means of four cells, or of those that there are at the end of the grid; `ABSENT` where one of them is that.
template <typename Transfer> WARPWEAR_FN void restrict_cells(int slot, int slots, const Transfer& transfer)
{
    const auto &fine = transfer.field, &coarse = transfer.target;
    const int rows = fine.shape[0], columns = transfer.columns;
    for (int row = slot; row < coarse.shape[0]; row += slots) {
        const double* const first = (const double*)row_of(fine, 2 * row);
        const double* const second = 2 * row + 1 < rows ? (const double*)row_of(fine, 2 * row + 1) : nullptr;
        for (int i = lane_of_slot(); 2 * i < columns; i += width_of_slot()) {
            const bool is_pair = 2 * i + 1 < columns;
            double sum = first[2 * i] + (is_pair ? first[2 * i + 1] : 0.0);
            if (second) sum += second[2 * i];
            if (second && is_pair) sum += second[2 * i + 1];
            const double mean = sum * (second ? 0.5 : 1.0) * (is_pair ? 0.5 : 1.0);
            ((double*)row_of(coarse, row))[i] = mean >= 1.0e-3 * ABSENT ? ABSENT : mean;
        }
    }
}

// Give each cell the value of the wide cell that it lies in.
template <typename Transfer> WARPWEAR_FN void prolong_cells(int slot, int slots, const Transfer& transfer)
{
    const auto &coarse = transfer.field, &fine = transfer.target;
    const int columns = transfer.columns;
    for (int row = slot; row < fine.shape[0]; row += slots) {
        const double* const values = (const double*)row_of(coarse, row / 2);
        double* const cells = (double*)row_of(fine, row);
        for (int i = lane_of_slot(); i < columns; i += width_of_slot()) cells[i] = values[i / 2];
    }
}
