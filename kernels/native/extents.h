#pragma once
#include "lanes.h"
// Which cells of a gap a contact can reach.

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
