"""Fit a sphere or a cylinder to measured heights."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.laws.linear import least_squares
from warpwear.surfaces.base import BoolArray, IntArray

optimize = lazy.module("scipy.optimize")

FIT_POINTS = 200_000  # more change a radius by less than the roughness does
FEWEST_POINTS = 10  # that a sphere is fitted to


class NoSphere(ValueError):
    """The heights have no curvature that a sphere could be fitted to."""


@dataclass(frozen=True)
class Sphere:
    """A sphere has an apex (x, y, z) [mm] from the middle of the field and a signed radius [mm].

    A positive radius bulges outward.
    """

    apex: tuple[float, float, float]
    radius: float

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] at the points x × y [mm], shape (x.size, y.size); NaN beyond the equator."""
        squared = np.add.outer(np.square(x - self.apex[0]), np.square(y - self.apex[1]))
        with np.errstate(invalid="ignore"):
            return self.apex[2] - _sag(squared, 1.0 / self.radius)


def places(shape: tuple[int, int], pixel: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Return the middles of pixels [mm] from the middle of a field of a shape (nx, ny): (nx,) and (ny,)."""
    pairs = zip(shape, pixel, strict=True)
    x, y = (np.asarray((np.arange(n) - 0.5 * (n - 1)) * p, dtype=np.float64) for n, p in pairs)
    return x, y


def fit_sphere(
    heights: FloatArray,
    *,
    pixel: tuple[float, float],
    where: BoolArray | None = None,
    radius: float | None = None,
) -> Sphere:
    """Fit a sphere by least squares of heights to the valid points (of `where`, if given).

    heights [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm]; where: points to fit to, shape
    (nx, ny); radius [mm] fixes it, else it is fitted. A parabola starts the fit. Raises NoSphere where there
    are fewer than ten points, they have no curvature to speak of, or they lie beyond the equator.
    """
    x, y = places(heights.shape, pixel)
    i, j = _fitted(np.isfinite(heights) if where is None else np.isfinite(heights) & where)
    px, py, z = x[i], y[j], heights[i, j]
    scale = max(float(np.hypot(np.ptp(px), np.ptp(py))) / 2.0, 1e-12)
    design = np.stack([np.ones_like(px), px / scale, py / scale, (px**2 + py**2) / scale**2], axis=1)
    z0, bx, by, bend = least_squares(design, z)
    if radius is None and abs(bend) < 1e-9 * scale:
        raise NoSphere("no curvature")
    kappa = -2.0 * bend / scale**2 if radius is None else 1.0 / radius
    x0, y0 = bx / scale / kappa, by / scale / kappa
    apex = z0 + 0.5 * kappa * (x0**2 + y0**2)

    def rest(p: FloatArray) -> FloatArray:
        k = kappa if radius is not None else p[3] / scale
        return np.asarray(p[2] * scale - _sag((px - p[0] * scale) ** 2 + (py - p[1] * scale) ** 2, k) - z)

    def bounded(p: FloatArray) -> FloatArray:
        return np.nan_to_num(rest(p), nan=1e3)

    start = [x0 / scale, y0 / scale, apex / scale] + ([] if radius is not None else [kappa * scale])
    with np.errstate(invalid="ignore"):
        if not np.isfinite(rest(np.array(start))).all():  # a parabola is no start for steep flanks
            squares = least_squares(np.stack([px, py, z, np.ones_like(z)], axis=1), px**2 + py**2 + z**2)
            x0, y0, z0 = 0.5 * squares[:3]
            free = math.sqrt(max(squares[3] + x0**2 + y0**2 + z0**2, 1e-24)) * np.sign(z.mean() - z0)
            start = [x0 / scale, y0 / scale, (z0 + (radius or free)) / scale, scale / free][: len(start)]
        if not np.isfinite(rest(np.array(start))).all():
            raise NoSphere("points beyond the equator of the sphere")
        try:
            p = optimize.least_squares(bounded, start, method="lm", xtol=1e-14, ftol=1e-14).x
        except ValueError as error:
            raise NoSphere(str(error)) from error
    fitted = radius if radius is not None else scale / p[3]
    if not math.isfinite(fitted):
        raise NoSphere("no curvature")
    return Sphere(apex=(float(p[0] * scale), float(p[1] * scale), float(p[2] * scale)), radius=float(fitted))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along an axis of the field has a crest, a signed radius [mm] and a tilt along its axis."""

    axis: int  # of the field, along which it lies
    crest: tuple[float, float]  # place across it [mm] from the field's middle, and height [mm]
    radius: float  # positive bulges outward
    tilt: float

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] at the points x × y [mm], shape (x.size, y.size); NaN beyond its sides."""
        along, across = (x, y) if self.axis == 0 else (y, x)
        with np.errstate(invalid="ignore"):
            arc = self.crest[1] - _sag((across - self.crest[0]) ** 2, 1.0 / self.radius)
        tilted = self.tilt * along
        return np.add.outer(tilted, arc) if self.axis == 0 else np.add.outer(arc, tilted)


def fit_cylinder(heights: FloatArray, *, pixel: tuple[float, float]) -> Cylinder:
    """Fit a cylinder by least squares of heights to the valid points, along the axis that bends less.

    heights, pixel: as of `fit_sphere`. A parabola starts the fit. Raises NoSphere where there are fewer
    than ten points or they have no curvature to speak of.
    """
    i, j = _fitted(np.isfinite(heights))
    axes, z = places(heights.shape, pixel), heights[i, j]
    scale = max(float(np.ptp(places)) for places in axes) / 2.0
    points = axes[0][i] / scale, axes[1][j] / scale
    z0, *slopes, bend_x, bend_y = least_squares(
        np.stack([np.ones_like(z), *points, points[0] ** 2, points[1] ** 2], axis=1), z / scale
    )
    axis, bend = (1, bend_x) if abs(bend_x) > abs(bend_y) else (0, bend_y)
    if abs(bend) < 1e-9:
        raise NoSphere("no curvature")
    along, across, slope = points[axis], points[1 - axis], slopes[1 - axis]

    def rest(p: FloatArray) -> FloatArray:
        arc = _sag((across - p[0]) ** 2, p[2])
        return np.nan_to_num(p[1] - arc + p[3] * along - z / scale, nan=1e3)

    start = [-0.5 * slope / bend, z0 - 0.25 * slope**2 / bend, -2.0 * bend, slopes[axis]]
    with np.errstate(invalid="ignore"):
        x0, top, curvature, tilt = optimize.least_squares(rest, start, method="lm", xtol=1e-14, ftol=1e-14).x
    return Cylinder(axis, (float(x0 * scale), float(top * scale)), float(scale / curvature), float(tilt))


def _fitted(valid: BoolArray) -> tuple[IntArray, IntArray]:
    """Return the indices along both axes of the valid points that are fitted to. Raises NoSphere for few."""
    i, j = np.nonzero(valid)
    if i.size < FEWEST_POINTS:
        raise NoSphere("fewer than ten points")
    every = max(1, i.size // FIT_POINTS)
    return i[::every], j[::every]


def _sag(squared: FloatArray, curvature: float) -> FloatArray:
    """Return κ r²/(1 + √(1 − κ² r²)) [mm] for r² [mm²] and κ [1/mm]; NaN beyond the equator."""
    return np.asarray(curvature * squared / (1.0 + np.sqrt(1.0 - curvature**2 * squared)))
