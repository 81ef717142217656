#pragma once
// Cells of a list of tiles: how they are visited, what they carry at an approach, and what lies below a
// level.

#include "properties.h"

// Cells that a thread of a GPU loads together: one at a time does not keep the memory busy.
static const int AT_ONCE = LANES == 1 ? 4 : 1;

// Do something with the cells of the listed tiles of a row, or with those of a thread of the slot: places of
// `Lanes` in the row, AT_ONCE of them, -1 where there is none.
template <typename Visit>
WARPWEAR_FN void visit_listed(const int* tiles, int listed, int vectors_per_row, const Visit& visit)
{
#if defined(__CUDA_ARCH__)
    const bool is_whole = listed * OF_TILE >= vectors_per_row; // then no place waits for a number of the list
    for (int first = threadIdx.x; first < listed * OF_TILE; first += AT_ONCE * blockDim.x) {
        int at[AT_ONCE];
#pragma unroll
        for (int j = 0; j < AT_ONCE; ++j) {
            const int n = first + j * blockDim.x;
            at[j] = n;
            if (!is_whole) at[j] = n < listed * OF_TILE ? tiles[n / OF_TILE] * OF_TILE + n % OF_TILE : -1;
            at[j] = at[j] < vectors_per_row ? at[j] : -1;
        }
        visit(at);
    }
#else
    for (int n = 0; n < listed; ++n) {
        const int first = tiles[n] * OF_TILE,
                  last = first + OF_TILE < vectors_per_row ? first + OF_TILE : vectors_per_row;
        for (int at[AT_ONCE] = {first}; at[0] < last; ++at[0]) visit(at);
    }
#endif
}

// What cells carry at the approach of a search: the sum of the pressures, of the stiffnesses of the cells
// that are neither open nor capped, and how near one is to changing that [MPa]. A field of no rows says that
// the cells share one stiffness, or that all bear the cap.
template <typename List, typename Count, typename Springs, typename Field>
WARPWEAR_FN void carry(int slot, int slots, const List& list, const Count& counts, Springs& springs,
                       const Field& gaps, const Field& stiffnesses, const Field& cap_ratios)
{
    const auto& search = wp::index(springs.search, 0);
    const double base = search.base, offset = search.bracket.offset, cap = springs.cap;
    const auto by = [&](auto own_each, auto own_cap, const auto& alike) {
        CONTRACT_OFF
        constexpr bool OWN = decltype(own_each)::value, OWN_CAPS = decltype(own_cap)::value;
        const int vectors_per_row = gaps.shape[1] * OF_VECTOR;
        const Lanes zero = 0.0;
        Lanes pressure = 0.0, slope = 0.0, nearest = ABSENT;
        for (int row = slot; row < gaps.shape[0]; row += slots) {
            const int listed = wp::index(counts, row);
            if (listed == 0) continue;
            const Stored* const gap = row_of(gaps, row);
            const Stored* const own = OWN ? row_of(stiffnesses, row) : nullptr;
            const Stored* const cap_ratio = OWN_CAPS ? row_of(cap_ratios, row) : nullptr;
            visit_listed(&wp::index(list, row, 0), listed, vectors_per_row, [&](const int (&at)[AT_ONCE]) {
                Lanes g[AT_ONCE];
#pragma unroll
                for (int j = 0; j < AT_ONCE; ++j)
                    g[j] = AT_ONCE == 1 || at[j] >= 0 ? Lanes(gap[at[j]]) : ABSENT;
#pragma unroll
                for (int j = 0; j < AT_ONCE; ++j) {
                    if (AT_ONCE > 1 && at[j] < 0) continue;
                    const auto& s = spring_at<OWN>(own, at[j], alike);
                    const Lanes most_here = OWN_CAPS ? Lanes(cap * cap_ratio[at[j]]) : Lanes(cap);
                    const Lanes overlap = (base - g[j]) + offset;
                    const Lanes q = on_spring(overlap, s), p = clipped(q, most_here);
                    pressure += p;
                    slope += p > zero && q < most_here ? stiffness_of(s) * slope_on_spring(overlap, s) : zero;
                    const Lanes near = to_bound(q, most_here, s);
                    nearest = nearest < near ? nearest : near;
                }
            });
        }
        store_partials({{total(pressure), &wp::index(springs.trial, 0, slot), true},
                        {total(slope), &wp::index(springs.trial, 1, slot), true},
                        {most(-nearest), &wp::index(springs.trial, 2, slot), false}});
    };
    const bool bends = springs.bends.knots.shape[0] > 0, is_own = stiffnesses.shape[0] > 0;
    const bool own_caps = cap_ratios.shape[0] > 0;
    const Lanes stiffness = search.stiffness;
    told(own_caps, [&](auto caps) {
        if (bends) return by(Is<false>(), caps, bend_of(springs.bends));
        told(is_own, [&](auto one_each) { by(one_each, caps, stiffness); });
    });
}

