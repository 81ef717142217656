#pragma once
// The passes of a certificate: what a pressure violates, and how far its energy can lie above the least.
//
// Symbols: p pressure, t = g + u the gap g that its displacement u leaves, H the cap, L' the level of the
// lower bound. Lines of the table are those of the kernels in `half_space/certificate.py`.
#include "half_space/search.h"

// Sums: p, cells of which something is not a number. Maxima: p - H, -p, t where p > 0, -t where p < H.
template <typename Proof> WARPWEAR_FN void proof_extremes(int slot, int slots, Proof& proof)
{
    const int columns = proof.columns;
    Counts lost = 0;
    Lanes sum = 0.0, over = -NO_LIMIT, under = -NO_LIMIT, highest = -NO_LIMIT, lowest = -NO_LIMIT;
    each_cell(proof, slot, slots, [&](const SearchRow& row, const auto&, int i) {
        const Lanes zero = 0.0, none = NO_LIMIT, p = row.pressure[i], t = row.left(i), cap = row.cap_of(i);
        const Mask there = inside(i, columns), touches = there & (p > zero), below = there & (p < cap);
        const Lanes more = there ? p - cap : -none, less = there ? -p : -none;
        const Lanes up = touches ? t : -none, down = below ? -t : -none;
        lost += one_if(there) - one_if(there & (p == p) & (t == t));
        sum += there ? p : zero;
        over = over > more ? over : more;
        under = under > less ? under : less;
        highest = highest > up ? highest : up;
        lowest = lowest > down ? lowest : down;
    });
    store_lines(proof.table, slot, 2,
                {total(sum), count(lost), most(over), most(under), most(highest), most(lowest)});
}

// What cells carry at the cap: those with t up to the low end of the bracket, then those from there up to
// each of `LEVELS` levels in it. Maxima: t and -t in the bracket.
static const int LEVELS = 8;
template <typename Proof> WARPWEAR_FN void proof_carried(int slot, int slots, Proof& proof)
{
    const int columns = proof.columns;
    Lanes below = 0.0, highest = -NO_LIMIT, lowest = -NO_LIMIT, sums[LEVELS];
    for (int n = 0; n < LEVELS; ++n) sums[n] = 0.0;
    each_cell(proof, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes low = group.low, high = group.high, step = (group.high - group.low) / (LEVELS + 1);
        const Lanes zero = 0.0, none = NO_LIMIT, t = row.left(i), cap = row.cap_of(i);
        const Mask there = inside(i, columns), under = there & (t <= low),
                   within = there & (t > low) & (t <= high);
        below += under ? cap : zero;
        if (!any(within)) return; // as in most vectors
        const Lanes up = within ? t : -none, down = within ? -t : -none;
        highest = highest > up ? highest : up;
        lowest = lowest > down ? lowest : down;
        for (int n = 0; n < LEVELS; ++n) sums[n] += (within & (t <= low + double(n + 1) * step)) ? cap : zero;
    });
    double values[LEVELS + 3] = {total(below)};
    for (int n = 0; n < LEVELS; ++n) values[1 + n] = total(sums[n]);
    values[LEVELS + 1] = most(highest);
    values[LEVELS + 2] = most(lowest);
    store_lines(proof.table, slot, LEVELS + 1, values);
}

// Sum of p max(t - L', 0) + (H - p) max(L' - t, 0); without a cap the first term alone.
template <typename Proof> WARPWEAR_FN void proof_gap(int slot, int slots, Proof& proof)
{
    const int columns = proof.columns;
    Lanes sum = 0.0;
    each_cell(proof, slot, slots, [&](const SearchRow& row, const auto& group, int i) {
        const Lanes level = group.level;
        const Lanes zero = 0.0, p = row.pressure[i], t = row.left(i), cap = row.cap_of(i);
        const Mask there = inside(i, columns);
        sum += (there & (p > zero) & (t > level)) ? p * (t - level) : zero;
        sum += (there & (p < cap) & (t < level)) ? (cap - p) * (level - t) : zero;
    });
    store_sum(proof.table, 0, slot, total(sum));
}
