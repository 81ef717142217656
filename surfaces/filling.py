"""Missing points of a measurement: which lie within what was measured, and what stands in their place."""

import math

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.roughness import rms_slope

ndimage = lazy.module("scipy.ndimage")

SWEEPS = 8  # of the relaxation at each scale; more changes a filled height by less than its neighbours differ


def completed(heights: FloatArray, *, pixel: tuple[float, float]) -> FloatArray:
    """Return heights [mm], shape (nx, ny), with something in the place of missing points (NaN).

    Holes are filled from their rim, see `filled`. Beyond the measured region nothing is known but its mean
    plane: what a rim begins falls to that plane within the length Sq/Sdq, over which the surface itself loses
    its heights. pixel: (px, py) [mm]. Measured points are untouched.
    """
    missing = np.isnan(heights)
    outside = _beyond(missing)
    whole = filled(heights)
    if outside.any():
        flat = without_polynomial(np.where(missing, 0.0, heights), degree=1, where=~missing)
        plane = -flat[outside]
        flat[missing] = np.nan
        slope = rms_slope(flat, pixel=pixel)
        length = math.sqrt(float(np.nanmean(np.square(flat)))) / slope if slope else 0.0
        distance = ndimage.distance_transform_edt(missing, sampling=pixel)[outside]
        left = np.exp2(-np.square(distance / max(length, 2.0 * max(pixel))))
        whole[outside] = plane + left * (whole[outside] - plane)
    return whole


def _beyond(missing: BoolArray) -> BoolArray:
    """Return which missing points lie beyond the measured region: along no axis between measured ones."""
    along, across = (_between(valid) for valid in (~missing, ~missing.T))
    return missing & ~along & ~across.T


def _between(valid: BoolArray) -> BoolArray:
    """Return which points have one that is there both before and behind them along axis 0."""
    before, behind = (np.logical_or.accumulate(one, axis=0) for one in (valid, valid[::-1]))
    return np.asarray(before & behind[::-1])


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
