"""Which cells of a contact are bare of film, and what that does to their caps.

A body's cell has lost its film where more than the film's thickness was worn off it since the film was last
whole. A cell of the contact is bare where that holds of every body that carries one. Fields are those of the
sphere, or of patches; the disc's rows lie under them displaced, as in `sliding`.
"""

import warp as wp

from warpwear.kernels.cells import LANES, ONE, TILE_VECTORS, ZERO, Cells, sum_of
from warpwear.kernels.contact import Law, pressure_of
from warpwear.kernels.sliding import beneath

wp.set_module_options({"enable_backward": False})


@wp.struct
class Coat:
    """The film of one body, field by field; fields of no rows where it never forms anew."""

    wear: wp.array2d(dtype=Cells)  # of the body, from its unworn surface [mm]
    whole: wp.array2d(dtype=Cells)  # that wear, when the film was last whole [mm]
    seen: wp.array2d(dtype=Cells)  # that wear, at the end of the last step that could change it [mm]
    rubbed: wp.array2d(dtype=Cells)  # sliding distance at which it last changed [mm]


@wp.kernel
def look(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    thickness: wp.float64,
    first: wp.int32,
    end: wp.int32,
    is_first_body: wp.bool,
    coat: Coat,
    bare_out: wp.array2d(dtype=Cells),
):
    """1 where the body under a cell has lost its film and so has the body looked at before, else 0.

    first, end: vectors of a row that are looked at; the others were never touched.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, coat.wear.shape[0])
    heals = coat.whole.shape[0] > 0
    for k in range(first + slot % slots_per_row, end, slots_per_row):
        w = coat.wear[under, k]
        if heals:
            w = w - coat.whole[under, k]
        b = bare_out[row, k]
        for j in range(LANES):
            before = wp.where(is_first_body, ONE, b[j])
            b[j] = wp.where(w[j] > thickness, before, ZERO)
        bare_out[row, k] = b


@wp.kernel
def heal(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    distance: wp.float64,
    regrowth: wp.float64,
    first: wp.int32,
    end: wp.int32,
    coat: Coat,
):
    """The film is whole again where the body was not worn over the last `regrowth` of the distance [mm]."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, coat.wear.shape[0])
    for k in range(first + slot % slots_per_row, end, slots_per_row):
        w = coat.wear[under, k]
        x = coat.whole[under, k]
        rubbed = coat.rubbed[under, k]
        for j in range(LANES):
            x[j] = wp.where(distance - rubbed[j] >= regrowth, w[j], x[j])
        coat.whole[under, k] = x


@wp.kernel
def rub(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    shift: wp.int32,
    distance: wp.float64,
    first: wp.int32,
    end: wp.int32,
    coat: Coat,
):
    """Note the distance [mm] at the end of a step where the body was worn in it."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    under = beneath(row, shift, coat.wear.shape[0])
    for k in range(first + slot % slots_per_row, end, slots_per_row):
        w = coat.wear[under, k]
        s = coat.seen[under, k]
        rubbed = coat.rubbed[under, k]
        for j in range(LANES):
            rubbed[j] = wp.where(w[j] > s[j], distance, rubbed[j])
        coat.seen[under, k] = w
        coat.rubbed[under, k] = rubbed


@wp.kernel
def parts(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    filmed: wp.float64,
    bare: wp.float64,
    first: wp.int32,
    end: wp.int32,
    bare_in: wp.array2d(dtype=Cells),
    parts_out: wp.array2d(dtype=Cells),
):
    """Cap of every cell over the hardness, by its film."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(first + slot % slots_per_row, end, slots_per_row):
        b = bare_in[row, k]
        part = Cells(ZERO)
        for j in range(LANES):
            part[j] = wp.where(b[j] > ZERO, bare, filmed)
        parts_out[row, k] = part


@wp.kernel
def difference(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    now_in: wp.array2d(dtype=Cells),
    before_in: wp.array2d(dtype=Cells),
    worn_out: wp.array2d(dtype=Cells),
):
    """How far a gap has opened."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for k in range(slot % slots_per_row, now_in.shape[1], slots_per_row):
        worn_out[row, k] = now_in[row, k] - before_in[row, k]


@wp.kernel
def bare_under_pressure(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    pressure_in: wp.array2d(dtype=Cells),
    bare_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Bare cells among those with a pressure."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    total = Cells(ZERO)
    for k in range(slot % slots_per_row, pressure_in.shape[1], slots_per_row):
        p = pressure_in[row, k]
        b = bare_in[row, k]
        for j in range(LANES):
            b[j] = wp.where(p[j] > ZERO, b[j], ZERO)
        total += b
    sums_out[0, slot] = sum_of(total)


@wp.kernel
def bare_in_contact(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    bare_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Bare cells among those that a solved approach presses, in the tiles visited."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    total = Cells(ZERO)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            g = gap_in[row, k]
            b = bare_in[row, k]
            for j in range(LANES):
                b[j] = wp.where(pressure_of(law, g[j], s[j]) > ZERO, b[j], ZERO)
            total += b
    sums_out[0, slot] = sum_of(total)
