#pragma once
// Wear of a ball and a disc by a stored pressure, and the gap that the disc's asperities meet on their way.

#include "fretting.h"
#include "running_in/sources.h"

// The gap that a cell of the disc meets on its way through a step: that of the bodies, with the mean of the
// counter-body's wear along the way instead of the wear at its middle. Where pressures move with the
// counter-body it is the mean of the disc's wear. What cells have of their own is made with it.
template <typename Slides, typename Bodies, typename Sources, typename Properties, typename Field>
WARPWEAR_FN void make_gaps(int slot, int slots, const Slides& slides, const Bodies& bodies,
                           const Sources& sources, const Properties& cells, const Field& means,
                           const Field& gaps)
{
    CONTRACT_FAST
    const auto& slide = wp::index(slides, 0);
    const int vectors_per_row = gaps.shape[1] * OF_VECTOR, window = slide.window;
    const double shear_depth = slide.removal.shear_counter + slide.removal.shear_disc,
                 least = least_shear(slide);
    const Span span = {lane_of_slot(), vectors_per_row, width_of_slot()};
    for (int row = slot; row < gaps.shape[0] && makes(sources, cells); row += slots)
        make_cells(slide, sources, cells, row, under_row(row, slide.shift, bodies.disc.shape[0]), span);
    for (int row = slot; row < gaps.shape[0]; row += slots) {
        const auto& worn = slide.counter_moves == 1 ? bodies.wear_disc : bodies.wear_counter;
        const Stored *const counter = row_of(bodies.counter, row), *const wear = row_of(worn, row);
        const Stored* const disc = row_of(bodies.disc, under_row(row, slide.shift, bodies.disc.shape[0]));
        const Stored* const met = mean_of(worn, means, row, window);
        const Stored* const shear_ratio = row_or_none(cells.shear_ratio, row);
        Stored* const gap = row_of(gaps, row);
        for (int i = lane_of_slot(); i < vectors_per_row; i += width_of_slot()) {
            Lanes g = (counter[i] + (met[i] - wear[i])) - disc[i];
            if (shear_ratio) g += shear_depth * shear_ratio[i] - least; // as of tiles listed
            gap[i] = g;
        }
    }
}

// The part of a step that each cell was in contact: where it bears, all of it; else what is left of the depth
// that shear wears when its gap at the end is taken off; times its shear ratio.
template <typename Slides, typename Pressed>
WARPWEAR_FN void part_of_step(int slot, int slots, const Slides& slides, const Pressed& pressed)
{
    const auto& slide = wp::index(slides, 0);
    const double shear_depth = slide.removal.shear_counter + slide.removal.shear_disc,
                 approach = slide.approach;
    const int vectors_per_row = pressed.pressure.shape[1] * OF_VECTOR;
    const Lanes zero = 0.0, one = 1.0, least_depth = NEARLY_NONE;
    for (int row = slot; row < slide.rows; row += slots) {
        const Stored *const p = row_of(pressed.pressure, row), *const target = row_of(pressed.gradient, row);
        const Stored* const shear_ratio = row_or_none(pressed.cells.shear_ratio, row);
        Stored* const sheared = row_of(pressed.sheared, row);
        for (int i = lane_of_slot(); i < vectors_per_row; i += width_of_slot()) {
            const Lanes tau = own_or(shear_ratio, i, one);
            const Lanes own = larger_of(shear_depth * tau, least_depth);
            const Lanes part = smaller_of(larger_of((approach + own - target[i]) / own, zero), one);
            sheared[i] = tau * (p[i] > zero ? one : part);
        }
    }
}

// One increment of wear in place: the disc loses K dL p, the counter-body K dL times the mean of p that
// passes it. Without a disc all wear is the counter-body's, whose height is then the gap. Where the gap after
// the step is below the approach at the cap, a disc that keeps its dents is displaced for good by the
// difference. Sums of the disc are left by its rows.
//
// Where the pressure moves with the counter-body, that sees p, and the disc the mean. Cells with slips of
// their own lose more by them, K dL over the distance of a cycle times p times the slip, and slip by more
// then.
template <typename Slides, typename Layout, typename Pressed, typename Bodies, typename RowSums,
          typename Table>
