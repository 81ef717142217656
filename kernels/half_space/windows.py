"""What moves fields between the grid of a search and others: a larger grid, and cells twice as wide.

The loops over cells are in `native/half_space/windows.h`.
"""

import warp as wp

from warpwear.kernels import native_code
from warpwear.kernels.cells import Cells
from warpwear.kernels.half_space.certificate import Proven
from warpwear.kernels.half_space.solve import TOGETHER, Group


@wp.struct
class Transfer:
    """A field, and the one of another grid that it goes to."""

    field: wp.array2d(dtype=Cells)
    target: wp.array2d(dtype=Cells)
    columns: wp.int32  # of the finer grid
    first: wp.array(dtype=wp.int32)  # row and vector of the larger grid where the window begins


@wp.struct
class Reach:
    """What a contact reaches: its cells below its approach, and the level of its certificate."""

    gap: wp.array2d(dtype=Cells)
    columns: wp.int32
    groups: wp.array(dtype=Group)
    proven: wp.array(dtype=Proven)
    extents: wp.array2d(dtype=wp.float64)  # first and last row, first and last column; a column a slot


#: Copy what a field of the larger grid holds in a window.
take = native_code.a_pass("take_window", "take_window(slot, slots, it);", Transfer, module=TOGETHER)
#: Copy a field of a window to where it lies in the larger grid.
give = native_code.a_pass("give_window", "give_window(slot, slots, it);", Transfer, module=TOGETHER)
#: Give cells twice as wide the means of four, or of those that there are; no surface where one has none.
restrict = native_code.a_pass("restrict", "restrict_cells(slot, slots, it);", Transfer, module=TOGETHER)
#: Give each cell the value of the wide cell that it lies in.
prolong = native_code.a_pass("prolong", "prolong_cells(slot, slots, it);", Transfer, module=TOGETHER)
#: Find the extents of the cells that a contact reaches; the first ones negated.
extents = native_code.a_pass("extents", "extents(slot, slots, it);", Reach, module=TOGETHER)
