"""What pressures do to patches that are half-spaces of their own: the operator of all of them at once."""

from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.contact.half_space.influence import (
    Operator,
    free_spectrum,
    padded_shape,
    periodic_spectrum,
    shortest_response,
)
from warpwear.contact.half_space.transforms import CupyTransforms, Transforms, for_each, pool_for
from warpwear.engine.executor import Executor, Field
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.laws.patches import Patches

fft = lazy.module("scipy.fft")

#: Modes of the patches that a thread takes at a time: their values stay in its cache.
BLOCK = 16_384


class PatchTransforms(Transforms):
    """Transforms of patches on the CPU, each of `side` × `side` cells, zero-padded to a given shape.

    Blocks of whole patches, which do not depend on the threads, are shared among them. patches: how many of
    the first rows of the fields are transformed.
    """

    def __init__(self, executor: Executor, side: int, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        self._side = side
        self.patches = executor.grid.nx
        modes = shape[0] * (shape[1] // 2 + 1)
        self._block = max(1, BLOCK // modes)
        self._pool = pool_for(executor, self.patches * modes)

    def filter(
        self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False, single: bool = False
    ) -> None:
        """field_out = inverse(forward(field_in) × table), patch by patch; may be the same field.

        divide: ÷ instead, in single precision; modes where the table is 0 are left out. single: not used.
        """
        self.transforms += 1
        side, shape, axes = self._side, self.shape, (1, 2)
        values, result = (_cells(field.numpy(), side) for field in (field_in, field_out))
        factor: Any = table
        real: Any = np.float64
        if divide:
            factor = np.divide(1.0, table, out=np.zeros_like(table), where=table > 0.0).astype(np.float32)
            real = np.float32

        def work(first: int) -> None:
            block = slice(first, min(first + self._block, self.patches))
            spectrum = fft.rfft2(values[block].astype(real, copy=False), s=shape, axes=axes)
            spectrum *= factor
            found = fft.irfft2(spectrum, s=shape, axes=axes, overwrite_x=True)
            result[block] = found[:, :side, :side]

        for_each(self._pool, work, range(0, self.patches, self._block))


class CupyPatchTransforms(CupyTransforms):
    """On a GPU, all patches at once."""

    def __init__(self, executor: Executor, side: int, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        self._side = side
        self.patches = executor.grid.nx

    def _cells(self, field: Field) -> Any:
        return _cells(self._cupy.asarray(field), self._side)[: self.patches]


def _cells(values: Any, side: int) -> Any:
    """A view of the cells of patches as they are stored, shape (patches, side, side)."""
    return values.reshape(values.shape[0], side, -1)[:, :, :side]


class PatchInfluence(Operator):
    """The operator of patches of which each displaces itself alone, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (each patch repeats itself; the mean
    displacement, which has no limit then, is the business of the bulk behind the patch, see `set_bulk`) or
    "free" (nothing outside a patch, whose mean displacement is then contained). executor: on `patches.grid`.
    """

    _far: PatchTransforms | CupyPatchTransforms
    _near: PatchTransforms | CupyPatchTransforms

    def __init__(self, executor: Executor, patches: Patches, *, modulus: float, boundary: str) -> None:
        side, cell = patches.side, patches.domain.cell
        self._executor = executor
        self._boundary = boundary
        self.cells = patches.count * side**2
        self.shortest_response = shortest_response(cell, modulus)
        make = PatchTransforms if executor.device.is_cpu else CupyPatchTransforms
        grid = Grid(side, side, cell)
        self._near = self._far = make(executor, side, grid.shape)
        self._periodic = periodic_spectrum(grid, modulus)
        self._spectrum = self._periodic
        if boundary == "free":
            padded = padded_shape(grid)
            self._far = make(executor, side, padded)
            self._spectrum = free_spectrum(grid, modulus, padded)
        self._bulk = self._own = 0.0
        self._make_tables()
        self.visit(patches.count)

    def visit(self, patches: int) -> None:
        """Leave out all but the first `patches`; the pressures of the others stay, which must be 0."""
        self._near.patches = self._far.patches = patches
        self.chunks = self._executor.split_rows(np.full(patches, self._executor.grid.ny))

    def set_bulk(self, flexibility: float) -> None:
        """1/K_N of the spring behind every patch [mm³/N]; it yields to the patch's mean pressure."""
        if flexibility and self._boundary == "free":
            raise InputError("a free patch contains its mean displacement; a bulk would count it twice.")
        if flexibility != self._bulk:
            self._bulk = flexibility
            self._make_tables()

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """Add to the elastic response to a cell's own pressure [mm/MPa]; patches have no streaks."""
        assert streak == 0.0
        if own != self._own:
            self._own = own
            self._make_tables()

    def _make_tables(self) -> None:
        self._response = self._far.table(self._with(self._spectrum, self._bulk) + self._own)
        # A mean that displaces nothing, or that Fourier modes do not tell of, yields as the longest waves.
        mean = self._bulk or (0.0 if self._own else float(self._periodic.max()))
        if self._boundary == "free":
            mean = 3.0 * float(self._periodic.max())
        self._nearby = self._near.table(self._with(self._periodic, mean) + self._own)

    @staticmethod
    def _with(spectrum: FloatArray, mean: float) -> FloatArray:
        """A copy of a spectrum, with more displacement by the mean pressure [mm/MPa]."""
        found = spectrum.copy()
        found[0, 0] += mean
        return found
