"""Share a load among patches, as a part of a program: each at an approach of its own, joined by springs.

A patch k carries the mean pressure p_k(u_k) at its approach u_k. Behind it is a spring of stiffness K_N
[N/mm³], the bulk, so that all patches have

    u_k + p_k / K_N = δ,   A Σ p_k = F

with one approach δ of the bodies, both measured from the mean planes. What a patch answers is the micro law's
affair: any increasing p_k(u_k). The rules of the search stand in `warpwear.kernels.two_scale.sharing`.
"""

from collections.abc import Callable
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import MAX_EVALUATIONS, TOLERANCE
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.kernels.newton import Bracket
from warpwear.kernels.two_scale import curves, pressing, sharing
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask


class LoadSharing:
    """Holds patches at trial approaches, and searches for those at which they carry a load.

    executor: with one row a patch. load: F [N]. area: that each patch stands for [mm²]. hardness: that none
    exceeds [MPa]. lowest: below that approach a patch carries nothing [mm], shape (patches,).
    """

    STATE: ClassVar = {"base": Field, "offset": Field, "answer": Field}
    SCRATCH: ClassVar = ("curves", "search", "flags")

    def __init__(
        self, executor: Executor, lowest: FloatArray, *, load: float, area: float, hardness: float
    ) -> None:
        self._executor = executor
        self.count, device = lowest.size, executor.device
        self.curves = arguments(
            curves.Curves,
            device,
            lowest=wp.array(lowest, dtype=wp.float64, device=device),
            **dict.fromkeys(("base", "offset", "low", "high"), self.count),
            answer=(3, self.count),
            room=(curves.LINES, self.count),
        )
        #: Approaches are base + offset [mm], which together hold more digits than their sum.
        self.base, self.offset = self.curves.base, self.curves.offset
        self.answer: Field = self.curves.answer
        carried = {"load": load, "area": area, "hardness": hardness, "tolerance": TOLERANCE}
        self.load = arguments(sharing.SharedLoad, **carried, evaluations=MAX_EVALUATIONS - 1)
        self.search = Numbers(sharing.SharingSearch, device)
        self.flags = arguments(sharing.Flags, device)

    def add_to(self, program: Program, evaluate: Callable[[], None]) -> None:
        """Add the search to a program, from where a decision before it begins.

        evaluate: adds the pass that asks the patches.
        """
        flags = self.flags
        with program.loop(flags.searching):
            with program.branch(flags.unanswered):
                evaluate()
            program.decide(sharing.judge, self.load, self.curves, self.search.array, flags)

    @property
    def is_balanced(self) -> bool:
        """Tell whether the last search has ended well."""
        return bool(self.flags.balanced.numpy()[0])

    @property
    def approaches(self) -> FloatArray:
        """Return u_k of every patch [mm]; of one without pressure it is δ or lower."""
        return np.asarray(self.base.numpy() + self.offset.numpy())

    def failure(self) -> ConvergenceError:
        """Return the error for a search that has not ended well."""
        s, load = self.search, self.load.load
        return ConvergenceError(
            f"the load shares of {self.count} patches did not converge in {s['evaluations']} evaluations: "
            f"{s['residual']:.3g} N of {load:.6g} N are left (allowed {TOLERANCE * load:.1g} N), and "
            f"{s['spring_residual']:.3g} mm between a patch's approach with its bulk spring and that of the "
            f"bodies (allowed {s['spring_allowed']:.1g} mm), near an approach of {s['common_base']:.9g} mm."
        )


class SmoothContact:
    """Smooth bodies are a Winkler foundation on the macro cells, capped at the hardness, and wear.

    Uncapped it would ask more of the first patches than all their cells carry at the hardness. Its gap is the
    mean over each patch of the counter-body's; patches that reach beyond its rim have none and carry nothing.

    Raises InputError for a load that the others do not carry.
    """

    STATE: ClassVar = {"worn": Field, "_approach": Field}
    SCRATCH: ClassVar = ("smooth", "brackets", "_step")

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
            pressing.Smooth,
            device,
            initial=wp.array(self.initial, dtype=wp.float64, device=device),
            worn=self.worn,
            approach=self._approach,
            target=(1, count),
            room=(2, count),
        )
        carried = {"load": task.load, "area": self.area, "hardness": task.hardness, "tolerance": TOLERANCE}
        load = arguments(sharing.SharedLoad, **carried)
        self.brackets = wp.zeros(count, dtype=Bracket, device=device)
        self._step = wp.zeros(2, dtype=wp.float64, device=device)
        self._alone = Program(executor)
        self._alone.decide(pressing.press_smoothly, self.smooth, load, self._step)

    def add_to(self, program: Program, shares: LoadSharing, evaluate: Callable[[], None]) -> None:
        """Add the search of patches for what is prescribed to a program, from where a decision begins.

        evaluate: adds the pass that asks the patches.
        """
        with program.loop(shares.flags.searching):
            evaluate()
            patches = shares.curves, self.smooth, self.brackets
            program.decide(pressing.judge, shares.load, *patches, shares.search.array, shares.flags)

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

    def failure(self, shares: LoadSharing | None = None) -> ConvergenceError:
        """Return the error for a search that has not ended well: its own, or that of the patches."""
        if shares is None or not self.is_balanced:
            return ConvergenceError(
                f"the smooth macro contact did not converge: {self.smooth.left.numpy()[0]:.3g} N of "
                f"{self._load:.6g} N are left near an approach of {self.approach:.9g} mm."
            )
        target, p = self.smooth.target.numpy()[0], shares.answer.numpy()[0]
        worst = int(np.argmax(np.abs(p - target) - float(pressing.PART) * TOLERANCE * target))
        return ConvergenceError(
            "the patches did not converge to their prescribed loads in "
            f"{shares.search['evaluations']} evaluations: patch {worst} carries {p[worst]:.9g} MPa "
            f"of {target[worst]:.9g} MPa, at an approach of {shares.approaches[worst]:.9g} mm."
        )
