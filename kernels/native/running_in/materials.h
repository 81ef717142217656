#pragma once
// What each material of two bodies bears and loses in a step: books that know nothing of the pass that wears.

#include "running_in/sources.h"
#include "springs.h"

// Materials of a body that have books of their own; of a body with more, the first has those of all.
static const int BOOKED = 8;

// Cells in contact, their pressure [MPa] and the depth lost [mm] of the materials of a body.
enum { CELLS_IN_CONTACT, PRESSURE_BORNE, DEPTH_LOST, BOOKS };
typedef double MaterialBook[BOOKS][BOOKED];

// Book a cell. The depth lost is counted by K ΔL p of the uppermost material from the unworn surface: before
// the step and with it.
WARPWEAR_FN void book_cell(const Materials& materials, double depth, double pressure, double k,
                           MaterialBook& book)
{
    const auto line = [&](int m) { return materials.count > BOOKED ? 0 : m; };
    const auto last_before = [&](int what, double value) {
        int m = 0;
        while (m + 1 < materials.count && value >= materials.of(what, m + 1)) ++m;
        return m;
    };
    const int first = last_before(BEGINS, depth);
    book[CELLS_IN_CONTACT][line(first)] += 1.0;
    book[PRESSURE_BORNE][line(first)] += pressure;
    const double exposure = k * pressure + materials.of(EXPOSURE, first) +
                            needed_for(depth - materials.of(BEGINS, first), materials.of(RATIO, first),
                                       materials.of(RATIO_SLOPE, first));
    const int last = last_before(EXPOSURE, exposure);
    const double end =
        materials.of(BEGINS, last) + worn_by(exposure - materials.of(EXPOSURE, last),
                                             materials.of(RATIO, last), materials.of(RATIO_SLOPE, last));
    for (int m = first; m <= last; ++m) {
        const double begin = m == first ? depth : materials.of(BEGINS, m);
        book[DEPTH_LOST][line(m)] += (m == last ? end : materials.of(BEGINS, m + 1)) - begin;
    }
}

// The shear of a cell over the shear strength of the bodies: that of the weaker of both materials.
WARPWEAR_FN double shear_of(const Materials& materials, double depth, double pressure)
{
    if (materials.count == 0) return NO_LIMIT;
    const int m = materials.at(depth);
    return wp::min(materials.of(STRENGTH, m), materials.of(COEFFICIENT, m) * pressure);
}

// Book the materials of the tiles listed, as they were when the step began: a table has a line for each of
// the books of the counter-body and of the disc, then one of the sum of the shear ratios.
template <typename List, typename Count, typename Slides, typename Springs, typename Sources,
          typename Properties, typename Gap, typename Table>
WARPWEAR_FN void book_materials(int slot, int slots, const List& list, const Count& counts,
                                const Slides& slides, const Springs& springs, const Sources& sources,
                                const Properties& cells, const Gap& gaps, Table& sums)
{
    const auto& step = wp::index(slides, 0);
    const auto& law = wp::index(springs.law, 0);
    const Lanes stiffness_of_all = wp::index(springs.search, 0).stiffness, zero = 0.0, one = 1.0;
    const Lanes tie_pressure = law.tie_pressure;
    const int of_row = gaps.shape[1] * OF_VECTOR;
    MaterialBook books[2] = {};
    double sheared = 0.0;
    for (int row = slot; row < gaps.shape[0]; row += slots) {
        const CellRow own(cells, row);
        const Stored* const gap = row_of(gaps, row);
        const Stored* const worn_counter = row_of(sources.wear_counter, row);
        const Stored* const worn_disc = row_of(sources.wear_disc, row_beneath(row, step, sources));
        const auto book = [&](double p, double counter, double disc) {
            if (!(p > 0.0)) return;
            if (own.counter.count > 0) book_cell(own.counter, counter, p, step.k_counter, books[0]);
            if (own.disc.count > 0) book_cell(own.disc, disc, p, step.k_disc, books[1]);
            sheared += wp::min(shear_of(own.counter, counter, p), shear_of(own.disc, disc, p));
        };
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot()) {
            const Span span = span_of_tile(wp::index(list, row, n), of_row);
            for (int i = span.first; i < span.end; i += span.stride) {
                const Lanes overlap = (law.base - gap[i]) + law.offset;
                const Lanes stiffness = own_or(own.stiffness, i, stiffness_of_all);
                const Lanes cap_ratio = own_or(own.cap_ratio, i, one);
                Lanes p = clipped(on_spring(overlap - law.tie_width, stiffness), law.cap * cap_ratio);
                p = size_of(overlap) > law.tie_width ? p : tie_pressure * cap_ratio;
                if (!any(p > zero)) continue;
                const Lanes counter = worn_counter[i], disc = worn_disc[i];
#if defined(__CUDA_ARCH__)
                book(p, counter, disc);
#else
                for (int j = 0; j < LANES; ++j) book(p[j], counter[j], disc[j]);
#endif
            }
        }
    }
    const int lines = 2 * BOOKS * BOOKED;
    for (int line = 0; line < lines; ++line) leave_sum(sums, line, slot, (&books[0][0][0])[line]);
    leave_sum(sums, lines, slot, sheared);
}
