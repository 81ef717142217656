#pragma once
// What a contact can reach: the tiles listed, and how deep a list must go.

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

// List the tiles of a row whose smallest gap does not exceed the limit. Gaps of those that were not listed
// are what they were; of one that leaves the list its worn cells and the sum of their wear are kept. On a
// CPU.
template <typename Lists, typename Field, typename Tiles>
WARPWEAR_FN void list_tiles(int slot, int slots, const Lists& lists, const Field& gaps,
                            const Field& unworn_in, const Tiles& tiles)
{
    const auto& listing = wp::index(lists, 0);
    const int vectors_per_row = gaps.shape[1] * OF_VECTOR;
    for (int row = slot; row < gaps.shape[0]; row += slots) {
        const Stored *const gap = row_of(gaps, row), *const unworn = row_of(unworn_in, row);
        int *const list = &wp::index(tiles.list, row, 0), &listed = wp::index(tiles.count, row);
        double* const lowest = &wp::index(tiles.lowest, row, 0);
        for (int n = listing.is_fresh == 1 ? listed : 0; n < listed; ++n) {
            const int t = list[n], end = (t + 1) * OF_TILE;
            const Lanes zero = 0.0;
            Lanes low = ABSENT, worn = 0.0;
            Counts touched = 0;
            for (int i = t * OF_TILE; i < (end < vectors_per_row ? end : vectors_per_row); ++i) {
                const Lanes lost = gap[i] - unworn[i];
                low = smaller_of(low, gap[i]);
                worn += lost;
                touched += one_if(lost > zero);
            }
            lowest[t] = -most(-low);
            if (lowest[t] > listing.limit) wp::index(tiles.kept, row, t) = {count(touched), total(worn)};
        }
        listed = 0;
        auto& rest = wp::index(tiles.rest, row);
        rest = {0.0, 0.0};
        for (int t = 0; t < tiles.lowest.shape[1]; ++t)
            if (lowest[t] <= listing.limit)
                list[listed++] = t;
            else
                rest = rest + wp::index(tiles.kept, row, t);
    }
}
