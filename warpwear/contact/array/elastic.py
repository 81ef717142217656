"""The contact of an array on a half-space."""

from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from warpwear.contact.array.task import Found, Task, gap_field
from warpwear.contact.half_space import HalfSpace
from warpwear.contact.half_space_window import WindowedHalfSpace
from warpwear.contact.influence import Influence
from warpwear.engine.executor import Executor
from warpwear.engine.staging import upload
from warpwear.grid import Grid
from warpwear.kernels.cells import PADDING

#: What transforms on all cells instead of those in reach may change of a violation, relatively.
SLACK = 1.0e-9


def solve_half_space(task: Task, executor: Executor, tolerance: float) -> Found:
    """Solve on the cells that the other body can reach, then displace all of them."""
    assert task.edge is not None
    options: dict[str, Any] = {"modulus": 1.0, "boundary": task.edge, "hardness": task.cap}
    options["tolerance"] = tolerance
    if task.mean is not None and task.edge == "periodic":
        solver, here = HalfSpace(executor, **options), executor.device.is_cpu
        gap = gap_field(task.gap, executor) if here else upload(executor, task.gap_of, padding=PADDING)
        found = solver.solve(gap, mean_pressure=task.mean)
        return Found(
            found.pressure if here else found.pressure_field,
            executor.to_numpy(solver.displacement()) if here else solver.displacement(),
            found.approach,
            found.transforms + 1,
            certificate=found.certificate,
        )
    pressure, approach, transforms, allowed = np.zeros(task.gap.shape), task.approach, 0, 0.0
    if task.mean is not None:
        field = gap_field(task.gap, executor)
        found = WindowedHalfSpace(executor, **options).solve(field, load=task.mean * task.gap.size)
        pressure[:], approach = found.pressure, found.approach
        transforms, allowed = found.transforms, found.allowed.item()
        del found, field  # before there are more
        wp.synchronize_device(executor.device)  # which gives their memory back
    assert approach is not None
    reached = task.gap < approach
    if task.mean is None and reached.any():
        window = (slice(None), slice(None)) if task.edge == "periodic" else _box(reached)
        part = task.gap[window]
        with Executor(
            Grid(part.shape[0], part.shape[1], 1.0), device=str(executor.device), threads=executor.threads
        ) as smaller:
            found = HalfSpace(smaller, **options).solve(gap_field(part, smaller), approach=approach)
            pressure[window], transforms, allowed = found.pressure, found.transforms, found.allowed.item()
    field = executor.zeros()
    Influence(executor, modulus=1.0, boundary=task.edge).respond(executor.field(pressure), field)
    return Found(pressure, executor.to_numpy(field).copy(), approach, transforms + 1, (1.0 + SLACK) * allowed)


def _box(cells: npt.NDArray[np.bool_]) -> tuple[slice, slice]:
    """The rows and the columns that hold all the cells."""
    rows, columns = (np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
