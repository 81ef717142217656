#pragma once
// Cells of a contact that slip by lengths of their own.

#include "bodies.h"

// What cells slip at the end of a jump, as far as the last jump tells; what sticks does.
WARPWEAR_FN Lanes slip_ahead(Lanes slip, Lanes grown, Lanes ahead)
{
    const Lanes zero = 0.0, s = slip + ahead * grown;
    return slip > zero ? larger_of(s, zero) : zero;
}

// What cells slip in a cycle: by their gap beyond the approach, where nothing presses. Where there is no
// surface they do not. And how much more that is than before.
template <typename Slides, typename Field>
WARPWEAR_FN void slip_of_gaps(int slot, int slots, const Slides& slides, const Field& gaps,
                              const Field& pressures, const Field& slips, const Field& grown)
{
    const auto& slide = wp::index(slides, 0);
    const Lanes by = slide.removal.slip_of_gap, level = slide.approach, zero = 0.0;
    for (int row = slot; row < slips.shape[0]; row += slots) {
        const Stored *const gap = row_of(gaps, row), *const pressure = row_of(pressures, row);
        Stored* const slip = row_of(slips, row);
        for (int i = lane_of_slot(); i < slips.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes g = gap[i], s = by * larger_of(g - level, zero);
            const Mask none = (pressure[i] > zero) | (g > Lanes(0.5 * ABSENT));
            const Lanes now = none ? zero : s;
            row_of(grown, row)[i] = now - slip[i];
            slip[i] = now;
        }
    }
}

// The compliance that a jump lends cells by their slips at its end, as far as the last jump tells.
template <typename Slides, typename Field>
WARPWEAR_FN void yields_of_slips(int slot, int slots, const Slides& slides, const Field& slips,
                                 const Field& grown, const Field& yields)
{
    const auto& slide = wp::index(slides, 0);
    const Lanes by = slide.removal.slipping_counter + slide.removal.slipping_disc,
                ahead = slide.removal.growth_ahead;
    for (int row = slot; row < yields.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < yields.shape[1] * OF_VECTOR; i += width_of_slot())
            row_of(yields, row)[i] = by * slip_ahead(row_of(slips, row)[i], row_of(grown, row)[i], ahead);
}
