"""Displace patches that are half-spaces of their own: the operator of all of them at once."""

from functools import cached_property

import numpy as np

from warpwear.contact.half_space import influence
from warpwear.contact.half_space.filters import filter_of
from warpwear.contact.half_space.transforms import Filter, Grids
from warpwear.engine.executor import Executor
from warpwear.grid import Grid
from warpwear.laws.patches import Patches


class PatchInfluence(influence.Operator):
    """Applies the operator of patches of which each displaces itself alone, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (each patch repeats itself; the mean
    displacement, which has no limit then, is the business of the bulk behind the patch, see `set_bulk`) or
    "free" (nothing outside a patch, whose mean displacement is then contained). executor: on `patches.grid`.
    """

    def __init__(self, executor: Executor, patches: Patches, *, modulus: float, boundary: str) -> None:
        side, cell = patches.side, patches.domain.cell
        grid = Grid(side, side, cell)
        self._is_free = boundary == "free"
        super().__init__(executor, influence.padded_shape(grid) if self._is_free else grid.shape, grid.shape)
        self.cells = patches.count * side**2
        self.shortest_response = influence.shortest_response(cell, modulus)
        self._grids = Grids.squares(executor, side)
        self.visited = self._grids.visited
        self._near_table = influence.periodic_spectrum(grid, modulus, rows=side // 2 + 1)
        self._longest = float(self._near_table.max())
        self._far_table = (
            influence.free_quarter(grid, modulus, self.far_shape)
            if self._is_free
            else self._near_table.copy()
        )
        self._bulk = self._own = 0.0
        self._set_means()
        self.visit(patches.count)

    @cached_property
    def _far(self) -> Filter:
        return filter_of(self._executor, self._far_table, self.far_shape, np.float64, grids=self._grids)

    @cached_property
    def _near(self) -> Filter:
        shape = self._grids.rows, self._grids.columns
        return filter_of(
            self._executor, self._near_table, shape, np.float32, grids=self._grids, within=self._far
        )

    def visit(self, patches: int) -> None:
        """Leave out all but the first `patches`; the pressures of the others stay, which must be 0."""
        self._executor.put(self._grids.visited, patches)
        self.chunks = self._executor.split_rows(np.full(patches, self._executor.grid.ny))

    def set_bulk(self, flexibility: float) -> None:
        """Set 1/K_N of the spring behind every patch [mm³/N]; it yields to the patch's mean pressure."""
        assert not (flexibility and self._is_free)  # whose mean displacement is contained
        if flexibility != self._bulk:
            self._bulk = flexibility
            self._set_means()

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response to a cell's own pressure [mm/MPa]; patches have no streaks."""
        assert streak == 0.0
        if own != self._own:
            self._own = own
            for line in (self.line, self.near_line):
                self._executor.put(line, own)
            self._set_means()

    def _set_means(self) -> None:
        """Let the mean pressure of a patch displace it; programs recorded before heed it."""
        if self._is_free:
            self._near.set_mean(3.0 * self._longest)
            return
        self._far.set_mean(self._bulk)
        # A mean that displaces nothing, or that Fourier modes do not tell of, yields as the longest waves.
        self._near.set_mean(self._bulk or (0.0 if self._own else self._longest))
