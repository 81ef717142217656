"""Fourier transforms of fields by SciPy on a CPU and CuPy on a GPU, which work on Warp's own arrays."""

import gc
import math
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.contact.half_space import convolution
from warpwear.engine.executor import Executor, Field
from warpwear.errors import InputError
from warpwear.grid import FloatArray

fft = lazy.module("scipy.fft")
T = TypeVar("T")

#: Fewer modes a thread are not worth a pool.
MODES_PER_THREAD = 30_000
#: Blocks of rows that threads take one by one, at most, and the modes that a block has at least.
ROW_BLOCKS = 16
MODES_PER_BLOCK = 4_000
#: Width of the blocks of columns that they take, and what their lines are apart beyond it: lines apart by a
#: power of two would meet in the same few places of a cache.
COLUMNS = 128
APART = 8
#: Cells of a grid from which kernels make the convolutions in single precision.
LEAST_CONVOLVED = 2**14
#: Below any response [mm/MPa].
SMALLEST = 1.0e-300


class Transforms(ABC):
    """Real transforms of the fields of one executor, zero-padded to a given shape (n, m).

    Tables are even along axis 0, as all responses are: rows 0 … n//2 tell the others. transforms: pairs (one
    forward and one inverse) done so far.
    """

    def __init__(self, executor: Executor, shape: tuple[int, int]) -> None:
        self._executor = executor
        self.shape = shape
        self.transforms = 0

    def table(self, values: FloatArray) -> Any:
        """A table for `filter` where the transforms are done, from one of n rows or of n//2 + 1."""
        return values

    def on_device(self, make: Callable[[Any], Any]) -> Any:
        """What is made with NumPy, or with CuPy where the transforms are done on a GPU."""
        return make(np)

    def added(self, table: Any, own: float, line: FloatArray) -> Any:
        """A table and what adds to it: own everywhere, and line by row, shape (n,)."""
        return table + self.table(own + line[:, np.newaxis])

    @abstractmethod
    def filter(
        self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False, single: bool = False
    ) -> None:
        """field_out = inverse(forward(field_in) × table), on the cells of the grid; may be the same field.

        divide: ÷ instead of ×; modes where the table is 0 are left out. For a preconditioner, so single
        precision will do. single: whether it may do for × as well; not all transforms have it.
        """


def unfolded(table: Any, rows: int, xp: Any = np) -> Any:
    """All rows of a table that is even along axis 0, from those up to the middle or from all of them."""
    places = xp.arange(rows)
    return table if len(table) == rows else table[xp.minimum(places, rows - places)]


def pool_for(executor: Executor, modes: int) -> ThreadPoolExecutor | None:
    """A pool of as many threads as the executor has; None where there are too few modes to share."""
    threads = executor.threads if modes >= 2 * MODES_PER_THREAD else 1
    return ThreadPoolExecutor(threads) if threads > 1 else None


def for_each(pool: ThreadPoolExecutor | None, work: Callable[[T], None], blocks: Iterable[T]) -> None:
    """Do the work on every block, on the threads of a pool if there is one."""
    if pool is None:
        for block in blocks:
            work(block)
    else:
        list(pool.map(work, blocks))


