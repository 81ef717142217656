#pragma once
// Cells of a list of tiles: how they are visited, what they carry at an approach, and what lies below a
// level.

#include "properties.h"

#if defined(__CUDA_ARCH__)
static const int AT_ONCE =
    4; // cells that a thread loads together: one at a time does not keep the memory busy
#else
static const int AT_ONCE = 1;
#endif

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

// What cells carry at an approach base + offset: the sum of the pressures, of the stiffnesses of the cells
// that are neither open nor capped, and how near one is to changing that [MPa]. OWN: whether cells have a
// stiffness of their own; OWN_CAPS: whether they have a cap of their own. alike: stiffness, or `Bend`, of
// all.
template <bool OWN, bool OWN_CAPS, typename List, typename Count, typename Spring, typename Field,
          typename Table>
WARPWEAR_FN void carry_by(int slot, int slots, const List& list, const Count& counts, double base,
                          double offset, double cap, const Spring& alike, const Field& gap_in,
                          const Field& stiffness_in, const Field& cap_ratio_in, Table& trial)
{
#if !defined(__CUDA_ARCH__)
#pragma clang fp contract(off)
#endif
    const int vectors_per_row = gap_in.shape[1] * OF_VECTOR;
    const Lanes zero = 0.0;
    Lanes pressure = 0.0, slope = 0.0, nearest = ABSENT;
    for (int row = slot; row < gap_in.shape[0]; row += slots) {
        const int listed = wp::index(counts, row);
        if (listed == 0) continue;
        const Stored* const gap = row_of(gap_in, row);
        const Stored* const own = OWN ? row_of(stiffness_in, row) : nullptr;
        const Stored* const cap_ratio = OWN_CAPS ? row_of(cap_ratio_in, row) : nullptr;
        visit_listed(&wp::index(list, row, 0), listed, vectors_per_row, [&](const int (&at)[AT_ONCE]) {
            Lanes g[AT_ONCE];
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) g[j] = AT_ONCE == 1 || at[j] >= 0 ? Lanes(gap[at[j]]) : ABSENT;
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
    store_partials({{total(pressure), &wp::index(trial, 0, slot), true},
                    {total(slope), &wp::index(trial, 1, slot), true},
                    {most(-nearest), &wp::index(trial, 2, slot), false}});
}

template <bool IS> struct Is {
    static const bool value = IS;
};

// Do something told by a type whether a condition holds.
template <typename Do> WARPWEAR_FN void told(bool is, const Do& act)
{ is ? act(Is<true>()) : act(Is<false>()); }

// The same of a search: a field of no rows says that the cells share one stiffness, or that all bear the cap.
template <typename List, typename Count, typename Springs, typename Field>
WARPWEAR_FN void carry(int slot, int slots, const List& list, const Count& counts, Springs& springs,
                       const Field& gap, const Field& stiffness, const Field& cap_ratio)
{
    const auto& search = wp::index(springs.search, 0);
    const auto by = [&](auto own, auto own_caps, const auto& alike) {
        carry_by<decltype(own)::value, decltype(own_caps)::value>(slot, slots, list, counts, search.base,
                                                                  search.bracket.offset, springs.cap, alike,
                                                                  gap, stiffness, cap_ratio, springs.trial);
    };
    const bool bends = springs.bends.knots.shape[0] > 0, own = stiffness.shape[0] > 0;
    const bool own_caps = cap_ratio.shape[0] > 0;
    const Lanes alike = search.stiffness;
    told(own_caps, [&](auto caps) {
        if (bends) return by(Is<false>(), caps, bend_of(springs.bends));
        told(own, [&](auto one_each) { by(one_each, caps, alike); });
    });
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
#if defined(__CUDA_ARCH__)
    __shared__ int places;
    if (threadIdx.x == 0) places = 0;
    __syncthreads();
#else
    int places = 0;
#endif
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
#if defined(__CUDA_ARCH__)
    __syncthreads();
#endif
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
#if defined(__CUDA_ARCH__)
    const int slots = springs.near.shape[0];
#else
    const int slots = 1; // the first has all
#endif
    for (int slot = lane_of_slot(); slot < slots; slot += width_of_slot()) {
        const Stored* const near = row_of(springs.near, slot);
        const int places = int(wp::index(springs.trial, 4, slot));
        for (int i = 0; i < places; ++i) below += one_if(near[i] < level);
    }
    return reduce_slot(count(below), true);
}
