"""The loop of `patches.remove` over the cells of a slot, in C++; see `wear_loop`, its like on one grid."""

import warp as wp

from warpwear.kernels.lanes import LANES_IN_C
from warpwear.kernels.types import Cells

wp.set_module_options({"enable_backward": False})

#: Every cell of a slot.
_WEAR = """
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


@wp.func_native(LANES_IN_C + _WEAR)
def wear(
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
