"""Within a slot: from the lanes of a vector to one number. Across slots the executor's tables are reduced.

And the other way round: what a row has from a table of rows.
"""

import warp as wp

from warpwear.kernels.types import LANES, ZERO, Cells

wp.set_module_options({"enable_backward": False})


@wp.func
def sum_of(v: Cells):
    """Sum of the lanes."""
    total = ZERO
    for j in range(LANES):
        total += v[j]
    return total


@wp.func
def lowest_of(v: Cells):
    """Smallest of the lanes, pair by pair: one after another it takes twice as long."""
    return wp.min(
        wp.min(wp.min(v[0], v[1]), wp.min(v[2], v[3])),
        wp.min(wp.min(v[4], v[5]), wp.min(v[6], v[7])),
    )


@wp.func
def largest_of(v: Cells):
    """Largest of the lanes, pair by pair."""
    return wp.max(
        wp.max(wp.max(v[0], v[1]), wp.max(v[2], v[3])),
        wp.max(wp.max(v[4], v[5]), wp.max(v[6], v[7])),
    )


@wp.func
def of_row(values: wp.array(dtype=wp.float64), row: wp.int32):
    """The value of a row, or the one value that all rows share."""
    return values[wp.min(row, values.shape[0] - 1)]
