"""The fine cells of all patches have places, a gap, and a film on them."""

from typing import ClassVar

import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels import patches as kernels
from warpwear.kernels.cells import TILE_VECTORS
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask, Form
from warpwear.models.film import BareCells


def unworn(
    patches: Patches, heights: FloatArray, executor: Executor, *, form: Form
) -> tuple[Field, Arguments]:
    """Return the gap of the fine cells before any wear [mm], and where the patches lie.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """
    domain, device = patches.domain, executor.device
    tiles = patches.side * -(-patches.vectors // int(TILE_VECTORS))
    layout = arguments(
        kernels.Layout,
        vectors=patches.vectors,
        first_row=wp.array(patches.first_row, dtype=wp.int32, device=device),
        first_column=wp.array(patches.first_column, dtype=wp.int32, device=device),
        lowest=wp.zeros((patches.count, tiles), dtype=wp.float64, device=device),
    )
    ball = arguments(
        kernels.Ball,
        cell=domain.cell,
        x_first=float(domain.x[0]),
        y_first=float(domain.y[0]),
        curvature=form.curvature,
    )
    gap = executor.zeros()
    roughness = executor.field(patches.stored(form.beneath(heights, domain.x, domain.y)))
    program = Program(executor)
    program.launch(kernels.gap, patches.side, ball, layout, roughness, gap, slots=patches.count)
    program.run()
    return gap, layout


class PatchContact:
    """The micro law of two scales gives every fine cell a gap on a capped foundation, patch by patch.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    STATE: ClassVar = {"gap": Field, "film": BareCells}

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.initial, layout = unworn(patches, heights, executor, form=task.form)
        self.gap: Field = wp.clone(self.initial)
        #: Lowest gap of each patch before any wear [mm]: below that approach it carries nothing.
        self.lowest: FloatArray = layout.lowest.numpy().min(axis=1)
        #: Worn by both bodies [mm], where a film asks for it.
        worn = executor.zeros(None if task.film else 0)
        self.film = BareCells.of_both(task.film, executor, worn, task.wear_fractions)
        parts = None if self.film is None else self.film.parts
        self.surfaces = arguments(
            kernels.Surfaces,
            layout=layout,
            cells=float(patches.side**2),
            gap=self.gap,
            unworn=self.initial,
            parts=executor.zeros(0) if parts is None else parts,
            trial=wp.zeros((3, patches.count), dtype=wp.float64, device=executor.device),
        )
        self._measure_wear = Program(executor)
        if self.film:
            self._measure_wear.launch(kernels.worn, self.surfaces, worn, slots=patches.count)

    def look(self, distance: float) -> None:
        """See which cells are bare of film as a step begins at a sliding distance [mm]."""
        if self.film:
            self._measure_wear.run()
            self.film.look(distance)

    def rub(self, distance: float) -> None:
        """Note what a step that ends at a sliding distance [mm] has worn."""
        if self.film:
            self._measure_wear.run()
            self.film.rub(distance)
