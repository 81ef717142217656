"""The gap between a sphere (or rigid flat) and a rough disc, and its bounds."""

import warp as wp

from warpwear.kernels.cells import ABSENT, LANES, ONE, TILE_VECTORS, ZERO, Cells

wp.set_module_options({"enable_backward": False})


@wp.func
def sag(x: wp.float64, y: wp.float64, curvature: wp.float64):
    """Height of the sphere over its apex. Written so that neither a small r nor a flat loses digits."""
    r2 = x * x + y * y
    under_root = ONE - r2 * curvature * curvature
    return wp.where(under_root > ZERO, r2 * curvature / (ONE + wp.sqrt(wp.max(under_root, ZERO))), ABSENT)


@wp.kernel
def gap(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    columns: wp.int32,
    cell: wp.float64,
    x_first: wp.float64,
    y_first: wp.float64,
    curvature: wp.float64,
    roughness_in: wp.array2d(dtype=Cells),
    gap_out: wp.array2d(dtype=Cells),
    unworn_out: wp.array2d(dtype=Cells),
):
    """Gap of the unworn bodies from the mean planes, twice: sag − roughness of the disc."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    x = x_first + wp.float64(row) * cell
    for k in range(slot % slots_per_row, gap_out.shape[1], slots_per_row):
        z = roughness_in[row, k]
        g = Cells(ABSENT)
        for j in range(LANES):
            column = k * LANES + j
            y = y_first + wp.float64(column) * cell
            if column < columns:
                g[j] = sag(x, y, curvature) - z[j]
        gap_out[row, k] = g
        unworn_out[row, k] = g


@wp.kernel
def bounds(
    first_slot: wp.int32,
    slots_per_row: wp.int32,
    tiles_in: wp.array2d(dtype=wp.int32),
    count_in: wp.array(dtype=wp.int32),
    gap_in: wp.array2d(dtype=Cells),
    extremes_out: wp.array2d(dtype=wp.float64),
):
    """Smallest and largest gap of the tiles visited; places without a surface do not count."""
    slot = first_slot + wp.tid()
    row = slot // slots_per_row
    low = Cells(ABSENT)
    high = Cells(-ABSENT)
    for n in range(slot % slots_per_row, count_in[row], slots_per_row):
        t = tiles_in[row, n]
        for k in range(t * TILE_VECTORS, wp.min((t + 1) * TILE_VECTORS, gap_in.shape[1])):
            g = gap_in[row, k]
            there = Cells(-ABSENT)
            for j in range(LANES):
                there[j] = wp.where(g[j] < ABSENT / wp.float64(2.0), g[j], -ABSENT)
            low = wp.min(low, g)
            high = wp.max(high, there)
    extremes_out[0, slot] = wp.min(low)
    extremes_out[1, slot] = wp.max(high)
