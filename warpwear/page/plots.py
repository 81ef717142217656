"""Figures as what a page's script draws: numbers, words and codes of few bits."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Bars, Chart, Empty, Figure, HeatMap, Level, Line, Map, Scene
from warpwear.figures.units import far
from warpwear.figures.wording import chosen
from warpwear.grid import FloatArray

#: Most points of a line.
POINTS = 1500
#: Colours that have to stand out from a dark page as well: the script takes the text's instead.
INKS = {describe.HARDNESS: "ink", describe.NEUTRAL: "ink", describe.NOMINAL: "soft"}
#: Pixels of a point of a line's width.
PIXELS = 5.0 / 3.0
#: Markers of Matplotlib as the script has them.
SYMBOLS = {"": "circle", "o": "circle", ".": "circle", "s": "square", "x": "x-thin-open", "D": "diamond"}
SYMBOLS |= {"^": "triangle-up", "v": "triangle-down"}
#: How a value holds between places, as the script has it.
SHAPES = {"": "linear", "post": "hv", "mid": "hvh"}


def coded(values: FloatArray, low: float, high: float, *, bits: int = 8, log: bool = False) -> dict[str, Any]:
    """Code the finite values (above zero, where `log`) between low and high; beyond these the nearest.

    A value, or its logarithm to 10 where `log`, is low + step · code; codes (uint8 or uint16) are 0 for none.
    """
    most = 2**bits - 2
    known = np.isfinite(values) & ((values > 0.0) | (not log))
    filled = np.where(known, values, low)
    if log:
        low, high, filled = math.log10(low), math.log10(high), np.log10(filled)
    step = (high - low) / most or 1.0
    codes = np.where(known, 1.0 + np.clip(np.rint((filled - low) / step), 0.0, most), 0.0)
    codes = codes.astype(f"u{bits // 8}")
    return {"codes": codes, "low": float(low - step), "step": float(step), "log": log}


def plots_of(name: str, figure: Figure) -> list[dict[str, Any]]:
    """Turn the panels of a figure into plots; `name` is that of the picture where no script draws."""
    plots = []
    for panel in far(figure).panels:
        if not isinstance(panel, Empty) and type(panel) in KINDS:
            caption = getattr(panel, "note", "").replace("\n", "; ")
            about = {"id": panel.title.lower(), "title": panel.title, "caption": caption, "static": name}
            plots.append(about | KINDS[type(panel)](panel))
    return plots


def colour_of(colour: str) -> str:
    """Give the name of a colour that depends on the page, or the colour as it is."""
    return INKS.get(colour, colour)


def thinned(places: FloatArray) -> "np.ndarray[Any, Any]":
    """Choose at most about `POINTS` of rising places: evenly in number and in the places' logarithm."""
    count = places.size
    if count <= POINTS:
        return np.arange(count)
    if not (np.diff(places) >= 0.0).all() or places[-1] <= 0.0:
        return np.array(chosen(count, POINTS))
    first = max(float(places[0]), 1e-6 * float(places[-1]))
    spaced = np.searchsorted(places, np.geomspace(first, float(places[-1]), POINTS // 2))
    evenly = np.linspace(0, count - 1, POINTS // 2).round().astype(int)
    return np.unique(np.concatenate([evenly, np.minimum(spaced, count - 1)]))


def _chart(chart: Chart) -> dict[str, Any]:
    lines = [line for line in chart.lines if isinstance(line, Line) and np.isfinite(line.y).any()]
    log_y = describe.scaled(chart.y, *describe.values_of(chart, "y")).scale == "log"
    levels = [_across(level, lines, log_y) for level in chart.lines if isinstance(level, Level)]
    return {
        "kind": "chart",
        "x": chart.x.label,
        "y": chart.y.label,
        "lines": [_line(line, chart.title) for line in [*lines, *levels]],
        "log_x": describe.scaled(chart.x, *describe.values_of(chart, "x")).scale == "log",
        "log_y": log_y,
        "inverted": [chart.x.inverted, chart.y.inverted],
        "ends": [[axis.low, axis.high] for axis in (chart.x, chart.y)],
    }


def _across(level: Level, lines: list[Line], log_y: bool) -> Line:
    """Make the line through a whole chart at a level, where the lines have their places.

    log_y: whether values that are not above zero have none.
    """
    if not lines:
        return Line(np.zeros(0), np.zeros(0), level.label, level.look)
    if level.axis == "y":
        longest = max((line.x for line in lines), key=lambda places: places.size)
        return Line(longest, np.full(longest.size, level.value), level.label, level.look)
    every = np.concatenate([line.y for line in lines])
    every = every[every > 0.0] if log_y else every
    ends = np.array([np.nanmin(every), np.nanmax(every)])
    return Line(np.full(2, level.value), ends, level.label, level.look)


def _line(line: Line, title: str) -> dict[str, Any]:
    points, look = thinned(line.x), line.look
    columns = {"x": line.x, "y": line.y, "low": line.low, "high": line.high}
    marks = "+".join(["lines"] * bool(look.dash) + ["markers"] * bool(look.marker or line.x.size == 1))
    return {
        "name": line.name or line.label or ("steps" if look.alpha < 1.0 else title),
        "named": bool(line.label or line.name) and not line.written,
        "colour": colour_of(look.colour),
        "dash": look.dash or "solid",
        "width": PIXELS * look.width,
        "opacity": look.alpha,
        "marks": "text" if line.written else marks or "none",
        "symbol": SYMBOLS[look.marker] + "-open" * look.hollow,
        "shape": SHAPES[line.step],
        **{key: None if values is None else values[points] for key, values in columns.items()},
    }


def _map(field: Map) -> dict[str, Any]:
    scale = field.scale
    fields = [
        {"codes": values, "low": 0.0, "step": 1.0, "log": False}
        if field.states
        else coded(values, scale.low, scale.high, log=scale.log)
        for values in field.fields
    ]
    return {
        "kind": "map",
        "labels": [*field.labels] or [""] * len(field.fields),
        "says": [*field.notes] or [""] * len(field.fields),
        "extent": field.extent,
        "long": field.is_long,
        "fields": fields,
        "unit": scale.label.rpartition(", ")[2],
        "colours": scale.colours,
        "states": [(label, "clear" if c == describe.CLEAR else colour_of(c)) for label, c in field.states],
    }


def _bodies(bodies: Scene) -> dict[str, Any]:
    known = {name: heights for name, heights in bodies.heights.items() if np.isfinite(heights).any()}
    codes = {n: coded(h, float(np.nanmin(h)), float(np.nanmax(h)), bits=16) for n, h in known.items()}
    return {"kind": "bodies", "extent": bodies.extent, "bodies": codes, "still": [*bodies.still]}


def _bars(bars: Bars) -> dict[str, Any]:
    axis = {"x": bars.axis.label, "limits": (bars.axis.low, bars.axis.high)}
    values = {"values": bars.values, "ends": bars.ends, "dots": bars.dots}
    return {"kind": "bars", "names": [*bars.names], **axis, **values}


def _grid(grid: HeatMap) -> dict[str, Any]:
    return {"kind": "grid", **vars(grid), "across": [*grid.across], "down": [*grid.down]}


#: Kind of panel -> what turns it into a plot; what is none of these is on paper alone.
KINDS: dict[type, Callable[[Any], dict[str, Any]]] = {Chart: _chart, Map: _map, Scene: _bodies}
KINDS |= {Bars: _bars, HeatMap: _grid}