WARPWEAR_FN void wear_by_pressure(int slot, int slots, const Slides& slides, const Layout& layout,
                                  const Pressed& pressed, const Bodies& bodies, const RowSums& row_sums,
                                  Table& sums, Table& maxima)
{
    told(CellRow(pressed.cells, 0).has_own(), [&](auto is_own) {
        CONTRACT_FAST
        constexpr bool OWN = decltype(is_own)::value;
        const auto& slide = wp::index(slides, 0);
        const auto wear = slide.removal; // a loop over cells need not read it again
        const double cap = pressed.cap, approach = slide.approach, reference = slide.reference;
        const int of_line = layout.vectors * OF_VECTOR, lines = bodies.counter.shape[1] / layout.vectors;
        const bool has_disc = bodies.disc.shape[0] > 0;
        const bool shears = pressed.sheared.shape[0] > 0;
        const bool keeps = has_disc && bodies.plastic_disc.shape[0] == bodies.disc.shape[0];
        const bool slips = pressed.slips.shape[0] > 0;
        const double more_counter = slide.removal.slipping_counter, more_disc = slide.removal.slipping_disc;
        const double slip_of_gap = slide.removal.slip_of_gap, ahead = slide.removal.growth_ahead;
        const bool shows = bodies.reached.shape[0] != bodies.counter.shape[0];
        const Lanes zero = 0.0, one = 1.0, none = NO_INDEX;
        Sums<PressureSum> summed;
        Lanes highest = 0.0, deepest_counter = 0.0, deepest_disc = 0.0, first = NO_INDEX, last = NO_INDEX;
        double first_row = NO_INDEX, last_row = NO_INDEX;
        for (int row = slot; row < slide.rows; row += slots) {
            const int under = has_disc ? under_row(row, slide.shift, bodies.disc.shape[0]) : 0;
            const Stored *const p_of = row_of(pressed.pressure, row), *const target =
                                                                          row_of(pressed.gradient, row);
            const bool bends = pressed.on_counter.shape[0] > 0; // K goes with the pressure
            const Stored* const passing = bends ? row_of(pressed.on_counter, row)
                                                : mean_of(pressed.pressure, pressed.means, row, slide.window);
            const bool turned = slide.counter_moves == 1;
            const Stored* const own_disc = bends ? row_of(pressed.on_disc, row) : p_of;
            const Stored *const over_counter = turned ? p_of : passing, *const over_disc =
                                                                            turned ? passing : own_disc;
            Stored* const slip = slips ? row_of(pressed.slips, row) : nullptr;
            Stored* const grown = slips ? row_of(pressed.grown, row) : nullptr;
            const CellRow own(pressed.cells, row);
            const Stored* const sheared_here = shears ? row_of(pressed.sheared, row) : nullptr;
            const Stored* const sheared_passing =
                shears ? mean_of(pressed.sheared, pressed.sheared_means, row, slide.window) : nullptr;
            const Stored* const sheared_counter = turned ? sheared_here : sheared_passing;
            const Stored* const sheared_disc = turned ? sheared_passing : sheared_here;
            Stored *const counter = row_of(bodies.counter, row), *const wear_counter =
                                                                     row_of(bodies.wear_counter, row);
            Stored* const reached = shows ? nullptr : row_of(bodies.reached, row);
            Stored* const disc = has_disc ? row_of(bodies.disc, under) : nullptr;
            Stored* const wear_disc = has_disc ? row_of(bodies.wear_disc, under) : nullptr;
            Stored* const plastic = keeps ? row_of(bodies.plastic_disc, under) : nullptr;
            const int domain_row = wp::index(layout.first_row, row);
            const int domain_column = wp::index(layout.first_column, row);
            Lanes worn_disc = 0.0, pressed_disc = 0.0;
            for (int line = 0; line < lines; ++line) {
                Mask in_line = zero > one;
                for (int v = lane_of_slot(); v < of_line; v += width_of_slot()) {
                    const int i = line * of_line + v;
                    const Lanes p = p_of[i], m = over_counter[i];
                    const PerBody sheared = {shears ? (Lanes)sheared_counter[i] : zero,
                                             shears ? (Lanes)sheared_disc[i] : zero};
                    const PerBody before = {wear_counter[i], has_disc ? (Lanes)wear_disc[i] : zero};
                    const PerBody lost =
                        removal_of<OWN, true>(wear, own, i, {m, over_disc[i]}, before, sheared);
                    Lanes s = counter[i] + lost.counter, a = wear_counter[i] + lost.counter, by_slip = zero;
                    const Lanes was = shows ? wear_counter[i] : reached[i];
                    const Lanes most_here = cap * (OWN ? own_or(own.cap_ratio, i, one) : one);
                    if (slips) {
                        const Lanes slides_by = slip_ahead(slip[i], grown[i], ahead);
                        by_slip = p * slides_by;
                        s += more_counter * by_slip;
                        a += more_counter * by_slip;
                        summed.of(PressureSum::SLIP_WORK) += by_slip;
                        const Mask sticks = (p > zero) & (slides_by <= zero);
                        summed.counted(PressureSum::STUCK) += one_if(sticks);
                        const Lanes grows = slip_of_gap * (more_counter + more_disc) * by_slip;
                        slip[i] = slip[i] + grows;
                        grown[i] = grows;
                    }
                    counter[i] = s;
                    wear_counter[i] = a;
                    summed.of(PressureSum::PRESSURE) += p;
                    const Lanes away = p > zero ? p - reference : zero;
                    summed.of(PressureSum::DEVIATION_SQUARED) += away * away;
                    summed.counted(PressureSum::CONTACT) += one_if(p > zero);
                    summed.counted(PressureSum::CAPPED) += one_if(p >= most_here);
                    summed.of(PressureSum::WEAR_COUNTER) += a;
                    if (OWN && own.material)
                        summed.of(PressureSum::BARE) += p > zero ? (Lanes)own.material[i] : zero;
                    highest = larger_of(highest, p);
                    deepest_counter = larger_of(deepest_counter, a);
                    if (shears) summed.of(PressureSum::RUBBED) += (Lanes)sheared_here[i];
                    const Mask ever = m + was + wear.shear_counter * sheared.counter > zero;
                    const Lanes column = lanes_from(domain_column + v * LANES);
                    summed.counted(PressureSum::TOUCHED) += one_if(ever);
                    in_line = in_line | ever;
                    first = larger_of(first, ever ? -column : none);
                    last = larger_of(last, ever ? column : none);
                    if (!shows) reached[i] = ever ? one : zero;
                    if (!has_disc) continue;
                    Lanes d = disc[i];
                    if (keeps) {
                        Lanes beyond = p >= most_here ? approach - target[i] : zero;
                        beyond = larger_of(beyond, zero);
                        d -= beyond;
                        const Lanes x = plastic[i] + beyond;
                        plastic[i] = x;
                        pressed_disc += x;
                    }
                    Lanes b = wear_disc[i] + lost.disc, e = d - lost.disc;
                    if (slips) {
                        b += more_disc * by_slip;
                        e -= more_disc * by_slip;
                    }
                    disc[i] = e;
                    wear_disc[i] = b;
                    worn_disc += b;
                    deepest_disc = larger_of(deepest_disc, b);
                }
                if (any(in_line)) {
                    first_row = wp::max(first_row, -double(domain_row + line));
                    last_row = wp::max(last_row, double(domain_row + line));
                }
            }
            if (has_disc) {
                const double worn = reduce_slot(total(worn_disc), true);
                if (lane_of_slot() == 0) wp::index(row_sums.worn_disc, under) = worn;
            }
            if (keeps) {
                const double dents = reduce_slot(total(pressed_disc), true);
                if (lane_of_slot() == 0) wp::index(row_sums.pressed_disc, under) = dents;
            }
        }
        Partial partials[Sums<PressureSum>::LINES];
        summed.list(partials, sums, slot);
        store_partials(partials);
        store_lines(maxima, slot, 0,
                    {most(highest), most(deepest_counter), most(deepest_disc), first_row, last_row,
                     most(first), most(last)});
    });
}

