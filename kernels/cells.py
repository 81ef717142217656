"""All kernels get fields of one type.

A field of nx × ny cells is stored as `wp.array2d(dtype=Cells)` of shape (nx, ceil(ny / 8)): eight
neighbouring cells along axis 1 in one vector, because a compiler turns loops over a vector's lanes into SIMD
code and loops over scalars of a strided array not. Lanes beyond ny hold `PADDING` in the gap, so they never
touch.
"""

from enum import IntEnum
from typing import Any

import warp as wp

from warpwear.grid import VECTOR_CELLS

LANES = VECTOR_CELLS
Cells = wp.types.vector(LANES, wp.float64)
#: What passes take: a field, a table of partial results, and which tiles of a row are listed, and how many.
FIELD, TABLE = wp.array2d(dtype=Cells), wp.array2d(dtype=wp.float64)
LISTED = {"tiles": wp.array2d(dtype=wp.int32), "count": wp.array(dtype=wp.int32)}

#: Gap of a place where there is no surface (padding, beyond the counter-body's edge) [mm].
PADDING = 1.0e30
ABSENT = wp.constant(wp.float64(PADDING))
#: Stands for "no cell" in partial maxima, and for a step without limit.
NONE = wp.constant(wp.float64(1.0e300))
#: Stands for "no cell" among first and last indices.
NO_INDEX = wp.constant(wp.float64(-1.0e9))
#: Vectors of a tile, see `tiles`.
TILE_VECTORS = wp.constant(wp.int32(4))
ZERO = wp.constant(wp.float64(0.0))
ONE = wp.constant(wp.float64(1.0))

#: What is kept of every tile: cells ever touched, sum of the wear of both bodies [mm].
TileSums = wp.types.vector(2, wp.float64)


class WearSum(IntEnum):
    """Names the sums that one gap is worn with: rows of a table of partial results, one column a slot."""

    PRESSURE = 0
    DEVIATION_SQUARED = 1
    CONTACT = 2
    CAPPED = 3
    TOUCHED = 4  # this and the next: of the whole field, not of the step
    WORN = 5  # by both bodies [mm]
    WEARING = 6  # pressure times K over that of the step, where it differs [MPa]


class WearMost(IntEnum):
    """Names the maxima over the tiles visited. Lowest indices are stored negated."""

    PRESSURE = 0
    WORN = 1
    FIRST_ROW = 2
    LAST_ROW = 3
    FIRST_COLUMN = 4
    LAST_COLUMN = 5


class TrackSum(IntEnum):
    """Names the sums of a step that wears two bodies; other sums are kept a tile and a row."""

    PRESSURE = 0
    DEVIATION_SQUARED = 1
    CONTACT = 2
    CAPPED = 3
    PRESSURE_TIMES_FACTOR = 4
    BARE = 5
    RUBBED = 6  # cells, each by the part of the step that it was in contact
    WEARING_COUNTER = 7  # pressure times K of the counter-body over that of the step, where it differs [MPa]


class TrackMost(IntEnum):
    """Names the maxima of a step that wears two bodies."""

    PRESSURE = 0
    WEAR_COUNTER = 1
    WEAR_DISC = 2
    FIRST_COLUMN = 3
    LAST_COLUMN = 4


class PressureSum(IntEnum):
    """Names the sums of a step that wears two bodies by a stored pressure."""

    PRESSURE = 0
    DEVIATION_SQUARED = 1
    CONTACT = 2
    CAPPED = 3
    TOUCHED = 4  # this and the next: of the whole fields, not of the step
    WEAR_COUNTER = 5  # [mm]
    SLIP_WORK = 6  # Σ p s, of cells that slip by lengths of their own [MPa mm]
    STUCK = 7  # cells in contact that do not
    RUBBED = 8  # cells, each by the part of the step that it was in contact
    BARE = 9


class PressureMost(IntEnum):
    """Names the maxima of a step that wears two bodies by a stored pressure."""

    PRESSURE = 0
    WEAR_COUNTER = 1
    WEAR_DISC = 2
    FIRST_ROW = 3
    LAST_ROW = 4
    FIRST_COLUMN = 5
    LAST_COLUMN = 6


class PieceCount(IntEnum):
    """Names the counts of a body that wears in pieces."""

    CANDIDATES = 0
    PEAKS = 1  # of a round
    CUT = 2  # those that are
    ROUND = 3  # rounds in which pieces left
    WAITING = 4  # cells that are still due for the next step
    WAITED = 5  # those that were for this one
    STAGE = 6  # how far the step is
    PIECES = 7  # of the step
    DUE = 8  # cells


