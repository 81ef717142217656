#pragma once
#include "lanes.h"
// Cells on springs: what those of a list of tiles carry at an approach, and what a step wears off them.

#if defined(__CUDA_ARCH__)
static const int AT_ONCE =
    4; // cells that a thread loads together: one at a time does not keep the memory busy
#else
static const int AT_ONCE = 1;
#endif

// Do something with the cells of the listed tiles of a row, or with those of a thread of the slot: places of
// `Lanes` in the row, AT_ONCE of them, -1 where there is none.
template <typename Visit>
WARPWEAR_FN void visit_listed(const int* tiles, int listed, int of_row, const Visit& visit)
{
#if defined(__CUDA_ARCH__)
    for (int first = threadIdx.x; first < listed * OF_TILE; first += AT_ONCE * blockDim.x) {
        int at[AT_ONCE];
#pragma unroll
        for (int j = 0; j < AT_ONCE; ++j) {
            const int n = first + j * blockDim.x;
            at[j] = n < listed * OF_TILE ? tiles[n / OF_TILE] * OF_TILE + n % OF_TILE : -1;
            at[j] = at[j] < of_row ? at[j] : -1;
        }
        visit(at);
    }
#else
    for (int n = 0; n < listed; ++n) {
        const int first = tiles[n] * OF_TILE, last = first + OF_TILE < of_row ? first + OF_TILE : of_row;
        for (int at[AT_ONCE] = {first}; at[0] < last; ++at[0]) visit(at);
    }
#endif
}

// What a slot leaves in a column of a table: the sum of what its threads have, or the largest.
struct Left {
    double value;
    double* place;
    bool adds;
};

template <int N> WARPWEAR_FN void leave_each(const Left (&left)[N])
{
#if defined(__CUDA_ARCH__)
    // All at once: each warp brings every value to one, then has some of the values of all warps.
    __shared__ double of_warps[N][32];
    const int warp = threadIdx.x / 32, lane = threadIdx.x % 32, warps = blockDim.x / 32;
    const auto of_warp = [](double v, bool adds) {
        for (int apart = 16; apart > 0; apart /= 2) {
            const double other = __shfl_down_sync(0xffffffff, v, apart);
            v = adds ? v + other : (v > other ? v : other);
        }
        return v;
    };
#pragma unroll
    for (int n = 0; n < N; ++n) {
        const double v = of_warp(left[n].value, left[n].adds);
        if (lane == 0) of_warps[n][warp] = v;
    }
    __syncthreads();
#pragma unroll
    for (int n = 0; n < N; ++n) {
        if (n % warps != warp) continue;
        const double nothing = left[n].adds ? 0.0 : -NO_LIMIT;
        const double v = of_warp(lane < warps ? of_warps[n][lane] : nothing, left[n].adds);
        if (lane == 0) *left[n].place = v;
    }
#else
    for (const Left& one : left) *one.place = one.value;
#endif
}

// Bring every line of a table to one number, its sum or its largest. Every thread of a deciding slot calls
// it.
template <typename Table> WARPWEAR_FN void total_lines(const Table& table, bool adds, double* totals)
{
    const int columns = table.shape[1];
#if defined(__CUDA_ARCH__)
    const int warp = threadIdx.x / 32, lane = threadIdx.x % 32, warps = blockDim.x / 32;
    for (int line = warp; line < table.shape[0]; line += warps) {
        double v = adds ? 0.0 : -NO_LIMIT;
        for (int i = lane; i < columns; i += 32) {
            const double other = wp::index(table, line, i);
            v = adds ? v + other : (v > other ? v : other);
        }
        for (int apart = 16; apart > 0; apart /= 2) {
            const double other = __shfl_down_sync(0xffffffff, v, apart);
            v = adds ? v + other : (v > other ? v : other);
        }
        if (lane == 0) totals[line] = v;
    }
    __syncthreads();
#else
    for (int line = 0; line < table.shape[0]; ++line)
        totals[line] =
            adds ? sum_in_pairs(&wp::index(table, line, 0), columns) : most_of_line(table, line, 0, columns);
#endif
}

