#pragma once
// A disc displaced under a ball: the tiles that can touch, the wear of both bodies, and their sums by rows.

#include "running_in/sources.h"
#include "wear.h"

// Make the gap of a tile; the lowest of the cells that a thread makes. shear_ratio: where cells lose unlike
// depths by their shear, none else; what they lose beyond the least is in the gap.
template <typename Slide>
WARPWEAR_FN Lanes gap_of_tile(const Span& span, const Stored* counter, const Stored* disc, Stored* gap,
                              const Stored* shear_ratio, const Slide& slide)
{
    const double shear_depth = slide.removal.shear_counter + slide.removal.shear_disc,
                 least = least_shear(slide);
    Lanes low = ABSENT;
    for (int i = span.first; i < span.end; i += span.stride) {
        Lanes g = counter[i] - disc[i];
        if (shear_ratio) g += shear_depth * shear_ratio[i] - least;
        gap[i] = g;
        low = smaller_of(low, g);
    }
    return low;
}

// List, row by row, the tiles with a gap that does not exceed the limit, and make their gaps. Where the
// bounds of a pair of tiles let it touch, its gap decides: a list holds no tile too many. What its cells have
// of their own is made with the gap, but under a disc that lies still: see `make_listed`. The lowest gap of a
// tile is noted; under a disc that lies still it stays known, as 0 where the gap was never made. The lowest
// of eight tiles of the counter-body with the highest of the disc's row spares a CPU most bounds.
template <typename Lists, typename Slides, typename Bounds, typename Sources, typename Properties,
          typename Bodies, typename List, typename Count>
WARPWEAR_FN void select_tiles(int slot, int slots, const Lists& lists, const Slides& slides,
                              const Bounds& bounds, const Sources& sources, const Properties& cells,
                              const Bodies& bodies, const List& list, const Count& counts)
{
    told(makes(sources, cells) && bounds.keeps_gap == 0, [&](auto made) {
        constexpr bool MAKES = decltype(made)::value; // what cells have of their own
        const auto& step = wp::index(slides, 0);
        const double shear_depth =
            (step.removal.shear_counter + step.removal.shear_disc) * step.removal.most_shear_ratio;
        const double limit = wp::index(lists, 0).limit + shear_depth;
        const int shift = step.shift, vectors_per_row = bodies.gap.shape[1] * OF_VECTOR;
        const int tiles = (vectors_per_row + OF_TILE - 1) / OF_TILE;
        const bool keeps_gap = bounds.keeps_gap == 1;
        for (int row = slot; row < bodies.gap.shape[0]; row += slots) {
            const int under = under_row(row, shift, bodies.disc.shape[0]);
            const Stored *const counter = row_of(bodies.counter, row), *const disc =
                                                                           row_of(bodies.disc, under);
            const Stored *const lowest = row_of(bounds.lowest, row), *const highest =
                                                                         row_of(bounds.highest, under);
            Stored *const gap = row_of(bodies.gap, row), *const tile_bounds = row_of(bounds.gap, row);
            const Stored* const shear_ratio = MAKES ? row_or_none(cells.shear_ratio, row) : nullptr;
            const auto lowest_gap = [&](int t) {
                const Span span = span_of_tile(t, vectors_per_row);
                if (MAKES) make_cells(step, sources, cells, row, under, span);
                const Lanes apart = gap_of_tile(span, counter, disc, gap, shear_ratio, step);
                const double low = -reduce_warp(most(-apart), false);
                if (lane_of_team() == 0) ((double*)tile_bounds)[t] = low;
                return low;
            };
            int listed = 0;
#if defined(__CUDA_ARCH__)
            // A warp a tile says whether it touches; then each thread enters one behind those before it.
            __shared__ bool touches[1024];
            __shared__ int of_warps[32];
            const int warp = team_of_slot(), warps = teams_of_slot(), lane = lane_of_team();
            for (int first = 0; first < tiles; first += blockDim.x) {
                for (int n = warp; n < blockDim.x && first + n < tiles; n += warps) {
                    const int t = first + n;
                    const double low = keeps_gap ? tile_bounds[t] : 0.0;
                    bool here = (low != 0.0 ? low : lowest[t] - highest[t]) <= limit;
                    __syncwarp(); // before the first thread of the warp notes another
                    if (here && low == 0.0) here = lowest_gap(t) <= limit;
                    if (lane == 0) touches[n] = here;
                }
                __syncthreads();
                const bool mine = first + threadIdx.x < tiles && touches[threadIdx.x];
                const unsigned votes = __ballot_sync(0xffffffff, mine);
                if (lane == 0) of_warps[warp] = __popc(votes);
                __syncthreads();
                int place = listed + __popc(votes & ((1u << lane) - 1u));
                for (int w = 0; w < warp; ++w) place += of_warps[w];
                if (mine) wp::index(list, row, place) = first + threadIdx.x;
                for (int w = 0; w < warps; ++w) listed += of_warps[w];
                __syncthreads();
            }
            if (threadIdx.x == 0) wp::index(counts, row) = listed;
#else
        const double highest_here = wp::index(bounds.highest_of_row, under);
        const Lanes zero = 0.0;
        for (int m = 0; m < bounds.lowest.shape[1]; ++m) {
            if (wp::index(bounds.lowest_of_eight, row, m) - highest_here > limit) continue;
            const Lanes low = keeps_gap ? (Lanes)tile_bounds[m] : zero;
            const Lanes bound = low != zero ? low : lowest[m] - highest[m];
            if (!any(bound <= limit)) continue;
            const int end = tiles - m * LANES < LANES ? tiles - m * LANES : LANES;
            for (int j = 0; j < end; ++j) {
                const int t = m * LANES + j;
                const bool is_made = low[j] != 0.0 || bound[j] > limit;
                wp::index(list, row, listed) = t; // another takes its place where it is not to stay
                listed += (is_made ? bound[j] : lowest_gap(t)) <= limit;
            }
        }
        wp::index(counts, row) = listed;
#endif
        }
    });
}

