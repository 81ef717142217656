#pragma once
// The passes over all cells of a search for the tangential traction of a contact with friction.
//
// Symbols: q traction, a vector in each cell, |q| <= c its bound; s = D + e - Aq the slip, with the response
// Aq, the rigid displacement D of the increment and e, what the surfaces were displaced by at its start. At
// the solution s = 0 where |q| < c, else s = l q with l >= 0. A cell is tied if |q| = c and s does not point
// inward: there n = q/c, q moves along the circle alone, and l counts as the circle's curvature. All other
// cells in contact are free. Vectors are two rows of a field, so many rows apart as the grid has.
#include "lanes.h"

// Part of c² by which |q|² may lie below it on the circle.
static const double ON_CIRCLE = 1.0e-14;

struct Pair {
    Lanes x, y;
};

WARPWEAR_FN Pair operator+(Pair a, Pair b) { return {a.x + b.x, a.y + b.y}; }
WARPWEAR_FN Pair operator-(Pair a, Pair b) { return {a.x - b.x, a.y - b.y}; }
WARPWEAR_FN Pair operator*(Lanes by, Pair a) { return {by * a.x, by * a.y}; }
WARPWEAR_FN Lanes dot(Pair a, Pair b) { return a.x * b.x + a.y * b.y; }
WARPWEAR_FN Lanes only(Mask where, Lanes v)
{
    const Lanes zero = 0.0;
    return where ? v : zero;
}
WARPWEAR_FN Pair only(Mask where, Pair v) { return {only(where, v.x), only(where, v.y)}; }

// A row of a field of vectors.
struct PairRow {
    Stored *x, *y;

    template <typename Field>
    CUDA_CALLABLE PairRow(const Field& field, int row, int rows)
        : x(row_of(field, row)), y(row_of(field, rows + row))
    {
    }

    CUDA_CALLABLE Pair operator[](int i) const { return {x[i], y[i]}; }
    CUDA_CALLABLE void put(int i, Pair v) const
    {
        x[i] = v.x;
        y[i] = v.y;
    }
};

// Where the cells of a row lie, and what follows from them.
struct ShearRow {
    PairRow traction, start, response, gradient, change, trial, way;
    Stored* tie; // l >= 0 of a tied cell, -1 of others
    const Stored* bound;

    template <typename Shear>
    CUDA_CALLABLE ShearRow(const Shear& shear, int row, int rows)
        : traction(shear.traction, row, rows), start(shear.start, row, rows),
          response(shear.response, row, rows), gradient(shear.gradient, row, rows),
          change(shear.change, row, rows), trial(shear.trial, row, rows), way(shear.way, row, rows),
          tie(row_of(shear.tie, row)), bound(row_of(shear.bound, row))
    {
    }

    CUDA_CALLABLE Mask touches(int i) const { return bound[i] > Lanes(0.0); }
    CUDA_CALLABLE Mask on_circle(int i) const
    {
        const Pair q = traction[i];
        const Lanes c = bound[i];
        return touches(i) & (dot(q, q) >= (1.0 - ON_CIRCLE) * (c * c));
    }
    CUDA_CALLABLE Mask is_tied(int i) const { return tie[i] >= Lanes(0.0); }

    // How much harder a cell is to move for its multiplier.
    CUDA_CALLABLE Lanes held(int i, Lanes strength) const
    {
        const Lanes zero = 0.0, one = 1.0, l = tie[i];
        return one + strength * larger_of(l, zero);
    }

    // Of a cell among those that together must not move, and squared in the preconditioner.
    CUDA_CALLABLE Lanes weight(int i, Lanes strength) const
    { return only(touches(i), Lanes(1.0) / held(i, strength)); }

    // Part of a vector that a cell may follow: all of it, or of some cells what lies along the circle.
    CUDA_CALLABLE Pair along(int i, Pair v, Mask tied) const
    {
        if (!any(tied)) return v;
        const Lanes one = 1.0, c = bound[i], square = tied ? c * c : one;
        const Pair q = traction[i];
        return v - only(tied, dot(v, q) / square) * q;
    }
    CUDA_CALLABLE Pair along(int i, Pair v) const { return along(i, v, is_tied(i)); }
};

// Sums of the matrices that take the part which cells may follow, weighted: what a shift of all of them adds.
struct Ways {
    Lanes xx = 0.0, xy = 0.0, yy = 0.0;

