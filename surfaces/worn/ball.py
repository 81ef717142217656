"""What a ball has lost: from its topography, or from two diagonals of its worn patch."""

import math
from dataclasses import dataclass, replace

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, refused
from warpwear.surfaces.filling import filled
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.sphere import NoSphere, Sphere, fit_sphere, places
from warpwear.surfaces.worn.patch import FittedBody, Patch, check_points
from warpwear.surfaces.worn.waviness import ROUGH

ndimage = lazy.module("scipy.ndimage")

THRESHOLD = 4.0  # robust standard deviations of the unworn surface by which the worn patch lies below
FIRST_RING = 0.5  # of the field's half width: the unworn part is looked for outside of it first
CORNERS = 1.0 - math.pi / 4.0  # of what is measured, the outermost, as a field's corners: a second start
LEAST_UNWORN = 0.1  # of the field
LEAST_FOR_RADIUS = 0.25  # of the field, where the radius is to be fitted too
LEAST_ERRORS = 3.75  # of the volume: the deepest patch of an unworn ball has more in 2 or 3 of 100
AGREEMENT = 0.03  # of the volume, or three standard errors, by which two starts may differ
ROUNDS = 30  # in which the patch is found
SMOOTHED = 5  # pixels along each side of the mean in which the deeper part is looked for
REACH = 1.25  # of the radius of a flat cut's patch: what lies farther from its deeper half is not worn
TOO_LITTLE = "too little of the ball is unworn to fit a sphere to it: a wider measurement is needed"
NOT_TOLD = (
    "too little of the ball is unworn to tell its radius from: --radius gives it, or a wider measurement is "
    "needed"
)


@dataclass(frozen=True)
class Cap:
    """A flat cut takes a cap off a ball."""

    height: float  # [mm]
    rim: float  # radius of its rim [mm]
    volume: float  # [mm³]


@dataclass(frozen=True, kw_only=True, eq=False)
class WornBall(Patch):
    """A worn ball has lost what its topography lacks of the unworn sphere."""

    sphere: Sphere  # the unworn one


def cap_of_diagonals(first: float, second: float, *, radius: float) -> Cap:
    """Return the flat cap whose rim has two measured diagonals [mm], on a ball of a radius R [mm].

    Its height is h = R − √(R² − a²) (thesis eq 3.1, without its cancellation) with a half the diagonals'
    mean, its volume V = π h² (3R − h)/3. Raises InputError for a radius or diagonals that are not positive,
    and for diagonals wider than the ball.
    """
    if not (0.0 < radius < math.inf):
        raise InputError(f"--radius is {radius:g} mm: allowed is any positive length")
    for diagonal in (first, second):
        if not 0.0 < diagonal <= 2.0 * radius:
            raise InputError(f"a diameter is {diagonal:g} mm: allowed is up to the ball's, {2 * radius:g} mm")
    rim = 0.25 * (first + second)
    height = rim * rim / (radius + math.sqrt(radius * radius - rim * rim))
    return Cap(height=height, rim=rim, volume=math.pi * height**2 * (3.0 * radius - height) / 3.0)


def find_worn_ball(
    heights: FloatArray, *, pixel: tuple[float, float], radius: float | None = None
) -> WornBall:
    """Find the worn patch of a ball in heights [mm], shape (nx, ny), positive out of the material.

    heights: NaN where missing; the depth lost is filled there from its rim. pixel: (px, py) [mm]. A sphere
    (of the given radius [mm], or fitted) goes through what is not worn: first the outer part of the field,
    then, in rounds, all that does not lie below it by four times its scatter or next to what does. The patch
    is the largest connected piece below, grown to where its surroundings no longer lie lower on average. A
    fitted radius must give the same volume from a start in the corners of the field alone (where they lack:
    the outermost fifth of what was measured), and the patch must be deeper in its middle: where little is
    unworn, its flat may pass for the sphere. The patch was chosen as the deepest: it must have lost 3.75
    standard errors. Raises InputError where no sphere fits, nothing is worn, or too little is
    unworn to tell the radius.
    """
    check_points(heights.shape)
    x, y = places(heights.shape, pixel)
    u, v = (np.abs(p) / (0.5 * np.ptp(p)) for p in (x, y))
    ball = _find(heights, np.maximum.outer(u, v) > FIRST_RING, pixel=pixel, radius=radius)
    if radius is None:
        try:
            out = np.hypot.outer(u, v)
            outermost = out > np.quantile(out[~np.isnan(heights)], 1.0 - CORNERS)
            other = _find(heights, outermost, pixel=pixel, radius=None)
        except InputError as error:
            raise InputError(NOT_TOLD) from error
        allowed = max(AGREEMENT * abs(ball.volume), 3.0 * ball.volume_error)
        if abs(ball.volume - other.volume) > allowed or _bend(ball.lost, ball.patch, pixel) >= 0.0:
            raise InputError(NOT_TOLD)
    if ball.volume <= LEAST_ERRORS * ball.volume_error:
        raise refused("unworn_ball", volume=ball.volume, error=ball.volume_error)
    return ball


