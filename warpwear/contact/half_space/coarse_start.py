"""A contact of many cells begins with the pressure on cells twice as wide, which is solved roughly.

The gap of a wide cell is the mean of its four, so that the long waves are those of the fine grid, and its
pressure is that of all four. A pair of transforms costs a quarter there, and what a search spends on the long
waves, which decide where load goes, it then need not spend on the fine grid.
"""

from typing import Any

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import launch_once
from warpwear.grid import Grid
from warpwear.kernels.half_space import windows

#: Cells along each side of a grid from which wide ones pay.
LEAST_SIDE = 256
#: On a GPU, where a solve on wide cells takes a graph of its own, once.
LEAST_SIDE_ON_GPU = 4096
#: Fields of the fine grid that a solver on wide cells, and those that it starts from, take of a GPU.
FIELDS_ON_GPU = 6.0
#: Fields that a search on a GPU takes for itself afterwards.
FIELDS_OF_SEARCH = 10.0
#: Tolerance of the contact on wide cells, as of `solver.BoundedPressure`.
TOLERANCE = 1.0e-3
MAX_ITERATIONS = 100


def is_worth_it(executor: Executor) -> bool:
    """Tell whether wide cells make a solve shorter, and there is room for them."""
    device, grid = executor.device, executor.grid
    if device.is_cpu:
        return min(grid.shape) >= LEAST_SIDE
    return min(grid.shape) >= LEAST_SIDE_ON_GPU and device.free_memory > FIELDS_ON_GPU * 8 * grid.cells


def memory_is_short(executor: Executor) -> bool:
    """Tell whether a solver on wide cells takes memory worth more than the time of making it anew."""
    device = executor.device
    return device.is_cpu or device.free_memory < FIELDS_OF_SEARCH * 8 * executor.grid.cells


def coarse_grid(grid: Grid) -> Grid:
    """Return the grid of cells twice as wide; of an odd number of cells the last one goes over the edge."""
    return Grid(-(-grid.nx // 2), -(-grid.ny // 2), 2.0 * grid.cell)


def carry(kernel: Any, executor: Executor, field: Field, target: Field, *, fine: Grid) -> None:
    """Give the field of an executor what another one holds, by a kernel: `restrict` or `prolong`.

    A wide cell gets the mean of its four, `PADDING` where one of them is that, and each of them its value.
    fine: grid of the narrow cells.
    """
    transfer = arguments(windows.Transfer, field=field, target=target, columns=fine.ny)
    launch_once(executor, kernel, transfer)
