#pragma once
// The exact move of the few cells of a half-space contact whose place between the bounds is open.
//
// Where nearly all cells in contact bear the hardness, the others are few: those between the bounds, and
// those near enough to change sides. The pressure that is best for them, while all others stay, solves a
// small dense problem, to which conjugate steps take one transform after another. On a CPU alone: what one
// thread of a GPU takes for it is more than the steps that it saves.
#include "half_space/search.h"

#if !defined(__CUDA_ARCH__)
// Count the open cells of a slot, or list them from the place that the table tells. Listed, the trial becomes
// the pressure, which the open cells then leave.
template <bool lists, typename Solve, typename Few>
WARPWEAR_FN void open_cells(int slot, int slots, Solve& solve, const Few& few)
{
    const double near = solve.numbers.data[0].near;
    int place = lists ? (int)wp::index(solve.table, 1, slot) : 0, cells = 0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes level = group.level;
        const Lanes zero = 0.0, p = row.pressure[i], off = row.gradient[i] - level, cap = row.cap_of(i);
        const Mask open = ((p > zero) | (off < Lanes(near))) & ((p < cap) | (off > Lanes(-near)));
        if (lists) row.trial[i] = p;
        if (!any(open)) return;
        for (int j = 0; j < LANES; ++j) {
            const int column = i * LANES + j;
            if (!open[j] || column >= solve.columns) continue;
            if (lists) {
                few.row.data[place] = row.number;
                few.column.data[place] = column;
                few.slope.data[place] = off[j];
                few.low.data[place] = -p[j];
                few.high.data[place] = cap[j] - p[j];
                ++place;
            }
            ++cells;
        }
    });
    if (!lists) wp::index(solve.table, 0, slot) = double(cells);
}

// Solve matrix x = right for two right sides beside a symmetric matrix without negative eigenvalues, by
// Cholesky's method with diagonal pivots. equations: n rows of n + 2 numbers. factor: room for as many, whose
// columns are in the order of the pivots, so that none is computed for those before. Of like pivots the first
// is taken. Unknowns whose pivots are less than 1e-15 times the largest are not told from the others by the
// equations, and are 0.
WARPWEAR_FN void solve_pivoted(const double* equations, double* factor, double* rest, int* order, double* x,
                               int n)
{
    const int width = n + 2;
    double largest = 0.0;
    for (int i = 0; i < n; ++i) {
        rest[i] = equations[i * width + i];
        order[i] = i;
        largest = rest[i] > largest ? rest[i] : largest;
        x[2 * i] = x[2 * i + 1] = 0.0;
    }
    int rank = 0;
    for (; rank < n; ++rank) {
        int pivot = rank;
        for (int i = rank + 1; i < n; ++i) {
            const bool is_earlier = rest[i] == rest[pivot] && order[i] < order[pivot];
            pivot = rest[i] > rest[pivot] || is_earlier ? i : pivot;
        }
        if (!(rest[pivot] > 1.0e-15 * largest)) break;
        const auto swap = [&](auto* of) {
            const auto first = of[rank];
            of[rank] = of[pivot];
            of[pivot] = first;
        };
        swap(rest);
        swap(order);
        for (int k = 0; k < rank; ++k) swap(factor + k * width);
        double* const __restrict__ along = factor + rank * width;
        const double* const equation = equations + order[rank] * width;
        for (int i = rank; i < width; ++i) along[i] = equation[i < n ? order[i] : i];
        int k = 0;
        for (; k + 1 < rank; k += 2) { // two at a time: each row is read and stored half as often
            const double *const above = factor + k * width, *const below = above + width;
            const double times = above[rank], more = below[rank];
            for (int i = rank; i < width; ++i) {
                const double value = along[i] - times * above[i];
                along[i] = value - more * below[i];
            }
        }
        for (; k < rank; ++k) {
            const double* const above = factor + k * width;
            const double times = above[rank];
            for (int i = rank; i < width; ++i) along[i] -= times * above[i];
        }
        const double root = 1.0 / sqrt(rest[rank]);
        for (int i = rank; i < width; ++i) along[i] *= root;
        for (int i = rank + 1; i < n; ++i) rest[i] -= along[i] * along[i];
    }
    for (int row = rank - 1; row >= 0; --row) {
        const double* const along = factor + row * width;
        for (int side = 0; side < 2; ++side) {
            double value = along[n + side];
            for (int k = row + 1; k < rank; ++k) value -= along[k] * x[2 * order[k] + side];
            x[2 * order[row] + side] = value / along[row];
        }
    }
}