// What cells carry at an approach base + offset: the sum of the pressures, of the stiffnesses of the cells
// that are neither open nor capped, and how near one is to changing that [MPa]. OWN: whether cells have a
// stiffness of their own; PARTED: whether they have a part of the cap.
template <bool OWN, bool PARTED, typename List, typename Count, typename Field, typename Table>
WARPWEAR_FN void carry_by(int slot, int slots, const List& list, const Count& counts, double base,
                          double offset, double cap, double stiffness, const Field& gap_in,
                          const Field& stiffness_in, const Field& parts_in, Table& trial)
{
#if !defined(__CUDA_ARCH__)
#pragma clang fp contract(off)
#endif
    const int of_row = gap_in.shape[1] * OF_VECTOR;
    const Lanes zero = 0.0;
    Lanes pressure = 0.0, slope = 0.0, nearest = ABSENT;
    for (int row = slot; row < gap_in.shape[0]; row += slots) {
        const int listed = wp::index(counts, row);
        if (listed == 0) continue;
        const Stored* const gap = row_of(gap_in, row);
        const Stored* const own = OWN ? row_of(stiffness_in, row) : nullptr;
        const Stored* const parts = PARTED ? row_of(parts_in, row) : nullptr;
        visit_listed(&wp::index(list, row, 0), listed, of_row, [&](const int (&at)[AT_ONCE]) {
            Lanes g[AT_ONCE];
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) g[j] = AT_ONCE == 1 || at[j] >= 0 ? Lanes(gap[at[j]]) : ABSENT;
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                const Lanes s = OWN ? Lanes(own[at[j]]) : Lanes(stiffness);
                const Lanes most_here = PARTED ? Lanes(cap * parts[at[j]]) : Lanes(cap);
                const Lanes q = ((base - g[j]) + offset) * s;
                Lanes p = q > zero ? q : zero;
                p = p < most_here ? p : most_here;
                pressure += p;
                slope += p > zero && q < most_here ? s : zero;
                const Lanes open = size_of(q), full = size_of(q - most_here);
                const Lanes near = open < full ? open : full;
                nearest = nearest < near ? nearest : near;
            }
        });
    }
    leave_each({{total(pressure), &wp::index(trial, 0, slot), true},
                {total(slope), &wp::index(trial, 1, slot), true},
                {most(-nearest), &wp::index(trial, 2, slot), false}});
}

template <bool IS> struct Is {
    static const bool value = IS;
};

// The same of a search: a field of no rows says that the cells share one stiffness, or that all bear the cap.
template <typename List, typename Count, typename Search, typename Field, typename Table>
WARPWEAR_FN void carry(int slot, int slots, const List& list, const Count& counts, const Search& search,
                       double cap, const Field& gap, const Field& stiffness, const Field& parts, Table& trial)
{
    const auto by = [&](auto own, auto parted) {
        carry_by<decltype(own)::value, decltype(parted)::value>(slot, slots, list, counts, search.base,
                                                                search.bracket.offset, cap, search.stiffness,
                                                                gap, stiffness, parts, trial);
    };
    const bool own = stiffness.shape[0] > 0, parted = parts.shape[0] > 0;
    if (!own && !parted) by(Is<false>(), Is<false>());
    if (own && !parted) by(Is<true>(), Is<false>());
    if (!own && parted) by(Is<false>(), Is<true>());
    if (own && parted) by(Is<true>(), Is<true>());
}

