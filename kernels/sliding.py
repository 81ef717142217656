"""A disc displaced under the sphere by whole cells: which tiles can touch, their gap, and the wear of both.

Heights of the sphere and of the disc are kept apart, as worn. Below the sphere's row i lies the disc's row
i + shift, modulo the disc's length: the same vectors of another row, so nothing is copied. Of every tile of
the sphere the lowest height is kept and of every tile of the disc the highest, eight tiles in one vector like
the cells of a field; their difference bounds the gap of a pair of tiles from below.
"""

import warp as wp

from warpwear.kernels.cells import (
    ABSENT,
    LANES,
    NO_INDEX,
    NONE,
    ONE,
    TILE_VECTORS,
    ZERO,
    Cells,
    TrackMost,
    TrackSum,
    lowest_of,
    sum_of,
)
from warpwear.kernels.contact import Law, pressure_of

wp.set_module_options({"enable_backward": False})


@wp.struct
class Slide:
    """One step of a displaced pair of bodies."""

    shift: wp.int32  # the disc's row under the sphere's first
    wear_per_pressure_sphere: wp.float64  # K ΔL [mm³/N]
    wear_per_pressure_disc: wp.float64
    factored: wp.int32  # 1 where the sliding distance of the disc's cells has a factor each
    reference: wp.float64  # squares are those of the deviation from it [MPa]
    full_depth: wp.float64  # overlap c H of a cell at the hardness [mm]; NONE: the disc springs back
    first_column: wp.int32  # between these cells are known to be touched
    last_column: wp.int32


@wp.struct
class OfCells:
    """What cells may have one each of, or one row for all."""

    stiffness: wp.array2d(dtype=Cells)  # 1/c [N/mm³]
    factor: wp.array2d(dtype=Cells)  # of the sliding distance of the disc's cells


@wp.struct
class Bodies:
    """Fields of both bodies [mm], and the gap of the tiles listed."""

    sphere: wp.array2d(dtype=Cells)  # height, as worn
    disc: wp.array2d(dtype=Cells)
    wear_sphere: wp.array2d(dtype=Cells)
    wear_disc: wp.array2d(dtype=Cells)
    plastic_disc: wp.array2d(dtype=Cells)  # displaced for good; not looked at of a disc that springs back
    reached: wp.array2d(dtype=Cells)  # 1 where a sphere that does not wear was in contact; else one row
    gap: wp.array2d(dtype=Cells)


@wp.struct
class OfTiles:
    """Bounds and sums that are kept of every tile of either body, rows × tiles."""

    lowest: wp.array2d(dtype=wp.float64)  # height of the sphere [mm]
    highest: wp.array2d(dtype=wp.float64)  # of the disc [mm]
    touched: wp.array2d(dtype=wp.float64)  # cells of the sphere
    worn_sphere: wp.array2d(dtype=wp.float64)  # sums [mm]
    worn_disc: wp.array2d(dtype=wp.float64)
    pressed_disc: wp.array2d(dtype=wp.float64)  # displaced for good; one row where the disc springs back


@wp.struct
class OfEightTiles:
    """The sums of `OfTiles`, eight neighbouring tiles in a vector."""

    touched: wp.array2d(dtype=Cells)
    worn_sphere: wp.array2d(dtype=Cells)
    worn_disc: wp.array2d(dtype=Cells)
    pressed_disc: wp.array2d(dtype=Cells)


@wp.struct
class OfRows:
    """The sums of `OfTiles` over every row of the sphere and of the disc."""

    touched: wp.array(dtype=wp.float64)
    worn_sphere: wp.array(dtype=wp.float64)
    worn_disc: wp.array(dtype=wp.float64)
    pressed_disc: wp.array(dtype=wp.float64)


@wp.struct
class Bounds:
    """What gaps of pairs of tiles are bounded by [mm]. It may be out of date: wear only opens gaps."""

    lowest_of_eight: wp.array2d(dtype=wp.float64)  # of neighbouring tiles of the sphere
    highest_of_row: wp.array(dtype=wp.float64)  # of the disc
    lowest: wp.array2d(dtype=Cells)  # of the sphere's tiles, eight in a vector
    highest: wp.array2d(dtype=Cells)  # of the disc's


@wp.struct
class StepTables:
    """Tables of partial results of a step, one column a slot."""

    sums: wp.array2d(dtype=wp.float64)  # rows of `TrackSum`
    maxima: wp.array2d(dtype=wp.float64)  # rows of `TrackMost`


@wp.func
def beneath(row: wp.int32, shift: wp.int32, rows: wp.int32):
    """The disc's row under a row of the sphere; 0 ≤ shift < rows."""
    displaced = row + shift
    return wp.where(displaced < rows, displaced, displaced - rows)


