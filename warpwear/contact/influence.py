"""What a pressure does to an elastic half-space, and the inverse that preconditions the solver.

Displacement and pressure are tied by a convolution, done in Fourier space. The transforms come from a
library, `scipy.fft` on a CPU and CuPy on a GPU, behind `Transforms`; it works on Warp's own arrays.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.engine.executor import Executor, Field
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid

fft = lazy.module("scipy.fft")

#: Fewer modes a thread are not worth a pool.
MODES_PER_THREAD = 30_000
#: Blocks that a thread takes at a time: so many of the rows, so wide of the columns.
ROW_BLOCKS, COLUMNS = 16, 64
#: Below any response [mm/MPa].
SMALLEST = 1.0e-300


class Transforms(ABC):
    """Real transforms of the fields of one executor, zero-padded to a given shape.

    transforms: pairs (one forward and one inverse) done so far.
    """

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        self._executor = executor
        self._shape = shape
        self.transforms = 0

    @abstractmethod
    def table(self, values: FloatArray) -> Any:
        """A table for `filter` where the transforms are done, from one of shape (n, m//2 + 1)."""

    @abstractmethod
    def added(self, table: Any, own: float, line: FloatArray) -> Any:
        """A table and what adds to it: the same everywhere, and by row, shape (n,)."""

    @abstractmethod
    def filter(self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False) -> None:
        """field_out = inverse(forward(field_in) × table), on the cells of the grid; may be the same field.

        divide: ÷ instead of ×; modes where the table is 0 are left out. For a preconditioner, so single
        precision will do.
        """


class ScipyTransforms(Transforms):
    """On the CPU. Blocks of rows, then of columns, are shared among as many threads as the executor has.

    The blocks do not depend on the threads, so neither do the results. A block of columns is transformed,
    multiplied and transformed back while it is in the cache; rows and columns of padding are never stored.
    """

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        self._fft: Any = fft
        nx, modes = executor.grid.nx, shape[1] // 2 + 1
        #: Without padding the spectrum lies in the cells of the result, but for the last column.
        self._held = modes - 1 if shape == executor.grid.shape else 0
        self._spectrum = np.empty((nx, modes - self._held), dtype=np.complex128)
        self._rows = _blocks(0, nx, -(-nx // ROW_BLOCKS))
        self._columns = _blocks(0, self._held, COLUMNS) + _blocks(self._held, modes, COLUMNS)
        threads = executor.threads if nx * modes >= MODES_PER_THREAD * 2 else 1
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None

    def table(self, values: FloatArray) -> FloatArray:
        return values

    def added(self, table: Any, own: float, line: FloatArray) -> FloatArray:
        found: FloatArray = table + (own + line[:, np.newaxis])
        return found

    def filter(self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False) -> None:
        self.transforms += 1
        fft, held = self._fft, self._held
        real: Any = np.float32 if divide else np.float64
        kind: Any = np.complex64 if divide else np.complex128
        nx, ny = self._executor.grid.shape
        values, result = self._executor.to_numpy(field_in), self._executor.to_numpy(field_out)
        first: Any = result[:, : 2 * held].view(kind)[:, :held]
        rest: Any = self._spectrum.view(kind)[:, : self._spectrum.shape[1]]

        def forward(rows: slice) -> None:
            lines = fft.rfft(values[rows].astype(real, copy=False), n=self._shape[1], axis=1)
            first[rows], rest[rows] = lines[:, :held], lines[:, held:]

        def across(columns: slice) -> None:
            part = first if columns.start < held else rest
            start = columns.start if columns.start < held else columns.start - held
            block = part[:, start : start + columns.stop - columns.start]
            lines = fft.fft(block, n=self._shape[0], axis=0, overwrite_x=True)
            factor = table[:, columns].astype(real, copy=False)
            if divide:
                np.divide(lines, factor, out=lines, where=factor > 0.0)
                lines[factor == 0.0] = 0.0
            else:
                lines *= factor
            block[:] = fft.ifft(lines, axis=0, overwrite_x=True)[:nx]

        def back(rows: slice) -> None:
            lines = np.concatenate([first[rows], rest[rows]], axis=1) if held else rest[rows]
            result[rows] = fft.irfft(lines, n=self._shape[1], axis=1, overwrite_x=True)[:, :ny]

        self._each(forward, self._rows)
        self._each(across, self._columns)
        self._each(back, self._rows)

    def _each(self, work: Callable[[slice], None], blocks: list[slice]) -> None:
        if self._pool is None:
            for block in blocks:
                work(block)
        else:
            list(self._pool.map(work, blocks))


class CupyTransforms(Transforms):
    """On a GPU, in the stream of Warp's device; arrays are shared through `__cuda_array_interface__`."""

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        try:
            self._cupy: Any = lazy.load("cupy")
        except ImportError as error:
            raise InputError(
                f'contact.law = "half-space" on device = {str(executor.device)!r} needs CuPy for its Fourier '
                "transforms: pip install cupy-cuda12x (the extra gpu) or cupy-cuda13x (gpu13), for its CUDA, "
                "or use the device cpu."
            ) from error
        device = executor.device
        self._device = self._cupy.cuda.Device(device.ordinal)
        with self._device:
            self._stream = _stream_of(self._cupy.cuda, device)
        #: The last table that was divided by, and its reciprocals in single precision.
        self._divisor: tuple[Any, Any] = None, None

    def table(self, values: FloatArray) -> Any:
        with self._device, self._stream:
            return self._cupy.asarray(values)

    def added(self, table: Any, own: float, line: FloatArray) -> Any:
        with self._device, self._stream:
            return table + self._cupy.asarray(own + line[:, np.newaxis])

    def filter(self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False) -> None:
        self.transforms += 1
        cupy, fft = self._cupy, self._cupy.fft
        with self._device, self._stream:
            values, result = self._cells(field_in), self._cells(field_out)
            nx, ny = result.shape[-2:]
            if divide:
                values, table = values.astype(cupy.float32), self._reciprocals(table)
            spectrum = fft.rfft2(values, s=self._shape)
            spectrum *= table
            result[:] = fft.irfft2(spectrum, s=self._shape)[..., :nx, :ny]

    def _reciprocals(self, table: Any) -> Any:
        """1/table, 0 where it is 0."""
        if self._divisor[0] is not table:
            cupy = self._cupy
            values = cupy.where(table > 0.0, 1.0 / cupy.maximum(table, SMALLEST), 0.0)
            self._divisor = table, values.astype(cupy.float32)
        return self._divisor[1]

    def _cells(self, field: Field) -> Any:
        """A view of a field's cells, shape (nx, ny)."""
        return self._cupy.asarray(field).reshape(field.shape[0], -1)[:, : self._executor.grid.ny]


def _stream_of(cuda: Any, device: Any) -> Any:
    """The stream of Warp's device for CuPy, which leaves it to Warp."""
    if hasattr(cuda.Stream, "from_external"):  # since 14.0, which deprecates the other
        return cuda.Stream.from_external(device.stream)
    return cuda.ExternalStream(device.stream.cuda_stream, device.ordinal)


def _blocks(first: int, end: int, length: int) -> list[slice]:
    return [slice(start, min(start + length, end)) for start in range(first, end, length)]


class Influence:
    """The operator G + c + streak of one grid and boundary, and an approximate inverse.

    modulus: E* of both bodies together [MPa]. boundary: "periodic" (the mean displacement is left out, since
    it has no limit: gaps count from the mean planes) or "free" (nothing outside the grid; the displacement is
    that of uniform pressures on square cells, exact; Love 1929, Phil. Trans. R. Soc. A 228, 377; Johnson,
    Contact Mechanics, 1985, section 3.3). Call `set_compliance` before use.
    """

    def __init__(self, executor: Executor, *, modulus: float, boundary: str) -> None:
        grid = executor.grid
        if not (math.isfinite(modulus) and modulus > 0.0):
            raise InputError(f"E* = {modulus:g} MPa is not possible; it must be positive and finite.")
        if boundary not in ("periodic", "free"):
            raise InputError(
                f'contact.boundary = {boundary!r} is unknown; allowed are "periodic" and "free".'
            )
        self._boundary = boundary
        self._streak_cells = grid.nx
        self.cells = grid.cells
        self.shortest_response = shortest_response(grid.cell, modulus)
        #: Of slots for the threads: all, by whole rows.
        self.chunks: list[tuple[int, int]] | None = None
        make: Callable[..., Transforms] = ScipyTransforms if executor.device.is_cpu else CupyTransforms
        self._near = make(executor, grid.shape)
        elastic = periodic_spectrum(grid, modulus)
        if boundary == "periodic":
            self._far = self._near
            self._elastic = self._near_elastic = self._near.table(elastic)
        else:
            # The mean that a periodic surface leaves out: that of a uniform pressure, about.
            elastic[0, 0] = 3.0 * elastic.max()
            self._near_elastic = self._near.table(elastic)
            padded = padded_shape(grid)
            self._far = make(executor, padded)
            self._elastic = self._far.table(free_spectrum(grid, modulus, padded))
        self._compliance: tuple[float, float, int] | None = None
        self.set_compliance(0.0, 0.0)

    @property
    def transforms(self) -> int:
        """Pairs of transforms done so far, of the response and of its inverse."""
        return self._far.transforms + (self._near.transforms if self._near is not self._far else 0)

    def set_compliance(self, own: float, streak: float, window: int | None = None) -> None:
        """What adds to the elastic response [mm/MPa]: own × p of the cell, and streak × S S p.

        S is a mean along x over so many cells, around each of them: of an even number the cell at either end
        counts half. None, or as many cells as the grid has rows: S is the mean of the line, and so is S S.
        """
        line = self._streak_cells
        asked = own, streak, line if window is None else min(window, line)
        if self._compliance == asked:
            return
        self._compliance = asked
        self._response = self._with(self._far, self._elastic, *asked)
        self._nearby = self._response
        if self._near is not self._far:
            self._nearby = self._with(self._near, self._near_elastic, *asked)

    def _with(self, transforms: Transforms, elastic: Any, own: float, streak: float, window: int) -> Any:
        if own == 0.0 and streak == 0.0:
            return elastic
        # The spectrum of a mean is that of its coefficients.
        rows = elastic.shape[0]
        distance = np.minimum(np.arange(rows), rows - np.arange(rows))
        if window == self._streak_cells:
            line = np.fft.fft(np.where(distance < window, 1.0 / window, 0.0)).real
        else:
            inside = np.where(2 * distance < window, 1.0, np.where(2 * distance == window, 0.5, 0.0))
            line = np.fft.fft(inside / window).real ** 2
        return transforms.added(elastic, own, streak * line)

    def respond(self, pressure: Field, displacement: Field) -> None:
        """Displacement [mm] under a pressure [MPa], compliances included."""
        self._far.filter(pressure, self._response, displacement)

    def invert(self, displacement: Field, pressure: Field) -> None:
        """About the pressure [MPa] of a displacement [mm]: |q| E*/2 without compliances. May be in place."""
        self._near.filter(displacement, self._nearby, pressure, divide=True)


def periodic_spectrum(grid: Grid, modulus: float) -> FloatArray:
    """2/(E*|q|) of the modes of a real transform [mm/MPa], shape (nx, ny//2 + 1), 0 for the mean."""
    q_x = 2.0 * math.pi * np.fft.fftfreq(grid.nx, grid.cell)
    q_y = 2.0 * math.pi * np.fft.rfftfreq(grid.ny, grid.cell)
    q = np.hypot(q_x[:, np.newaxis], q_y)
    spectrum: FloatArray = np.divide(2.0 / modulus, q, out=np.zeros_like(q), where=q > 0.0)
    return spectrum


def shortest_response(cell: float, modulus: float) -> float:
    """Displacement under a pressure that alternates from cell to cell [mm/MPa]."""
    return 2.0 * cell / (math.pi * modulus)


def padded_shape(grid: Grid) -> tuple[int, int]:
    """An even shape on which the convolution of the grid does not wrap, quick to transform."""
    next_fast_len = fft.next_fast_len
    return 2 * next_fast_len(grid.nx), 2 * next_fast_len(grid.ny, real=True)


def free_spectrum(grid: Grid, modulus: float, shape: tuple[int, int]) -> FloatArray:
    """Of the modes of a real transform [mm/MPa], on an even shape: (shape[0], shape[1]//2 + 1).

    The coefficients are even in both directions: a cosine transform of a quarter of them is their spectrum.
    """
    quarter = fft.dctn(
        free_coefficients(grid.cell, modulus, shape[0] // 2 + 1, shape[1] // 2 + 1), type=1, overwrite_x=True
    )
    rows = np.arange(shape[0])
    return np.asarray(quarter[np.minimum(rows, shape[0] - rows)])


def free_coefficients(cell: float, modulus: float, rows: int, columns: int) -> FloatArray:
    """Displacement at a cell's centre under a unit pressure on another [mm/MPa], by distance in cells.

    Four corner terms, x ln(y + r) + y ln(x + r), over π E* (Johnson eq 3.25). Shape (rows, columns).
    """
    corners_x, corners_y = ((np.arange(n + 1) - 0.5)[:, np.newaxis] * cell for n in (rows, columns))
    x, y = corners_x, corners_y.T
    # by inverse hyperbolic sines: the logarithms differ by what cancels between the corners
    corner = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    total = corner[1:, 1:] - corner[1:, :-1] - corner[:-1, 1:] + corner[:-1, :-1]
    return np.asarray(total / (math.pi * modulus))
