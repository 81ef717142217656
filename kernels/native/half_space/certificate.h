#pragma once
// The passes of a certificate: what a pressure violates, and how far its energy can lie above the least.
//
// Symbols: p pressure, t = g + u the gap g that its displacement u leaves, H the cap, L' the level of the
// lower bound. Lines of the table are those of the kernels in `half_space/certificate.py`.
#include "half_space/search.h"

// Where the cells of a row lie, and their caps.
struct ProofRow {
    const Stored *pressure, *gap, *displacement, *cap_ratio;
    Lanes cap;

    template <typename Fields>
    CUDA_CALLABLE ProofRow(const Fields& fields, int row)
        : pressure(row_of(fields.pressure, row)), gap(row_of(fields.gap, row)),
          displacement(row_of(fields.response, row)), cap_ratio(nullptr), cap(fields.cap)
    {
        if (fields.cap_ratio.shape[0] > 0) cap_ratio = row_of(fields.cap_ratio, row);
    }

    CUDA_CALLABLE Lanes cap_of(int i) const { return cap_ratio ? cap * cap_ratio[i] : cap; }
    CUDA_CALLABLE Lanes left(int i) const { return gap[i] + displacement[i]; }
};

// Sums: p, cells of which something is not a number. Maxima: p - H, -p, t where p > 0, -t where p < H.
template <typename Proof> WARPWEAR_FN void proof_extremes(int slot, int slots, Proof& proof)
{
    const int columns = proof.columns;
    Counts lost = 0;
    Lanes sum = 0.0, over = -NO_LIMIT, under = -NO_LIMIT, highest = -NO_LIMIT, lowest = -NO_LIMIT;
    each_cell<ProofRow>(proof, slot, slots, [&](const ProofRow& row, const auto&) {
        return [&, row](int i) {
            const Lanes zero = 0.0, none = NO_LIMIT, p = row.pressure[i], t = row.left(i),
                        cap = row.cap_of(i);
            const Counts no = 0, yes = 1;
            const Mask there = inside(i, columns), touches = there & (p > zero), below = there & (p < cap);
            const Lanes more = there ? p - cap : -none, less = there ? -p : -none;
            const Lanes up = touches ? t : -none, down = below ? -t : -none;
            lost += (there & ((p == p) & (t == t))) ? no : (there ? yes : no);
            sum += there ? p : zero;
            over = over > more ? over : more;
            under = under > less ? under : less;
            highest = highest > up ? highest : up;
            lowest = lowest > down ? lowest : down;
        };
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
    each_cell<ProofRow>(proof, slot, slots, [&](const ProofRow& row, const auto& group) {
        const Lanes low = group.low, high = group.high, step = (group.high - group.low) / (LEVELS + 1);
        return [&, row, low, high, step](int i) {
            const Lanes zero = 0.0, none = NO_LIMIT, t = row.left(i), cap = row.cap_of(i);
            const Mask there = inside(i, columns), under = there & (t <= low),
                       within = there & (t > low) & (t <= high);
            below += under ? cap : zero;
            if (!any(within)) return; // as in most vectors
            const Lanes up = within ? t : -none, down = within ? -t : -none;
            highest = highest > up ? highest : up;
            lowest = lowest > down ? lowest : down;
            for (int n = 0; n < LEVELS; ++n)
                sums[n] += (within & (t <= low + double(n + 1) * step)) ? cap : zero;
        };
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
    each_cell<ProofRow>(proof, slot, slots, [&](const ProofRow& row, const auto& group) {
        const Lanes level = group.level;
        return [&, row, level](int i) {
            const Lanes zero = 0.0, p = row.pressure[i], t = row.left(i), cap = row.cap_of(i);
            const Mask there = inside(i, columns);
            sum += (there & (p > zero) & (t > level)) ? p * (t - level) : zero;
            sum += (there & (p < cap) & (t < level)) ? (cap - p) * (level - t) : zero;
        };
    });
    store_sum(proof.table, 0, slot, total(sum));
}
