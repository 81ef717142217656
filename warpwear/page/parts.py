"""Parts of a page as plain arrays: charts, maps, bars, bodies in 3-D, and the sections that they stand in.

Colours are names of `warpwear.figures.style` or #rrggbb, and arrays stay arrays, so that nothing here draws;
the page's script does, of what `warpwear.page.html` writes into the page.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.results.ensemble import band

#: Most points of a line.
POINTS = 1500
#: Values over more than this many times the least are drawn on a logarithmic scale; distances alike.
WIDE, WIDE_DISTANCE = 5.0, 30.0
DISTANCE = "sliding distance, mm"


@dataclass(frozen=True)
class Line:
    """A line of a chart. x, y: (points,), of one length. low, high: ends of a band around it, as y.

    marks: "lines", "lines+markers" or "markers".
    """

    name: str
    colour: str
    x: FloatArray
    y: FloatArray
    dash: str = "solid"
    marks: str = "lines"
    wide: bool = False
    low: FloatArray | None = None
    high: FloatArray | None = None


@dataclass(frozen=True)
class Chart:
    """Lines over one axis. static: the figure that shows the same, for a page without scripts."""

    id: str
    title: str
    x: str
    y: str
    lines: list[Line]
    caption: str = ""
    static: str = ""
    log_x: bool = False
    log_y: bool = False
    kind: str = "chart"


@dataclass(frozen=True)
class Coded:
    """An array as whole numbers of few bits: value = low + step · code, of its logarithm to 10 where `log`.

    codes: uint8 or uint16, 0 where there is no value.
    """

    codes: "np.ndarray[Any, Any]"
    low: float
    step: float
    log: bool = False

    @classmethod
    def of(cls, values: FloatArray, low: float, high: float, *, bits: int = 8, log: bool = False) -> "Coded":
        """Code the finite values (above zero, where `log`) between low and high; beyond these the nearest."""
        most = 2**bits - 2
        known = np.isfinite(values) & ((values > 0.0) | (not log))
        shown = np.where(known, values, low)
        if log:
            low, high, shown = math.log10(low), math.log10(high), np.log10(shown)
        step = (high - low) / most or 1.0
        codes = np.where(known, 1.0 + np.clip(np.rint((shown - low) / step), 0.0, most), 0.0)
        return cls(codes.astype(f"u{bits // 8}"), float(low - step), float(step), log)


@dataclass(frozen=True)
class Map:
    """A field at each of some distances. extent: first x, last x, first y, last y [mm].

    fields: one a distance, shape (x, y). says: a sentence a field. states: label and colour of each code of a
    field that holds states.
    """

    id: str
    title: str
    labels: list[str]
    extent: tuple[float, ...]
    fields: list[Coded]
    says: list[str]
    unit: str = ""
    states: tuple[tuple[str, str], ...] = ()
    caption: str = ""
    static: str = ""
    kind: str = "map"


@dataclass(frozen=True)
class Bodies:
    """Bodies in 3-D by name, heights [µm], (x, y). extent: first x, last x, first y, last y [mm].

    still: names of those that a picture shows where nothing turns them.
    """

    id: str
    title: str
    extent: tuple[float, ...]
    bodies: dict[str, Coded]
    still: list[str]
    caption: str
    static: str = ""
    kind: str = "bodies"


@dataclass(frozen=True)
class Bars:
    """A bar a name, the first on top. ends: of an interval, (2, names). dots: second values, (names,)."""

    id: str
    title: str
    names: list[str]
    values: FloatArray
    x: str
    limits: tuple[float, float]
    ends: FloatArray | None = None
    dots: FloatArray | None = None
    caption: str = ""
    static: str = ""
    kind: str = "bars"


@dataclass(frozen=True)
class Grid:
    """A value for each pair of two keys' values, (across, down). x, y: what they are; unit: of the values."""

    id: str
    title: str
    across: list[str]
    down: list[str]
    values: FloatArray
    x: str
    y: str
    unit: str
    caption: str = ""
    static: str = ""
    kind: str = "grid"


@dataclass(frozen=True)
class Section:
    """Plots under one heading, which share a slider where they have one, or a legend of the first one's "
    "lines."""

    title: str
    plots: list[Any]
    id: str = ""
    text: str = ""
    slider: list[str] = field(default_factory=list)
    one_legend: bool = False


def chosen(count: int, most: int) -> list[int]:
    """Choose at most so many of `count` numbers, the first and the last among them."""
    return sorted({round(float(at)) for at in np.linspace(0, count - 1, min(most, count))})


def thinned(distance: FloatArray) -> "np.ndarray[Any, Any]":
    """Choose at most about `POINTS` steps: evenly in number and in the distance's logarithm."""
    count = distance.size
    if count <= POINTS:
        return np.arange(count)
    first = max(float(distance[0]), 1e-6 * float(distance[-1]))
    spaced = np.searchsorted(distance, np.geomspace(first, float(distance[-1]), POINTS // 2))
    evenly = np.linspace(0, count - 1, POINTS // 2).round().astype(int)
    return np.unique(np.concatenate([evenly, np.minimum(spaced, count - 1)]))


def is_wide(*values: FloatArray) -> bool:
    """Tell whether values above zero differ so much that they need a logarithmic scale."""
    known = np.concatenate([np.ravel(v)[np.isfinite(np.ravel(v)) & (np.ravel(v) > 0.0)] for v in values])
    return bool(known.size and known.max() >= WIDE * known.min())


def after(distance: float) -> str:
    """Say in words when a snapshot was taken. distance: [mm]"""
    return f"after {distance:.4g} mm" if distance else "static contact"


#: Kinds of line as Matplotlib's figures have them -> as a page has them.
DASHES = {"-": "solid", "--": "dash", "-.": "dashdot", ":": "dot"}


def look_of(line: dict[str, Any]) -> tuple[str, str]:
    """Return colour and dash of a page for the keyword arguments of a line of Matplotlib's."""
    kind = line.get("ls", "-")
    return line["color"], DASHES[kind] if isinstance(kind, str) else f"longdash{'dot' * (len(kind[1]) > 2)}"


def banded(name: str, line: dict[str, Any], places: FloatArray, values: FloatArray) -> Line:
    """Make the line of a group's mean, in a band of 5 to 95 % of its runs where it has several.

    line: as of Matplotlib. places: (n,), rising; values: (runs, n), NaN where a run has none.
    """
    at = thinned(places)
    mean, low, high = (of[at] for of in band(values))
    several, (colour, dash) = len(values) > 1, look_of(line)
    marks = "lines+markers" if places.size == 1 else "lines"
    ends = (low, high) if several else (None, None)
    return Line(name, colour, places[at], mean, dash, marks, False, *ends)


def overlaid(
    name: str,
    title: str,
    unit: str,
    lines: list[Line],
    *,
    x: str = DISTANCE,
    log: bool = False,
    note: str = "",
) -> Chart | None:
    """Lay lines over each other in a chart, with the figure `name` where no script draws; None without lines.

    log: whether distance and values may be logarithmic, where they span much.
    """
    lines = [line for line in lines if np.isfinite(line.y).any()]
    if not lines:
        return None
    first = min((float(line.x[0]) for line in lines), default=0.0)
    log_x = log and first > 0.0 and max(float(line.x[-1]) for line in lines) > WIDE_DISTANCE * first
    log_y = log and is_wide(*(line.y for line in lines))
    return Chart(title.lower(), title, x, unit, lines, note, name, log_x, log_y)
