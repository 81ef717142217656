#pragma once
// What a step wears off the cells of a gap, and the sums that it leaves.

#include "properties.h"
#include "springs.h"

// What a step wears cells by, and where the next step looks first.
struct WearBy {
    double base, offset, cap, tie_width, tie_pressure, stiffness; // as of the contact law
    double wear_per_pressure, reference;
    double base_next, offset_next, stiffness_next;
};

// Sums of a step over the cells of a slot, its maxima, and what the cells carry in the next step.
struct WearSums : Sums<WearSum> {
    Lanes highest = 0.0, deepest = 0.0, pressure_next = 0.0, between_next = 0.0, nearest_next = ABSENT;
};

// Wear a cell with a cap of its own and add it to the sums; return its gap. spring, next: stiffness, or
// `Bend`, of this step and the next. touches: whether it ever did.
template <typename Spring>
WARPWEAR_FN Lanes wear_cell(WearSums& sums, const WearBy& by, const Spring& spring, const Spring& next_spring,
                            Lanes g, Lanes unworn, Lanes cap, Counts& touches)
{
    CONTRACT_FAST
    const Lanes zero = 0.0;
    Lanes p = clipped(on_spring((by.base - g) + (by.offset - by.tie_width), spring), cap);
    if (by.tie_width > 0.0) p = size_of((by.base - g) + by.offset) > by.tie_width ? p : by.tie_pressure;
    const Lanes wearing = wearing_pressure(spring, p).counter;
    g += removal_of(by.wear_per_pressure, wearing);
    if (!is_straight<Spring>) sums.of(WearSum::WEARING) += wearing;
    sums.of(WearSum::PRESSURE) += p;
    sums.highest = sums.highest > p ? sums.highest : p;
    const Lanes d = p > zero ? p - by.reference : zero;
    sums.of(WearSum::DEVIATION_SQUARED) += d * d;
    sums.counted(WearSum::CONTACT) += one_if(p > zero);
    sums.counted(WearSum::CAPPED) += one_if(p >= cap);

    const Lanes w = g - unworn;
    touches = one_if(p > zero || w > zero);
    sums.counted(WearSum::TOUCHED) += touches;
    sums.of(WearSum::WORN) += w;
    sums.deepest = sums.deepest > w ? sums.deepest : w;

    const Lanes next = (by.base_next - g) + by.offset_next, r = on_spring(next, next_spring);
    const Lanes cap_next = by.cap, q = clipped(r, cap_next);
    sums.pressure_next += q;
    sums.between_next += r == q ? slope_on_spring(next, next_spring) : zero;
    const Lanes near = to_bound(r, cap_next, next_spring);
    sums.nearest_next = sums.nearest_next < near ? sums.nearest_next : near;
    return g;
}

// Whether a worn cell was ever touched. Where nothing wears the gap is as it was, and what touched does so
// still.
WARPWEAR_FN bool was_touched(const WearBy& by, double g, double unworn)
{ return pressure_by(by, g, by.stiffness) + (g - unworn) > 0.0; }

// First and last row and column of what was ever touched; the first ones negated, so that the largest count.
struct Extents {
    double first_row = NO_INDEX, last_row = NO_INDEX, first_column = NO_INDEX, last_column = NO_INDEX;
};

// Leave the sums of a slot. rest: cells touched, and wear, of tiles that it did not visit; beside: the change
// of pressure that those need to touch at the next approach.
template <typename Spring, typename Tables>
WARPWEAR_FN void store_wear(Tables& tables, int slot, const WearSums& sums, const Extents& extents,
                            double stiffness_next, double rest_touched, double rest_worn, double beside)
{
    const double nearest = -most(-sums.nearest_next), slope = stiffness_next * total(sums.between_next);
    const double largest[] = {most(sums.highest), most(sums.deepest),   extents.first_row,
                              extents.last_row,   extents.first_column, extents.last_column};
    const int lines = is_straight<Spring> ? int(WearSum::WEARING) : WearSums::LINES;
    const int more = sizeof(largest) / sizeof(double), ahead = lines + more;
    Partial partials[ahead + 3];
    sums.list<lines>(partials, tables.sums, slot);
    list_largest(partials + lines, tables.maxima, slot, largest);
    partials[int(WearSum::TOUCHED)].value += rest_touched;
    partials[int(WearSum::WORN)].value += rest_worn;
    partials[ahead] = {total(sums.pressure_next), &wp::index(tables.ahead, 0, slot), true};
    partials[ahead + 1] = {slope, &wp::index(tables.ahead, 1, slot), true};
    partials[ahead + 2] = {nearest < beside ? -nearest : -beside, &wp::index(tables.ahead, 2, slot), false};
    store_partials(partials);
}

