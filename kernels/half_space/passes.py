"""A search of the half-space solver makes these passes over all cells.

`native/half_space/search.h` and `extension.h` beside it have their loops, `windows.h` those by which fields
move between the grid of a search and others: a larger grid, and cells twice as wide.
"""

import warp as wp

from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.certificate import Proven
from warpwear.kernels.half_space.solve import TOGETHER, RowGroup, Solve, Streaks
from warpwear.kernels.native_code import native_pass

#: Rows of a slot of `extend` and `gather`.
ROWS = 16


@native_pass("moments", module=TOGETHER)
def moments(solve: Solve):
    """Sum up cells, gap − mean and its square of every group; find the lowest gap."""


@native_pass("springs", module=TOGETHER)
def springs(solve: Solve):
    """Make the trial pressure of springs under the gap, and sum it up as `carried` does."""


@native_pass("carried<false>", module=TOGETHER)
def carried(solve: Solve):
    """Sum up the trial, shifted and clipped, and the cells between the bounds."""


@native_pass("carried<true>", module=TOGETHER)
def take(solve: Solve):
    """Make the trial, shifted and clipped, the pressure."""


@native_pass("bound", module=TOGETHER)
def bound(solve: Solve):
    """Bring pressures down to caps that may have fallen."""


@native_pass("streak", module=TOGETHER)
def streak(solve: Solve, streaks: Streaks, of_step: wp.bool):
    """Find what yields of a body that the pressure, or the step, passes along x."""


@native_pass("add_streaks", module=TOGETHER)
def add_streaks(solve: Solve, streaks: Streaks):
    """Add the mean along x of what yields so to the response."""


@native_pass("yield<false>", module=TOGETHER)
def yield_to_pressure(solve: Solve):
    """Add what compliances of each cell make of the pressure to its response."""


@native_pass("yield<true>", module=TOGETHER)
def yield_to_step(solve: Solve):
    """Add what compliances of each cell make of the step to its response."""


@native_pass("weigh", module=TOGETHER)
def weigh(solve: Solve):
    """Give each cell the share in the preconditioner that its compliance leaves it."""


@native_pass("gradient", module=TOGETHER)
def gradient(solve: Solve):
    """Make the gradient of the present pressure from its response."""


@native_pass("advance", module=TOGETHER)
def advance(solve: Solve):
    """Go along the step, or take the trial; sum up and bound what that leaves."""


@native_pass("residual", module=TOGETHER)
def residual(solve: Solve):
    """Give the preconditioner the gradient of the free cells."""


@native_pass("scatter", module=TOGETHER)
def scatter(solve: Solve):
    """Count cells between the bounds, and the ends of their lines, in some rows."""


@native_pass("products", module=TOGETHER)
def products(solve: Solve):
    """Sum up products of descent, gradient, last step and its response."""


@native_pass("direction", module=TOGETHER)
def direction(solve: Solve):
    """Make the trial pressure of a step, and sum it up as `carried` does."""


@native_pass("step", module=TOGETHER)
def step(solve: Solve):
    """Make the feasible step to the trial; sum up its slope and how much room it uses."""


@native_pass("curvature", module=TOGETHER)
def curvature(solve: Solve):
    """Sum up step × response."""


@native_pass("extend<false>", module=TOGETHER)
def extend(solve: Solve):
    """Extend the gradient of the free cells to the others, in the trial, on a CPU. A slot is `ROWS` rows."""


@native_pass("extend<true>", module=TOGETHER)
def gather(solve: Solve):
    """Add to the free cells what the others give back; the transpose of `extend`, on a CPU."""


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
    """Holds pressures of the places of a lap, those of the last above those of the one before."""

    laps: wp.array2d(dtype=Cells)  # [MPa]
    rows: wp.int32  # of a place, of each lap
    pressure: wp.array2d(dtype=Cells)  # in a window [MPa]
    first: wp.array(dtype=wp.int32)  # row and vector among laps where the window begins
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


@native_pass("take_window", module=TOGETHER)
def take_window(transfer: Transfer):
    """Copy what a field of the larger grid holds in a window."""


@native_pass("give_window", module=TOGETHER)
def give_window(transfer: Transfer):
    """Copy a field of a window to where it lies in the larger grid."""


@native_pass("take_lap", module=TOGETHER)
def take_lap(lap: Lap):
    """Start from the pressure of a place in the last lap, or from where that leads to."""


@native_pass("keep_lap", module=TOGETHER)
def keep_lap(lap: Lap):
    """Keep the pressure of a place, and that of the lap before."""


@native_pass("restrict_cells", module=TOGETHER)
def restrict(transfer: Transfer):
    """Give cells twice as wide the means of four, or of fewer at an edge; no surface where one has none."""


@native_pass("prolong_cells", module=TOGETHER)
def prolong(transfer: Transfer):
    """Give each cell the value of the wide cell that it lies in."""


@native_pass("extents", module=TOGETHER)
def extents(reach: ContactReach):
    """Find the extents of the cells that a contact reaches; the first ones negated."""
