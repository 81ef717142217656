"""The passes over all cells of a search of the half-space solver; `native/half_space/search.h` says what each does."""

import warp as wp

from warpwear.kernels.half_space.solve import TOGETHER, Solve


@wp.func_native("moments(slot, slots, solve);")
def _moments(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def moments(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Sum up cells, gap − mean and its square of every group; find the lowest gap."""
    _moments(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("springs(slot, slots, solve);")
def _springs(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def springs(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Make the trial pressure of springs under the gap, and sum it up as `carried` does."""
    _springs(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("carried(slot, slots, solve, false);")
def _carried(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def carried(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Sum up the trial, shifted and clipped, and the cells between the bounds."""
    _carried(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("carried(slot, slots, solve, true);")
def _take(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def take(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Make the trial, shifted and clipped, the pressure."""
    _take(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("bound(slot, slots, solve);")
def _bound(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def bound(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Bring pressures down to caps that may have fallen."""
    _bound(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("gradient(slot, slots, solve);")
def _gradient(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def gradient(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Make the gradient of the present pressure from its response."""
    _gradient(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("advance(slot, slots, solve);")
def _advance(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def advance(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Go along the step, or take the trial; sum up and bound what that leaves."""
    _advance(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("residual(slot, slots, solve);")
def _residual(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def residual(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Give the preconditioner the gradient of the free cells."""
    _residual(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("scatter(slot, slots, solve);")
def _scatter(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def scatter(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Count cells between the bounds, and the ends of their lines, in some rows."""
    _scatter(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("products(slot, slots, solve);")
def _products(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def products(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Sum up products of descent, gradient, last step and its response."""
    _products(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("direction(slot, slots, solve);")
def _direction(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def direction(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Make the trial pressure of a step, and sum it up as `carried` does."""
    _direction(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("step(slot, slots, solve);")
def _step(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def step(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Make the feasible step to the trial; sum up its slope and how much room it uses."""
    _step(first_slot + wp.tid() // wp.block_dim(), slots, solve)


@wp.func_native("curvature(slot, slots, solve);")
def _curvature(slot: wp.int32, slots: wp.int32, solve: Solve): ...


@wp.kernel(module=TOGETHER)
def curvature(first_slot: wp.int32, slots: wp.int32, solve: Solve):
    """Sum up step × response."""
    _curvature(first_slot + wp.tid() // wp.block_dim(), slots, solve)
