"""The wear scar in a measurement, or in the difference of two: what is gone, and what is piled up."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, refused
from warpwear.surfaces.filling import filled
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.outline import outlined
from warpwear.surfaces.worn.patch import INWARDS, SMOOTHED, FittedBody, Patch, Reach, check_points, extents
from warpwear.surfaces.worn.registration import unchanged
from warpwear.surfaces.worn.waviness import CHANGED

ndimage = lazy.module("scipy.ndimage")

THRESHOLD = 4.0  # robust standard deviations of the unworn surface, smoothed, by which a scar lies below
CERTAIN = 5.5  # of these, by which it does so somewhere: less is chance in one of a field's many places
JOINED = 1.0 / 40.0  # of the shorter side: worn asperities closer than this belong together
PIECE = 0.05  # of the largest worn region: a smaller one beside it is no part of the scar
FILLINGS = 4  # of known points, by which the error of what is filled is told
MAIN = 0.2  # of what the largest region has lost: a smaller one beside it does not lengthen the scar
BESIDE = 1.0  # of the scar's mean extent, within which worn asperities that stand alone belong to it
ROUNDS = 15  # in which the scar is found
FITTED = 20_000  # unworn points, of which the scatter of medians is told
LEAST_UNWORN = 0.2  # of what is measured
LEAST_ERRORS = 3.0  # standard errors that the worn volume must exceed
STRIP = 0.125  # of the scar's length: the middle part whose mean is its profile


@dataclass(frozen=True, eq=False)
class ScarProfile:
    """A scar has a mean profile across sliding, in a band of what unworn surface gives as such a mean."""

    y: FloatArray  # places across [mm] from the middle of the field, shape (ny,)
    depth: FloatArray  # mean depth below the unworn form [mm], shape (ny,)
    band: float  # its standard error at any one place [mm]
    rows: slice  # of the field, that are averaged
    length: float  # of these [mm]


def find_scar(
    heights: FloatArray, *, pixel: tuple[float, float], degree: int = 1, hurst: float = CHANGED
) -> Patch:
    """Find the wear scar in heights [mm], shape (nx, ny), positive out of the material, NaN where missing.

    heights: how they changed, or of the worn surface alone, with `waviness.ROUGH` as `hurst`: its roughness
    is then part of the errors; pixel: (px, py) [mm]. A polynomial of the total degree goes through what is
    not worn, found in rounds. The scar is the region that lies below it by four times the scatter of the
    unworn surface, both smoothed, and by five and a half somewhere; worn asperities next to each other are
    one region, and the valleys between them belong to it. Asperities that have worn alone, within the
    scar's mean extent beside it, belong to it where they are deeper than anything farther off. It reaches
    to where rings about it no longer lie lower on average, beside pile-up to where the heights cross the
    form. Raises InputError where nothing is worn, or too little is unworn to level by.
    """
    check_points(heights.shape)
    nx, ny = heights.shape
    measured = ~np.isnan(heights)
    terms_x, terms_y = (legendre.legvander(np.linspace(-1.0, 1.0, n), degree).T for n in (nx, ny))
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    terms = np.stack([np.multiply.outer(terms_x[i], terms_y[j]) for i, j in powers])
    unworn = measured.copy()
    unworn[measured] = unchanged(heights[measured], terms[:, measured].T)
    coarse = [max(SMOOTHED, round(JOINED * min(nx * pixel[0], ny * pixel[1]) / d)) for d in pixel]
    patch = np.zeros_like(unworn)
    for _ in range(ROUNDS):
        level = -without_polynomial(heights, degree=degree, where=unworn)
        lost = filled(level)
        noise = robust_deviation(lost[unworn], 0.0)
        seed = _seed(lost, unworn, measured, coarse=coarse, pixel=pixel)
        body = FittedBody(lost=lost, unworn=unworn, pixel=pixel, terms=terms)
        reach = body.grown(seed, np.ones_like(seed), noise=noise, inwards=INWARDS)
        same = np.array_equal(reach.patch, patch)
        patch = reach.patch
        unworn = measured & ~patch & ~reach.rim
        part = float(unworn.sum() / measured.sum())
        if part < LEAST_UNWORN:
            raise refused("wide_scar", percent=100.0 * part, least=100.0 * LEAST_UNWORN)
        if same:
            break
    if sides_reached(patch) == 4:
        raise InputError("the scar reaches all four sides of the field: a wider measurement is needed")
    scar = replace(body, unworn=unworn).worn_patch(reach, noise=noise, hurst=hurst)
    guessed = _filling_errors(level, scar) * body.pixel_area
    names = ("volume_error", "piled_up_error", "net_error")
    wider: dict[str, Any] = {n: math.hypot(getattr(scar, n), e) for n, e in zip(names, guessed, strict=True)}
    main, pixel_area = _main(reach.patch, lost), body.pixel_area
    points = outlined(
        lost, main=main, core=seed & main, measured=measured, unworn=unworn, level=scar.edge_error
    )
    # worn asperities that stand alone may be noise, or be part of it
    alone = float((reach.patch & ~main).sum()) / math.sqrt(3.0)
    wider["area"], wider["area_error"] = points[0] * pixel_area, math.hypot(points[1], alone) * pixel_area
    stands_out, scar = scar.volume > LEAST_ERRORS * scar.volume_error, replace(scar, **wider)
    if not scar.volume > LEAST_ERRORS * scar.volume_error:
        lacks = f"{(~measured[patch]).mean():.0%} of the scar's points are missing, which leaves open "
        what = f"{lacks}what it lost" if stands_out else "no scar was found"
        raise InputError(f"{what}: {scar.volume:.3g} ± {scar.volume_error:.2g} mm³")
    along, across, errors = _lengths(reach, lost, unworn, measured, pixel=pixel)
    blurred = [math.hypot(*pair) for pair in zip(scar.length_errors, errors, strict=True)]
    return replace(scar, along=along, across=across, length_errors=(blurred[0], blurred[1]))


def _lengths(
    reach: Reach, lost: FloatArray, unworn: BoolArray, measured: BoolArray, *, pixel: tuple[float, float]
) -> tuple[float, float, tuple[float, float]]:
    """Return how far a scar extends along and across [mm], and what adds to their errors [mm].

    What lies far off beside a scar may be noise, which its volume hardly feels, but its lengths do. Beside
    pile-up the outline is told point by point; elsewhere a ragged scar ends at its outermost worn asperities,
    not at the rings about them. Where a hole hides the end, it is the last that was measured, to half of what
    is filled beyond.
    """
    main = _main(reach.patch, lost)
    whole = extents(main, pixel)
    spread = [SMOOTHED / math.sqrt(12.0) * d * bool(reach.doubtful) for d in pixel]
    # a median keeps an edge where it is
    windows = np.pad(np.where(measured, lost, np.nan), SMOOTHED // 2, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(windows, (SMOOTHED, SMOOTHED))
    some = np.argwhere(unworn)[:: max(1, int(unworn.sum()) // FITTED)]
    noise, depth = (np.nanmedian(windows[at], axis=(1, 2)) for at in (tuple(some.T), main & measured))
    sharp = np.zeros_like(main)
    sharp[main & measured] = depth > THRESHOLD * robust_deviation(noise, 0.0)
    main = sharp if sharp.any() else main
    along, across = extents(main, pixel)
    beyond = zip(spread, whole, (along, across), strict=True)
    errors = [math.hypot(s, 0.5 * (w - n)) for s, w, n in beyond]
    return along, across, (errors[0], errors[1])


def _filling_errors(lost: FloatArray, scar: Patch) -> FloatArray:
    """Return standard errors [mm] that filled points give, shape (3,): of sums over patch, rim and both.

    lost: depth below the form [mm], shape (nx, ny), NaN where missing. The holes are laid over known points
    elsewhere, which are filled in the same way and compared. An instrument loses points where they are deep
    or steep, as no others are: the points next to a hole are most like them, so these are filled, too. What
    they are off by on average the points in the hole are, times their distance from what is known.
    """
    holes, parts = np.isnan(lost), (scar.patch, scar.rim, scar.patch | scar.rim)
    if not (holes & parts[2]).any():
        return np.zeros(3)

    def off(hidden: BoolArray) -> list[float]:
        guess = filled(np.where(hidden, np.nan, lost)) - lost
        tried = [guess[hidden & ~holes & part] for part in parts]
        each = zip(tried, parts, strict=True)
        return [float(t.mean()) * int((holes & p).sum()) if t.size else math.nan for t, p in each]

    shifts = [[round(k * n / (FILLINGS + 1)) for n in lost.shape] for k in range(1, 1 + FILLINGS)]
    elsewhere = np.ma.masked_invalid([off(np.roll(holes, shift, axis=(0, 1))) for shift in shifts])
    beside = np.nan_to_num(off(ndimage.binary_dilation(holes, np.ones((3, 3)))))
    beside *= float(ndimage.distance_transform_edt(holes)[holes & parts[2]].mean())
    return np.sqrt(np.square(elsewhere).mean(axis=0).filled(0.0) + np.square(beside))


def _main(patch: BoolArray, lost: FloatArray) -> BoolArray:
    """Return the largest connected region of a patch, and those that have lost a good part of what it has.

    patch: shape (nx, ny); lost: depth below the unworn form [mm], shape (nx, ny).
    """
    labels, pieces = ndimage.label(patch, structure=np.ones((3, 3)))
    sums = ndimage.sum_labels(lost, labels, np.arange(1, pieces + 1))
    return np.isin(labels, 1 + np.flatnonzero(sums >= MAIN * sums.max()))


def sides_reached(patch: BoolArray) -> int:
    """Return how many of the field's four sides a patch, shape (nx, ny), reaches."""
    return sum(bool(side.any()) for side in (patch[0], patch[-1], patch[:, 0], patch[:, -1]))


