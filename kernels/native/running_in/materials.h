#pragma once
// What each material of two bodies bears and loses in a step: books that know nothing of the pass that wears.

#include "springs.h"
#include "wear_from_pressure.h"

// Materials of a body that have books of their own; of a body with more, the first has those of all.
static const int BOOKED = 8;

// Cells in contact, their pressure [MPa] and the depth lost [mm] of the materials of a body.
enum { CELLS_IN_CONTACT, PRESSURE_BORNE, DEPTH_LOST, BOOKS };
typedef Lanes MaterialBook[BOOKS][BOOKED];

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
    const Lanes in_lane = {1.0};
    book[CELLS_IN_CONTACT][line(first)] += in_lane * cells;
    book[PRESSURE_BORNE][line(first)] += in_lane * pressure;
    const double exposure = k * pressure + materials.of(EXPOSURE, first) +
                            needed_for(depth - materials.of(BEGINS, first), materials.of(RATIO, first),
                                       materials.of(RATIO_SLOPE, first));
    const int last = last_before(EXPOSURE, exposure);
    const double end =
        materials.of(BEGINS, last) + worn_by(exposure - materials.of(EXPOSURE, last),
                                             materials.of(RATIO, last), materials.of(RATIO_SLOPE, last));
    for (int m = first; m <= last; ++m) {
        const double begin = m == first ? depth : materials.of(BEGINS, m);
        book[DEPTH_LOST][line(m)] += in_lane * ((m == last ? end : materials.of(BEGINS, m + 1)) - begin);
    }
}

// The shear of cells over the shear strength of the bodies, by the material of one.
WARPWEAR_FN Lanes shear_of(const Materials& materials, Lanes depth, Lanes pressure)
{
    Lanes strength = NO_LIMIT, coefficient = NO_LIMIT;
    for (int m = 0; m < materials.count; ++m) {
        const Mask here = depth >= Lanes(materials.of(BEGINS, m));
        strength = here ? Lanes(materials.of(STRENGTH, m)) : strength;
        coefficient = here ? Lanes(materials.of(COEFFICIENT, m)) : coefficient;
    }
    return smaller_of(strength, coefficient * pressure);
}

// Books of the counter-body and of the disc, and the sum of the shear ratios: that of the weakest that meets.
struct Books {
    MaterialBook of_body[2] = {};
    Lanes sheared = 0.0;

    // Book cells of a body, all at once where none wears through a material.
    CUDA_CALLABLE static void of_cells(const Materials& materials, double k, Lanes touches, Lanes pressure,
                                       Lanes depth, MaterialBook& book)
    {
        Lanes lost;
        const Lanes zero = 0.0;
        const bool within = materials.count <= BOOKED && lost_within(materials, depth, k * pressure, lost);
        for (int m = 0; within && m < materials.count; ++m) {
            const Lanes begin = materials.of(BEGINS, m), end = materials.end_of(m);
            const Mask here = (depth >= begin) & (depth < end);
            book[CELLS_IN_CONTACT][m] += here ? touches : zero;
            book[PRESSURE_BORNE][m] += here ? pressure : zero;
            book[DEPTH_LOST][m] += here ? lost : zero;
        }
        if (within || materials.count == 0) return;
        const auto book_one = [&](double d, double p, double touched) {
            if (p + touched > 0.0) book_cell(materials, d, p, k, touched, book);
            return 0.0;
        };
        each_lane(book_one, depth, pressure, touches);
    }

    // Book cells under a pressure. borne: what each body sees of it.
    template <typename Slide, typename Sources>
    CUDA_CALLABLE void enter(const Slide& step, const Sources& sources, const CellRow& own, int i,
                             Lanes pressure, const PerBody& borne, const PerBody& worn)
    {
        const Lanes zero = 0.0, one = 1.0, touches = pressure > zero ? one : zero;
        of_cells(own.counter, step.removal.k_counter, touches, borne.counter, worn.counter, of_body[0]);
        of_cells(own.disc, step.removal.k_disc, touches, borne.disc, worn.disc, of_body[1]);
        const Lanes filmed = sources.films.shear_filmed, limit = sources.largest_shear * pressure;
        const Lanes bare = own.counter.count + own.disc.count > 0 ? NO_LIMIT : 1.0;
        const Lanes strength = own_or(own.material, i, one) > zero ? bare : filmed;
        const Lanes shear = smaller_of(shear_of(own.counter, worn.counter, pressure),
                                       shear_of(own.disc, worn.disc, pressure));
        sheared += pressure > zero ? smaller_of(smaller_of(strength, limit), shear) : zero;
    }

    // Leave those of as many materials as there are in the lines of a table.
    template <typename Properties, typename Table>
    CUDA_CALLABLE void leave(const Properties& cells, Table& sums, int slot) const
    {
        const int counts[] = {cells.materials_counter.shape[1], cells.materials_disc.shape[1]};
        for (int book = 0; book < 2 * BOOKS; ++book)
            for (int m = 0; m < BOOKED && m < counts[book / BOOKS]; ++m)
                store_sum(sums, book * BOOKED + m, slot, total((&of_body[0][0][0])[book * BOOKED + m]));
        store_sum(sums, 2 * BOOKS * BOOKED, slot, total(sheared));
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
    const Lanes zero = 0.0, one = 1.0, tie_pressure = law.tie_pressure;
    const int vectors_per_row = gaps.shape[1] * OF_VECTOR;
    Books books;
    const auto book_row = [&](int row, const auto& alike) {
        const CellRow own(cells, row);
        const Stored* const gap = row_of(gaps, row);
        const Stored* const worn_counter = row_of(sources.wear_counter, row);
        const Stored* const worn_disc = row_of(sources.wear_disc, row_beneath(row, step, sources));
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot()) {
            const Span span = span_of_tile(wp::index(list, row, n), vectors_per_row);
            for (int i = span.first; i < span.end; i += span.stride) {
                const Lanes overlap = (law.base - gap[i]) + law.offset;
                const auto& spring = spring_at<true>(own.stiffness, i, alike);
                const Lanes cap_ratio = own_or(own.cap_ratio, i, one);
                Lanes p = clipped(on_spring(overlap - law.tie_width, spring), law.cap * cap_ratio);
                p = size_of(overlap) > law.tie_width ? p : tie_pressure * cap_ratio;
                if (any(p > zero))
                    books.enter(step, sources, own, i, p, {p, p}, {worn_counter[i], worn_disc[i]});
            }
        }
    };
    const Lanes stiffness = wp::index(springs.search, 0).stiffness;
    for (int row = slot; row < gaps.shape[0]; row += slots)
        if (springs.bends.knots.shape[0] > 0)
            book_row(row, bend_of(springs.bends));
        else
            book_row(row, stiffness);
    books.leave(cells, sums, slot);
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
            books.enter(step, sources, own, i, p, borne, {worn_counter[i], worn_disc[i]});
        }
    }
    books.leave(pressed.cells, sums, slot);
}