#: Sums that a feature of a contact enters in its books, where there is one.
OF_FEATURES = {"bare", "slip_work", "stuck"}
#: Tables whose lines C++ knows by name, see `native_code`: they are numbered from 0 on.
TABLES = (WearSum, WearMost, TrackSum, TrackMost, PressureSum, PressureMost, PieceCount)


def names_of(rows: type[IntEnum]) -> tuple[str, ...]:
    """Return the names of the rows of a table."""
    return tuple(row.name.lower() for row in rows)


PATCH_SUMS, PATCH_MAXIMA = names_of(WearSum), names_of(WearMost)
#: Maxima of two bodies, by name.
MAXIMA = names_of(PressureMost)
#: Extents of what was touched, among them.
EXTENTS = ("first_row", "last_row", "first_column", "last_column")

wp.set_module_options({"enable_backward": False})


@wp.struct
class Layout:
    """Tells where rows of a field lie: lines of a domain, or patches, their lines one after another."""

    vectors: wp.int32  # of a line
    first_row: wp.array(dtype=wp.int32)  # of the domain's cells, where a row of the field begins
    first_column: wp.array(dtype=wp.int32)


@wp.struct
class CellProperties:
    """What cells of a contact may have one each of, or one row for all; no rows where they are alike.

    Rows are those of the counter-body. Ratios are those to what a step has for all: see `Slide`.
    """

    stiffness: wp.array2d(dtype=Cells)  # 1/c [N/mm³]
    yields: wp.array2d(dtype=Cells)  # what wear lends beside a compliance of all, on the half-space [mm³/N]
    cap_ratio: wp.array2d(dtype=Cells)  # cap over the hardness
    shear_ratio: wp.array2d(dtype=Cells)  # shear strength over that by which shear wears
    k_counter: wp.array2d(dtype=Cells)  # K of the counter-body over that of its uppermost material
    k_disc: wp.array2d(dtype=Cells)  # of the disc, and factor of the sliding distance of its cells
    material: wp.array2d(dtype=Cells)  # index of what meets: of a film 0, of the bare bodies 1
    materials_counter: wp.array2d(dtype=wp.float64)  # by worn depth, see native/layers.h; none of one alike
    materials_disc: wp.array2d(dtype=wp.float64)


@wp.struct
class Coat:
    """Holds one body's film by fields; these have no rows where there is none, or it never forms anew."""

    wear: wp.array2d(dtype=Cells)  # of the body, from its unworn surface [mm]
    whole: wp.array2d(dtype=Cells)  # that wear, when the film was last whole [mm]
    seen: wp.array2d(dtype=Cells)  # that wear, at the end of the last step that could change it [mm]
    rubbed: wp.array2d(dtype=Cells)  # sliding distance at which it last changed [mm]


@wp.struct
class Films:
    """Holds the films of both bodies, and what they make of the cells of the contact.

    A body's cell has lost its film where more than its thickness was worn off since it was last whole. A cell
    of the contact is bare where that holds of every body that carries one.
    """

    counter: Coat
    disc: Coat
    thickness: wp.float64  # [mm]
    regrowth: wp.float64  # sliding distance without wear after which a film is whole again [mm]
    cap_filmed: wp.float64  # over the hardness
    cap_bare: wp.float64
    shear_filmed: wp.float64  # shear strength over that of a bare cell


@wp.struct
class Curve:
    """Describes a logistic bearing area curve φ(z)."""

    middle: wp.float64  # m [mm]
    scale: wp.float64  # s [mm]; 0: it bears everywhere


@wp.struct
class Sources:
    """What the properties of cells follow from as a step begins, beside their Ks."""

    films: Films
    curve: Curve
    wear_counter: wp.array2d(dtype=Cells)  # where there are layers [mm]
    wear_disc: wp.array2d(dtype=Cells)  # where there are layers or a curve [mm]
    layered: wp.int32  # 1 where bodies have materials by worn depth
    largest_shear: wp.float64  # of cells over their pressure and the bodies' strength [1/MPa]
    disc_rows: wp.int32  # rows of a disc that may be displaced; 0 of none
    stiffens: wp.int32  # 1 where the stiffness of every cell is made with the others


#: What cells of a contact have, for passes: what it follows from, and what it is.
OF_CELLS = {"sources": Sources, "cells": CellProperties}


def fields(*names: str) -> dict[str, Any]:
    """Return the types of fields that a pass takes, by their names."""
    return dict.fromkeys(names, FIELD)
