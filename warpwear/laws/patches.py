"""Where the patches of a two-scale contact lie, and how fields of them are stored."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from warpwear.grid import VECTOR_CELLS, FloatArray, Grid


@dataclass(frozen=True, eq=False)
class Patches:
    """Square patches lie one in each of across × across macro cells, in the order of the macro cells.

    They are stored as the kernels of `warpwear.kernels.patches` read them: one row a patch.
    """

    domain: Grid  # of all fine cells
    side: int  # of a patch, in fine cells
    pitch: int  # of a macro cell, in fine cells
    first_row: NDArray[np.int32]  # of the domain's cells, where a patch begins, shape (patches,)
    first_column: NDArray[np.int32]

    @classmethod
    def laid_out(cls, domain: Grid, *, pitch: int, side: int, seed: int | None = None) -> "Patches":
        """Return patches of side × side cells in macro cells of pitch × pitch cells.

        domain: of all fine cells. seed: of random places in the macro cells; None for their middle.
        """
        across = domain.nx // pitch
        row, column = (c.ravel() * pitch for c in np.indices((across, across)))
        room = pitch - side
        if seed is not None and room:
            dice = np.random.default_rng(seed)
            row = row + dice.integers(0, room, row.size, endpoint=True)
            column = column + dice.integers(0, room, column.size, endpoint=True)
        else:
            row, column = row + room // 2, column + room // 2
        return cls(domain, side, pitch, row.astype(np.int32), column.astype(np.int32))

    @property
    def count(self) -> int:
        """Return the number of patches."""
        return int(self.first_row.size)

    @property
    def across(self) -> int:
        """Return the number of macro cells along a side of the domain."""
        return self.domain.nx // self.pitch

    @property
    def cover_everything(self) -> bool:
        """Tell whether the patches tile the domain."""
        return self.side == self.pitch

    @property
    def uncovered(self) -> int:
        """Return the number of cells of the domain that belong to no patch."""
        return self.domain.cells - self.count * self.side**2

    @property
    def weight(self) -> float:
        """Return the area that a patch stands for over its own."""
        return (self.pitch / self.side) ** 2

    @property
    def area(self) -> float:
        """Return the area that a patch stands for [mm²], which is its macro cell's."""
        return float(self.pitch * self.domain.cell) ** 2

    @property
    def vectors(self) -> int:
        """Return the number of vectors of `VECTOR_CELLS` cells that hold a line of a patch."""
        return -(-self.side // VECTOR_CELLS)

    @property
    def grid(self) -> Grid:
        """Return the grid of the cells as they are stored: one row a patch, padding included."""
        return Grid(self.count, self.side * self.vectors * VECTOR_CELLS, self.domain.cell)

    @property
    def centres(self) -> tuple[FloatArray, FloatArray]:
        """Return the centres of the macro cells along x and y [mm], each of shape (across,)."""
        grid = Grid(self.across, self.across, self.pitch * self.domain.cell)
        return grid.x, grid.y

    def stored(self, field: FloatArray) -> FloatArray:
        """Return the patches of a field over the domain, shape (nx, ny), as they are stored; padding is 0."""
        n = self.side
        rows = np.empty((self.count, n, self.vectors * VECTOR_CELLS))
        rows[:, :, n:] = 0.0
        for patch, (row, column) in enumerate(zip(self.first_row, self.first_column, strict=True)):
            rows[patch, :, :n] = field[row : row + n, column : column + n]
        return rows.reshape(self.count, -1)

    def on_domain(self, rows: FloatArray, *, beside: float = 0.0) -> FloatArray:
        """Return a stored field over the domain, shape (nx, ny). beside: value of cells in no patch."""
        n = self.side
        shape = self.domain.shape
        field = np.empty(shape) if self.cover_everything else np.full(shape, beside)
        cells = rows.reshape(self.count, n, -1)
        for patch, (row, column) in enumerate(zip(self.first_row, self.first_column, strict=True)):
            field[row : row + n, column : column + n] = cells[patch, :, :n]
        return field
