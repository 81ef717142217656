#pragma once
// Wear in pieces: what becomes pending of both bodies, where a piece is due, and the cut that it leaves.
//
// A cell is named by its index, row x width + column. Sums are made in the order of the footprint, without
// fused operations, and footprints of a round do not overlap: all devices find the same pieces.
#include "bodies.h"
#include "springs.h"

template <typename Body> WARPWEAR_FN int& count_of(const Body& body, PieceCount which)
{ return body.counts.data[int(which)]; }

// Append a cell to a list of a body.
template <typename Body, typename List>
WARPWEAR_FN void append(const Body& body, const List& list, PieceCount which, int cell)
{ list.data[wp::atomic_add(body.counts, int(which), 1)] = cell; }

// A row of a body, also beyond its ends; -1 where there is none.
template <typename Body> WARPWEAR_FN int row_at(int row, const Body& body)
{
    const int rows = body.pending.shape[0];
    if (row >= 0 && row < rows) return row;
    return body.periodic == 0 ? -1 : row < 0 ? row + rows : row - rows;
}

// Visit the cells of the footprint around a cell: their places and the depth of the bowl.
template <typename Footprint, typename Body, typename Visit>
WARPWEAR_FN void each_around(int cell, const Footprint& footprint, const Body& body, const Visit& visit)
{
    const int row = cell / body.pending.shape[1], column = cell % body.pending.shape[1];
    for (int n = 0; n < footprint.bowl.shape[0]; ++n) {
        const int r = row_at(row + footprint.along.data[n], body), c = column + footprint.across.data[n];
        if (r >= 0 && c >= 0 && c < body.columns)
            visit(r * body.pending.shape[1] + c, footprint.bowl.data[n]);
    }
}

// List a cell once. A sum of 0 says that it is not listed yet.
template <typename Body> WARPWEAR_FN void list_cell(int cell, const Body& body)
{
    if (wp::atomic_add(body.sums, cell, 1.0) == 0.0)
        append(body, body.candidates, PieceCount::CANDIDATES, cell);
}

// Make a depth pending, and list the cells whose footprints it lies in.
template <typename Footprint, typename Body>
WARPWEAR_FN void add_pending(int row, int column, double depth, const Footprint& footprint, const Body& body)
{
    const int cell = row * body.pending.shape[1] + column;
    body.pending.data[cell] += depth;
    each_around(cell, footprint, body, [&](int other, double) { list_cell(other, body); });
}

// Make the wear by the pressure of one cell pending.
template <typename Slide, typename Both>
WARPWEAR_FN void share_out(int row, int column, double pressure, const Slide& slide, const Both& both)
{
    if (!(pressure > 0.0)) return;
    const double of_counter = slide.removal.pending_counter, of_disc = slide.removal.pending_disc;
    const int under = under_row(row, slide.shift, both.disc.pending.shape[0]);
    if (of_counter > 0.0) add_pending(row, column, of_counter * pressure, both.footprint, both.counter);
    if (of_disc > 0.0) add_pending(under, column, of_disc * pressure, both.footprint, both.disc);
}

// Make the wear by a stored pressure pending.
template <typename Slides, typename Both, typename Field>
WARPWEAR_FN void take_field(int slot, int slots, const Slides& slides, const Both& both,
                            const Field& pressures)
{
    const Lanes zero = 0.0;
    for (int row = slot; row < pressures.shape[0]; row += slots)
        for (int i = lane_of_slot(); i < pressures.shape[1] * OF_VECTOR; i += width_of_slot()) {
            const Lanes p = row_of(pressures, row)[i];
            for (int j = 0; any(p > zero) && j < LANES; ++j)
                share_out(row, i * LANES + j, ((const double*)&p)[j], wp::index(slides, 0), both);
        }
}

// The same of the tiles listed, by a solved approach.
template <typename List, typename Count, typename Slides, typename Springs, typename Both,
          typename Properties, typename Field>
WARPWEAR_FN void take_tiles(int slot, int slots, const List& list, const Count& counts, const Slides& slides,
                            const Springs& springs, const Both& both, const Properties& cells,
                            const Field& gaps)
{
    for (int row = slot; row < gaps.shape[0]; row += slots)
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot()) {
            const Span span = span_of_tile(wp::index(list, row, n), gaps.shape[1] * OF_VECTOR);
            for (int i = span.first; i < span.end; i += span.stride)
                for (int column = i * LANES; column < (i + 1) * LANES; ++column)
                    share_out(row, column,
                              pressure_at(springs, gaps, cells.stiffness, cells.cap_ratio, row, column),
                              wp::index(slides, 0), both);
        }
}