// The cells below a level, each as the part of the cap that it bears, and the lowest and highest gap listed.
template <typename List, typename Count, typename Field, typename Table>
WARPWEAR_FN void count_level(int slot, int slots, const List& list, const Count& counts, double level,
                             const Field& gap_in, const Field& parts_in, Table& trial)
{
    const int of_row = gap_in.shape[1] * OF_VECTOR;
    const Lanes zero = 0.0, one = 1.0, none = -ABSENT;
    const bool parted = parts_in.shape[0] > 0;
    Lanes below = 0.0, lowest = ABSENT, highest = -ABSENT;
    for (int row = slot; row < gap_in.shape[0]; row += slots) {
        const Stored* const gap = row_of(gap_in, row);
        const Stored* const parts = parted ? row_of(parts_in, row) : nullptr;
        visit_listed(&wp::index(list, row, 0), wp::index(counts, row), of_row, [&](const int (&at)[AT_ONCE]) {
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                const Lanes g = gap[at[j]];
                below += g < level ? (parted ? Lanes(parts[at[j]]) : one) : zero;
                const Lanes there = g < 0.5 * ABSENT ? g : none; // places without a surface do not count
                lowest = lowest < g ? lowest : g;
                highest = highest > there ? highest : there;
            }
        });
    }
    leave_each({{total(below), &wp::index(trial, 0, slot), true},
                {most(-lowest), &wp::index(trial, 1, slot), false},
                {most(highest), &wp::index(trial, 2, slot), false}});
}

// What a step wears cells by, and where the next step looks first.
struct WearBy {
    double base, offset, cap, tie_width, tie_pressure, stiffness; // as of the contact law
    double wear_per_pressure, reference;
    double base_next, offset_next, stiffness_next;
};

// Sums of a step over the cells of a slot.
struct WearSums {
    Lanes pressure = 0.0, deviation = 0.0, highest = 0.0, worn = 0.0, deepest = 0.0;
    Lanes pressure_next = 0.0, nearest_next = ABSENT;
    Counts contact = 0, capped = 0, touched = 0, between_next = 0;
};

// Wear a cell with a cap of its own and add it to the sums; return its gap. touches: whether it ever did.
WARPWEAR_FN Lanes wear_cell(WearSums& sums, const WearBy& by, Lanes g, Lanes unworn, Lanes cap,
                            Counts& touches)
{
#if !defined(__CUDA_ARCH__)
#pragma clang fp contract(fast)
#endif
    const Lanes zero = 0.0;
    const Counts no = 0, yes = 1;
    Lanes p = ((by.base - g) + (by.offset - by.tie_width)) * by.stiffness;
    p = p > zero ? p : zero;
    p = p < cap ? p : cap;
    if (by.tie_width > 0.0) p = size_of((by.base - g) + by.offset) > by.tie_width ? p : by.tie_pressure;
    g += by.wear_per_pressure * p;
    sums.pressure += p;
    sums.highest = sums.highest > p ? sums.highest : p;
    const Lanes d = p > zero ? p - by.reference : zero;
    sums.deviation += d * d;
    sums.contact += p > zero ? yes : no;
    sums.capped += p >= cap ? yes : no;

    const Lanes w = g - unworn;
    touches = p > zero || w > zero ? yes : no;
    sums.touched += touches;
    sums.worn += w;
    sums.deepest = sums.deepest > w ? sums.deepest : w;

    const Lanes r = ((by.base_next - g) + by.offset_next) * by.stiffness_next;
    Lanes q = r > zero ? r : zero;
    q = q < by.cap ? q : by.cap;
    sums.pressure_next += q;
    sums.between_next += r == q ? yes : no;
    const Lanes open = size_of(r), full = size_of(r - by.cap);
    const Lanes near = open < full ? open : full;
    sums.nearest_next = sums.nearest_next < near ? sums.nearest_next : near;
    return g;
}

// Whether a worn cell was ever touched. Where nothing wears the gap is as it was, and what touched does so
// still.
WARPWEAR_FN bool was_touched(const WearBy& by, double g, double unworn)
{
    const double overlap = (by.base - g) + by.offset;
    double p = (overlap - by.tie_width) * by.stiffness;
    p = p > 0.0 ? p : 0.0;
    p = p < by.cap ? p : by.cap;
    p = fabs(overlap) <= by.tie_width ? by.tie_pressure : p;
    return p + (g - unworn) > 0.0;
}

