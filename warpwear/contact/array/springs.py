"""The contact of an array whose cells do not feel each other: springs under them, or the bearing area."""

import numpy as np

from warpwear.contact.array.task import ROUNDING, Found, Task, gap_field
from warpwear.contact.balance import RIGID, Balancer, Foundation
from warpwear.contact.bearing_area import TIE, BearingArea
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.tiles import Tiles
from warpwear.kernels.contact import Law

#: Cells that the lists of tiles hold at least, over those that carry the load at the hardness.
SPARE = 2.0


def solve_cells(task: Task, executor: Executor) -> Found:
    """Solve with springs, or the bearing area: to rounding."""
    gap, stiffest = gap_field(task.gap, executor), 1.0 if task.response else RIGID
    stiffness = executor.field(np.full((1, 1), stiffest), padding=stiffest)
    load = (task.mean or 0.0) * task.gap.size
    tiles = Tiles(executor, gap, gap, least=SPARE * load / task.cap)
    law, evaluations, balancer = arguments(Law, offset=0.0), 1, Balancer(executor)
    law.base, law.cap, law.tie_pressure = float(task.approach or 0.0), task.cap, task.cap
    # Where nothing yields a cell at the very approach is touched.
    law.tie_width = 0.0 if task.response else TIE
    if task.approach is None:
        if task.response:
            found = balancer.solve(Foundation(gap, stiffness, tiles, load, task.cap))
        else:
            # No number of cells but the very one: else their pressure would exceed the hardness.
            bearing = BearingArea(executor)
            found = bearing.solve(
                gap,
                tiles,
                highest=bearing.bounds(gap, tiles)[1],
                load=load,
                hardness=task.cap,
                tolerance=ROUNDING * load,
            )
        found.fill(law)
        law.cap, evaluations = task.cap, found.evaluations
    if not law.tie_width:
        law.tie_pressure = 0.0
    pressure = balancer.pressures(law, stiffness, gap, tiles).copy()
    approach = law.base + law.offset
    if task.approach is None and not task.response:  # the lowest of those that touch these cells
        approach = float(task.gap[pressure > 0.0].max())
    return Found(pressure, pressure * task.response, approach, evaluations)