// Do something with the cells of a list, each by one of all threads.
template <typename List, typename Do>
WARPWEAR_FN void each_of_list(int slot, int slots, const List& list, int count, const Do& act)
{
    const int width = width_of_slot();
    for (int n = slot * width + lane_of_slot(); n < count; n += slots * width) act(list.data[n], n);
}

// List the cells that were still due after all rounds of the last step.
template <typename Body> WARPWEAR_FN void list_waiting(int slot, int slots, const Body& body)
{
    each_of_list(slot, slots, body.waiting, count_of(body, PieceCount::WAITING),
                 [&](int cell, int) { list_cell(cell, body); });
}

// Sum up what is pending in the footprint of a cell; only where a piece was due, unless anew.
template <typename Footprint, typename Body>
WARPWEAR_FN void sum_around(int cell, bool anew, const Footprint& footprint, const Body& body)
{
    if (!anew && body.sums.data[cell] < footprint.needed) return;
    double total = 0.0;
    each_around(cell, footprint, body, [&](int other, double) { total += body.pending.data[other]; });
    body.sums.data[cell] = total;
    if (anew && total >= footprint.needed) append(body, body.due, PieceCount::DUE, cell);
}

// Sum up around the cells listed; after the first round only where a piece was due.
template <typename Footprint, typename Body>
WARPWEAR_FN void sum_up(int slot, int slots, const Footprint& footprint, const Body& body)
{
    const bool anew = count_of(body, PieceCount::ROUND) == 0;
    each_of_list(slot, slots, anew ? body.candidates : body.due,
                 count_of(body, anew ? PieceCount::CANDIDATES : PieceCount::DUE),
                 [&](int cell, int) { sum_around(cell, anew, footprint, body); });
}

// Note the cells whose sum calls for a piece, and is the largest (sum, index) of a square around them.
template <typename Footprint, typename Body>
WARPWEAR_FN void find_peaks(int slot, int slots, const Footprint& footprint, const Body& body)
{
    const int width = body.pending.shape[1], apart = footprint.apart;
    each_of_list(slot, slots, body.due, count_of(body, PieceCount::DUE), [&](int cell, int) {
        const int row = cell / width, column = cell % width;
        const int low = wp::max(column - apart, 0), high = wp::min(column + apart, body.columns - 1);
        const double mine = body.sums.data[cell];
        bool beaten = mine < footprint.needed;
        for (int away = 0; !beaten && away <= 2 * apart; ++away) { // outwards: most are beaten nearby
            const int step = (away + 1) / 2, r = row_at(away % 2 == 0 ? row - step : row + step, body);
            for (int c = low; r >= 0 && c <= high; ++c) {
                const int other = r * width + c;
                beaten |= body.sums.data[other] > mine || (body.sums.data[other] == mine && other > cell);
            }
        }
        if (!beaten) append(body, body.peaks, PieceCount::PEAKS, cell);
    });
}

// The cell near a peak with most pending, the last of those with as much.
template <typename Body> WARPWEAR_FN int middle_near(int peak, int reach, const Body& body)
{
    const int width = body.pending.shape[1], row = peak / width, column = peak % width;
    const int low = wp::max(column - reach, 0), high = wp::min(column + reach, body.columns - 1);
    double most = -NO_LIMIT;
    int middle = peak;
    for (int i = row - reach; i <= row + reach; ++i) {
        const int r = row_at(i, body);
        for (int cell = r * width + low; r >= 0 && cell <= r * width + high; ++cell) {
            const double here = body.pending.data[cell];
            if (here > most || (here == most && cell > middle)) {
                most = here;
                middle = cell;
            }
        }
    }
    return middle;
}

