"""What a pressure does to an elastic half-space, and the inverse that preconditions the solver.

Displacement and pressure are tied by a convolution, done in Fourier space. The transforms come from a
library, `scipy.fft` on a CPU and CuPy on a GPU, behind `Transforms`; it works on Warp's own arrays.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.execution import Executor, Field
from warpwear.grid import FloatArray, Grid

#: Fewer modes than this are multiplied on one thread.
MODES_PER_THREAD = 100_000


class Transforms(ABC):
    """Real transforms of the fields of one executor, zero-padded to a given shape.

    transforms: pairs (one forward and one inverse) done so far.
    """

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        self._executor = executor
        self._shape = shape
        self._padded = shape != executor.grid.shape
        self.transforms = 0

    @abstractmethod
    def table(self, values: FloatArray) -> Any:
        """An array that `filter` multiplies with, where the transforms are done."""

    @abstractmethod
    def filter(self, field_in: Field, table: Any, field_out: Field) -> None:
        """field_out = inverse(forward(field_in) × table), on the cells of the grid; may be the same field."""


class ScipyTransforms(Transforms):
    """On the CPU, with as many workers as the executor has threads.

    Only rows that hold cells are transformed along axis 1: padding costs nothing there.
    """

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        self._fft: Any = import_module("scipy.fft")  # takes 0.1 s: not for a run without
        modes = shape[0] * (shape[1] // 2 + 1)
        self._chunks = max(1, min(executor.threads, modes // MODES_PER_THREAD))
        self._pool = ThreadPoolExecutor(self._chunks) if self._chunks > 1 else None

    def table(self, values: FloatArray) -> FloatArray:
        return values

    def filter(self, field_in: Field, table: Any, field_out: Field) -> None:
        nx, ny = self._executor.grid.shape
        workers = self._executor.threads
        self.transforms += 1
        values = self._executor.to_numpy(field_in)
        spectrum = self._fft.rfft(values, n=self._shape[1], axis=1, workers=workers)
        spectrum = self._fft.fft(spectrum, n=self._shape[0], axis=0, workers=workers, overwrite_x=True)
        self._multiply(spectrum, table)
        spectrum = self._fft.ifft(spectrum, axis=0, workers=workers, overwrite_x=True)[:nx]
        result = self._fft.irfft(spectrum, n=self._shape[1], axis=1, workers=workers, overwrite_x=True)
        self._executor.to_numpy(field_out)[:] = result[:, :ny]

    def _multiply(self, spectrum: Any, table: Any) -> None:
        edges = [len(table) * i // self._chunks for i in range(self._chunks + 1)]

        def chunk(number: int) -> None:
            rows = slice(edges[number], edges[number + 1])
            np.multiply(spectrum[rows], table[rows], out=spectrum[rows])

        if self._pool is None:
            chunk(0)
        else:
            list(self._pool.map(chunk, range(self._chunks)))


class CupyTransforms(Transforms):
    """On a GPU, in the stream of Warp's device; arrays are shared through `__cuda_array_interface__`."""

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        super().__init__(executor, shape)
        try:
            self._cupy: Any = import_module("cupy")
        except ImportError as error:
            raise InputError(
                f'contact.law = "half-space" on device = {str(executor.device)!r} needs CuPy for its Fourier '
                "transforms: pip install warpwear[gpu], or use the device cpu."
            ) from error
        device = executor.device
        self._device = self._cupy.cuda.Device(device.ordinal)
        self._stream = self._cupy.cuda.ExternalStream(device.stream.cuda_stream, device.ordinal)

    def table(self, values: FloatArray) -> Any:
        with self._device, self._stream:
            return self._cupy.asarray(values)

    def filter(self, field_in: Field, table: Any, field_out: Field) -> None:
        fft = self._cupy.fft
        nx, ny = self._executor.grid.shape
        self.transforms += 1
        with self._device, self._stream:
            spectrum = fft.rfft(self._cells(field_in), n=self._shape[1], axis=1)
            spectrum = fft.fft(spectrum, n=self._shape[0], axis=0)
            spectrum *= table
            spectrum = fft.ifft(spectrum, axis=0)[:nx]
            self._cells(field_out)[:] = fft.irfft(spectrum, n=self._shape[1], axis=1)[:, :ny]

    def _cells(self, field: Field) -> Any:
        """A view of a field's cells, shape (nx, ny)."""
        return self._cupy.asarray(field).reshape(field.shape[0], -1)[:, : self._executor.grid.ny]


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
        self._executor = executor
        self._boundary = boundary
        make: Callable[..., Transforms] = ScipyTransforms if executor.device.is_cpu else CupyTransforms
        self._inverse_transforms = make(executor, grid.shape)
        if boundary == "periodic":
            self._transforms = self._inverse_transforms
            self._elastic = periodic_spectrum(grid, modulus)
            self._near = self._elastic
        else:
            padded = padded_shape(grid)
            self._transforms = make(executor, padded)
            self._elastic = _spectrum(free_coefficients(grid, modulus, padded))
            self._near = periodic_spectrum(grid, modulus)
            # The mean that a periodic surface leaves out: that of a uniform pressure, by order of magnitude.
            self._near[0, 0] = 2.0 * self._near.max()
        self._compliance: tuple[float, float] | None = None
        self.set_compliance(0.0, 0.0)

    @property
    def transforms(self) -> int:
        """Pairs of transforms done so far, of the response and of its inverse."""
        both = {id(t): t.transforms for t in (self._transforms, self._inverse_transforms)}
        return sum(both.values())

    @property
    def rigid_mean(self) -> bool:
        """Whether a uniform pressure displaces nothing."""
        return self._boundary == "periodic" and self._compliance == (0.0, 0.0)

    def set_compliance(self, own: float, streak: float) -> None:
        """What adds to the elastic response [mm/MPa]: own pressure of the cell, mean of its line along x."""
        if self._compliance == (own, streak):
            return
        response = self._elastic + own
        near = self._near + own
        if streak > 0.0:
            response += streak * self._streak(response.shape)
            near[0] += streak
        inverse = np.divide(1.0, near, out=np.zeros_like(near), where=near > 0.0)
        self._response_table = self._transforms.table(response)
        self._inverse_table = self._inverse_transforms.table(inverse)
        self._compliance = own, streak

    def respond(self, pressure: Field, displacement: Field) -> None:
        """Displacement [mm] under a pressure [MPa], compliances included."""
        self._transforms.filter(pressure, self._response_table, displacement)

    def respond_elastically(self, pressure: Field, displacement: Field) -> None:
        """Displacement of the half-space alone [mm]."""
        table = self._transforms.table(self._elastic)
        self._transforms.filter(pressure, table, displacement)

    def invert(self, displacement: Field, pressure: Field) -> None:
        """About the pressure [MPa] of a displacement [mm]: |q| E*/2 without compliances. May be in place."""
        self._inverse_transforms.filter(displacement, self._inverse_table, pressure)

    def _streak(self, shape: tuple[int, ...]) -> FloatArray:
        """Spectrum of the mean over the cells of a line along x."""
        if self._boundary == "periodic":
            spectrum = np.zeros(shape)
            spectrum[0] = 1.0
            return spectrum
        padded, nx = shape[0], self._executor.grid.nx
        distance = np.minimum(np.arange(padded), padded - np.arange(padded))
        line = np.where(distance < nx, 1.0 / nx, 0.0)
        return np.repeat(np.fft.fft(line).real[:, np.newaxis], shape[1], axis=1)


