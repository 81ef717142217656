#pragma once
// The passes over all cells of a search of the half-space solver, each with the sums that the next one needs.
//
// Symbols: p pressure, t = Gp + g its gradient (gap after deformation, from the mean planes), L the approach
// (level), H the cap. At the solution t = L on cells with 0 < p < H, t >= L where p = 0, t <= L where p = H.
// A cell is free if it may move: p > 0 or t < L, and p < H or t > L. Lines of the table are those of the
// kernels in `half_space/passes.py`.
#include "bodies.h"
#include "law.h"

// Rounding of a sum of two numbers, relatively.
static const double ROUNDING_OF_SUM = 4.0e-16;

// Where the cells of a row lie, and their caps.
struct SearchRow {
    Stored *pressure, *gradient, *trial, *step, *response;
    const Stored *gap, *cap_ratio, *yields;
    const StoredSingle* gathered;
    Lanes cap;
    int number;

    template <typename Fields>
    CUDA_CALLABLE SearchRow(const Fields& fields, int row)
        : pressure(row_of(fields.pressure, row)), gradient(row_or_none(fields.gradient, row)),
          trial(row_or_none(fields.trial, row)), step(row_or_none(fields.step, row)),
          response(row_of(fields.response, row)), gap(row_of(fields.gap, row)),
          cap_ratio(row_or_none(fields.cap_ratio, row)), yields(row_or_none(fields.yields, row)),
          gathered(fields.gathered.shape[0] > 0 ? single_row_of(fields.gathered, row) : nullptr),
          cap(fields.cap), number(row)
    {
    }

    CUDA_CALLABLE Lanes cap_of(int i) const { return cap_ratio ? cap * cap_ratio[i] : cap; }
    // The gap that is left under the displacement by the pressure.
    CUDA_CALLABLE Lanes left(int i) const { return gap[i] + response[i]; }
};

// Visit every cell of a slot: a row, the group that carries its load, and the cell's place in the row.
template <typename Solve, typename Visit>
WARPWEAR_FN void each_cell(const Solve& solve, int slot, int slots, const Visit& visit)
{
    const int rows = solve.visited.data[0], cells = solve.fields.pressure.shape[1] * OF_VECTOR;
    const bool is_one = solve.groups.shape[0] == 1;
    for (int row = slot; row < rows; row += slots) {
        const SearchRow here(solve.fields, row);
        const auto group = solve.groups.data[is_one ? 0 : row]; // a loop over cells need not read it again
        for (int i = lane_of_slot(); i < cells; i += width_of_slot()) visit(here, group, i);
    }
}

// Whether cells are columns of the grid, not the padding behind its last one.
WARPWEAR_FN Mask inside(int i, int columns) { return lanes_from(double(LANES * i)) < Lanes(double(columns)); }

WARPWEAR_FN Mask is_free(Lanes p, Lanes t, Lanes level, Lanes cap)
{ return ((p > Lanes(0.0)) | (t < level)) & ((p < cap) | (t > level)); }

// x + shift between 0 and the cap; at a bound where it is off it by the rounding of the sum alone.
WARPWEAR_FN Lanes shifted(Lanes x, Lanes shift, Lanes cap)
{
    CONTRACT_FAST
    const Lanes zero = 0.0, y = x + shift, rounding = ROUNDING_OF_SUM * size_of(shift);
    const Lanes low = y < rounding ? zero : y;
    return y > cap - rounding ? cap : low;
}

// Where there is a surface, sums of cells, g - mean and its square. Maximum: -g.
template <typename Solve> WARPWEAR_FN void moments(int slot, int slots, Solve& solve)
{
    const int columns = solve.columns;
    Counts cells = 0;
    Lanes first = 0.0, second = 0.0, lowest = -NO_LIMIT;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        CONTRACT_FAST
        const Lanes mean = group.mean;
        const Lanes zero = 0.0, none = NO_LIMIT, g = row.gap[i];
        const Mask there = inside(i, columns) & (g < Lanes(ABSENT));
        const Lanes above = there ? g - mean : zero, down = there ? -g : -none;
        cells += one_if(there);
        first += above;
        second += above * above;
        lowest = lowest > down ? lowest : down;
    });
    store_lines(solve.table, slot, 3, {count(cells), total(first), total(second), most(lowest)});
}

