"""Find spikes of an instrument, which lie far from the surface around them."""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.filling import filled

ndimage = lazy.module("scipy.ndimage")

REPEATED = 3  # times that a mark of lost points stands in a file, at least
MARKED = 3.0  # times the range of the others by which a mark is away from them
STEPS = 20  # different values that others have, at least
AT_END, FEWEST_AT_END = 0.01, 5  # part of the values, and how many, that make the end of a sensor's range
TIMES_NEXT = 3.0  # times that they are as many as those at the next value
WINDOW = 5  # pixels of the local median: outvotes spikes of up to 12 pixels
HALF = WINDOW // 2  # pixels from the rim to the nearest middle of a window that fits
ROUNDS = 12  # bounded, as walls of what is wider than the window would be eaten from their corners
SAMPLES = 200_000  # of a spread, about: more say nothing new of its median
TO_SIGMA = 1.4826  # median absolute deviation to standard deviation, of Gaussian values


def robust_deviation(values: FloatArray, centre: float | None = None) -> float:
    """Return the standard deviation of values about their median, or a centre, from absolute deviations."""
    centre = float(np.median(values)) if centre is None else centre
    return TO_SIGMA * float(np.median(np.abs(values - centre)))


def marks_of_loss(values: FloatArray) -> list[float]:
    """Return the values, of shape (n,), that stand for lost points, such as -999: they repeat, far outside.

    Values of few steps, as of a profile that is drawn, have none.
    """
    least = values.size // 2
    for end in (float(values.min()), float(values.max())):
        others = values[values != end]
        if not (values.size - others.size >= REPEATED and others.size > least):
            continue
        if np.abs(others - end).min() > MARKED * np.ptp(others) and np.unique(others).size > STEPS:
            return [end, *marks_of_loss(others)]
    return []


def at_ends(values: FloatArray) -> list[float]:
    """Return the least and the largest of values, shape (n,), if so many are equal to it that more may be."""
    ends = []
    for end, next_to in ((values.min(), np.min), (values.max(), np.max)) if values.size else ():
        count = np.count_nonzero(values == end)
        if max(FEWEST_AT_END, AT_END * values.size) <= count < values.size:
            others = values[values != end]
            ends += [float(end)] * bool(count >= TIMES_NEXT * np.count_nonzero(others == next_to(others)))
    return ends


@dataclass(frozen=True, eq=False)
class Outliers:
    """Outliers are points that lie farther than a limit from the surface around them."""

    where: BoolArray  # shape (nx, ny)
    limit: float  # inside [mm]; on the outer two rows and columns it is higher
    farthest: float  # distance of the farthest [mm], 0 where there is none

    @property
    def points(self) -> int:
        """Return how many points are outliers."""
        return int(self.where.sum())

    @property
    def groups(self) -> int:
        """Return how many connected groups they form, corners counted as connections."""
        return int(ndimage.label(self.where, structure=np.ones((3, 3)))[1])


def outliers(heights: FloatArray, *, deviations: float) -> Outliers:
    """Find the points farther than `deviations` robust standard deviations from the local median surface.

    heights [mm], shape (nx, ny), NaN where missing. The local median is that of 5 × 5 pixels. At the rim,
    where no window fits, it goes on straight (odd reflection of the medians, not of the heights, so a spike
    there is not copied and a tilt is kept). The standard deviation is 1.4826 times the median absolute
    deviation from the local mean of the same pixels, over the whole field, so neither knows of the spikes.
    (From the mean, since that is Gaussian on a Gaussian surface: at 6 nothing of one is removed; on a smooth
    surface the median is mostly the point itself.) The outer two rows and columns have their own: of what
    the same one-sided continuation misses all over the field. Form and tilt do not matter over 5 pixels.

    What is found is replaced by the local median and all points are tested again, until nothing changes (or
    after 12 rounds; in the end what is near the local mean of the others stays, as that one is Gaussian):
    blocks of up to 5 × 5 pixels go, from their corners inwards, and rows and columns along the rim. Of
    larger blocks some or all may stay: they could be the surface. What is real and stands out of a surface
    smooth over more than half its points (rough valleys of a plateau) cannot be told from spikes and goes.
    """
    valid = ~np.isnan(heights)
    short = [(0, max(0, WINDOW - n)) for n in heights.shape]
    inside = tuple(slice(0, n) for n in heights.shape)
    original = np.pad(filled(heights), short, mode="symmetric")
    valid = np.pad(valid, short)
    limits = _limits(original, valid, deviations)
    field = original.copy()
    core = (slice(HALF, -HALF),) * 2
    median = np.ascontiguousarray(ndimage.median_filter(field, size=WINDOW)[core])
    where = np.zeros(field.shape, dtype=np.bool_)
    within = np.zeros(field.shape, dtype=np.bool_)
    within[core] = True
    rim_too = False
    for turn in range(ROUNDS):
        rim_too |= turn == ROUNDS // 2
        surface = _continued(median)
        distance = np.abs(original - surface)
        before, where = where, valid & (distance > limits)
        if not rim_too:  # what is continued from a spike says nothing of the rim
            where &= within
        touched = before | where
        field[touched] = np.where(where, surface, original)[touched]
        settled = np.array_equal(before, where)
        if settled and rim_too:
            break
        rim_too |= settled
        _update(median, field, touched)
    if where.any():
        where &= np.abs(original - _continued(_mean(field))) > limits
    return Outliers(
        where=where[inside],
        limit=float(limits[HALF, HALF]),
        farthest=float(distance[where].max()) if where.any() else 0.0,
    )


