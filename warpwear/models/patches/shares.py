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
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels.two_scale import curves, sharing


class LoadSharing:
    """Holds patches at trial approaches, and searches for those at which they carry a load.

    executor: with one row a patch. load: F [N]. area: that each patch stands for [mm²]. hardness: that none
    exceeds [MPa]. lowest: below that approach a patch carries nothing [mm], shape (patches,).
    """

    STATE: ClassVar = {"base": Field, "offset": Field, "answer": Field}

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
        self.load = arguments(
            sharing.Load,
            load=load,
            area=area,
            hardness=hardness,
            tolerance=TOLERANCE,
            evaluations=MAX_EVALUATIONS - 1,
        )
        self.search = Numbers(sharing.Search, device)
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