// Trial pressure of springs under the gap's mean; far below zero in the padding. Sums as those of `carried`.
template <typename Solve> WARPWEAR_FN void springs(int slot, int slots, Solve& solve)
{
    const int columns = solve.columns;
    const Lanes stiffness = solve.numbers.data[0].stiffness;
    Lanes sum = 0.0;
    Counts between = 0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes level = group.level;
        const Lanes zero = 0.0, none = NO_LIMIT, cap = row.cap_of(i);
        const Lanes x = inside(i, columns) ? (level - row.gap[i]) * stiffness : -none;
        row.trial[i] = x;
        sum += clipped(x, cap);
        between += one_if((x > zero) & (x < cap));
    });
    store_lines(solve.table, slot, 2, {total(sum), count(between)});
}

// Sums of the trial pressures, shifted and clipped, and of the cells between the bounds. takes: whether they
// become the pressure.
template <bool takes, typename Solve> WARPWEAR_FN void carried(int slot, int slots, Solve& solve)
{
    Lanes sum = 0.0;
    Counts between = 0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes shift = group.shift;
        const Lanes zero = 0.0, cap = row.cap_of(i), q = shifted(row.trial[i], shift, cap);
        if (takes) row.pressure[i] = q;
        sum += q;
        between += one_if((q > zero) & (q < cap));
    });
    store_lines(solve.table, slot, 2, {total(sum), count(between)});
}

// Pressures down to caps that may have fallen since they were solved.
template <typename Solve> WARPWEAR_FN void bound(int slot, int slots, Solve& solve)
{
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        const Lanes p = row.pressure[i], cap = row.cap_of(i);
        row.pressure[i] = p < cap ? p : cap;
    });
}

// What passes the cells of a body and yields there: the mean of the pressure, or of the step, times their
// compliance.
template <typename Solve, typename Streaks>
WARPWEAR_FN void streak(int slot, int slots, const Solve& solve, Streaks& streaks, bool of_step)
{
    const auto& fields = solve.fields;
    const int window = streaks.window.data[0];
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        const Lanes mean = mean_at(of_step ? fields.step : fields.pressure, row.number, i, window);
        row_of(streaks.yielded, row.number)[i] = row_of(streaks.yields, row.number)[i] * mean;
    });
}

// Add the mean of what has yielded along x to the response.
template <typename Solve, typename Streaks>
WARPWEAR_FN void add_streaks(int slot, int slots, Solve& solve, const Streaks& streaks)
{
    const int window = streaks.window.data[0];
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        row.response[i] += mean_at(streaks.yielded, row.number, i, window);
    });
}

// What compliances of each cell add to the response to the pressure, or to the step.
template <bool of_step, typename Solve> WARPWEAR_FN void yield(int slot, int slots, Solve& solve)
{
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        CONTRACT_FAST
        const Lanes x = of_step ? row.step[i] : row.pressure[i], b = row.yields[i];
        row.response[i] = row.response[i] + b * x;
    });
}

// The share of a cell in what the preconditioner is given, and in what it gives: w = 1/sqrt(1 + b M) with
// its compliance b and a coefficient M of the inverse, of longer waves than cells. w M w is about the inverse
// with b then. Of all cells' compliance c no b is less than -c, so that 1 + b M stays positive.
template <typename Solve> WARPWEAR_FN void weigh(int slot, int slots, Solve& solve)
{
    const Lanes stiffness = solve.numbers.data[0].longer_stiffness;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        CONTRACT_FAST
        const Lanes one = 1.0, b = row.yields[i];
        row.trial[i] = row.trial[i] / root_of(one + stiffness * b);
    });
}

// t = Gp + g from the response Gp; without end in the padding, which therefore stays open. Maximum: |Gp|.
template <typename Solve> WARPWEAR_FN void gradient(int slot, int slots, Solve& solve)
{
    const int columns = solve.columns;
    Lanes largest = 0.0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        const Lanes zero = 0.0, none = NO_LIMIT, u = row.response[i];
        const Mask there = inside(i, columns);
        row.gradient[i] = there ? row.gap[i] + u : none;
        const Lanes size = there ? size_of(u) : zero;
        largest = largest > size ? largest : size;
    });
    store_most(solve.table, 0, slot, most(largest));
}

