"""Many steps of a small contact in one launch on one core of a CPU: what a launch costs is paid once a block.

A step searches as `contact.balance` and `contact.bearing_area` do and wears by the loops of `wear` and
`sliding`, all in the order in which a step of its own adds up, so that its numbers are the same. A block ends
before a step that asks for more, a new list of tiles or a tie, say, which is then made by itself.
"""

import warp as wp

from warpwear.kernels.cells import EXTENTS, NONE, Cells, TileSums, TrackMost, WearMost
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
from warpwear.kernels.wear import wear_slot
from warpwear.kernels.wear_loops import LANES_IN_C, Increment, Tables

wp.set_module_options({"enable_backward": False})

#: Columns of the plan: K ΔL of both bodies or of each [mm³/N], compliance [mm³/N] and 1/c [N/mm³].
PLAN = ("sphere", "disc", "compliance", "stiffness")
#: What a row says of the balance, before the sums and maxima of its step.
BALANCE = ("base", "offset", "cap", "residual", "evaluations", "reference")
#: Numbers that a block begins with and leaves as they are after its last step.
MEMORY = (
    "made",  # steps of the block
    "approach",  # of the last step [mm]
    "mean",  # pressure of the last step [MPa]
    *EXTENTS,
    # Of one gap: what foresees the next approach, see `contact.foresight`, and what was evaluated there.
    *("slid", "rates", "where_0", "rate_0", "where_1", "rate_1"),
    *("known", "ahead", "force", "slope", "straight"),
    # The list of tiles that a step asks for before its search, 1, or after it, 2; from where, how far beyond
    # [mm], and what was found before.
    *("asks", "reach", "margin", "solved", "solved_force", "solved_evaluations"),
    # Of two bodies: the largest gap that wear has made [mm], and the oldest of the last changes below.
    *("largest", "oldest", "changes"),
)


@wp.struct
class Rules:
    """How a balance is searched for: constants of `contact.balance` and, for tiles, of the models."""

    tolerance: wp.float64
    most: wp.int32
    hopeless: wp.float64
    first_reach: wp.float64
    surely: wp.float64
    digits: wp.float64
    steps_ahead: wp.float64


@wp.struct
class Block:
    """A block of steps: what is asked for, what is kept between them, and what they leave."""

    rules: Rules
    steps: wp.int32
    plan: wp.array2d(dtype=wp.float64)  # one row a step, by `PLAN`; a row more where the step after is known
    memory: wp.array(dtype=wp.float64)  # by `MEMORY`, then changes of the approach, -1 for none [mm]
    found: wp.array2d(dtype=wp.float64)  # one row a step: `BALANCE`, sums, maxima
    sums: wp.array2d(dtype=wp.float64)  # room for two numbers a row of cells
    stiffness: wp.array2d(dtype=Cells)  # one row [N/mm³]
    within: wp.array(dtype=wp.float64)  # by `EXTENTS`, where a contact is neither at the edge nor at the rim
    load: wp.float64  # [N]
    hardness: wp.float64  # [MPa]
    cell_area: wp.float64  # [mm²]
    limit: wp.float64  # approach that the list of tiles serves [mm]
    asked: wp.float64  # that it was made for [mm]


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


