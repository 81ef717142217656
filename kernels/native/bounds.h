#pragma once
// What bounds the gaps of pairs of tiles, made anew from the heights of both bodies.

#include "sliding.h"

// Bring the cells of every tile of a row to the largest number, or by a sign of −1 to the smallest. Every
// thread of the slot gets that of the row, times the sign.
template <typename Field, typename Numbers>
WARPWEAR_FN double bound_tiles(const Field& field, int row, double sign, const Numbers& bounds)
{
    const int vectors_per_row = field.shape[1] * OF_VECTOR, tiles = (vectors_per_row + OF_TILE - 1) / OF_TILE;
    const Stored* const values = row_of(field, row);
    double* const numbers = (double*)row_of(bounds, row);
    double of_all = -ABSENT;
    for (int t = team_of_slot(); t < tiles; t += teams_of_slot()) {
        const int last = (t + 1) * OF_TILE < vectors_per_row ? (t + 1) * OF_TILE : vectors_per_row;
        Lanes here = -ABSENT;
        for (int i = t * OF_TILE + lane_of_team(); i < last; i += TEAM)
            here = larger_of(here, sign * (Lanes)values[i]);
        const double of_tile = reduce_warp(most(here), false);
        of_all = wp::max(of_all, of_tile);
        if (lane_of_team() == 0) numbers[t] = sign * of_tile;
    }
    return reduce_slot(of_all, false);
}

// Make the bounds of all tiles of the disc's rows, and of the counter-body's.
template <typename Bodies, typename Bounds>
WARPWEAR_FN void remake_bounds(int slot, int slots, const Bodies& bodies, const Bounds& bounds)
{
    for (int row = slot; row < bodies.disc.shape[0]; row += slots) {
        const double highest = bound_tiles(bodies.disc, row, 1.0, bounds.highest);
        if (lane_of_slot() == 0) wp::index(bounds.highest_of_row, row) = highest;
        if (row >= bodies.counter.shape[0]) continue;
        bound_tiles(bodies.counter, row, -1.0, bounds.lowest);
        const double* const lowest = (const double*)row_of(bounds.lowest, row);
        for (int m = lane_of_slot(); m < bounds.lowest.shape[1]; m += width_of_slot()) {
            double low = ABSENT;
            for (int t = m * LANES * OF_VECTOR; t < (m + 1) * LANES * OF_VECTOR; ++t)
                low = wp::min(low, lowest[t]);
            wp::index(bounds.lowest_of_eight, row, m) = low;
        }
    }
}