// The pressures that wear counter-body and disc at their K of a step, where that goes with the pressure; and
// their sums. passing: what the counter-body sees of the pressure.
template <typename Bends, typename Field, typename Table>
WARPWEAR_FN void wearing_pressures(int slot, int slots, const Bends& bends, const Field& passing,
                                   const Field& pressure, const Field& counter, const Field& disc,
                                   Table& sums)
{
    const Bend bend = bend_of(bends);
    Lanes of_counter = 0.0, of_disc = 0.0;
    for (int row = slot; row < pressure.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < pressure.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes m = row_of(passing, row)[i], p = row_of(pressure, row)[i];
            const Lanes a = bend.k_at(0, m) * m, b = bend.k_at(1, p) * p;
            row_of(counter, row)[i] = a;
            row_of(disc, row)[i] = b;
            of_counter += a;
            of_disc += b;
        }
    store_lines(sums, slot, 2, {total(of_counter), total(of_disc)});
}

// The mean of a field along sliding at every cell, added to another field.
template <typename Field>
WARPWEAR_FN void add_mean(int slot, int slots, int window, const Field& field, const Field& to,
                          const Field& out)
{
    for (int row = slot; row < field.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < field.shape[1] * OF_VECTOR; i += width_of_slot())
            row_of(out, row)[i] = row_of(to, row)[i] + mean_at(field, row, i, window);
}