def mean_profile(scar: Patch) -> ScarProfile:
    """Return the mean profile across of the middle eighth of a scar, or of a whole groove through the field.

    The band is the root mean square of such means over strips of unworn surface, all that the field has.
    """
    lost, (px, _) = scar.lost, scar.pixel
    rows = np.flatnonzero(scar.patch.any(axis=1))
    through = rows[0] == 0 and rows[-1] == lost.shape[0] - 1
    count = lost.shape[0] if through else max(1, round(STRIP * scar.along / px))
    first = 0 if through else max(0, round(0.5 * float(rows[0] + rows[-1] + 1 - count)))
    kernel = np.full(count, 1.0 / count)
    known = ndimage.convolve1d(scar.unworn * 1.0, kernel, axis=0, mode="constant")
    means = ndimage.convolve1d(np.where(scar.unworn, lost, 0.0), kernel, axis=0, mode="constant")
    # holes and the ends of the field leave strips a little shorter
    enough = known > 0.8 if (known > 0.8).any() else known >= known.max()
    band = math.sqrt(float(np.square(means[enough] / known[enough]).mean()))
    y = places((lost.shape[0], lost.shape[1]), scar.pixel)[1]
    averaged = slice(first, first + count)
    return ScarProfile(y, np.asarray(lost[averaged].mean(axis=0)), band, averaged, count * px)


