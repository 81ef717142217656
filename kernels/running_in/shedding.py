"""Pieces leave the bodies of a contact, in rounds, where they are due.

A round is `sum_up`, `find_peaks`, `begin_cut` and `cut`; rounds follow each other until no piece is due. One
for which the table of pieces has no room stops all, until the host has emptied it; what was begun goes on
then.
"""

import warp as wp

from warpwear.kernels.cells import PieceCount, fields
from warpwear.kernels.native_code import most_of, sum_of
from warpwear.kernels.running_in.pieces import (
    DONE,
    OF_BODY,
    SHEDS,
    TAKES,
    Footprint,
    SheddingBody,
    native_pass,
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


@wp.kernel(module=TOGETHER)
def begin_rounds(body: SheddingBody, release: Release):
    """Begin to shed, or go on with it."""
    if wp.tid() == 0:
        if body.counts[PieceCount.STAGE] == TAKES:
            body.counts[PieceCount.STAGE] = SHEDS
            body.counts[PieceCount.ROUND] = 0
            body.counts[PieceCount.PIECES] = 0
            body.counts[PieceCount.WAITED] = body.counts[PieceCount.WAITING]
            body.counts[PieceCount.WAITING] = 0
        if body.counts[PieceCount.ROUND] == 0:  # also where the table was full before the first
            body.counts[PieceCount.DUE] = 0
        goes_on = body.counts[PieceCount.STAGE] == SHEDS and body.counts[PieceCount.CANDIDATES] > 0
        release.sheds[0] = wp.where(goes_on and release.full[0] == 0, 1, 0)


@wp.kernel(module=TOGETHER)
def begin_cut(footprint: Footprint, body: SheddingBody, release: Release):
    """Cut the peaks of a round if the table has room for them, and let another round follow."""
    if wp.tid() == 0:
        peaks = body.counts[PieceCount.PEAKS]
        body.counts[PieceCount.PEAKS] = 0
        if release.count[0] + peaks > release.pieces.shape[0]:
            release.full[0] = 1
            peaks = 0
        if peaks > 0:
            release.count[0] = release.count[0] + peaks
            body.counts[PieceCount.PIECES] = body.counts[PieceCount.PIECES] + peaks
            body.counts[PieceCount.ROUND] = body.counts[PieceCount.ROUND] + 1
        body.counts[PieceCount.CUT] = peaks
        release.sheds[0] = wp.where(peaks > 0 and body.counts[PieceCount.ROUND] < footprint.rounds, 1, 0)


@wp.kernel(module=TOGETHER)
def end_rounds(body: SheddingBody, release: Release):
    """Tell whether a body is done with its rounds."""
    if wp.tid() == 0:
        release.closes[0] = wp.where(body.counts[PieceCount.STAGE] == SHEDS and release.full[0] == 0, 1, 0)


#: Sum up what is pending around the cells listed; after the first round only where a piece was due.
sum_up = native_pass("sum_up", **OF_BODY)
#: Find the peaks among the cells where a piece is due, with the largest (sum, index) of a square around.
find_peaks = native_pass("find_peaks", **OF_BODY)
#: Let a piece leave at each peak.
cut = native_pass("cut", slides=SLIDES, **OF_BODY, release=Release)
#: Cells where pieces are still due after all rounds wait for the next step; the sums are forgotten.
close = native_pass("close_rounds", **OF_BODY)
#: Sum up the rows that a step may have changed: under the contact, or all where cells had waited.
total_rows = native_pass("total_body", slides=SLIDES, **OF_BODY, **fields("wear", "pending"))


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
        rows_out[row, first_column] = wp.float64(body.counts[PieceCount.PIECES])
        rows_out[row, first_column + 1] = worn
        rows_out[row, first_column + 2] = pending - body.start
        rows_out[row, first_column + 3] = deepest
        body.counts[PieceCount.CANDIDATES] = 0
        body.counts[PieceCount.STAGE] = DONE


@wp.kernel(module=TOGETHER)
def end_step(counter: SheddingBody, disc: SheddingBody, release: Release, goes_out: wp.array(dtype=wp.int32)):
    """End a step when both bodies are done with it; stop the program where the table is full."""
    if wp.tid() == 0:
        ends = wp.where(release.full[0] == 0, 1, 0)
        if ends == 1:
            counter.counts[PieceCount.STAGE] = TAKES
            disc.counts[PieceCount.STAGE] = TAKES
        else:
            goes_out[0] = 0
        release.begins[0] = ends
        release.ends[0] = ends
