"""The smooth macro contact that prescribes the load of each patch (coupling = "load")."""

import math
from typing import ClassVar

import numpy as np

from warpwear.contact.balance import Carried, newton_in_bracket
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.surfaces.sphere import sag


class SmoothContact:
    """A Winkler foundation of smooth bodies on the macro cells, capped at the hardness, with its own wear.

    Uncapped it would ask more of the first patches than all their cells carry at the hardness. Its gap is the
    mean over each patch of the sphere's; patches that reach beyond its rim have none and carry nothing.

    Raises InputError for a load that the others do not carry.
    """

    STATE: ClassVar = {"worn": FloatArray, "approach": float}

    def __init__(self, task: ContactTask, patches: Patches) -> None:
        self._load, self._hardness = task.load, task.hardness
        self.area = patches.area  # of a macro cell [mm²]
        curvature = task.curvature
        heights = sag(patches.domain.x, patches.domain.y, radius=1.0 / curvature if curvature else np.inf)
        stored = patches.stored(heights).reshape(patches.count, patches.side, -1)[:, :, : patches.side]
        self.initial: FloatArray = stored.mean(axis=(1, 2))  # gap before any wear [mm]
        whole = int(np.isfinite(self.initial).sum())
        if whole * self.area * self._hardness < self._load:
            raise InputError(
                f"contact.load = {self._load:g} N is more than the {whole} macro cells that lie wholly under "
                f"the sphere carry at the hardness ({whole * self.area * self._hardness:.4g} N), as "
                "patches.coupling = 'load' needs it; allowed are smaller loads or a smaller "
                "patches.macro_cell."
            )
        self.worn = np.zeros(patches.count)  # by both bodies [mm]
        self.approach = float(self.initial.min())  # [mm]

    def press(self, *, foundation: float, removal: float) -> FloatArray:
        """Pressures [MPa] that carry the load, then worn by removal [mm³/N] times them, implicitly.

        They add up to the load to rounding. foundation: K_N [N/mm³]. Raises ConvergenceError.
        """
        base = self.approach
        stiffness = 1.0 / (1.0 / foundation + removal)
        overlap = base - (self.initial + self.worn)

        def pressure(offset: float) -> FloatArray:
            return np.clip((overlap + offset) * stiffness, 0.0, self._hardness)

        def carried(offset: float) -> Carried:
            p = pressure(offset)
            between = np.count_nonzero((p > 0.0) & (p < self._hardness))
            return Carried(self.area * float(p.sum()), self.area * stiffness * between, 0.0)

        step = self._load / (self.area * stiffness * self.worn.size)
        found = newton_in_bracket(carried, self._load, step, -math.inf, math.inf, 0.0, stiffness, None)
        if not found.converged(self._load):
            raise ConvergenceError(
                f"the smooth macro contact did not converge: {found.force - self._load:.3g} N of "
                f"{self._load:.6g} N are left near an approach of {base + found.offset:.9g} mm."
            )
        p = self._adding_up(pressure(found.offset))
        self.approach = base + found.offset
        self.worn = self.worn + removal * p
        return p

    def _adding_up(self, p: FloatArray) -> FloatArray:
        """Without what the search left of the load: that of the patches comes on top of it."""
        between = (p > 0.0) & (p < self._hardness)
        if carried := float(p[between].sum()):
            scale = 1.0 - (float(p.sum()) - self._load / self.area) / carried
            p[between] = np.minimum(p[between] * scale, self._hardness)
        return p
