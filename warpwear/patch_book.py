"""What each patch did in every step: its load share and its real area of contact."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history import Column
from warpwear.patches import Patches

#: Tables of shape (steps, patches), patches in the order of `Patches`: x · across + y.
COLUMNS = (
    Column("load_share", "N", "load of each patch, or of the macro cell that it stands for"),
    Column("area_patch", "mm^2", "real area of contact of each, or of its macro cell"),
)


def bytes_of_book(steps: int, patches: int) -> int:
    """What the tables take of memory at most: as they grow and, for a checkpoint, as they are written."""
    return 2 * len(COLUMNS) * 8 * steps * patches


class PatchBook:
    """Grows by a row of each table a step."""

    def __init__(self, patches: Patches) -> None:
        self.patches = patches
        self._rows: dict[str, list[FloatArray]] = {column.name: [] for column in COLUMNS}

    def enter(self, **row: FloatArray) -> None:
        """Values of one step by the names of `COLUMNS`, shape (patches,) each."""
        for name, values in row.items():
            self._rows[name].append(values)

    def table(self, name: str) -> FloatArray:
        """Shape (steps, patches)."""
        return np.array(self._rows[name]).reshape(-1, self.patches.count)

    def saved_state(self) -> dict[str, Any]:
        """Arrays that `restore` takes back."""
        return {column.name: self.table(column.name) for column in COLUMNS}

    def restore(self, arrays: Mapping[str, Any]) -> None:
        for column in COLUMNS:
            self._rows[column.name] = list(arrays[column.name])
