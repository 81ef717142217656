"""Cells of an array that do not feel each other stand on springs, or bear by the bearing area."""

import numpy as np

from warpwear.contact.array.task import ROUNDING, Solution, Task, gap_field
from warpwear.contact.balance import RIGID, Balance
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.kernels.bearing import TIE

#: Cells that the lists of tiles hold at least, over those that carry the load at the hardness.
SPARE = 2.0


def solve_cells(task: Task, executor: Executor) -> Solution:
    """Solve with springs, or the bearing area: to rounding."""
    gap, stiffest = gap_field(task.gap, executor), 1.0 if task.response else RIGID
    load = (task.mean or 0.0) * task.gap.size
    search = LoadSearch(
        executor,
        gap,
        Tiles(executor, gap, gap, least=SPARE * load / task.cap),
        load=load,
        hardness=task.cap,
        stiffness=executor.field(np.full((1, 1), stiffest), padding=stiffest),
        # No number of cells but the very one: else their pressure would exceed the hardness.
        tolerance=None if task.response else ROUNDING * load,
    )
    if task.approach is None:
        balance = search.solve()
    else:
        # Where nothing yields a cell at the very approach is touched.
        width, tied = (0.0, 0.0) if task.response else (TIE, task.cap)
        balance = Balance(task.approach, 0.0, task.cap, 0.0, width, tied, evaluations=1)
    pressure = search.pressures(balance._replace(cap=task.cap)).copy()
    approach = balance.approach
    if task.approach is None and not task.response:  # the lowest of those that touch these cells
        approach = float(task.gap[pressure > 0.0].max())
    return Solution(pressure, pressure * task.response, approach, balance.evaluations)
