"""The fine cells of all patches have places, a gap, and a film on them."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.engine.tiles import of_tiles
from warpwear.grid import FloatArray
from warpwear.kernels import patches as kernels
from warpwear.kernels.cells import CellProperties
from warpwear.kernels.sliding import Slide
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.attachment import Place
from warpwear.models.film import BareCells
from warpwear.models.unworn import gap_over, layout_of


class PatchContact:
    """The micro law of two scales gives every fine cell a gap on a capped foundation, patch by patch.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    STATE: ClassVar = {"gap": InFrame("contact"), "film": BareCells}

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.initial = gap_over(task.form, heights, executor, patches)
        self.gap: Field = wp.clone(self.initial)
        lowest = of_tiles(np.minimum, self.gap, lines=patches.side)
        #: Lowest gap of each patch before any wear [mm]: below that approach it carries nothing.
        self.lowest: FloatArray = lowest.min(axis=1)
        #: Worn by both bodies [mm], where a film asks for it.
        self._worn = executor.zeros(None if task.film else 0)
        self.film = BareCells.of_both(task, executor, self._worn)
        #: The step, and how many cells of each patch were bare under its pressure, where there is a film.
        self.slides = Numbers(Slide, executor.device, written=False, rows=patches.count)
        self.bare = wp.zeros((1, patches.count), dtype=wp.float64, device=executor.device)
        self.surfaces = arguments(
            kernels.Surfaces,
            executor.device,
            layout=layout_of(executor, patches),
            lowest=wp.array(lowest, dtype=wp.float64, device=executor.device),
            cells_of_patch=float(patches.side**2),
            gap=self.gap,
            unworn=self.initial,
            cells=arguments(CellProperties, **({} if self.film is None else self.film.properties)),
            trial=(3, patches.count),
        )

    def add_film(self, program: Program, add: Callable[[Program, Place], None]) -> None:
        """Add to a program what a film does before a step or after it, of what is worn then."""
        program.launch(kernels.worn, self.surfaces, self._worn, slots=self.gap.shape[0])
        add(program, Place(self.slides.array))
