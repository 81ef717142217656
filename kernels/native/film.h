#pragma once
// Which cells of a contact are bare of film: those that every body which carries one has lost it from.

#include "bodies.h"

// Vectors of a row that hold the columns ever touched, in `Lanes`: from the first, and up to the last.
template <typename Slide> WARPWEAR_FN int first_lanes(const Slide& slide)
{ return slide.first_column / 8 * OF_VECTOR; }

template <typename Slide> WARPWEAR_FN int end_lanes(const Slide& slide)
{ return (slide.end_column + 7) / 8 * OF_VECTOR; }

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
template <typename Slides, typename Films>
WARPWEAR_FN void look_at_film(int slot, int slots, const Slides& slides, const Films& films)
{
    const auto& slide = wp::index(slides, 0);
    const int first = first_lanes(slide), end = end_lanes(slide);
    const bool on_counter = films.counter.wear.shape[0] > 0, on_disc = films.disc.wear.shape[0] > 0;
    const Lanes zero = 0.0, one = 1.0;
    const Lanes cap_bare = films.cap_bare, cap_filmed = films.cap_filmed, shear_filmed = films.shear_filmed;
    for (int row = slot; row < films.cells.material.shape[0]; row += slots) {
        const int under = on_disc ? under_row(row, slide.shift, films.disc.wear.shape[0]) : 0;
        Stored* const bare = row_of(films.cells.material, row);
        Stored* const cap_ratio =
            films.cells.cap_ratio.shape[0] > 0 ? row_of(films.cells.cap_ratio, row) : nullptr;
        Stored* const shear_ratio =
            films.cells.shear_ratio.shape[0] > 0 ? row_of(films.cells.shear_ratio, row) : nullptr;
        for (int i = first + lane_of_slot(); i < end; i += width_of_slot()) {
            Lanes here = one;
            if (on_counter) {
                const Lanes depth = lost(films.counter, row, i, slide.start, films.regrowth);
                here = depth > films.thickness ? here : zero;
            }
            if (on_disc) {
                const Lanes depth = lost(films.disc, under, i, slide.start, films.regrowth);
                here = depth > films.thickness ? here : zero;
            }
            bare[i] = here;
            if (cap_ratio) cap_ratio[i] = here > zero ? cap_bare : cap_filmed;
            if (shear_ratio) shear_ratio[i] = here > zero ? one : shear_filmed;
        }
    }
}

// Note the distance at the end of a step where a body was worn in it.
template <typename Slide, typename Coat>
WARPWEAR_FN void rub_coat(const Coat& coat, int row, const Slide& slide)
{
    const Stored* const wear = row_of(coat.wear, row);
    Stored *const seen = row_of(coat.seen, row), *const rubbed = row_of(coat.rubbed, row);
    const Lanes now = slide.end;
    for (int i = first_lanes(slide) + lane_of_slot(); i < end_lanes(slide); i += width_of_slot()) {
        rubbed[i] = wear[i] > seen[i] ? now : (Lanes)rubbed[i];
        seen[i] = wear[i];
    }
}

template <typename Slides, typename Films>
WARPWEAR_FN void rub_film(int slot, int slots, const Slides& slides, const Films& films)
{
    const auto& slide = wp::index(slides, 0);
    for (int row = slot; row < films.cells.material.shape[0]; row += slots) {
        if (films.counter.seen.shape[0] > 0) rub_coat(films.counter, row, slide);
        if (films.disc.seen.shape[0] > 0)
            rub_coat(films.disc, under_row(row, slide.shift, films.disc.seen.shape[0]), slide);
    }
}

// Bare cells among those under a pressure.
template <typename Slides, typename Films, typename Field, typename Table>
WARPWEAR_FN void count_bare(int slot, int slots, const Slides& slides, const Films& films,
                            const Field& pressures, Table& sums)
{
    const Lanes zero = 0.0;
    Lanes sum = 0.0;
    for (int row = slot; row < wp::index(slides, 0).rows; row += slots) {
        const Stored *const pressure = row_of(pressures, row), *const bare =
                                                                   row_of(films.cells.material, row);
        for (int i = lane_of_slot(); i < pressures.shape[1] * OF_VECTOR; i += width_of_slot())
            sum += pressure[i] > zero ? (Lanes)bare[i] : zero;
    }
    leave_sum(sums, 0, slot, total(sum));
}