    CUDA_CALLABLE void add(const ShearRow& row, int i, Lanes weight, Mask tied)
    {
        const Lanes zero = 0.0;
        const Pair x = row.along(i, {weight, zero}, tied), y = row.along(i, {zero, weight}, tied);
        xx += x.x;
        xy += x.y;
        yy += y.y;
    }
};

// Visit every cell of a slot.
template <typename Shear, typename Do>
WARPWEAR_FN void each_pair(const Shear& shear, int slot, int slots, const Do& of_cell)
{
    const int rows = shear.bound.shape[0], cells = shear.bound.shape[1] * OF_VECTOR;
    for (int number = slot; number < rows; number += slots) {
        const ShearRow row(shear, number, rows);
        for (int i = lane_of_slot(); i < cells; i += width_of_slot()) of_cell(row, i);
    }
}

// Add what the last traction displaced to where surfaces start from; set the traction to (c, 0).
template <typename Shear> WARPWEAR_FN void shear_starts(int slot, int slots, Shear& shear)
{
    each_pair(shear, slot, slots, [](const ShearRow& row, int i) {
        const Lanes zero = 0.0, c = row.bound[i];
        row.start.put(i, row.start[i] + row.response[i]);
        row.traction.put(i, {c, zero});
    });
}

// Begin with no traction. Sums: those of `shear_moves`, c. Maximum: the response to (c, 0).
template <typename Shear> WARPWEAR_FN void shear_scale(int slot, int slots, Shear& shear)
{
    Lanes sum = 0.0, largest = 0.0;
    Counts touching = 0;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Lanes zero = 0.0, none = -1.0;
        const Mask touches = row.touches(i);
        largest = larger_of(largest, only(touches, size_of(row.response.x[i])));
        touching += one_if(touches);
        sum += row.bound[i];
        row.tie[i] = none;
        row.traction.put(i, {zero, zero});
        row.gradient.put(i, {zero, zero});
        row.way.put(i, {zero, zero});
        row.trial.put(i, {zero, zero});
    });
    const double cells = count(touching);
    store_lines(shear.table, slot, 6, {0.0, 0.0, cells, 0.0, cells, total(sum), most(largest)});
}

// Sums over cells in contact: how many, e - Aq, what of it all may follow by their last weights, and the sum
// of how.
template <typename Shear> WARPWEAR_FN void shear_levels(int slot, int slots, Shear& shear)
{
    const Lanes strength = shear.numbers.data[0].strength, none = 0.0;
    Pair all = {none, none}, of_ways = all;
    Counts touching = 0;
    Ways ways;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Mask touches = row.touches(i), on = row.on_circle(i);
        const Lanes weight = row.weight(i, strength);
        const Pair left = only(touches, row.start[i] - row.response[i]);
        all = all + left;
        of_ways = of_ways + weight * row.along(i, left, on);
        touching += one_if(touches);
        ways.add(row, i, weight, on);
    });
    store_lines(shear.table, slot, 8,
                {count(touching), total(all.x), total(all.y), total(of_ways.x), total(of_ways.y),
                 total(ways.xx), total(ways.xy), total(ways.yy)});
}

// What the slip asks of each cell: ties, gradient with its change, and what the preconditioner is given.
// Maxima: squared breaches, of slip inside and along circles; slip against the traction on circles.
template <typename Shear> WARPWEAR_FN void shear_slips(int slot, int slots, Shear& shear)
{
    const auto& numbers = shear.numbers.data[0];
    const Pair level = {Lanes(numbers.level[0]), Lanes(numbers.level[1])};
    const Lanes strength = numbers.strength;
    Lanes aside = 0.0, against = 0.0;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Lanes zero = 0.0, one = 1.0, none = -1.0, c = row.bound[i];
        const Mask touches = row.touches(i), on = row.on_circle(i);
        const Pair q = row.traction[i], s = only(touches, level + row.start[i] - row.response[i]);
        const Lanes outward = dot(s, q) / (on ? c : one);
        row.tie[i] = (on & (outward >= zero)) ? outward / (on ? c : one) : none;
        const Pair across = s - only(on, outward / (on ? c : one)) * q;
        const Pair g = row.along(i, s);
        row.change.put(i, g - row.gradient[i]);
        row.gradient.put(i, g);
        row.trial.put(i, root_of(row.weight(i, strength)) * g);
        aside = larger_of(aside, dot(across, across));
        against = larger_of(against, only(on, -outward));
    });
    store_lines(shear.table, slot, 0, {most(aside), most(against)});
}

