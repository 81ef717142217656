"""Finite Fourier sums at any points, and reproducible random amplitudes for them."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from warpwear.grid import FloatArray
from warpwear.surfaces.base import blocks_of_rows

ComplexArray = npt.NDArray[np.complex128]


def fourier_blocks(
    amplitudes: ComplexArray, wave_x: FloatArray, wave_y: FloatArray, x: FloatArray, y: FloatArray
) -> Iterator[tuple[slice, FloatArray]]:
    """Yield Re Σ c_ij exp(i(p_i x + q_j y)) at the points x × y, a block of rows at a time.

    amplitudes: c [mm], shape (wave_x.size, wave_y.size); wave_x, wave_y: p, q [rad/mm]; x, y: points [mm].
    Each block is its rows and their values [mm], shape (rows, y.size). The sum is exact at any points: two
    matrix products, the second in real arithmetic, so nothing is tied to a mesh as an FFT would be.
    """
    # Re((P + iQ)(cos + i sin)) = P cos − Q sin
    phase_y = np.multiply.outer(wave_y, y)
    basis_y = np.empty((2 * wave_y.size, y.size))
    np.cos(phase_y, out=basis_y[: wave_y.size])
    np.negative(np.sin(phase_y, out=phase_y), out=basis_y[wave_y.size :])
    del phase_y
    for block in blocks_of_rows(x.size, values=max(y.size, 2 * wave_x.size, 2 * wave_y.size)):
        product = np.exp(1j * np.multiply.outer(x[block], wave_x)) @ amplitudes
        yield block, np.concatenate([product.real, product.imag], axis=1) @ basis_y


def fourier_sum(
    amplitudes: ComplexArray, wave_x: FloatArray, wave_y: FloatArray, x: FloatArray, y: FloatArray
) -> FloatArray:
    """Return the whole sum of `fourier_blocks` [mm], shape (x.size, y.size)."""
    field = np.empty((x.size, y.size))
    for rows, values in fourier_blocks(amplitudes, wave_x, wave_y, x, y):
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
