"""1/c of the cells in a step: of the foundation, and of the wear that an implicit step takes with it."""

from dataclasses import dataclass

import numpy as np

from warpwear.contact.balance import RIGID
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray
from warpwear.kernels.cells import LANES


@dataclass(frozen=True)
class Stiffness:
    """1/c of the cells in a step [N/mm³]."""

    made_for: tuple[float, float, float]  # compliance, removal of sphere and of disc [mm³/N]
    field: Field
    stiffest: float


class Stiffnesses:
    """Makes them; those of the last two steps are kept, as the next one's is needed before this one ends.

    factor: of the disc's sliding distance, as of `kinematics.distance_factor`. implicit: whether the wear of
    a step adds to its compliance.
    """

    def __init__(self, executor: Executor, factor: FloatArray, *, implicit: bool) -> None:
        self._executor, self._factor, self._implicit = executor, factor, implicit
        self._made: list[Stiffness] = []

    def of(self, compliance: float, removal_sphere: float, removal_disc: float) -> Stiffness:
        """Of a step on a foundation of this compliance that removes so much [mm³/N].

        One row where all are alike.
        """
        made_for = compliance, removal_sphere * self._implicit, removal_disc * self._implicit
        for made in self._made:
            if made.made_for == made_for:
                return made
        del self._made[:-1]
        values = self._factor * made_for[2]
        values += compliance + made_for[1]
        with np.errstate(divide="ignore", over="ignore"):
            np.reciprocal(values, out=values)
        np.minimum(values, RIGID, out=values)
        stiffest = float(values.max())
        ny, padded = self._executor.grid.ny, self._executor.vectors * LANES
        if values.size == 1:
            values = np.full((1, padded), stiffest)
        elif ny < padded:  # a stiffness of 0 there would look like cells at the point of touching
            values = np.pad(values, ((0, 0), (0, padded - ny)), mode="edge")
        made = Stiffness(made_for, self._executor.field(values), stiffest)
        self._made.append(made)
        return made
