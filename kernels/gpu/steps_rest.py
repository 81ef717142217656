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
    int first_row = beyond, last_row = -1, first_column = beyond, last_column = -1;
    const auto& search = steps.search.data[0];
    const double base = search.base, offset = search.offset, cap = steps.cap, mean = search.mean;
    const double base_next = search.approach, offset_next = search.ahead;
    const auto& worn_by = steps.wear_per_pressure.data[steps.step.data[0]];
    const double opening = worn_by[0] + worn_by[1], s = stiffness;
    const int lines = gap_out.shape[0] / columns;
    for (int row = block; row < lines; row += steps.blocks) {
        const long long start = (long long)row * columns;
        const int touched_before = touched;
        for (int first = lane; first < columns; first += FOUR * width) {
            double g[FOUR], u[FOUR];
            #pragma unroll
            for (int j = 0; j < FOUR; ++j) {  // loaded together: one at a time does not keep the memory busy
                const int column = first + j * width;
                const bool is_there = column < columns;
                g[j] = is_there ? gap[start + column] : absent;
                u[j] = is_there ? unworn[start + column] : absent;
            }
            #pragma unroll
            for (int j = 0; j < FOUR; ++j) {
                const int column = first + j * width;
                double p = ((base - g[j]) + offset) * s;
                p = p > 0.0 ? p : 0.0;
                p = p < cap ? p : cap;
                const double after = g[j] + opening * p, w = after - u[j];
                if (p > 0.0) {
                    gap[start + column] = after;
                    pressure += p;
                    deviation += (p - mean) * (p - mean);
                    contact += 1;
                    capped += p >= cap ? 1 : 0;
                    highest = highest > p ? highest : p;
                }
                if (p + w > 0.0) {
                    touched += 1;
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
        if (touched > touched_before) {
            first_row = first_row < row ? first_row : row;
            last_row = row;
        }
    }

#if defined(__CUDA_ARCH__)
    __shared__ double of_warps[32];
    const auto of_block = [&](double v, bool adds) {
        for (int apart = 16; apart > 0; apart /= 2) {
            const double other = __shfl_down_sync(0xffffffff, v, apart);
            v = adds ? v + other : (v > other ? v : other);
        }
        __syncthreads();
        if (lane % 32 == 0) of_warps[lane / 32] = v;
        __syncthreads();
        for (int n = 1; n < width / 32; ++n)
            v = adds ? v + of_warps[n] : (v > of_warps[n] ? v : of_warps[n]);
        return v;
    };
#else
    const auto of_block = [&](double v, bool) { return v; };
#endif
    const auto keep = [&](auto& table, int line, double v, bool adds) {
        v = of_block(v, adds);
        if (lane == 0) wp::index(table, line, block) = v;
    };
    const bool some = touched > 0;
"""
_KEEP = f"""
    keep(steps.trial, 0, pressure_next, true);
    keep(steps.trial, 1, stiffness_next * between_next, true);
    keep(steps.trial, 2, -nearest_next, false);
    keep(steps.found, {WearSum.PRESSURE.value}, pressure, true);
    keep(steps.found, {WearSum.DEVIATION_SQUARED.value}, deviation, true);
    keep(steps.found, {WearSum.CONTACT.value}, contact, true);
    keep(steps.found, {WearSum.CAPPED.value}, capped, true);
    keep(steps.found, {WearSum.TOUCHED.value}, touched, true);
    keep(steps.found, {WearSum.WORN.value}, worn, true);
    const int most = {len(WearSum)};
    keep(steps.found, most + {WearMost.PRESSURE.value}, highest, false);
    keep(steps.found, most + {WearMost.WORN.value}, deepest, false);
    keep(steps.found, most + {WearMost.FIRST_ROW.value}, some ? -double(first_row) : no_index, false);
    keep(steps.found, most + {WearMost.LAST_ROW.value}, some ? double(last_row) : no_index, false);
    keep(steps.found, most + {WearMost.FIRST_COLUMN.value}, some ? -double(first_column) : no_index, false);
    keep(steps.found, most + {WearMost.LAST_COLUMN.value}, some ? double(last_column) : no_index, false);
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
