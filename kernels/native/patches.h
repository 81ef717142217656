#pragma once
#include "wear.h"
// Patches of cells on springs: what those of a patch carry, what a step wears off them, and what decisions
// over patches need beside sums.

// The number after v in the direction of `to`.
WARPWEAR_FN double next_number(double v, double to)
{
    if (!(v < to) && !(v > to)) return v;
    union {
        double number;
        long long bits;
    } next;
    next.number = v;
    if (v == 0.0) {
        next.bits = 1;
        return to > v ? next.number : -next.number;
    }
    next.bits += (v < to) == (v > 0.0) ? 1 : -1;
    return next.number;
}

// Visit the cells of a patch in the tiles that it reaches: `Lanes` by line and place in it. reaches: tells by
// the lowest gap of a tile before any wear.
template <typename Surfaces, typename Reaches, typename Visit>
WARPWEAR_FN void visit_patch(const Surfaces& surfaces, int patch, const Reaches& reaches, const Visit& visit)
{
    const double* const lowest = &wp::index(surfaces.lowest, patch, 0);
    const int of_line = surfaces.layout.vectors * OF_VECTOR, tiles = (of_line + OF_TILE - 1) / OF_TILE;
    for (int tile = team_of_slot(); tile < surfaces.lowest.shape[1]; tile += teams_of_slot()) {
        if (!reaches(lowest[tile])) continue;
        const int line = tile / tiles, first = (tile - line * tiles) * OF_TILE + lane_of_team();
        for (int place = first; place < first + OF_TILE; place += TEAM) // once on a GPU
            if (place < of_line) visit(line, place);
    }
}

// Give what was added up of a patch as its mean pressure, slope, and way of a straight line.
template <typename Table>
WARPWEAR_FN void give_answer(Table& answer, int patch, const Table& trial, double cells, double stiffness)
{
    wait_for_slot();
    if (lane_of_slot() != 0) return;
    wp::index(answer, 0, patch) = wp::index(trial, 0, patch) / cells;
    wp::index(answer, 1, patch) = wp::index(trial, 1, patch) / cells;
    wp::index(answer, 2, patch) = -wp::index(trial, 2, patch) / stiffness;
}

// Give the answer of a patch that is not reached at an approach: nothing, up to its lowest cell.
template <typename Curves>
WARPWEAR_FN void give_nothing(Curves& curves, int patch, double base, double offset)
{
    wp::index(curves.answer, 0, patch) = 0.0;
    wp::index(curves.answer, 1, patch) = 0.0;
    wp::index(curves.answer, 2, patch) = (wp::index(curves.lowest, patch) - base) - offset;
}

// Do something with what bears the cells in a step: their stiffness, or the `Bend` of their K.
template <typename Steps, typename Visit>
WARPWEAR_FN void on_springs_of(const Steps& steps, const Visit& visit)
{
    const auto& now = wp::index(steps.now, 0);
    const auto& bends = steps.bends;
    if (bends.knots.shape[0] == 0) return visit(Lanes(now.stiffness), Lanes(now.stiffness_next));
    const Bend bend(bends.knots, bends.step.data[0], bends.step.data[1] * now.removal, 0.0);
    visit(bend, bend); // such steps do not look ahead
}

