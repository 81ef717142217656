"""A worn track in a measurement: where it is, its section areas, its volume."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, refused
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.outliers import robust_deviation
from warpwear.surfaces.profiles.profile import Profile
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.waviness import ROUGH, regular_wave, waviness

ndimage = lazy.module("scipy.ndimage")

THRESHOLD = 4.0  # robust standard deviations of the unworn mean profile that a track stands out by
FOOT = 2.0  # robust standard deviations to which it reaches down from there
MARGIN = 0.2  # of its width, added on both sides: the ends of pile-up are low
REACH = 1.0  # of a parabola's width, from its middle, that a track reaches with its pile-up and margins
LEAST_OUTSIDE = 0.05  # of the width across on each side of the track, to level by
ROUNDS = 20  # in which the track is found
LEAST_ERRORS = 3.0  # standard errors that the net section of a track found must exceed
NEEDLE = 0.4  # of a section in a tenth of its width, of which a parabola has 0.15 and a wedge 0.19
SURE = 3.0  # robust standard deviations of the unworn mean profile: what is deeper is no roughness
WIDTH_LEVELS = (0.25, 0.75)  # of the depth, between which the width is followed up to the reference
CELLS = 96  # across, about, at which the error looks: shorter waves average out in a track
BLOCKS = 10  # along the track, whose means are taken as correlated with their neighbours at most


@dataclass(frozen=True, kw_only=True, eq=False)
class WornTrack:
    """A worn track lies along axis 0 of a measurement.

    Section areas are those of single sections, so both hold the roughness too; their difference, in which
    that averages out, is what was lost. A missing point is taken as the mean of the others at its place
    across.
    """

    levelled: FloatArray  # heights [mm] over the form of the surface outside the track, shape (nx, ny)
    degree: int  # of the polynomial taken off
    missing: BoolArray  # points without a height of their own, shape (nx, ny)
    y: FloatArray  # places across [mm] from the middle of the field, shape (ny,)
    inside: BoolArray  # which of them belong to the track with its pile-up and margins, shape (ny,)
    window: tuple[float, float]  # the edges of these [mm]: what is summed
    below: FloatArray  # section areas under the reference in the window [mm²], shape (nx,)
    above: FloatArray  # section areas over the reference in the window [mm²], shape (nx,)
    length: float  # of the measured piece [mm]

    @property
    def net(self) -> FloatArray:
        """Return the section areas lost [mm²], below less above, shape (nx,)."""
        return self.below - self.above

    @cached_property
    def profile(self) -> FloatArray:
        """Return the mean profile across [mm], shape (ny,)."""
        return np.asarray(self.levelled.mean(axis=0))

    @property
    def mean_section(self) -> tuple[float, float]:
        """Return the areas [mm²] of the mean section under and over the reference.

        They are those of the trough and of its pile-up without roughness.
        """
        mean = self.profile[self.inside]
        pixel = (self.window[1] - self.window[0]) / mean.size
        below, above = (float(np.maximum(sign * mean, 0.0).sum()) * pixel for sign in (-1.0, 1.0))
        return below, above

    @cached_property
    def net_error(self) -> float:
        """Return the standard error of the mean net section [mm²].

        It is what levelling and summing over the window would find of a mean profile of unworn surface, as
        it lies beside the track: its roughness and waviness, in the window and under the reference.
        """
        cells = max(1, math.ceil(self.y.size / CELLS))
        count = self.y.size // cells
        terms = legendre.legvander(np.linspace(-1.0, 1.0, self.y.size), self.degree)
        outside = ~self.inside
        taken = np.linalg.lstsq(terms[outside].T, terms[self.inside].sum(axis=0), rcond=None)[0]
        weights = self.inside.astype(np.float64)
        weights[outside] = -taken
        by_cell = [v[: count * cells].reshape(count, cells) for v in (self.profile, self.y, weights)]
        heights, places = by_cell[0].mean(axis=1), by_cell[1].mean(axis=1)
        unworn = np.logical_not(self.inside[: count * cells].reshape(count, cells).max(axis=1))
        spacing = float(places[1] - places[0])
        waves = waviness(
            heights,
            distances=np.abs(np.subtract.outer(places, places)),
            unworn=unworn,
            terms=legendre.legvander(places / (0.5 * count * spacing), self.degree),
            spacing=spacing,
            hurst=ROUGH,
            regular=regular_wave(heights, places=places, unworn=unworn),
        )
        alone = float(cells * np.square(by_cell[2]).sum())
        return waves.error(by_cell[2].sum(axis=1), alone) * spacing / cells

    @property
    def depth(self) -> float:
        """Return how far the mean profile's deepest point lies below the reference [mm]."""
        return float(-self.profile[self.inside].min())

    @cached_property
    def needle(self) -> tuple[float, float] | None:
        """Return a height [mm] below which a tenth of the trough holds much of its section, and that part.

        The trough is what stands out of the roughness beside it. None where its deepest tenth holds little.
        """
        mean = self.profile[self.inside]
        return _needle(mean[mean < -SURE * robust_deviation(self.profile[~self.inside], 0.0)])

    @cached_property
    def width(self) -> float:
        """Return the width of the trough at the level of the reference [mm], without pile-up and margins.

        The width of the mean profile at 25 to 75 % of its depth, squared, is fitted by a straight line over
        the level, as it is for a parabola, and taken on to the reference: there roughness hides the edge. Of
        a `needle` nothing counts.
        """
        mean = self.profile[self.inside]
        if self.needle is not None:
            mean = np.maximum(mean, self.needle[0])
        pixel = (self.window[1] - self.window[0]) / mean.size
        bottom = float(ndimage.uniform_filter1d(mean, max(1, mean.size // 20) | 1).min())
        levels = np.linspace(*WIDTH_LEVELS, 21) * bottom
        widths = [float((mean < level).sum()) * pixel for level in levels]
        squared = float(np.polyfit(levels, np.square(widths), 1)[1])
        return math.sqrt(max(squared, widths[0] ** 2))

    def volume(self, length: float | None = None) -> tuple[float, float]:
        """Return the volume lost over a length [mm] (by default the measured piece) and its error [mm³].

        Beyond the measured piece the error holds how the sections scatter along it, too.
        """
        over = self.length if length is None else length
        beyond = _standard_error(self.net) * math.sqrt(max(0.0, 1.0 - self.length / over))
        return float(self.net.mean()) * over, math.hypot(self.net_error, beyond) * over


def find_track(
    heights: FloatArray, *, pixel: tuple[float, float], degree: int = 1, width: float | None = None
) -> WornTrack:
    """Find the worn track along axis 0 of heights, shape (nx, ny), NaN where missing; pixel (px, py); in mm.

    The surface is levelled by a polynomial of the given total degree through what lies outside the track.
    The track is where the mean profile across stands out of its scatter outside, found in rounds, with its
    pile-up and a margin, if its net section exceeds three standard errors; or, with `width` [mm] and
    whatever its section, the piece of that width about the middle of the deepest part.
    Raises InputError where there is none, or too little surface beside it to level by.
    """
    y = places(heights.shape, pixel)[1]
    missing = np.isnan(heights)
    start = _profile(without_polynomial(heights, degree=degree))
    inside = _first_guess(start) if width is None else _span(start, start < 0.0, pixel=pixel[1], width=width)
    outside = ~inside
    for _ in range(ROUNDS):
        where = np.broadcast_to(outside, heights.shape)
        levelled = without_polynomial(heights, degree=degree, where=where)
        profile = _profile(levelled)
        span = _span(profile, outside, pixel=pixel[1], width=width)
        if np.array_equal(span, inside):
            break
        inside, outside = span, ~span
        _check(inside, width=width)
    levelled = np.where(missing, profile, levelled)
    levelled.flags.writeable = False
    across = levelled[:, inside]
    columns = np.flatnonzero(inside)
    track = WornTrack(
        levelled=levelled,
        degree=degree,
        missing=missing,
        y=y,
        inside=inside,
        window=(float(y[columns[0]]) - 0.5 * pixel[1], float(y[columns[-1]]) + 0.5 * pixel[1]),
        below=np.maximum(-across, 0.0).sum(axis=1) * pixel[1],
        above=np.maximum(across, 0.0).sum(axis=1) * pixel[1],
        length=heights.shape[0] * pixel[0],
    )
    net = float(track.net.mean())
    if width is None and net <= LEAST_ERRORS * track.net_error:
        raise refused("no_track", net=1e6 * net, error=1e6 * track.net_error)
    return track


def find_groove(profile: Profile, *, degree: int = 1, width: float | None = None) -> WornTrack:
    """Find the groove in a profile across it, as `find_track` does: a track of one section."""
    pixel = (profile.spacing, profile.spacing)
    return find_track(profile.heights[None], pixel=pixel, degree=degree, width=width)


def _needle(heights: FloatArray) -> tuple[float, float] | None:
    """Return the height [mm] below which a tenth of a trough, (n,), lies, and its part, None where little."""
    deep, tenth = np.sort(heights), heights.size // 10
    part = float(deep[:tenth].sum() / deep.sum()) if tenth else 0.0
    return (float(deep[tenth]), part) if part > NEEDLE else None


def _profile(heights: FloatArray) -> FloatArray:
    """Return the mean profile across of heights, shape (nx, ny), NaN where missing: shape (ny,).

    Where a place across has no height at all, it lies on the line between its neighbours.
    """
    valid = ~np.isnan(heights)
    count, total = valid.sum(axis=0), np.where(valid, heights, 0.0).sum(axis=0)
    places = np.flatnonzero(count)
    return np.interp(np.arange(count.size), places, total[places] / count[places])


def _standard_error(values: FloatArray) -> float:
    """Return the standard error of a mean, from means over blocks; 0 of a single value, which tells none.

    Neighbouring blocks that go together count as fewer.
    """
    if values.size == 1:
        return 0.0
    blocks = np.array([block.mean() for block in np.array_split(values, min(BLOCKS, values.size))])
    rest = blocks - blocks.mean()
    variance = float(rest @ rest) / (blocks.size - 1)
    shared = float(rest[1:] @ rest[:-1]) / (blocks.size - 1)
    return math.sqrt((variance + 2.0 * max(shared, 0.0)) / blocks.size)


def _first_guess(profile: FloatArray) -> BoolArray:
    """Return where a mean profile [mm] has the deeper half of its trough, and as much again on each side.

    Shapes are (ny,). Before the first levelling a track tilts and lifts its own reference, so no scatter can
    be told yet.
    """
    count = profile.size
    centre, deepest = float(np.median(profile)), int(np.argmin(profile))
    labels = ndimage.label(profile < 0.5 * (centre + float(profile[deepest])))[0]
    columns = np.flatnonzero(labels == labels[deepest]) if labels[deepest] else np.array([deepest])
    least = max(1, math.ceil(2.0 * LEAST_OUTSIDE * count))
    first = max(int(columns[0]) - columns.size, least)
    last = min(int(columns[-1]) + columns.size, count - 1 - least)
    place = np.arange(count)
    return (place >= first) & (place <= last)


def _span(profile: FloatArray, outside: BoolArray, *, pixel: float, width: float | None) -> BoolArray:
    """Return which points across belong to the track of a mean profile [mm], shape (ny,).

    outside: points taken as unworn so far, shape (ny,); pixel: their distance [mm]; width: the track's [mm],
    None to find it.
    """
    count = profile.size
    if width is not None:
        points = round(width / pixel)
        if not 2 <= points < count:
            raise InputError(f"--track-width is {width:g} mm: allowed is less than {count * pixel:.4g} mm")
        below = np.convolve(np.maximum(-profile, 0.0), np.ones(points), mode="same")
        near = np.abs(np.arange(count) - int(np.argmax(below))) <= points // 2
        # about the middle of the deeper half: a window wider than the track would hold it in many places
        deep = np.flatnonzero(near & (profile < 0.5 * profile[near].min()))
        start = min(max(round(float(deep[0] + deep[-1] + 1 - points) / 2.0), 0), count - points)
        return (np.arange(count) >= start) & (np.arange(count) < start + points)
    window = max(3, count // 100) | 1
    smooth = ndimage.uniform_filter1d(profile, window, mode="nearest")
    rest = smooth[outside]
    centre = float(np.median(rest))
    sigma = max(robust_deviation(rest, centre), 1e-6 * float(np.ptp(profile)))
    deepest = int(np.argmin(smooth))
    if centre - smooth[deepest] < THRESHOLD * sigma:
        raise InputError("no track stands out of the surface: --track-width may say how wide it is")
    beyond = np.abs(smooth - centre) > FOOT * sigma
    # a track's profile crosses the reference between its trough and its pile-up
    gap = max(3, count // 25)
    closed = ndimage.binary_closing(np.pad(beyond, gap), np.ones(gap))[gap:-gap]
    labels = ndimage.label(closed | beyond)[0]
    columns = np.flatnonzero(labels == labels[deepest])
    margin = math.ceil(MARGIN * columns.size)
    if (needle := _needle(np.minimum(profile[columns] - centre, 0.0))) is not None:
        smooth = np.maximum(smooth, centre + needle[0])
    # the valleys of a wavy surface would lead on from the trough; pile-up does not reach as far as it is wide
    deep = ndimage.label(ndimage.binary_closing(smooth < 0.5 * (centre + smooth[deepest]), np.ones(gap)))[0]
    trough = np.flatnonzero(deep == deep[deepest])
    middle, reach = 0.5 * float(trough[0] + trough[-1]), math.sqrt(2.0) * REACH * trough.size
    first, last = (max(columns[0] - margin, middle - reach), min(columns[-1] + margin, middle + reach))
    place = np.arange(count)
    return (place >= first) & (place <= last)


def _check(inside: BoolArray, *, width: float | None) -> None:
    """Raise InputError where too little surface is left on a side of the track to level by."""
    columns = np.flatnonzero(inside)
    least = LEAST_OUTSIDE * inside.size
    if columns[0] < least or inside.size - 1 - columns[-1] < least:
        advice = "a wider measurement is needed"
        if width is None:
            advice = f"--track-width may say how wide it is, or {advice}"
        raise InputError(f"the track leaves too little surface beside it to level by: {advice}")