// Tiles that are listed in all. Every thread of a deciding slot gets the number.
template <typename Count> WARPWEAR_FN int count_listed(const Count& counts)
{
    int listed = 0;
    for (int row = lane_of_slot(); row < counts.shape[0]; row += width_of_slot())
        listed += wp::index(counts, row);
    return int(reduce_slot(listed, true));
}

// Last row of those with a number above 0, or the first one negated.
template <typename Array> WARPWEAR_FN double end_of_rows(const Array& row_sums, bool is_last)
{
    double end = NO_INDEX;
    for (int row = lane_of_slot(); row < row_sums.shape[0]; row += width_of_slot())
        if (row_sums.data[row] > 0.0) end = wp::max(end, is_last ? double(row) : -double(row));
    return reduce_slot(end, false);
}

// Sum what is kept of the tiles of a row, by all threads of the slot.
template <typename Numbers> WARPWEAR_FN double sum_of_tiles(const Numbers& numbers, int row)
{
    const Stored* const values = row_of(numbers, row);
    Lanes sum = 0.0;
    for (int i = lane_of_slot(); i * LANES < numbers.shape[1]; i += width_of_slot()) sum += values[i];
    return reduce_slot(total(sum), true);
}

// Sum the tiles of a row of the counter-body, and of the disc's row beneath it. Sums over the fields as they
// are: increments added up would drift.
template <typename TileBounds>
WARPWEAR_FN void total_rows(int row, int under, bool presses, const TileBounds& tile_bounds)
{
    wait_for_slot(); // other threads have worn tiles of the row
    const double touched = sum_of_tiles(tile_bounds.touched, row);
    const double counter = sum_of_tiles(tile_bounds.worn_counter, row);
    const double disc = sum_of_tiles(tile_bounds.worn_disc, under);
    const double pressed = presses ? sum_of_tiles(tile_bounds.pressed_disc, under) : 0.0;
    if (lane_of_slot() != 0) return;
    tile_bounds.rows.touched.data[row] = touched;
    tile_bounds.rows.worn_counter.data[row] = counter;
    tile_bounds.rows.worn_disc.data[under] = disc;
    if (presses) tile_bounds.rows.pressed_disc.data[under] = pressed;
}

// Wear the listed tiles by one increment: each body loses K p dL. What goes beyond the full depth is
// displaced from the disc for good, not worn. A cell that shears is worn by a depth, whatever its pressure:
// it lifts the approach, so cells that stand out less than that were in contact for a part of the step, and
// bear nothing at its end. Bounds and sums of the tiles and rows are made anew; tiles that
// do not touch stay as they are, where their lowest gaps are known. Each sum grows lane by lane, in the order
// of the cells. alike: stiffness, or `Bend`, of all. OWN: the disc's cells have a K each; RARE: cells have
// more of their own, shear, keep their dents, or belong to a ball that does not wear.
template <typename List, typename Count, typename Slides, typename Springs, typename Properties,
          typename Bodies, typename TileBounds, typename Tables>
