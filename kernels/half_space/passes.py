"""A search of the half-space solver makes these passes over all cells.

`native/half_space/search.h` and `extension.h` beside it have their loops, `windows.h` those by which fields
move between the grid of a search and others: a larger grid, and cells twice as wide.
"""

import warp as wp

from warpwear.kernels import contact
from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.certificate import Proven
from warpwear.kernels.half_space.solve import RowGroup, Solve, Streaks, native_pass, own_pass

#: Rows of a slot of `extend` and `gather`.
ROWS = 16


#: Sum up cells, gap − mean and its square of every group; find the lowest gap.
moments = native_pass("moments", solve=Solve)
#: Make the trial pressure of springs under the gap, and sum it up as `carried` does.
springs = native_pass("springs", solve=Solve)
#: Sum up the trial, shifted and clipped, and the cells between the bounds.
carried = native_pass("carried<false>", solve=Solve)
#: Make the trial, shifted and clipped, the pressure.
take = native_pass("carried<true>", solve=Solve)
#: Bring pressures down to caps that may have fallen.
bound = own_pass("bound", solve=Solve)
#: Find what yields of a body that the pressure, or the step, passes along x.
streak = own_pass("streak", solve=Solve, streaks=Streaks, of_step=wp.bool)
#: Add the mean along x of what yields so to the response.
add_streaks = own_pass("add_streaks", solve=Solve, streaks=Streaks)
#: Add what compliances of each cell make of the pressure to its response.
yield_to_pressure = own_pass("yield<false>", solve=Solve)
#: Add what compliances of each cell make of the step to its response.
yield_to_step = own_pass("yield<true>", solve=Solve)
#: Give each cell the share in the preconditioner that its compliance leaves it.
weigh = own_pass("weigh", solve=Solve)
#: Make the gradient of the present pressure from its response.
gradient = native_pass("gradient", solve=Solve)
#: Go along the step, or take the trial; sum up and bound what that leaves.
advance = native_pass("advance", solve=Solve)
#: Give the preconditioner the gradient of the free cells.
residual = native_pass("residual", solve=Solve)
#: Count cells between the bounds, and the ends of their lines, in some rows.
scatter = native_pass("scatter", solve=Solve)
#: Sum up products of descent, gradient, last step and its response.
products = native_pass("products", solve=Solve)
#: Make the trial pressure of a step, and sum it up as `carried` does.
direction = native_pass("direction", solve=Solve)
#: Make the feasible step to the trial; sum up its slope and how much room it uses.
step = native_pass("step", solve=Solve)
#: Sum up step × response.
curvature = native_pass("curvature", solve=Solve)
#: Extend the gradient of the free cells to the others, in the trial, on a CPU. A slot is `ROWS` rows.
extend = native_pass("extend<false>", solve=Solve)
#: Add to the free cells what the others give back; the transpose of `extend`, on a CPU.
gather = native_pass("extend<true>", solve=Solve)
#: On a GPU: make one of the passes 0 and 1, which extend the trial, or 2 to 4, which gather it.
extend_once = native_pass("extend_once", solve=Solve, number=wp.int32)


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
    first: wp.array(dtype=wp.int32)  # row of the one before, vector, and row of the last where it begins
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
take_window = native_pass("copy_window<false>", transfer=Transfer)
#: Copy a field of a window to where it lies in the larger grid.
give_window = native_pass("copy_window<true>", transfer=Transfer)
#: Start from the pressure of a place in the last lap, or from where that leads to.
take_lap = native_pass("take_lap", lap=Lap)
#: Give cells twice as wide the means of four, or of fewer at an edge; no surface where one has none.
restrict = native_pass("restrict_cells", transfer=Transfer)
#: Give each cell the value of the wide cell that it lies in.
prolong = native_pass("prolong_cells", transfer=Transfer)
#: Find the extents of the cells that a contact reaches; the first ones negated.
extents = native_pass("extents", reach=ContactReach)
#: The gap of unworn bodies, with which searches begin: alone it would compile Warp's headers again.
unworn_gap = native_pass("gap_under_ball", **contact.OF_GAP)
