"""The loop of `removal.remove` over the cells of a slot, in C++.

It keeps up to fifteen sums and maxima. Of vectors in Python's notation the compiler keeps five in SIMD
registers: the time is 1 ns a cell, not 4 (measure with bench/speed.py after a change). Each line is written
once for all devices.
"""

import warp as wp

from warpwear.kernels.cells import Cells

wp.set_module_options({"enable_backward": False})

#: `Lanes` are the eight cells of a vector on a CPU, on a GPU one cell after another.
LANES_IN_C = """
#if defined(__CUDA_ARCH__)
    typedef double Lanes;
    typedef double Stored;
    typedef long long Counts;
    const auto size_of = [](double v) { return fabs(v); };
    const auto fetch = [](const Stored*) {};
#else
    typedef double Lanes __attribute__((ext_vector_type(8)));
    typedef double Stored __attribute__((ext_vector_type(8), aligned(8)));
    typedef long long Counts __attribute__((ext_vector_type(8)));
    const auto size_of = [](Lanes v) { return __builtin_elementwise_abs(v); };
    const auto fetch = [](const Stored* place) { __builtin_prefetch(place, 1); };
#endif
    const int lanes = sizeof(Lanes) / sizeof(double);
    const Lanes zero = 0.0;
    const Counts no = 0, yes = 1;
    const auto total = [&](const Lanes& v) {
        double sum = 0.0;
        for (int j = 0; j < lanes; ++j) sum += ((const double*)&v)[j];
        return sum;
    };
    const auto count = [&](const Counts& v) {
        long long sum = 0;
        for (int j = 0; j < lanes; ++j) sum += ((const long long*)&v)[j];
        return double(sum);
    };
    const auto most = [&](const Lanes& v) {
        double top = ((const double*)&v)[0];
        for (int j = 1; j < lanes; ++j) top = wp::max(top, ((const double*)&v)[j]);
        return top;
    };
"""