_MEMORY = "".join(f"    double& {name} = memory[{index}];\n" for index, name in enumerate(MEMORY))
#: A sum as NumPy makes it of a row of numbers.
_BEGIN = (
    LANES_IN_C
    + """
{
    #pragma clang fp contract(off)
    const double inf = __builtin_inf();
    const auto sum_part = [](const auto& self, const double* v, int n) __attribute__((noinline)) -> double {
        if (n > 128) {
            const int half = n / 2 - n / 2 % 8;
            return self(self, v, half) + self(self, v + half, n - half);
        }
        double r[8] = {0.0}, sum = 0.0;
        int i = 0;
        if (n >= 8) {
            for (; i < 8; ++i) r[i] = v[i];
            for (; i < n - n % 8; ++i) r[i % 8] += v[i];
            sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
        }
        for (; i < n; ++i) sum += v[i];
        return sum;
    };
    const auto sum_of_row = [&](const auto& table, int line) __attribute__((noinline)) {
        return sum_part(sum_part, &wp::index(table, line, 0), table.shape[1]);
    };
    const auto most_of_row = [&](const auto& table, int line) {
        double found = wp::index(table, line, 0);
        for (int i = 1; i < table.shape[1]; ++i) found = wp::max(found, wp::index(table, line, i));
        return found;
    };
    double* const memory = block.memory.data;
"""
    + _MEMORY
)
#: The load carried at an offset, and the search for the load.
_SEARCH = """
    const int rows = gap_in.shape[0], of_tile = 32 / lanes, of_row = gap_in.shape[1];
    const double* const plan = &wp::index(block.plan, n, 0);
    const double load = block.load, cap = block.hardness;
    double offset = 0.0, evaluations = 0.0, now_force = 0.0, now_slope = 0.0, now_straight = 0.0;
    const auto look = [&](double at) {
        const Stored* const stiffness = (const Stored*)block.stiffness.data;
        double nearest = inf;
        for (int row = 0; row < rows; ++row) {
            Lanes pressure = 0.0, slope = 0.0, near = 1.0e30;
            const Stored* const gap = (const Stored*)&wp::index(gap_in, row, 0);
            for (int k = 0; k < wp::index(count_in, row); ++k) {
                const int first = wp::index(tiles_in, row, k) * of_tile;
                for (int i = first; i < wp::min(first + of_tile, of_row); ++i) {
                    const Lanes q = ((approach - gap[i]) + at) * stiffness[i];
                    Lanes p = q > zero ? q : zero;
                    p = p < cap ? p : cap;
                    pressure += p;
                    slope += p > zero && q < cap ? (Lanes)stiffness[i] : zero;
                    const Lanes open = size_of(q), full = size_of(q - cap);
                    const Lanes either = open < full ? open : full;
                    near = near < either ? near : either;
                }
            }
            wp::index(block.sums, 0, row) = total(pressure);
            wp::index(block.sums, 1, row) = total(slope);
            nearest = wp::min(nearest, -most(-near));
        }
        now_force = sum_of_row(block.sums, 0) * block.cell_area;
        now_slope = sum_of_row(block.sums, 1) * block.cell_area;
        now_straight = nearest;
    };
    const auto balance = [&](double guess, double scatter, double stiffest, bool is_known) {
        double low = -inf, high = inf, before = inf, reach = wp::max(wp::abs(guess), scatter);
        reach = reach != 0.0 ? reach : block.rules.first_reach;
        offset = guess;
        for (int trial = 1; trial < block.rules.most; ++trial) {
            if (trial > 1 || !is_known) look(offset);
            evaluations = trial - is_known;
            const double residual = now_force - load;
            if (wp::abs(residual) <= block.rules.tolerance * load) return true;
            if (!(wp::abs(offset) < block.rules.hopeless)) return false;
            (residual < 0.0 ? low : high) = offset;
            const double newton = now_slope > 0.0 ? offset - residual / now_slope : __builtin_nan("");
            const double way = wp::abs(newton - offset);
            if (way * stiffest < block.rules.surely * now_straight
                && now_slope * wp::abs(newton) < block.rules.digits * load) {
                offset = newton;
                now_force = load;
                return true;
            }
            if (low == -inf || high == inf) {
                offset = way <= reach ? newton : offset + __builtin_copysign(reach, -residual);
                reach *= 4.0;
                continue;
            }
            const bool halves = trial % 2 == 0, stalled = halves && high - low > 0.5 * before;
            if (halves) before = high - low;
            offset = low < newton && newton < high && !stalled ? newton : 0.5 * (low + high);
            if (!(low < offset && offset < high)) return false;
        }
        return false;
    };
    const auto fill = [&](double value) {
        for (int i = 0; i < of_row; ++i) ((Stored*)block.stiffness.data)[i] = value;
    };
    const auto write = [&](double base, double cap, double residual, double reference) {
        const double numbers[] = {base, offset, cap, residual, evaluations, reference};
        for (int i = 0; i < 6; ++i) wp::index(block.found, n, i) = numbers[i];
    };
"""