// p += length x step, t += length x response; a whole step takes the shifted trial itself, exact at the
// bounds. Sums: p, cells in contact, cells between the bounds and their t. Maxima: t where p > 0, -t where p
// < H.
template <typename Solve> WARPWEAR_FN void advance(int slot, int slots, Solve& solve)
{
    const auto& numbers = solve.numbers.data[0];
    const bool whole = numbers.whole == 1, moves = numbers.length > 0.0;
    const Lanes by = numbers.length;
    Lanes sum = 0.0, level = 0.0, highest = -NO_LIMIT, lowest = -NO_LIMIT;
    Counts touching = 0, between = 0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        CONTRACT_FAST
        const Lanes shift = group.shift;
        const Lanes zero = 0.0, none = NO_LIMIT, cap = row.cap_of(i);
        Lanes p = row.pressure[i], t = row.gradient[i];
        if (moves) { // else there may be no response
            p = whole ? shifted(row.trial[i], shift, cap) : clipped(p + by * row.step[i], cap);
            t += by * row.response[i];
            row.pressure[i] = p;
            row.gradient[i] = t;
        }
        const Mask touches = p > zero, below = p < cap;
        const Lanes up = touches ? t : -none, down = below ? -t : -none;
        sum += p;
        touching += one_if(touches);
        between += one_if(touches & below);
        level += (touches & below) ? t : zero;
        highest = highest > up ? highest : up;
        lowest = lowest > down ? lowest : down;
    });
    store_lines(solve.table, slot, 4,
                {total(sum), count(touching), count(between), total(level), most(highest), most(lowest)});
}

// t - L on the free cells, 0 elsewhere, in the place of the trial.
template <typename Solve> WARPWEAR_FN void residual(int slot, int slots, Solve& solve)
{
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes level = group.level;
        const Lanes zero = 0.0, t = row.gradient[i];
        row.trial[i] = is_free(row.pressure[i], t, level, row.cap_of(i)) ? t - level : zero;
    });
}

// In some rows, sums of cells between the bounds and of the ends of their lines.
template <typename Solve> WARPWEAR_FN void scatter(int slot, int slots, Solve& solve)
{
    const int rows = solve.visited.data[0], every = solve.rules.data[0].every, cells = solve.columns;
    double inner = 0.0, ends = 0.0;
    for (int row = slot; row < rows; row += slots) {
        if (row % every) continue;
        const SearchRow here(solve.fields, row);
        const double* const p = (const double*)here.pressure;
        const double* const cap_ratio = (const double*)here.cap_ratio;
        const auto is_between = [&](int i) {
            const double cap = cap_ratio ? solve.fields.cap * cap_ratio[i] : solve.fields.cap;
            return (p[i] > 0.0) & (p[i] < cap);
        };
        for (int i = lane_of_slot(); i < cells; i += width_of_slot()) {
            const bool one = is_between(i);
            inner += one;
            if (i + 1 < cells) ends += one != is_between(i + 1);
        }
    }
    store_lines(solve.table, slot, 2, {inner, ends});
}

// Where a step goes down from a cell: its gradient, or what the preconditioner made of that.
struct Descent {
    bool is_plain, is_extended;

    CUDA_CALLABLE Lanes at(const SearchRow& row, int i, Lanes level) const
    {
        if (is_plain) return row.gradient[i] - level;
        if (is_extended) return doubled(row.gathered[i]);
        return row.trial[i];
    }
};