def _seed(
    lost: FloatArray, unworn: BoolArray, measured: BoolArray, *, coarse: list[int], pixel: tuple[float, float]
) -> BoolArray:
    """Return the region that stands out as worn, shape (nx, ny): the largest of those connected.

    lost [mm], unworn, measured: shape (nx, ny); coarse: pixels along each side over which asperities are
    joined.
    """
    floor = 1e-6 * float(np.ptp(lost))
    fine, wide = (ndimage.uniform_filter(lost, size, mode="nearest") for size in (SMOOTHED, coarse))
    region, sharp = (z > max(THRESHOLD * robust_deviation(z[unworn], 0.0), floor) for z in (wide, fine))
    labels, pieces = ndimage.label(region)
    # means over fewer points, at the field's edges, scatter more
    inner = tuple(slice(n // 2, size - n // 2) for n, size in zip(coarse, lost.shape, strict=True))
    known = np.arange(1, pieces + 1)
    peaks = ndimage.maximum(wide[inner], labels[inner], known) if pieces else np.zeros(0)
    certain = [max(CERTAIN * robust_deviation(z[unworn], 0.0), floor) for z in (wide, fine)]
    known = known[peaks > certain[0]]
    if not known.size:
        raise InputError("no scar was found: nothing lies below the rest of the surface by more than chance")
    sums = ndimage.sum_labels(np.maximum(lost, 0.0), labels, known)
    region = np.isin(labels, known[sums >= PIECE * sums.max()])
    # closed, so that the gaps between worn asperities belong to the scar
    seed, width = sharp & region, max(n * d for n, d in zip(coarse, pixel, strict=True))
    if not seed.any():
        seed = region
    reach = BESIDE * math.sqrt(math.prod(extents(seed, pixel)))
    close = ndimage.distance_transform_edt(~seed, sampling=pixel) <= reach
    far = fine[unworn & ~close]
    if far.size:  # what the unworn surface has elsewhere is no wear beside the scar, either
        # nor is what has half as much above the form next to it, as a steep pit that is laid a little off
        above = ndimage.uniform_filter(np.maximum(-lost, 0.0), SMOOTHED, mode="nearest")
        next_to = ndimage.maximum_filter(above, SMOOTHED)
        close &= measured  # a point at the rim of a hole, whose noise fills it, is no asperity
        seed |= close & (fine > np.maximum(max(far.max(), certain[1]), 2.0 * next_to))
    padded = np.pad(seed, [(n, n) for n in coarse], mode="edge")
    near = ndimage.distance_transform_edt(~padded, sampling=pixel) <= 0.5 * width
    closed = ndimage.distance_transform_edt(np.pad(near, 1, mode="edge"), sampling=pixel)[1:-1, 1:-1]
    field = tuple(slice(n, -n) for n in coarse)
    return np.asarray(ndimage.binary_fill_holes(seed | (closed[field] > 0.5 * width)))
