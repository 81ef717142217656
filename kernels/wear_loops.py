"""The loops of `wear.wear_step` and `patches.wear_step` over the cells of a slot, in C++.

They keep up to eleven sums and maxima. Of vectors in Python's notation the compiler keeps five in SIMD
registers: the time is 1 ns a cell, not 4 (measure with bench/speed.py after a change). Each line is written
once for all devices.
"""

import warp as wp

from warpwear.kernels.cells import Cells, WearMost, WearSum
from warpwear.kernels.contact import Law

wp.set_module_options({"enable_backward": False})


@wp.struct
class Increment:
    """What a step wears off one gap, and where the next one will look first."""

    wear_per_pressure: wp.float64  # K ΔL of both bodies [mm³/N]
    stiffness: wp.float64  # 1/c of the step [N/mm³]
    reference: wp.float64  # squares are those of the deviation from it: near the mean they keep digits [MPa]
    base_next: wp.float64  # approach of the next step [mm], of patches one each in `Approaches`
    offset_next: wp.float64
    stiffness_next: wp.float64
    #: Rows and columns between which cells are known to be touched: extents are looked for beyond them only.
    first_row: wp.int32
    last_row: wp.int32
    first_column: wp.int32
    last_column: wp.int32


@wp.struct
class Tables:
    """Tables of partial results, one column a slot."""

    sums: wp.array2d(dtype=wp.float64)  # rows of `WearSum`
    maxima: wp.array2d(dtype=wp.float64)  # rows of `WearMost`
    ahead: wp.array2d(dtype=wp.float64)  # what `carried` would find in the worn gap at the next approach


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
#if defined(__CUDA_ARCH__)
    const auto count = [&](Counts v) { return double(v); };
    const auto most = [&](Lanes v) { return v; };
#else
    const auto count = [&](Counts v) { return double(__builtin_reduce_add(v)); };
    const auto most = [&](Lanes v) {  // by halves: the built-in reduction minds NaN and takes thrice as long
        Lanes w = __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
        v = v > w ? v : w;
        w = __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5);
        v = v > w ? v : w;
        return v[0] > v[1] ? v[0] : v[1];
    };
#endif
"""

#: What the loops share: their sums, a cell, and where the sums go.
_BEGIN = """
    const double cap = law.cap;
    const Lanes cap_of_all = cap;
    const double wear_per_pressure = step.wear_per_pressure, reference = step.reference;
    const double stiffness = step.stiffness, stiffness_next = step.stiffness_next;
    Lanes pressure = 0.0, deviation = 0.0, highest = 0.0, worn = 0.0, deepest = 0.0;
    Lanes pressure_next = 0.0, nearest_next = 1.0e30;
    Counts contact = 0, capped = 0, touched = 0, between_next = 0;
"""
_CELL = """
#if !defined(__CUDA_ARCH__)
            #pragma clang fp contract(fast)
#endif
            fetch(gap + i + 16);  // a fifth of the time, where fields do not fit the cache
            fetch(unworn + i + 16);
            Lanes g = gap[i];
            Lanes p = ((base - g) + (offset - tie_width)) * stiffness;
            p = p > zero ? p : zero;
            const Lanes most_here = parts ? cap * parts[i] : cap_of_all;
            p = p < most_here ? p : most_here;
            if (tie_width > 0.0)
                p = size_of((base - g) + offset) > tie_width ? p : tie_pressure;
            g += wear_per_pressure * p;
            gap[i] = g;
            pressure += p;
            highest = highest > p ? highest : p;
            Lanes d = p > zero ? p - reference : zero;
            deviation += d * d;
            contact += p > zero ? yes : no;
            capped += p >= most_here ? yes : no;

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
"""
_END = f"""
    wp::index(tables.sums, {WearSum.PRESSURE.value}, slot) = total(pressure);
    wp::index(tables.sums, {WearSum.DEVIATION_SQUARED.value}, slot) = total(deviation);
    wp::index(tables.sums, {WearSum.CONTACT.value}, slot) = count(contact);
    wp::index(tables.sums, {WearSum.CAPPED.value}, slot) = count(capped);
    wp::index(tables.sums, {WearSum.TOUCHED.value}, slot) = count(touched);
    wp::index(tables.sums, {WearSum.WORN.value}, slot) = total(worn);
    wp::index(tables.maxima, {WearMost.PRESSURE.value}, slot) = most(highest);
    wp::index(tables.maxima, {WearMost.WORN.value}, slot) = most(deepest);
    wp::index(tables.ahead, 0, slot) = total(pressure_next);
    wp::index(tables.ahead, 1, slot) = stiffness_next * count(between_next);
    wp::index(tables.ahead, 2, slot) = wp::min(-most(-nearest_next), beside);
"""

#: Every cell of the tiles that a row lists.
_WEAR = """
    const int row = slot / slots_per_row, lane = slot % slots_per_row;
    const double base = law.base, offset = law.offset;
    const double tie_width = law.tie_width, tie_pressure = law.tie_pressure;
    const double base_next = step.base_next, offset_next = step.offset_next, beside = 1.0e30;
    // Rows lie in one piece each.
    const Stored* const unworn = (const Stored*)&wp::index(unworn_in, row, 0);
    Stored* const gap = (Stored*)&wp::index(gap_out, row, 0);
    const Stored* const parts = nullptr;  // one gap has one cap
    const int* const tiles = &wp::index(tiles_in, row, 0);
    const int of_tile = 32 / lanes, of_row = gap_out.shape[1] * 8 / lanes;
    const int listed = wp::index(count_in, row);
    for (int n = lane; n < listed; n += slots_per_row) {
        const int first = tiles[n] * of_tile, last = wp::min(first + of_tile, of_row);
        for (int i = first; i < last; ++i) {
"""


@wp.func_native(LANES_IN_C + _BEGIN + _WEAR + _CELL + "}}" + _END)
def wear(
    slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    law: Law,
    step: Increment,
    unworn_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    tables: Tables,
):
    """Wears the tiles listed of a slot and sums up what it finds; arguments as of `wear.wear_step`."""
    ...
