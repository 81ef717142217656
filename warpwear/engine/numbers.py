"""The host sees numbers that kernels change by their names."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import warp as wp

from warpwear.engine.executor import Field


def members_of(host: Any) -> dict[str, Any]:
    """Return views of what an array of structs holds, by name: also of what structs within it do."""
    own = {name: host[name] for name in host.dtype.names or ()}
    within = {name: view for member in own.values() for name, view in members_of(member).items()}
    return within | own


class Mirror:
    """Shows arrays of a device as the host sees them: on a CPU in place, of a GPU as last read or written.

    pinned: whether what is written goes to a GPU while the host goes on.
    """

    def __init__(self, *arrays: Field, pinned: bool = True) -> None:
        self._pairs = [
            (array, array if array.device.is_cpu else wp.zeros_like(array, device="cpu", pinned=pinned))
            for array in arrays
        ]
        self._is_far = any(array is not host for array, host in self._pairs)
        self.values: list[Any] = [host.numpy() for _, host in self._pairs]

    def read(self) -> list[Any]:
        """Wait for the device; the values of every array."""
        if self._is_far:
            for array, host in self._pairs:
                wp.copy(host, array)
            wp.synchronize_device(self._pairs[0][0].device)
        return self.values

    def write(self, *values: Any) -> None:
        """Give the arrays other values. Those that were written before must have been used."""
        for place, new in zip(self.values, values, strict=True):
            place[...] = new
        self.send()

    def send(self) -> None:
        """Give the arrays what was changed in `values`."""
        for array, host in self._pairs if self._is_far else ():
            wp.copy(array, host)


class Numbers:
    """Holds an instance of a struct in an array of one, which kernels read and, by default, write.

    On a CPU the host writes into the memory of the array, on a GPU it copies it. written: whether kernels
    write it; else a GPU's need not be read.
    """

    STATE: ClassVar = {"values": dict}
    SCRATCH: ClassVar = ("_mirror", "_host", "host")

    def __init__(
        self, kind: Any, device: Any, *, written: bool = True, **values: float | list[float]
    ) -> None:
        self.array: Field = wp.zeros(1, dtype=kind, device=device)
        self._mirror, self._written = Mirror(self.array, pinned=False), written
        #: The array as the host has it.
        self.host: Any = self._mirror.values[0]
        self._host = members_of(self.host)
        self.set(**values)

    def __getitem__(self, name: str) -> Any:
        return self._read()[name][0].item()

    def set(self, **values: float | Sequence[float]) -> None:
        """Give some of them other values."""
        host = self._read()
        for name, value in values.items():
            host[name][...] = value
        self._mirror.send()

    @property
    def values(self) -> dict[str, Any]:
        """Return all members by name, of a struct of numbers, vectors and structs of such."""
        host = self._read()
        return {name: host[name][0].tolist() for name in self.host.dtype.names}

    @values.setter
    def values(self, values: Mapping[str, Any]) -> None:
        """Raise KeyError or ValueError for those of another struct."""
        before = self.values
        self.set(**{name: type(before[name])(values[name]) for name in before})

    def _read(self) -> Any:
        if self._written:
            self._mirror.read()
        return self._host