// First and last row and column of what was ever touched; the first ones negated, so that the largest count.
struct Extents {
    double first_row = NO_INDEX, last_row = NO_INDEX, first_column = NO_INDEX, last_column = NO_INDEX;
};

// Leave the sums of a slot. rest: cells touched, and wear, of tiles that it did not visit; beside: the change
// of pressure that those need to touch at the next approach.
template <typename Tables>
WARPWEAR_FN void leave_wear(Tables& tables, int slot, const WearSums& sums, const Extents& extents,
                            double stiffness_next, double rest_touched, double rest_worn, double beside)
{
    const double nearest = -most(-sums.nearest_next), slope = stiffness_next * count(sums.between_next);
    const auto sum = [&](int line, double v) { return Left{v, &wp::index(tables.sums, line, slot), true}; };
    const auto largest = [&](int line, double v) {
        return Left{v, &wp::index(tables.maxima, line, slot), false};
    };
    const auto ahead = [&](int line, double v, bool adds) {
        return Left{v, &wp::index(tables.ahead, line, slot), adds};
    };
    leave_each({sum(0, total(sums.pressure)), sum(1, total(sums.deviation)), sum(2, count(sums.contact)),
                sum(3, count(sums.capped)), sum(4, count(sums.touched) + rest_touched),
                sum(5, total(sums.worn) + rest_worn), largest(0, most(sums.highest)),
                largest(1, most(sums.deepest)), largest(2, extents.first_row), largest(3, extents.last_row),
                largest(4, extents.first_column), largest(5, extents.last_column),
                ahead(0, total(sums.pressure_next), true), ahead(1, slope, true),
                ahead(2, nearest < beside ? -nearest : -beside, false)});
}

// Columns of what was ever touched in a worn row of a CPU, looked for beyond those that are known.
template <typename Increment>
WARPWEAR_FN void find_columns(Extents& extents, const WearBy& by, const Increment& step, const int* tiles,
                              int listed, int of_row, const Stored* gap, const Stored* unworn)
{
    const double *const g = (const double*)gap, *const u = (const double*)unworn;
    const int cells = of_row * LANES, of_tile = OF_TILE * LANES;
    for (int n = 0; n < listed && tiles[n] * of_tile < step.first_column; ++n)
        for (int i = tiles[n] * of_tile; i < tiles[n] * of_tile + of_tile && i < cells; ++i)
            if (was_touched(by, g[i], u[i])) {
                extents.first_column = -i;
                n = listed;
                break;
            }
    for (int n = listed - 1; n >= 0 && (tiles[n] + 1) * of_tile > step.last_column + 1; --n)
        for (int i = wp::min(tiles[n] * of_tile + of_tile, cells) - 1; i >= tiles[n] * of_tile; --i)
            if (was_touched(by, g[i], u[i])) {
                extents.last_column = i;
                return;
            }
}

// Wear the listed cells of the rows of a slot by a step, and leave what it adds up to.
template <typename List, typename Count, typename Law, typename Increment, typename Field, typename Rest,
          typename Tables>
