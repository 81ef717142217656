"""The book of the pieces that have left the bodies of a contact: when, where from and how large."""

from typing import Any, ClassVar

import numpy as np

from warpwear.grid import FloatArray

#: Columns of the table.
COLUMNS = ("step", "body", "row", "column", "volume", "diameter")


class PieceBook:
    """Grows by the pieces of each step. body: 0 the sphere, 1 the disc; row and column are of its cells."""

    STATE: ClassVar = {"table": np.ndarray, "_steps": int}

    def __init__(self) -> None:
        self._parts = [np.zeros((0, len(COLUMNS)))]
        self._steps = 0

    def enter(
        self, body: int, row: "np.ndarray[Any, Any]", column: Any, volume: FloatArray, diameter: FloatArray
    ) -> None:
        """Enter pieces of a body in the step at hand: volume [mm³], and diameter as cut [mm], each."""
        number, of_body = np.full(row.size, self._steps), np.full(row.size, body)
        self._parts.append(np.stack([number, of_body, row, column, volume, diameter], axis=1))

    def end_step(self) -> None:
        """Go on to the next step."""
        self._steps += 1

    @property
    def table(self) -> FloatArray:
        """All pieces in the order in which they left, shape (pieces, columns); may be set."""
        self._parts = [np.concatenate(self._parts)]
        return self._parts[0]

    @table.setter
    def table(self, table: FloatArray) -> None:
        self._parts = [table]
