"""Lay two measurements of one place over each other, by shift, rotation and tilt, and take the difference."""

import itertools
import math
from dataclasses import dataclass
from functools import partial
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, refused
from warpwear.surfaces.filling import filled
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.sphere import places

fft = lazy.module("scipy.fft")
ndimage = lazy.module("scipy.ndimage")

COARSE = 160  # points along the longer side at which shift and rotation are looked for
LARGEST_ANGLE = math.radians(6.0)  # that is looked for
ANGLE_STEP = 0.5  # coarse points by which the ends of the field move between two angles
FIT_POINTS = 150_000  # more change the fit by less than the noise does
COARSE_POINTS = 6_000  # of coarse maps that are fitted to each other
ROUNDS = 30  # of the fit
CANDIDATES = 5  # places, of each whitening, that are fitted to coarse maps
WHITENED = (1.0, 0.5)  # power of a wave's strength that is taken off: a lay of few waves needs some left
APART = 3.0  # coarse steps, or steps of the angle, by which two places differ
CERTAIN = 0.95  # correlation from which no other place is tried
FIRST_ROUNDS = 5  # of the fit of each of these places
FITTED = 3  # of these places, the best after the first rounds, that are fitted to the end
LEAST_COARSE = 0.3  # correlation of coarse maps, after the first rounds and in the end, to go on
STEADY = 4.0  # robust standard deviations: what differs more is worn and not fitted to
FORM_POINTS = 5_000  # that the first form is fitted to
FORM_ROUNDS = 20  # of weighted fits that find the form of least absolute deviations
FINE = 1.0 / 16.0  # of the shorter side: the width of the mean from which fine heights are taken
STEP = 0.05  # of the field, over which both are compared
ALIKE = 30.0  # times by which the steps of both surfaces may differ: more is another unit
SETTLED = 1e-3  # pixels that the ends of the field move in a last round
LEAST_CORRELATION = 0.5  # below it a difference scatters more than either measurement
LEAST_AGREEING = 0.6  # of the power of long waves, in the directions in which both agree least
DIRECTIONS = 12  # of waves, in which these agree or not
LEAST_SHARE = 0.002  # of the power of all long waves that a direction has, beyond noise, where it is asked
FADED = 6.0  # points over which heights fade out towards what is not compared
LONG = 0.125  # waves a point, at most, of a long wave
SHORT = 0.4  # waves a point, at least, of one that the noise is told from
LEAST_KNOWN = 0.8  # of a line along the edge of what both show, over the part that is known within it
MOST_FILLED = 0.5  # of the points about a place that may be filled ones where its height is known
FEWEST_PIXELS = 8  # of the earlier measurement along the later one's field
LEAST_OVERLAP = 0.25  # of the later measurement's field
EVERYWHERE = slice(None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Difference:
    """A later measurement less an earlier one, where both are known."""

    heights: FloatArray  # [mm], shape (nx, ny), NaN where either is missing; tilt is left in
    shift: tuple[float, float]  # of the earlier one on the later one's field [mm]
    rotation: float  # of the earlier one [rad], from x to y
    correlation: float  # of both where nothing is worn
    window: tuple[slice, slice]  # rows and columns of the later measurement that both show


@dataclass(frozen=True, eq=False)
class _Earlier:
    """The earlier measurement can be sampled anywhere, NaN where it knows nothing."""

    splines: FloatArray  # coefficients of its cubic splines, shape (nx, ny)
    missing: FloatArray | None  # 1 where missing, shape (nx, ny); None where nothing is
    pixel: tuple[float, float]

    def at(self, x: FloatArray, y: FloatArray, place: FloatArray) -> FloatArray:
        """Return heights [mm] at points (x, y) [mm] of the later field. place: shift x, y [mm], rotation."""
        cosine, sine = math.cos(place[2]), math.sin(place[2])
        moved = (cosine * x - sine * y + place[0], sine * x + cosine * y + place[1])
        triples = zip(moved, self.splines.shape, self.pixel, strict=True)
        index = [p / pixel + 0.5 * (count - 1) for p, count, pixel in triples]
        options: dict[str, Any] = {"mode": "nearest", "prefilter": False}
        heights = ndimage.map_coordinates(self.splines, index, order=3, **options)
        if self.missing is None:
            ends = zip(index, self.splines.shape, strict=True)
            outside = np.logical_or.reduce([(i < 0.0) | (i > count - 1) for i, count in ends])
        else:
            part = ndimage.map_coordinates(self.missing, index, order=1, mode="constant", cval=1.0)
            outside = part > MOST_FILLED
        return np.where(outside, np.nan, heights)


class _Map(NamedTuple):
    """Heights [mm], shape (nx, ny), have a pixel [mm]."""

    heights: FloatArray
    pixel: tuple[float, float]

    @property
    def extent(self) -> tuple[float, float]:
        """Return how far the field reaches along both axes [mm]."""
        (nx, ny), (px, py) = self.heights.shape, self.pixel
        return nx * px, ny * py


def difference(
    later: FloatArray, earlier: FloatArray, *, pixel: tuple[float, float], earlier_pixel: tuple[float, float]
) -> Difference:
    """Lay an earlier measurement over a later one of the same place and take it off.

    Heights [mm], shapes (nx, ny) each, NaN where missing; pixels (px, py) [mm]. Shift and rotation (up to
    6°) are found by phase correlation of coarse maps, then fitted by least squares to the points that did
    not change, together with the tilt. Raises InputError where the two do not show the same place.
    """
    later, earlier = (without_polynomial(heights, degree=1) for heights in (later, earlier))
    maps = _Map(later, pixel), _Map(earlier, earlier_pixel)
    _check_alike(*maps)
    # filled, a hole does not ring in the splines beside it: lost points cost themselves alone
    splines = ndimage.spline_filter(filled(earlier), order=3, mode="nearest")
    absent = np.isnan(earlier)
    sampled = _Earlier(splines, absent * 1.0 if absent.any() else None, earlier_pixel)
    place, correlation = _coarse_place(*maps)
    if correlation >= LEAST_COARSE:
        place, correlation = _fitted(later, sampled, place, pixel=pixel)
    if not correlation >= LEAST_CORRELATION:
        raise refused("other_place", correlation=correlation, least=LEAST_CORRELATION)
    x, y = places((later.shape[0], later.shape[1]), pixel)
    below = sampled.at(*np.meshgrid(x, y, indexing="ij"), place)
    agreeing = _agreeing_waves(later, below, pixel)
    if not agreeing >= LEAST_AGREEING:
        raise refused(
            "repeated_grooves",
            correlation=correlation,
            percent=100.0 * max(agreeing, 0.0),
            least=100.0 * LEAST_AGREEING,
        )
    rows, columns = _shared(~np.isnan(below))
    heights = (later - below)[rows, columns]
    if heights.size < LEAST_OVERLAP * later.size:
        raise refused("small_overlap", percent=100.0 * heights.size / later.size, least=100.0 * LEAST_OVERLAP)
    return Difference(
        heights=heights,
        shift=(float(place[0]), float(place[1])),
        rotation=float(place[2]),
        correlation=correlation,
        window=(rows, columns),
    )


def _coarse_place(later: _Map, earlier: _Map) -> tuple[FloatArray, float]:
    """Return shift x, y [mm] and rotation [rad] by phase correlation of coarse maps, and their correlation.

    Of the places with the highest peaks over all angles it is the one about which the maps, fitted to each
    other, correlate best.
    """
    extent = later.extent
    step = max(max(extent) / COARSE, *later.pixel, *earlier.pixel)
    shape = (max(8, round(extent[0] / step)), max(8, round(extent[1] / step)))
    x, y = np.meshgrid(*places(shape, (step, step)), indexing="ij")
    here = np.zeros(3)
    before, coarse = _coarse(earlier, step), _coarse(later, step)
    # tapered, so that the edges of the field do not correlate with themselves
    taper = np.multiply.outer(*(np.hanning(n + 2)[1:-1] for n in shape))
    size = [fft.next_fast_len(2 * n, real=True) for n in shape]
    unworn = _unworn(np.nan_to_num(coarse.at(x, y, here)))
    waves = fft.rfft2(taper * np.nan_to_num(unworn), s=size)
    # a Gaussian of one point's width: a shift between two points is spread over both
    along, across = fft.fftfreq(size[0]), fft.rfftfreq(size[1])
    spread = np.exp(-2.0 * math.pi**2 * np.add.outer(np.square(along), np.square(across)))
    turns = ANGLE_STEP * step / (0.5 * math.hypot(*extent))
    peaks: dict[float, list[tuple[float, FloatArray]]] = {power: [] for power in WHITENED}
    for angle in np.arange(-math.ceil(LARGEST_ANGLE / turns), math.ceil(LARGEST_ANGLE / turns) + 1) * turns:
        turned = np.nan_to_num(before.at(x, y, np.array([0.0, 0.0, angle])))
        both = np.conj(waves) * fft.rfft2(taper * turned, s=size)
        strength = np.maximum(np.abs(both), np.finfo(float).tiny)
        for power, candidates in peaks.items():
            peak = fft.irfft2(spread * both / strength**power, s=size)
            i, j = (int(k) for k in np.unravel_index(int(np.argmax(peak)), peak.shape))
            moved = [step * (k - n if k > n // 2 else k) for k, n in zip((i, j), size, strict=True)]
            cosine, sine = math.cos(angle), math.sin(angle)
            turned_place = [cosine * moved[0] - sine * moved[1], sine * moved[0] + cosine * moved[1], angle]
            candidates.append((float(peak.max()), np.array(turned_place)))
    near = np.array([APART * step, APART * step, APART * turns])
    fit = partial(_fitted, unworn, before, pixel=(step, step), points=COARSE_POINTS)
    begun: list[tuple[FloatArray, float]] = []
    starts = itertools.zip_longest(*(_distinct(candidates, near) for candidates in peaks.values()))
    for start in (place for both in starts for place in both if place is not None):
        begun.append(fit(start, rounds=FIRST_ROUNDS))
        if begun[-1][1] > CERTAIN:
            begun = begun[-1:]
            break
    # the right place stands out after a few rounds, in which the others do not settle
    begun.sort(key=itemgetter(1), reverse=True)
    return max((fit(place) for place, _ in begun[:FITTED]), key=itemgetter(1))


def _distinct(peaks: list[tuple[float, FloatArray]], near: FloatArray) -> list[FloatArray]:
    """Return the places of the highest peaks, shape (3,) each, of those `near` each other the highest."""
    distinct: list[FloatArray] = []
    for _, place in sorted(peaks, key=lambda peak: -peak[0]):
        if all((np.abs(place - other) > near).any() for other in distinct):
            distinct.append(place)
    return distinct[:CANDIDATES]


def _plane_terms(shape: tuple[int, ...]) -> FloatArray:
    """Return the terms of a plane at every point of a field, shape (nx · ny, 3)."""
    p, q = (np.linspace(-1.0, 1.0, n) for n in shape)
    return np.stack([np.ones(p.size * q.size), np.repeat(p, q.size), np.tile(q, p.size)], axis=1)


def _rest(values: FloatArray, terms: FloatArray, fitted: BoolArray | slice = EVERYWHERE) -> FloatArray:
    """Return values, shape (n,), less the terms, (n, p), that are fitted to some of them by least squares."""
    return np.asarray(values - terms @ np.linalg.lstsq(terms[fitted], values[fitted], rcond=None)[0])


def _unworn(heights: FloatArray) -> FloatArray:
    """Return heights [mm], shape (nx, ny), over the plane of what is not worn, NaN where they are far off."""
    terms = _plane_terms(heights.shape)
    unworn = unchanged(heights.ravel(), terms)
    return np.where(unworn, _rest(heights.ravel(), terms, unworn), np.nan).reshape(heights.shape)


def _check_alike(later: _Map, earlier: _Map) -> None:
    """Raise InputError where two measurements [mm] cannot show one place: another size, or another unit.

    Compared are the fields, and the median step of height over a part of them, where noise decides less.
    """
    if math.prod(earlier.extent) < LEAST_OVERLAP * math.prod(later.extent) or max(earlier.pixel) > (
        min(later.extent) / FEWEST_PIXELS
    ):
        sizes = [" × ".join(f"{side:.4g}" for side in one.extent) for one in (earlier, later)]
        raise refused(
            "other_field", earlier=sizes[0], later=sizes[1], least=100.0 * LEAST_OVERLAP, fewest=FEWEST_PIXELS
        )
    apart = max(*later.pixel, *earlier.pixel, STEP * later.extent[0])
    steps = []
    for heights, pixel in (later, earlier):
        i, j = (max(1, round(apart / d)) for d in pixel)
        steps.append(float(np.nanmedian(np.abs(np.diff(heights[::i, ::j], axis=0)))))
    if min(steps) > 0.0 and not 1.0 / ALIKE <= steps[1] / steps[0] <= ALIKE:
        raise refused("other_unit", times=steps[1] / steps[0])


def _coarse(source: _Map, step: float) -> _Earlier:
    """Return a map smoothed for sampling at a step [mm]."""
    size = [max(1, round(step / p)) for p in source.pixel]
    smooth = ndimage.uniform_filter(filled(source.heights), size, mode="nearest")
    return _Earlier(ndimage.spline_filter(smooth, mode="nearest"), None, source.pixel)


def _fitted(
    later: FloatArray,
    earlier: _Earlier,
    place: FloatArray,
    *,
    pixel: tuple[float, float],
    points: int = FIT_POINTS,
    rounds: int = ROUNDS,
) -> tuple[FloatArray, float]:
    """Return the place (shift x, y [mm], rotation [rad]) fitted from a first one, and the correlation.

    points: to which it is fitted, about; rounds: at most. Gauss-Newton steps fit place and tilt to the points
    that did not change; which these are is found anew in each round. The correlation is 0 where too little is
    known.
    """
    stride = max(1, math.ceil(math.sqrt(later.size / points)))
    x, y = (p[::stride] for p in places((later.shape[0], later.shape[1]), pixel))
    x, y = (p.ravel() for p in np.meshgrid(x, y, indexing="ij"))
    known = later[::stride, ::stride].ravel()
    reach, small = 0.5 * math.hypot(float(np.ptp(x)), float(np.ptp(y))), 0.5 * min(pixel)
    changes = small * np.eye(3)[:2]
    for _ in range(rounds):
        below = earlier.at(x, y, place)
        ends = [(earlier.at(x, y, place + c), earlier.at(x, y, place - c)) for c in changes]
        slopes = [(above - beneath) / (2.0 * small) for above, beneath in ends]
        cosine, sine = math.cos(place[2]), math.sin(place[2])
        turning = (cosine * x - sine * y) * slopes[1] - (sine * x + cosine * y) * slopes[0]
        design = np.stack([*slopes, turning, np.ones_like(x), x, y], axis=1)
        rest = known - below
        steady = ~np.isnan(rest) & ~np.isnan(design).any(axis=1)
        if steady.sum() < 10 * design.shape[1]:
            return place, 0.0
        steady[steady] = unchanged(rest[steady], design[steady][:, 3:])
        move = np.linalg.lstsq(design[steady], rest[steady], rcond=None)[0][:3]
        place = place + move
        if max(abs(move[0]), abs(move[1]), reach * abs(move[2])) < SETTLED * min(pixel):
            break
    # of roughness alone: a deep scar has tilted the later one, and the tilt is no part of the place
    tilt = design[steady][:, 3:]
    rough: list[Any] = [_rest(z[steady], tilt) for z in (known, below)]
    if min(float(np.ptp(z)) for z in rough) == 0.0:
        return place, 0.0
    whole = float(np.corrcoef(*rough)[0, 1])
    # long waves of any two surfaces can be laid over each other: what is left of both must agree, too
    shape = later[::stride, ::stride].shape
    weight = steady.reshape(shape) * 1.0
    fine = []
    for z in (known, below):
        heights, width = np.where(steady, z, 0.0).reshape(shape), FINE * min(shape)
        smooth, sums = (ndimage.gaussian_filter(v, width) for v in (heights, weight))
        fine.append((heights - smooth / np.maximum(sums, 1e-9)).ravel()[steady])
    return place, min(whole, float(np.corrcoef(*fine)[0, 1]))


def _agreeing_waves(later: FloatArray, below: FloatArray, pixel: tuple[float, float]) -> float:
    """Return how well the long waves of two fields [mm], shape (nx, ny), NaN where missing, agree.

    pixel [mm]. It is 1 where both fields are one, and less where they are two places: the lower quartile of
    directions, of those with more power than noise has. A lay is one direction of them, and its grooves may
    be laid over other grooves.
    """
    known = np.isfinite(later) & np.isfinite(below)
    terms = _plane_terms(later.shape)
    steady = known.ravel()
    steady[steady] = unchanged((later - below)[known], terms[steady])
    # single points that differ by chance leave no holes
    whole = np.pad(ndimage.binary_closing(steady.reshape(known.shape), iterations=2), 1)
    inwards = ndimage.distance_transform_edt(whole)[1:-1, 1:-1]
    fade = np.square(np.sin(0.5 * np.pi * np.minimum(inwards / FADED, 1.0)))
    waves = []
    for heights in (later, below):
        flat = np.where(steady, _rest(heights.ravel(), terms, steady), 0.0).reshape(fade.shape)
        waves.append(fft.rfft2(fade * (flat - (fade * flat).sum() / fade.sum())))
    along, across = fft.fftfreq(fade.shape[0], pixel[0]), fft.rfftfreq(fade.shape[1], pixel[1])
    number = np.hypot.outer(along, across) * max(pixel)
    power = 0.5 * (np.square(np.abs(waves[0])) + np.square(np.abs(waves[1])))
    noise = float(np.median(power[number > SHORT]))
    # the other half of the waves is not there, but for those along axis 0
    twice = np.where(across == 0.0, 1.0, 2.0) * ((number > 0.0) & (number < LONG))
    angle = np.arctan2(across, along[:, np.newaxis]) % np.pi
    direction = (np.floor(angle / np.pi * DIRECTIONS + 0.5).astype(np.int64) % DIRECTIONS).ravel()
    together = (waves[0] * np.conj(waves[1])).real
    total, agreed, count = (
        np.bincount(direction, v.ravel(), DIRECTIONS) for v in (twice * power, twice * together, twice)
    )
    strong = total - noise * count > LEAST_SHARE * total.sum()
    agreeing = agreed[strong] / total[strong]
    return float(np.quantile(agreeing, 0.25)) if agreeing.size else 1.0


def unchanged(values: FloatArray, terms: FloatArray) -> BoolArray:
    """Return which values [mm], shape (n,), scatter about a form, terms (n, p), and are no wear.

    The form begins as the one of least absolute deviations, which a deep scar does not tilt.
    """
    every = max(1, values.size // FORM_POINTS)
    some, design = values[::every], terms[::every]
    weights = np.ones(some.size)
    floor = max(1e-6 * float(np.ptp(some)), 1e-15)
    for _ in range(FORM_ROUNDS):
        weighted = weights[:, None] * design
        form = np.linalg.lstsq(weighted.T @ design, weighted.T @ some, rcond=None)[0]
        weights = 1.0 / np.maximum(np.abs(some - design @ form), floor)
        weights /= weights.max()
    apart, steady = values - terms @ form, np.ones(values.size, dtype=np.bool_)
    for again in range(5):
        centre = float(np.median(apart[steady]))
        spread = robust_deviation(apart[steady], centre)
        before, steady = steady, np.abs(apart - centre) <= max(STEADY * spread, 1e-15)
        if again and np.array_equal(steady, before):
            break
        inside = terms[steady]
        apart = values - terms @ np.linalg.lstsq(inside.T @ inside, inside.T @ values[steady], rcond=None)[0]
    return steady


def _shared(known: BoolArray) -> tuple[slice, slice]:
    """Return the rows and columns of the rectangle that two fields share, known: shape (nx, ny).

    The side with the largest part unknown is taken off, line by line, until every side is mostly known: what
    the other field does not reach goes, holes stay.
    """
    first, last = [0, 0], list(known.shape)
    while min(last[0] - first[0], last[1] - first[1]) > 1:
        part = known[first[0] : last[0], first[1] : last[1]]
        sides = [part[0].mean(), part[-1].mean(), part[:, 0].mean(), part[:, -1].mean()]
        worst = int(np.argmin(sides))
        if sides[worst] >= LEAST_KNOWN * part.mean():
            break
        axis = worst // 2
        if worst % 2:
            last[axis] -= 1
        else:
            first[axis] += 1
    return slice(first[0], last[0]), slice(first[1], last[1])
