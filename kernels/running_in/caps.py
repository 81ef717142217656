"""What a trial approach carries where the cap of a cell is its own: see `contact`, where all have one.

parts_in: the cap of every cell over that of the law, which is the hardness, or what a bearing area makes of
it so that the load is met.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, TILE_VECTORS, ZERO, Cells, sum_of
from warpwear.kernels.contact import Law, pressure_of

wp.set_module_options({"enable_backward": False})


@wp.func
def of_cell(law: Law, part: wp.float64):
    """The law of a cell with a cap of its own; cells tied with the approach carry a part of it."""
    own = law
    own.cap = law.cap * part
    own.tie_pressure = law.tie_pressure * part
    return own


@wp.kernel
def carried(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    parts_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sums of the pressures and slopes, and how far they follow straight lines, as of `contact.carried`."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    pressure = Cells(ZERO)
    slope = Cells(ZERO)
    nearest = Cells(ABSENT)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            g = gap_in[row, k]
            part = parts_in[row, k]
            p = Cells(ZERO)
            between = Cells(ZERO)
            near = Cells(ZERO)
            for j in range(LANES):
                cap = law.cap * part[j]
                q = ((law.base - g[j]) + law.offset) * s[j]
                p[j] = wp.min(wp.max(q, ZERO), cap)
                between[j] = wp.where(q > ZERO and q < cap, s[j], ZERO)
                near[j] = wp.min(wp.abs(q), wp.abs(q - cap))
            pressure += p
            slope += between
            nearest = wp.min(nearest, near)
    sums_out[0, slot] = sum_of(pressure)
    sums_out[1, slot] = sum_of(slope)
    sums_out[2, slot] = wp.min(nearest)


@wp.kernel
def below(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    approach: wp.float64,
    gap_in: wp.array2d(dtype=Cells),
    parts_in: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
):
    """Sum over the cells in contact of their caps, in cells at the hardness: as of `contact.count_below`."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    total = Cells(ZERO)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            g = gap_in[row, k]
            part = parts_in[row, k]
            for j in range(LANES):
                part[j] = wp.where(g[j] < approach, part[j], ZERO)
            total += part
    sums_out[0, slot] = sum_of(total)


@wp.kernel
def pressures(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    stiffness_in: wp.array2d(dtype=Cells),
    gap_in: wp.array2d(dtype=Cells),
    parts_in: wp.array2d(dtype=Cells),
    pressure_out: wp.array2d(dtype=Cells),
):
    """The pressure field of a solved approach, in the tiles visited."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    stiffness_row = wp.min(row, stiffness_in.shape[0] - 1)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            s = stiffness_in[stiffness_row, k]
            g = gap_in[row, k]
            part = parts_in[row, k]
            p = Cells(ZERO)
            for j in range(LANES):
                p[j] = pressure_of(of_cell(law, part[j]), g[j], s[j])
            pressure_out[row, k] = p
