#pragma once
// What each material of two bodies bears and loses in a step: books that know nothing of the pass that wears.

#include "springs.h"
#include "wear_from_pressure.h"

// Materials of a body that have books of their own; of a body with more, the first has those of all.
static const int BOOKED = 8;

// Cells in contact, their pressure [MPa] and the depth lost [mm] of the materials of a body.
enum { CELLS_IN_CONTACT, PRESSURE_BORNE, DEPTH_LOST, BOOKS };
typedef double MaterialBook[BOOKS][BOOKED];

// Book a cell, which counts as so many in contact. The depth lost is counted by K ΔL p of the uppermost
// material from the unworn surface: before the step and with it.
WARPWEAR_FN void book_cell(const Materials& materials, double depth, double pressure, double k, double cells,
                           MaterialBook& book)
{
    const auto line = [&](int m) { return materials.count > BOOKED ? 0 : m; };
    const auto last_before = [&](int what, double value) {
        int m = 0;
        while (m + 1 < materials.count && value >= materials.of(what, m + 1)) ++m;
        return m;
    };
    const int first = last_before(BEGINS, depth);
    book[CELLS_IN_CONTACT][line(first)] += cells;
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

// Books of the counter-body and of the disc, and the sum of the shear ratios.
struct Books {
    MaterialBook of_body[2] = {};
    double sheared = 0.0;

    // Book cells under a pressure; borne: what each body sees of it.
    template <typename Slide>
    CUDA_CALLABLE void enter(const Slide& step, const CellRow& own, Lanes pressure, const PerBody& borne,
                             const PerBody& worn)
    {
        const auto one = [&](double p, double by_counter, double by_disc, double counter, double disc) {
            const double touches = p > 0.0 ? 1.0 : 0.0;
            if (own.counter.count > 0 && by_counter + touches > 0.0)
                book_cell(own.counter, counter, by_counter, step.k_counter, touches, of_body[0]);
            if (own.disc.count > 0 && by_disc + touches > 0.0)
                book_cell(own.disc, disc, by_disc, step.k_disc, touches, of_body[1]);
            if (p > 0.0) sheared += wp::min(shear_of(own.counter, counter, p), shear_of(own.disc, disc, p));
        };
#if defined(__CUDA_ARCH__)
        one(pressure, borne.counter, borne.disc, worn.counter, worn.disc);
#else
        for (int j = 0; j < LANES; ++j)
            one(pressure[j], borne.counter[j], borne.disc[j], worn.counter[j], worn.disc[j]);
#endif
    }
    // Leave them in the lines of a table.
    template <typename Table> CUDA_CALLABLE void leave(Table& sums, int slot) const
    {
        const int lines = 2 * BOOKS * BOOKED;
        for (int line = 0; line < lines; ++line) leave_sum(sums, line, slot, (&of_body[0][0][0])[line]);
        leave_sum(sums, lines, slot, sheared);
    }
};

// Book the materials of the tiles listed, as they were when the step began.
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
    Books books;
    for (int row = slot; row < gaps.shape[0]; row += slots) {
        const CellRow own(cells, row);
        const Stored* const gap = row_of(gaps, row);
        const Stored* const worn_counter = row_of(sources.wear_counter, row);
        const Stored* const worn_disc = row_of(sources.wear_disc, row_beneath(row, step, sources));
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot()) {
            const Span span = span_of_tile(wp::index(list, row, n), of_row);
            for (int i = span.first; i < span.end; i += span.stride) {
                const Lanes overlap = (law.base - gap[i]) + law.offset;
                const Lanes stiffness = own_or(own.stiffness, i, stiffness_of_all);
                const Lanes cap_ratio = own_or(own.cap_ratio, i, one);
                Lanes p = clipped(on_spring(overlap - law.tie_width, stiffness), law.cap * cap_ratio);
                p = size_of(overlap) > law.tie_width ? p : tie_pressure * cap_ratio;
                if (any(p > zero)) books.enter(step, own, p, {p, p}, {worn_counter[i], worn_disc[i]});
            }
        }
    }
    books.leave(sums, slot);
}

// The same of a stored pressure, and of its mean where one body wears by that.
template <typename Slides, typename Pressed, typename Sources, typename Table>
WARPWEAR_FN void book_pressed(int slot, int slots, const Slides& slides, const Pressed& pressed,
                              const Sources& sources, Table& sums)
{
    const auto& step = wp::index(slides, 0);
    const Lanes zero = 0.0;
    const bool turned = step.counter_moves == 1;
    Books books;
    for (int row = slot; row < step.rows; row += slots) {
        const CellRow own(pressed.cells, row);
        const Stored* const pressure = row_of(pressed.pressure, row);
        const Stored* const passing = mean_of(pressed.pressure, pressed.means, row, step.window);
        const Stored* const worn_counter = row_of(sources.wear_counter, row);
        const Stored* const worn_disc = row_of(sources.wear_disc, row_beneath(row, step, sources));
        for (int i = lane_of_slot(); i < pressed.pressure.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes p = pressure[i], mean = passing[i];
            if (!any(p + mean > zero)) continue;
            const PerBody borne = {turned ? p : mean, turned ? mean : p};
            books.enter(step, own, p, borne, {worn_counter[i], worn_disc[i]});
        }
    }
    books.leave(sums, slot);
}
