#pragma once
// Which cells of a contact are bare of film: those that every body which carries one has lost it from.

#include "bodies.h"

// What a body has lost since its film was last whole. It is whole again where the body was not worn over the
// last `regrowth` of the distance.
template <typename Coat>
WARPWEAR_FN Lanes lost(const Coat& coat, int row, int i, double distance, double regrowth)
{
    Lanes wear = row_of(coat.wear, row)[i];
    if (coat.whole.shape[0] == 0) return wear;
    Stored* const whole = row_of(coat.whole, row);
    const Lanes rubbed = row_of(coat.rubbed, row)[i];
    const Lanes since = distance - rubbed >= regrowth ? wear : (Lanes)whole[i];
    whole[i] = since;
    return wear - since;
}

// 1 where a cell is bare as a step begins, else 0, and what cap and shear strength that leaves it.
template <typename Slide, typename Films, typename Properties>
WARPWEAR_FN void update_film(const Slide& slide, const Films& films, const Properties& cells, int row,
                             int under, const Span& span)
{
    const bool on_counter = films.counter.wear.shape[0] > 0, on_disc = films.disc.wear.shape[0] > 0;
    const Lanes zero = 0.0, one = 1.0;
    const Lanes cap_bare = films.cap_bare, cap_filmed = films.cap_filmed, shear_filmed = films.shear_filmed;
    Stored* const material = row_of(cells.material, row);
    Stored* const cap_ratio = cells.cap_ratio.shape[0] > 0 ? row_of(cells.cap_ratio, row) : nullptr;
    Stored* const shear_ratio = cells.shear_ratio.shape[0] > 0 ? row_of(cells.shear_ratio, row) : nullptr;
    for (int i = span.first; i < span.end; i += span.stride) {
        Lanes here = one;
        const auto look_at = [&](const auto& coat, int of_coat) {
            here = lost(coat, of_coat, i, slide.start, films.regrowth) > films.thickness ? here : zero;
        };
        if (on_counter) look_at(films.counter, row);
        if (on_disc) look_at(films.disc, under);
        material[i] = here;
        if (cap_ratio) cap_ratio[i] = here > zero ? cap_bare : cap_filmed;
        if (shear_ratio) shear_ratio[i] = here > zero ? one : shear_filmed;
    }
}

// Note the distance at the end of a step where a body was worn in it.
template <typename Slide, typename Coat>
WARPWEAR_FN void record_wear_of(const Slide& slide, const Coat& coat, int row, const Span& span)
{
    const Stored* const wear = row_of(coat.wear, row);
    Stored *const seen = row_of(coat.seen, row), *const rubbed = row_of(coat.rubbed, row);
    const Lanes now = slide.end;
    for (int i = span.first; i < span.end; i += span.stride) {
        rubbed[i] = wear[i] > seen[i] ? now : (Lanes)rubbed[i];
        seen[i] = wear[i];
    }
}

template <typename Slide, typename Films>
WARPWEAR_FN void record_wear(const Slide& slide, const Films& films, int row, int under, const Span& span)
{
    if (films.counter.seen.shape[0] > 0) record_wear_of(slide, films.counter, row, span);
    if (films.disc.seen.shape[0] > 0) record_wear_of(slide, films.disc, under, span);
}

// Bare cells among those under a pressure.
template <typename Slides, typename Properties, typename Field, typename Table>
WARPWEAR_FN void count_bare(int slot, int slots, const Slides& slides, const Properties& cells,
                            const Field& pressures, Table& sums)
{
    const Lanes zero = 0.0;
    Lanes sum = 0.0;
    for (int row = slot; row < wp::index(slides, 0).rows; row += slots) {
        const Stored *const pressure = row_of(pressures, row), *const bare = row_of(cells.material, row);
        for (int i = lane_of_slot(); i < pressures.shape[1] * OF_VECTOR; i += width_of_slot())
            sum += pressure[i] > zero ? (Lanes)bare[i] : zero;
    }
    store_sum(sums, 0, slot, total(sum));
}
