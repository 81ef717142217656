"""Blocks of steps of two bodies that lie still, each of which wears by itself."""

import warp as wp

from warpwear.kernels.blocks.steps import BEGIN, END, FIRST_COLUMN, LAST_COLUMN, MADE, SEARCH, Block
from warpwear.kernels.cells import NONE, Cells, TrackMost
from warpwear.kernels.contact import Law
from warpwear.kernels.sliding import (
    Bodies,
    OfCells,
    OfEightTiles,
    OfRows,
    OfTiles,
    Slide,
    StepTables,
    total_row,
    wear_tiles,
)

wp.set_module_options({"enable_backward": False})


@wp.struct
class Lying:
    """Two bodies that lie still, and what lists of their tiles and a bearing area need."""

    of_cells: OfCells
    bodies: Bodies
    of_tiles: OfTiles
    of_eight: OfEightTiles
    of_rows: OfRows
    lowest: wp.array2d(dtype=wp.float64)  # gap of every tile [mm]
    cells: wp.array(dtype=wp.float64)  # room for the gaps of all cells
    factored: wp.int32  # as of `Slide`
    own: wp.float64  # compliance without wear where 1/c differs by the factor, else -1 [mm³/N]
    least: wp.int32  # tiles that a list holds
    first_depth: wp.float64  # by which a list reaches deeper than the last approach [mm]
    deeper: wp.float64
    deepest: wp.float64  # [mm]
    scatter: wp.float64  # that the approach may change by when nothing is known of it [mm]
    least_scatter: wp.float64  # [mm]
    times: wp.float64
    needed: wp.float64  # cells of a bearing area
    allowed: wp.float64
    highest: wp.float64  # gap before wear [mm]
    tie: wp.float64  # [mm]


#: What two bodies that lie still can touch is known to a cell, as none of them moves.
_TWO_BODIES = """
    const double of_sphere = plan[0], of_disc = plan[1], compliance = plan[2], stiffness = plan[3];
    const int columns = lying.lowest.shape[1];
    const double* const gaps = (const double*)gap_in.data;
    if (n == 0) largest = -inf;
    for (int row = 0; row < rows; ++row) {  // what the last step wore, at first everything
        Stored* const gap = (Stored*)&wp::index(gap_in, row, 0);
        const Stored* const sphere = (const Stored*)&wp::index(lying.bodies.sphere, row, 0);
        const Stored* const disc = (const Stored*)&wp::index(lying.bodies.disc, row, 0);
        const int listed = n == 0 ? columns : wp::index(count_in, row);
        for (int k = 0; k < listed; ++k) {
            const int t = n == 0 ? k : wp::index(tiles_in, row, k), first = t * of_tile;
            Lanes low = 1.0e30, high = -1.0e30;
            for (int i = first; i < wp::min(first + of_tile, of_row); ++i) {
                if (n == 0) gap[i] = sphere[i] - disc[i];
                const Lanes g = gap[i], there = g < 0.5e30 ? g : -1.0e30;
                low = low < g ? low : g;
                high = high > there ? high : there;
            }
            wp::index(lying.lowest, row, t) = -most(-low);
            largest = wp::max(largest, most(high));
        }
    }
    const auto list = [&](double limit) {
        int listed = 0;
        for (int row = 0; row < rows; ++row) {
            int here = 0;
            for (int t = 0; t < columns; ++t)
                if (wp::index(lying.lowest, row, t) <= limit) wp::index(tiles_in, row, here++) = t;
            wp::index(count_in, row) = here;
            listed += here;
        }
        return listed;
    };
    double scatter = -1.0;
    for (double* change = &changes; change < memory + block.memory.shape[0]; ++change)
        scatter = wp::max(scatter, *change);
    scatter = lying.times * (scatter < 0.0 ? 0.5 * lying.scatter : scatter);
    scatter = wp::max(scatter, lying.least_scatter);
    if (compliance > 0.0) {
        fill(stiffness);
        if (lying.own >= 0.0)
            for (int i = 0; i < of_row; ++i) {
                Lanes c = ((const Stored*)lying.of_cells.factor.data)[i] * of_disc + (lying.own + of_sphere);
                ((Stored*)block.stiffness.data)[i] = 1.0 / c;
            }
        double limit = approach + scatter, depth = lying.first_depth;
        while (list(limit) < lying.least && limit < inf) {
            limit = depth < lying.deepest ? limit + depth : inf;
            depth *= lying.deeper;
        }
        if (!balance(0.0, scatter, lying.factored == 1 ? inf : stiffness, false)) return 0;
        if (approach + offset > limit) return 0;
        write(approach, cap, now_force - load, mean);
        return 1;
    }
    // A bearing area. Counts are needed of levels up to one that surely holds too many cells.
    fill(stiffness);
    double low = inf, high = lying.highest + 2.0 * lying.tie, level = approach + 0.25 * scatter;
    for (int i = 0; i < rows * columns; ++i) low = wp::min(low, lying.lowest.data[i]);
    if (largest != lying.highest) return 0;  // a cell that high is worn: rarer than rare
    double* const cells = lying.cells.data;
    int some = 0;
    while (true) {
        some = 0;
        for (int row = 0; row < rows; ++row)
            for (int t = 0; t < columns; ++t)
                if (wp::index(lying.lowest, row, t) < level)
                    for (int i = t * 32; i < wp::min(t * 32 + 32, of_row * lanes); ++i) {
                        const double g = gaps[row * of_row * lanes + i];
                        cells[some] = g;
                        some += g < level;
                    }
        if (some - lying.needed >= lying.allowed || level >= high) break;
        level = approach + scatter;
        scatter *= 4.0;
    }
    double at = 0.5 * (low + high);
    for (int trial = 1; trial < block.rules.most; ++trial) {
        const bool is_above = at >= level;
        int below = is_above ? some : 0;
        if (!is_above)
            for (int i = 0; i < some; ++i) below += cells[i] < at;
        if (!is_above && wp::abs(below - lying.needed) < lying.allowed && below > 0) {
            evaluations = trial;
            list(at);
            const double shared = load / (below * block.cell_area);
            write(at, shared, (below - lying.needed) * cap * block.cell_area, shared);
            return 1;
        }
        const double before = high - low;
        (below > lying.needed ? high : low) = at;
        if (before <= lying.tie) return 0;
        at = 0.5 * (low + high);
    }
    return 0;
}
"""
_END_OF_TWO_BODIES = f"""
    const double change = wp::abs((base + offset) - approach);
    const int room = block.memory.shape[0] - (int)(&changes - memory);
    (&changes)[(int)oldest] = change;
    oldest = ((int)oldest + 1) % room;
    approach = base + offset;
    const auto& of_rows = lying.of_rows;
    const double* const totals[] = {{of_rows.touched.data, of_rows.worn_sphere.data, of_rows.worn_disc.data}};
    for (int i = 0; i < 3; ++i) *found++ = sum_part(sum_part, totals[i], of_rows.touched.shape[0]);
    double first = -inf, last = -inf;
    for (int row = 0; row < lying.of_rows.touched.shape[0]; ++row)
        if (lying.of_rows.touched.data[row] > 0.0) {{
            first = wp::max(first, -double(row));
            last = row;
        }}
    *found++ = first;
    *found++ = last;
    extend(first_row, first);
    extend(last_row, last);
    extend(first_column, maxima[{TrackMost.FIRST_COLUMN.value}]);
    extend(last_column, maxima[{TrackMost.LAST_COLUMN.value}]);
    return goes_on;
}}
"""