#: A gap whose tiles are listed: a step that needs another list is not made.
_ONE_GAP = """
    const double removal = plan[0], stiffness = plan[3], guess = known != 0.0 ? ahead : removal * mean;
    const int listed = (int)asks;
    const auto serves = [&](double at, double way, int which) {
        reach = at;
        margin = block.rules.steps_ahead * wp::abs(way);
        asks = at > block.limit || at + 2.0 * margin < block.asked ? which : 0;
        return asks == 0.0;
    };
    asks = 0.0;
    fill(stiffness);
    now_force = force;
    now_slope = slope;
    now_straight = straight;
    if (listed == 0 && !serves(approach + guess, guess, 1)) return 0;
    if (listed == 2) {
        offset = solved;
        now_force = solved_force;
        evaluations = solved_evaluations;
    } else if (!balance(guess, 0.0, stiffness, known != 0.0)) return 0;
    const double here = approach + offset, slid_now = slid + removal, where = slid + 0.5 * removal;
    if (here > block.limit) return 0;
    double count_now = rates, w0 = where_0, r0 = rate_0, w1 = where_1, r1 = rate_1, next = 0.0;
    if (removal > 0.0 && (rates == 0.0 || where > (rates == 1.0 ? w0 : w1))) {
        if (rates == 2.0) {
            w0 = w1;
            r0 = r1;
        }
        (rates == 0.0 ? w0 : w1) = where;
        (rates == 0.0 ? r0 : r1) = (here - approach) / removal;
        count_now = wp::min(rates + 1.0, 2.0);
    }
    if (n + 1 < block.plan.shape[0]) {
        const double removal_next = plan[4], there = slid_now + 0.5 * removal_next;
        double rate = 0.0;
        if (count_now == 1.0) rate = r0;
        if (count_now == 2.0) rate = r0 * ((there - w1) / (w0 - w1)) + r1 * ((there - w0) / (w1 - w0));
        next = removal_next * rate;
        solved = offset;
        solved_force = now_force;
        solved_evaluations = evaluations;
        if (listed < 2 && !serves(here + wp::max(next, 0.0), next, 2)) return 0;
    }
    write(approach, cap, now_force - load, mean);
    slid = slid_now;
    rates = count_now;
    where_0 = w0;
    rate_0 = r0;
    where_1 = w1;
    rate_1 = r1;
    ahead = next;
    return 1;
}
"""
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
#: Sums and maxima of a step, and what the next one needs of them. A block ends where the contact reaches the
#: edge or the rim: the run may have to stop there, and be kept as it is.
_END = """
    double* found = &wp::index(block.found, n, 6);
    const double base = found[-6], offset = found[-5];
    for (int line = 0; line < tables.sums.shape[0]; ++line) *found++ = sum_of_row(tables.sums, line);
    const double* const sums = found - tables.sums.shape[0], *const maxima = found;
    for (int line = 0; line < tables.maxima.shape[0]; ++line) *found++ = most_of_row(tables.maxima, line);
    bool goes_on = sums[2] > 0.0 && sums[0] < inf;
    mean = sums[0] / sums[2];
    made = n + 1;
    const auto extend = [&](double& extent, double index) {
        goes_on = goes_on && !(index > extent && index > block.within.data[&extent - &first_row]);
        extent = wp::max(extent, index);
    };
"""
_END_OF_ONE_GAP = f"""
    approach = base + offset;
    extend(first_row, maxima[{WearMost.FIRST_ROW.value}]);
    extend(last_row, maxima[{WearMost.LAST_ROW.value}]);
    extend(first_column, maxima[{WearMost.FIRST_COLUMN.value}]);
    extend(last_column, maxima[{WearMost.LAST_COLUMN.value}]);
    force = sum_of_row(tables.ahead, 0) * block.cell_area;
    slope = sum_of_row(tables.ahead, 1) * block.cell_area;
    straight = inf;
    const int rows = tables.ahead.shape[1];
    for (int i = 0; i < rows; ++i) straight = wp::min(straight, wp::index(tables.ahead, 2, i));
    known = ahead != 0.0;
    const double residual = sums[0] * block.cell_area - block.load;
    return goes_on && wp::abs(residual) <= 2.0 * block.rules.tolerance * block.load;
}}
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


@wp.func_native(_BEGIN + _SEARCH + _ONE_GAP)
def begin_gap(
    n: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    block: Block,
    gap_in: wp.array2d(dtype=Cells),
) -> wp.int32:
    """Tells whether step n can be made, and solves its balance."""
    ...


@wp.func_native(_BEGIN + _END + _END_OF_ONE_GAP)
def end_gap(n: wp.int32, block: Block, tables: Tables) -> wp.int32:
    """Sums up step n and tells whether the block goes on."""
    ...


@wp.func_native(_BEGIN + _SEARCH + _TWO_BODIES)
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


@wp.func_native(_BEGIN + _END + _END_OF_TWO_BODIES)
def end_bodies(n: wp.int32, block: Block, lying: Lying, tables: StepTables) -> wp.int32:
    """Sums up step n and tells whether the block goes on."""
    ...


MADE, AHEAD, FIRST_COLUMN, LAST_COLUMN = (
    wp.constant(wp.int32(MEMORY.index(name))) for name in ("made", "ahead", "first_column", "last_column")
)


@wp.kernel(module="unique", enable_backward=False)
def wear_gap(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    block: Block,
    unworn_in: wp.array2d(dtype=Cells),
    rest_in: wp.array(dtype=TileSums),
    gap_out: wp.array2d(dtype=Cells),
    tables: Tables,
):
    """Steps of bodies that wear in one proportion, as those of `wear.wear_step`. One thread."""
    n = wp.int32(block.memory[MADE])
    goes_on = wp.int32(1)
    while n < block.steps and goes_on == 1:
        goes_on = begin_gap(n, tiles_in, count_in, block, gap_out)
        if goes_on == 1:
            law = Law()
            law.base = block.found[n, 0]
            law.offset = block.found[n, 1]
            law.cap = block.hardness
            step = Increment()
            step.wear_per_pressure = block.plan[n, 0]
            step.stiffness = block.plan[n, 3]
            step.reference = block.found[n, 5]
            step.base_next = law.base + law.offset
            step.offset_next = block.memory[AHEAD]
            step.stiffness_next = block.plan[wp.min(n + 1, block.plan.shape[0] - 1), 3]
            step.first_column = -wp.int32(block.memory[FIRST_COLUMN])
            step.last_column = wp.int32(block.memory[LAST_COLUMN])
            for row in range(gap_out.shape[0]):
                wear_slot(row, 1, tiles_in, count_in, law, step, unworn_in, rest_in, gap_out, tables)
            goes_on = end_gap(n, block, tables)
            n += 1


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
