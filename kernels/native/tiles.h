#pragma once
// What a contact can reach: how deep a list of tiles must go, and which rows and columns.

#include "lanes.h"

// The limit up to which at least so many tiles have a cell, by their lowest gaps in every so-many-th row: the
// lowest such limit above one that is known. One thread.
template <typename Table>
WARPWEAR_FN double limit_of_rank(const Table& lowest, int rows_apart, int tiles, double limit)
{
    const auto count_to = [&](double level, double& largest) {
        int some = 0;
        largest = -NO_LIMIT;
        for (int row = 0; row < lowest.shape[0]; row += rows_apart) {
            const double* const low = &wp::index(lowest, row, 0);
            for (int t = 0; t < lowest.shape[1]; ++t) {
                some += low[t] <= level ? 1 : 0;
                const double here = low[t] <= level ? low[t] : -NO_LIMIT;
                largest = largest > here ? largest : here;
            }
        }
        return some;
    };
    double low = limit, high = limit, reach = 1.0e-6, largest = 0.0;
    int some = count_to(high, largest);
    if (some >= tiles) return limit;
    while (some < tiles) {
        low = high;
        high = low + reach;
        if (high > 0.5 * ABSENT) return NO_LIMIT;
        reach *= 4.0;
        some = count_to(high, largest);
    }
    for (int halving = 0; some != tiles && halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        double below;
        const int here = count_to(middle, below);
        if (here < tiles) {
            low = middle;
            continue;
        }
        high = middle;
        some = here;
        largest = below;
    }
    return largest;
}

// First and last row, first and last column of the cells that do not exceed a level; the first ones negated.
template <typename Gap, typename Table>
WARPWEAR_FN void extents(int slot, int slots, int columns, double level, const Gap& gap, Table& table)
{
    double first_row = -NO_LIMIT, last_row = -NO_LIMIT, first = -NO_LIMIT, last = -NO_LIMIT;
    for (int row = slot; row < gap.shape[0]; row += slots) {
        const Stored* const cells = row_of(gap, row);
        for (int i = lane_of_slot(); i < gap.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes g = cells[i];
            if (!any(g <= Lanes(level))) continue; // as in most vectors
            for (int j = 0; j < LANES; ++j) {
                const int column = i * LANES + j;
                if (column >= columns || !(((const double*)&g)[j] <= level)) continue;
                first_row = first_row > -row ? first_row : -row;
                last_row = row;
                first = first > -column ? first : -column;
                last = last > column ? last : column;
            }
        }
    }
    leave_most(table, 0, slot, first_row);
    leave_most(table, 1, slot, last_row);
    leave_most(table, 2, slot, first);
    leave_most(table, 3, slot, last);
}
