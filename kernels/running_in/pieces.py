"""Wear in pieces: what is pending of each body, where a piece is due, and the cut that it leaves.

Fields are those of the bodies, seen as numbers. A cell is named by its index, row × width + column. Sums over
a footprint are depths [mm]: volumes over the area of a cell. Every sum is made in the order of the footprint,
without fused operations, and footprints of a round do not overlap: all devices find the same pieces.

A step lists the cells whose footprints gained (`list_waiting`, `take_field`, `take_tiles`). Then each body
sheds in rounds: `sum_up`, `find_peaks`, `begin_cut`, `cut`, until no piece is due. A round for which the
table of pieces has no room stops all, until the host has emptied it; what was begun goes on then.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import Springs, law_of_cell
from warpwear.kernels.cells import LANES, NONE, ONE, TILE_VECTORS, ZERO, Cells
from warpwear.kernels.contact import pressure_of
from warpwear.kernels.slide import Slide, beneath

wp.set_module_options({**native_code.options("pieces.h"), "fuse_fp": False})

#: Counts of a body: cells listed, peaks of a round and those that are cut, rounds in which pieces left, cells
#: that wait for the next step, whether any had waited for this one, how far the step is, its pieces.
LISTED, PEAKS, CUT, ROUND, WAITING, HAD_WAITED, STAGE, PIECES = (wp.constant(wp.int32(n)) for n in range(8))
COUNTS = 8
#: How far a body is with a step: it takes wear, sheds pieces, or is done.
TAKES, SHEDS, DONE = (wp.constant(wp.int32(n)) for n in range(3))
#: Columns of the table of pieces: step of the replay, body, round, index of the peak and of the middle,
#: volume over the area of a cell [mm], cells cut.
COLUMNS = 7


@wp.struct
class Footprint:
    """What is the same for all pieces."""

    along: wp.array(dtype=wp.int32)  # offsets of its cells
    across: wp.array(dtype=wp.int32)
    bowl: wp.array(dtype=wp.float64)  # depth of the piece [mm]
    needed: wp.float64  # sum of the bowl: V* over the area of a cell [mm]
    reach: wp.int32  # cells beside a peak where the middle of its piece may lie
    apart: wp.int32  # cells beside a peak where no other is one
    margin: wp.int32  # cells beside one in contact that a piece may reach
    rounds: wp.int32  # of a step at most


@wp.struct
class Body:
    """One of the bodies, and what is due of it."""

    height: wp.array2d(dtype=wp.float64)  # as worn [mm]
    wear: wp.array2d(dtype=wp.float64)  # [mm]
    pending: wp.array2d(dtype=wp.float64)  # [mm]
    sums: wp.array(dtype=wp.float64)  # pending in the footprint around a listed cell, 0 elsewhere [mm]
    listed: wp.array(dtype=wp.int32)  # cells whose footprint gained in this step
    waiting: wp.array(dtype=wp.int32)  # cells that are due since the rounds of a step were not enough
    peaks: wp.array(dtype=wp.int32)  # those where a piece is due in this round
    counts: wp.array(dtype=wp.int32)  # by `LISTED` and so on
    of_rows: wp.array2d(dtype=wp.float64)  # sums of wear and pending, and the deepest wear, of each row [mm]
    start: wp.float64  # sum of what was pending at first [mm]
    down: wp.float64  # 1 where heights grow as a body is worn, as those of the sphere; −1 of the disc
    number: wp.int32  # 0 the sphere, 1 the disc
    columns: wp.int32  # without padding
    periodic: wp.int32  # 1 where after the last row comes the first


@wp.struct
class Left:
    """The pieces that have left, and the flags by which a program goes on."""

    pieces: wp.array2d(dtype=wp.float64)
    count: wp.array(dtype=wp.int32)
    full: wp.array(dtype=wp.int32)  # 1 where a round found no room
    sheds: wp.array(dtype=wp.int32)  # whether there is another round
    closes: wp.array(dtype=wp.int32)  # whether a body is done with its rounds
    begins: wp.array(dtype=wp.int32)  # whether a step begins
    ends: wp.array(dtype=wp.int32)  # whether a step ends


@wp.func
def row_at(row: wp.int32, body: Body):
    """A row of a body, also beyond its ends; −1 where there is none."""
    rows = body.pending.shape[0]
    if row >= 0 and row < rows:
        return row
    if body.periodic == 0:
        return -1
    return wp.where(row < 0, row + rows, row - rows)


@wp.func
def list_cell(cell: wp.int32, body: Body):
    """List a cell once. A sum of 0 says that it is not listed yet."""
    if wp.atomic_add(body.sums, cell, ONE) == ZERO:
        body.listed[wp.atomic_add(body.counts, LISTED, 1)] = cell


@wp.func
def add_pending(row: wp.int32, column: wp.int32, depth: wp.float64, footprint: Footprint, body: Body):
    """Make a depth pending, and list the cells whose footprints it lies in."""
    body.pending[row, column] = body.pending[row, column] + depth
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            list_cell(r * body.pending.shape[1] + c, body)


@wp.func
def share_out(
    row: wp.int32,
    column: wp.int32,
    pressure: wp.float64,
    slide: Slide,
    footprint: Footprint,
    sphere: Body,
    disc: Body,
):
    """Make the wear by the pressure of one cell pending."""
    if pressure > ZERO:
        if slide.pending_sphere > ZERO:
            add_pending(row, column, slide.pending_sphere * pressure, footprint, sphere)
        if slide.pending_disc > ZERO:
            under = beneath(row, slide.shift, disc.pending.shape[0])
            add_pending(under, column, slide.pending_disc * pressure, footprint, disc)


@wp.kernel
def take_field(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    footprint: Footprint,
    pressure_in: wp.array2d(dtype=Cells),
    sphere: Body,
    disc: Body,
):
    """Make the wear by a stored pressure pending."""
    slot = first_slot + wp.tid() // wp.block_dim()
    slide = slides[0]
    for row in range(slot, pressure_in.shape[0], slots):
        for k in range(wp.tid() % wp.block_dim(), pressure_in.shape[1], wp.block_dim()):
            p = pressure_in[row, k]
            if wp.max(p) > ZERO:
                for j in range(LANES):
                    share_out(row, k * LANES + j, p[j], slide, footprint, sphere, disc)


@wp.kernel
def take_tiles(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    footprint: Footprint,
    springs: Springs,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    stiffness_in: wp.array2d(dtype=Cells),
    parts_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    sphere: Body,
    disc: Body,
):
    """Make the wear by the pressure of a solved approach pending, of the tiles listed.

    stiffness_in, parts_in of the cap: of every cell, or no rows where all have one.
    """
    slot = first_slot + wp.tid() // wp.block_dim()
    slide = slides[0]
    law = springs.law[0]
    s = Cells(springs.search[0].stiffness)
    for row in range(slot, gap_in.shape[0], slots):
        for n in range(wp.tid() % wp.block_dim(), count_in[row], wp.block_dim()):
            t = tiles_in[row, n]
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
                g = gap_in[row, k]
                if stiffness_in.shape[0] > 0:
                    s = stiffness_in[wp.min(row, stiffness_in.shape[0] - 1), k]
                part = Cells(ONE)
                if parts_in.shape[0] > 0:
                    part = parts_in[row, k]
                for j in range(LANES):
                    p = pressure_of(law_of_cell(law, part[j]), g[j], s[j])
                    share_out(row, k * LANES + j, p, slide, footprint, sphere, disc)


@wp.kernel
def list_waiting(first_slot: wp.int32, slots: wp.int32, body: Body):
    """List cells that have waited since the last step."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[WAITING], slots * wp.block_dim()):
        list_cell(body.waiting[n], body)


