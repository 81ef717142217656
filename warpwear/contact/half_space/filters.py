"""Waves are filtered by kernels of a CPU's own, or around the transforms of SciPy, or of CuPy on a GPU."""

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.contact.half_space.convolution import Convolution, fits
from warpwear.contact.half_space.transforms import ALIGNED, Filter, Grids, load_cupy, lying, stream_of
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.kernels import fourier

fft = lazy.module("scipy.fft")


class PaddedFilter(Filter):
    """Transforms of a library, step by step of a program, between fields padded in memory of their own.

    within: a filter of double precision and no smaller a shape, whose memory serves one of single precision.
    """

    scale = 1.0  # that takes off what forward and back together multiply by

    def __init__(
        self,
        executor: Executor,
        grids: Grids,
        table: Any,
        shape: tuple[int, int],
        kind: Any,
        within: Filter | None = None,
    ) -> None:
        device, real = executor.device, wp.dtype_from_numpy(kind)
        self._executor, self._grids, self._kind, self.shape = executor, grids, kind, shape
        #: Shared by filters of one table, which a GPU makes itself.
        self._table: Field = wp.array(table, dtype=wp.float64, device=device, copy=False)
        padded = grids.count, *shape
        modes = grids.count, shape[0], 2 * (shape[1] // 2 + 1)
        places: tuple[Any, Any] = None, None
        half = 0
        if isinstance(within, PaddedFilter):
            assert shape == (grids.rows, grids.columns)  # of no padding to stay zero
            places = within.padded_out, within.waves
            half = -(-math.prod(modes) * wp.types.type_size_in_bytes(real) // ALIGNED) * ALIGNED
        if self._is_plain:
            padded = (0, 0, 0)
        #: Before and after; between, by modes: real and imaginary parts in turn.
        self.padded_in: Field = lying(places[0], padded, real, device)
        self.waves: Field = lying(places[1], modes, real, device)
        self.padded_out: Field = lying(places[1], padded, real, device, start=half)

    @property
    def _is_plain(self) -> bool:
        """Tell whether fields are transformed as they lie, without padded ones beside them."""
        return False

    def set_mean(self, value: float) -> None:
        """Set the answer to a uniform pressure [mm/MPa]."""
        self._table[:1, :1].fill_(value)

    def add_to(
        self, program: Program, field_in: Field, line: Any, field_out: Field, *, divides: bool = False
    ) -> None:
        """Add the transforms and the filter between them to a program."""
        grids, executor = self._grids, self._executor
        members = {name: getattr(grids, name) for name in ("visited", "rows", "columns", "stride")}
        around = arguments(fourier.FourierPlan, divides=divides, scale=self.scale, **members)

        def launch(kernel: Any, rows: int, *arrays: Any) -> None:
            slots = executor.slots_of(grids.count * rows)
            program.launch(kernel[self._kind], around, *arrays, slots=slots)

        place_in, place_out = (field_in, field_out) if self._is_plain else (self.padded_in, self.padded_out)
        if not self._is_plain:
            launch(fourier.pad, grids.rows, field_in, place_in)
        program.call(self.transform(place_in))
        if self._table.ndim == 3:
            slots = executor.slots_of(self.shape[0])
            program.launch(fourier.multiply_pair[self._kind], around, self._table, self.waves, slots=slots)
        else:
            launch(fourier.multiply, self.shape[0], self._table, line, self.waves)
        program.call(self.transform(place_out, back=True))
        if not self._is_plain:
            launch(fourier.crop, grids.rows, field_out, place_out)

    @abstractmethod
    def transform(self, values: Field, *, back: bool = False) -> Callable[[], None]:
        """Make what transforms values to the modes, or these back to values; they are lost then."""


class ScipyFilter(PaddedFilter):
    """Transforms the grids that are visited on a CPU, by its threads."""

    def transform(self, values: Field, *, back: bool = False) -> Callable[[], None]:
        """Make what transforms values to the modes, or these back to values; they are lost then."""
        host, modes, options = values.numpy(), self._modes, {"workers": self._executor.threads}

        def forth() -> None:
            lines = fft.rfft(host[: self._visited], **options)
            modes[: self._visited] = fft.fft(lines, axis=1, overwrite_x=True, **options)

        def and_back() -> None:
            lines = fft.ifft(modes[: self._visited], axis=1, overwrite_x=True, **options)
            host[: self._visited] = fft.irfft(lines, self.shape[1], **options)

        return and_back if back else forth

    @property
    def _modes(self) -> Any:
        """Return the modes as complex numbers, shape (grids, n, m//2 + 1)."""
        return self.waves.numpy().view(np.complex64 if self._kind is np.float32 else np.complex128)

    @property
    def _visited(self) -> int:
        return int(self._grids.visited.numpy()[0])


class CupyFilter(PaddedFilter):
    """Transforms all grids at once on a GPU, by plans of CuPy in the stream of Warp's device."""

    def __init__(self, executor: Executor, grids: Grids, *where: Any, **options: Any) -> None:
        super().__init__(executor, grids, *where, **options)
        cupy = load_cupy(executor.device)
        cufft, shape, count = cupy.cuda.cufft, self.shape, grids.count
        self.scale = 1.0 / math.prod(shape)
        self._device = cupy.cuda.Device(executor.device.ordinal)
        double = self._kind is np.float64
        there = cufft.CUFFT_D2Z if double else cufft.CUFFT_R2C
        back = cufft.CUFFT_Z2D if double else cufft.CUFFT_C2R
        with self._device:
            self._stream = stream_of(cupy.cuda, executor.device)
            self._plans = [
                cufft.PlanNd(shape, None, 1, 0, None, 1, 0, way, count, "C", 1, None) for way in (there, back)
            ]
            self._waves = cupy.asarray(self.waves).view(cupy.complex128 if double else cupy.complex64)
        self._cupy = cupy
        self._warm()

    @property
    def _is_plain(self) -> bool:
        """Tell whether fields are transformed as they lie: those of one grid without padding."""
        grids = self._grids
        whole = (
            grids.count == 1 and (grids.rows, grids.columns) == self.shape and grids.stride == grids.columns
        )
        return whole and self._kind is np.float64

    def transform(self, values: Field, *, back: bool = False) -> Callable[[], None]:
        """Make what transforms values to the modes, or these back to values; they are lost then."""
        with self._device:
            places = [self._cupy.asarray(values), self._waves]

        def run() -> None:
            with self._device, self._stream:
                self._plans[back].fft(places[back], places[1 - back], 1 if back else -1)

        return run

    def _warm(self) -> None:
        """Transform the modes in place before a graph captures the plans: the library loads what it needs."""
        real = self._waves.view(self._waves.real.dtype)
        with self._device, self._stream:
            self._plans[0].fft(real, self._waves, -1)
            self._plans[1].fft(self._waves, real, 1)


def filter_of(
    executor: Executor,
    table: Any,
    shape: tuple[int, int],
    kind: Any,
    *,
    grids: Grids | None = None,
    within: Filter | None = None,
) -> Filter:
    """Return a filter where the executor's fields are.

    table: rows 0 … n//2 and columns 0 … m//2 of an even one, or three as `Filter` says. kind: of number.
    grids: the executor's grid by default. within: of double precision and no smaller a shape, whose memory
    serves one of single precision.
    """
    kinds: type[Any] = CupyFilter
    if executor.device.is_cpu:
        kinds = Convolution if fits(shape) else ScipyFilter
    return kinds(executor, grids or Grids.whole(executor), table, shape, kind, within=within)