// What the cells of a patch carry at its trial approach.
template <typename Steps, typename Curves, typename Surfaces>
WARPWEAR_FN void carry_patch(int patch, int, const Steps& steps, Curves& curves, const Surfaces& surfaces)
{
    const double cap = surfaces.cap, stiffness = wp::index(steps.now, 0).stiffness;
    const double base = wp::index(curves.base, patch), offset = wp::index(curves.offset, patch);
    if (!((base - wp::index(curves.lowest, patch)) + offset > 0.0)) {
        if (lane_of_slot() == 0) give_nothing(curves, patch, base, offset);
        return;
    }
    const int of_line = surfaces.layout.vectors * OF_VECTOR;
    const Stored* const gap = row_of(surfaces.gap, patch);
    const Stored* const cap_ratio = row_or_none(surfaces.cells.cap_ratio, patch);
    const Stored* const own = row_or_none(surfaces.cells.stiffness, patch);
    const auto carry_on = [&](auto is_own, const auto& alike) {
        CONTRACT_OFF
        constexpr bool OWN = decltype(is_own)::value;
        const Lanes zero = 0.0;
        Lanes pressure = 0.0, between = 0.0, nearest = ABSENT;
        double beside = ABSENT; // of the tiles that are skipped
        const auto reaches = [&](double low) {
            const double overlap = (base - low) + offset;
            if (!(overlap > 0.0)) beside = wp::min(beside, -overlap);
            return overlap > 0.0;
        };
        visit_patch(surfaces, patch, reaches, [&](int line, int place) {
            const int i = line * of_line + place;
            const Lanes most_here = cap_ratio ? Lanes(cap * cap_ratio[i]) : Lanes(cap);
            const Lanes overlap = (base - Lanes(gap[i])) + offset;
            const auto& spring = spring_at<OWN>(own, i, alike);
            const Lanes q = on_spring(overlap, spring), p = clipped(q, most_here);
            pressure += p;
            Lanes slope = slope_on_spring(overlap, spring), near = to_bound(q, most_here, spring);
            if (OWN) { // counted over the stiffness of all
                slope *= stiffness_of(spring) / stiffness;
                near = near / slope;
            }
            between += p > zero && q < most_here ? slope : zero;
            nearest = nearest < near ? nearest : near;
        });
        store_partials(
            {{total(pressure), &wp::index(surfaces.trial, 0, patch), true},
             {total(between) * stiffness, &wp::index(surfaces.trial, 1, patch), true},
             {-wp::min(-most(-nearest), beside * stiffness), &wp::index(surfaces.trial, 2, patch), false}});
        give_answer(curves.answer, patch, surfaces.trial, surfaces.cells_of_patch, stiffness);
    };
    on_springs_of(steps, [&](const auto& spring, const auto&) {
        own ? carry_on(Is<true>(), spring) : carry_on(Is<false>(), spring);
    });
}

// Lay the pressures of a patch at its solved approach, and what both bodies have lost there.
template <typename Steps, typename Curves, typename Surfaces, typename Field>
WARPWEAR_FN void press_patch(int patch, int slots, const Steps& steps, const Curves& curves,
                             const Surfaces& surfaces, Field& pressure_out)
{
    const double cap = surfaces.cap;
    const double base = wp::index(curves.base, patch), offset = wp::index(curves.offset, patch);
    const bool touches = (base - wp::index(curves.lowest, patch)) + offset > 0.0;
    const Stored* const gap = row_of(surfaces.gap, patch);
    const Stored* const cap_ratio = row_or_none(surfaces.cells.cap_ratio, patch);
    Stored* const pressure = row_of(pressure_out, patch);
    const Stored* const own = row_or_none(surfaces.cells.stiffness, patch);
    const Lanes zero = 0.0;
    const auto press = [&](auto is_own, const auto& alike) {
        for (int i = lane_of_slot(); i < surfaces.gap.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes most_here = cap_ratio ? Lanes(cap * cap_ratio[i]) : Lanes(cap);
            const auto& spring = spring_at<decltype(is_own)::value>(own, i, alike);
            const Lanes p = clipped(on_spring((base - Lanes(gap[i])) + offset, spring), most_here);
            pressure[i] = touches ? p : zero;
        }
    };
    on_springs_of(steps, [&](const auto& spring, const auto&) {
        own ? press(Is<true>(), spring) : press(Is<false>(), spring);
    });
}

template <typename Surfaces, typename Field>
WARPWEAR_FN void worn_of_patch(int patch, int slots, const Surfaces& surfaces, Field& worn_out)
{
    const Stored* const gap = row_of(surfaces.gap, patch);
    const Stored* const unworn = row_of(surfaces.unworn, patch);
    Stored* const worn = row_of(worn_out, patch);
    for (int i = lane_of_slot(); i < surfaces.gap.shape[1] * OF_VECTOR; i += width_of_slot())
        worn[i] = Lanes(gap[i]) - Lanes(unworn[i]);
}

