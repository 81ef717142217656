"""Wear in pieces: what is pending of each body, where a piece is due, and the cut that it leaves.

Fields are those of the bodies, seen as numbers. A cell is named by its index, row × width + column. Sums over
a footprint are depths [mm]: volumes over the area of a cell. Every sum is made in the order of the footprint,
without fused operations, and footprints of a round do not overlap: all devices find the same pieces.

A step lists the cells whose footprints gained. Then each body sheds pieces, see `shedding`.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.balance import Springs, pressures_at
from warpwear.kernels.cells import LANES, ONE, TILE_VECTORS, ZERO, CellProperties, Cells
from warpwear.kernels.sliding import Slide

native_pass = native_code.passes_of(__name__, "law.h", "bodies.h", fuse_fp=False)

#: Counts of a body: candidates, peaks of a round and those that are cut, rounds in which pieces left, cells
#: over for the next step and those that were for this one, how far the step is, its pieces, cells due.
CANDIDATES, PEAKS, CUT, ROUND = (wp.constant(wp.int32(n)) for n in range(4))
OVERFLOW, OVERFLOW_BEFORE, STAGE, PIECES, DUE = (wp.constant(wp.int32(n)) for n in range(4, 9))
COUNTS = 9
#: How far a body is with a step: it takes wear, sheds pieces, or is done.
TAKES, SHEDS, DONE = (wp.constant(wp.int32(n)) for n in range(3))


@wp.struct
class Footprint:
    """Holds what is the same for all pieces."""

    along: wp.array(dtype=wp.int32)  # offsets of its cells
    across: wp.array(dtype=wp.int32)
    bowl: wp.array(dtype=wp.float64)  # depth of the piece [mm]
    needed: wp.float64  # sum of the bowl: V* over the area of a cell [mm]
    reach: wp.int32  # cells beside a peak where the middle of its piece may lie
    apart: wp.int32  # cells beside a peak where no other is one
    margin: wp.int32  # cells beside one in contact that a piece may reach
    rounds: wp.int32  # of a step at most


@wp.struct
class SheddingBody:
    """Holds one of the bodies, and what is due of it."""

    height: wp.array2d(dtype=wp.float64)  # as worn [mm]
    wear: wp.array2d(dtype=wp.float64)  # [mm]
    pending: wp.array2d(dtype=wp.float64)  # [mm]
    sums: wp.array(dtype=wp.float64)  # pending in the footprint around a listed cell, 0 elsewhere [mm]
    candidates: wp.array(dtype=wp.int32)  # cells whose footprint gained in this step
    due: wp.array(dtype=wp.int32)  # those of them whose sums call for a piece before any has left
    overflow: wp.array(dtype=wp.int32)  # cells still due after all rounds of the last step
    peaks: wp.array(dtype=wp.int32)  # those where a piece is due in this round
    counts: wp.array(dtype=wp.int32)  # by `CANDIDATES` and so on
    of_rows: wp.array2d(dtype=wp.float64)  # sums of wear and pending, and the deepest wear, of each row [mm]
    start: wp.float64  # sum of what was pending at first [mm]
    down: wp.float64  # 1 where heights grow as a body is worn, as those of the counter-body; −1 of the disc
    number: wp.int32  # 0 the counter-body, 1 the disc
    columns: wp.int32  # without padding
    periodic: wp.int32  # 1 where after the last row comes the first


@wp.struct
class Both:
    """Holds both bodies of a contact."""

    footprint: Footprint
    counter: SheddingBody
    disc: SheddingBody


@wp.func
def row_at(row: wp.int32, body: SheddingBody):
    """Return a row of a body, also beyond its ends; −1 where there is none."""
    rows = body.pending.shape[0]
    if row >= 0 and row < rows:
        return row
    if body.periodic == 0:
        return -1
    return wp.where(row < 0, row + rows, row - rows)


@wp.func
def list_cell(cell: wp.int32, body: SheddingBody):
    """List a cell once. A sum of 0 says that it is not listed yet."""
    if wp.atomic_add(body.sums, cell, ONE) == ZERO:
        body.candidates[wp.atomic_add(body.counts, CANDIDATES, 1)] = cell


@wp.func
def add_pending(row: wp.int32, column: wp.int32, depth: wp.float64, footprint: Footprint, body: SheddingBody):
    """Make a depth pending, and list the cells whose footprints it lies in."""
    body.pending[row, column] = body.pending[row, column] + depth
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            list_cell(r * body.pending.shape[1] + c, body)


@wp.func
def beneath(row: wp.int32, shift: wp.int32, rows: wp.int32):
    """Return the disc's row under a row of the counter-body; 0 ≤ shift < rows."""
    displaced = row + shift
    return wp.where(displaced < rows, displaced, displaced - rows)


@wp.func
def share_out(row: wp.int32, column: wp.int32, pressure: wp.float64, slide: Slide, both: Both):
    """Make the wear by the pressure of one cell pending."""
    if pressure > ZERO:
        if slide.removal.pending_counter > ZERO:
            add_pending(row, column, slide.removal.pending_counter * pressure, both.footprint, both.counter)
        if slide.removal.pending_disc > ZERO:
            under = beneath(row, slide.shift, both.disc.pending.shape[0])
            add_pending(under, column, slide.removal.pending_disc * pressure, both.footprint, both.disc)


@wp.kernel
def take_field(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    both: Both,
    pressure_in: wp.array2d(dtype=Cells),
):
    """Make the wear by a stored pressure pending."""
    slot = first_slot + wp.tid() // wp.block_dim()
    slide = slides[0]
    for row in range(slot, pressure_in.shape[0], slots):
        for k in range(wp.tid() % wp.block_dim(), pressure_in.shape[1], wp.block_dim()):
            p = pressure_in[row, k]
            if wp.max(p) > ZERO:
                for j in range(LANES):
                    share_out(row, k * LANES + j, p[j], slide, both)


@wp.kernel
def take_tiles(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    both: Both,
    springs: Springs,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    cells: CellProperties,
    gap_in: wp.array2d(dtype=Cells),
):
    """Make the wear by the pressure of a solved approach pending, of the tiles listed."""
    slot = first_slot + wp.tid() // wp.block_dim()
    slide = slides[0]
    for row in range(slot, gap_in.shape[0], slots):
        for n in range(wp.tid() % wp.block_dim(), count_in[row], wp.block_dim()):
            t = tiles_in[row, n]
            for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
                p = pressures_at(row, k, springs, gap_in, cells.stiffness, cells.cap_ratio)
                for j in range(LANES):
                    share_out(row, k * LANES + j, p[j], slide, both)


@wp.kernel
def list_overflow(first_slot: wp.int32, slots: wp.int32, body: SheddingBody):
    """List the cells that were still due after all rounds of the last step."""
    for n in range(first_slot * wp.block_dim() + wp.tid(), body.counts[OVERFLOW], slots * wp.block_dim()):
        list_cell(body.overflow[n], body)