// The pressure of a cell by the law that a search has left; fields as of `carry`. One that bears a part of
// the cap does so also where it is tied with the approach.
template <typename Springs, typename Field>
WARPWEAR_FN double pressure_at(const Springs& springs, const Field& gaps, const Field& stiffnesses,
                               const Field& cap_ratios, int row, int column)
{
    const auto at = [&](const Field& field) { return ((const double*)row_of(field, row))[column]; };
    auto law = wp::index(springs.law, 0);
    const double ratio = cap_ratios.shape[0] > 0 ? at(cap_ratios) : 1.0;
    law.cap *= ratio;
    law.tie_pressure *= ratio;
    if (springs.bends.knots.shape[0] > 0) return pressure_by(law, at(gaps), bend_of(springs.bends));
    const double alike = wp::index(springs.search, 0).stiffness;
    return pressure_by(law, at(gaps), stiffnesses.shape[0] > 0 ? at(stiffnesses) : alike);
}

// Store those of the cells of the tiles listed.
template <typename List, typename Count, typename Springs, typename Field>
WARPWEAR_FN void press(int slot, int slots, const List& list, const Count& counts, const Springs& springs,
                       const Field& gaps, const Field& stiffnesses, const Field& cap_ratios, Field& pressures)
{
    const int of_tile = OF_TILE * LANES, columns = gaps.shape[1] * OF_VECTOR * LANES;
    for (int row = slot; row < gaps.shape[0]; row += slots)
        for (int n = lane_of_slot(); n < wp::index(counts, row) * of_tile; n += width_of_slot()) {
            const int column = wp::index(list, row, n / of_tile) * of_tile + n % of_tile;
            if (column < columns)
                ((double*)row_of(pressures, row))[column] =
                    pressure_at(springs, gaps, stiffnesses, cap_ratios, row, column);
        }
}

// Up to where the cells inside the bracket of a bearing area are looked at: as far as all tiles are listed,
// and the approach may be.
template <typename Springs> WARPWEAR_FN double inside_up_to(const Springs& springs)
{
    const auto& search = wp::index(springs.search, 0);
    const double limit = wp::min(wp::index(springs.lists, 0).limit, 0.5 * ABSENT); // where there is a surface
    const double expected = search.scatter > 0.0 ? search.start + search.scatter : NO_LIMIT;
    return wp::min(wp::min(search.bracket.high, limit), expected);
}

