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
    TILE_VECTORS,
    ZERO,
    Cells,
    TrackMost,
    TrackSum,
    lowest_of,
    sum_of,
)
from warpwear.kernels.contact import Law
from warpwear.kernels.slide import beneath
from warpwear.kernels.wear_loops import LANES_IN_C

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
    parts: wp.array2d(dtype=Cells)  # of the cap, that cells bear; no rows where all bear it


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


#: Every cell of the tiles that a row lists. Each sum grows lane by lane, in the order of the cells.
_WEAR_TILES = f"""
{{
#if !defined(__CUDA_ARCH__)
    #pragma clang fp contract(off)
#endif
    const Lanes one = 1.0;
    const int row = slot / slots_per_row, lane = slot % slots_per_row, listed = wp::index(count_in, row);
    const int sums = tables.sums.shape[0], maxima = tables.maxima.shape[0];
    if (lane >= listed) {{  // nothing to do: most rows
        for (int n = 0; n < sums; ++n) wp::index(tables.sums, n, slot) = 0.0;
        for (int n = 0; n < maxima; ++n)
            wp::index(tables.maxima, n, slot) = n < {TrackMost.FIRST_COLUMN.value} ? 0.0 : -1.0e9;
        return;
    }}
    const int rows = bodies.disc.shape[0], displaced = row + step.shift;
    const int under = displaced < rows ? displaced : displaced - rows;
    // Rows lie in one piece each.
    const auto line = [&](const auto& field, int number) {{
        return (Stored*)&wp::index(field, wp::min(number, field.shape[0] - 1), 0);
    }};
    Stored *const gap = line(bodies.gap, row), *const sphere = line(bodies.sphere, row);
    Stored *const disc = line(bodies.disc, under), *const plastic = line(bodies.plastic_disc, under);
    Stored *const wear_sphere = line(bodies.wear_sphere, row), *const reached = line(bodies.reached, row);
    Stored* const wear_disc = line(bodies.wear_disc, under);
    const Stored *const stiffness = line(of_cells.stiffness, row);
    const Stored *const factor = line(of_cells.factor, under);
    const bool keeps_reached = bodies.reached.shape[0] == bodies.gap.shape[0];
    const bool presses = step.full_depth < 1.0e300, factored = step.factored == 1;
    const bool parted = of_cells.parts.shape[0] > 0;
    const Stored *const parts = parted ? line(of_cells.parts, row) : nullptr;
    const int of_tile = 32 / lanes, of_row = bodies.gap.shape[1] * 8 / lanes;
    const double base = law.base, offset = law.offset, cap = law.cap, tie_width = law.tie_width;
    const double of_sphere = step.wear_per_pressure_sphere, of_disc = step.wear_per_pressure_disc;
    Lanes pressure = 0.0, weighted = 0.0, deviation = 0.0, highest = 0.0, deepest_sphere = 0.0;
    Lanes deepest_disc = 0.0;
    Counts contact = 0, capped = 0;
    double first_column = -1.0e9, last_column = -1.0e9;
    for (int n = lane; n < listed; n += slots_per_row) {{
        const int t = wp::index(tiles_in, row, n), first = t * of_tile;
        const int last = wp::min(first + of_tile, of_row);
        Lanes low = 1.0e30, high = -1.0e30, worn_sphere = 0.0, worn_disc = 0.0, pressed = 0.0;
        Counts touched = 0;
        Lanes was_touched[32 / lanes];
        for (int i = first; i < last; ++i) {{
            const Lanes overlap = (base - gap[i]) + offset;
            Lanes p = (overlap - tie_width) * stiffness[i];
            const Lanes part = parted ? parts[i] : one, most_here = cap * part;
            p = p > zero ? p : zero;
            p = p < most_here ? p : most_here;
            p = size_of(overlap) > tie_width ? p : law.tie_pressure * part;
            Lanes d = disc[i];
            if (presses) {{
                Lanes beyond = overlap - step.full_depth * part;
                beyond = beyond > zero ? beyond : zero;
                d -= beyond;
                const Lanes x = plastic[i] + beyond;
                plastic[i] = x;
                pressed += x;
            }}
            const Lanes f = factored ? factor[i] : one, da = of_sphere * p, db = of_disc * f * p;
            const Lanes s = sphere[i] + da, a = wear_sphere[i] + da, b = wear_disc[i] + db;
            d -= db;
            gap[i] = s - d;
            sphere[i] = s;
            disc[i] = d;
            wear_sphere[i] = a;
            wear_disc[i] = b;
            pressure += p;
            weighted += p * f;
            highest = highest > p ? highest : p;
            const Lanes from_reference = p > zero ? p - step.reference : zero;
            deviation += from_reference * from_reference;
            contact += p > zero ? yes : no;
            capped += p >= most_here ? yes : no;
            low = low < s ? low : s;
            high = high > d ? high : d;
            worn_sphere += a;
            worn_disc += b;
            deepest_sphere = deepest_sphere > a ? deepest_sphere : a;
            deepest_disc = deepest_disc > b ? deepest_disc : b;
            const Lanes ever = p + (keeps_reached ? (Lanes)reached[i] : a) > zero ? one : zero;
            touched += ever > zero ? yes : no;
            was_touched[i - first] = ever;
            if (keeps_reached) reached[i] = ever;
        }}
        wp::index(of_tiles.lowest, row, t) = -most(-low);
        wp::index(of_tiles.highest, under, t) = most(high);
        wp::index(of_tiles.worn_sphere, row, t) = total(worn_sphere);
        wp::index(of_tiles.worn_disc, under, t) = total(worn_disc);
        wp::index(of_tiles.touched, row, t) = count(touched);
        if (presses) wp::index(of_tiles.pressed_disc, under, t) = total(pressed);
        // Extents are known up to tiles that lie beyond them: all but a few of the first steps'.
        const bool reaches_beyond = first * lanes < step.first_column || last * lanes - 1 > step.last_column;
        if (reaches_beyond && count(touched) > 0.0)
            for (int j = 0; j < (last - first) * lanes; ++j)
                if (((const double*)was_touched)[j] > 0.0) {{
                    first_column = wp::max(first_column, -double(first * lanes + j));
                    last_column = wp::max(last_column, double(first * lanes + j));
                }}
    }}
    wp::index(tables.sums, {TrackSum.PRESSURE.value}, slot) = total(pressure);
    wp::index(tables.sums, {TrackSum.DEVIATION_SQUARED.value}, slot) = total(deviation);
    wp::index(tables.sums, {TrackSum.CONTACT.value}, slot) = count(contact);
    wp::index(tables.sums, {TrackSum.CAPPED.value}, slot) = count(capped);
    wp::index(tables.sums, {TrackSum.PRESSURE_TIMES_FACTOR.value}, slot) = total(weighted);
    wp::index(tables.maxima, {TrackMost.PRESSURE.value}, slot) = most(highest);
    wp::index(tables.maxima, {TrackMost.WEAR_SPHERE.value}, slot) = most(deepest_sphere);
    wp::index(tables.maxima, {TrackMost.WEAR_DISC.value}, slot) = most(deepest_disc);
    wp::index(tables.maxima, {TrackMost.FIRST_COLUMN.value}, slot) = first_column;
    wp::index(tables.maxima, {TrackMost.LAST_COLUMN.value}, slot) = last_column;
}}
"""


@wp.func_native(LANES_IN_C + _WEAR_TILES)
def wear_tiles(
    slot: wp.int32,
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
    """Wears the tiles listed of a slot and sums up what it finds; arguments as of `wear_step`."""
    ...


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

    What goes beyond the full depth is displaced from the disc for good, not worn. Of the tiles listed the
    gap, the bounds and what `totals` sums are made anew. Columns count that lie beyond the known ones.
    """
    slot = first_slot + wp.tid()
    wear_tiles(slot, slots_per_row, tiles_in, count_in, law, step, of_cells, bodies, of_tiles, tables)


@wp.func
def total_row(
    row: wp.int32,
    under: wp.int32,
    of_tiles: OfEightTiles,
    of_rows: OfRows,
):
    """Sums over a row of the sphere and the disc's row beneath it."""
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
    total_row(row, beneath(row, shift, of_tiles.worn_disc.shape[0]), of_tiles, of_rows)