// What wear takes off a cell at a K of its pressure, as a line over the pressure: a part of the gap, and a
// compliance. It is the chord to a pressure on the other side of what is looked for: the last one where the
// present one has gone past it, else half as far as before; or the tangent where that is steeper; and no
// less steep than `keeps` of the line before. Partial is the
// most by which the line before was off.
template <typename Bends, typename Field, typename Table>
WARPWEAR_FN void linearise(int slot, int slots, const Bends& bends, double keeps, const Field& pressure,
                           const Field& last, const Field& far, const Field& gap, const Field& gap_out,
                           const Field& yields, Table& off)
{
    const Bend bend = bend_of(bends);
    const double counter = bends.step.data[1], disc = bends.step.data[2];
    const auto worn = [&](Lanes p) { return p * (counter * bend.k_at(0, p) + disc * bend.k_at(1, p)); };
    const Lanes zero = 0.0;
    Lanes largest = 0.0;
    for (int row = slot; row < gap.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < gap.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes p = row_of(pressure, row)[i], g = row_of(gap, row)[i], here = worn(p);
            const Lanes by = here - (row_of(gap_out, row)[i] - g) - row_of(yields, row)[i] * p;
            const Lanes before = row_of(last, row)[i], least = 1.0e-6 * p + 1.0e-6;
            const Lanes beyond = (p - before) * by > zero ? before : 0.5 * (p + row_of(far, row)[i]);
            const Lanes end = size_of(beyond - p) < least ? p + least : beyond;
            const Lanes chord = (worn(end) - here) / (end - p), tangent = (worn(p + least) - here) / least;
            const Lanes slope = larger_of(larger_of(chord, tangent), keeps * row_of(yields, row)[i]);
            largest = larger_of(largest, p > zero ? size_of(by) : zero);
            row_of(yields, row)[i] = slope;
            row_of(gap_out, row)[i] = g + (here - slope * p);
            row_of(last, row)[i] = p;
            row_of(far, row)[i] = beyond;
        }
    store_most(off, 0, slot, most(largest));
}
