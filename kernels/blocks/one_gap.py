"""Blocks of steps of bodies that wear in one proportion, over the gap between them."""

import warp as wp

from warpwear.kernels.blocks.steps import AHEAD, BEGIN, END, FIRST_COLUMN, LAST_COLUMN, MADE, SEARCH, Block
from warpwear.kernels.cells import Cells, TileSums, WearMost
from warpwear.kernels.contact import Law
from warpwear.kernels.wear import wear_slot
from warpwear.kernels.wear_loops import Increment, Tables

wp.set_module_options({"enable_backward": False})

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


@wp.func_native(BEGIN + SEARCH + _ONE_GAP)
def begin_gap(
    n: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    block: Block,
    gap_in: wp.array2d(dtype=Cells),
) -> wp.int32:
    """Tells whether step n can be made, and solves its balance."""
    ...


@wp.func_native(BEGIN + END + _END_OF_ONE_GAP)
def end_gap(n: wp.int32, block: Block, tables: Tables) -> wp.int32:
    """Sums up step n and tells whether the block goes on."""
    ...


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
