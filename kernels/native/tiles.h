#pragma once
// What a contact can reach: how deep a list of tiles must go.

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
