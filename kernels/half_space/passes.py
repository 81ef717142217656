"""The passes over all cells of a search of the half-space solver.

`native/half_space/search.h` and `extension.h` beside it have their loops.
"""

from typing import Any

from warpwear.kernels import native_code
from warpwear.kernels.half_space.solve import TOGETHER, Solve


def _a_pass(name: str, call: str = "") -> Any:
    return native_code.a_pass(name, call or f"{name}(slot, slots, it);", Solve, module=TOGETHER)


#: Sum up cells, gap − mean and its square of every group; find the lowest gap.
moments = _a_pass("moments")
#: Make the trial pressure of springs under the gap, and sum it up as `carried` does.
springs = _a_pass("springs")
#: Sum up the trial, shifted and clipped, and the cells between the bounds.
carried = _a_pass("carried", "carried(slot, slots, it, false);")
#: Make the trial, shifted and clipped, the pressure.
take = _a_pass("take", "carried(slot, slots, it, true);")
#: Bring pressures down to caps that may have fallen.
bound = _a_pass("bound")
#: Make the gradient of the present pressure from its response.
gradient = _a_pass("gradient")
#: Go along the step, or take the trial; sum up and bound what that leaves.
advance = _a_pass("advance")
#: Give the preconditioner the gradient of the free cells.
residual = _a_pass("residual")
#: Count cells between the bounds, and the ends of their lines, in some rows.
scatter = _a_pass("scatter")
#: Sum up products of descent, gradient, last step and its response.
products = _a_pass("products")
#: Make the trial pressure of a step, and sum it up as `carried` does.
direction = _a_pass("direction")
#: Make the feasible step to the trial; sum up its slope and how much room it uses.
step = _a_pass("step")
#: Sum up step × response.
curvature = _a_pass("curvature")

#: Rows of a slot of `extend` and `gather`.
ROWS = 16
#: Extend the gradient of the free cells to the others, in the trial, on a CPU. A slot is `ROWS` rows.
extend = _a_pass("extend", "extend<false>(slot, it);")
#: Add to the free cells what the others give back; the transpose of `extend`, on a CPU.
gather = _a_pass("gather", "extend<true>(slot, it);")
#: On a GPU: passes 0 and 1 extend the trial, 2 to 4 gather it.
extend_once = [_a_pass(f"extend_{n}", f"extend_once(slot, slots, it, {n});") for n in range(5)]