@wp.func_native(BEGIN + SEARCH + _TWO_BODIES)
def begin_bodies(
    n: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    block: Block,
    lying: Lying,
    gap_in: wp.array2d(dtype=Cells),
) -> wp.int32:
    """Tells whether step n can be made, solves its balance and lists the tiles in contact."""
    ...


@wp.func_native(BEGIN + END + _END_OF_TWO_BODIES)
def end_bodies(n: wp.int32, block: Block, lying: Lying, tables: StepTables) -> wp.int32:
    """Sums up step n and tells whether the block goes on."""
    ...


@wp.kernel(module="unique", enable_backward=False)
def wear_bodies(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    block: Block,
    lying: Lying,
    tables: StepTables,
):
    """Steps of two bodies that lie still, as those of `sliding.wear_step`. One thread."""
    n = wp.int32(block.memory[MADE])
    goes_on = wp.int32(1)
    while n < block.steps and goes_on == 1:
        goes_on = begin_bodies(n, tiles_in, count_in, block, lying, lying.bodies.gap)
        if goes_on == 1:
            law = Law()
            law.base = block.found[n, 0]
            law.offset = block.found[n, 1]
            law.cap = block.found[n, 2]
            step = Slide()
            step.wear_per_pressure_sphere = block.plan[n, 0]
            step.wear_per_pressure_disc = block.plan[n, 1]
            step.factored = lying.factored
            step.reference = block.found[n, 5]
            step.full_depth = NONE
            step.first_column = -wp.int32(block.memory[FIRST_COLUMN])
            step.last_column = wp.int32(block.memory[LAST_COLUMN])
            for row in range(count_in.shape[0]):
                wear_tiles(
                    row,
                    1,
                    tiles_in,
                    count_in,
                    law,
                    step,
                    lying.of_cells,
                    lying.bodies,
                    lying.of_tiles,
                    tables,
                )
                if count_in[row] > 0:
                    total_row(row, row, lying.of_eight, lying.of_rows)
            goes_on = end_bodies(n, block, lying, tables)
            n += 1
