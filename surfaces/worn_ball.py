"""What a ball has lost: from its topography, or from two diagonals of its worn patch."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.ndimage

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray
from warpwear.surfaces.outliers import TO_SIGMA
from warpwear.surfaces.sphere_fit import NoSphere, Sphere, fit_sphere, places

THRESHOLD = 4.0  # robust standard deviations of the unworn surface by which the worn patch lies below
FIRST_RING = 0.5  # of the field's half width: the unworn part is looked for outside of it first
LEAST_UNWORN = 0.1  # of the field
ROUNDS = 30


@dataclass(frozen=True)
class Cap:
    """A cap cut off a ball: height and the radius of its rim a [mm], volume [mm³]."""

    height: float
    rim: float
    volume: float


@dataclass(frozen=True, kw_only=True, eq=False)
class WornBall:
    """sphere: the unworn one; lost: depth below it [mm], shape (nx, ny); patch: the worn points.

    volume: lost inside the patch [mm³], raised: the part of it that lies above the sphere; depth: largest
    [mm]; along, across: extents of the patch [mm]; noise: robust scatter of the unworn surface [mm].
    """

    sphere: Sphere
    lost: FloatArray
    patch: npt.NDArray[np.bool_]
    volume: float
    raised: float
    depth: float
    along: float
    across: float
    noise: float


def cap_of_diagonals(first: float, second: float, *, radius: float) -> Cap:
    """The flat cap whose rim has two measured diagonals [mm], on a ball of a radius [mm].

    h = R − √(R² − a²) (thesis eq 3.1, without its cancellation) with a half their mean, V = π h² (3R − h)/3.
    InputError for diagonals that are not positive or wider than the ball.
    """
    if not (0.0 < radius < math.inf):
        raise InputError(f"--radius is {radius:g} mm: allowed is any positive length")
    for diagonal in (first, second):
        if not 0.0 < diagonal <= 2.0 * radius:
            raise InputError(
                f"--diagonals has {diagonal:g} mm: allowed is up to the ball's diameter, {2 * radius:g} mm"
            )
    rim = 0.25 * (first + second)
    height = rim * rim / (radius + math.sqrt(radius * radius - rim * rim))
    return Cap(height=height, rim=rim, volume=math.pi * height**2 * (3.0 * radius - height) / 3.0)


def find_worn_ball(
    heights: FloatArray, *, pixel: tuple[float, float], radius: float | None = None
) -> WornBall:
    """The worn patch of a ball in complete heights [mm], shape (nx, ny), positive out of it; pixel [mm].

    A sphere (of the given radius [mm], or fitted) goes through what is not worn: first the outer part of the
    field, then, in rounds, all that does not lie below it by four times its scatter or next to what does.
    The patch is the largest connected piece below. InputError where no sphere fits or nothing is worn.
    """
    x, y = places((heights.shape[0], heights.shape[1]), pixel)
    half = 0.5 * np.array([np.ptp(x), np.ptp(y)])
    outer = np.maximum.outer(np.abs(x) / half[0], np.abs(y) / half[1]) > FIRST_RING
    unworn, patch = outer, ~outer
    noise = 0.0
    for _ in range(ROUNDS):
        try:
            sphere = fit_sphere(heights, pixel=pixel, where=unworn, radius=radius)
        except NoSphere as error:
            raise InputError(f"no sphere fits the unworn part of the ball: {error}") from error
        if sphere.radius < 0:
            raise InputError(
                "the measurement is hollow, not a ball: --height-sign down turns heights over where it "
                "gives depths"
            )
        lost = sphere.heights(x, y) - heights
        if np.isnan(lost).any():
            raise InputError("the measurement reaches beyond the ball: --crop takes a smaller part")
        rest = lost[unworn]
        noise = TO_SIGMA * float(np.median(np.abs(rest - np.median(rest))))
        limit = max(THRESHOLD * noise, 1e-6 * float(np.ptp(lost)))
        smooth = scipy.ndimage.uniform_filter(lost, 5, mode="nearest")
        labels, pieces = scipy.ndimage.label(smooth > limit / 2.0)
        if not pieces:
            raise InputError("nothing on the ball stands out as worn")
        sums = scipy.ndimage.sum_labels(np.maximum(lost, 0.0), labels, np.arange(1, pieces + 1))
        found = scipy.ndimage.binary_fill_holes(labels == 1 + int(np.argmax(sums)))
        same = np.array_equal(found, patch)
        patch = found
        # what is next to the patch may be piled up
        grown = scipy.ndimage.binary_dilation(patch, iterations=max(2, min(heights.shape) // 50))
        unworn = ~grown & ((lost < limit) | ~outer & ~grown)
        if unworn.mean() < LEAST_UNWORN:
            raise InputError("too little of the ball is unworn to fit a sphere to it")
        if same:
            break
    area = pixel[0] * pixel[1]
    rows, columns = np.flatnonzero(patch.any(axis=1)), np.flatnonzero(patch.any(axis=0))
    return WornBall(
        sphere=sphere,
        lost=lost,
        patch=patch,
        volume=float(lost[patch].sum()) * area,
        raised=float(np.maximum(-lost[grown], 0.0).sum()) * area,
        depth=float(lost[patch].max()),
        along=float(rows[-1] - rows[0] + 1) * pixel[0],
        across=float(columns[-1] - columns[0] + 1) * pixel[1],
        noise=noise,
    )
