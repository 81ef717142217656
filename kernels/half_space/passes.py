"""A search of the half-space solver makes these passes over all cells.

`native/half_space/search.h` and `extension.h` beside it have their loops, `windows.h` those by which fields
move between the grid of a search and others: a larger grid, and cells twice as wide.
"""

import warp as wp

from warpwear.kernels import contact
from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.certificate import Proven
from warpwear.kernels.half_space.solve import OWN, TOGETHER, RowGroup, Solve, Streaks
from warpwear.kernels.native_code import native_pass, pass_over

#: Rows of a slot of `extend` and `gather`.
ROWS = 16


#: Sum up cells, gap − mean and its square of every group; find the lowest gap.
moments = pass_over(Solve, "moments", module=TOGETHER)
#: Make the trial pressure of springs under the gap, and sum it up as `carried` does.
springs = pass_over(Solve, "springs", module=TOGETHER)
#: Sum up the trial, shifted and clipped, and the cells between the bounds.
carried = pass_over(Solve, "carried<false>", module=TOGETHER)
#: Make the trial, shifted and clipped, the pressure.
take = pass_over(Solve, "carried<true>", module=TOGETHER)
#: Bring pressures down to caps that may have fallen.
bound = pass_over(Solve, "bound", module=OWN)


@native_pass("streak", module=OWN)
def streak(solve: Solve, streaks: Streaks, of_step: wp.bool):
    """Find what yields of a body that the pressure, or the step, passes along x."""


@native_pass("add_streaks", module=OWN)
def add_streaks(solve: Solve, streaks: Streaks):
    """Add the mean along x of what yields so to the response."""


#: Add what compliances of each cell make of the pressure to its response.
yield_to_pressure = pass_over(Solve, "yield<false>", module=OWN)
#: Add what compliances of each cell make of the step to its response.
yield_to_step = pass_over(Solve, "yield<true>", module=OWN)
#: Give each cell the share in the preconditioner that its compliance leaves it.
weigh = pass_over(Solve, "weigh", module=OWN)
#: Make the gradient of the present pressure from its response.
gradient = pass_over(Solve, "gradient", module=TOGETHER)
#: Go along the step, or take the trial; sum up and bound what that leaves.
advance = pass_over(Solve, "advance", module=TOGETHER)
#: Give the preconditioner the gradient of the free cells.
residual = pass_over(Solve, "residual", module=TOGETHER)
#: Count cells between the bounds, and the ends of their lines, in some rows.
scatter = pass_over(Solve, "scatter", module=TOGETHER)
#: Sum up products of descent, gradient, last step and its response.
products = pass_over(Solve, "products", module=TOGETHER)
#: Make the trial pressure of a step, and sum it up as `carried` does.
direction = pass_over(Solve, "direction", module=TOGETHER)
#: Make the feasible step to the trial; sum up its slope and how much room it uses.
step = pass_over(Solve, "step", module=TOGETHER)
#: Sum up step × response.
curvature = pass_over(Solve, "curvature", module=TOGETHER)
#: Extend the gradient of the free cells to the others, in the trial, on a CPU. A slot is `ROWS` rows.
extend = pass_over(Solve, "extend<false>", module=TOGETHER)
#: Add to the free cells what the others give back; the transpose of `extend`, on a CPU.
gather = pass_over(Solve, "extend<true>", module=TOGETHER)


@native_pass("extend_once", module=TOGETHER)
def extend_once(solve: Solve, number: wp.int32):
    """On a GPU: make one of the passes 0 and 1, which extend the trial, or 2 to 4, which gather it."""


@wp.struct
class Transfer:
    """Holds a field, and the one of another grid that it goes to."""

    field: wp.array2d(dtype=Cells)
    target: wp.array2d(dtype=Cells)
    columns: wp.int32  # of the finer grid
    first: wp.array(dtype=wp.int32)  # row and vector of the larger grid where the window begins


@wp.struct
class Lap:
    """Holds pressures of the places of a lap, of the last one and of the one before."""

    laps: wp.array2d(dtype=Cells)  # [MPa]
    pressure: wp.array2d(dtype=Cells)  # in a window [MPa]
    first: wp.array(dtype=wp.int32)  # row of the last, vector, and row of the one before where it begins
    ahead: wp.array(dtype=wp.float64)  # distance from the last lap on, over that between both; one number
    cap: wp.float64  # [MPa]


@wp.struct
class ContactReach:
    """Tells what a contact reaches: its cells below its approach, and the level of its certificate."""

    gap: wp.array2d(dtype=Cells)
    columns: wp.int32
    groups: wp.array(dtype=RowGroup)
    proven: wp.array(dtype=Proven)
    extents: wp.array2d(dtype=wp.float64)  # first and last row, first and last column; a column a slot


#: Copy what a field of the larger grid holds in a window.
take_window = pass_over(Transfer, "take_window", module=TOGETHER)
#: Copy a field of a window to where it lies in the larger grid.
give_window = pass_over(Transfer, "give_window", module=TOGETHER)
#: Start from the pressure of a place in the last lap, or from where that leads to.
take_lap = pass_over(Lap, "take_lap", module=TOGETHER)
#: Keep the pressure of a place instead of that of the lap before the last.
keep_lap = pass_over(Lap, "keep_lap", module=TOGETHER)
#: Give cells twice as wide the means of four, or of fewer at an edge; no surface where one has none.
restrict = pass_over(Transfer, "restrict_cells", module=TOGETHER)
#: Give each cell the value of the wide cell that it lies in.
prolong = pass_over(Transfer, "prolong_cells", module=TOGETHER)
#: Find the extents of the cells that a contact reaches; the first ones negated.
extents = pass_over(ContactReach, "extents", module=TOGETHER)
#: The gap of unworn bodies, with which searches begin: alone it would compile Warp's headers again.
unworn_gap = wp.Kernel(contact.gap.func, key="unworn_gap", module=TOGETHER, source=contact.gap.adj.source)
