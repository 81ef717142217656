"""The history of a run: its rows while it goes on, its columns when it is read.

A row holds the state solved in the step and the wear of its increment; `distance` is at its end.
"""

import math
from array import array
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.quantities import UNITS


class UnknownColumnError(InputError, KeyError):
    """A column that a history does not have."""

    __str__ = Exception.__str__  # a KeyError shows its sentence in quotes


class History(dict[str, FloatArray]):
    """Column name -> one value a step, shape (steps,)."""

    def __missing__(self, name: str) -> FloatArray:
        near = get_close_matches(str(name), self, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"allowed: {', '.join(self)}"
        raise UnknownColumnError(f"history has no column {name!r}; {hint}")

    def __repr__(self) -> str:
        steps = len(next(iter(self.values()), ()))
        names = ", ".join(f"{name} [{UNITS.get(name, '?')}]" for name in self)
        return f"<History of {steps} steps: {names}>"


class Rows:
    """The rows of a run so far: as dictionaries for those who add and read them, as numbers in memory.

    A whole track makes hundreds of thousands. All have the columns of the first.
    """

    def __init__(self, rows: Iterable[dict[str, float]] = ()) -> None:
        self._names: list[str] = []
        self._values = array("d")
        for row in rows:
            self.append(row)

    def append(self, row: dict[str, float]) -> None:
        if not self._names:
            self._names = [*row]
        self._values.extend([row[name] for name in self._names])

    def __len__(self) -> int:
        return len(self._values) // max(len(self._names), 1)

    def __getitem__(self, index: int) -> dict[str, float]:
        start = range(len(self))[index] * len(self._names)
        return dict(zip(self._names, self._values[start : start + len(self._names)], strict=True))

    def __iter__(self) -> Iterator[dict[str, float]]:
        return (self[index] for index in range(len(self)))

    def column(self, name: str) -> FloatArray:
        """One value a row, shape (rows,); NaN for a column that the rows do not have."""
        if name not in self._names:
            return np.full(len(self), math.nan)
        table = np.frombuffer(self._values).reshape(len(self), len(self._names))
        return table[:, self._names.index(name)].copy()
