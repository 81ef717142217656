"""Solve the contact of an array on a half-space: of all its cells, or of those that a free one can touch.

Pressures push a free half-space away from the other body everywhere, so that a contact solved on a window is
that of all cells if no cell beyond the window then reaches the other body. That is looked up in the
displacement of all cells, which is made anew from the pressure; where it is not so a larger window is taken.
"""

import math
from functools import partial

import numpy as np
import warp as wp

from warpwear.contact.array.task import Solution, Task, rms_of
from warpwear.contact.array.workplace import Workplace
from warpwear.contact.half_space.influence import Box, apart_shape, displacing
from warpwear.contact.half_space.solver import ROUGH, ROUGH_ITERATIONS
from warpwear.contact.half_space.window import Window
from warpwear.engine.executor import Field
from warpwear.engine.staging import upload
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid, box_of
from warpwear.kernels.cells import LANES, PADDING

#: What transforms on all cells instead of those of a window may change of a violation, relatively.
SLACK = 1.0e-9
#: Rms height of the gap in a window, over that of all cells, from which its digits tell it.
LEAST_ROUGH = 0.01
#: Wide cells along the longer side of an array, on which a first window is looked for.
WIDE_CELLS = 64


def solve_half_space(task: Task, place: Workplace, tolerance: float) -> Solution:
    """Solve on all cells of a half-space that repeats, or on those of a free one that may touch."""
    if task.edge == "free":
        return _solve_free(task, place, tolerance)
    executor, solver = place.executor, place.half_space(str(task.edge), task.cap, tolerance=tolerance)
    here = executor.device.is_cpu or task.edge == "line"  # where a counter-body may have an end
    lies = here or place.is_kept
    gap = place.gap(task.gap) if lies else upload(executor, task.gap_of, padding=PADDING)
    contact = solver.solve(gap, mean_pressure=task.mean, approach=task.approach)
    displacement = solver.displacement()
    return Solution(
        contact.pressure if here else contact.pressure_field,
        executor.to_numpy(displacement) if here else displacement,
        contact.approach,
        contact.transforms + 1,
        certificate=contact.certificate,
    )


def _solve_free(task: Task, place: Workplace, tolerance: float) -> Solution:
    """Solve on a window, then displace all cells; on a larger one where that shows it to be too small."""
    executor, grid, evaluations = place.executor, place.executor.grid, 0
    everything = Window.close_to((0, grid.nx - 1, 0, grid.ny - 1), grid)
    reached = everything.box if task.approach is None else box_of(task.gap < task.approach)
    if reached is None:
        return Solution(np.zeros(task.shape), np.zeros(task.shape), task.approach or 0.0, evaluations)
    boxes = [reached, _guess(task, place) or reached]
    window = min((Window.close_to(box, grid) for box in boxes), key=lambda one: one.area)
    for again in range(3):
        if not _carries(task, window):
            window = everything
        pressure, approach, transforms, allowed = _solve_in(window, task, place, tolerance)
        wp.synchronize_device(executor.device)  # which gives back the memory of what was let go
        displacement, shape = place.field("displacement"), apart_shape(grid, window.box)
        displace = partial(displacing, executor, pressure, displacement, modulus=1.0, shape=shape)
        place.solver(shape, displace).run()
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
    window: Window, task: Task, place: Workplace, tolerance: float
) -> tuple[Field, float, int, float]:
    """Return the pressure of all cells, solved on a window; approach, transforms and violation allowed."""
    executor, cells = place.executor, task.gap[window.cells]
    grid = window.grid(executor.grid)
    mean = None if task.mean is None else task.mean * (task.gap.size / grid.cells)
    part = place.part(grid)
    with part.executor:
        has_padding = executor.grid.ny % LANES or not math.isfinite(cells.max())
        if place.is_kept or has_padding or executor.device.is_cuda:
            gap = part.gap(cells)
        else:
            gap = window.of(executor.field(task.gap))  # not copied
        height = rms_of(cells)
        if height > LEAST_ROUGH * task.rms:  # what is asked counts over that of all cells
            tolerance = tolerance * task.rms / height
        solver = part.half_space("free", task.cap, tolerance=tolerance)
        contact = solver.solve(gap, mean_pressure=mean, approach=task.approach)
        if place.is_kept:
            pressures = np.zeros(task.shape)
            pressures[window.cells] = contact.pressure
            pressure = place.field("pressure", pressures)
        else:
            pressure = executor.zeros()
            window.give(part.executor, contact.pressure_field, pressure)
        return pressure, contact.approach, contact.transforms, contact.allowed.item()


def _carries(task: Task, window: Window) -> bool:
    """Tell whether the cells of a window can bear the load."""
    if task.mean is None or math.isinf(task.cap):
        return True
    there = np.count_nonzero(np.isfinite(task.gap[window.cells]))
    return bool(there * task.cap >= task.mean * task.gap.size)


def _guess(task: Task, place: Workplace) -> Box | None:
    """Return a box of cells that will hold the contact: those that a contact of wide cells comes near."""
    size = -(-max(task.shape) // WIDE_CELLS)
    if size == 1:
        return None
    starts = [np.arange(0, cells, size) for cells in task.shape]
    counts = np.outer(*(np.diff([*at, end]) for at, end in zip(starts, task.shape, strict=True)))

    gap = np.add.reduceat(_joined(np.add, task.gap, size), starts[1], axis=1) / counts
    lowest = _joined(np.minimum, _joined(np.minimum, task.gap, size).T, size).T
    mean = None if task.mean is None else task.mean * (task.gap.size / (gap.size * size**2))
    wide = place.part(Grid(gap.shape[0], gap.shape[1], float(size)))
    with wide.executor:
        solver = wide.half_space("free", task.cap, tolerance=ROUGH, max_iterations=ROUGH_ITERATIONS)
        try:
            contact = solver.solve(wide.gap(gap), mean_pressure=mean, approach=task.approach, certified=False)
        except (ConvergenceError, InputError):
            return None
        lifted = np.where(gap < PADDING, wide.executor.to_numpy(contact.gradient_field) - gap, 0.0)
        box = box_of((lowest + lifted < contact.approach) | (contact.pressure > 0.0))
    if box is None:
        return None
    # one wide cell more on each side
    ends = [min((last + 2) * size, cells) for last, cells in zip(box[1::2], task.shape, strict=True)]
    return max(box[0] - 1, 0) * size, ends[0] - 1, max(box[2] - 1, 0) * size, ends[1] - 1


def _joined(total: np.ufunc, values: FloatArray, size: int) -> FloatArray:
    """Return what each `size` rows come to, one added to another, say; the last may be fewer."""
    joined = values[::size].copy()
    for first in range(1, size):
        rows = values[first::size]
        total(joined[: len(rows)], rows, out=joined[: len(rows)])
    return joined


def _clears(gap: FloatArray, displaced: FloatArray, window: Window, level: float) -> bool:
    """Tell whether all cells beyond a window lie above a level."""
    rows, columns = window.cells
    above = gap + displaced >= level
    above[rows, columns] = True
    return bool(above.all())
