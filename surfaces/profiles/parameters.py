"""Compute the profile parameters of ISO 21920-2, by the filters and over the lengths of ISO 21920-3."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces import roughness
from warpwear.surfaces.base import IntArray
from warpwear.surfaces.profiles.profile import Profile
from warpwear.surfaces.roughness import CUT_OFFS, bearing_parameters, height_parameters

#: Largest Ra [mm] of the setting classes of ISO 21920-3, and the λc [mm] that belongs to each.
CLASSES = {0.02e-3: 0.08, 0.1e-3: 0.25, 2e-3: 0.8, 10e-3: 2.5, math.inf: 8.0}
SECTIONS = 5  # of an evaluation length
DISCRIMINATION = 0.1  # of Rz, by which an element of a profile must leave the mean line on both sides


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
    heights = rough[0] - np.nanmean(rough[0])
    if np.nanmax(np.abs(heights)) < roughness.FLAT:
        raise InputError(f"the file '{profile.about['file']}' has no roughness: its profile is flat")
    count = 1 if used is None else max(round(heights.size * profile.spacing / used), 1)
    numbers = _numbers(heights, profile.spacing, count)
    return Parameters(rough=heights, cut_off=used, short=waves, notes=tuple(notes), **numbers)


def _numbers(heights: FloatArray, spacing: float, sections: int) -> dict[str, Any]:
    """Return the numbers of a roughness profile [mm] about its mean, shape (n,), in so many sections."""
    parts = np.array_split(heights, sections)
    peaks, valleys = (float(np.mean([np.nanmax(sign * part) for part in parts])) for sign in (1.0, -1.0))
    areal = height_parameters(heights)
    rz = peaks + valleys
    return {
        "sections": sections,
        "ra": areal["sa"],
        "rq": areal["sq"],
        "rsk": areal["ssk"],
        "rku": areal["sku"],
        "rz": rz,
        "rp": peaks,
        "rv": valleys,
        "rt": areal["sz"],
        "rsm": mean_width(heights, spacing=spacing, least=DISCRIMINATION * rz),
        "bearing": bearing_parameters(heights),
    }


def material_ratio(heights: FloatArray, level: float) -> float:
    """Return Rmr(c) [%]: which part of a profile [mm], shape (n,), lies above a level [mm]."""
    return 100.0 * float(np.mean(heights[~np.isnan(heights)] > level))


def mean_width(heights: FloatArray, *, spacing: float, least: float) -> float | None:
    """Return RSm [mm]: the mean distance at which a profile [mm], shape (n,), rises through its mean of 0.

    Only peaks and valleys count that leave the mean line by `least` [mm]; lower ones belong to their
    neighbours. None where fewer than two such rises are there.
    """
    known = np.flatnonzero(~np.isnan(heights))
    far = known[np.abs(heights[known]) > least]
    side = np.sign(heights[far])
    rises = np.flatnonzero((side[:-1] < 0.0) & (side[1:] > 0.0))
    if rises.size < 2:
        return None
    crossings = [_crossing(heights, known, far[i], far[i + 1]) for i in (rises[0], rises[-1])]
    return float(crossings[1] - crossings[0]) * spacing / (rises.size - 1)


def _crossing(heights: FloatArray, known: IntArray, low: int, high: int) -> float:
    """Return the last place, in points, where a profile rises through zero between two of its points."""
    between = known[(known >= low) & (known <= high)]
    last = np.flatnonzero(heights[between] <= 0.0)[-1]
    left, right = between[last], between[last + 1]
    return float(left + (right - left) * -heights[left] / (heights[right] - heights[left]))
