#pragma once
// Cells of a contact that slip by lengths of their own.

#include "bodies.h"

// What cells slip in a cycle: by their gap beyond the approach, where nothing presses. Where there is no
// surface they do not.
template <typename Slides, typename Field>
WARPWEAR_FN void slip_of_gaps(int slot, int slots, const Slides& slides, const Field& gaps,
                              const Field& pressures, const Field& slips)
{
    const auto& slide = wp::index(slides, 0);
    const Lanes by = slide.slip_of_gap, level = slide.approach, zero = 0.0;
    for (int row = slot; row < slips.shape[0]; row += slots) {
        const Stored *const gap = row_of(gaps, row), *const pressure = row_of(pressures, row);
        Stored* const slip = row_of(slips, row);
        for (int i = lane_of_slot(); i < slips.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes g = gap[i], s = by * larger_of(g - level, zero);
            const Mask none = (pressure[i] > zero) | (g > Lanes(0.5 * ABSENT));
            slip[i] = none ? zero : s;
        }
    }
}

// The compliance that a jump lends cells by their slips at its end, as far as the last jump tells.
template <typename Slides, typename Field>
WARPWEAR_FN void yields_of_slips(int slot, int slots, const Slides& slides, const Field& slips,
                                 const Field& grown, const Field& yields)
{
    const auto& slide = wp::index(slides, 0);
    const Lanes by = slide.slipping_counter + slide.slipping_disc, ahead = slide.ahead;
    for (int row = slot; row < yields.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < yields.shape[1] * OF_VECTOR; i += width_of_slot())
            row_of(yields, row)[i] = by * (row_of(slips, row)[i] + ahead * row_of(grown, row)[i]);
}