def periodic_spectrum(grid: Grid, modulus: float) -> FloatArray:
    """2/(E*|q|) of the modes of a real transform [mm/MPa], shape (nx, ny//2 + 1), 0 for the mean."""
    q_x = 2.0 * math.pi * np.fft.fftfreq(grid.nx, grid.cell)
    q_y = 2.0 * math.pi * np.fft.rfftfreq(grid.ny, grid.cell)
    q = np.hypot(q_x[:, np.newaxis], q_y)
    spectrum: FloatArray = np.divide(2.0 / modulus, q, out=np.zeros_like(q), where=q > 0.0)
    return spectrum


def padded_shape(grid: Grid) -> tuple[int, int]:
    """A shape on which the convolution of the grid does not wrap, quick to transform."""
    next_fast_len = import_module("scipy.fft").next_fast_len
    return next_fast_len(2 * grid.nx - 1), next_fast_len(2 * grid.ny - 1, real=True)


def free_coefficients(grid: Grid, modulus: float, shape: tuple[int, int]) -> FloatArray:
    """Displacement at a cell's centre under a unit pressure on another [mm/MPa], by wrapped distance.

    Four corner terms, x ln(y + r) + y ln(x + r), over π E* (Johnson eq 3.25).
    """
    x, y = (np.minimum(np.arange(n), n - np.arange(n)) * grid.cell for n in shape)
    half = 0.5 * grid.cell
    right, left = x[:, np.newaxis] + half, x[:, np.newaxis] - half
    above, below = y + half, y - half

    def corner(a: FloatArray, b: FloatArray) -> FloatArray:
        # by inverse hyperbolic sines: the logarithms differ by what cancels between the corners
        return np.asarray(a * np.arcsinh(b / np.abs(a)) + b * np.arcsinh(a / np.abs(b)))

    total = corner(right, above) - corner(right, below) - corner(left, above) + corner(left, below)
    return total / (math.pi * modulus)


def _spectrum(coefficients: FloatArray) -> FloatArray:
    """Real transform of symmetric coefficients, which is real."""
    spectrum: FloatArray = np.ascontiguousarray(import_module("scipy.fft").rfft2(coefficients).real)
    return spectrum