#: Every cell of a slot.
_WEAR = """
    Lanes pressure = 0.0, factored = 0.0, deviation = 0.0, highest = 0.0;
    Lanes worn = 0.0, worn_sphere = 0.0, deepest = 0.0, deepest_sphere = 0.0, deepest_disc = 0.0;
    Lanes pressure_next = 0.0, slope_next = 0.0, nearest_next = 1.0e30;
    Counts contact = 0, capped = 0, touched = 0, between_next = 0;

    // Rows lie in one piece each.
    const Stored* const stiffness = (const Stored*)&wp::index(stiffness_in, stiffness_row, 0);
    const Stored* const stiffness_next = (const Stored*)&wp::index(stiffness_next_in, next_row, 0);
    const Stored* const factor = (const Stored*)&wp::index(distance_factor_in, factor_row, 0);
    const Stored* const share = (const Stored*)&wp::index(share_in, share_row, 0);
    const Stored* const unworn = (const Stored*)&wp::index(unworn_in, row, 0);
    Stored* const gap = (Stored*)&wp::index(gap_out, row, 0);
    const int* const tiles = &wp::index(tiles_in, row, 0);
    const int of_tile = 32 / lanes, of_row = gap_out.shape[1] * 8 / lanes;
    const int listed = wp::index(count_in, row);
    for (int n = lane; n < listed; n += slots_per_row) {
        const int first = tiles[n] * of_tile, last = wp::min(first + of_tile, of_row);
        for (int i = first; i < last; ++i) {
#if !defined(__CUDA_ARCH__)
            #pragma clang fp contract(fast)
#endif
            fetch(gap + i + 16);  // a fifth of the time, where fields do not fit the cache
            fetch(unworn + i + 16);
            Lanes g = gap[i];
            Lanes p = ((base - g) + (offset - tie_width)) * stiffness[i];
            p = p > zero ? p : zero;
            p = p < cap ? p : cap;
            if (tie_width > 0.0)
                p = size_of((base - g) + offset) > tie_width ? p : tie_pressure;
            g += (removal_sphere + removal_disc * factor[i]) * p;
            gap[i] = g;
            pressure += p;
            highest = highest > p ? highest : p;
            Lanes d = p > zero ? p - pressure_reference : zero;
            deviation += d * d;
            contact += p > zero ? yes : no;
            capped += p >= cap ? yes : no;

            Lanes w = g - unworn[i];
            touched += p > zero || w > zero ? yes : no;
            worn += w;
            if (alike) {
                deepest = deepest > w ? deepest : w;
            } else {
                Lanes a = share[i] * w, b = w - a;
                factored += factor[i] * p;
                worn_sphere += a;
                deepest_sphere = deepest_sphere > a ? deepest_sphere : a;
                deepest_disc = deepest_disc > b ? deepest_disc : b;
            }

            Lanes r = ((base_next - g) + offset_next) * stiffness_next[i];
            Lanes q = r > zero ? r : zero;
            q = q < cap ? q : cap;
            pressure_next += q;
            if (alike)
                between_next += r == q ? yes : no;
            else
                slope_next += r == q ? (Lanes)stiffness_next[i] : zero;
            Lanes open = size_of(r), full = size_of(r - cap);
            Lanes near = open < full ? open : full;
            nearest_next = nearest_next < near ? nearest_next : near;
        }
    }

    const auto first_of = [](const wp::vec_t<8, double>& v) { return v[0]; };
    const double part = alike ? first_of(wp::index(share_in, share_row, 0)) : 0.0;
    const double sphere = alike ? part * total(worn) : total(worn_sphere);
    const double depth = most(deepest);
    wp::index(sums_out, 0, slot) = total(pressure);
    wp::index(sums_out, 1, slot) = alike ? total(pressure) : total(factored);
    wp::index(sums_out, 2, slot) = total(deviation);
    wp::index(sums_out, 3, slot) = count(contact);
    wp::index(sums_out, 4, slot) = count(capped);
    wp::index(sums_out, 5, slot) = count(touched);
    wp::index(sums_out, 6, slot) = sphere;
    wp::index(sums_out, 7, slot) = total(worn) - sphere;
    wp::index(maxima_out, 0, slot) = most(highest);
    wp::index(maxima_out, 1, slot) = alike ? part * depth : most(deepest_sphere);
    wp::index(maxima_out, 2, slot) = alike ? depth - part * depth : most(deepest_disc);
    wp::index(ahead_out, 0, slot) = total(pressure_next);
    wp::index(ahead_out, 1, slot) =
        alike ? first_of(wp::index(stiffness_next_in, next_row, 0)) * count(between_next) : total(slope_next);
    wp::index(ahead_out, 2, slot) = -most(-nearest_next);
"""


@wp.func_native(LANES_IN_C + _WEAR)
def wear(
    slot: wp.int32,
    slots_per_row: wp.int32,
    row: wp.int32,
    lane: wp.int32,
    stiffness_row: wp.int32,
    next_row: wp.int32,
    factor_row: wp.int32,
    share_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    base: wp.float64,
    offset: wp.float64,
    cap: wp.float64,
    tie_width: wp.float64,
    tie_pressure: wp.float64,
    removal_sphere: wp.float64,
    removal_disc: wp.float64,
    pressure_reference: wp.float64,
    base_next: wp.float64,
    offset_next: wp.float64,
    alike: wp.int32,
    stiffness_in: wp.array2d(dtype=Cells),
    stiffness_next_in: wp.array2d(dtype=Cells),
    distance_factor_in: wp.array2d(dtype=Cells),
    share_in: wp.array2d(dtype=Cells),
    unworn_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
    ahead_out: wp.array2d(dtype=wp.float64),
):
    """Wears the tiles listed of a slot and sums up what it finds; arguments as of `remove`."""
    ...


