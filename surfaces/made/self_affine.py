"""Gaussian random surfaces are self-affine between two wavelengths."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.surfaces.made.fourier import ComplexArray, fourier_blocks, half_plane_draws
from warpwear.surfaces.made.synthetic import SLACK, FourierSurface, RandomPart

#: Ra [mm] before scaling of the surfaces computed so far, by what their draws depend on: the runs of a sweep,
#: and the files that are written of a run, need the same.
_KNOWN_RA: dict[tuple[float, ...], float] = {}


@dataclass(frozen=True, kw_only=True)
class SelfAffine(RandomPart, FourierSurface):
    """A Gaussian random surface is self-affine between two wavelengths and periodic (period × period).

    It is a finite Fourier sum over the modes 2π(i, j)/period. Its isotropic power spectral density is
    constant for wavelengths above `roll_off`, ∝ q^(−2 − 2·hurst) down to `cut_off`, and zero for shorter ones
    (a circle in the plane of modes) and for the mean (Persson et al. 2005, J. Phys.: Condens. Matter 17, R1).
    Amplitudes are complex Gaussian; a mode's draw depends on `seed` and (i, j) alone, so a shorter cut-off
    adds waves and leaves the others as they were, up to the common factor that restores the asked roughness.

    Sq is exact over the period (Parseval), Ra over a fixed grid of one period with a pitch of at most
    cut_off/4. Parameters and errors are those of `RandomPart`.
    """

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say whether the grid x × y [mm] is wider than the period or too coarse for the cut-off."""
        return self._repeats(x, y) + self._unresolved(x, y)

    def record(self) -> dict[str, Any]:
        """Return the parameters, what was asked for, and the Ra, Sq and rms slope that the surface has."""
        return {
            "kind": "self-affine",
            **self._parameters(),
            "ra_um": self._scale * self._unscaled_ra * 1e3,
            "sq_um": _sq(self._amplitudes) * 1e3,
            "rms_slope": self.rms_slope,
        }

    @cached_property
    def _unscaled(self) -> ComplexArray:
        """Return draws times the root of the power spectral density (1 on its plateau), (2n + 1, n + 1)."""
        i = np.arange(-self._largest, self._largest + 1)
        radius = np.sqrt(np.add.outer(i**2, np.arange(self._largest + 1) ** 2))
        # in units of the roll-off wave number, so that the plateau is 1 whatever the cut-off
        level = np.maximum(radius * (self.roll_off / self.period), 1.0) ** (-1.0 - self.hurst)
        level[radius > self.period / self.cut_off * (1 + SLACK)] = 0.0
        return half_plane_draws(self._largest, seed=self.seed) * level

    @cached_property
    def _unscaled_ra(self) -> float:
        """Return the Ra [mm] of the surface before it is scaled."""
        drawn = (self.period, self.cut_off, self.roll_off, self.hurst, self.seed)
        if drawn not in _KNOWN_RA:
            points = self._points_along(self.period)
            blocks = fourier_blocks(self._unscaled, self._wave, points, points)
            _KNOWN_RA[drawn] = sum(float(np.abs(values).sum()) for _, values in blocks) / points.size**2
        return _KNOWN_RA[drawn]

    @cached_property
    def _scale(self) -> float:
        """Return the factor on the unscaled surface that makes it as rough as asked."""
        name, target = self._target
        return target / (_sq(self._unscaled) if name == "sq" else self._unscaled_ra)

    @cached_property
    def _amplitudes(self) -> ComplexArray:
        """Return the amplitudes [mm] of the half plane of modes, c in z = Re Σ c exp(i q·r)."""
        return self._scale * self._unscaled


def _sq(amplitudes: ComplexArray) -> float:
    """Return the Sq over the period (Parseval), in the unit of the amplitudes of the half plane of modes."""
    return math.sqrt(0.5 * float(np.sum(np.abs(amplitudes) ** 2)))
