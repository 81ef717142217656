"""Lists of points x y z: the grid on which they lie, and the units that their header states."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray

SLACK = 0.2  # pixels that a point may lie off its grid, where its printed digits do not allow more
MOST_DIGITS = 12  # of printed places
ROUNDED = 0.6  # of the last digit: half by rounding, the rest by the line fitted to the places
LEAST_FILLED = 0.25  # of the grid; scattered points and turned grids fill next to nothing
UNIT = (
    r"(?:mm|cm|km|nm|pm|[uµμ]m|m|Å|micrometers?|micrometres?|microns?|millimeters?|millimetres?"
    r"|meters?|metres?)"
)
WORDS = {"micro": "µm", "milli": "mm", "meter": "m", "metre": "m"}
#: A unit behind the name of its axis, such as "X [µm]", "z in nm" or "x-unit: um".
AXIS_UNIT = re.compile(
    r"\b([xyz])(?:\b|(?=[-_ ]))[ _-]*(?:axis|position|pos|coordinate|height|unit|units)?"
    rf"[ ]*[:=]?[ ]*[\[(/]?[ ]*(?:in[ ]+)?({UNIT})\b",
    re.I,
)
#: A unit as the last word of a column's name.
LAST_WORD = re.compile(rf"\D+ ({UNIT})", re.I)
HEIGHT_UNIT = re.compile(rf"\b(?:z|height)[ _-]*units?\b[ ]*[:=]?[ ]*({UNIT})\b", re.I)
ANY_UNIT = re.compile(rf"\b(?:units?|einheit)\b[ ]*[:=]?[ ]*[\[(]?[ ]*({UNIT})\b", re.I)


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points on a grid are a height map, in the units of their file."""

    heights: FloatArray  # shape (nx, ny), x increasing with axis 0 and y with axis 1, NaN where no point is
    pixel: tuple[float, float]  # distance of the points along x and y
    notes: tuple[str, ...]  # what was decided, in sentences


def gridded(points: FloatArray) -> Cloud:
    """Return the height map of points, shape (n, 3 or more), with x, y, z in the first columns.

    They fill a grid, or one with holes, in any order. A point that comes twice counts once. Raises
    ValueError, with the end of a sentence, for one point with two heights, and for points of no evenly spaced
    grid along the axes.
    """
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    placed = np.isfinite(x) & np.isfinite(y)
    x, y, z = x[placed], y[placed], z[placed]
    if x.size < 4:
        raise ValueError("fewer than four points")
    try:
        (column, nx, px), (row, ny, py) = _axis(x, "x"), _axis(y, "y")
    except ValueError as error:
        raise ValueError(f"{error}, or a turned grid") from error
    if nx < 2 or ny < 2:
        raise ValueError("holds a line scan")
    if x.size < LEAST_FILLED * nx * ny:
        raise ValueError("scattered points, or a turned grid")
    cell = column * ny + row
    heights = np.full(nx * ny, np.nan)
    heights[cell] = z
    notes = []
    repeated = x.size - np.count_nonzero(np.bincount(cell))
    if repeated:
        same = (heights[cell] == z) | ~np.isfinite(z) & ~np.isfinite(heights[cell])
        if not same.all():
            bad = int(np.flatnonzero(~same)[0])
            raise ValueError(
                f"{int((~same).sum())} points that are given twice with different heights, the first at "
                f"x = {x[bad]:g}, y = {y[bad]:g}"
            )
        notes.append(f"{repeated} repeated points dropped")
    return Cloud(heights=heights.reshape(nx, ny), pixel=(px, py), notes=tuple(notes))