// Displacement of one of the few cells under a unit pressure on another.
template <typename Few> WARPWEAR_FN double between_cells(const Few& few, int one, int other)
{
    int along = few.row.data[one] - few.row.data[other],
        across = few.column.data[one] - few.column.data[other];
    along = along < 0 ? -along : along;
    across = across < 0 ? -across : across;
    along = along < few.rows - along ? along : few.rows - along;
    across = across < few.columns - across ? across : few.columns - across;
    return wp::index(few.elastic, along, across) + (across == 0 ? few.along.data[along] : 0.0);
}

// Changes x of n cells between bounds, whose sum is 0, with the least x . matrix x / 2 + slope . x. The
// bounds that hold are changed until they suit (Hintermueller, Ito and Kunisch 2002, SIAM J. Optim. 13, 865).
// Returns whether some lie between the bounds and an end was reached.
template <typename Few> WARPWEAR_FN bool best_of_few(const Few& few, int n)
{
    const int ROUNDS = 30; // changes of sides at most
    double *const matrix = few.matrix.data, *const x = few.change.data, *const pair = few.pair.data;
    int *const side = few.side.data, *const free = few.free.data;
    double largest = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            const double value = between_cells(few, i, j);
            matrix[i * n + j] = matrix[j * n + i] = value;
            largest = value > largest ? value : largest;
        }
    for (int i = 0; i < n; ++i) side[i] = 0;
    for (int round = 0; round < ROUNDS; ++round) {
        int count = 0;
        for (int i = 0; i < n; ++i) {
            x[i] = side[i] < 0 ? few.low.data[i] : side[i] > 0 ? few.high.data[i] : 0.0;
            if (side[i] == 0) free[count++] = i;
        }
        if (count == 0) return false;
        // A constant added, which a fixed sum does not feel, makes the matrix of all cells regular as well.
        double* const equations = few.equations.data;
        for (int i = 0; i < count; ++i) {
            const double* const row = matrix + free[i] * n;
            double pull = 0.0;
            for (int j = 0; j < n; ++j)
                if (x[j] != 0.0) pull += row[j] * x[j]; // of the cells at a bound
            double* const equation = equations + i * (count + 2);
            for (int j = 0; j < count; ++j) equation[j] = row[free[j]] + largest;
            equation[count] = -few.slope.data[free[i]] - pull;
            equation[count + 1] = 1.0;
        }
        solve_pivoted(equations, few.factor.data, few.rest.data, few.order.data, pair, count);
        double alone = 0.0, shift = 0.0, bound = 0.0, moved = 0.0;
        for (int i = 0; i < n; ++i) bound += x[i];
        for (int i = 0; i < count; ++i) {
            alone += pair[2 * i];
            shift += pair[2 * i + 1];
        }
        double level = (alone + bound) / shift;
        for (int i = 0; i < count; ++i) {
            x[free[i]] = pair[2 * i] - level * pair[2 * i + 1];
            moved += x[free[i]];
        }
        level += largest * moved;
        bool changes = false;
        for (int i = 0; i < n; ++i) {
            double pull = few.slope.data[i] + level; // negative where a cell would rise
            for (int j = 0; j < n && side[i] != 0; ++j) pull += matrix[i * n + j] * x[j];
            int now = 0;
            if (side[i] == 0)
                now = x[i] < few.low.data[i] ? -1 : x[i] > few.high.data[i] ? 1 : 0;
            else if (side[i] < 0)
                now = pull >= 0.0 ? -1 : 0;
            else
                now = pull <= 0.0 ? 1 : 0;
            few.next.data[i] = now;
            changes |= now != side[i];
        }
        for (int i = 0; i < n; ++i) side[i] = few.next.data[i];
        if (!changes) return true;
    }
    return false;
}

// Move the few open cells in the trial, exact at the bounds, which a sum may miss by its last digit.
template <typename Solve, typename Few> WARPWEAR_FN bool move_few(Solve& solve, const Few& few, int n)
{
    if (!best_of_few(few, n)) return false;
    for (int i = 0; i < n; ++i) {
        const SearchRow row(solve.fields, few.row.data[i]);
        const double x = few.change.data[i], low = few.low.data[i], high = few.high.data[i];
        const int column = few.column.data[i];
        const double cap = row.cap_of(column / LANES)[column % LANES];
        double& trial = ((double*)row.trial)[column];
        trial = x <= low ? 0.0 : x >= high ? cap : trial + x;
    }
    return true;
}
#else
template <typename Few> WARPWEAR_FN bool best_of_few(const Few&, int) { return false; }
template <bool lists, typename Solve, typename Few> WARPWEAR_FN void open_cells(int, int, Solve&, const Few&)
{
}
template <typename Solve, typename Few> WARPWEAR_FN bool move_few(Solve&, const Few&, int) { return false; }
#endif