@wp.func
def sum_around(cell: wp.int32, anew: wp.int32, footprint: Footprint, body: Body):
    """What is pending in the footprint around a cell; only where a piece was due, unless anew."""
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


@wp.func
def find_peak(cell: wp.int32, footprint: Footprint, body: Body):
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
def cut_at(peak: wp.int32, place: wp.int32, footprint: Footprint, body: Body, left: Left):
    """A piece leaves at a peak, and is entered in a place of the table, but for its step.

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
    left.pieces[place, 1] = wp.float64(body.number)
    left.pieces[place, 2] = wp.float64(body.counts[ROUND])
    left.pieces[place, 3] = wp.float64(peak)
    left.pieces[place, 4] = wp.float64(middle)
    left.pieces[place, 5] = removed
    left.pieces[place, 6] = cells


@wp.kernel
def begin_rounds(first_slot: wp.int32, slots: wp.int32, body: Body, left: Left):
    """A body begins to shed, or goes on with it."""
    if wp.tid() == 0:
        if body.counts[STAGE] == TAKES:
            body.counts[STAGE] = SHEDS
            body.counts[ROUND] = 0
            body.counts[PIECES] = 0
            body.counts[HAD_WAITED] = body.counts[WAITING]
            body.counts[WAITING] = 0
        goes_on = body.counts[STAGE] == SHEDS and left.full[0] == 0 and body.counts[LISTED] > 0
        left.sheds[0] = wp.where(goes_on, 1, 0)


@wp.kernel
def sum_up(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: Body):
    """What is pending around the cells listed; after the first round only where a piece was due."""
    anew = wp.where(body.counts[ROUND] == 0, 1, 0)
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[LISTED], slots * wp.block_dim()):
        sum_around(body.listed[n], anew, footprint, body)


@wp.kernel
def find_peaks(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: Body):
    """The peaks among the cells listed."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[LISTED], slots * wp.block_dim()):
        find_peak(body.listed[n], footprint, body)