WARPWEAR_FN void wear_rows(int slot, int slots, const List& list, const Count& counts, const Law& law,
                           const Increment& step, const Field& unworn_in, const Rest& rest, Field& gap_out,
                           Tables& tables)
{
    const WearBy by = {law.base,
                       law.offset,
                       law.cap,
                       law.tie_width,
                       law.tie_pressure,
                       step.stiffness,
                       step.wear_per_pressure,
                       step.reference,
                       step.base_next,
                       step.offset_next,
                       step.stiffness_next};
    const int of_row = gap_out.shape[1] * OF_VECTOR;
    const bool first_thread = lane_of_slot() == 0;
    const Lanes cap = by.cap;
#if !defined(__CUDA_ARCH__)
    if (wp::index(counts, slot) == 0) { // most rows of an early contact
        for (int line = 0; line < 6; ++line) {
            wp::index(tables.sums, line, slot) = line < 4 ? 0.0 : wp::index(rest, slot)[line - 4];
            wp::index(tables.maxima, line, slot) = line < 2 ? 0.0 : NO_INDEX;
        }
        for (int line = 0; line < 3; ++line) wp::index(tables.ahead, line, slot) = line < 2 ? 0.0 : -ABSENT;
        return;
    }
#endif
    WearSums sums;
    Extents extents;
    double rest_touched = 0.0, rest_worn = 0.0;
    for (int row = slot; row < gap_out.shape[0]; row += slots) {
        if (first_thread) {
            rest_touched += wp::index(rest, row)[0];
            rest_worn += wp::index(rest, row)[1];
        }
        const int listed = wp::index(counts, row);
        if (listed == 0) continue;
        const int* const tiles = &wp::index(list, row, 0);
        const Stored* const unworn = row_of(unworn_in, row);
        Stored* const gap = row_of(gap_out, row);
        visit_listed(tiles, listed, of_row, [&](const int (&at)[AT_ONCE]) {
            Lanes g[AT_ONCE], u[AT_ONCE];
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                fetch((const double*)(gap + at[j] + 16)); // a fifth of the time, where fields do not fit the cache
                fetch((const double*)(unworn + at[j] + 16));
                g[j] = gap[at[j]];
                u[j] = unworn[at[j]];
            }
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                Counts touches;
                gap[at[j]] = wear_cell(sums, by, g[j], u[j], cap, touches);
#if defined(__CUDA_ARCH__)
                if (touches) {
                    extents.first_row = wp::max(extents.first_row, -double(row));
                    extents.last_row = row;
                    extents.first_column = wp::max(extents.first_column, -double(at[j]));
                    extents.last_column = wp::max(extents.last_column, double(at[j]));
                }
#endif
            }
        });
#if !defined(__CUDA_ARCH__)
        if (count(sums.touched) > 0.0) { // a slot has one row
            extents.first_row = -row;
            extents.last_row = row;
            find_columns(extents, by, step, tiles, listed, of_row, gap, unworn);
        }
#endif
    }
    leave_wear(tables, slot, sums, extents, by.stiffness_next, rest_touched, rest_worn, NO_LIMIT);
}

// The limit up to which at least so many tiles have a cell, by their lowest gaps in every so-many-th row: the
// lowest such limit above one that is known. One thread.
template <typename Table>
WARPWEAR_FN double limit_of_rank(const Table& lowest, int rows_apart, int tiles, double limit)
{
    const auto count_to = [&](double level, double& largest) {
        int some = 0;
        largest = -NO_LIMIT;
        for (int row = 0; row < lowest.shape[0]; row += rows_apart) {
            const double* const low = &wp::index(lowest, row, 0);
            for (int t = 0; t < lowest.shape[1]; ++t) {
                some += low[t] <= level ? 1 : 0;
                const double here = low[t] <= level ? low[t] : -NO_LIMIT;
                largest = largest > here ? largest : here;
            }
        }
        return some;
    };
    double low = limit, high = limit, reach = 1.0e-6, largest = 0.0;
    int some = count_to(high, largest);
    if (some >= tiles) return limit;
    while (some < tiles) {
        low = high;
        high = low + reach;
        if (high > 0.5 * ABSENT) return NO_LIMIT;
        reach *= 4.0;
        some = count_to(high, largest);
    }
    for (int halving = 0; some != tiles && halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        double below;
        const int here = count_to(middle, below);
        if (here < tiles) {
            low = middle;
            continue;
        }
        high = middle;
        some = here;
        largest = below;
    }
    return largest;
}