// Rows and columns of the domain in which a worn patch was ever touched, beyond those that are known.
template <typename Surfaces, typename Now, typename Reaches>
WARPWEAR_FN Extents extents_of(int patch, const Surfaces& surfaces, const WearBy& by, const Now& now,
                               const Reaches& reaches)
{
    Extents extents;
    const int of_line = surfaces.layout.vectors * OF_VECTOR;
    const int lines = surfaces.gap.shape[1] / surfaces.layout.vectors;
    const int row = wp::index(surfaces.layout.first_row, patch);
    const int column = wp::index(surfaces.layout.first_column, patch);
    if (-row <= now.extents[0] && row + lines - 1 <= now.extents[1] && -column <= now.extents[2] &&
        column + of_line * LANES - 1 <= now.extents[3])
        return extents;
    const double* const gap = (const double*)row_of(surfaces.gap, patch);
    const double* const unworn = (const double*)row_of(surfaces.unworn, patch);
    visit_patch(surfaces, patch, reaches, [&](int line, int place) {
        for (int i = place * LANES; i < place * LANES + LANES; ++i) {
            const int cell = line * of_line * LANES + i;
            if (!was_touched(by, gap[cell], unworn[cell])) continue;
            extents.first_row = wp::max(extents.first_row, -double(row + line));
            extents.last_row = wp::max(extents.last_row, double(row + line));
            extents.first_column = wp::max(extents.first_column, -double(column + i));
            extents.last_column = wp::max(extents.last_column, double(column + i));
        }
    });
    return extents;
}

// Wear the cells of a patch that it has reached or reaches next, and leave what they add up to. Where the
// next step is foreseen the patch answers for it as well.
template <typename Steps, typename Curves, typename Courses, typename Surfaces, typename Books>
WARPWEAR_FN void wear_patch(int patch, int slots, const Steps& steps, Curves& curves, const Courses& courses,
                            const Surfaces& surfaces, Books& books)
{
    const auto& now = wp::index(steps.now, 0);
    const double base = wp::index(curves.base, patch), offset = wp::index(curves.offset, patch);
    const double base_next = wp::index(courses.base_next, patch);
    const double offset_next = wp::index(courses.offset_next, patch);
    const double lowest = wp::index(curves.lowest, patch), reached = wp::index(courses.reached, patch);
    const bool touches = (base - lowest) + offset > 0.0;
    const bool touches_next = (base_next - lowest) + offset_next > 0.0;
    if (!touches && !touches_next && !(lowest < reached)) {
        if (lane_of_slot() != 0) return;
        for (int line = 0; line < books.sums.shape[0]; ++line) wp::index(books.sums, line, patch) = 0.0;
        for (int line = 0; line < books.maxima.shape[0]; ++line)
            wp::index(books.maxima, line, patch) = line < 2 ? 0.0 : NO_INDEX;
        if (steps.looks_ahead) give_nothing(curves, patch, base_next, offset_next);
        return;
    }
    const WearBy by = {base,      offset,        surfaces.cap,      0.0,
                       0.0,       now.stiffness, now.removal,       now.reference,
                       base_next, offset_next,   now.stiffness_next};
    const int of_line = surfaces.layout.vectors * OF_VECTOR;
    const Stored* const unworn = row_of(surfaces.unworn, patch);
    const Stored* const cap_ratio = row_or_none(surfaces.cells.cap_ratio, patch);
    Stored* const gap = row_of(surfaces.gap, patch);
    const Lanes cap = by.cap;
    WearSums sums;
    double beside = ABSENT;
    const auto was_reached = [&](double low) { return low < reached || (base - low) + offset > 0.0; };
    const auto reaches = [&](double low) {
        const double next = (base_next - low) + offset_next;
        const bool is_near = was_reached(low) || next > 0.0;
        if (!is_near) beside = wp::min(beside, -next * by.stiffness_next);
        return is_near;
    };
    on_springs_of(steps, [&](const auto& spring, const auto& next) {
        visit_patch(surfaces, patch, reaches, [&](int line, int place) {
            const int i = line * of_line + place;
            fetch((const double*)(gap + i + 16)); // a fifth of the time, where fields do not fit the cache
            fetch((const double*)(unworn + i + 16));
            const Lanes most_here = cap_ratio ? Lanes(by.cap * cap_ratio[i]) : cap;
            Counts touched;
            gap[i] = wear_cell(sums, by, spring, next, gap[i], unworn[i], most_here, touched);
        });
    });
    const Extents extents = extents_of(patch, surfaces, by, now, was_reached);
    store_wear<Bend>(books, patch, sums, extents, by.stiffness_next, 0.0, 0.0, beside);
    if (steps.looks_ahead)
        give_answer(curves.answer, patch, books.ahead, surfaces.cells_of_patch, by.stiffness_next);
}
