#pragma once
// What the preconditioner of a search does beside its transforms: it extends values of free cells to others.
//
// |q| E*/2 is the inverse of the whole surface. Of free cells alone it is the inverse of their own operator
// if their gradient is extended to the other cells so that no pressure is needed there. About that extension
// is made here, by two of Jacobi's iterations with the coefficients of next neighbours alone. Whatever
// extension E is made, E' |q| E is symmetric and positive as |q| is. In single precision, as the transforms
// between. Symbols as in `search.h`. A GPU makes each iteration in a pass of its own, see
// `half_space/extension.py`.
#include "half_space/search.h"

// A GPU makes each iteration in a pass of its own, a cell a thread, between the trial and two fields that lie
// one after the other in `gathered`.

// Weighted sum of what the neighbours of a cell have. rows: of the field before, at and behind the cell, null
// beyond an edge that does not repeat.
template <typename Value, typename Solve>
WARPWEAR_FN float around_cell(const Solve& solve, const Value* const (&rows)[3], int column)
{
    const int columns = solve.columns;
    int left = column - 1, right = column + 1;
    if (left < 0) left = solve.wraps_across == 1 ? columns - 1 : -1;
    if (right == columns) right = solve.wraps_across == 1 ? 0 : -1;
    float along = 0.0f, corner = 0.0f;
    for (int side = 0; side < 3; side += 2) {
        const Value* const row = rows[side];
        if (!row) continue;
        along += float(row[column]);
        if (left >= 0) corner += float(row[left]);
        if (right >= 0) corner += float(row[right]);
    }
    float across = left >= 0 ? float(rows[1][left]) : 0.0f;
    if (right >= 0) across += float(rows[1][right]);
    const float* const weights = solve.neighbours.data;
    return weights[0] * along + weights[1] * across + weights[2] * corner;
}

// One of five passes: 0 and 1 extend the trial of free cells to the others; 2 to 4 add to it what the others
// have. What lies around a cell is loaded whether it is needed or not: a branch would wait for the cell's
// own.
template <int pass, typename Solve> WARPWEAR_FN void extend_pass(int slot, int slots, Solve& solve)
{
    const int rows = solve.fields.pressure.shape[0], columns = solve.columns;
    const Lanes level = solve.groups.data[0].level;
    for (int row = slot; row < rows; row += slots) {
        const SearchRow cells(solve.fields, row);
        double* const trial = (double*)cells.trial;
        float* const one = &wp::index(solve.fields.gathered, row, 0);
        float* const other = &wp::index(solve.fields.gathered, rows + row, 0);
        const int above = row > 0 ? row - 1 : solve.wraps_along == 1 ? rows - 1 : -1;
        const int below = row < rows - 1 ? row + 1 : solve.wraps_along == 1 ? 0 : -1;
        const auto around = [&](int column) {
            if constexpr (pass == 0) {
                const auto of = [&](int r) {
                    return r < 0 ? nullptr : (double*)row_of(solve.fields.trial, r);
                };
                const double* const three[3] = {of(above), trial, of(below)};
                return around_cell(solve, three, column);
            } else {
                const int first = pass == 4 ? rows : 0; // of `other`, or of `one`
                const auto of = [&](int r) {
                    return r < 0 ? nullptr : &wp::index(solve.fields.gathered, first + r, 0);
                };
                const float* const three[3] = {of(above), of(row), of(below)};
                return around_cell(solve, three, column);
            }
        };
        for (int column = lane_of_slot(); column < columns; column += width_of_slot()) {
            const int i = column / LANES, j = column % LANES;
            const Mask may_move = is_free(cells.pressure[i], cells.gradient[i], level, cells.cap_of(i));
            const bool may = lane_of(may_move, j);
            const double value = trial[column];
            const float near = pass == 2 ? 0.0f : around(column);
            if (pass == 0) one[column] = may ? float(value) : near;
            if (pass == 1 && !may) trial[column] = near;
            if (pass == 2) one[column] = may ? 0.0f : float(value);
            if (pass == 3) other[column] = may ? 0.0f : float(value) + near;
            if (pass == 4 && may) trial[column] = value + near;
        }
    }
}

template <typename Solve> WARPWEAR_FN void extend_once(int slot, int slots, Solve& solve, int pass)
{
    if (pass == 0) extend_pass<0>(slot, slots, solve);
    if (pass == 1) extend_pass<1>(slot, slots, solve);
    if (pass == 2) extend_pass<2>(slot, slots, solve);
    if (pass == 3) extend_pass<3>(slot, slots, solve);
    if (pass == 4) extend_pass<4>(slot, slots, solve);
}

// A CPU makes both iterations at once, tile by tile.
#if !defined(__CUDA_ARCH__)
static const int BLOCK_ROWS = 16; // rows of a slot
static const int TILE = 128;      // vectors of a row that are looked at together

