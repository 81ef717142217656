"""Wear in pieces: what is pending of each body, where a piece is due, and the cut that it leaves.

Fields are those of the bodies, seen as numbers. A cell is named by its index, row × width + column. Sums over
a footprint are depths [mm]: volumes over the area of a cell. Every sum is made in the order of the footprint,
without fused operations, and footprints of a round do not overlap: all devices find the same pieces.
"""

import warp as wp

from warpwear.kernels.cells import LANES, NONE, ONE, TILE_VECTORS, ZERO, Cells, sum_of
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.running_in.caps import of_cell
from warpwear.kernels.sliding import beneath

wp.set_module_options({"enable_backward": False, "fuse_fp": False})


@wp.struct
class Footprint:
    """What is the same for all pieces."""

    along: wp.array(dtype=wp.int32)  # offsets of its cells
    across: wp.array(dtype=wp.int32)
    bowl: wp.array(dtype=wp.float64)  # depth of the piece [mm]
    needed: wp.float64  # sum of the bowl: V* over the area of a cell [mm]
    reach: wp.int32  # cells beside a peak where the middle of its piece may lie
    apart: wp.int32  # cells beside a peak where no other is one


@wp.struct
class Body:
    """One of the bodies, and what is due of it."""

    height: wp.array2d(dtype=wp.float64)  # as worn [mm]
    wear: wp.array2d(dtype=wp.float64)  # [mm]
    pending: wp.array2d(dtype=wp.float64)  # [mm]
    sums: wp.array(dtype=wp.float64)  # pending in the footprint around a listed cell, 0 elsewhere [mm]
    listed: wp.array(dtype=wp.int32)  # cells whose footprint gained in this step
    peaks: wp.array(dtype=wp.int32)  # those where a piece is due in this round
    counts: wp.array(dtype=wp.int32)  # of the listed cells, of the peaks, and see `shed`
    down: wp.float64  # 1 where heights grow as a body is worn, as those of the sphere; −1 of the disc
    columns: wp.int32  # without padding
    periodic: wp.int32  # 1 where after the last row comes the first


@wp.struct
class Share:
    """What a pressure adds to the depths pending."""

    footprint: Footprint
    sphere: wp.float64  # K ΔL without the dust [mm³/N]
    disc: wp.float64
    shift: wp.int32  # the disc's row under the sphere's first
    parts: wp.array2d(dtype=Cells)  # of the cap, that cells bear; no rows where all bear it


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
        body.listed[wp.atomic_add(body.counts, 0, 1)] = cell


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
    share: Share,
    sphere: Body,
    disc: Body,
):
    """Make the wear by the pressure of one cell pending."""
    if pressure > ZERO:
        if share.sphere > ZERO:
            add_pending(row, column, share.sphere * pressure, share.footprint, sphere)
        if share.disc > ZERO:
            under = beneath(row, share.shift, disc.pending.shape[0])
            add_pending(under, column, share.disc * pressure, share.footprint, disc)


@wp.kernel
def take_field(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    share: Share,
    pressure_in: wp.array2d(dtype=Cells),
    sphere: Body,
    disc: Body,
):
    """Make the wear by a stored pressure pending."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(slot % slots_per_row, pressure_in.shape[1], slots_per_row):
        p = pressure_in[row, k]
        if wp.max(p) > ZERO:
            for j in range(LANES):
                share_out(row, k * LANES + j, p[j], share, sphere, disc)


@wp.kernel
def take_tiles(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    share: Share,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    sphere: Body,
    disc: Body,
):
    """Make the wear by the pressure of a solved approach pending, of the tiles listed."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            g = gap_in[row, k]
            s = stiffness_in[stiffness_row, k]
            part = Cells(ONE)
            if share.parts.shape[0] > 0:
                part = share.parts[row, k]
            for j in range(LANES):
                p = pressure_of(of_cell(law, part[j]), g[j], s[j])
                share_out(row, k * LANES + j, p, share, sphere, disc)


@wp.kernel
def take_cells(first: wp.int32, slots_per_row: wp.int32, cells_in: wp.array(dtype=wp.int32), body: Body):
    """List cells that have waited since the last step."""
    list_cell(cells_in[first + wp.tid()], body)


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
        body.peaks[wp.atomic_add(body.counts, 1, 1)] = cell


