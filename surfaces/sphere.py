"""The smooth sphere in NumPy: the reference for kernels, tests and figures."""

import math

import numpy as np

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray


def sag(x: FloatArray, y: FloatArray, *, radius: float) -> FloatArray:
    """Height [mm] of the sphere's lower side over its apex at the points x × y, shape (x.size, y.size).

    r²/(R + √(R² − r²)), equal to R − √(R² − r²) (thesis eq 3.1) without its cancellation near the apex.
    x, y: points [mm], 1-D, 0 = below the apex. radius: R [mm]; infinite for a rigid flat (sag 0).
    Beyond the sphere's edge (r > R) the sag is infinite. InputError for a radius that is not positive.
    """
    if not radius > 0:
        raise InputError(f"sphere.radius is {radius:g} mm: allowed is any positive length, or inf for a flat")
    if math.isinf(radius):
        return np.zeros((x.size, y.size))
    squared = np.add.outer(np.square(x), np.square(y)).astype(np.float64, copy=False)
    below = radius * radius - squared
    outside = below < 0.0
    np.maximum(below, 0.0, out=below)
    np.sqrt(below, out=below)
    below += radius
    np.divide(squared, below, out=squared)
    squared[outside] = np.inf
    return squared
