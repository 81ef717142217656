"""The history of a run is rows while it goes on, and columns when it is read.

A row holds the state solved in the step and the wear of its increment; `distance` is at its end.
"""

import math
from array import array
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from operator import itemgetter
from typing import TypeVar

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.quantities import PATCH_TABLES, unit_of

Value = TypeVar("Value")


class UnknownColumnError(InputError, KeyError):
    """Refuse a column that a history does not have."""

    __str__ = Exception.__str__  # a KeyError shows its sentence in quotes


class Named(dict[str, Value]):
    """Name of a column -> what is known of it; the nearest name is told of one that is not there."""

    _says = "there is no column, field or table"

    def __missing__(self, name: str) -> Value:
        near = get_close_matches(str(name), self, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"allowed: {', '.join(self)}"
        raise UnknownColumnError(f"{self._says} {name!r}; {hint}")


class History(Named[FloatArray]):
    """Map the name of a column to one value a step, shape (steps,)."""

    _says = "history has no column"

    def __missing__(self, name: str) -> FloatArray:
        if any(name == quantity.name for quantity in PATCH_TABLES):
            raise UnknownColumnError(
                f"{self._says} {name!r}: it is one of every patch of a two-scale run: result.{name}"
            )
        return super().__missing__(name)

    def __repr__(self) -> str:
        steps = len(next(iter(self.values()), ()))
        names = ", ".join(f"{name} [{unit_of(name)}]" for name in self)
        return f"<History of {steps} steps: {names}>"


class Rows:
    """Hold the rows of a run so far, as numbers in memory: a whole track makes hundreds of thousands.

    names: of the columns, those of the first row if none are given. table: rows to begin with, shape
    (rows, columns).
    """

    def __init__(self, names: Iterable[str] = (), table: FloatArray | None = None) -> None:
        self.names = [*names]
        self._of: Callable[[Mapping[str, float]], tuple[float, ...]] | None = None
        self._values = array("d", () if table is None else table.ravel())

    def append(self, row: Mapping[str, float]) -> None:
        """Add a row, by the names of its columns."""
        if self._of is None:
            self.names = self.names or [*row]
            self._of = itemgetter(*self.names)
        self._values.fromlist([*self._of(row)])

    def extend(self, columns: Mapping[str, FloatArray]) -> None:
        """Add rows, by columns of one value each."""
        self.names = self.names or [*columns]
        self._values.frombytes(np.stack([columns[name] for name in self.names], axis=1).tobytes())

    def __len__(self) -> int:
        return len(self._values) // max(len(self.names), 1)

    @property
    def last(self) -> dict[str, float]:
        """Return the last row, by the names of its columns."""
        return dict(zip(self.names, self._values[-len(self.names) :], strict=True))

    @property
    def table(self) -> FloatArray:
        """Return all rows, shape (rows, columns)."""
        return np.array(self._values).reshape(len(self), len(self.names))

    def column(self, name: str) -> FloatArray:
        """Return one value a row, shape (rows,); NaN for a column that the rows do not have."""
        if name not in self.names:
            return np.full(len(self), math.nan)
        table = np.frombuffer(self._values).reshape(len(self), len(self.names))
        return table[:, self.names.index(name)].copy()  # the array cannot grow while it is seen
