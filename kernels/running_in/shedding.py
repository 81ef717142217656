"""Pieces leave the bodies of a contact, in rounds, where they are due.

A round is `sum_up`, `find_peaks`, `begin_cut` and `cut`; rounds follow each other until no piece is due. One
for which the table of pieces has no room stops all, until the host has emptied it; what was begun goes on
then.
"""

import warp as wp

from warpwear.kernels.cells import NONE, ONE, ZERO, fields
from warpwear.kernels.native_code import most_of, sum_of
from warpwear.kernels.running_in.pieces import (
    CANDIDATES,
    CUT,
    DONE,
    DUE,
    OVERFLOW,
    OVERFLOW_BEFORE,
    PEAKS,
    PIECES,
    ROUND,
    SHEDS,
    STAGE,
    TAKES,
    Footprint,
    SheddingBody,
    native_pass,
    row_at,
)
from warpwear.kernels.sliding import SLIDES, Slide

#: All kernels of pieces are compiled together.
TOGETHER = wp.get_module("warpwear.kernels.running_in.pieces")

#: Columns of the table of pieces: step of the replay, body, round, index of the peak and of the middle,
#: volume over the area of a cell [mm], cells cut.
COLUMNS = 7


@wp.struct
class Release:
    """Holds the pieces that have left, and the flags by which a program goes on."""

    pieces: wp.array2d(dtype=wp.float64)
    count: wp.array(dtype=wp.int32)
    full: wp.array(dtype=wp.int32)  # 1 where a round found no room
    sheds: wp.array(dtype=wp.int32)  # whether there is another round
    closes: wp.array(dtype=wp.int32)  # whether a body is done with its rounds
    begins: wp.array(dtype=wp.int32)  # whether a step begins
    ends: wp.array(dtype=wp.int32)  # whether a step ends


@wp.func
def sum_around(cell: wp.int32, anew: wp.int32, footprint: Footprint, body: SheddingBody):
    """Sum up what is pending in the footprint of a cell; only where a piece was due, unless anew."""
    if anew == 0 and body.sums[cell] < footprint.needed:
        return
    row = cell // body.pending.shape[1]
    column = cell - row * body.pending.shape[1]
    total = ZERO + ZERO  # a variable of its own
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            total += body.pending[r, c]
    body.sums[cell] = total
    if anew == 1 and total >= footprint.needed:
        body.due[wp.atomic_add(body.counts, DUE, 1)] = cell


@wp.func
def find_peak(cell: wp.int32, footprint: Footprint, body: SheddingBody):
    """Note a cell whose sum calls for a piece, and is the largest (sum, index) of a square around it."""
    mine = body.sums[cell]
    if mine < footprint.needed:
        return
    width = body.pending.shape[1]
    row = cell // width
    column = cell - row * width
    low = wp.max(column - footprint.apart, 0)
    high = wp.min(column + footprint.apart, body.columns - 1)
    beaten = wp.int32(0)
    for away in range(2 * footprint.apart + 1):  # from the middle row outwards: most are beaten nearby
        step = (away + 1) // 2
        r = row_at(wp.where(away % 2 == 0, row - step, row + step), body)
        if r >= 0 and beaten == 0:
            for c in range(low, high + 1):
                other = r * width + c
                s = body.sums[other]
                beaten += wp.where(s > mine or (s == mine and other > cell), 1, 0)
    if beaten == 0:
        body.peaks[wp.atomic_add(body.counts, PEAKS, 1)] = cell


@wp.func
def cut_at(peak: wp.int32, place: wp.int32, footprint: Footprint, body: SheddingBody, release: Release):
    """Let a piece leave at a peak, which is entered in a place of the table, but for its step.

    Its middle is the cell near the peak with most pending, the last of those with as much. The crack surface
    lies where the cut has the volume of a piece, or what is pending.
    """
    width = body.pending.shape[1]
    row = peak // width
    column = peak - row * width
    most = -NONE + ZERO
    middle = peak + 0
    for i in range(row - footprint.reach, row + footprint.reach + 1):
        r = row_at(i, body)
        if r >= 0:
            for c in range(
                wp.max(column - footprint.reach, 0), wp.min(column + footprint.reach, body.columns - 1) + 1
            ):
                here = body.pending[r, c]
                if here > most or (here == most and r * width + c > middle):
                    most = here
                    middle = r * width + c
    row = middle // width
    column = middle - row * width
    held = ZERO + ZERO
    total = ZERO + ZERO
    cells = ZERO + ZERO
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            held += body.pending[r, c]
            total += body.down * body.height[r, c] - footprint.bowl[n]
            cells += ONE
    volume = wp.min(footprint.needed, held)
    # The volume above a level is convex in it: from above, Newton's steps lead down and end exactly.
    level = (volume + total) / cells
    before = cells + ONE
    while cells < before:
        before = cells
        cells = ZERO
        total = ZERO
        for n in range(footprint.bowl.shape[0]):
            r = row_at(row + footprint.along[n], body)
            c = column + footprint.across[n]
            if r >= 0 and c >= 0 and c < body.columns:
                least = body.down * body.height[r, c] - footprint.bowl[n]
                if least < level:
                    total += least
                    cells += ONE
        if cells > ZERO and cells < before:
            level = (volume + total) / cells
    stays = ONE - volume / held
    removed = ZERO + ZERO
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            body.pending[r, c] = body.pending[r, c] * stays
            depth = body.down * body.height[r, c]
            deeper = level + footprint.bowl[n]
            if deeper > depth:
                body.height[r, c] = body.down * deeper
                body.wear[r, c] = body.wear[r, c] + (deeper - depth)
                removed += deeper - depth
    release.pieces[place, 1] = wp.float64(body.number)
    release.pieces[place, 2] = wp.float64(body.counts[ROUND])
    release.pieces[place, 3] = wp.float64(peak)
    release.pieces[place, 4] = wp.float64(middle)
    release.pieces[place, 5] = removed
    release.pieces[place, 6] = cells


