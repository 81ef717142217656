"""Compute finite Fourier sums at uniform points, and reproducible random amplitudes for them."""

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from warpwear.grid import FloatArray
from warpwear.surfaces.base import spacing

ComplexArray = npt.NDArray[np.complex128]

ROWS = 1024  # whose sums along x are made at once: more than there are waves, or their padding costs most
BLOCK = 64  # rows of a block of the sums along y


def fourier_blocks(
    amplitudes: ComplexArray, wave: float, x: FloatArray, y: FloatArray
) -> Iterator[tuple[slice, FloatArray]]:
    """Yield Re Σ c_ij exp(i·wave·((i − n) x + j y)) at the points x × y, a block of rows at a time.

    amplitudes: c [mm], shape (2n + 1, n + 1); wave: of the period [rad/mm]; x, y: uniform points [mm]. Each
    block is its rows and their values [mm], shape (rows, y.size). The sum is exact there: nothing is tied
    to a mesh as a plain FFT would be.
    """
    lowest = (amplitudes.shape[0] - 1) // 2
    for start in range(0, x.size, ROWS):
        places = x[start : start + ROWS]
        along = sum_waves(amplitudes.T, wave, places).T
        along *= np.exp(-1j * (lowest * wave) * places)[:, None]
        for first in range(0, places.size, BLOCK):
            values = sum_waves(along[first : first + BLOCK], wave, y).real
            yield slice(start + first, start + first + len(values)), values


def sum_waves(amplitudes: ComplexArray, wave: float, points: FloatArray) -> ComplexArray:
    """Return Σ_j c_ij exp(i·wave·j·p) at uniform points p [mm], shape (rows, points.size).

    amplitudes: c, shape (rows, waves), of j = 0, 1, …; wave: in rad/mm. It is the chirp-z transform (Rabiner,
    Schafer and Rader 1969): with 2jm = j² + m² − (m − j)² the sum is a convolution, made by FFTs. These add
    in one order, whatever the threads; a matrix product does not, and takes longer.
    """
    waves, count = amplitudes.shape[1], points.size
    chirp, kernel = _chirp_and_kernel(wave * spacing(points) / (2.0 * math.pi), waves, count)
    start = np.exp(1j * (wave * float(points[0])) * np.arange(waves)) * chirp[:waves]
    # NumPy's transforms are SciPy's to the last bit, and need no quarter of a second to be imported
    spectrum = np.fft.fft(amplitudes * start, kernel.size)
    spectrum *= kernel
    return np.fft.ifft(spectrum)[:, :count] * chirp[:count]


@lru_cache(4)  # blocks of rows ask for the same
def _chirp_and_kernel(turns: float, waves: int, count: int) -> tuple[ComplexArray, ComplexArray]:
    """Return the factors of `sum_waves` and the transform of what it convolves with."""
    chirp = _chirp(turns, max(waves, count))
    length = _fast_length(waves + count - 1)
    kernel = np.zeros(length, dtype=np.complex128)
    kernel[:count] = chirp[:count].conj()
    kernel[length - waves + 1 :] = chirp[waves - 1 : 0 : -1].conj()
    return chirp, np.fft.fft(kernel)


def _fast_length(least: int) -> int:
    """Return the smallest length of at least so many that has no prime factor above 11, for quick FFTs."""
    lengths = [1]
    for factor in (11, 7, 5, 3, 2):
        lengths = [n * factor**k for n in lengths for k in range(least.bit_length() + 1)]
        lengths = [n for n in lengths if n < 2 * least]
    return min(n for n in lengths if n >= least)


def _chirp(turns: float, count: int) -> ComplexArray:
    """Return exp(iπ·turns·m²), m < count; whole turns are taken off a product that is exact."""
    squares = np.square(np.arange(count, dtype=np.float64))
    short = float(np.float32(turns))
    return np.asarray(np.exp(1j * math.pi * (np.remainder(short * squares, 2.0) + (turns - short) * squares)))


def fourier_sum(amplitudes: ComplexArray, wave: float, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the whole sum of `fourier_blocks` [mm], shape (x.size, y.size)."""
    field = np.empty((x.size, y.size))
    for rows, values in fourier_blocks(amplitudes, wave, x, y):
        field[rows] = values
    return field


def uniform_draws(count: int, *, seed: int, stream: int = 0) -> FloatArray:
    """Return random numbers in [0, 1), shape (count,): the first n are the same whatever the count.

    They are made from the raw bits of PCG64, whose stream NumPy guarantees for ever (it does not for its
    distributions). Streams of one seed are independent of each other.
    """
    bits = np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(stream,))).random_raw(count)
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53


def half_plane_draws(largest: int, *, seed: int) -> ComplexArray:
    """Return complex Gaussian draws for the modes (i, j), −n ≤ i ≤ n, 0 ≤ j ≤ n, n = largest.

    Their shape is (2n + 1, n + 1). One of each pair (i, j), (−i, −j) is drawn, since a real field fixes the
    other; modes (i ≤ 0, 0) are zero. Real and imaginary part have variance 1. A draw depends on the seed and
    (i, j) only, not on n: modes are counted in rings of max(|i|, j), of 4·ring modes each.
    """
    i = np.arange(-largest, largest + 1)[:, None]
    j = np.arange(largest + 1)[None, :]
    ring = np.maximum(np.abs(i), j)
    place = np.where(j == ring, i + ring, np.where(i > 0, 2 * ring + 1 + j, 3 * ring + j))
    used = (j > 0) | (i > 0)
    index = np.where(used, 2 * ring * (ring - 1) + place, 0)
    uniform = uniform_draws(4 * largest * (largest + 1), seed=seed).reshape(-1, 2)
    # Box and Muller 1958
    draws = np.sqrt(-2.0 * np.log1p(-uniform[:, 0])) * np.exp(2j * np.pi * uniform[:, 1])
    return np.where(used, draws[index], 0.0)