def _find(
    heights: FloatArray, start: BoolArray, *, pixel: tuple[float, float], radius: float | None
) -> WornBall:
    """Find the worn patch from a start: the points that are taken as unworn at first, shape (nx, ny)."""
    x, y = places(heights.shape, pixel)
    measured = ~np.isnan(heights)
    unworn, patch = start & measured, ~start
    # as if the fit were one of 1, x, y and, where the radius is fitted too, x² + y²
    half = float(np.hypot(np.ptp(x), np.ptp(y))) / 2.0
    px, py = np.meshgrid(x / half, y / half, indexing="ij")
    terms, least, lacking = np.stack([np.ones_like(px), px, py, px**2 + py**2]), LEAST_FOR_RADIUS, NOT_TOLD
    if radius is not None:
        terms, least, lacking = terms[:3], LEAST_UNWORN, TOO_LITTLE
    for _ in range(ROUNDS):
        try:
            sphere = fit_sphere(heights, pixel=pixel, where=unworn, radius=radius)
        except NoSphere as error:
            raise InputError(f"no sphere fits the unworn part of the ball: {error}") from error
        if sphere.radius < 0:
            raise InputError("the measurement is hollow, not a ball: --height-sign down turns depths over")
        lost = sphere.heights(x, y) - heights
        if np.isnan(lost[measured]).any():
            raise InputError("the measurement reaches beyond the ball: --crop takes a smaller part")
        lost = filled(lost)
        noise = robust_deviation(lost[unworn])
        limit = max(THRESHOLD * noise, 1e-6 * float(np.ptp(lost)))
        smooth = ndimage.uniform_filter(lost, SMOOTHED, mode="nearest")
        labels, pieces = ndimage.label(smooth > limit / 2.0)
        if not pieces:
            raise InputError("nothing on the ball stands out as worn")
        sums = ndimage.sum_labels(np.maximum(lost, 0.0), labels, np.arange(1, pieces + 1))
        seed = ndimage.binary_fill_holes(labels == 1 + int(np.argmax(sums)))
        near = _near(smooth, seed, pixel=pixel)
        body = FittedBody(lost=lost, unworn=unworn, pixel=pixel, terms=terms)
        reach = body.grown(seed & near, near)
        same = np.array_equal(reach.patch, patch)
        patch = reach.patch
        unworn = measured & ~patch & ~reach.rim & ((lost < limit) | ~start)
        if unworn.mean() < least:
            raise InputError(lacking)
        if same:
            break
    worn = replace(body, unworn=unworn).worn_patch(reach, noise=noise, hurst=ROUGH)
    return WornBall(sphere=sphere, **vars(worn))


def _bend(lost: FloatArray, patch: BoolArray, pixel: tuple[float, float]) -> float:
    """Return the factor of x² + y² [1/mm] in the depth lost over the patch; below 0 its middle is deepest."""
    x, y = places(lost.shape, pixel)
    i, j = np.nonzero(patch)
    design = np.stack([np.ones(i.size), x[i], y[j], x[i] ** 2 + y[j] ** 2], axis=1)
    return float(np.linalg.lstsq(design, lost[patch], rcond=None)[0][3])


def _near(smooth: FloatArray, seed: BoolArray, *, pixel: tuple[float, float]) -> BoolArray:
    """Return what may belong to the patch about its deeper half: beyond are valleys of a wavy ball.

    smooth: depth lost [mm], smoothed, seed: the deeper part, shapes (nx, ny). Where a ball is cut flat, the
    half depth has 1/√2 of the patch's radius.
    """
    deepest = np.unravel_index(int(np.argmax(np.where(seed, smooth, -np.inf))), seed.shape)
    labels = ndimage.label(smooth > 0.5 * smooth[deepest])[0]
    deep = ndimage.binary_fill_holes(labels == labels[deepest])
    radius = math.sqrt(float(deep.sum()) * pixel[0] * pixel[1] / math.pi)
    distance = ndimage.distance_transform_edt(~deep, sampling=pixel)
    return np.asarray(distance <= (math.sqrt(2.0) * REACH - 1.0) * radius)
