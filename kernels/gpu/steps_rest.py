"""The passes of a gap at rest over its cells, on a GPU: what it carries, and its wear.

A thread visits single cells, its neighbours the neighbouring ones; fields are those of the other kernels,
seen as numbers. The loop that wears is written in C++: in Python's notation the compiler gives each thread
some 230 registers, so that too few threads run at a time to keep the memory busy (measure with bench/speed.py
on a GPU after a change). On a CPU a block is one thread.
"""

import warp as wp

from warpwear.kernels.cells import ABSENT, ONE, ZERO, WearMost, WearSum
from warpwear.kernels.gpu.steps import Steps, compliance_of

wp.set_module_options({"enable_backward": False})


#: Cells that a thread loads at once.
FOUR = 4


@wp.kernel
def carried(steps: Steps, gap_in: wp.array(dtype=wp.float64)):
    """What the trial approach carries, see `steps.carried_of`."""
    block = wp.tid() // wp.block_dim()
    columns = steps.columns
    cap = steps.cap
    base = steps.search[0].base
    offset = steps.search[0].offset
    s = ONE / compliance_of(steps, steps.step[0])
    width = wp.block_dim()
    pressure = ZERO
    slope = ZERO
    nearest = -ABSENT
    for row in range(block, gap_in.shape[0] // columns, steps.blocks):
        for first in range(wp.tid() % width, columns, FOUR * width):
            gaps = wp.vec4d(ABSENT, ABSENT, ABSENT, ABSENT)
            for j in range(FOUR):  # loaded together: one at a time does not keep the memory busy
                if first + j * width < columns:
                    gaps[j] = gap_in[row * columns + first + j * width]
            for j in range(FOUR):
                q = ((base - gaps[j]) + offset) * s
                pressure += wp.min(wp.max(q, ZERO), cap)
                slope += wp.where(q > ZERO and q < cap, s, ZERO)
                nearest = wp.max(nearest, -wp.min(wp.abs(q), wp.abs(q - cap)))
    wp.tile_store(steps.trial[0], wp.tile_sum(wp.tile(pressure)), offset=block)
    wp.tile_store(steps.trial[1], wp.tile_sum(wp.tile(slope)), offset=block)
    wp.tile_store(steps.trial[2], wp.tile_max(wp.tile(nearest)), offset=block)


_WEAR = """
    const int FOUR = 4, beyond = 2147483647;
    const double absent = 1.0e30, no_index = -1.0e9;
    const int block = thread / width, lane = thread % width, columns = steps.columns;
    const double* const unworn = unworn_in.data;
    double* const gap = gap_out.data;
    double pressure = 0.0, deviation = 0.0, worn = 0.0, highest = 0.0, deepest = 0.0;
    double pressure_next = 0.0, nearest_next = absent;
    int contact = 0, capped = 0, touched = 0, between_next = 0;  // whole numbers cost a GPU less
    int first_column = beyond, last_column = -1;
    long long first_place = -1, last_place = -1;  // of a cell in the field: its row follows from it
    const auto& search = steps.search.data[0];
    const double base = search.base, offset = search.offset, cap = steps.cap, mean = search.mean;
    const double base_next = search.approach, offset_next = search.ahead;
    const auto& worn_by = steps.wear_per_pressure.data[steps.step.data[0]];
    const double opening = worn_by[0] + worn_by[1], s = stiffness;
    const long long cells = gap_out.shape[0];
    for (long long start = (long long)block * FOUR * width; start < cells;
         start += (long long)steps.blocks * FOUR * width) {
        const int place = (int)(start % columns) + lane;
        double g[FOUR], u[FOUR];
        #pragma unroll
        for (int j = 0; j < FOUR; ++j) {  // loaded together: one at a time does not keep the memory busy
            const long long cell = start + lane + j * width;
            const bool is_there = cell < cells;
            g[j] = is_there ? gap[cell] : absent;
            u[j] = is_there ? unworn[cell] : absent;
        }
        #pragma unroll
        for (int j = 0; j < FOUR; ++j) {
            const long long cell = start + lane + j * width;
            double p = ((base - g[j]) + offset) * s;
            p = p > 0.0 ? p : 0.0;
            p = p < cap ? p : cap;
            const double after = g[j] + opening * p, w = after - u[j];
            if (p > 0.0) {
                gap[cell] = after;
                pressure += p;
                deviation += (p - mean) * (p - mean);
                contact += 1;
                capped += p >= cap ? 1 : 0;
                highest = highest > p ? highest : p;
            }
            if (p + w > 0.0) {
                int column = place + j * width;
                while (column >= columns) column -= columns;
                touched += 1;
                first_place = first_place < 0 ? cell : first_place;
                last_place = cell;
                first_column = first_column < column ? first_column : column;
                last_column = last_column > column ? last_column : column;
                worn += w;
                deepest = deepest > w ? deepest : w;
            }
            const double r = ((base_next - after) + offset_next) * stiffness_next, full = fabs(r - cap);
            double q = r > 0.0 ? r : 0.0;
            q = q < cap ? q : cap;
            pressure_next += q;
            between_next += r == q ? 1 : 0;
            const double near = fabs(r) < full ? fabs(r) : full;
            nearest_next = nearest_next < near ? nearest_next : near;
        }
    }

    const bool some = touched > 0;
"""
#: What a block leaves: table, line, value of a thread, and whether values are added up or the largest counts.
_LEAVES = (
    ("trial", 0, "pressure_next", True),
    ("trial", 1, "stiffness_next * between_next", True),
    ("trial", 2, "-nearest_next", False),
    ("found", WearSum.PRESSURE, "pressure", True),
    ("found", WearSum.DEVIATION_SQUARED, "deviation", True),
    ("found", WearSum.CONTACT, "contact", True),
    ("found", WearSum.CAPPED, "capped", True),
    ("found", WearSum.TOUCHED, "touched", True),
    ("found", WearSum.WORN, "worn", True),
    ("found", len(WearSum) + WearMost.PRESSURE, "highest", False),
    ("found", len(WearSum) + WearMost.WORN, "deepest", False),
    ("found", len(WearSum) + WearMost.FIRST_ROW, "some ? -double(first_place / columns) : no_index", False),
    ("found", len(WearSum) + WearMost.LAST_ROW, "some ? double(last_place / columns) : no_index", False),
    ("found", len(WearSum) + WearMost.FIRST_COLUMN, "some ? -double(first_column) : no_index", False),
    ("found", len(WearSum) + WearMost.LAST_COLUMN, "some ? double(last_column) : no_index", False),
)
# All at once: each warp of the block brings every value to one, then has some of the values of all warps.
_KEEP = f"""
#if defined(__CUDA_ARCH__)
    __shared__ double of_warps[{len(_LEAVES)}][32];
    const int warp = lane / 32, in_warp = lane % 32, warps = width / 32;
    const auto of_warp = [&](double v, bool adds) {{
        for (int apart = 16; apart > 0; apart /= 2) {{
            const double other = __shfl_down_sync(0xffffffff, v, apart);
            v = adds ? v + other : (v > other ? v : other);
        }}
        return v;
    }};
    const auto leave = [&](int n, double v, bool adds) {{
        v = of_warp(v, adds);
        if (in_warp == 0) of_warps[n][warp] = v;
    }};
    {"".join(f"leave({n}, {value}, {str(adds).lower()});" for n, (_, _, value, adds) in enumerate(_LEAVES))}
    __syncthreads();
    const auto keep = [&](auto& table, int line, int n, double, bool adds) {{
        if (n % warps != warp) return;
        const double v = of_warp(in_warp < warps ? of_warps[n][in_warp] : (adds ? 0.0 : -1.0e300), adds);
        if (in_warp == 0) wp::index(table, line, block) = v;
    }};
#else
    const auto keep = [&](auto& table, int line, int, double v, bool) {{
        wp::index(table, line, block) = v;
    }};
#endif
    {
    "".join(
        f"keep(steps.{table}, {int(line)}, {n}, {value}, {str(adds).lower()});"
        for n, (table, line, value, adds) in enumerate(_LEAVES)
    )
}
"""


@wp.func_native(_WEAR + _KEEP)
def wear(
    thread: wp.int32,
    width: wp.int32,
    steps: Steps,
    stiffness: wp.float64,
    stiffness_next: wp.float64,
    unworn_in: wp.array(dtype=wp.float64),
    gap_out: wp.array(dtype=wp.float64),
):
    """Wears the cells of a thread in a block of some width; arguments as of `wear_step`."""
    ...


@wp.kernel
def wear_step(steps: Steps, unworn_in: wp.array(dtype=wp.float64), gap_out: wp.array(dtype=wp.float64)):
    """One increment of wear, as `wear.wear_step`, and what the approach expected next carries after it."""
    step = steps.step[0]
    if wp.tid() == 0:
        steps.step[1] = step
    stiffness = ONE / compliance_of(steps, step)
    stiffness_next = ONE / compliance_of(steps, step + 1)
    wear(wp.tid(), wp.block_dim(), steps, stiffness, stiffness_next, unworn_in, gap_out)
