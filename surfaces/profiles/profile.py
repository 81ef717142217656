"""A profile is a line of heights: of a stylus, of a file, or of a map.

Its parameters are those of ISO 21920-2, by the filters and over the lengths of ISO 21920-3.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces import roughness
from warpwear.surfaces.base import BoolArray, IntArray
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.outliers import WINDOW, outliers, robust_deviation
from warpwear.surfaces.preparation import cropped
from warpwear.surfaces.reading import Reading, read
from warpwear.surfaces.roughness import CUT_OFFS, bearing_parameters, height_parameters

SPIKE = 7.0  # times Rq from the middle, beyond which a point is doubted
FAR_OFF = 3.0  # times its robust deviation that the Rq of a profile without spikes is, at most
FEWEST = 50  # points, below which nothing is said of a profile
MOST_MISSING = 0.2  # of its points
#: Largest Ra [mm] of the setting classes of ISO 21920-3, and the λc [mm] that belongs to each.
CLASSES = {0.02e-3: 0.08, 0.1e-3: 0.25, 2e-3: 0.8, 10e-3: 2.5, math.inf: 8.0}
SECTIONS = 5  # of an evaluation length
DISCRIMINATION = 0.1  # of Rz, by which an element of a profile must leave the mean line on both sides


@dataclass(frozen=True, eq=False)
class Profile:
    """A profile has heights at even distances along a line."""

    spacing: float  # [mm]
    heights: FloatArray  # [mm], positive out of the material, shape (n,), NaN where missing
    about: Mapping[str, Any]  # where it is from, JSON-ready

    @property
    def length(self) -> float:
        """Return the length [mm], a spacing for each point."""
        return self.spacing * self.heights.size

    @property
    def places(self) -> FloatArray:
        """Return the places [mm] of the points from the beginning, shape (n,)."""
        return self.spacing * np.arange(0.5, self.heights.size)

    @property
    def missing(self) -> BoolArray:
        """Return which points are missing, shape (n,)."""
        return np.isnan(self.heights)

    def levelled(self, degree: int) -> "Profile":
        """Return it less the least-squares polynomial of a degree."""
        return replace(self, heights=without_polynomial(self.heights[None], degree=degree)[0])

    def filled(self) -> FloatArray:
        """Return heights [mm] with straight lines where points are missing, shape (n,)."""
        known = np.flatnonzero(~self.missing)
        return np.interp(np.arange(self.heights.size), known, self.heights[known])


def profile_in(
    path: str | Path,
    *,
    spacing: float | None = None,
    height_unit: str | None = None,
    array: str | None = None,
    down: bool = False,
    crop: Sequence[float] | None = None,
    deviations: float | None = None,
) -> Profile:
    """Read the profile in a file of any format that `warpwear.surfaces.reading.read` knows.

    spacing [mm] and height_unit override what the file says; array: which of several in it, by name or
    number; down: whether the file gives depths; crop, deviations: see `prepared`. Raises InputError, naming
    ``disc.surface``, ``disc.pixel`` or ``disc.height_unit``, where there is none, where it has fewer than 50
    points or where a fifth of them is missing.
    """
    content = read(path, pixel=spacing, height_unit=height_unit, array=array, profile=True)
    content = prepared(content, crop=crop, deviations=deviations)
    about = {
        "file": Path(path).name,
        "format": content.format,
        "sha256": content.digest,
        "unit": content.unit,
        "notes": [*content.notes, *content.doubts, *(["heights turned over"] if down else [])],
    }
    return checked(Profile(content.pixel[0], -content.heights if down else content.heights, about))


def prepared(reading: Reading, *, crop: Sequence[float] | None, deviations: float | None) -> Reading:
    """Return a profile that was read, cropped and without outliers, and note both.

    crop: as of `cropped`; deviations: as of `warpwear.surfaces.outliers.outliers`; None for neither. Raises
    InputError, naming ``disc.crop``.
    """
    heights, notes = reading.heights, list(reading.notes)
    if crop is not None:
        heights, sentence = cropped(heights, reading.pixel, crop)
        notes.append(sentence)
    if deviations is not None:
        found = outliers(np.repeat(heights[None], WINDOW, axis=0), deviations=deviations)
        where = found.where[WINDOW // 2]
        heights = np.where(where, np.nan, heights)
        notes.append(
            f"outliers: {int(where.sum())} points farther than {deviations:g} robust standard deviations "
            f"({1e3 * found.limit:.4g} µm) from the median of {WINDOW} points removed"
        )
    return replace(reading, heights=heights, notes=tuple(notes))


def far_off(heights: FloatArray) -> str | None:
    """Say how far a point of a levelled profile [mm], shape (n,), lies where roughness seldom has one."""
    off, rq = (heights - np.nanmedian(heights))[~np.isnan(heights)], float(np.nanstd(heights))
    farthest = float(off[np.argmax(np.abs(off))])
    if abs(farthest) < SPIKE * max(min(rq, FAR_OFF * robust_deviation(off)), roughness.FLAT):
        return None
    which, advice = "highest" if farthest > 0.0 else "lowest", "--outliers 6 takes off what stands out"
    off_by = f"{abs(farthest) / rq:.2g} Rq off the middle, as roughness seldom does"
    return f"the {which} point lies {off_by}: a spike, or a lost point? {advice}"


def checked(profile: Profile) -> Profile:
    """Return a profile that has enough points. Raises InputError."""
    count, share = profile.heights.size, float(profile.missing.mean())
    name = f"disc.surface '{profile.about['file']}'"
    if count < FEWEST:
        raise InputError(f"{name} has a profile of {count} points: at least {FEWEST} are needed")
    if share > MOST_MISSING:
        raise InputError(f"{name} lacks {100.0 * share:.3g} % of its points: allowed is {MOST_MISSING:.0%}")
    return profile


@dataclass(frozen=True, eq=False)
class Parameters:
    """The roughness of a profile is described by numbers, lengths in mm.

    ra, rq, rsk, rku, rt and the curve of the material are those of the whole evaluated length, rz, rp and rv
    means over its sections.
    """

    rough: FloatArray  # the evaluated roughness profile about its mean [mm], shape (n,)
    cut_off: float | None  # λc used [mm], None where whole profiles are evaluated
    short: float | None  # λs used [mm], None where not filtered
    sections: int
    ra: float
    rq: float
    rsk: float
    rku: float
    rz: float
    rp: float
    rv: float
    rt: float
    rsm: float | None  # mean width of the profile elements, None where there is not one
    bearing: roughness.Bearing
    notes: tuple[str, ...]


def parameters(profile: Profile, *, cut_off: float | None = None, short: float | None = None) -> Parameters:
    """Return the parameters of a levelled profile; cut_off, short: λc and λs [mm], None for the rule.

    The rule is that of ISO 21920-3 for a profile of which nothing is known: the smallest λc whose setting
    class holds the Ra that it gives, and the λs of that class. Filters and evaluated length are those of
    `warpwear.surfaces.roughness.profile_roughness`. Raises InputError where λs is not below λc, or the
    filters leave no roughness.
    """
    if cut_off is not None:
        return _with(profile, cut_off, short)
    limits = [one for one in CLASSES.items() if short is None or short < one[1]] or [(math.inf, 8.0)]
    for limit, wave in limits:
        result = _with(profile, wave, short)
        if result.ra <= limit or result.cut_off != wave:  # the profile is too short for that class
            break
    return result


def _with(profile: Profile, cut_off: float, short: float | None) -> Parameters:
    """Return the parameters with λc and, where given, λs [mm]."""
    wave = short
    if wave is None:
        wave = next((s for c, s in sorted(CUT_OFFS.items()) if c >= cut_off), max(CUT_OFFS.values()))
        wave = min(wave, cut_off / 30.0)
    pixel = (profile.spacing, profile.spacing)
    rough, used, waves, notes = roughness.filtered(
        profile.heights[None], pixel=pixel, axis=1, cut_off=cut_off, short=wave
    )
    if notes and notes[-1].startswith(roughness.NO_RA):
        raise InputError(f"the file '{profile.about['file']}' has {notes[-1]}")
    heights = rough[0] - np.nanmean(rough[0])
    if np.nanmax(np.abs(heights)) < roughness.FLAT:
        raise InputError(f"the file '{profile.about['file']}' has no roughness: its profile is flat")
    count = 1 if used is None else max(round(heights.size * profile.spacing / used), 1)
    parts = np.array_split(heights, count)
    peaks, valleys = (float(np.mean([np.nanmax(sign * part) for part in parts])) for sign in (1.0, -1.0))
    areal, rz = height_parameters(heights), peaks + valleys
    return Parameters(
        rough=heights,
        cut_off=used,
        short=waves,
        sections=count,
        ra=areal["sa"],
        rq=areal["sq"],
        rsk=areal["ssk"],
        rku=areal["sku"],
        rz=rz,
        rp=peaks,
        rv=valleys,
        rt=areal["sz"],
        rsm=mean_width(heights, spacing=profile.spacing, least=DISCRIMINATION * rz),
        bearing=bearing_parameters(heights),
        notes=tuple(notes),
    )


def material_ratio(heights: FloatArray, level: float) -> float:
    """Return Rmr(c) [%]: which part of a profile [mm], shape (n,), lies above a level [mm]."""
    return 100.0 * float(np.mean(heights[~np.isnan(heights)] > level))


def mean_width(heights: FloatArray, *, spacing: float, least: float) -> float | None:
    """Return RSm [mm]: the mean distance at which a profile [mm], shape (n,), rises through its mean of 0.

    Only peaks and valleys count that leave the mean line by `least` [mm]; lower ones belong to their
    neighbours. Read from both ends, and the mean of both. None where fewer than two such rises are there.
    """
    widths = [_mean_width(one, least) for one in (heights, heights[::-1])]
    known = [width for width in widths if width is not None]
    return spacing * sum(known) / len(known) if known else None


def _mean_width(heights: FloatArray, least: float) -> float | None:
    """Return the mean distance of rises, in points, of a profile that is read from its first point."""
    known = np.flatnonzero(~np.isnan(heights))
    far = known[np.abs(heights[known]) > least]
    side = np.sign(heights[far])
    rises = np.flatnonzero((side[:-1] < 0.0) & (side[1:] > 0.0))
    if rises.size < 2:
        return None
    crossings = [_crossing(heights, known, far[i], far[i + 1]) for i in (rises[0], rises[-1])]
    return float(crossings[1] - crossings[0]) / (rises.size - 1)


def _crossing(heights: FloatArray, known: IntArray, low: int, high: int) -> float:
    """Return the last place, in points, where a profile rises through zero between two of its points."""
    between = known[(known >= low) & (known <= high)]
    last = np.flatnonzero(heights[between] <= 0.0)[-1]
    left, right = between[last], between[last + 1]
    return float(left + (right - left) * -heights[left] / (heights[right] - heights[left]))
