"""The bodies of a contact that lies still: their gap as worn and unworn, and whose wear it was."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray
from warpwear.kernels import gap
from warpwear.laws.archard import WearLaw


@dataclass
class State:
    """Fields of nx × ny cells, on the executor's device.

    What is worn is gap − unworn: a step near a late contact then moves three fields, not six. Its rounding is
    that of the gap, 1e-17 mm a step.
    """

    gap: Field  # from the mean planes, as worn [mm]
    unworn: Field  # the gap without wear [mm]
    share: Field  # of the sphere in what is worn; one row where it is the same all along
    #: Parts of sphere and disc in what is worn, where all cells and steps have the same, else None: a small
    #: one is then no difference of large ones.
    parts: tuple[float, float] | None
    #: The fields that steps change.
    changing: tuple[str, ...] = ("gap",)

    @property
    def STATE(self) -> dict[str, Any]:
        return dict.fromkeys(self.changing, Field)

    @classmethod
    def of(
        cls,
        executor: Executor,
        heights: FloatArray,
        laws: tuple[WearLaw, WearLaw],
        *,
        curvature: float,
        factor: FloatArray | None = None,
    ) -> Self:
        """Unworn, of a sphere over the heights of a disc [mm], shape (nx, ny).

        laws: of sphere and disc. curvature: 1/R [1/mm]. factor: of the sliding distance of the disc's cells,
        see `kinematics.distance_factor`.
        """
        sphere, disc = laws
        factor = np.ones((1, 1)) if factor is None else factor
        worn = sphere.fastest + disc.fastest * factor
        share = np.divide(sphere.fastest, worn, out=np.zeros_like(worn), where=worn > 0.0)
        grid = executor.grid
        in_proportion = sphere.in_proportion_to(disc)
        rows = share.shape[0] if in_proportion else grid.nx
        parts = None
        if in_proportion and worn.max() > 0.0 and (factor == 1.0).all():
            parts = float(share.flat[0]), disc.fastest / float(worn.flat[0])
        shared = executor.field(np.broadcast_to(share, (rows, grid.ny)))
        found = cls(executor.zeros(), executor.zeros(), shared, parts)
        place = [grid.ny, grid.cell, float(grid.x[0]), float(grid.y[0]), curvature]
        executor.launch(gap.gap, inputs=[*place, executor.field(heights)], outputs=[found.gap, found.unworn])
        return found

    def worn(self, executor: Executor) -> tuple[FloatArray, FloatArray]:
        """Depths worn off sphere and disc so far [mm], shape (nx, ny)."""
        gap, unworn, share = (executor.to_numpy(field) for field in (self.gap, self.unworn, self.share))
        both = gap - unworn
        if self.parts is not None:
            return self.parts[0] * both, self.parts[1] * both
        sphere = share * both
        return sphere, np.subtract(both, sphere, out=both)

    def divide(self, found: dict[str, float]) -> dict[str, float]:
        """Sums or maxima over the cells, with what is worn of sphere and disc by their parts."""
        if self.parts is None:
            return found
        both = found["wear_sphere"] + found["wear_disc"]
        return found | {"wear_sphere": self.parts[0] * both, "wear_disc": self.parts[1] * both}
