"""Prepare a measurement by operations in a fixed order, each one recorded."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray, refused
from warpwear.surfaces.filling import completed
from warpwear.surfaces.levelling import areal_low_pass, tilt, without_polynomial
from warpwear.surfaces.outliers import outliers
from warpwear.surfaces.reading import Reading
from warpwear.surfaces.roughness import FLAT
from warpwear.surfaces.sphere import Cylinder, NoSphere, Sphere, fit_cylinder, fit_sphere, places

HIGHEST_DEGREE = 12  # of a polynomial taken off
LARGEST_SQ = 1.0  # mm: above it a unit is wrong
#: Median slope above which a unit is wrong, as no instrument sees a surface of 79° over half its area.
STEEPEST = 5.0
LARGEST_MISSING = 0.5  # share of the points: beyond it the surface would be invented, not measured


@dataclass(frozen=True, kw_only=True)
class Preparation:
    """A measurement is prepared by these operations, in this order; by default only the plane is taken off.

    height_sign: "up" as in the file, "down" turns heights over (files that give depths).
    crop: (x0, x1, y0, y1) [mm] in the file's frame, whose zero is the outer corner of its first pixel; or
        (size_x, size_y) [mm] around the middle.
    sliding_axis: which of the file's axes, "x" or "y", lies along the sliding direction; "y" transposes.
    outliers: how many robust standard deviations from the local median make a point count as missing, at
        least 3; None keeps all (see `outliers.outliers`).
    level: form removed by least squares: "none" (the mean only), "plane", a degree from 0 to 12, "sphere",
        "cylinder" (its axis along one of the field's).
    s_filter, l_filter: cut-offs [mm] of the areal Gaussian filters of ISO 16610-61 that take off what is
        shorter (S) and longer (L), 50 % transmission at the cut-off, mirrored at the edges. Missing points
        have no weight in them, and are filled last (see `filling.completed`).

    Raises InputError, naming the field of ``disc``, for what is not allowed.
    """

    height_sign: str = "up"
    crop: Sequence[float] | None = None
    sliding_axis: str = "x"
    outliers: float | None = None
    level: str | int = "plane"
    s_filter: float | None = None
    l_filter: float | None = None


class Prepared(NamedTuple):
    """A prepared measurement is complete, over its mean, and says what was done to it."""

    heights: FloatArray  # [mm], shape (nx, ny), axis 0 along sliding
    filled: BoolArray | None  # points that were missing or removed, shape (nx, ny); None without any
    pixel: tuple[float, float]  # along both axes [mm]
    record: dict[str, Any]  # how many points were missing or removed; in sentences what was done, in order


def prepare(reading: Reading, preparation: Preparation, *, name: str) -> Prepared:
    """Prepare what was read from the file `name`.

    Raises InputError, naming the field of ``disc``, for operations that the measurement does not allow and
    for heights that no measurement has.
    """
    heights, pixel = reading.heights, reading.pixel
    done = list(reading.notes)
    if preparation.height_sign == "down":
        heights = -heights
        done.append("heights turned over: the file gives depths")
    if preparation.crop is not None:
        heights, sentence = cropped(heights, pixel, preparation.crop)
        done.append(sentence)
    if preparation.sliding_axis == "y":
        heights, pixel = np.ascontiguousarray(heights.T), (pixel[1], pixel[0])
        done.append("transposed: the file's y is along the sliding direction")
    missing = int(np.isnan(heights).sum())
    if missing == heights.size:
        raise InputError(f"disc.crop leaves no valid point of disc.surface '{name}'")
    removed = 0
    if preparation.outliers is not None:
        spikes = outliers(heights, deviations=preparation.outliers)
        heights = np.where(spikes.where, np.nan, heights)
        removed = spikes.points
        done.append(
            f"outliers: {removed} points in {spikes.groups} groups farther than {preparation.outliers:g} "
            f"robust standard deviations ({1e3 * spikes.limit:.4g} µm) from the median of 5 × 5 points "
            "removed" + (f", the farthest {1e3 * spikes.farthest:.4g} µm" if removed else "")
        )
    share = (missing + removed) / heights.size
    if share > LARGEST_MISSING:
        by = f", {removed} of them removed by disc.outliers" if removed else ""
        raise refused("missing", name=name, percent=100 * share, by_outliers=by, most=100 * LARGEST_MISSING)
    heights, sentence, tilted = _levelled(heights, pixel, preparation.level)
    done.append(sentence)
    sq = float(np.sqrt(np.nanmean(np.square(heights))))
    _check_plausible(heights, pixel, sq, name=name, unit=reading.unit)
    heights, sentences = _filtered(heights, pixel, preparation)
    done += sentences
    absent = np.isnan(heights)
    if float(np.nanstd(heights)) < FLAT:
        heights = np.where(absent, np.nan, 0.0)
        done.append("flat: what is left is rounding, less than 1 pm, and was set to 0")
    if missing + removed:
        heights = completed(heights, pixel=pixel)
        done.append(
            f"{missing + removed} missing points ({100 * share:.3g} %) filled: holes from their rim, what "
            "lies beyond the measured region with its mean plane"
        )
    record = {
        "missing": missing,
        "missing_percent": 100.0 * missing / heights.size,
        "outliers_removed": removed,
        "filled_percent": 100.0 * (missing + removed) / heights.size,
        "operations": done,
        "tilt_degrees": tilted,
    }
    return Prepared(heights, absent if missing + removed else None, pixel, record)


def degree_of(level: str | int) -> int | Literal["sphere", "cylinder"]:
    """Return the degree of the polynomial that a level takes off, or "sphere" or "cylinder".

    level: as in `Preparation`. Raises InputError, naming ``disc.level``, for anything else.
    """
    if level == "sphere" or level == "cylinder":
        return "sphere" if level == "sphere" else "cylinder"
    degree = {"none": 0, "plane": 1}.get(level) if isinstance(level, str) else level
    if degree is None or isinstance(level, bool) or not 0 <= degree <= HIGHEST_DEGREE:
        raise refused("level", level=level, most=HIGHEST_DEGREE)
    return degree


def cropped(heights: FloatArray, pixel: tuple[float, ...], crop: Sequence[float]) -> tuple[FloatArray, str]:
    """Return the part of a map, or of a profile (n,), that a crop [mm] leaves, and what was done.

    crop: from and to along each axis; or sizes about the middle, of a profile its size twice. Raises
    InputError, naming ``disc.crop``.
    """
    extent = [n * p for n, p in zip(heights.shape, pixel, strict=False)]
    bounds, is_map = list(crop), heights.ndim > 1
    if len(crop) == 2 and (is_map or crop[0] == crop[1]):
        pairs = zip(crop, extent, strict=False)
        bounds = [edge for size, whole in pairs for edge in ((whole - size) / 2, (whole + size) / 2)]
    slices = []
    for low, high, size, step in zip(bounds[::2], bounds[1::2], extent, pixel, strict=False):
        slack = 1e-6 * step
        first, last = math.ceil((low - slack) / step), math.floor((high + slack) / step)
        if len(bounds) == 2 * heights.ndim and -slack <= low < high <= size + slack and last - first > 1:
            slices.append(slice(max(first, 0), last))
    if len(slices) < heights.ndim:
        allowed, whole = (
            "x0, x1, y0, y1" if is_map else "x0, x1",
            " × ".join(f"{size:.6g}" for size in extent),
        )
        raise refused("crop", given=", ".join(f"{v:.6g}" for v in crop), allowed=allowed, whole=whole)
    part = np.ascontiguousarray(heights[tuple(slices)])
    ends = zip("xy", bounds[::2], bounds[1::2], strict=False)
    sides = " and ".join(f"{axis} {low:.6g} to {high:.6g} mm" for axis, low, high in ends)
    return part, f"cropped to {sides} of the file, {' × '.join(map(str, part.shape))} points"


def _levelled(
    heights: FloatArray, pixel: tuple[float, float], level: str | int
) -> tuple[FloatArray, str, float]:
    """Return the heights less the form of a level, what was done, and the tilt [°] that it took off."""
    degree = degree_of(level)
    if isinstance(degree, str):
        fit = fit_sphere if degree == "sphere" else fit_cylinder
        try:
            fitted: Sphere | Cylinder = fit(heights, pixel=pixel)
        except NoSphere as error:
            raise refused("no_form", degree=degree, error=error) from error
        rest = heights - fitted.heights(*places(heights.shape, pixel))
        rest -= np.nanmean(rest)
        way = "bulging" if fitted.radius > 0 else "hollow"
        along = f" along {'xy'[fitted.axis]}" if isinstance(fitted, Cylinder) else ""
        form = f"least-squares {degree}{along} of radius {abs(fitted.radius):.5g} mm ({way})"
        return rest, f"{form} taken off", 0.0
    form = {"none": "mean height", "plane": "least-squares plane"}.get(
        str(level), f"least-squares polynomial of degree {level}"
    )
    rest = without_polynomial(heights, degree=degree)
    tilted = tilt(heights - rest, pixel=pixel)
    return rest, f"{form} taken off" + f", tilted by {tilted:.3g}°" * (degree > 0), tilted


def _filtered(
    heights: FloatArray, pixel: tuple[float, float], preparation: Preparation
) -> tuple[FloatArray, list[str]]:
    """Return the heights after the S- and the L-filter, and what was done."""
    shortest = 2.0 * max(pixel)
    longest = min(n * p for n, p in zip(heights.shape, pixel, strict=True))
    short, long = preparation.s_filter, preparation.l_filter
    for key, cut_off in (("s_filter", short), ("l_filter", long)):
        if cut_off is not None and not shortest * (1 - 1e-9) <= cut_off <= longest:
            raise refused(
                "cut_off", key=key, cut_off=1e3 * cut_off, shortest=1e3 * shortest, longest=1e3 * longest
            )
    if short is not None and long is not None and short >= long:
        raise refused("both_filters", short=1e3 * short, long=1e3 * long)
    sentence = (
        "{}-filter: Gaussian (ISO 16610-61), waves {} than {:.4g} µm taken off, half transmitted there, "
        "mirrored at the edges"
    )
    done = []
    if short is not None:
        heights = areal_low_pass(heights, pixel=pixel, cut_off=short)
        done.append(sentence.format("S", "shorter", 1e3 * short))
    if long is not None:
        heights = heights - areal_low_pass(heights, pixel=pixel, cut_off=long)
        heights -= np.nanmean(heights)
        done.append(sentence.format("L", "longer", 1e3 * long))
    return heights, done


def _check_plausible(
    heights: FloatArray, pixel: tuple[float, float], sq: float, *, name: str, unit: str
) -> None:
    """Raise InputError for heights, NaN where missing, that no measured surface has: a unit is wrong."""
    smaller = {"km": "m", "m": "mm", "cm": "mm", "mm": "um", "µm": "nm", "um": "nm"}.get(unit)
    advice = "or give disc.height_unit" + (f', such as "{smaller}" instead of {unit}' if smaller else "")
    if not sq <= LARGEST_SQ:
        raise refused("high", name=name, sq=sq, most=LARGEST_SQ, advice=advice)
    valid = [s[~np.isnan(s)] for s in [np.diff(heights, axis=axis) / pixel[axis] for axis in (0, 1)]]
    # less the median step: a tilt that is left on is no slope of the surface
    slope = max((float(np.median(np.abs(v - np.median(v)))) for v in valid if v.size), default=0.0)
    if slope > STEEPEST:
        raise refused("steep", name=name, slope=slope, most=STEEPEST, advice=advice)