// Sum of the neighbours of eight cells, weighed: along x (rows above and below), across and at the corners.
// Vectors to the left and right of these three must be there.
struct Neighbours {
    float along, across, corner;

    SingleLanes operator()(const SingleLanes* above, const SingleLanes* here, const SingleLanes* below) const
    {
        CONTRACT_FAST
        const SingleLanes before = above[-1] + below[-1], beside = above[0] + below[0],
                          after = above[1] + below[1];
        const SingleLanes left = __builtin_shufflevector(before, beside, 7, 8, 9, 10, 11, 12, 13, 14);
        const SingleLanes right = __builtin_shufflevector(beside, after, 1, 2, 3, 4, 5, 6, 7, 8);
        const SingleLanes own_left = __builtin_shufflevector(here[-1], here[0], 7, 8, 9, 10, 11, 12, 13, 14);
        const SingleLanes own_right = __builtin_shufflevector(here[0], here[1], 1, 2, 3, 4, 5, 6, 7, 8);
        return along * beside + across * (own_left + own_right) + corner * (left + right);
    }
};

// Extend t - L of the free cells to the others, in the trial; or, where it gathers, add to the trial of free
// cells what that of the others gives back, in `gathered`: the transpose. A slot is a block of rows.
//
// Cells of a tile and two around it begin with what the fields hold, `begun`, and from it those one further
// in are made, `within`; eight at a time, after two vectors that end in what lies to the left. Where there is
// no cell there is nothing.
template <bool gathers, typename Solve> WARPWEAR_FN void extend(int slot, int, Solve& solve)
{
    const int ahead = 16, rows = solve.fields.pressure.shape[0], columns = solve.columns;
    const Neighbours around = {solve.neighbours.data[0], solve.neighbours.data[1], solve.neighbours.data[2]};
    const Lanes level = solve.groups.data[0].level;
    SingleLanes begun[BLOCK_ROWS + 4][TILE + 4], bound[BLOCK_ROWS + 4][TILE + 4],
        within[BLOCK_ROWS + 2][TILE + 4];
    const int top = slot * BLOCK_ROWS, height = rows - top < BLOCK_ROWS ? rows - top : BLOCK_ROWS;
    for (int left = 0; left < columns; left += LANES * TILE) {
        const int size = columns - left < LANES * TILE ? columns - left : LANES * TILE;
        const int vectors = (size + LANES - 1) / LANES;
        for (int i = 0; i < height + 4; ++i) {
            float *const begins = (float*)begun[i], *const bounds = (float*)bound[i];
            const int place = top + i - 2, number = (place + 2 * rows) % rows;
            const SearchRow row(solve.fields, number);
            const auto load = [&](int v, SingleLanes& begin, SingleLanes& is_bound) {
                const Lanes zero = 0.0, one = 1.0, t = row.gradient[v];
                const Mask may = is_free(row.pressure[v], t, level, row.cap_of(v));
                begin = halved(gathers ? (may ? zero : row.trial[v]) : (may ? t - level : zero));
                is_bound = halved(may ? zero : one);
            };
            for (int v = 0; v < vectors; ++v) load(left / LANES + v, begun[i][v + 2], bound[i][v + 2]);
            for (int side = 0; side < 4; ++side) {
                const int k = side < 2 ? side - 2 : size + side - 2, j = (left + k + 2 * columns) % columns;
                SingleLanes begin, is_bound;
                load(j / LANES, begin, is_bound);
                const bool there = solve.wraps_across == 1 || j == left + k;
                begins[ahead + k] = there ? begin[j % LANES] : 0.0f;
                bounds[ahead + k] = there ? is_bound[j % LANES] : 0.0f;
            }
            if (solve.wraps_along == 0 && number != place)
                for (int k = ahead - 2; k < ahead + size + 2; ++k) begins[k] = bounds[k] = 0.0f;
        }
        for (int i = 0; i < height + 2; ++i)
            for (int v = 1; v < vectors + 3; ++v)
                within[i][v] = begun[i + 1][v] +
                               bound[i + 1][v] * around(begun[i] + v, begun[i + 1] + v, begun[i + 2] + v);
        for (int i = 0; i < height; ++i) {
            Stored* const trial = row_of(solve.fields.trial, top + i) + left / LANES;
            StoredSingle* const gathered = single_row_of(solve.fields.gathered, top + i) + left / LANES;
            for (int v = 0; v < vectors; ++v) {
                const SingleLanes more =
                    around(within[i] + v + 2, within[i + 1] + v + 2, within[i + 2] + v + 2);
                if (gathers)
                    gathered[v] = halved(trial[v]) + more;
                else
                    trial[v] = doubled(begun[i + 2][v + 2] + bound[i + 2][v + 2] * more);
            }
        }
    }
}
#else
template <bool gathers, typename Solve> WARPWEAR_FN void extend(int, int, Solve&) {}
#endif