// Over the free cells, with descent z, r = t - L, last step s and its response y.
// Sums: cells, z, r, y, z y, z r, s r. Maxima: |z|, |r|.
template <typename Solve> WARPWEAR_FN void products(int slot, int slots, Solve& solve)
{
    const auto& numbers = solve.numbers.data[0];
    const Descent descent = {numbers.plain == 1, numbers.extended == 1};
    Counts free_cells = 0;
    Lanes sum_z = 0.0, sum_r = 0.0, sum_y = 0.0, zy = 0.0, zr = 0.0, sr = 0.0;
    Lanes largest_z = 0.0, largest_r = 0.0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        CONTRACT_FAST
        const Lanes level = group.level;
        const Lanes zero = 0.0, p = row.pressure[i], t = row.gradient[i];
        const Mask may = is_free(p, t, level, row.cap_of(i));
        if (!any(may)) return; // the others are not read
        const Lanes z = may ? descent.at(row, i, level) : zero, r = may ? t - level : zero;
        const Lanes y = may ? row.response[i] : zero, s = row.step[i], of_z = size_of(z), of_r = size_of(r);
        free_cells += one_if(may);
        sum_z += z;
        sum_r += r;
        sum_y += y;
        zy += z * y;
        zr += z * r;
        sr += s * r;
        largest_z = largest_z > of_z ? largest_z : of_z;
        largest_r = largest_r > of_r ? largest_r : of_r;
    });
    store_lines(solve.table, slot, 7,
                {count(free_cells), total(sum_z), total(sum_r), total(sum_y), total(zy), total(zr), total(sr),
                 most(largest_z), most(largest_r)});
}

// Trial pressure p + length x d, with d = -(z - its mean) + memory x last step on the free cells. Elsewhere
// d = -outward x (t - L), which points out of the bounds: such a cell moves only if the shift that restores
// the load is larger. Sums as those of `carried`.
template <typename Solve> WARPWEAR_FN void direction(int slot, int slots, Solve& solve)
{
    const auto& numbers = solve.numbers.data[0];
    const Descent descent = {numbers.plain == 1, numbers.extended == 1};
    const Lanes memory = numbers.memory, length = numbers.trial_length, out = -numbers.outward;
    Lanes sum = 0.0;
    Counts between = 0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        CONTRACT_FAST
        const Lanes level = group.level, mean = group.descent_mean;
        const Lanes zero = 0.0, p = row.pressure[i], t = row.gradient[i], cap = row.cap_of(i);
        const Mask may = is_free(p, t, level, cap);
        Lanes d = out * (t - level);
        if (any(may)) d = may ? memory * row.step[i] - (descent.at(row, i, level) - mean) : d;
        const Lanes x = p + length * d;
        row.trial[i] = x;
        sum += clipped(x, cap);
        between += one_if((x > zero) & (x < cap));
    });
    store_lines(solve.table, slot, 2, {total(sum), count(between)});
}

// Feasible step to the shifted trial. Sum: step x (t - L). Maximum: fraction used of the room to a bound.
template <typename Solve> WARPWEAR_FN void step(int slot, int slots, Solve& solve)
{
    Lanes slope = 0.0, used = 0.0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        CONTRACT_FAST
        const Lanes level = group.level, shift = group.shift;
        const Lanes zero = 0.0, cap = row.cap_of(i), p = row.pressure[i];
        const Lanes s = shifted(row.trial[i], shift, cap) - p;
        row.step[i] = s;
        const Mask moves = s != zero;
        if (!any(moves)) return;
        const Lanes room = s < zero ? p : cap - p;
        const Mask more = moves & (size_of(s) > used * room);
        if (any(more)) used = more ? size_of(s) / room : used; // a division is dear
        slope += moves ? s * (row.gradient[i] - level) : zero;
    });
    store_partials({{total(slope), &wp::index(solve.table, 0, slot), true},
                    {most(used), &wp::index(solve.table, 2, slot), false}});
}

// Sum of step x response. Maximum: |response|.
template <typename Solve> WARPWEAR_FN void curvature(int slot, int slots, Solve& solve)
{
    Lanes sum = 0.0, largest = 0.0;
    each_cell(solve, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        CONTRACT_FAST
        const Lanes y = row.response[i], size = size_of(y);
        sum += row.step[i] * y;
        largest = largest > size ? largest : size;
    });
    store_partials({{total(sum), &wp::index(solve.table, 1, slot), true},
                    {most(largest), &wp::index(solve.table, 3, slot), false}});
}
