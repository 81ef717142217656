"""A smooth macro contact prescribes the load of each patch (coupling = "load")."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.kernels.newton import Bracket
from warpwear.kernels.two_scale import pressing as kernels
from warpwear.kernels.two_scale.sharing import Load
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.patches.shares import LoadSharing


class SmoothContact:
    """Smooth bodies are a Winkler foundation on the macro cells, capped at the hardness, and wear.

    Uncapped it would ask more of the first patches than all their cells carry at the hardness. Its gap is the
    mean over each patch of the counter-body's; patches that reach beyond its rim have none and carry nothing.

    Raises InputError for a load that the others do not carry.
    """

    STATE: ClassVar = {"worn": Field, "_approach": Field}

    def __init__(self, task: ContactTask, patches: Patches, executor: Executor) -> None:
        self._load = task.load
        self.area = patches.area  # of a macro cell [mm²]
        count, device = patches.count, executor.device
        heights = task.form.heights(patches.domain.x, patches.domain.y)
        stored = patches.stored(heights).reshape(count, patches.side, -1)[:, :, : patches.side]
        self.initial: FloatArray = stored.mean(axis=(1, 2))  # gap before any wear [mm]
        whole = int(np.isfinite(self.initial).sum())
        if whole * self.area * task.hardness < self._load:
            raise InputError(
                f"contact.load = {self._load:g} N is more than the {whole} macro cells that lie wholly under "
                f"the counter-body carry at the hardness ({whole * self.area * task.hardness:.4g} N), as "
                "patches.coupling = 'load' needs it; allowed are smaller loads or a smaller "
                "patches.macro_cell."
            )
        self.worn = wp.zeros(count, dtype=wp.float64, device=device)  # by both bodies [mm]
        self._approach: Field = wp.array([self.initial.min()], dtype=wp.float64, device=device)  # [mm]
        self.smooth = arguments(
            kernels.Smooth,
            device,
            initial=wp.array(self.initial, dtype=wp.float64, device=device),
            worn=self.worn,
            approach=self._approach,
            target=(1, count),
            room=(2, count),
        )
        load = arguments(
            Load, load=task.load, area=self.area, hardness=task.hardness, tolerance=TOLERANCE, evaluations=0
        )
        self.brackets = wp.zeros(count, dtype=Bracket, device=device)
        self._step = wp.zeros(2, dtype=wp.float64, device=device)
        self._alone = Program(executor)
        self._alone.decide(kernels.press_smoothly, self.smooth, load, self._step)

    def add_to(self, program: Program, sharing: LoadSharing, evaluate: Callable[[], None]) -> None:
        """Add the search of patches for what is prescribed to a program, from where a decision begins.

        evaluate: adds the pass that asks the patches.
        """
        with program.loop(sharing.flags.searching):
            evaluate()
            patches = sharing.curves, self.smooth, self.brackets
            program.decide(kernels.judge, sharing.load, *patches, sharing.search.array, sharing.flags)

    @property
    def approach(self) -> float:
        """Return the approach of the smooth bodies [mm]."""
        return float(self._approach.numpy()[0])

    @property
    def is_balanced(self) -> bool:
        """Tell whether the last search has ended well."""
        return bool(self.smooth.balanced.numpy()[0])

    def press(self, *, foundation: float, removal: float) -> FloatArray:
        """Return pressures [MPa] that carry the load, then worn by removal [mm³/N] times them, implicitly.

        They add up to the load to rounding. foundation: K_N [N/mm³]. Raises ConvergenceError.
        """
        self._step.assign([1.0 / foundation, removal])
        self._alone.run()
        if not self.is_balanced:
            raise self.failure()
        return self.smooth.target.numpy()[0].copy()

    def failure(self, sharing: LoadSharing | None = None) -> ConvergenceError:
        """Return the error for a search that has not ended well: its own, or that of the patches."""
        if sharing is None or not self.is_balanced:
            return ConvergenceError(
                f"the smooth macro contact did not converge: {self.smooth.left.numpy()[0]:.3g} N of "
                f"{self._load:.6g} N are left near an approach of {self.approach:.9g} mm."
            )
        target, p = self.smooth.target.numpy()[0], sharing.answer.numpy()[0]
        worst = int(np.argmax(np.abs(p - target) - float(kernels.PART) * TOLERANCE * target))
        return ConvergenceError(
            "the patches did not converge to their prescribed loads in "
            f"{sharing.search['evaluations']} evaluations: patch {worst} carries {p[worst]:.9g} MPa "
            f"of {target[worst]:.9g} MPa, at an approach of {sharing.approaches[worst]:.9g} mm."
        )
