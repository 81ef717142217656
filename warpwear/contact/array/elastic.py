"""Solve the contact of an array on a half-space: of all its cells, or of those that a free one can touch.

Pressures push a free half-space away from the other body everywhere, so that a contact solved on a window is
that of all cells if no cell beyond the window then reaches the other body. That is looked up in the
displacement of all cells, which is made anew from the pressure; where it is not so a larger window is taken.
"""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from warpwear.contact.array.task import Solution, Task, gap_field, rms_of
from warpwear.contact.half_space.influence import Box, displace
from warpwear.contact.half_space.solver import ROUGH, ROUGH_ITERATIONS, HalfSpace
from warpwear.contact.half_space.window import Window
from warpwear.engine.executor import Executor, Field
from warpwear.engine.staging import upload
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import LANES, PADDING

#: What transforms on all cells instead of those of a window may change of a violation, relatively.
SLACK = 1.0e-9
#: Rms height of the gap in a window, over that of all cells, from which its digits tell it.
LEAST_ROUGH = 0.01
#: Wide cells along the longer side of an array, on which a first window is looked for.
WIDE_CELLS = 64


def solve_half_space(task: Task, executor: Executor, tolerance: float) -> Solution:
    """Solve on all cells of a half-space that repeats, or on those of a free one that may touch."""
    options: dict[str, Any] = {"modulus": 1.0, "boundary": task.edge, "hardness": task.cap}
    options["tolerance"] = tolerance
    if task.edge == "free":
        return _solve_free(task, executor, options)
    solver = HalfSpace(executor, **options)
    here = executor.device.is_cpu or task.edge == "line"  # where a counter-body may have an end
    gap = gap_field(task.gap, executor) if here else upload(executor, task.gap_of, padding=PADDING)
    contact = solver.solve(gap, mean_pressure=task.mean, approach=task.approach)
    displacement = solver.displacement()
    return Solution(
        contact.pressure if here else contact.pressure_field,
        executor.to_numpy(displacement) if here else displacement,
        contact.approach,
        contact.transforms + 1,
        certificate=contact.certificate,
    )


def _solve_free(task: Task, executor: Executor, options: dict[str, Any]) -> Solution:
    """Solve on a window, then displace all cells; on a larger one where that shows it to be too small."""
    grid, evaluations = executor.grid, 0
    everything = Window.close_to((0, grid.nx - 1, 0, grid.ny - 1), grid)
    reached = everything.box if task.approach is None else box_of(task.gap < task.approach)
    if reached is None:
        return Solution(np.zeros(task.shape), np.zeros(task.shape), task.approach or 0.0, evaluations)
    boxes = [reached, _guess(task, executor, options) or reached]
    window = min((Window.close_to(box, grid) for box in boxes), key=lambda one: one.area)
    for again in range(3):
        if not _carries(task, window):
            window = everything
        pressure, approach, transforms, allowed = _solve_in(window, task, executor, options)
        wp.synchronize_device(executor.device)  # which gives back the memory of what was let go
        displacement = executor.zeros()
        displace(executor, pressure, displacement, modulus=1.0, box=window.box)
        displaced = executor.to_numpy(displacement)
        evaluations += transforms + 1
        if _clears(task.gap, displaced, window, approach - allowed):
            break
        # Too few cells give too large an approach: what lies below it holds the contact of them all.
        reached = None if again else box_of(task.gap <= approach)
        window = everything if reached is None else Window.close_to(reached, grid)
    return Solution(
        executor.to_numpy(pressure), displaced, approach, evaluations, allowed=(1.0 + SLACK) * allowed
    )


def _solve_in(
    window: Window, task: Task, executor: Executor, options: dict[str, Any]
) -> tuple[Field, float, int, float]:
    """Return the pressure of all cells, solved on a window; approach, transforms and violation allowed."""
    grid, cells = window.grid(executor.grid), task.gap[window.cells]
    mean = None if task.mean is None else task.mean * (task.gap.size / grid.cells)
    with _executor_like(executor, grid) as part:
        if executor.device.is_cpu and executor.grid.ny % LANES == 0 and math.isfinite(cells.max()):
            gap = window.of(executor.field(task.gap))  # not copied
        else:
            gap = gap_field(cells, part)
        height = rms_of(cells)
        if height > LEAST_ROUGH * task.rms:  # what is asked counts over that of all cells
            options = options | {"tolerance": options["tolerance"] * task.rms / height}
        contact = HalfSpace(part, **options).solve(gap, mean_pressure=mean, approach=task.approach)
        pressure = executor.zeros()
        window.give(part, contact.pressure_field, pressure)
        return pressure, contact.approach, contact.transforms, contact.allowed.item()


def _carries(task: Task, window: Window) -> bool:
    """Tell whether the cells of a window can bear the load."""
    if task.mean is None or math.isinf(task.cap):
        return True
    there = np.count_nonzero(np.isfinite(task.gap[window.cells]))
    return bool(there * task.cap >= task.mean * task.gap.size)


def _guess(task: Task, executor: Executor, options: dict[str, Any]) -> Box | None:
    """Return a box of cells that will hold the contact: those that a contact of wide cells comes near."""
    size = -(-max(task.shape) // WIDE_CELLS)
    if size == 1:
        return None
    starts = [np.arange(0, cells, size) for cells in task.shape]
    counts = np.outer(*(np.diff([*at, end]) for at, end in zip(starts, task.shape, strict=True)))

    def of_wide(total: np.ufunc) -> FloatArray:
        return np.asarray(total.reduceat(total.reduceat(task.gap, starts[0], axis=0), starts[1], axis=1))

    gap, lowest = of_wide(np.add) / counts, of_wide(np.minimum)
    mean = None if task.mean is None else task.mean * (task.gap.size / (gap.size * size**2))
    rough = {"tolerance": ROUGH, "max_iterations": ROUGH_ITERATIONS}
    with _executor_like(executor, Grid(gap.shape[0], gap.shape[1], float(size))) as wide:
        solver = HalfSpace(wide, **{**options, **rough})
        try:
            contact = solver.solve(
                gap_field(gap, wide), mean_pressure=mean, approach=task.approach, certified=False
            )
        except (ConvergenceError, InputError):
            return None
        lifted = np.where(gap < PADDING, wide.to_numpy(contact.gradient_field) - gap, 0.0)
        box = box_of((lowest + lifted < contact.approach) | (contact.pressure > 0.0))
    if box is None:
        return None
    # one wide cell more on each side
    ends = [min((last + 2) * size, cells) for last, cells in zip(box[1::2], task.shape, strict=True)]
    return max(box[0] - 1, 0) * size, ends[0] - 1, max(box[2] - 1, 0) * size, ends[1] - 1


def _clears(gap: FloatArray, displaced: FloatArray, window: Window, level: float) -> bool:
    """Tell whether all cells beyond a window lie above a level."""
    rows, columns = window.cells
    above = gap + displaced >= level
    above[rows, columns] = True
    return bool(above.all())


def _executor_like(executor: Executor, grid: Grid) -> Executor:
    """Make an executor on another grid, whose memory is part of what was asked for."""
    return Executor(grid, device=str(executor.device), threads=executor.threads, fields_needed=0.0)


def box_of(cells: npt.NDArray[np.bool_]) -> Box | None:
    """Return the first and last row and column of the cells that are true; None where none is."""
    rows, columns = (np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return None
    return int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1])
