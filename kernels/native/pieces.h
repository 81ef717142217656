#pragma once
// Sums over the rows of a body that wears in pieces.

#include "bodies.h"

// Sums of wear and of what is pending, and the deepest wear, of rows of a body from a first one on.
template <typename Table, typename Field>
WARPWEAR_FN void total_body(int slot, int slots, int first, int count, const Field& wear_of,
                            const Field& pending_of, Table& table)
{
#if !defined(__CUDA_ARCH__)
#pragma clang fp contract(off)
#endif
    const int rows = wear_of.shape[0], of_row = wear_of.shape[1] * OF_VECTOR;
    for (int number = slot; number < count; number += slots) {
        const int row = (first + number) % rows;
        const Stored *const wear = row_of(wear_of, row), *const pending = row_of(pending_of, row);
        Lanes worn = 0.0, waits = 0.0, deepest = 0.0;
        for (int i = lane_of_slot(); i < of_row; i += width_of_slot()) {
            worn += wear[i];
            waits += pending[i];
            deepest = larger_of(deepest, wear[i]);
        }
        leave_sum(table, 0, row, total(worn));
        leave_sum(table, 1, row, total(waits));
        leave_most(table, 2, row, most(deepest));
    }
}
