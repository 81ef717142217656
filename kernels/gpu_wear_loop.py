"""The loop of `device_steps.remove` over the cells of a thread, in C++, and what its block makes of it.

In Python's notation the compiler gives each thread some 230 registers, so that too few threads run at a
time to keep the memory busy (measure with bench/speed.py on a GPU after a change). On a CPU a block is one
thread.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

_WEAR = """
    const int FOUR = 4, beyond = 2147483647;
    const double absent = 1.0e30, nowhere = -1.0e9;
    const bool alike = rows == 0 && share_changes == 0;
    const double* const unworn = unworn_in.data;
    const double* const factor = factor_in.data;
    double* const gap = gap_out.data;
    double* const shares = share_out.data;
    double pressure = 0.0, factored = 0.0, deviation = 0.0, worn = 0.0, worn_sphere = 0.0;
    double highest = 0.0, deepest = 0.0, deepest_sphere = 0.0, deepest_disc = 0.0;
    int contact = 0, capped = 0, touched = 0;  // whole numbers cost a GPU less
    int first_row = beyond, last_row = -1, first_column = beyond, last_column = -1;
    double f = 1.0, opening = removal_sphere + removal_disc;  // where no factor differs from 1
    double s = 1.0 / (compliance + implicit * opening);
    double share = opening > 0.0 ? removal_sphere / opening : 0.0;
    const int lines = gap_out.shape[0] / columns;
    for (int row = block; row < lines; row += blocks) {
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
                const long long i = start + column;
                if (rows > 0 && column < columns) {
                    f = factor[rows > 1 ? i : column];
                    opening = removal_sphere + f * removal_disc;
                    s = 1.0 / (compliance + implicit * opening);
                    share = opening > 0.0 ? removal_sphere / opening : 0.0;
                }
                double p = ((base - g[j]) + offset) * s;
                p = p > 0.0 ? p : 0.0;
                p = p < cap ? p : cap;
                const double before = g[j] - u[j], after = g[j] + opening * p, w = after - u[j];
                if (p > 0.0) {
                    gap[i] = after;
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
                    if (alike) {
                        deepest = deepest > w ? deepest : w;
                    } else {
                        if (share_changes > 0) {
                            share = shares[i];
                            if (p > 0.0) {
                                share = w > 0.0 ? (share * before + removal_sphere * p) / w : 0.0;
                                shares[i] = share;
                            }
                        }
                        const double a = share * w, b = w - a;
                        factored += f * p;
                        worn_sphere += a;
                        deepest_sphere = deepest_sphere > a ? deepest_sphere : a;
                        deepest_disc = deepest_disc > b ? deepest_disc : b;
                    }
                }
            }
        }
        if (touched > touched_before) {
            first_row = first_row < row ? first_row : row;
            last_row = row;
        }
    }
    if (alike) {
        factored = pressure;
        worn_sphere = share * worn;
        deepest_sphere = share * deepest;
        deepest_disc = deepest - deepest_sphere;
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
    int line = 0;
    const auto keep = [&](double v, bool adds) {
        v = of_block(v, adds);
        if (lane == 0) wp::index(partial_out, line, block) = v;
        ++line;
    };
    const double sums[] = {pressure, factored, deviation, double(contact), double(capped), double(touched),
                           worn_sphere, worn - worn_sphere};
    const bool some = touched > 0;
    const double maxima[] = {highest, deepest_sphere, deepest_disc,
                             some ? -double(first_row) : nowhere, some ? double(last_row) : nowhere,
                             some ? -double(first_column) : nowhere, some ? double(last_column) : nowhere};
    #pragma unroll
    for (const double sum : sums) keep(sum, true);
    #pragma unroll
    for (const double most : maxima) keep(most, false);
"""


@wp.func_native(_WEAR)
def wear(
    block: wp.int32,
    lane: wp.int32,
    width: wp.int32,
    columns: wp.int32,
    rows: wp.int32,
    compliance: wp.float64,
    implicit: wp.float64,
    cap: wp.float64,
    blocks: wp.int32,
    share_changes: wp.int32,
    removal_sphere: wp.float64,
    removal_disc: wp.float64,
    base: wp.float64,
    offset: wp.float64,
    mean: wp.float64,
    factor_in: wp.array(dtype=wp.float64),
    unworn_in: wp.array(dtype=wp.float64),
    gap_out: wp.array(dtype=wp.float64),
    share_out: wp.array(dtype=wp.float64),
    partial_out: wp.array2d(dtype=wp.float64),
):
    """Wears the cells of a thread, thread `lane` of `width` in a block; arguments as of `remove`."""
    ...