#: Every cell of a slot of patches.
_WEAR_PATCHES = """
    Lanes pressure = 0.0, deviation = 0.0, highest = 0.0, worn = 0.0, deepest = 0.0;
    Lanes pressure_next = 0.0, nearest_next = 1.0e30;
    Counts contact = 0, capped = 0, touched = 0, between_next = 0;
    double beside = 1.0e30;

    // The lines of a patch lie in one piece.
    const Stored* const unworn = (const Stored*)&wp::index(initial_in, patch, 0);
    Stored* const gap = (Stored*)&wp::index(gap_out, patch, 0);
    const double* const lowest = &wp::index(lowest_in, patch, 0);
    const int of_tile = 32 / lanes, of_line = vectors * 8 / lanes;
    const int tiles = (of_line + of_tile - 1) / of_tile, of_patch = lowest_in.shape[1];
    for (int n = lane; n < of_patch; n += slots_per_row) {
        const double low = lowest[n];
        const double overlap_next = (base_next - low) + offset_next;
        if (!(low < reached || (base - low) + offset > 0.0 || overlap_next > 0.0)) {
            beside = wp::min(beside, -overlap_next);
            continue;
        }
        const int line = n / tiles, first = (n - line * tiles) * of_tile;
        const int start = line * of_line + first, end = line * of_line + wp::min(first + of_tile, of_line);
        for (int i = start; i < end; ++i) {
#if !defined(__CUDA_ARCH__)
            #pragma clang fp contract(fast)
#endif
            fetch(gap + i + 16);
            fetch(unworn + i + 16);
            Lanes g = gap[i];
            Lanes p = ((base - g) + offset) * stiffness;
            p = p > zero ? p : zero;
            p = p < cap ? p : cap;
            g += removal * p;
            gap[i] = g;
            pressure += p;
            highest = highest > p ? highest : p;
            Lanes d = p > zero ? p - pressure_reference : zero;
            deviation += d * d;
            contact += p > zero ? yes : no;
            capped += p >= cap ? yes : no;

            Lanes w = g - unworn[i];
            touched += p > zero || w > zero ? yes : no;
            worn += w;
            deepest = deepest > w ? deepest : w;

            Lanes r = ((base_next - g) + offset_next) * stiffness_next;
            Lanes q = r > zero ? r : zero;
            q = q < cap ? q : cap;
            pressure_next += q;
            between_next += r == q ? yes : no;
            Lanes open = size_of(r), full = size_of(r - cap);
            Lanes near = open < full ? open : full;
            nearest_next = nearest_next < near ? nearest_next : near;
        }
    }
    wp::index(sums_out, 0, slot) = total(pressure);
    wp::index(sums_out, 1, slot) = total(deviation);
    wp::index(sums_out, 2, slot) = count(contact);
    wp::index(sums_out, 3, slot) = count(capped);
    wp::index(sums_out, 4, slot) = count(touched);
    wp::index(sums_out, 5, slot) = total(worn);
    wp::index(maxima_out, 0, slot) = most(highest);
    wp::index(maxima_out, 1, slot) = most(deepest);
    wp::index(ahead_out, 0, slot) = total(pressure_next);
    wp::index(ahead_out, 1, slot) = stiffness_next * count(between_next);
    wp::index(ahead_out, 2, slot) = wp::min(-most(-nearest_next), beside * stiffness_next);
"""


@wp.func_native(LANES_IN_C + _WEAR_PATCHES)
def wear_patches(
    slot: wp.int32,
    slots_per_row: wp.int32,
    patch: wp.int32,
    lane: wp.int32,
    vectors: wp.int32,
    base: wp.float64,
    offset: wp.float64,
    reached: wp.float64,
    base_next: wp.float64,
    offset_next: wp.float64,
    cap: wp.float64,
    stiffness: wp.float64,
    stiffness_next: wp.float64,
    removal: wp.float64,
    pressure_reference: wp.float64,
    lowest_in: wp.array2d(dtype=wp.float64),
    initial_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    sums_out: wp.array2d(dtype=wp.float64),
    maxima_out: wp.array2d(dtype=wp.float64),
    ahead_out: wp.array2d(dtype=wp.float64),
):
    """Wears a slot's tiles and sums up what it finds; arguments as of `patches.remove`."""
    ...
