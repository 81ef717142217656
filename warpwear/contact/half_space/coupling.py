"""Bodies of different materials: pressures shear them apart, and tractions lift them.

Both by the same kernel, odd along the traction: a traction q_x lifts by β/(π E*) ∫ q_x x/r², a pressure moves
the surfaces along x by as much with the other sign (Johnson, Contact Mechanics, 1985, section 3.6).
"""

import math

import numpy as np

from warpwear import lazy
from warpwear.contact.half_space.influence import BOUNDARIES, padded_shape
from warpwear.grid import FloatArray, Grid

fft = lazy.module("scipy.fft")


class Coupling:
    """Ties pressures to tangential displacements, and tractions to the gap, on the host.

    modulus: E* [MPa]. beta: Dundurs' β of the bodies. boundary: "periodic" or "free".
    """

    def __init__(self, grid: Grid, *, modulus: float, beta: float, boundary: str, threads: int) -> None:
        self._shape, self._threads = grid.shape, threads
        self._far = padded_shape(grid, BOUNDARIES[boundary])
        if boundary == "free":
            at = [np.asarray(grid.cell * np.fft.fftfreq(n, 1.0 / n)) for n in self._far]
            values = [_lifted(at[0], at[1], grid.cell), _lifted(at[1], at[0], grid.cell).T]
            spectra = [fft.rfft2(value, workers=threads) for value in values]
        else:
            along, across = fft.fftfreq(grid.nx, grid.cell), fft.rfftfreq(grid.ny, grid.cell)
            waves = [2.0 * math.pi * along, 2.0 * math.pi * across]
            q_x, q_y = np.meshgrid(*waves, indexing="ij")
            q_x[2 * np.arange(grid.nx) == grid.nx] = 0.0  # the shortest waves have no side
            q_y[:, 2 * np.arange(waves[1].size) == grid.ny] = 0.0
            square = waves[0][:, np.newaxis] ** 2 + waves[1] ** 2
            square[0, 0] = math.inf
            spectra = [-2.0j * math.pi * q / square for q in (q_x, q_y)]
        self._spectra = np.stack(spectra) * (beta / (math.pi * modulus))

    def lift(self, traction: FloatArray) -> FloatArray:
        """Return what tractions, shape (2, nx, ny), add to the gap [mm]."""
        modes = fft.rfft2(traction, s=self._far, workers=self._threads)
        return self._back((self._spectra * modes).sum(axis=0))

    def shear(self, pressure: FloatArray) -> FloatArray:
        """Return the relative displacement by pressures along both axes, shape (2, nx, ny) [mm]."""
        return self._back(-self._spectra * fft.rfft2(pressure, s=self._far, workers=self._threads))

    def _back(self, modes: FloatArray) -> FloatArray:
        values = fft.irfft2(modes, s=self._far, workers=self._threads)
        return np.asarray(values[..., : self._shape[0], : self._shape[1]])


def _lifted(along: FloatArray, across: FloatArray, cell: float) -> FloatArray:
    """Return ∫ x/r² over cells at these places: corners of ½ y ln(x² + y²) + x atan(y/x)."""
    total = np.zeros((along.size, across.size))
    for side in (-0.5, 0.5):
        for side_across in (-0.5, 0.5):
            x, y = np.ix_(along + side * cell, across + side_across * cell)
            corner = 0.5 * y * np.log(x**2 + y**2) + x * np.arctan(y / x)
            total += 4.0 * side * side_across * corner
    return total