def _continued(inner: FloatArray) -> FloatArray:
    """Return values of the windows that fit, continued straight to the rim: shape (nx, ny)."""
    return np.pad(inner, HALF, mode="reflect", reflect_type="odd")


def _mean(field: FloatArray) -> FloatArray:
    """Return the means of the windows that fit, shape (nx − 4, ny − 4)."""
    return ndimage.uniform_filter(field, size=WINDOW)[HALF:-HALF, HALF:-HALF]


def _update(median: FloatArray, field: FloatArray, changed: BoolArray) -> None:
    """Bring the medians, of the windows that fit, up to date where the field changed."""
    near = ndimage.binary_dilation(changed, structure=np.ones((WINDOW, WINDOW)))
    i, j = np.nonzero(near[HALF:-HALF, HALF:-HALF])
    windows = np.lib.stride_tricks.sliding_window_view(field, (WINDOW, WINDOW))
    median[i, j] = np.median(windows[i, j].reshape(i.size, WINDOW**2), axis=1)


def _limits(field: FloatArray, valid: BoolArray, deviations: float) -> FloatArray:
    """Return the limit [mm] of the distance from the median surface at every point, shape (nx, ny)."""
    mean = _mean(field)
    flat = 1e-12 * float(np.abs(field).max())
    limits = np.empty(field.shape)
    sigmas = np.zeros((HALF + 1, HALF + 1))
    # `to_x`: pixels from a point to the nearest middle of a window that fits, 0 inside
    for to_x, to_y in product(range(HALF + 1), repeat=2):
        spread = _missed(field, valid, mean, to_x, to_y)
        # no less than nearer: on a smooth form the bias of mean and continuation may cancel
        sigmas[to_x, to_y] = sigma = max(_robust(spread, flat), float(sigmas[: to_x + 1, : to_y + 1].max()))
        limits[np.ix_(_at(to_x, field.shape[0]), _at(to_y, field.shape[1]))] = deviations * sigma
    return limits


def _at(outside: int, count: int) -> list[int]:
    """Return the places along an axis of `count` that lie `outside` pixels off the windows' middles."""
    if outside == 0:
        return list(range(HALF, count - HALF))
    return [HALF - outside, count - 1 - HALF + outside]


def _missed(field: FloatArray, valid: BoolArray, mean: FloatArray, to_x: int, to_y: int) -> FloatArray:
    """Return how far [mm] a mean continued by to_x, to_y pixels is from the heights, at valid points."""
    nx, ny = (n - 2 * t for n, t in zip(mean.shape, (to_x, to_y), strict=True))
    if nx < 1 or ny < 1:
        return np.abs(_continued(mean) - field)[valid]
    step = max(1, int(math.sqrt(nx * ny / SAMPLES)))
    guess = np.zeros((-(-nx // step), -(-ny // step)))
    for (weight_x, at_x), (weight_y, at_y) in product(
        *([(2.0, t), (-1.0, 2 * t)] if t else [(1.0, 0)] for t in (to_x, to_y))
    ):
        guess += weight_x * weight_y * mean[at_x : at_x + nx : step, at_y : at_y + ny : step]
    here = (slice(HALF, HALF + nx, step), slice(HALF, HALF + ny, step))
    return np.abs(guess - field[here])[valid[here]]


def _robust(spread: FloatArray, flat: float) -> float:
    """Return the standard deviation behind absolute deviations, less those up to `flat` if half are."""
    sigma = robust_deviation(spread, 0.0) if spread.size else math.inf
    if sigma > flat:
        return sigma
    steps = spread[spread > flat]
    return robust_deviation(steps, 0.0) if steps.size else math.inf