// Descent z of what the preconditioner made of the trial, and the last way d along the circles of now. Sums:
// z, d, what all cells may follow with its weights, g z, change z, g d, and of g and change what may be
// followed.
template <typename Shear> WARPWEAR_FN void shear_descends(int slot, int slots, Shear& shear)
{
    const Lanes strength = shear.numbers.data[0].strength;
    const Lanes none = 0.0;
    Pair all = {none, none}, last = all, of_g = all, of_change = all;
    Lanes gz = 0.0, cz = 0.0, gd = 0.0;
    Ways ways;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Mask tied = row.is_tied(i);
        const Lanes square = row.weight(i, strength);
        const Pair g = row.gradient[i], change = row.change[i];
        const Pair made = row.along(i, root_of(square) * row.trial[i]);
        // A cell that is to leave its circle, and that its neighbours' part of the preconditioner holds on
        // it, would stay for ever: it follows its own slip, by the preconditioner's diagonal.
        const Mask held = ~tied & row.on_circle(i) & (dot(made, row.traction[i]) >= Lanes(0.0));
        const Pair z = only(~held, made) + only(held, strength * g);
        const Pair d = only(~held, row.along(i, row.way[i]));
        row.trial.put(i, z);
        row.way.put(i, d);
        ways.add(row, i, square, tied);
        all = all + z;
        last = last + d;
        of_g = of_g + square * g;
        of_change = of_change + square * row.along(i, change);
        gz += dot(g, z);
        cz += dot(change, z);
        gd += dot(g, d);
    });
    store_lines(shear.table, slot, 14,
                {total(all.x), total(all.y), total(last.x), total(last.y), total(ways.xx), total(ways.xy),
                 total(ways.yy), total(gz), total(cz), total(gd), total(of_g.x), total(of_g.y),
                 total(of_change.x), total(of_change.y)});
}

// d = z + memory x the last way, less what all cells together must not move.
template <typename Shear> WARPWEAR_FN void shear_aims(int slot, int slots, Shear& shear)
{
    const auto& numbers = shear.numbers.data[0];
    const Lanes memory = numbers.memory, strength = numbers.strength;
    const Pair shift = {Lanes(numbers.mean[0]), Lanes(numbers.mean[1])};
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Pair less = row.along(i, row.weight(i, strength) * shift);
        row.way.put(i, row.trial[i] + memory * row.way[i] - less);
    });
}

// Sum: d Ad + l d², the curvature along the way.
template <typename Shear> WARPWEAR_FN void shear_curves(int slot, int slots, Shear& shear)
{
    Lanes sum = 0.0;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Pair d = row.way[i];
        const Lanes l = row.tie[i], zero = 0.0;
        sum += dot(d, row.response[i]) + larger_of(l, zero) * dot(d, d);
    });
    store_sum(shear.table, 0, slot, total(sum));
}

// The nearest traction within the circles to a trial, q + length x d, and a shift of all. goes: make the
// trial first, of tied cells so far out that a shift turns them as a step would and few of them come in.
// Sums: traction, and the derivative of that by the shift. Maximum: 1 where a free cell has come to its
// circle.
template <bool goes, typename Shear> WARPWEAR_FN void shear_moves(int slot, int slots, Shear& shear)
{
    const auto& numbers = shear.numbers.data[0];
    const Lanes length = numbers.length, strength = numbers.strength;
    const Pair shift = {Lanes(numbers.shift[0]), Lanes(numbers.shift[1])};
    Lanes x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, hit = 0.0;
    each_pair(shear, slot, slots, [&](const ShearRow& row, int i) {
        const Lanes zero = 0.0, one = 1.0, c = row.bound[i];
        const Mask touches = row.touches(i), was_on = row.on_circle(i);
        const Mask free_cell = ~row.is_tied(i);
        if (goes) row.trial.put(i, row.held(i, strength) * (row.traction[i] + length * row.way[i]));
        const Pair v = row.trial[i] + only(touches, shift);
        const Lanes square = dot(v, v);
        const Mask beyond = square > c * c;
        const Lanes size = root_of(beyond ? square : one), by = beyond ? c / size : one;
        const Pair q = by * v, n = only(beyond, (one / size) * v);
        row.traction.put(i, q);
        const Lanes weight = touches ? by : zero;
        x += q.x;
        y += q.y;
        xx += weight * (one - n.x * n.x);
        xy -= weight * (n.x * n.y);
        yy += weight * (one - n.y * n.y);
        if (goes) hit = larger_of(hit, (free_cell & row.on_circle(i) & ~was_on) ? one : zero);
    });
    store_lines(shear.table, slot, 5, {total(x), total(y), total(xx), total(xy), total(yy), most(hit)});
}
