"""Levelling, filling and filtering of measured heights."""

import numpy as np
from numpy.polynomial import legendre

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, blocks_of_rows

fft = lazy.module("scipy.fft")

SWEEPS = 8  # of the relaxation at each scale; more changes a filled height by less than its neighbours differ


def without_polynomial(heights: FloatArray, *, degree: int, where: BoolArray | None = None) -> FloatArray:
    """Return heights [mm], shape (nx, ny), NaN where missing, less a least-squares polynomial.

    degree: its total degree; 0 takes off the mean, 1 the mean plane. It is fitted to the valid points (of
    `where`, shape (nx, ny), if given) by normal equations, in products of Legendre polynomials over the
    field, which stay well conditioned there. Sums over points are made by einsum, in one order whatever the
    threads of BLAS.
    """
    nx, ny = heights.shape
    basis_x = legendre.legvander(np.linspace(-1.0, 1.0, nx), degree)
    basis_y = legendre.legvander(np.linspace(-1.0, 1.0, ny), degree)
    pairs_y = np.einsum("yj,yl->yjl", basis_y, basis_y).reshape(ny, -1)
    i, j = np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]).T
    # the second round takes off what rounding left of a large tilt or offset
    levelled = heights
    for _ in range(2):
        square, right = np.zeros((degree + 1,) * 4), np.zeros((degree + 1, degree + 1))
        for rows in blocks_of_rows(nx, values=ny):
            valid = ~np.isnan(levelled[rows])
            if where is not None:
                valid &= where[rows]
            across = np.einsum("xy,yp->xp", valid.astype(np.float64), pairs_y).reshape(-1, *square.shape[2:])
            square += np.einsum("xi,xk,xjl->ikjl", basis_x[rows], basis_x[rows], across)
            moments = np.einsum("xy,yj->xj", np.where(valid, levelled[rows], 0.0), basis_y)
            right += np.einsum("xi,xj->ij", basis_x[rows], moments)
        # least squares rather than a solution: few valid points do not fix every term
        matrix = square[i[:, None], i, j[:, None], j]
        table = np.zeros_like(right)
        table[i, j] = np.linalg.lstsq(matrix, right[i, j], rcond=1e-12)[0]
        levelled = levelled - np.einsum("xi,iy->xy", basis_x, np.einsum("ij,yj->iy", table, basis_y))
    return levelled


def filled(heights: FloatArray) -> FloatArray:
    """Return heights [mm], shape (nx, ny), with missing points (NaN) filled; valid ones are untouched.

    It goes from coarse to fine: block means of 2 × 2 valid points are filled first in the same way, their
    values start the missing points, then a few sweeps pull every missing point to the mean of its four
    neighbours (a discrete harmonic surface: smooth, no higher or lower than the rim). That takes a few passes
    whatever the holes.
    """
    missing = np.isnan(heights)
    if not missing.any():
        return heights
    fine = heights.copy()
    fine[missing] = _from_coarse(heights, missing)[missing]
    for _ in range(SWEEPS):
        fine[missing] = _neighbour_mean(fine)[missing]
    return fine


def _from_coarse(heights: FloatArray, missing: BoolArray) -> FloatArray:
    """Return the filled means of blocks of 2 × 2 points, repeated over each block: shape (nx, ny)."""
    nx, ny = heights.shape
    pad = ((0, nx % 2), (0, ny % 2))
    weight = np.pad((~missing).astype(np.float64), pad)
    value = np.pad(np.where(missing, 0.0, heights), pad)
    quads = (weight.shape[0] // 2, 2, weight.shape[1] // 2, 2)
    count, total = weight.reshape(quads).sum(axis=(1, 3)), value.reshape(quads).sum(axis=(1, 3))
    coarse = np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0)
    return np.repeat(np.repeat(filled(coarse), 2, axis=0), 2, axis=1)[:nx, :ny]


def _neighbour_mean(field: FloatArray) -> FloatArray:
    """Return the mean of each point's four neighbours; at the rim the point itself stands for what lacks."""
    framed = np.pad(field, 1, mode="edge")
    return 0.25 * (framed[2:, 1:-1] + framed[:-2, 1:-1] + framed[1:-1, 2:] + framed[1:-1, :-2])


def low_pass(
    field: FloatArray, *, axis: int, pixel: float, cut_off: float, edge: str = "reflect"
) -> FloatArray:
    """Return heights [mm], shape (nx, ny), after a Gaussian low-pass along an axis; pixel and cut-off in mm.

    The filter is that of ISO 16610-21: it transmits exp(−π (α λc/λ)²), α² = ln 2/π, that is 2^−(λc/λ)², half
    at the cut-off. It is applied to the waves themselves, since weights sampled at pixels are off where the
    cut-off is only a few of them. edge: "reflect" goes on beyond the ends in the mirror, "grid-wrap" repeats
    the field.
    """
    count = field.shape[axis]
    if edge == "grid-wrap":
        frequency, waves = fft.rfftfreq(count, pixel), fft.rfft(field, axis=axis)
    else:
        # the cosine transform is the Fourier transform of the field reflected at its outer edge
        frequency, waves = np.arange(count) / (2.0 * count * pixel), fft.dct(field, type=2, axis=axis)
    passed = np.exp2(-np.square(cut_off * frequency))
    waves *= passed[:, None] if axis == 0 else passed
    if edge == "grid-wrap":
        smooth: FloatArray = fft.irfft(waves, n=count, axis=axis, overwrite_x=True)
    else:
        smooth = fft.idct(waves, type=2, axis=axis, overwrite_x=True)
    return smooth


def areal_low_pass(field: FloatArray, *, pixel: tuple[float, float], cut_off: float) -> FloatArray:
    """Return complete heights [mm], shape (nx, ny), after an areal Gaussian low-pass; pixel, cut-off [mm].

    The filter is that of ISO 16610-61, isotropic as the product of the filters along both axes. Beyond its
    edges the field is mirrored, so that no height is lost there; within half a cut-off of them the result
    knows only one side.
    """
    along = low_pass(field, axis=0, pixel=pixel[0], cut_off=cut_off)
    return low_pass(along, axis=1, pixel=pixel[1], cut_off=cut_off)
