"""Filters of waves share the grids that they filter, memory, and CuPy where fields are on a GPU."""

import gc
import math
import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.errors import InputError
from warpwear.kernels.cells import LANES

#: Bytes at whose multiples arrays begin.
ALIGNED = 256


@dataclass(frozen=True)
class Grids:
    """Describes grids of one size that lie one after another in a field.

    visited: how many of them are filtered, the first ones; an array of one number. stride: numbers from one
    row to the next.
    """

    count: int
    rows: int
    columns: int
    stride: int
    visited: Any

    @classmethod
    def whole(cls, executor: Executor, count: int = 1) -> Self:
        """Return the grid of an executor; or two, of a field with twice as many rows."""
        grid = executor.grid
        return cls(count, grid.nx, grid.ny, executor.vectors * LANES, _visited(executor, count))

    @classmethod
    def squares(cls, executor: Executor, side: int) -> Self:
        """Return squares of which each is a row of the executor's fields."""
        count = executor.grid.nx
        return cls(count, side, side, executor.vectors * LANES // side, _visited(executor, count))


class Filter(ABC):
    """Multiplies modes of grids, zero-padded to a shape (n, m), by a table of them.

    The table is even in both directions, as all responses are: rows 0 … n//2 and columns 0 … m//2 tell the
    others. To each of its rows a number of a line adds, an array that may change.

    Of two grids of an executor a filter with three tables multiplies the modes by a symmetric matrix of
    them, and heeds no line: even ones on the diagonal, first and last, one odd in both directions off it.
    """

    @abstractmethod
    def add_to(
        self, program: Program, field_in: Field, line: Any, field_out: Field, *, divides: bool = False
    ) -> None:
        """Add to a program: field_out = inverse(forward(field_in) × (table + line)); may be the same field.

        divides: ÷ instead of ×; modes where that is 0 are left out.
        """

    @abstractmethod
    def set_mean(self, value: float) -> None:
        """Change the table's number of the mean."""


def _visited(executor: Executor, count: int) -> Any:
    return wp.full(1, count, dtype=wp.int32, device=executor.device)


def lying(place: Any, shape: tuple[int, ...], dtype: Any, device: Any, *, start: int = 0) -> Any:
    """Return an array in another's memory, from a byte on; in its own where that is too little or none."""
    size = math.prod(shape) * wp.types.type_size_in_bytes(dtype)
    if place is None or start + size > place.capacity:
        return wp.zeros(shape, dtype=dtype, device=device)
    array: Any = wp.array(ptr=place.ptr + start, dtype=dtype, shape=shape, device=device, copy=False)
    array._place = place  # whose memory must last
    return array


@contextmanager
def array_module(executor: Executor) -> Iterator[Any]:
    """Lend NumPy, or CuPy in the stream of Warp's device."""
    if executor.device.is_cpu:
        yield np
        return
    cupy = load_cupy(executor.device)
    with cupy.cuda.Device(executor.device.ordinal), stream_of(cupy.cuda, executor.device):
        yield cupy


def load_cupy(device: Any) -> Any:
    """Return CuPy, for a device of Warp's. Raises InputError where it is not installed."""
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
    """Return the stream of Warp's device for CuPy, which leaves it to Warp."""
    if hasattr(cuda.Stream, "from_external"):  # since 14.0, which deprecates the other
        return cuda.Stream.from_external(device.stream)
    return cuda.ExternalStream(device.stream.cuda_stream, device.ordinal)
