"""Where the approaches of the next step of patches will be: the bodies' as of one, and the springs behind."""

from typing import ClassVar

import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.kernels.two_scale import steps as kernels


class PatchForesight:
    """Continues the rate of the common approach, and of every spring's deflection the last one.

    executor: with one row a patch.
    """

    STATE: ClassVar = {
        "memory": Numbers,
        "start": Field,
        "deflection": Field,
        "giving": Field,
        "reached": Field,
    }

    def __init__(self, executor: Executor) -> None:
        count, device = executor.grid.nx, executor.device

        def of_patches(value: float = 0.0) -> Field:
            return wp.full(count, value, dtype=wp.float64, device=device)

        self.memory = Numbers(kernels.Memory, device, ahead=-1.0)
        self.start, self.deflection, self.giving = of_patches(), of_patches(), of_patches()
        #: Largest approach that each patch has had [mm].
        self.reached = of_patches(-float("inf"))
        self.courses = arguments(
            kernels.Courses,
            start=self.start,
            deflection=self.deflection,
            giving=self.giving,
            reached=self.reached,
            base_next=of_patches(),
            offset_next=of_patches(),
        )
