"""Wear in pieces: what is pending of each body, where a piece is due, and the cut that it leaves.

Fields are those of the bodies, seen as numbers. A cell is named by its index, row × width + column. Sums over
a footprint are depths [mm]: volumes over the area of a cell. Every sum is made in the order of the footprint,
without fused operations, and footprints of a round do not overlap: all devices find the same pieces.

A step lists the cells whose footprints gained. Then each body sheds pieces, see `shedding`.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import FIELD, CellProperties
from warpwear.kernels.sliding import SLIDES, SOLVED

native_pass = native_code.passes_of(__name__, "running_in/pieces.h", fuse_fp=False)

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
    waiting: wp.array(dtype=wp.int32)  # cells still due after all rounds of the last step
    peaks: wp.array(dtype=wp.int32)  # those where a piece is due in this round
    counts: wp.array(dtype=wp.int32)  # by `PieceCount`
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


#: What passes over pieces take of a body.
OF_BODY = {"footprint": Footprint, "body": SheddingBody}
#: Make the wear by a stored pressure pending.
take_field = native_pass("take_field", slides=SLIDES, both=Both, pressure=FIELD)
#: Make the wear by the pressure of a solved approach pending, of the tiles listed.
take_tiles = native_pass("take_tiles", **SOLVED, both=Both, cells=CellProperties, gap=FIELD)
#: List the cells that were still due after all rounds of the last step.
list_waiting = native_pass("list_waiting", body=SheddingBody)
