"""Gaussian random surfaces, self-affine between two wavelengths."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.surfaces.base import FloatArray
from warpwear.surfaces.made.fourier import ComplexArray, fourier_blocks, fourier_sum, half_plane_draws
from warpwear.surfaces.made.synthetic import (
    POINTS_PER_CUT_OFF,
    SLACK,
    asked,
    check_roughness,
    check_spectrum,
    points_along,
    repeats,
    unresolved,
)


@dataclass(frozen=True, kw_only=True)
class SelfAffine:
    """A Gaussian random surface, self-affine between two wavelengths, periodic (period × period).

    A finite Fourier sum over the modes 2π(i, j)/period. Its isotropic power spectral density is constant for
    wavelengths above `roll_off`, ∝ q^(−2 − 2·hurst) down to `cut_off`, and zero for shorter ones (a circle in
    the plane of modes) and for the mean (Persson et al. 2005, J. Phys.: Condens. Matter 17, R1). Amplitudes
    are complex Gaussian; a mode's draw depends on `seed` and (i, j) alone, so a shorter cut-off adds waves
    and leaves the others as they were, up to the common factor that restores the asked roughness.

    Lengths in mm; exactly one of `ra`, `sq`. Sq is exact over the period (Parseval), Ra over a fixed grid of
    one period with a pitch of at most cut_off/4. InputError, naming ``disc.synthetic.NAME``, for bad values.
    """

    hurst: float = 0.8
    roll_off: float = 0.1
    cut_off: float = 0.008
    seed: int = 0
    period: float = 2.0
    ra: float | None = None
    sq: float | None = None

    def __post_init__(self) -> None:
        check_roughness(self.ra, self.sq)
        check_spectrum(self.hurst, self.roll_off, self.cut_off, self.seed, self.period)

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights [mm] at the points x × y [mm], shape (x.size, y.size); repeats beyond the period."""
        return fourier_sum(self._amplitudes, *self._waves, x, y)

    def blocks(self, x: FloatArray, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """The same heights block by block of rows."""
        return fourier_blocks(self._amplitudes, *self._waves, x, y)

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Whether the grid is wider than the period or too coarse for the cut-off."""
        return repeats(self.period, x, y) + unresolved(self.cut_off, x, y)

    @property
    def rms_slope(self) -> float:
        """Root mean square gradient [-] over the period, from the spectrum."""
        wave_x, wave_y = self._waves
        squared = np.add.outer(wave_x**2, wave_y**2)
        return math.sqrt(0.5 * float(np.sum(squared * np.abs(self._amplitudes) ** 2)))

    def record(self) -> dict[str, Any]:
        """Parameters, what was asked for, and the Ra, Sq and rms slope that the surface has."""
        return {
            "kind": "self-affine",
            "asked": asked(self.ra, self.sq),
            "hurst": self.hurst,
            "roll_off_um": self.roll_off * 1e3,
            "cut_off_um": self.cut_off * 1e3,
            "seed": self.seed,
            "period_mm": self.period,
            "ra_um": self._scale * self._unscaled_ra * 1e3,
            "sq_um": math.sqrt(0.5 * float(np.sum(np.abs(self._amplitudes) ** 2))) * 1e3,
            "rms_slope": self.rms_slope,
        }

    @cached_property
    def _largest(self) -> int:
        return int(self.period / self.cut_off * (1 + SLACK))

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray]:
        """Wave numbers [rad/mm] of the half plane of modes."""
        modes = np.arange(-self._largest, self._largest + 1).astype(np.float64)
        modes *= 2.0 * math.pi / self.period
        return modes, modes[self._largest :]

    @cached_property
    def _unscaled(self) -> ComplexArray:
        """Draws times the root of the power spectral density (1 on its plateau)."""
        i = np.arange(-self._largest, self._largest + 1)
        radius = np.sqrt(np.add.outer(i**2, np.arange(self._largest + 1) ** 2))
        # in units of the roll-off wave number, so that the plateau is 1 whatever the cut-off
        level = np.maximum(radius * (self.roll_off / self.period), 1.0) ** (-1.0 - self.hurst)
        level[radius > self.period / self.cut_off * (1 + SLACK)] = 0.0
        return half_plane_draws(self._largest, seed=self.seed) * level

    @cached_property
    def _unscaled_ra(self) -> float:
        count = math.ceil(self.period / self.cut_off * POINTS_PER_CUT_OFF)
        points = points_along(self.period, count)
        blocks = fourier_blocks(self._unscaled, *self._waves, points, points)
        return sum(float(np.abs(values).sum()) for _, values in blocks) / count**2

    @cached_property
    def _scale(self) -> float:
        if self.sq is not None:
            return self.sq / math.sqrt(0.5 * float(np.sum(np.abs(self._unscaled) ** 2)))
        assert self.ra is not None
        return self.ra / self._unscaled_ra

    @cached_property
    def _amplitudes(self) -> ComplexArray:
        """Amplitudes [mm] of the half plane of modes: z = Re Σ c exp(i q·r)."""
        return self._scale * self._unscaled
