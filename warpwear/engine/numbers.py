"""Numbers that kernels change, seen by the host by their names."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Field
from warpwear.grid import FloatArray


class Table:
    """A table of numbers that kernels read or write, rows × columns, and the host by rows."""

    def __init__(self, rows: int, columns: int, device: Any) -> None:
        self.array: Field = wp.zeros((rows, columns), dtype=wp.float64, device=device)
        self._host = self.array.numpy() if device.is_cpu else None

    def write(self, rows: Sequence[Sequence[float]]) -> None:
        """Give the first rows other values."""
        if self._host is not None:
            self._host[: len(rows)] = rows
        else:
            host: Field = wp.array(np.array(rows), dtype=wp.float64, device="cpu")
            wp.copy(self.array, host, count=host.size)

    def read(self, rows: int) -> FloatArray:
        """The first rows; on a CPU a view."""
        if self._host is not None:
            return self._host[:rows]
        values: FloatArray = self.array[:rows].numpy() if rows else np.zeros((0, self.array.shape[1]))
        return values


class Numbers:
    """An instance of a struct in an array of one, which kernels read and, by default, write.

    On a CPU the host writes into the memory of the array, on a GPU it copies it. written: whether kernels
    write it; else a GPU's need not be read.
    """

    STATE: ClassVar = {"values": dict}

    def __init__(self, kind: Any, device: Any, *, written: bool = True, **values: float) -> None:
        self.array: Field = wp.zeros(1, dtype=kind, device=device)
        self._on_gpu = not device.is_cpu
        self._host = None if self._on_gpu and written else self.array.numpy()
        self.set(**values)

    def __getitem__(self, name: str) -> Any:
        return self._read()[name][0].item()

    def set(self, **values: float) -> None:
        """Give some of them other values."""
        host = self._read()
        for name, value in values.items():
            host[name] = value
        if self._on_gpu:
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


class Mirror:
    """Arrays of a device as the host sees them: on a CPU in place, of a GPU as they were when last read."""

    def __init__(self, *arrays: Field) -> None:
        self._arrays = arrays
        self._host = [
            array if array.device.is_cpu else wp.zeros_like(array, device="cpu", pinned=True)
            for array in arrays
        ]
        self._values = [host.numpy() for host in self._host]

    def read(self) -> list[Any]:
        """Wait for the device; the values of every array."""
        for array, host in zip(self._arrays, self._host, strict=True):
            if array is not host:
                wp.copy(host, array)
        wp.synchronize_device(self._arrays[0].device)
        return self._values
