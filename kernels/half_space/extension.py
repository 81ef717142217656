"""The passes that extend values of free cells to others, for the preconditioner; see `native/half_space/extension.h`.

On a CPU `extend` and `gather` do that tile by tile, on a GPU `extend_once` in five passes.
"""

import warp as wp

from warpwear.kernels.half_space.solve import TOGETHER, Solve

#: Rows of a slot of `extend` and `gather`.
ROWS = 16
#: Weights of neighbours along x, along y and across corners.
Weights = wp.types.vector(3, wp.float32)


@wp.func_native("extend<false>(slot, solve);")
def _extend(slot: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def extend(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Extend the gradient of the free cells to the others, in the trial. A slot is `ROWS` rows, on a CPU."""
    _extend(first_slot + wp.tid(), solve)


@wp.func_native("extend<true>(slot, solve);")
def _gather(slot: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def gather(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Add to the free cells what the others give back; the transpose of `extend`, on a CPU."""
    _gather(first_slot + wp.tid(), solve)


@wp.func_native("extend_once(slot, slots, solve, number);")
def _extend_once(slot: wp.int32, slots: wp.int32, solve: Solve, number: wp.int32): ...


@wp.kernel(module=TOGETHER)
def extend_once(first_slot: wp.int32, slots: wp.int32, solve: Solve, number: wp.int32):
    """Make one of the passes 0 and 1, which extend the trial, or 2 to 4, which gather it."""
    _extend_once(first_slot + wp.tid() // wp.block_dim(), slots, solve, number)