// Let a piece leave at each peak, whose middle is near it, and enter it in the table. The crack surface lies
// where the cut has the volume of a piece, or what is pending.
template <typename Slides, typename Footprint, typename Body, typename Release>
WARPWEAR_FN void cut(int slot, int slots, const Slides& slides, const Footprint& footprint, const Body& body,
                     const Release& release)
{
    const int peaks = count_of(body, PieceCount::CUT);
    double *const heights = body.height.data, *const pending = body.pending.data;
    each_of_list(slot, slots, body.peaks, peaks, [&](int peak, int n) {
        const int middle = middle_near(peak, footprint.reach, body);
        double held = 0.0, total = 0.0, cells = 0.0, removed = 0.0;
        each_around(middle, footprint, body, [&](int cell, double bowl) {
            held += pending[cell];
            total += body.down * heights[cell] - bowl;
            cells += 1.0;
        });
        const double volume = wp::min(footprint.needed, held);
        // The volume above a level is convex in it: from above, Newton's steps lead down and end exactly.
        double level = (volume + total) / cells, before = cells + 1.0;
        while (cells < before) {
            before = cells;
            cells = total = 0.0;
            each_around(middle, footprint, body, [&](int cell, double bowl) {
                const double least = body.down * heights[cell] - bowl;
                if (!(least < level)) return;
                total += least;
                cells += 1.0;
            });
            if (cells > 0.0 && cells < before) level = (volume + total) / cells;
        }
        const double stays = 1.0 - volume / held;
        each_around(middle, footprint, body, [&](int cell, double bowl) {
            pending[cell] *= stays;
            const double depth = body.down * heights[cell], deeper = level + bowl;
            if (!(deeper > depth)) return;
            heights[cell] = body.down * deeper;
            body.wear.data[cell] += deeper - depth;
            removed += deeper - depth;
        });
        const double step = wp::index(slides, 0).number, round = count_of(body, PieceCount::ROUND);
        const double piece[] = {step, double(body.number), round, double(peak), double(middle), removed,
                                cells};
        const int place = release.count.data[0] - peaks + n;
        for (int k = 0; k < release.pieces.shape[1]; ++k) wp::index(release.pieces, place, k) = piece[k];
    });
}

// Let the cells where pieces are still due after all rounds wait for the next step, and forget the sums.
template <typename Footprint, typename Body>
WARPWEAR_FN void close_rounds(int slot, int slots, const Footprint& footprint, const Body& body)
{
    const bool ended = count_of(body, PieceCount::ROUND) == footprint.rounds;
    each_of_list(slot, slots, body.candidates, count_of(body, PieceCount::CANDIDATES), [&](int cell, int) {
        if (ended) sum_around(cell, false, footprint, body);
        if (ended && body.sums.data[cell] >= footprint.needed)
            append(body, body.waiting, PieceCount::WAITING, cell);
        body.sums.data[cell] = 0.0;
    });
}

// Sums of wear and of what is pending, and the deepest wear, of the rows of a body that a step may have
// changed: those under the contact and beside it, or all where cells had waited.
template <typename Slides, typename Footprint, typename Body, typename Field>
WARPWEAR_FN void total_body(int slot, int slots, const Slides& slides, const Footprint& footprint,
                            const Body& body, const Field& wear_of, const Field& pending_of)
{
    CONTRACT_OFF
    const auto& slide = wp::index(slides, 0);
    const int rows = wear_of.shape[0], vectors_per_row = wear_of.shape[1] * OF_VECTOR;
    int first = slide.shift * body.number - footprint.margin, count = slide.rows + 2 * footprint.margin;
    if (count_of(body, PieceCount::WAITED) > 0) {
        first = 0;
        count = rows;
    } else if (body.periodic == 0) {
        count = wp::min(first + count, rows) - wp::max(first, 0);
        first = wp::max(first, 0);
    }
    count = wp::min(count, rows);
    for (int number = slot; number < count; number += slots) {
        const int row = (first + rows + number) % rows;
        const Stored *const wear = row_of(wear_of, row), *const pending = row_of(pending_of, row);
        Lanes worn = 0.0, waits = 0.0, deepest = 0.0;
        for (int i = lane_of_slot(); i < vectors_per_row; i += width_of_slot()) {
            worn += wear[i];
            waits += pending[i];
            deepest = larger_of(deepest, wear[i]);
        }
        store_sum(body.of_rows, 0, row, total(worn));
        store_sum(body.of_rows, 1, row, total(waits));
        store_most(body.of_rows, 2, row, most(deepest));
    }
}
