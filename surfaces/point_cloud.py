"""Lists of points x y z: the grid on which they lie, and the units that their header states."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.surfaces.base import FloatArray

spatial = lazy.module("scipy.spatial")

SLACK = 0.2  # pixels that a point may lie off its grid: the rounding of printed coordinates
LEAST_FILLED = 0.25  # of the grid; scattered points and turned grids fill next to nothing
UNIT = (
    r"(?:mm|cm|km|nm|pm|[uµμ]m|m|Å|micrometers?|micrometres?|microns?|millimeters?|millimetres?"
    r"|meters?|metres?)"
)
WORDS = {"micro": "µm", "milli": "mm", "meter": "m", "metre": "m"}


@dataclass(frozen=True, eq=False)
class Cloud:
    """A gridded cloud: heights in the file's unit, shape (nx, ny), NaN where no point is; x increases with
    axis 0 and y with axis 1. pixel: distance of the points along both, in the file's lateral unit."""

    heights: FloatArray
    pixel: tuple[float, float]
    notes: tuple[str, ...]


def gridded(points: FloatArray) -> Cloud:
    """The height map of points, shape (n, 3 or more): x, y, z in the first columns.

    A full grid or one with holes, in any order. The same point twice counts once. ValueError, with the end of
    a sentence, for one point with two heights, and for points of no axis-parallel, evenly spaced grid.
    """
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    placed = np.isfinite(x) & np.isfinite(y)
    if not placed.all():
        x, y, z = x[placed], y[placed], z[placed]
    if x.size < 4:
        raise ValueError("fewer than four points")
    column, nx, px = _axis(x, "x")
    row, ny, py = _axis(y, "y")
    if nx < 2 or ny < 2:
        raise ValueError("holds a line scan")
    if x.size < LEAST_FILLED * nx * ny:
        raise ValueError(_scattered(x, y))
    cell = column * ny + row
    heights = np.full(nx * ny, np.nan)
    heights[cell] = z
    notes = []
    count = np.bincount(cell, minlength=1)
    if count.max() > 1:
        same = (heights[cell] == z) | ~np.isfinite(z) & ~np.isfinite(heights[cell])
        if not same.all():
            bad = int(np.flatnonzero(~same)[0])
            raise ValueError(
                f"{int((~same).sum())} points that are given twice with different heights, the first at "
                f"x = {x[bad]:g}, y = {y[bad]:g}"
            )
        notes.append(f"{int(x.size - np.count_nonzero(count))} repeated points dropped")
    return Cloud(heights=heights.reshape(nx, ny), pixel=(px, py), notes=tuple(notes))


def units_in(header: Sequence[str]) -> tuple[str | None, str | None]:
    """Lateral unit and height unit that a header states, each None unless unambiguous."""
    found: dict[str, set[str]] = {"x": set(), "y": set(), "z": set(), "": set()}
    words_between = r"(?:axis|position|pos|coordinate|height|unit|units)?"
    named = rf"\b([xyz])(?:\b|(?=[-_ ]))[ _-]*{words_between}[ ]*[:=]?[ ]*[\[(/]?[ ]*(?:in[ ]+)?({UNIT})\b"
    general = rf"\b(?:units?|einheit)\b[ ]*[:=]?[ ]*[\[(]?[ ]*({UNIT})\b"
    for line in header:
        names = re.findall(named, line, re.I)
        for axis, unit in names:
            found[axis.lower()].add(_canonical(unit))
        if names:
            continue
        height = re.search(rf"\b(?:z|height)[ _-]*units?\b[ ]*[:=]?[ ]*({UNIT})\b", line, re.I)
        if height:
            found["z"].add(_canonical(height[1]))
        elif match := re.search(general, line, re.I):
            found[""].add(_canonical(match[1]))
        else:
            # a line of units alone, under the names of the columns
            words = re.findall(rf"(?<![\w])({UNIT})(?![\w])", line)
            rest = re.sub(rf"{UNIT}|[\[\]()#%;,\s]", "", line)
            if len(words) == 3 and not rest:
                for axis, unit in zip("xyz", words, strict=True):
                    found[axis].add(_canonical(unit))
    lateral = found["x"] | found["y"] or found[""]
    height_units = found["z"] or found[""]
    return (
        next(iter(lateral)) if len(lateral) == 1 else None,
        next(iter(height_units)) if len(height_units) == 1 else None,
    )


def _canonical(unit: str) -> str:
    lower = unit.lower()
    for start, meant in WORDS.items():
        if lower.startswith(start):
            return meant
    return unit.replace("μ", "µ").replace("um", "µm").replace("UM", "µm")


def _axis(places: FloatArray, name: str) -> tuple[np.ndarray, int, float]:
    """Index of each place on its axis, their number, and the spacing."""
    sorted_places, inverse = np.unique(places, return_inverse=True)
    span = float(sorted_places[-1] - sorted_places[0])
    if span == 0.0:
        return np.zeros(places.size, dtype=np.int64), 1, 0.0
    gaps = np.diff(sorted_places)
    real = gaps > 1e-7 * span  # smaller ones are rounding of the same place
    spacing = float(np.median(gaps[real]))
    steps = np.where(real, np.rint(gaps / spacing), 0.0)
    index = np.concatenate([[0.0], np.cumsum(steps)])
    if index[-1] < 1.0 or index[-1] >= 1.0 / LEAST_FILLED * max(places.size, 4):
        raise ValueError(f"points along {name} that are not evenly spaced, or a turned grid")
    slope, offset = np.polyfit(index, sorted_places, 1)
    off = np.abs(sorted_places - (slope * index + offset)) / slope
    if off.max() > SLACK or np.any(real & (steps == 0.0)):
        if sorted_places.size > 0.2 * places.size:
            raise ValueError("points of a turned grid, or scattered ones")
        raise ValueError(f"points along {name} that are not evenly spaced")
    return index.astype(np.int64)[inverse.reshape(-1)], int(index[-1]) + 1, float(slope)


def _scattered(x: FloatArray, y: FloatArray) -> str:
    """What kind of no grid: the angle of a turned one from neighbours of some points."""

    points = np.column_stack([x, y])
    near = spatial.cKDTree(points).query(points[:: max(1, len(points) // 500)], k=2)[1]
    step = points[near[:, 1]] - points[near[:, 0]]
    angle = np.angle(np.exp(4j * np.arctan2(step[:, 1], step[:, 0])).sum()) / 4.0
    agree = float(np.abs(np.exp(4j * np.arctan2(step[:, 1], step[:, 0])).mean()))
    if agree > 0.95 and abs(np.degrees(angle)) > 0.05:
        return f"points of a grid turned by {np.degrees(angle):.3g}° from the axes"
    return "scattered points, of no regular grid"