@wp.func
def cut_at(
    peak: wp.int32, number: wp.int32, footprint: Footprint, body: Body, pieces: wp.array2d(dtype=wp.float64)
):
    """A piece leaves at a peak: index of the peak, and of the middle, volume [mm], cells cut.

    Its middle is the cell near the peak with most pending, the last of
    those with as much. The crack surface lies where the cut has the volume of a piece, or what is pending.
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
    left = ONE - volume / held
    removed = ZERO + ZERO
    for n in range(footprint.bowl.shape[0]):
        r = row_at(row + footprint.along[n], body)
        c = column + footprint.across[n]
        if r >= 0 and c >= 0 and c < body.columns:
            body.pending[r, c] = body.pending[r, c] * left
            depth = body.down * body.height[r, c]
            deeper = level + footprint.bowl[n]
            if deeper > depth:
                body.height[r, c] = body.down * deeper
                body.wear[r, c] = body.wear[r, c] + (deeper - depth)
                removed += deeper - depth
    pieces[number, 0] = wp.float64(peak)
    pieces[number, 1] = wp.float64(middle)
    pieces[number, 2] = removed
    pieces[number, 3] = cells


@wp.kernel
def sum_up(first: wp.int32, slots_per_row: wp.int32, anew: wp.int32, footprint: Footprint, body: Body):
    """What is pending around the cells listed; only where a piece was due, unless anew."""
    sum_around(body.listed[first + wp.tid()], anew, footprint, body)


@wp.kernel
def find_peaks(first: wp.int32, slots_per_row: wp.int32, footprint: Footprint, body: Body):
    """The peaks among the cells listed."""
    find_peak(body.listed[first + wp.tid()], footprint, body)


@wp.kernel
def cut(
    first: wp.int32,
    slots_per_row: wp.int32,
    footprint: Footprint,
    body: Body,
    pieces_out: wp.array2d(dtype=wp.float64),
):
    """A piece leaves at each peak."""
    number = first + wp.tid()
    cut_at(body.peaks[number], number, footprint, body, pieces_out)


@wp.kernel
def shed(
    first: wp.int32,
    slots_per_row: wp.int32,
    rounds: wp.int32,
    anew: wp.int32,
    footprint: Footprint,
    body: Body,
    pieces_out: wp.array2d(dtype=wp.float64),
):
    """Rounds of `sum_up`, `find_peaks` and `cut` by one thread, while there are peaks, and room for as many.

    Counts then are those of the pieces and of the rounds in which any left, round by round by their peaks.
    """
    listed = body.counts[0]
    made = wp.int32(0)
    left = wp.int32(0)
    peaks = wp.int32(1)
    while made < rounds and peaks > 0 and left + body.peaks.shape[0] <= pieces_out.shape[0]:
        body.counts[1] = 0
        for n in range(listed):
            sum_around(body.listed[n], wp.where(made == 0, anew, 0), footprint, body)
        for n in range(listed):
            find_peak(body.listed[n], footprint, body)
        peaks = body.counts[1]
        for n in range(1, peaks):  # the order of the list is no matter
            peak = body.peaks[n]
            place = n + 0
            while place > 0 and body.peaks[wp.max(place - 1, 0)] > peak:
                body.peaks[place] = body.peaks[place - 1]
                place -= 1
            body.peaks[place] = peak
        for n in range(peaks):
            cut_at(body.peaks[n], left + n, footprint, body, pieces_out)
        left += peaks
        made += wp.where(peaks > 0, 1, 0)
    body.counts[1] = left
    body.counts[2] = made


@wp.kernel
def forget(first: wp.int32, slots_per_row: wp.int32, body: Body):
    """The sums of the cells listed become 0, and with them the list."""
    body.sums[body.listed[first + wp.tid()]] = ZERO


@wp.kernel
def total_rows(
    first: wp.int32,
    slots_per_row: wp.int32,
    first_row: wp.int32,
    wear_in: wp.array2d(dtype=Cells),
    pending_in: wp.array2d(dtype=Cells),
    table_out: wp.array2d(dtype=wp.float64),
):
    """Sums of wear and of what is pending, and the deepest wear, of rows from a first one on."""
    number = first + wp.tid()
    rows = wear_in.shape[0]
    row = (first_row + number + rows) % rows
    worn = Cells(ZERO)
    pending = Cells(ZERO)
    deepest = Cells(ZERO)
    for k in range(wear_in.shape[1]):
        worn += wear_in[row, k]
        pending += pending_in[row, k]
        deepest = wp.max(deepest, wear_in[row, k])
    table_out[0, row] = sum_of(worn)
    table_out[1, row] = sum_of(pending)
    table_out[2, row] = wp.max(deepest)
