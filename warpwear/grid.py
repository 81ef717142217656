"""The cells on which a contact is resolved."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
#: Cells of a vector: rows of fields are stored in whole ones.
VECTOR_CELLS = 8
#: What the cells of an array lie on: the disc, which other parts may follow; the counter-body; or the contact
#: of both, the domain that the disc moves under.
Frame = Literal["disc", "counter", "contact"]


@dataclass(frozen=True)
class Grid:
    """nx × ny square cells around the middle of the contact; axis 0 runs along the sliding direction."""

    nx: int
    ny: int
    cell: float  # [mm]

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of cells along both axes."""
        return self.nx, self.ny

    @property
    def cells(self) -> int:
        """Return the number of cells."""
        return self.nx * self.ny

    @property
    def cell_area(self) -> float:
        """Return the area of a cell [mm²]."""
        return self.cell**2

    @property
    def area(self) -> float:
        """Return the area of all cells [mm²]."""
        return self.cells * self.cell_area

    @property
    def x(self) -> FloatArray:
        """Return the centres of the cells along sliding [mm], shape (nx,), 0 = under the apex."""
        return _centres(self.nx, self.cell)

    @property
    def y(self) -> FloatArray:
        """Return the centres of the cells across sliding [mm], shape (ny,)."""
        return _centres(self.ny, self.cell)


def blocks_of_rows(count: int, *, values: int, together: int = 2**18) -> list[slice]:
    """Return the slices that divide `count` rows of so many values into blocks; they depend on no machine.

    together: values of a block, if not of a single row; by default 2 MiB of float64, which fit into a cache.
    """
    rows = max(together // values, 1)
    return [slice(first, min(first + rows, count)) for first in range(0, count, rows)]


def _centres(n: int, cell: float) -> FloatArray:
    return (np.arange(n, dtype=np.float64) - 0.5 * (n - 1)) * cell


def box_of(cells: NDArray[np.bool_]) -> tuple[int, int, int, int] | None:
    """Return the first and last row and column of the cells that are true; None where none is."""
    rows, columns = (np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return None
    return int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1])
