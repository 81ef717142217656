"""Transforms of a plan in memory of their own, for the graphs of a search on a GPU."""

import math
from typing import Any

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.contact.half_space.transforms import load_cupy, stream_of
from warpwear.engine.executor import Executor, Field

fft = lazy.module("scipy.fft")

#: Bytes at whose multiples arrays begin.
ALIGNED = 256


class Filter:
    """Transforms of a plan in fields of their own, so that a graph can hold them; `filter_of` makes them.

    given, made: before and after, zero where nobody writes, shape `shape`. waves: between, by modes, shape
    (n, m//2 + 1). scale: that takes off what forward and back together multiply by. within: a filter of
    double precision and no smaller a shape, whose memory serves one of single precision.
    """

    def __init__(
        self,
        executor: Executor,
        shape: tuple[int, int],
        kind: type[np.floating[Any]],
        within: "Filter | None" = None,
    ) -> None:
        device = executor.device
        real, complex_ = (wp.float64, wp.vec2d) if kind is np.float64 else (wp.float32, wp.vec2f)
        self.shape, self.scale = shape, 1.0
        modes = shape[0], shape[1] // 2 + 1
        if within is None:
            self.given, self.made = (wp.zeros(shape, dtype=real, device=device) for _ in range(2))
            self.waves = wp.zeros(modes, dtype=complex_, device=device)
            return
        assert kind is np.float32
        half = within.waves.capacity // 2 // ALIGNED * ALIGNED
        self._of = within  # whose memory must last
        self.given = _lying(within.made, 0, shape, real)
        self.waves = _lying(within.waves, 0, modes, complex_)
        self.made = _lying(within.waves, half, shape, real)

    def forward(self) -> None:
        """Transform what is given."""
        self._modes[:] = fft.rfft2(self.given.numpy())

    def back(self) -> None:
        """Transform the modes back; they are lost."""
        self.made.numpy()[:] = fft.irfft2(self._modes, s=self.shape)

    def transform(self) -> None:
        """Do both."""
        self.forward()
        self.back()

    @property
    def _modes(self) -> Any:
        values = self.waves.numpy()
        return values.view(np.complex128 if values.dtype == np.float64 else np.complex64)[..., 0]


class CupyFilter(Filter):
    """On a GPU, by plans of CuPy in the stream of Warp's device."""

    def __init__(
        self,
        executor: Executor,
        shape: tuple[int, int],
        kind: type[np.floating[Any]],
        within: Filter | None = None,
    ) -> None:
        super().__init__(executor, shape, kind, within)
        cupy = load_cupy(executor.device)
        cufft = cupy.cuda.cufft
        self.scale = 1.0 / (shape[0] * shape[1])
        self._device = cupy.cuda.Device(executor.device.ordinal)
        double = kind is np.float64
        there = cufft.CUFFT_D2Z if double else cufft.CUFFT_R2C
        back = cufft.CUFFT_Z2D if double else cufft.CUFFT_C2R
        with self._device:
            self._stream = stream_of(cupy.cuda, executor.device)
            self._plans = [
                cufft.PlanNd(shape, None, 1, 0, None, 1, 0, way, 1, "C", 1, None) for way in (there, back)
            ]
            self._views = [cupy.asarray(values) for values in (self.given, self.waves, self.made)]

    def forward(self) -> None:
        """Transform what is given."""
        with self._device, self._stream:
            self._plans[0].fft(self._views[0], self._views[1], -1)

    def back(self) -> None:
        """Transform the modes back; they are lost."""
        with self._device, self._stream:
            self._plans[1].fft(self._views[1], self._views[2], 1)


def filter_of(
    executor: Executor,
    shape: tuple[int, int],
    kind: type[np.floating[Any]],
    *,
    within: Filter | None = None,
) -> Filter:
    """Transforms where the executor's fields are. kind: of number. within: where its memory lies."""
    return (Filter if executor.device.is_cpu else CupyFilter)(executor, shape, kind, within)


def _lying(place: Field, start: int, shape: tuple[int, int], dtype: Any) -> Field:
    """An array in the memory of another, from a byte on; of its own where it does not fit."""
    size = math.prod(shape) * wp.types.type_size_in_bytes(dtype)
    if start + size > place.capacity:
        return wp.zeros(shape, dtype=dtype, device=place.device)
    return wp.array(ptr=place.ptr + start, dtype=dtype, shape=shape, device=place.device, copy=False)
