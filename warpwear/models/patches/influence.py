"""Displace patches that are half-spaces of their own: the operator of all of them at once."""

import numpy as np

from warpwear.contact.half_space.influence import Influence
from warpwear.engine.executor import Executor
from warpwear.laws.patches import Patches


class PatchInfluence(Influence):
    """Applies the operator of patches of which each displaces itself alone, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (each patch repeats itself; the mean
    displacement, which has no limit then, is the business of the bulk behind the patch, see `set_bulk`) or
    "free" (nothing outside a patch, whose mean displacement is then contained). executor: on `patches.grid`.
    """

    _bulk = 0.0  # 1/K_N of the spring behind every patch [mm³/N]

    def __init__(self, executor: Executor, patches: Patches, *, modulus: float, boundary: str) -> None:
        super().__init__(executor, modulus=modulus, boundary=boundary, side=patches.side)
        self.visited = self._grids.visited
        self.visit(patches.count)

    def visit(self, patches: int) -> None:
        """Leave out all but the first `patches`; the pressures of the others stay, which must be 0."""
        self._executor.put(self._grids.visited, patches)
        self.chunks = self._executor.split_rows(np.full(patches, self._executor.grid.ny))

    def set_bulk(self, flexibility: float) -> None:
        """Set 1/K_N of the spring behind every patch [mm³/N]; it yields to the patch's mean pressure."""
        if flexibility != self._bulk:
            assert all(self.wraps)  # else the mean displacement is contained
            self._bulk = flexibility
            self._set_means()

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response to a cell's own pressure [mm/MPa]; patches have no streaks."""
        assert streak == 0.0
        before = self._compliance
        super().set_compliance(own, streak, window)
        if self._compliance != before and all(self.wraps):
            self._set_means()

    def _set_means(self) -> None:
        """Let the mean pressure of a patch displace it; programs recorded before heed it."""
        assert self._compliance is not None
        self._far.set_mean(self._bulk)
        # A mean that displaces nothing, or that Fourier modes do not tell of, yields as the longest waves.
        longest = 0.0 if self._compliance[0] else float(self.near_elastic.max())
        self._near.set_mean(self._bulk or longest)