WARPWEAR_FN void wear_tiles(int slot, int slots, const List& list, const Count& counts, const Slides& slides,
                            const Springs& springs, const Properties& cells, const Bodies& bodies,
                            const TileBounds& tile_bounds, Tables& tables)
{
    const auto& step = wp::index(slides, 0);
    const auto by = [&](auto own_k, auto own_more, const auto& alike) {
        CONTRACT_OFF
        constexpr bool OWN = decltype(own_k)::value, RARE = decltype(own_more)::value;
        constexpr bool bends = !is_straight<decltype(alike)>;
        const auto wear = step.removal; // a loop over cells need not read it again
        const auto& law = wp::index(springs.law, 0);
        const double base = law.base, offset = law.offset, cap = law.cap, tie_width = law.tie_width;
        const double tie_pressure = law.tie_pressure, yield_depth = step.yield_depth,
                     reference = step.reference;
        const bool keeps_reached = RARE && bodies.reached.shape[0] == bodies.gap.shape[0];
        const bool presses = RARE && yield_depth < NO_LIMIT, is_known = tile_bounds.gap.shape[0] > 0;
        const double shear_depth = step.removal.shear_counter + step.removal.shear_disc;
        const bool sheared = RARE && shear_depth > 0.0;
        const int vectors_per_row = bodies.gap.shape[1] * OF_VECTOR;
        const Lanes zero = 0.0, one = 1.0, none = NO_INDEX, least_depth = NEARLY_NONE;
        Sums<TrackSum> sums;
        Lanes highest = 0.0, deepest_counter = 0.0, deepest_disc = 0.0;
        double first_column = NO_INDEX, last_column = NO_INDEX;
        bool wears = width_of_slot() > 1;
        for (int row = slot; row < bodies.gap.shape[0]; row += slots) {
            const int listed = wp::index(counts, row);
            if (listed == 0) continue; // most rows
            const int under = under_row(row, step.shift, bodies.disc.shape[0]);
            Stored *const gap = row_of(bodies.gap, row), *const counter = row_of(bodies.counter, row);
            Stored *const disc = row_of(bodies.disc, under), *const plastic =
                                                                 row_of(bodies.plastic_disc, under);
            Stored *const wear_counter = row_of(bodies.wear_counter, row), *const reached =
                                                                               row_of(bodies.reached, row);
            Stored* const wear_disc = row_of(bodies.wear_disc, under);
            const CellRow own(cells, row);
            for (int n = team_of_slot(); n < listed; n += teams_of_slot()) {
                const int t = wp::index(list, row, n), first = t * OF_TILE;
                const int last = first + OF_TILE < vectors_per_row ? first + OF_TILE : vectors_per_row;
                if (is_known && (base - wp::index(tile_bounds.gap, row, t)) + offset < -tie_width) continue;
                wears = true;
                // Extents are known up to tiles that lie beyond them: all but a few of the first steps'.
                const bool beyond_known = first * LANES < step.first_column || last * LANES > step.end_column;
                Lanes low = ABSENT, high = -ABSENT, apart = ABSENT, worn_counter = 0.0, worn_disc = 0.0,
                      pressed = 0.0;
                Counts touched = 0;
                Lanes was_touched[OF_TILE / TEAM];
                for (int i = first + lane_of_team(); i < last; i += TEAM) {
                    const Lanes overlap = (base - gap[i]) + offset;
                    const auto& spring = spring_at<RARE>(own.stiffness, i, alike);
                    const Lanes cap_ratio = RARE ? own_or(own.cap_ratio, i, one) : one,
                                cap_here = cap * cap_ratio;
                    Lanes p = clipped(on_spring(overlap - tie_width, spring), cap_here);
                    p = size_of(overlap) > tie_width ? p : tie_pressure * cap_ratio;
                    Lanes d = disc[i];
                    if (presses) {
                        const Lanes beyond = larger_of(overlap - yield_depth * cap_ratio, zero);
                        d -= beyond;
                        const Lanes x = plastic[i] + beyond;
                        plastic[i] = x;
                        pressed += x;
                    }
                    Lanes fraction = zero;
                    if (sheared) {
                        const Lanes tau = own_or(own.shear_ratio, i, one);
                        const Lanes own_depth = larger_of(shear_depth * tau, least_depth);
                        const Lanes part_of_step = clipped((overlap + own_depth) / own_depth, one);
                        fraction = tau * (p > zero ? one : part_of_step);
                        sums.of(TrackSum::RUBBED) += fraction;
                    }
                    const PerBody wearing = wearing_pressure(alike, p);
                    sums.of(TrackSum::PRESSURE_TIMES_FACTOR) +=
                        OWN ? wearing.disc * k_disc_at<RARE>(own, i) : wearing.disc;
                    const PerBody lost = removal_of<OWN, RARE>(
                        wear, own, i, wearing, {wear_counter[i], wear_disc[i]}, {fraction, fraction});
                    const Lanes s = counter[i] + lost.counter, a = wear_counter[i] + lost.counter;
                    const Lanes b = wear_disc[i] + lost.disc;
                    d -= lost.disc;
                    const Lanes g = s - d;
                    gap[i] = g;
                    counter[i] = s;
                    disc[i] = d;
                    wear_counter[i] = a;
                    wear_disc[i] = b;
                    sums.of(TrackSum::PRESSURE) += p;
                    if (bends) sums.of(TrackSum::WEARING_COUNTER) += wearing.counter;
                    highest = larger_of(highest, p);
                    const Lanes from_reference = p > zero ? p - reference : zero;
                    sums.of(TrackSum::DEVIATION_SQUARED) += from_reference * from_reference;
                    sums.counted(TrackSum::CONTACT) += one_if(p > zero);
                    sums.counted(TrackSum::CAPPED) += one_if(p >= cap_here);
                    if (RARE) sums.of(TrackSum::BARE) += p > zero ? own_or(own.material, i, zero) : zero;
                    low = smaller_of(low, s);
                    high = larger_of(high, d);
                    apart = smaller_of(apart, g);
                    worn_counter += a;
                    worn_disc += b;
                    deepest_counter = larger_of(deepest_counter, a);
                    deepest_disc = larger_of(deepest_disc, b);
                    const Lanes ever = p + (keeps_reached ? (Lanes)reached[i] : a) > zero ? one : zero;
                    touched += one_if(ever > zero);
                    if (keeps_reached) reached[i] = ever;
                    was_touched[(i - first) / TEAM] = ever;
                }
                for (int i = first + lane_of_team(); beyond_known && i < last; i += TEAM) {
                    const Lanes column = lanes_from(i * LANES), ever = was_touched[(i - first) / TEAM];
                    first_column = wp::max(first_column, most(ever > zero ? -column : none));
                    last_column = wp::max(last_column, most(ever > zero ? column : none));
                }
                const double lowest = -reduce_warp(most(-low), false),
                             largest = reduce_warp(most(high), false);
                const double smallest = is_known ? -reduce_warp(most(-apart), false) : 0.0;
                const double of_tile[] = {
                    reduce_warp(total(worn_counter), true), reduce_warp(total(worn_disc), true),
                    reduce_warp(count(touched), true), reduce_warp(total(pressed), true)};
                if (lane_of_team() != 0) continue;
                wp::index(tile_bounds.lowest, row, t) = lowest;
                wp::index(tile_bounds.highest, under, t) = largest;
                if (is_known) wp::index(tile_bounds.gap, row, t) = smallest;
                wp::index(tile_bounds.worn_counter, row, t) = of_tile[0];
                wp::index(tile_bounds.worn_disc, under, t) = of_tile[1];
                wp::index(tile_bounds.touched, row, t) = of_tile[2];
                if (presses) wp::index(tile_bounds.pressed_disc, under, t) = of_tile[3];
            }
            if (wears) total_rows(row, under, presses, tile_bounds);
        }
        if (!wears) { // most rows
            for (int line = 0; line < tables.sums.shape[0]; ++line) wp::index(tables.sums, line, slot) = 0.0;
            for (int line = 0; line < tables.maxima.shape[0]; ++line)
                wp::index(tables.maxima, line, slot) = line < 3 ? 0.0 : NO_INDEX;
            return;
        }
        const double largest[] = {most(highest), most(deepest_counter), most(deepest_disc), first_column,
                                  last_column};
        const int lines = bends ? Sums<TrackSum>::LINES : int(TrackSum::WEARING_COUNTER);
        const int more = sizeof(largest) / sizeof(double);
        Partial partials[lines + more];
        sums.list<lines>(partials, tables.sums, slot);
        list_largest(partials + lines, tables.maxima, slot, largest);
        store_partials(partials);
    };
    const Lanes stiffness = wp::index(springs.search, 0).stiffness;
    const bool rare = bodies.reached.shape[0] == bodies.gap.shape[0] || step.yield_depth < NO_LIMIT ||
                      step.removal.shear_counter > 0.0 || step.removal.shear_disc > 0.0 ||
                      cells.material.shape[0] > 0 || cells.k_counter.shape[0] > 0 ||
                      cells.stiffness.shape[0] > 0 || cells.cap_ratio.shape[0] > 0;
    const bool own_k = cells.k_disc.shape[0] > 0;
    if (springs.bends.knots.shape[0] > 0) return by(Is<true>(), Is<true>(), bend_of(springs.bends));
    if (rare) return by(Is<true>(), Is<true>(), stiffness);
    told(own_k, [&](auto one_each) { by(one_each, Is<false>(), stiffness); });
}
