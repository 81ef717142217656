"""What blocks of steps share: their plan, rules and memory, the search for the load, and the sums at the end.

A step searches as `contact.balance` and `contact.bearing_area` do and wears by the loops of `wear` and
`sliding`, all in the order in which a step of its own adds up, so that its numbers are the same. A block ends
before a step that asks for more, a new list of tiles or a tie, say, which is then made by itself.
"""

import warp as wp

from warpwear.kernels.cells import EXTENTS, Cells
from warpwear.kernels.wear_loops import LANES_IN_C

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


_MEMORY = "".join(f"    double& {name} = memory[{index}];\n" for index, name in enumerate(MEMORY))
#: A sum as NumPy makes it of a row of numbers.
BEGIN = (
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
SEARCH = """
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

#: Sums and maxima of a step, and what the next one needs of them. A block ends where the contact reaches the
#: edge or the rim: the run may have to stop there, and be kept as it is.
END = """
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

MADE, AHEAD, FIRST_COLUMN, LAST_COLUMN = (
    wp.constant(wp.int32(MEMORY.index(name))) for name in ("made", "ahead", "first_column", "last_column")
)
