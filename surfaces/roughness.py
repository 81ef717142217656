"""Compute height parameters, slopes, the bearing area curve, and Ra of filtered profiles.

All are of measured points alone: heights may be NaN where a point is missing.
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.levelling import low_pass, over_measured

SECANT = 0.4  # of the material ratio, ISO 13565-2
STARTS = 2001  # of secants tried; the flattest is broad
#: λc [mm] of ISO 3274, largest first, and the λs [mm] that belongs to each.
CUT_OFFS = {8.0: 0.025, 2.5: 0.008, 0.8: 0.0025, 0.25: 0.0025, 0.08: 0.0025}
SAMPLING_LENGTHS = 5  # usual; fewer are told, and without a single one λc is reduced
FEWEST_WAVES = 5  # of λs in a profile: of a field of few waves there is no Ra to speak of
NO_RA = "no Ra"  # begins the sentence that says why
LEAST_OF_A_PROFILE = 0.5  # of its points that must be measured
FLAT = 1e-9  # mm: 1 pm, a hundredth of an atom; what is lower is rounding


def roughness(heights: FloatArray, *, pixel: tuple[float, float]) -> dict[str, float]:
    """Return the height parameters of ISO 25178-2 about the mean height, and the rms slope.

    heights [mm], shape (nx, ny), NaN where missing, already levelled; pixel (px, py) [mm]. Keys: those of
    `height_parameters` and ``rms_slope`` [-].
    """
    return height_parameters(heights) | {"rms_slope": rms_slope(heights, pixel=pixel)}


def height_parameters(heights: FloatArray) -> dict[str, float]:
    """Return the height parameters of ISO 25178-2 about the mean height.

    heights [mm], any shape, NaN where missing, levelled. Keys: ``sa``, ``sq``, ``sz`` (highest minus lowest)
    [mm]; ``ssk``, ``sku`` (skewness and kurtosis, 0 and 3 for Gaussian heights; both 0 for a flat).
    """
    heights = _there(heights)
    centred = heights - heights.mean()
    sq = math.sqrt(float(np.square(centred).mean()))
    scaled = centred / (sq or 1.0)  # whose powers neither overflow nor vanish
    return {
        "sa": float(np.abs(centred).mean()),
        "sq": sq,
        "sz": float(centred.max() - centred.min()),
        "ssk": float((scaled**3).mean()),
        "sku": float((scaled**4).mean()),
    }


def developed_area(heights: FloatArray, *, pixel: tuple[float, float]) -> float:
    """Return by which part the surface's area exceeds its projection: Sdr of ISO 25178-2 [-].

    heights [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm]. Differences as in `rms_slope`.
    """
    along, across = (np.diff(heights, axis=axis) / pixel[axis] for axis in (0, 1))
    squares = np.square(along[:, :-1]) + np.square(across[:-1, :])
    known = squares[np.isfinite(squares)]
    # √(1 + s) − 1 without the loss of digits of small slopes
    return float((known / (np.sqrt(1.0 + known) + 1.0)).mean()) if known.size else 0.0


def rms_slope(heights: FloatArray, *, pixel: tuple[float, float]) -> float:
    """Return the root mean square gradient [-] by forward differences: Sdq of ISO 25178-2.

    heights [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm]. A difference over a pixel is blind
    to waves near two pixels, so the value grows with finer pixels until the shortest waves of the surface are
    resolved.
    """
    along, across = (_mean_square_slope(heights, pixel=pixel, axis=axis) for axis in (0, 1))
    return math.sqrt(along + across)


def slope_along(heights: FloatArray, *, pixel: tuple[float, float], axis: int) -> float:
    """Return the root mean square slope [-] along one axis by forward differences; see `rms_slope`."""
    return math.sqrt(_mean_square_slope(heights, pixel=pixel, axis=axis))


def _mean_square_slope(heights: FloatArray, *, pixel: tuple[float, float], axis: int) -> float:
    """Return the mean square slope [-] along one axis, 0 where no two neighbours are there."""
    squares = _there(np.square(np.diff(heights, axis=axis)))
    return float(squares.mean()) / pixel[axis] ** 2 if squares.size else 0.0


def _there(values: FloatArray) -> FloatArray:
    """Return the values that are there: as they are, or, where some are NaN, the others, shape (n,)."""
    missing = np.isnan(values)
    return values[~missing] if missing.any() else values


@dataclass(frozen=True)
class Bearing:
    """A bearing area curve has a core between peaks and valleys (ISO 25178-2)."""

    sk: float  # core height [mm]
    spk: float  # reduced peak height [mm]
    svk: float  # reduced valley depth [mm]
    smr1: float  # material ratio at which the core begins [%]
    smr2: float  # material ratio at which it ends [%]
    top: float  # height of the equivalent line at 0 % [mm]
    bottom: float  # height of the equivalent line at 100 % [mm]


def material_ratio_curve(heights: FloatArray, *, points: int = 501) -> tuple[FloatArray, FloatArray]:
    """Return material ratios [%] from 0 to 100 and the height [mm] that such a part of the area reaches.

    heights [mm], any shape, NaN where missing. Both arrays have the shape (points,): highest at 0 %, lowest
    at 100 %.
    """
    falling = np.sort(_there(heights), axis=None)[::-1]
    ratio = np.linspace(0.0, 100.0, points)
    return ratio, np.interp(ratio / 100.0, _ratios(falling.size), falling)


def bearing_parameters(heights: FloatArray) -> Bearing:
    """Return Sk, Spk, Svk, Smr1 and Smr2 of ISO 25178-2 (by the construction of ISO 13565-2).

    heights [mm], any shape, NaN where missing, levelled. The equivalent line is that of least squares through
    the 40 % of the curve whose secant is flattest (the first, should there be several); it cuts the axes 0
    and 100 % Sk apart. Spk and Svk are heights of the triangles over Smr1 and 100 % − Smr2 with the areas of
    the peaks above and valleys below the core. They are meant for S-shaped curves: on a pure sine the
    flattest 40 % is an end.
    """
    falling = np.sort(_there(heights), axis=None)[::-1]
    count = falling.size
    ratio = _ratios(count)
    start = np.linspace(0.0, 1.0 - SECANT, STARTS)
    drop = np.interp(start, ratio, falling) - np.interp(start + SECANT, ratio, falling)
    # equal to rounding counts as equal, or a straight curve would choose by chance
    first = int(np.argmax(drop <= drop.min() + 1e-9 * (falling[0] - falling[-1])))
    low, high = np.searchsorted(ratio, [start[first], start[first] + SECANT])
    core_ratio, core = ratio[low:high], falling[low:high]
    centred = core_ratio - core_ratio.mean()
    slope = float((centred * core).sum() / np.square(centred).sum())
    top = float(core.mean() - slope * core_ratio.mean())
    bottom = top + slope
    peaks = int(np.searchsorted(-falling, -top))  # points above the core
    valleys = count - int(np.searchsorted(-falling, -bottom, side="right"))
    area_peaks = float((falling[:peaks] - top).sum()) / count
    area_valleys = float((bottom - falling[count - valleys :]).sum()) / count
    return Bearing(
        sk=top - bottom,
        spk=2.0 * area_peaks * count / peaks if peaks else 0.0,
        svk=2.0 * area_valleys * count / valleys if valleys else 0.0,
        smr1=100.0 * peaks / count,
        smr2=100.0 * (1.0 - valleys / count),
        top=top,
        bottom=bottom,
    )


def _ratios(count: int) -> FloatArray:
    """Return the material ratio [-] of each of `count` falling heights, shape (count,)."""
    return np.asarray((np.arange(count) + 0.5) / count)


@dataclass(frozen=True)
class ProfileRoughness:
    """Profiles along one axis have a mean Ra, which scatters over them."""

    ra: float | None  # mean over the profiles [mm]; None where there is nothing to speak of
    scatter: float | None  # standard deviation over the profiles [mm]
    profiles: int  # their number
    cut_off: float | None  # λc used [mm], None where not filtered
    short: float | None  # λs used [mm], None where not filtered
    notes: tuple[str, ...]  # why they are not those asked for, in sentences


def profile_roughness(
    heights: FloatArray, *, pixel: tuple[float, float], axis: int, cut_off: float, short: float
) -> ProfileRoughness:
    """Return Ra (ISO 21920-2, formerly ISO 4287) of the profiles along an axis.

    heights [mm], shape (nx, ny), NaN where missing, levelled; cut_off and short: λc and λs [mm] of the
    Gaussian profile filters (ISO 16610-21), in which missing points have no weight. A profile that lacks half
    of its evaluated points is left out. Their mirror at the ends is not evaluated: after filtering, λc/2 is
    discarded at each end (run-in and run-out, ISO 3274), and Ra is that of the largest whole number of
    sampling lengths λc in what is left, taken from the middle. Where not one is left, that is where profiles
    are shorter than 2 λc, the next λc of ISO 3274 that leaves one is used; where none does, there is no λc
    and whole profiles are evaluated. λs stays the one asked for; only where it is not shorter than a reduced
    λc (or the profile) does the λs that belongs to that λc replace it, and it is left out where a wave of it
    has fewer than two pixels. There is no Ra where the filters leave no height of 1 pm. notes tell each of
    these. Raises InputError where short is not below cut_off.
    """
    rough, used, waves, notes = filtered(heights, pixel=pixel, axis=axis, cut_off=cut_off, short=short)
    valid = ~np.isnan(rough)
    enough = valid.mean(axis=1) > LEAST_OF_A_PROFILE
    if any(note.startswith(NO_RA) for note in notes):
        return ProfileRoughness(None, None, len(rough), None, None, tuple(notes))
    if left_out := int(np.count_nonzero(~enough)):
        notes.append(f"{left_out} profiles left out: half of their points or more are missing")
    rough, valid = rough[enough], valid[enough]
    points = valid.sum(axis=1)
    rest = rough - (np.sum(rough, axis=1, where=valid) / points)[:, None]
    values = np.sum(np.abs(rest), axis=1, where=valid) / points
    ra = scatter = None
    if not values.size:
        notes.append(f"{NO_RA}: too much is missing")
    elif values.mean() < FLAT:
        notes.append(f"{NO_RA}: the filters leave no height of 1 pm")
    else:
        ra, scatter = float(values.mean()), float(values.std())
        scatter = scatter if scatter >= FLAT else 0.0
    return ProfileRoughness(ra, scatter, values.size, used, waves, tuple(notes))


def filtered(
    heights: FloatArray, *, pixel: tuple[float, float], axis: int, cut_off: float, short: float
) -> tuple[FloatArray, float | None, float | None, list[str]]:
    """Return the roughness profiles along an axis, one a row, λc and λs [mm] used, and why these.

    Parameters and errors are those of `profile_roughness`. Only what is evaluated is returned.
    """
    if short >= cut_off:
        raise InputError(f"--lambda-s is {1e3 * short:g} µm: allowed is less than λc, {1e3 * cut_off:g} µm")
    count, step = heights.shape[axis], pixel[axis]
    used, waves, notes = _cut_offs(count * step, step, cut_off=cut_off, short=short)

    def smoothed(field: FloatArray, wave: float) -> FloatArray:
        return over_measured(field, partial(low_pass, axis=axis, pixel=step, cut_off=wave))

    rough = heights if waves is None else smoothed(heights, waves)
    if used is not None:
        rough = rough - smoothed(rough, used)
        evaluated = min(max(round(_sampling_lengths(count * step, used) * used / step), 1), count)
        first = (count - evaluated) // 2
        rough = rough.take(range(first, first + evaluated), axis)
    return (rough.T if axis == 0 else rough), used, waves, notes


def _cut_offs(
    length: float, step: float, *, cut_off: float, short: float
) -> tuple[float | None, float | None, list[str]]:
    """Return λc and λs [mm] for profiles of a length and step [mm], None for none, and why not others."""
    notes = []
    fitting = (c for c in (cut_off, *CUT_OFFS) if c <= cut_off and _sampling_lengths(length, c) >= 1)
    used = next(fitting, None)
    if used is None:
        notes.append(f"no λc: profiles of {length:.3g} mm are too short for any of ISO 3274")
    elif used != cut_off:
        notes.append(f"λc reduced from {cut_off:g} to {used:g} mm: profiles are {length:.3g} mm long")
    whole = 0 if used is None else _sampling_lengths(length, used)
    if 0 < whole < SAMPLING_LENGTHS:
        notes.append(f"{whole} sampling length{'s' if whole > 1 else ''} instead of {SAMPLING_LENGTHS}")
    waves, limit = short, length if used is None else used
    if short >= limit:
        waves = min(CUT_OFFS.values()) if used is None else CUT_OFFS[used]
    if FEWEST_WAVES * waves > length:
        few = f"hold fewer than {FEWEST_WAVES} waves of λs, {1e3 * waves:.3g} µm; --lambda-s may be shorter"
        return used, None, [f"{NO_RA}: profiles of {1e3 * length:.3g} µm {few}"]
    if waves < 2.0 * step * (1.0 - 1e-6):
        instead = f" (instead of {1e3 * short:g} µm)" if short >= limit else ""
        notes.append(f"no λs: {1e3 * waves:g} µm{instead} is shorter than two pixels")
        return used, None, notes
    if short >= limit:
        than = "the profiles" if used is None else "λc"
        notes.append(f"λs reduced from {1e3 * short:g} to {1e3 * waves:g} µm: it must be shorter than {than}")
    return used, waves, notes


def _sampling_lengths(length: float, cut_off: float) -> int:
    """Count the sampling lengths in a profile [mm] less λc/2 at each end; 0.001 of one may be missing."""
    return math.floor(length / cut_off - 1.0 + 1e-3)
