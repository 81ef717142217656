"""Structs on a device that the host writes between replays of a program."""

from typing import Any

import warp as wp

from warpwear.engine.executor import Executor


class Record:
    """A struct of numbers in an array of one, which passes and decisions read and write.

    kind: the wp.struct. numbers: what its members are at first, by default 0.
    """

    def __init__(self, executor: Executor, kind: Any, **numbers: float) -> None:
        self.array: Any = wp.zeros(1, dtype=kind, device=executor.device)
        self._host: Any = self.array.numpy()
        self.write(**numbers)

    def write(self, **numbers: float) -> None:
        """Set members to numbers; on a CPU in place."""
        if not self.array.device.is_cpu:
            self._host = self.array.numpy()
        for name, value in numbers.items():
            self._host[name][0] = value
        if not self.array.device.is_cpu:
            self.array.assign(self._host)

    def read(self) -> dict[str, float]:
        """Return the members by name."""
        values = self.array.numpy()[0]
        return dict(zip(values.dtype.names, values.tolist(), strict=True))
