"""The bodies of a contact that lies still: their gap as worn and unworn, and whose wear it was."""

from dataclasses import dataclass
from typing import ClassVar, Self

from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import launch_once
from warpwear.grid import FloatArray
from warpwear.kernels import contact
from warpwear.laws.task import ContactTask


@dataclass
class RestingBodies:
    """Fields of nx × ny cells, on the executor's device, of bodies that wear in one proportion.

    What is worn is gap − unworn: a step near a late contact then moves three fields, not six. Its rounding is
    that of the gap, 1e-17 mm a step.
    """

    gap: Field  # from the mean planes, as worn [mm]
    unworn: Field  # the gap without wear [mm]
    fractions: tuple[float, float]  # of counter-body and disc in what is worn

    STATE: ClassVar = {"gap": Field}

    @classmethod
    def of(cls, task: ContactTask, executor: Executor, heights: FloatArray) -> Self:
        """Return unworn bodies: the task's counter-body over heights of a disc [mm], shape (nx, ny)."""
        grid, form = executor.grid, task.form
        bodies = cls(executor.zeros(), executor.zeros(), task.wear_fractions)
        place = [grid.ny, grid.cell, float(grid.x[0]), float(grid.y[0]), form.curvature]
        roughness = executor.field(form.beneath(heights, grid.x, grid.y))
        launch_once(executor, contact.gap, *place, roughness, bodies.gap, bodies.unworn)
        return bodies