@wp.kernel(module=TOGETHER)
def begin_rounds(body: SheddingBody, release: Release):
    """Begin to shed, or go on with it."""
    if wp.tid() == 0:
        if body.counts[STAGE] == TAKES:
            body.counts[STAGE] = SHEDS
            body.counts[ROUND] = 0
            body.counts[PIECES] = 0
            body.counts[OVERFLOW_BEFORE] = body.counts[OVERFLOW]
            body.counts[OVERFLOW] = 0
        if body.counts[ROUND] == 0:  # also where the table was full before the first
            body.counts[DUE] = 0
        goes_on = body.counts[STAGE] == SHEDS and release.full[0] == 0 and body.counts[CANDIDATES] > 0
        release.sheds[0] = wp.where(goes_on, 1, 0)


@wp.kernel(module=TOGETHER)
def sum_up(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: SheddingBody):
    """Sum up what is pending around the cells listed; after the first round only where a piece was due."""
    first = first_slot * wp.block_dim() + wp.tid()
    if body.counts[ROUND] == 0:
        for n in range(first, body.counts[CANDIDATES], slots * wp.block_dim()):
            sum_around(body.candidates[n], 1, footprint, body)
    else:
        for n in range(first, body.counts[DUE], slots * wp.block_dim()):
            sum_around(body.due[n], 0, footprint, body)


@wp.kernel(module=TOGETHER)
def find_peaks(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: SheddingBody):
    """Find the peaks among the cells where a piece is due."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[DUE], slots * wp.block_dim()):
        find_peak(body.due[n], footprint, body)


@wp.kernel(module=TOGETHER)
def begin_cut(footprint: Footprint, body: SheddingBody, release: Release):
    """Cut the peaks of a round if the table has room for them, and let another round follow."""
    if wp.tid() == 0:
        peaks = body.counts[PEAKS]
        body.counts[PEAKS] = 0
        if release.count[0] + peaks > release.pieces.shape[0]:
            release.full[0] = 1
            peaks = 0
        if peaks > 0:
            release.count[0] = release.count[0] + peaks
            body.counts[PIECES] = body.counts[PIECES] + peaks
            body.counts[ROUND] = body.counts[ROUND] + 1
        body.counts[CUT] = peaks
        release.sheds[0] = wp.where(peaks > 0 and body.counts[ROUND] < footprint.rounds, 1, 0)


@wp.kernel(module=TOGETHER)
def cut(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    footprint: Footprint,
    body: SheddingBody,
    release: Release,
):
    """Let a piece leave at each peak."""
    peaks = body.counts[CUT]
    for n in range(first_slot * wp.block_dim() + wp.tid(), peaks, slots * wp.block_dim()):
        place = release.count[0] - peaks + n
        release.pieces[place, 0] = wp.float64(slides[0].number)
        cut_at(body.peaks[n], place, footprint, body, release)


@wp.kernel(module=TOGETHER)
def end_rounds(body: SheddingBody, release: Release):
    """Tell whether a body is done with its rounds."""
    if wp.tid() == 0:
        release.closes[0] = wp.where(body.counts[STAGE] == SHEDS and release.full[0] == 0, 1, 0)


@wp.kernel(module=TOGETHER)
def close(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: SheddingBody):
    """Cells where pieces are still due after all rounds wait for the next step; the sums are forgotten."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[CANDIDATES], slots * wp.block_dim()):
        cell = body.candidates[n]
        if body.counts[ROUND] == footprint.rounds:
            sum_around(cell, 0, footprint, body)
            if body.sums[cell] >= footprint.needed:
                body.overflow[wp.atomic_add(body.counts, OVERFLOW, 1)] = cell
        body.sums[cell] = ZERO


#: Sum up the rows that a step may have changed: under the contact, or all where pieces had overflowed.
total_rows = native_pass(
    "total_body", slides=SLIDES, footprint=Footprint, body=SheddingBody, **fields("wear", "pending")
)


@wp.kernel(module=TOGETHER)
def note(
    slides: wp.array(dtype=Slide),
    body: SheddingBody,
    first_column: wp.int32,
    rows_out: wp.array2d(dtype=wp.float64),
):
    """Enter what a body has lost in the row of the step: pieces, sums of wear and pending, deepest wear."""
    worn = sum_of(body.of_rows, 0)
    pending = sum_of(body.of_rows, 1)
    deepest = most_of(body.of_rows, 2)
    if wp.tid() == 0:
        row = slides[0].number
        rows_out[row, first_column] = wp.float64(body.counts[PIECES])
        rows_out[row, first_column + 1] = worn
        rows_out[row, first_column + 2] = pending - body.start
        rows_out[row, first_column + 3] = deepest
        body.counts[CANDIDATES] = 0
        body.counts[STAGE] = DONE


@wp.kernel(module=TOGETHER)
def end_step(counter: SheddingBody, disc: SheddingBody, release: Release, goes_out: wp.array(dtype=wp.int32)):
    """End a step when both bodies are done with it; stop the program where the table is full."""
    if wp.tid() == 0:
        ends = wp.where(release.full[0] == 0, 1, 0)
        if ends == 1:
            counter.counts[STAGE] = TAKES
            disc.counts[STAGE] = TAKES
        else:
            goes_out[0] = 0
        release.begins[0] = ends
        release.ends[0] = ends