// The cells below the trial of a search, each as the part of the cap that it bears; the lowest and the
// highest gap listed; and how many lie inside the bracket, see above. Those are gathered in the slot's line
// of `near`, as far as it has room, so that what follows may count them there: on a CPU in vectors as they
// stand in the row, without the others. Nothing is gathered where cells bear ratios of the cap.
template <typename List, typename Count, typename Springs, typename Field>
WARPWEAR_FN void count_level(int slot, int slots, const List& list, const Count& counts,
                             const Springs& springs, const Field& gap_in, const Field& cap_ratio_in)
{
    const auto& search = wp::index(springs.search, 0);
    const double level = search.bracket.offset, from = search.bracket.low, to = inside_up_to(springs);
    const int vectors_per_row = gap_in.shape[1] * OF_VECTOR, room = springs.near.shape[1] * OF_VECTOR;
    const Lanes zero = 0.0, one = 1.0, absent = ABSENT, none = -ABSENT;
    const bool own_caps = cap_ratio_in.shape[0] > 0, gathers = springs.near.shape[0] > 0;
    Stored* const near = gathers ? row_of(springs.near, slot) : nullptr;
    OF_SLOT int places;
    if (lane_of_slot() == 0) places = 0;
    wait_for_slot();
    Lanes below = 0.0, lowest = ABSENT, highest = -ABSENT;
    Counts inside = 0;
    for (int row = slot; row < gap_in.shape[0]; row += slots) {
        const Stored* const gap = row_of(gap_in, row);
        const Stored* const cap_ratio = own_caps ? row_of(cap_ratio_in, row) : nullptr;
        visit_listed(
            &wp::index(list, row, 0), wp::index(counts, row), vectors_per_row, [&](const int (&at)[AT_ONCE]) {
#pragma unroll
                for (int j = 0; j < AT_ONCE; ++j) {
                    if (AT_ONCE > 1 && at[j] < 0) continue;
                    const Lanes g = gap[at[j]];
                    below += g < level ? (own_caps ? Lanes(cap_ratio[at[j]]) : one) : zero;
                    const Lanes there = g < 0.5 * ABSENT ? g : none; // places without a surface do not count
                    lowest = lowest < g ? lowest : g;
                    highest = highest > there ? highest : there;
                    if (!gathers) continue;
                    const Mask is_inside = (g >= from) & (g < to);
                    inside += one_if(is_inside);
#if defined(__CUDA_ARCH__)
                    if (!is_inside) continue;
                    const int place = atomicAdd(&places, 1); // in any order: they are only counted
                    if (place < room) near[place] = g;
#else
                near[places < room ? places : room - 1] = is_inside ? g : absent;
                places += any(is_inside);
#endif
                }
            });
    }
    wait_for_slot();
    const double filled = places;
    store_partials({{total(below), &wp::index(springs.trial, 0, slot), true},
                    {most(-lowest), &wp::index(springs.trial, 1, slot), false},
                    {most(highest), &wp::index(springs.trial, 2, slot), false},
                    {count(inside), &wp::index(springs.trial, 3, slot), true},
                    {filled, &wp::index(springs.trial, 4, slot), false}});
}

// Whether all cells inside the bracket are gathered. Every thread of a deciding slot gets the answer. On a
// CPU they then lie one behind the other from the first slot's line on, as if it had them all.
template <typename Springs> WARPWEAR_FN bool are_gathered(const Springs& springs)
{
    const double fullest = most_of_line(springs.trial, 4, 0, springs.trial.shape[1]);
    if (springs.near.shape[0] == 0 || fullest > springs.near.shape[1] * OF_VECTOR) return false;
#if !defined(__CUDA_ARCH__)
    Stored* const near = row_of(springs.near, 0);
    double* const places = &wp::index(springs.trial, 4, 0);
    int end = int(places[0]);
    for (int slot = 1; slot < springs.near.shape[0]; ++slot) {
        for (int i = 0; i < int(places[slot]); ++i) near[end++] = row_of(springs.near, slot)[i];
        places[slot] = 0.0;
    }
    places[0] = end;
#endif
    return true;
}

// The gathered cells below a level, likewise.
template <typename Springs> WARPWEAR_FN double count_gathered(const Springs& springs, double level)
{
    Counts below = 0;
    const int slots = LANES == 1 ? springs.near.shape[0] : 1; // on a CPU the first has all
    for (int slot = lane_of_slot(); slot < slots; slot += width_of_slot()) {
        const Stored* const near = row_of(springs.near, slot);
        const int places = int(wp::index(springs.trial, 4, slot));
        for (int i = 0; i < places; ++i) below += one_if(near[i] < level);
    }
    return reduce_slot(count(below), true);
}
