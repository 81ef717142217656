"""Numbers that kernels change, seen by the host by their names."""

from collections.abc import Mapping
from typing import Any, ClassVar

import warp as wp

from warpwear.engine.executor import Field


class Numbers:
    """An instance of a struct in an array of one, which kernels read and write.

    On a CPU the host writes into the memory of the array, on a GPU it copies it.
    """

    STATE: ClassVar = {"values": dict}

    def __init__(self, kind: Any, device: Any, **values: float) -> None:
        self.array: Field = wp.zeros(1, dtype=kind, device=device)
        self._host = self.array.numpy() if device.is_cpu else None
        self.set(**values)

    def __getitem__(self, name: str) -> Any:
        return self._read()[name][0].item()

    def set(self, **values: float) -> None:
        """Give some of them other values."""
        host = self._read()
        for name, value in values.items():
            host[name] = value
        if self._host is None:
            self.array.assign(host)

    @property
    def values(self) -> dict[str, Any]:
        """All of them by name, of a struct of plain numbers."""
        host = self._read()
        return {name: host[name][0].item() for name in host.dtype.names}

    @values.setter
    def values(self, values: Mapping[str, Any]) -> None:
        """Raise KeyError or ValueError for those of another struct."""
        before = self.values
        self.set(**{name: type(before[name])(values[name]) for name in before})

    def _read(self) -> Any:
        return self.array.numpy() if self._host is None else self._host
