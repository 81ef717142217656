"""Roughness parameters of a field of heights."""

import math

import numpy as np

from warpwear.surfaces.base import FloatArray


def rms_slope(heights: FloatArray, *, pixel: tuple[float, float]) -> float:
    """Root mean square gradient [-] by forward differences.

    heights [mm], shape (nx, ny), complete; pixel (px, py) [mm]. ISO 25178-2 calls it Sdq. A difference
    over a pixel is blind to waves near two pixels, so the value grows with finer pixels until the shortest
    waves of the surface are resolved.
    """
    along = (
        float(np.mean(np.square(np.diff(heights, axis=0)))) / pixel[0] ** 2 if heights.shape[0] > 1 else 0.0
    )
    across = (
        float(np.mean(np.square(np.diff(heights, axis=1)))) / pixel[1] ** 2 if heights.shape[1] > 1 else 0.0
    )
    return math.sqrt(along + across)


def roughness(heights: FloatArray, *, pixel: tuple[float, float]) -> dict[str, float]:
    """Height parameters of ISO 25178-2 about the mean height, and the rms slope.

    heights [mm], shape (nx, ny), complete (no NaN), already levelled; pixel (px, py) [mm].
    Keys: ``sa``, ``sq``, ``sz`` (highest minus lowest) [mm]; ``ssk``, ``sku`` (skewness and kurtosis, 0 and 3
    for Gaussian heights; both 0 for a flat) and ``rms_slope`` [-].
    """
    centred = heights - heights.mean()
    power = np.square(centred)
    variance = float(power.mean())
    flat = variance == 0.0
    return {
        "sa": float(np.abs(centred).mean()),
        "sq": math.sqrt(variance),
        "sz": float(centred.max() - centred.min()),
        "ssk": 0.0 if flat else float((power * centred).mean()) / variance**1.5,
        "sku": 0.0 if flat else float(np.square(power).mean()) / variance**2,
        "rms_slope": rms_slope(heights, pixel=pixel),
    }