class ScipyTransforms(Transforms):
    """On the CPU. Blocks of rows, then of columns, are shared among as many threads as the executor has.

    The blocks do not depend on the threads, so neither do the results. A block of columns is transformed,
    multiplied and transformed back while it is in the cache; rows and columns of padding are never stored.
    In single precision a large grid is convolved by kernels of its own, which take a third of the time.
    within: others of no smaller a shape, in whose memory those kernels work.
    """

    def __init__(
        self, executor: Executor, shape: tuple[int, int], within: "ScipyTransforms | None" = None
    ) -> None:
        super().__init__(executor, shape)
        nx, modes = executor.grid.nx, shape[1] // 2 + 1
        #: Columns of modes that lie in the cells of the result; without padding all but the last.
        self._held = min(modes - 1, executor.grid.ny // 2)
        blocks = min(max(nx * modes // MODES_PER_BLOCK, 1), ROW_BLOCKS)
        self._rows = _blocks(0, nx, -(-nx // blocks))
        self._columns = _blocks(0, self._held, COLUMNS) + _blocks(self._held, modes, COLUMNS)
        self._pool = pool_for(executor, nx * modes)
        self._convolves = executor.grid.cells >= LEAST_CONVOLVED and convolution.fits(shape)
        self._within = within
        self._own_place: Any = None
        #: The last table in single precision, and the reciprocals of the last one that was divided by.
        self._single: dict[bool, tuple[Any, Any]] = {}

    @cached_property
    def _convolution(self) -> convolution.Convolution:
        """The kernels of single precision; made where they are asked for, as their memory is a field's."""
        place = self._within._convolution if self._within and self._within._convolves else None
        return convolution.Convolution(self._executor, self.shape, place)

    @property
    def _spectrum(self) -> Any:
        """Where the modes lie that the result does not hold: if possible where those kernels work."""
        shape = self._executor.grid.nx, self.shape[1] // 2 + 1 - self._held
        if "_convolution" in vars(self):
            place = self._convolution.memory.view(np.complex128)
            if place.size >= math.prod(shape):
                return place[: math.prod(shape)].reshape(shape)
        if self._own_place is None:
            self._own_place = np.empty(shape, np.complex128)
        return self._own_place

    def table(self, values: FloatArray) -> Any:
        half = self.shape[0] // 2 + 1
        return values[:half].copy() if len(values) > half else values

    def added(self, table: Any, own: float, line: FloatArray) -> Any:
        if not line.any():
            return table + own
        return unfolded(table, self.shape[0]) + (own + line[:, np.newaxis])  # alike but for rounding

    def filter(
        self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False, single: bool = False
    ) -> None:
        self.transforms += 1
        if self._convolves and (divide or single):
            self._own_place = None
            self._convolution.apply(field_in, self._in_single(table, divide), field_out)
            return
        held = self._held
        real: Any = np.float32 if divide or single else np.float64
        kind: Any = np.complex64 if divide or single else np.complex128
        factors = self._in_single(table, divide) if divide or single else table
        nx, ny = self._executor.grid.shape
        values, result = self._executor.to_numpy(field_in), self._executor.to_numpy(field_out)
        first: Any = result[:, : 2 * held].view(kind)[:, :held]
        spectrum = self._spectrum
        rest: Any = spectrum.view(kind)[:, : spectrum.shape[1]]
        length, half = self.shape[0], len(factors)

        def forward(rows: slice) -> None:
            lines = fft.rfft(values[rows].astype(real, copy=False), n=self.shape[1], axis=1)
            first[rows], rest[rows] = lines[:, :held], lines[:, held:]

        def across(columns: slice) -> None:
            part = first if columns.start < held else rest
            start = columns.start if columns.start < held else columns.start - held
            width = columns.stop - columns.start
            block = part[:, start : start + width]
            lines = np.empty((length, width + APART), kind)[:, :width]
            lines[:nx], lines[nx:] = block, 0.0
            lines = fft.fft(lines, axis=0, overwrite_x=True)
            of_block = factors[:, columns]
            lines[:half] *= of_block
            if half < length:
                lines[half:] *= of_block[length - half : 0 : -1]
            block[:] = fft.ifft(lines, axis=0, overwrite_x=True)[:nx]

        def back(rows: slice) -> None:
            lines = np.concatenate([first[rows], rest[rows]], axis=1) if held else rest[rows]
            result[rows] = fft.irfft(lines, n=self.shape[1], axis=1, overwrite_x=True)[:, :ny]

        for_each(self._pool, forward, self._rows)
        for_each(self._pool, across, self._columns)
        for_each(self._pool, back, self._rows)

    def _in_single(self, table: Any, divide: bool) -> Any:
        """A table in single precision, or 1/table, 0 where it is 0."""
        kept = self._single.get(divide, (None, None))
        if kept[0] is not table:
            factors = np.empty(table.shape, np.float32)
            for rows in _blocks(0, len(table), COLUMNS):
                values = table[rows]
                if divide:
                    values = np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0)
                factors[rows] = values
            made = self._convolution.table(factors) if self._convolves else factors
            kept = self._single[divide] = table, made
        return kept[1]


class CupyTransforms(Transforms):
    """On a GPU, in the stream of Warp's device; arrays are shared through `__cuda_array_interface__`."""

    def __init__(
        self, executor: Executor, shape: tuple[int, int], within: "CupyTransforms | None" = None
    ) -> None:
        super().__init__(executor, shape)
        self._cupy: Any = load_cupy(executor.device)
        device = executor.device
        self._device = self._cupy.cuda.Device(device.ordinal)
        with self._device:
            self._stream = stream_of(self._cupy.cuda, device)
        #: The last table that was divided by, and its reciprocals in single precision.
        self._divisor: tuple[Any, Any] = None, None

    def table(self, values: FloatArray) -> Any:
        with self._device, self._stream:
            return unfolded(self._cupy.asarray(values), self.shape[0], self._cupy)

    def on_device(self, make: Callable[[Any], Any]) -> Any:
        with self._device, self._stream:
            return make(self._cupy)

    def added(self, table: Any, own: float, line: FloatArray) -> Any:
        with self._device, self._stream:
            return super().added(table, own, line)

    def filter(
        self, field_in: Field, table: Any, field_out: Field, *, divide: bool = False, single: bool = False
    ) -> None:
        self.transforms += 1
        cupy, fft = self._cupy, self._cupy.fft
        with self._device, self._stream:
            values, result = self._cells(field_in), self._cells(field_out)
            nx, ny = result.shape[-2:]
            if divide:
                values, table = values.astype(cupy.float32), self._reciprocals(table)
            spectrum = fft.rfft2(values, s=self.shape)
            spectrum *= table
            result[:] = fft.irfft2(spectrum, s=self.shape)[..., :nx, :ny]

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


@contextmanager
def arrays_of(executor: Executor) -> Iterator[tuple[Any, Callable[[Field], Any]]]:
    """NumPy, or CuPy in the stream of Warp's device; and what sees a field with it, shape (rows, ny)."""
    if executor.device.is_cpu:
        yield np, executor.to_numpy
        return
    cupy = load_cupy(executor.device)

    def view(field: Field) -> Any:
        return cupy.asarray(field).reshape(field.shape[0], -1)[:, : executor.grid.ny]

    with cupy.cuda.Device(executor.device.ordinal), stream_of(cupy.cuda, executor.device):
        yield cupy, view


def load_cupy(device: Any) -> Any:
    """CuPy, for a device of Warp's. Raises InputError where it is not installed."""
    try:
        return lazy.load("cupy")
    except ImportError as error:
        raise InputError(
            f'contact.law = "half-space" on device = {str(device)!r} needs CuPy for its Fourier '
            "transforms: pip install cupy-cuda12x (the extra gpu) or cupy-cuda13x (gpu13), for its CUDA, "
            "or use the device cpu."
        ) from error


def release(device: Any) -> None:
    """Give back to a GPU what nobody uses any more: the pools of Warp and CuPy keep it, and plans do."""
    if device.is_cpu:
        return
    gc.collect()
    if "cupy" in sys.modules:
        cupy = load_cupy(device)
        with cupy.cuda.Device(device.ordinal):
            cupy.fft.config.get_plan_cache().clear()
            cupy.get_default_memory_pool().free_all_blocks()
    wp.synchronize_device(device)


def stream_of(cuda: Any, device: Any) -> Any:
    """The stream of Warp's device for CuPy, which leaves it to Warp."""
    if hasattr(cuda.Stream, "from_external"):  # since 14.0, which deprecates the other
        return cuda.Stream.from_external(device.stream)
    return cuda.ExternalStream(device.stream.cuda_stream, device.ordinal)


def _blocks(first: int, end: int, length: int) -> list[slice]:
    return [slice(start, min(start + length, end)) for start in range(first, end, length)]