@wp.kernel
def bounds(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    height_in: wp.array2d(dtype=Cells),
    lowest_out: wp.array2d(dtype=wp.float64),
    highest_out: wp.array2d(dtype=wp.float64),
):
    """Lowest and highest height of every tile of a body; nothing for places beyond the last tile."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    for t in range(slot % slots_per_row, lowest_out.shape[1], slots_per_row):
        low = Cells(ABSENT)
        high = Cells(-ABSENT)
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, height_in.shape[1])):
            low = wp.min(low, height_in[row, k])
            high = wp.max(high, height_in[row, k])
        lowest_out[row, t] = lowest_of(low)
        highest_out[row, t] = wp.max(high)


@wp.kernel
def select(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    limit: wp.float64,
    shift: wp.int32,
    bounds: Bounds,
    sphere_in: wp.array2d(dtype=Cells),
    disc_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    list_out: wp.array2d(dtype=wp.int32),
    count_out: wp.array(dtype=wp.int32),
):
    """Lists, row by row, the tiles with a gap that does not exceed the limit, and writes their gaps.

    Where the bounds of a pair of tiles let it touch, its gap is made and decides: a list holds no tile too
    many. Gaps of tiles that are not listed are left as they are. The lowest of eight tiles of the sphere with
    the highest of the disc's row spares most bounds.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0:  # a list is written in order, by one slot
        return
    under = beneath(row, shift, disc_in.shape[0])
    highest = bounds.highest_of_row[under]
    count = wp.int32(0)
    for m in range(bounds.lowest.shape[1]):
        if bounds.lowest_of_eight[row, m] - highest <= limit:
            bound = bounds.lowest[row, m] - bounds.highest[under, m]
            if lowest_of(bound) <= limit:
                for j in range(LANES):
                    t = m * LANES + j
                    if bound[j] <= limit and t * TILE_VECTORS < gap_out.shape[1]:
                        low = Cells(ABSENT)
                        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_out.shape[1])):
                            g = sphere_in[row, k] - disc_in[under, k]
                            gap_out[row, k] = g
                            low = wp.min(low, g)
                        if lowest_of(low) <= limit:
                            list_out[row, count] = t
                            count += 1
    count_out[row] = count


