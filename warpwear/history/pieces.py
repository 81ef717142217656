"""A book lists the pieces that have left the bodies of a contact: when, where from and how large."""

from typing import Any, ClassVar

import numpy as np

from warpwear.grid import FloatArray

#: Columns of the table.
COLUMNS = ("step", "body", "row", "column", "volume", "diameter")


class PieceBook:
    """Grows by the pieces of each step. body: 0 the ball, 1 the disc; row and column are of its cells."""

    STATE: ClassVar = {"table": np.ndarray, "_steps": int}

    def __init__(self) -> None:
        self._parts = [np.zeros((0, len(COLUMNS)))]
        self._steps = 0

    def enter(
        self, step: Any, body: Any, place: tuple[Any, Any], volume: FloatArray, diameter: FloatArray
    ) -> None:
        """Enter pieces: of each the step from the one at hand on, its body, the row and column of its cell.

        volume [mm³] and diameter as cut [mm] are of each.
        """
        self._parts.append(np.stack([self._steps + step, body, *place, volume, diameter], axis=1))

    def end_steps(self, count: int = 1) -> None:
        """Go on by some steps."""
        self._steps += count

    @property
    def table(self) -> FloatArray:
        """Return all pieces in the order in which they left, shape (pieces, columns); may be set."""
        self._parts = [np.concatenate(self._parts)]
        return self._parts[0]

    @table.setter
    def table(self, table: FloatArray) -> None:
        self._parts = [table]
