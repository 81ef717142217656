"""Spikes of an instrument: points far from the surface around them."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.ndimage

from warpwear.surfaces.base import FloatArray
from warpwear.surfaces.levelling import filled

WINDOW = 5  # pixels of the local median: outvotes spikes of up to 12 pixels
TO_SIGMA = 1.4826  # median absolute deviation to standard deviation, of Gaussian values


@dataclass(frozen=True, eq=False)
class Outliers:
    """Where outliers are, shape (nx, ny); the limit [mm] used, and how far off the farthest was [mm]."""

    where: npt.NDArray[np.bool_]
    limit: float
    farthest: float

    @property
    def points(self) -> int:
        """Their number."""
        return int(self.where.sum())

    @property
    def groups(self) -> int:
        """Number of connected groups, corners counted as connections."""
        return int(scipy.ndimage.label(self.where, structure=np.ones((3, 3)))[1])


def outliers(heights: FloatArray, *, deviations: float) -> Outliers:
    """Points farther than so many robust standard deviations from the local median surface.

    heights [mm], shape (nx, ny), NaN where missing. The local median is that of 5 × 5 pixels; beyond the
    edges heights go on in odd reflection, which keeps a tilt. The standard deviation is 1.4826 times the
    median absolute deviation from the local mean of the same pixels, over the whole field, so neither knows
    of the spikes. (From the mean, since that is Gaussian on a Gaussian surface: at 6 nothing of one is
    removed; on a smooth surface the median is mostly the point itself.) Form and tilt do not matter over 5
    pixels.
    """
    valid = ~np.isnan(heights)
    framed = np.pad(filled(heights), WINDOW // 2, mode="reflect", reflect_type="odd")
    inside = (slice(WINDOW // 2, -(WINDOW // 2)),) * 2
    distance = np.abs(framed - scipy.ndimage.median_filter(framed, size=WINDOW))[inside]
    spread = np.abs(framed - scipy.ndimage.uniform_filter(framed, size=WINDOW))[inside][valid]
    sigma = TO_SIGMA * float(np.median(spread))
    if sigma <= 1e-12 * float(np.abs(framed).max()):  # more than half is flat to rounding
        steps = spread[spread > 1e-12 * float(np.abs(framed).max())]
        sigma = TO_SIGMA * float(np.median(steps)) if steps.size else math.inf
    limit = deviations * sigma
    where = valid & (distance > limit)
    return Outliers(where=where, limit=limit, farthest=float(distance[where].max()) if where.any() else 0.0)