@wp.kernel
def wear_step(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    step: Slide,
    of_cells: OfCells,
    bodies: Bodies,
    of_tiles: OfTiles,
    tables: StepTables,
):
    """One increment of wear in place: each body loses K p ΔL.

    What goes beyond the full depth is displaced from the disc for good, not worn. Of the tiles listed, the
    bounds and what `totals` sums are made anew from their cells, and their gap gives way to their pressure.
    Columns count that lie beyond the known ones.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    lane = slot % slots_per_row
    stiffness_row = wp.min(row, of_cells.stiffness.shape[0] - 1)
    under = beneath(row, step.shift, bodies.disc.shape[0])
    factor_row = wp.min(under, of_cells.factor.shape[0] - 1)
    vectors = bodies.gap.shape[1]
    keeps_reached = bodies.reached.shape[0] == bodies.gap.shape[0]

    if lane >= count_in[row]:  # nothing to do: most rows
        for i in range(wp.static(len(TrackSum))):
            tables.sums[i, slot] = ZERO
        for i in range(wp.static(len(TrackMost))):
            tables.maxima[i, slot] = ZERO
        tables.maxima[TrackMost.FIRST_COLUMN, slot] = NO_INDEX
        tables.maxima[TrackMost.LAST_COLUMN, slot] = NO_INDEX
        return

    pressure = Cells(ZERO)
    factored = Cells(ZERO)
    deviation = Cells(ZERO)
    contact = Cells(ZERO)
    capped = Cells(ZERO)
    highest_pressure = Cells(ZERO)
    deepest_sphere = Cells(ZERO)
    deepest_disc = Cells(ZERO)
    first_column = NO_INDEX
    last_column = NO_INDEX

    for n in range(lane, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        first = t * TILE_VECTORS
        end = wp.min(first + TILE_VECTORS, vectors)
        if step.full_depth < NONE:
            pressed = Cells(ZERO)
            for k in range(first, end):
                g = bodies.gap[row, k]
                d = bodies.disc[under, k]
                x = bodies.plastic_disc[under, k]
                for j in range(LANES):
                    beyond = wp.max(((law.base - g[j]) + law.offset) - step.full_depth, ZERO)
                    d[j] = d[j] - beyond
                    x[j] = x[j] + beyond
                bodies.disc[under, k] = d
                bodies.plastic_disc[under, k] = x
                pressed += x
            of_tiles.pressed_disc[under, t] = sum_of(pressed)
        for k in range(first, end):
            stiffness = of_cells.stiffness[stiffness_row, k]
            g = bodies.gap[row, k]
            s = bodies.sphere[row, k]
            d = bodies.disc[under, k]
            a = bodies.wear_sphere[row, k]
            b = bodies.wear_disc[under, k]
            p = Cells(ZERO)
            f = Cells(ONE)
            if step.factored == 1:
                f = of_cells.factor[factor_row, k]
            for j in range(LANES):
                q = pressure_of(law, g[j], stiffness[j])
                da = step.wear_per_pressure_sphere * q
                db = step.wear_per_pressure_disc * f[j] * q
                p[j] = q
                s[j] = s[j] + da
                a[j] = a[j] + da
                d[j] = d[j] - db
                b[j] = b[j] + db
            bodies.gap[row, k] = p
            bodies.sphere[row, k] = s
            bodies.disc[under, k] = d
            bodies.wear_sphere[row, k] = a
            bodies.wear_disc[under, k] = b
            if step.factored == 1:
                factored += wp.cw_mul(p, f)
        low = Cells(ABSENT)
        high = Cells(-ABSENT)
        worn_sphere = Cells(ZERO)
        worn_disc = Cells(ZERO)
        for k in range(first, end):
            low = wp.min(low, bodies.sphere[row, k])
            high = wp.max(high, bodies.disc[under, k])
            a = bodies.wear_sphere[row, k]
            b = bodies.wear_disc[under, k]
            worn_sphere += a
            worn_disc += b
            deepest_sphere = wp.max(deepest_sphere, a)
            deepest_disc = wp.max(deepest_disc, b)
        of_tiles.lowest[row, t] = lowest_of(low)
        of_tiles.highest[under, t] = wp.max(high)
        of_tiles.worn_sphere[row, t] = sum_of(worn_sphere)
        of_tiles.worn_disc[under, t] = sum_of(worn_disc)
        touched = Cells(ZERO)
        for k in range(first, end):
            p = bodies.gap[row, k]
            a = bodies.wear_sphere[row, k]
            if keeps_reached:
                a = bodies.reached[row, k]
            from_reference = Cells(ZERO)
            is_contact = Cells(ZERO)
            is_capped = Cells(ZERO)
            is_touched = Cells(ZERO)
            for j in range(LANES):
                from_reference[j] = wp.where(p[j] > ZERO, p[j] - step.reference, ZERO)
                is_contact[j] = wp.where(p[j] > ZERO, ONE, ZERO)
                is_capped[j] = wp.where(p[j] >= law.cap, ONE, ZERO)
                is_touched[j] = wp.where(p[j] + a[j] > ZERO, ONE, ZERO)
            highest_pressure = wp.max(highest_pressure, p)
            pressure += p
            deviation += wp.cw_mul(from_reference, from_reference)
            contact += is_contact
            capped += is_capped
            touched += is_touched
            if keeps_reached:
                bodies.reached[row, k] = is_touched
        of_tiles.touched[row, t] = sum_of(touched)
        # Extents are known up to tiles that lie beyond them: all but a few of the first steps'.
        if first * LANES < step.first_column or end * LANES - 1 > step.last_column:
            for k in range(first, end):
                p = bodies.gap[row, k]
                a = bodies.wear_sphere[row, k]
                for j in range(LANES):
                    if p[j] + a[j] > ZERO:
                        column = wp.float64(k * LANES + j)
                        first_column = wp.max(first_column, -column)
                        last_column = wp.max(last_column, column)
    tables.sums[TrackSum.PRESSURE, slot] = sum_of(pressure)
    tables.sums[TrackSum.DEVIATION_SQUARED, slot] = sum_of(deviation)
    tables.sums[TrackSum.CONTACT, slot] = sum_of(contact)
    tables.sums[TrackSum.CAPPED, slot] = sum_of(capped)
    weighted = wp.where(step.factored == 1, sum_of(factored), sum_of(pressure))
    tables.sums[TrackSum.PRESSURE_TIMES_FACTOR, slot] = weighted
    tables.maxima[TrackMost.PRESSURE, slot] = wp.max(highest_pressure)
    tables.maxima[TrackMost.WEAR_SPHERE, slot] = wp.max(deepest_sphere)
    tables.maxima[TrackMost.WEAR_DISC, slot] = wp.max(deepest_disc)
    tables.maxima[TrackMost.FIRST_COLUMN, slot] = first_column
    tables.maxima[TrackMost.LAST_COLUMN, slot] = last_column


@wp.kernel
def totals(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    shift: wp.int32,
    of_tiles: OfEightTiles,
    of_rows: OfRows,
):
    """Sums over the rows with listed tiles, of the sphere and of the disc beneath it.

    Sums over the fields as they are: increments added up would drift.
    """
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    if slot % slots_per_row > 0 or count_in[row] == 0:
        return
    under = beneath(row, shift, of_tiles.worn_disc.shape[0])
    touched = Cells(ZERO)
    worn_sphere = Cells(ZERO)
    worn_disc = Cells(ZERO)
    if of_tiles.pressed_disc.shape[0] == of_tiles.worn_disc.shape[0]:
        pressed = Cells(ZERO)
        for m in range(of_tiles.touched.shape[1]):
            pressed += of_tiles.pressed_disc[under, m]
        of_rows.pressed_disc[under] = sum_of(pressed)
    for m in range(of_tiles.touched.shape[1]):
        touched += of_tiles.touched[row, m]
        worn_sphere += of_tiles.worn_sphere[row, m]
        worn_disc += of_tiles.worn_disc[under, m]
    of_rows.touched[row] = sum_of(touched)
    of_rows.worn_sphere[row] = sum_of(worn_sphere)
    of_rows.worn_disc[under] = sum_of(worn_disc)