def spaced(points: FloatArray) -> tuple[FloatArray, float]:
    """Return heights, shape (n,), and spacing of points x z, shape (m, 2), NaN where one is left out.

    Raises ValueError, with the end of a sentence, for points that are not evenly spaced along x.
    """
    points = points[np.isfinite(points[:, 0])]
    if len(points) < 4:
        raise ValueError("fewer than four points")
    column, count, step = _axis(points[:, 0], "x")
    if count < 4 or np.bincount(column).max() > 1:
        raise ValueError("several points at one x")
    heights = np.full(count, np.nan)
    heights[column] = points[:, 1]
    return heights, step


def units_in(header: Sequence[str]) -> tuple[str | None, str | None]:
    """Return the lateral unit and the unit of heights that a header states, None where not unambiguous."""
    units: dict[str, set[str]] = {"x": set(), "y": set(), "z": set(), "": set()}
    for line in header:
        for axis, unit in _units_of_axes(line):
            units[axis.lower()].add(_canonical(unit))
    along, across = units["x"] | units["y"] or units[""], units["z"] or units[""]
    lateral, height = (next(iter(one)) if len(one) == 1 else None for one in (along, across))
    return lateral, height


def unit_of(name: str) -> str | None:
    """Return the unit in brackets behind the name of a column, None without one."""
    found = re.search(rf"[\[(] *({UNIT}) *[\])]", name)
    return _canonical(found[1]) if found else None


def _units_of_axes(line: str) -> list[tuple[str, str]]:
    """Return the axes and units that a line of a header states; "" is the axis of a unit for all."""
    if named := AXIS_UNIT.findall(line):
        return named
    if match := HEIGHT_UNIT.search(line):
        return [("z", match[1])]
    if match := ANY_UNIT.search(line):
        return [("", match[1])]
    words = re.findall(rf"[\[(] *({UNIT}) *[\])]", line)
    if len(words) != 2:
        words = [last[1] for field in re.split("[,;\t]", line) if (last := LAST_WORD.fullmatch(field))]
    if len(words) == 2:  # two columns of other names
        return list(zip("xz", words, strict=True))
    # perhaps a line of units alone, under the names of the columns
    words = re.findall(rf"(?<![\w])({UNIT})(?![\w])", line)
    rest = re.sub(rf"{UNIT}|[\[\]()#%;,\s]", "", line)
    axes = {2: "xz", 3: "xyz"}.get(len(words), "")
    return list(zip(axes, words, strict=True)) if axes and not rest else []


def _canonical(unit: str) -> str:
    meant = (word for start, word in WORDS.items() if unit.lower().startswith(start))
    return next(meant, unit.replace("μ", "µ").replace("um", "µm").replace("UM", "µm"))


def _axis(places: FloatArray, name: str) -> tuple[np.ndarray, int, float]:
    """Return the index of each place along an axis, shape (n,), the number of places, and their spacing.

    name: of the axis, for the ValueError that places of no evenly spaced grid raise.
    """
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
        raise ValueError(f"points along {name} that are not evenly spaced")
    middle, far = index.mean(), index - index.mean()
    slope = (far * sorted_places).sum() / np.square(far).sum()
    offset = sorted_places.mean() - slope * middle
    off = np.abs(sorted_places - (slope * index + offset)) / slope
    if off.max() > SLACK or np.any(real & (steps == 0.0)):
        index = np.arange(sorted_places.size)
        slope, offset = np.polyfit(index, sorted_places, 1)
        if np.abs(sorted_places - slope * index - offset).max() > ROUNDED * _last_digit(sorted_places):
            raise ValueError(f"points along {name} that are not evenly spaced")
    return index.astype(np.int64)[inverse.reshape(-1)], int(index[-1]) + 1, float(slope)


def _last_digit(places: FloatArray) -> float:
    """Return the value of the last digit that places were printed with, 0 for more than twelve digits."""
    first = math.ceil(math.log10(float(np.abs(places).max())))
    for digit in (10.0**power for power in range(first, first - MOST_DIGITS, -1)):
        if np.allclose(places / digit, np.rint(places / digit), rtol=1e-12, atol=1e-6):
            return digit
    return 0.0
