"""The fine cells of all patches have places, a gap, and what the study adds to them."""

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.engine.tiles import tile_extremes
from warpwear.grid import FloatArray
from warpwear.kernels import patches as kernels
from warpwear.kernels.running_in import film
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.features.feature import Place
from warpwear.models.features.features import Features
from warpwear.models.unworn import gap_over, layout_of


class PatchContact:
    """The micro law of two scales gives every fine cell a gap on a capped foundation, patch by patch.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    STATE: ClassVar = {"gap": InFrame("contact"), "features": Features}
    SCRATCH: ClassVar = ("bare", "surfaces", "_worn")

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.initial = gap_over(task.form, heights, executor, patches)
        self.gap: Field = wp.clone(self.initial)
        lowest = tile_extremes(np.minimum, self.gap, lines=patches.side)
        #: Lowest gap of each patch before any wear [mm]: below that approach it carries nothing.
        self.lowest: FloatArray = lowest.min(axis=1)
        #: Worn by both bodies [mm], where a feature asks for it.
        self._worn = executor.zeros(0 if task.film is None else None)
        self.features = Features.of(replace(task, profiles=None), executor, {"worn": self._worn})
        #: How many cells of each patch were bare under the pressure of a step.
        self.bare = wp.zeros((1, patches.count), dtype=wp.float64, device=executor.device)
        self.surfaces = arguments(
            kernels.Surfaces,
            executor.device,
            layout=layout_of(executor, patches),
            lowest=wp.array(lowest, dtype=wp.float64, device=executor.device),
            cells_of_patch=float(patches.side**2),
            cap=task.hardness,
            gap=self.gap,
            unworn=self.initial,
            cells=self.features.cells,
            trial=(3, patches.count),
        )

    def surfaces_of(self, cells: Arguments) -> Arguments:
        """Return the surfaces as kernels take them with other `CellProperties`."""
        kind: Any = kernels.Surfaces
        members = {name: getattr(self.surfaces, name) for name in kind.vars}
        return arguments(kind, **members | {"cells": cells})

    def ask(self, hook: str, program: Program, slides: Field) -> None:
        """Let features add to a program what they do before a step or after it, of what is worn then."""
        if self.features:
            program.launch(kernels.worn, self.surfaces, self._worn, slots=self.gap.shape[0])
            self.features.ask(hook, program, Place(slides))

    def add_bare(self, program: Program, pressure: Field, slides: Field) -> None:
        """Add to a program that it counts the bare cells of each patch under a pressure."""
        cells = self.features.cells
        if cells.material is not None:
            slots = self.gap.shape[0]
            program.launch(film.bare_under_pressure, slides, cells, pressure, self.bare, slots=slots)
