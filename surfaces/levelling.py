"""Measured heights are levelled and filtered."""

import math
from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from warpwear import lazy
from warpwear.grid import FloatArray, blocks_of_rows
from warpwear.laws.linear import solve
from warpwear.surfaces.base import BoolArray

fft = lazy.module("scipy.fft")

ROWS = 64  # of a block: the terms of a polynomial at every point at once would be many fields


def without_polynomial(
    heights: FloatArray, *, degree: int, where: BoolArray | None = None, every: int = 1
) -> FloatArray:
    """Return heights [mm], shape (nx, ny), NaN where missing, less a least-squares polynomial.

    degree: its total degree; 0 takes off the mean, 1 the mean plane. It is fitted to the valid points (of
    `where`, shape (nx, ny), if given; every n-th of them along x and y) by normal equations, in products of
    Legendre polynomials over the field, which stay well conditioned there. Terms that the points do not fix
    are left out. All sums are made in one order, whatever the threads of BLAS.
    """
    nx, ny = heights.shape
    basis_x = legendre.legvander(np.linspace(-1.0, 1.0, nx), degree)
    basis_y = legendre.legvander(np.linspace(-1.0, 1.0, ny), degree)
    some_x, some_y = basis_x[::every], basis_y[::every]
    pairs_y = np.einsum("yj,yl->yjl", some_y, some_y).reshape(len(some_y), -1)
    i, j = np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]).T
    # the second round takes off what rounding left of a large tilt or offset
    levelled, square = heights, np.zeros((degree + 1,) * 4)
    for first in (True, False):
        right = np.zeros((degree + 1, degree + 1))
        some, picked = levelled[::every, ::every], None if where is None else where[::every, ::every]
        for rows in blocks_of_rows(len(some_x), values=len(some_y)):
            valid = ~np.isnan(some[rows])
            if picked is not None:
                valid &= picked[rows]
            if first:  # the same points in both
                across = np.einsum("xy,yp->xp", valid.astype(np.float64), pairs_y)
                across = across.reshape(-1, *square.shape[2:])
                square += np.einsum("xi,xk,xjl->ikjl", some_x[rows], some_x[rows], across)
            moments = np.einsum("xy,yj->xj", np.where(valid, some[rows], 0.0), some_y)
            right += np.einsum("xi,xj->ij", some_x[rows], moments)
        matrix = square[i[:, None], i, j[:, None], j]
        table = np.zeros_like(right)
        table[i, j] = solve(matrix, right[i, j, np.newaxis], rcond=1e-12)[:, 0]
        levelled = levelled - np.einsum("xi,iy->xy", basis_x, np.einsum("ij,yj->iy", table, basis_y))
    return levelled


def tilt(form: FloatArray, *, pixel: tuple[float, float]) -> float:
    """Return the mean tilt [°] of a form [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm]."""
    slopes = [np.diff(form, axis=axis) / pixel[axis] for axis in (0, 1)]
    means = [float(np.nanmean(slope)) for slope in slopes if not np.isnan(slope).all()]
    return math.degrees(math.atan(math.hypot(*means)))


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
    """Return heights [mm], shape (nx, ny), after an areal Gaussian low-pass; pixel, cut-off [mm].

    The filter is that of ISO 16610-61, isotropic as the product of the filters along both axes. Beyond its
    edges the field is mirrored, so that no height is lost there; within half a cut-off of them the result
    knows only one side. Missing points (NaN) have no weight and stay missing.
    """

    def smoothed(whole: FloatArray) -> FloatArray:
        along = low_pass(whole, axis=0, pixel=pixel[0], cut_off=cut_off)
        return low_pass(along, axis=1, pixel=pixel[1], cut_off=cut_off)

    return over_measured(field, smoothed)


def over_measured(field: FloatArray, smoothed: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return a field, shape (nx, ny), smoothed by weights of which missing points (NaN) have none.

    smoothed: sums a complete field by the weights. Missing points stay missing.
    """
    missing = np.isnan(field)
    if not missing.any():
        return smoothed(field)
    total, weight = smoothed(np.where(missing, 0.0, field)), smoothed((~missing).astype(np.float64))
    return np.divide(total, weight, out=np.full(field.shape, np.nan), where=~missing)