// Columns of what was ever touched in a worn row of a CPU, looked for beyond those that are known.
template <typename Increment>
WARPWEAR_FN void find_columns(Extents& extents, const WearBy& by, const Increment& step, const int* tiles,
                              int listed, int vectors_per_row, const Stored* gap, const Stored* unworn)
{
    const double *const g = (const double*)gap, *const u = (const double*)unworn;
    const int cells = vectors_per_row * LANES, of_tile = OF_TILE * LANES;
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
template <typename List, typename Count, typename Laws, typename Increments, typename Field, typename Rest,
          typename Tables>
WARPWEAR_FN void wear_rows(int slot, int slots, const List& list, const Count& counts, const Laws& laws,
                           const Increments& steps, const Field& unworn_in, const Rest& rest, Field& gap_out,
                           Tables& tables)
{
    const auto& law = wp::index(laws, 0);
    const auto& step = wp::index(steps, 0);
    if (!step.is_ready) return;
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
    const int vectors_per_row = gap_out.shape[1] * OF_VECTOR;
    const bool first_thread = lane_of_slot() == 0;
    const Lanes cap = by.cap, stiffness = by.stiffness, stiffness_next = by.stiffness_next;
#if !defined(__CUDA_ARCH__)
    if (wp::index(counts, slot) == 0) { // most rows of an early contact
        store_wear<Lanes>(tables, slot, WearSums(), Extents(), 0.0, wp::index(rest, slot)[0],
                          wp::index(rest, slot)[1], NO_LIMIT);
        return;
    }
#endif
    WearSums sums;
    Extents extents;
    double rest_touched = 0.0, rest_worn = 0.0;
    // On a GPU whole numbers, of a thread: they take half the registers.
    int first_row = gap_out.shape[0], last_row = -1, first_column = vectors_per_row, last_column = -1;
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
        visit_listed(tiles, listed, vectors_per_row, [&](const int (&at)[AT_ONCE]) {
            Lanes g[AT_ONCE], u[AT_ONCE];
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                fetch((const double*)(gap + at[j] +
                                      16)); // a fifth of the time, where fields do not fit the cache
                fetch((const double*)(unworn + at[j] + 16));
                g[j] = gap[at[j]];
                u[j] = unworn[at[j]];
            }
#pragma unroll
            for (int j = 0; j < AT_ONCE; ++j) {
                if (AT_ONCE > 1 && at[j] < 0) continue;
                Counts touches;
                const Lanes after = wear_cell(sums, by, stiffness, stiffness_next, g[j], u[j], cap, touches);
#if !defined(__CUDA_ARCH__)
                gap[at[j]] = after;
#else
                if (after != g[j]) gap[at[j]] = after; // most cells of an early contact stay
                if (touches) {
                    first_row = wp::min(first_row, row);
                    last_row = row;
                    first_column = wp::min(first_column, at[j]);
                    last_column = wp::max(last_column, at[j]);
                }
#endif
            }
        });
#if !defined(__CUDA_ARCH__)
        if (count(sums.counted(WearSum::TOUCHED)) > 0.0) { // a slot has one row
            extents.first_row = -row;
            extents.last_row = row;
            find_columns(extents, by, step, tiles, listed, vectors_per_row, gap, unworn);
        }
#endif
    }
    if (last_row >= 0)
        extents = {-double(first_row), double(last_row), -double(first_column), double(last_column)};
    store_wear<Lanes>(tables, slot, sums, extents, by.stiffness_next, rest_touched, rest_worn, NO_LIMIT);
}

// Bring the tables of a step to numbers likewise, all lines at once: sums and maxima to a row of the history,
// and what was looked at ahead, two sums and a maximum, to what is returned.
template <typename Tables> WARPWEAR_FN wp::vec_t<3, double> total_step(const Tables& tables, double* totals)
{
    const int sums = tables.sums.shape[0], lines = sums + tables.maxima.shape[0];
    OF_SLOT double ahead[3];
    for (int line = team_of_slot(); line < lines + 3; line += teams_of_slot()) {
        double total = 0.0;
        if (line < sums)
            total = total_of_line(tables.sums, line, tables.sums.shape[1], true);
        else if (line < lines)
            total = total_of_line(tables.maxima, line - sums, tables.maxima.shape[1], false);
        else
            total = total_of_line(tables.ahead, line - lines, tables.ahead.shape[1], line - lines < 2);
        if (lane_of_team() == 0) *(line < lines ? totals + line : ahead + line - lines) = total;
    }
    wait_for_slot();
    return wp::vec_t<3, double>(ahead[0], ahead[1], ahead[2]);
}