@wp.kernel
def begin_cut(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: Body, left: Left):
    """The peaks of a round are cut if the table has room for them, and another round follows."""
    if wp.tid() == 0:
        peaks = body.counts[PEAKS]
        body.counts[PEAKS] = 0
        if left.count[0] + peaks > left.pieces.shape[0]:
            left.full[0] = 1
            peaks = 0
        if peaks > 0:
            left.count[0] = left.count[0] + peaks
            body.counts[PIECES] = body.counts[PIECES] + peaks
            body.counts[ROUND] = body.counts[ROUND] + 1
        body.counts[CUT] = peaks
        left.sheds[0] = wp.where(peaks > 0 and body.counts[ROUND] < footprint.rounds, 1, 0)


@wp.kernel
def cut(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    footprint: Footprint,
    body: Body,
    left: Left,
):
    """A piece leaves at each peak."""
    peaks = body.counts[CUT]
    for n in range(first_slot * wp.block_dim() + wp.tid(), peaks, slots * wp.block_dim()):
        place = left.count[0] - peaks + n
        left.pieces[place, 0] = wp.float64(slides[0].number)
        cut_at(body.peaks[n], place, footprint, body, left)


@wp.kernel
def end_rounds(first_slot: wp.int32, slots: wp.int32, body: Body, left: Left):
    """Tell whether a body is done with its rounds."""
    if wp.tid() == 0:
        left.closes[0] = wp.where(body.counts[STAGE] == SHEDS and left.full[0] == 0, 1, 0)


@wp.kernel
def close(first_slot: wp.int32, slots: wp.int32, footprint: Footprint, body: Body):
    """Cells where pieces are still due after all rounds wait for the next step; the sums are forgotten."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[LISTED], slots * wp.block_dim()):
        cell = body.listed[n]
        if body.counts[ROUND] == footprint.rounds:
            sum_around(cell, 0, footprint, body)
            if body.sums[cell] >= footprint.needed:
                body.waiting[wp.atomic_add(body.counts, WAITING, 1)] = cell
        body.sums[cell] = ZERO


@wp.func_native("total_body(slot, slots, first, count, wear_in, pending_in, table_out);")
def _total_rows(
    slot: wp.int32,
    slots: wp.int32,
    first: wp.int32,
    count: wp.int32,
    wear_in: wp.array2d(dtype=Cells),
    pending_in: wp.array2d(dtype=Cells),
    table_out: wp.array2d(dtype=wp.float64),
): ...


@wp.kernel
def total_rows(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    footprint: Footprint,
    body: Body,
    wear_in: wp.array2d(dtype=Cells),
    pending_in: wp.array2d(dtype=Cells),
):
    """Sum up the rows that a step may have changed: under the contact, or all where pieces had waited."""
    slot = first_slot + wp.tid() // wp.block_dim()
    every = wear_in.shape[0]
    first = slides[0].shift * body.number - footprint.margin
    count = slides[0].rows + 2 * footprint.margin
    if body.counts[HAD_WAITED] > 0:
        first = wp.int32(0)
        count = every
    elif body.periodic == 0:
        count = wp.min(first + count, every) - wp.max(first, 0)
        first = wp.max(first, 0)
    first = (first + every) % every
    _total_rows(slot, slots, first, wp.min(count, every), wear_in, pending_in, body.of_rows)


@wp.func_native("return sum_of_line(table, line, 0, table.shape[1]);")
def _sum_of(table: wp.array2d(dtype=wp.float64), line: wp.int32) -> wp.float64: ...


@wp.func_native("return most_of_line(table, line, 0, table.shape[1]);")
def _most_of(table: wp.array2d(dtype=wp.float64), line: wp.int32) -> wp.float64: ...


@wp.kernel
def note(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    body: Body,
    first_column: wp.int32,
    rows_out: wp.array2d(dtype=wp.float64),
):
    """Enter what a body has lost in the row of the step: pieces, sums of wear and pending, deepest wear."""
    worn = _sum_of(body.of_rows, 0)
    pending = _sum_of(body.of_rows, 1)
    deepest = _most_of(body.of_rows, 2)
    if wp.tid() == 0:
        row = slides[0].number
        rows_out[row, first_column] = wp.float64(body.counts[PIECES])
        rows_out[row, first_column + 1] = worn
        rows_out[row, first_column + 2] = pending - body.start
        rows_out[row, first_column + 3] = deepest
        body.counts[LISTED] = 0
        body.counts[STAGE] = DONE


@wp.kernel
def end_step(
    first_slot: wp.int32,
    slots: wp.int32,
    sphere: Body,
    disc: Body,
    left: Left,
    goes_out: wp.array(dtype=wp.int32),
):
    """A step ends when both bodies are done with it; the program stops where the table is full."""
    if wp.tid() == 0:
        ends = wp.where(left.full[0] == 0, 1, 0)
        if ends == 1:
            sphere.counts[STAGE] = TAKES
            disc.counts[STAGE] = TAKES
        else:
            goes_out[0] = 0
        left.begins[0] = ends
        left.ends[0] = ends
