#pragma once
// A ball and a disc displaced under it by whole rows.

#include "lanes.h"

// The disc's row under a row of the counter-body; 0 <= shift < rows of the disc.
WARPWEAR_FN int under_row(int row, int shift, int rows)
{
    const int displaced = row + shift;
    return displaced < rows ? displaced : displaced - rows;
}

// Threads that visit a tile together: on a CPU the one of the slot, on a GPU a warp, a cell each.
#if defined(__CUDA_ARCH__)
static const int TEAM = 32;
#else
static const int TEAM = 1;
#endif

WARPWEAR_FN int team_of_slot() { return lane_of_slot() / TEAM; }
WARPWEAR_FN int teams_of_slot() { return (width_of_slot() + TEAM - 1) / TEAM; }
WARPWEAR_FN int lane_of_team() { return lane_of_slot() % TEAM; }

// Bring what the threads of a team have to one number, in the first of them.
WARPWEAR_FN double reduce_team(double value, bool adds)
{
#if defined(__CUDA_ARCH__)
    for (int apart = TEAM / 2; apart > 0; apart /= 2) {
        const double other = __shfl_down_sync(0xffffffff, value, apart);
        value = adds ? value + other : (value > other ? value : other);
    }
#endif
    return value;
}

// Some cells of a row, as a thread visits them.
struct Span {
    int first, end, stride;
};

// Those of a tile, by the threads of a team.
WARPWEAR_FN Span span_of_tile(int t, int vectors_per_row)
{
    const int end = (t + 1) * OF_TILE;
    return {t * OF_TILE + lane_of_team(), end < vectors_per_row ? end : vectors_per_row, TEAM};
}

// Numbers of the lanes, added to the index of the first cell.
WARPWEAR_FN Lanes columns_from(int first)
{
#if defined(__CUDA_ARCH__)
    return double(first);
#else
    const Lanes lane = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    return lane + double(first);
#endif
}

WARPWEAR_FN Lanes larger_of(Lanes a, Lanes b) { return a > b ? a : b; }
WARPWEAR_FN Lanes smaller_of(Lanes a, Lanes b) { return a < b ? a : b; }

// A depth [mm] to divide by where shear wears nothing.
static const double NEARLY_NONE = 1e-200;

// What of a depth [mm] that shear wears all cells lose, at least.
template <typename Slide> WARPWEAR_FN double least_shear(const Slide& slide)
{ return (slide.removal.shear_counter + slide.removal.shear_disc) * slide.removal.least_shear_ratio; }

static const int OVERFLOW_BEFORE = 5; // where a body counts what had overflowed, as in pieces.py

// Sums of wear and of what is pending, and the deepest wear, of the rows of a body that a step may have
// changed: those under the contact and beside it, or all where pieces had overflowed.
template <typename Slides, typename Footprint, typename Body, typename Field>
WARPWEAR_FN void total_body(int slot, int slots, const Slides& slides, const Footprint& footprint,
                            const Body& body, const Field& wear_of, const Field& pending_of)
{
#if !defined(__CUDA_ARCH__)
#pragma clang fp contract(off)
#endif
    const auto& slide = wp::index(slides, 0);
    const int rows = wear_of.shape[0], vectors_per_row = wear_of.shape[1] * OF_VECTOR;
    int first = slide.shift * body.number - footprint.margin, count = slide.rows + 2 * footprint.margin;
    if (wp::index(body.counts, OVERFLOW_BEFORE) > 0) {
        first = 0;
        count = rows;
    } else if (body.periodic == 0) {
        count = wp::min(first + count, rows) - wp::max(first, 0);
        first = wp::max(first, 0);
    }
    count = wp::min(count, rows);
    for (int number = slot; number < count; number += slots) {
        const int row = (first + rows + number) % rows;
        const Stored *const wear = row_of(wear_of, row), *const pending = row_of(pending_of, row);
        Lanes worn = 0.0, waits = 0.0, deepest = 0.0;
        for (int i = lane_of_slot(); i < vectors_per_row; i += width_of_slot()) {
            worn += wear[i];
            waits += pending[i];
            deepest = larger_of(deepest, wear[i]);
        }
        store_sum(body.of_rows, 0, row, total(worn));
        store_sum(body.of_rows, 1, row, total(waits));
        store_most(body.of_rows, 2, row, most(deepest));
    }
}
