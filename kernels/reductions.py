"""Within a slot: from the lanes of a vector to one number. Across slots the executor's tables are reduced."""

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
