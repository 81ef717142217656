"""The surfaces and loads on which the half-space is measured, and what judges a pressure on them."""

import math
from typing import Any, NamedTuple

import numpy as np
from contenders.half_space import MODULUS

from warpwear.contact.half_space.influence import free_coefficients, periodic_spectrum
from warpwear.grid import Grid
from warpwear.surfaces.made.fourier import half_plane_draws
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.made.synthetic import LARGEST_MODE

HURST, SLOPE, ROLL_OFF = 0.8, 0.1, 0.999
#: Radius of the ball, and rms slope of its roughness.
RADIUS, BALL_SLOPE = 10.0, 0.003
#: Rows that are transformed back together.
ROWS = 256


class Case(NamedTuple):
    """cut: cells in the shortest wave; 0: none. load: mean pressure over E*. cap: over E*."""

    cut: int
    load: float = 0.005
    cap: float = math.inf
    ball: bool = False

    @property
    def boundary(self) -> str:
        return "free" if self.ball else "periodic"

    def heights(self, cells: int) -> Any:
        """Heights on 1 × 1."""
        grid = Grid(cells, cells, 1.0 / cells)
        made = np.zeros(grid.shape)
        if self.cut:
            slope = BALL_SLOPE if self.ball else SLOPE
            made = (surface if cells / self.cut <= LARGEST_MODE else fine_surface)(cells, self.cut, slope)
        if self.ball:
            made -= ((grid.x[:, np.newaxis] - 0.5) ** 2 + (grid.y - 0.5) ** 2) / (2.0 * RADIUS)
        return made


def surface(cells: int, cut: int, slope: float) -> Any:
    """A self-affine surface of the package, by its rms slope."""
    waves = SelfAffine(hurst=HURST, roll_off=ROLL_OFF, cut_off=cut / cells, period=1.0, sq=1.0)
    x = Grid(cells, cells, 1.0 / cells).x
    return waves.heights(x, x) * (slope / waves.rms_slope)


def fine_surface(cells: int, cut: int, slope: float) -> Any:
    """Make `surface`, the digits aside, of more waves than the package allows, by transforms of this grid."""
    largest = cells // cut
    i, j = np.arange(-largest, largest + 1), np.arange(largest + 1)
    radius = np.hypot(i[:, np.newaxis], j)
    draws = half_plane_draws(largest, seed=0)
    draws *= np.where(radius > cells / cut, 0.0, np.maximum(radius * ROLL_OFF, 1.0) ** (-1.0 - HURST))
    draws *= slope / (2.0 * math.pi * math.sqrt(0.5 * float(np.sum((radius * np.abs(draws)) ** 2))))
    del radius
    start = np.exp(-1j * math.pi * (cells - 1) / cells * np.arange(-largest, largest + 1))  # the first cell's
    draws *= start[:, np.newaxis]
    draws *= start[largest:]
    modes = np.zeros((cells, cells // 2 + 1), dtype=np.complex128)
    for row, waves in zip(i % cells, draws, strict=True):  # the shortest waves either way are one
        modes[row, : largest + 1] += waves
    del draws
    modes = np.fft.ifft(modes, axis=0, norm="forward")
    modes[:, 1 : -1 if cells % 2 == 0 else None] *= 0.5
    made = np.empty((cells, cells))
    for first in range(0, cells, ROWS):
        made[first : first + ROWS] = np.fft.irfft(modes[first : first + ROWS], n=cells, norm="forward")
    return made


CASES = {
    "elastic": Case(2),
    "resolved": Case(16),
    "near full": Case(16, load=0.06),
    "ball": Case(0, load=0.003, ball=True),
    "rough ball": Case(16, load=0.003, ball=True),
    "capped": Case(2, cap=0.05),
}


def judge(heights: Any, pressure: Any, case: Case) -> dict[str, float]:
    """Residual, area and load of a pressure, by NumPy alone."""
    n, cap = heights.shape[0], case.cap
    pressure = np.clip(pressure, 0.0, cap)
    if case.ball:
        away = np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n))
        coefficients = free_coefficients(1.0 / n, MODULUS, n + 1, n + 1)
        spectrum = np.fft.rfft2(coefficients[np.ix_(away, away)]).real
    else:
        spectrum = periodic_spectrum(Grid(n, n, 1.0 / n), MODULUS)
    shape = (2 * n, 2 * n) if case.ball else heights.shape
    gap = np.fft.irfft2(np.fft.rfft2(pressure, s=shape) * spectrum, s=shape)[:n, :n] - heights
    overlap = gap[pressure > 0.0].max() - gap[pressure < cap].min()
    return {
        "residual": max(0.5 * overlap / heights.std(), 0.0),
        "area": float((pressure > 0.0).mean()),
        "load_residual": pressure.mean() / (case.load * MODULUS) - 1.0,
    }
