"""Foresee the approaches of the next step of patches: that of the bodies, and the springs behind."""

import math
from typing import ClassVar

import warp as wp

from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.kernels.two_scale import steps as kernels


class PatchForesight:
    """Continue the rate of the common approach, and of every spring's deflection the last one.

    executor: with one row a patch.
    """

    STATE: ClassVar = dict.fromkeys(("start", "deflection", "giving", "reached"), Field) | {"memory": Numbers}

    def __init__(self, executor: Executor) -> None:
        count, device = executor.grid.nx, executor.device

        self.memory = Numbers(kernels.Memory, device, ahead=-1.0)
        names = ("start", "deflection", "giving", "reached", "base_next", "offset_next")
        fields = {name: wp.zeros(count, dtype=wp.float64, device=device) for name in names}
        self.courses = arguments(kernels.Courses, **fields)
        self.start, self.deflection, self.giving, self.reached, *_ = fields.values()
        self.reached.fill_(-math.inf)
