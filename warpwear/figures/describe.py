"""What a figure shows, in plain arrays and words, once: Matplotlib draws it, and so does a page's script.

Nothing here imports Matplotlib: a run declares its figures, and another process draws them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from warpwear.grid import FloatArray

#: Widths of one and of two columns of a journal, and height of a row of panels [inch].
COLUMN, PAGE, ROW = 3.5, 7.0, 2.6

# Okabe and Ito's colours, told apart by colour-blind readers. A body keeps its colour in every figure, and
# so does each kind of contact; where two could meet in grey, their lines differ too.
COUNTER, DISC = "#0072B2", "#D55E00"
CONTACT, TOUCHED, HARDNESS, NOMINAL, SUM = "#009E73", "#56B4E9", "#000000", "#777777", "#E69F00"
NEUTRAL, MEAN_PRESSURE = "#444444", "#A3487F"
UNWORN, CLEAR = "#999999", "#FFFFFF"
BODIES = {"counter": COUNTER, "disc": DISC}
#: Colours of groups of runs beside each other, and of what was measured, which they are held against.
GROUPS = (COUNTER, DISC, CONTACT, MEAN_PRESSURE, SUM, TOUCHED)
GREYS = ("#000000", "#888888", "#555555")

Dash = Literal["solid", "dash", "dashdot", "dot", "longdash", "longdashdot", ""]
#: Kinds of line, from the plainest; "" draws none.
DASHES: tuple[Dash, ...] = ("solid", "dash", "dashdot", "dot", "longdash", "longdashdot")
MARKERS = ("o", "s", "^", "v", "D")
#: Values over more than this many times the least are drawn on a logarithmic scale; distances alike.
WIDE, WIDE_DISTANCE = 5.0, 30.0
#: Length of a map over its width from which on it is drawn in a row of its own.
LONG = 4.0
DISTANCE, TIME = "sliding distance, mm", "sliding time, s"
ALONG, ACROSS = "along sliding, x, mm", "across sliding, y, mm"

Ends: TypeAlias = tuple[float, float, float, float]


@dataclass(frozen=True)
class Look:
    """How a line looks. width: [points]; marker: of Matplotlib, and its size [points]; hollow: unfilled."""

    colour: str = NEUTRAL
    dash: Dash = "solid"
    width: float = 1.2
    marker: str = ""
    size: float = 3.0
    alpha: float = 1.0
    hollow: bool = False


#: One value of a course, and one that is an input of it.
DOT = Look(dash="", marker="o", size=4.0)
RING = replace(DOT, hollow=True)


@dataclass(frozen=True)
class Line:
    """Values over places, both (points,). low, high: ends of a band around it, as y; hatch: of the band.

    step: a value holds from its place on ("post") or around it ("mid"). clipped: cut off at the panel's
    edge. every: points from a marker to the next. name: in full, on a page. written: its label stands at its
    one place, in the plane.
    """

    x: FloatArray
    y: FloatArray
    label: str = ""
    look: Look = Look()
    low: FloatArray | None = None
    high: FloatArray | None = None
    step: Literal["", "post", "mid"] = ""
    clipped: bool = True
    every: int = 1
    hatch: str = ""
    name: str = ""
    written: bool = False


@dataclass(frozen=True)
class Level:
    """Declare a straight line through the whole panel, at a value of y, or of x."""

    value: float
    label: str = ""
    look: Look = Look(width=0.8)
    axis: Literal["x", "y"] = "y"


@dataclass(frozen=True)
class Density:
    """How often two values meet, (x, y): areas that enclose parts of all, and lines around them."""

    x: FloatArray
    y: FloatArray
    counts: FloatArray
    levels: tuple[float, ...]
    colours: tuple[str, ...]
    edge: str = COUNTER


@dataclass(frozen=True)
class Axis:
    """An axis: its label with the unit, its scale, and its ends where the lines do not choose them.

    scale: "auto" is logarithmic where values span more than `wide` times the least, and else begins at zero;
    "unworn" is logarithmic with a place for 0. least: a logarithmic axis begins no lower. places: ticks with
    their labels. numbered: whether ticks have labels.
    """

    label: str = ""
    scale: Literal["linear", "log", "auto", "unworn"] = "linear"
    low: float | None = None
    high: float | None = None
    wide: float = WIDE
    least: float = 0.0
    integer: bool = False
    inverted: bool = False
    numbered: bool = True
    ticks: int = 6
    places: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class Chart:
    """Lines over one axis. title: its heading on a page; note: said above it on paper, and below it there.

    stretch_note: said instead of the note, with a field for how many times larger `stretch_factor` of y is
    drawn than one of x.
    """

    title: str
    x: Axis
    y: Axis
    lines: Sequence[Line | Level | Density]
    note: str = ""
    stretch_note: str = ""
    stretch_factor: float = 1.0


@dataclass(frozen=True)
class Scale:
    """Colours of values from `low` to `high`. beyond: which end of it values go past."""

    label: str = ""
    low: float = 0.0
    high: float = 1.0
    log: bool = False
    colours: Literal["pressures", "heights", "depths", "signed"] = "pressures"
    beyond: Literal["neither", "min", "max", "both"] = "neither"


@dataclass(frozen=True)
class Map:
    """Declare fields (x, y) over one extent [mm]: side by side on paper, under a slider on a page.

    labels, notes: when each is, and what is said of it. states: label and colour of each code, where fields
    hold codes. hidden: where nothing is known, grey; hatched: where it is filled in. regions: whose outlines
    are drawn. frames: around parts of it [mm]. contours: about how many lines of equal value. lit: as if
    light fell on heights. square: whether x and y are of one scale. heading: whether the title stands above
    each on paper. stretch_note: as of a Chart.
    """

    title: str
    fields: Sequence[NDArray[Any]]
    extent: Ends
    scale: Scale = Scale()
    labels: Sequence[str] = ()
    notes: Sequence[str] = ()
    states: tuple[tuple[str, str], ...] = ()
    hidden: NDArray[Any] | None = None
    hatched: NDArray[np.bool_] | None = None
    regions: Sequence[tuple[NDArray[np.bool_], Look]] = ()
    contours: int = 0
    frames: Sequence[Ends] = ()
    levels: Sequence[Level] = ()
    lit: bool = False
    square: bool = True
    heading: bool = False
    stretch_note: str = ""
    x: str = ALONG
    y: str = ACROSS

    @property
    def is_long(self) -> bool:
        """Tell whether it is too long to stand beside others, x and y of one scale."""
        x0, x1, y0, y1 = self.extent
        return bool(x1 - x0 > LONG * (y1 - y0))


@dataclass(frozen=True)
class Bars:
    """Draw a bar a name, the first on top.

    ends: of an interval, (2, names). dots: second values, (names,). written: format of values behind bars.
    """

    title: str
    names: Sequence[str]
    values: FloatArray
    axis: Axis
    ends: FloatArray | None = None
    dots: FloatArray | None = None
    colours: Sequence[str] = (COUNTER,)
    written: str = ""
    note: str = ""


@dataclass(frozen=True)
class HeatMap:
    """A value for each pair of two keys' values, (across, down). x, y: what they are; unit: of the values."""

    title: str
    across: Sequence[str]
    down: Sequence[str]
    values: FloatArray
    x: str
    y: str
    unit: str
    note: str = ""


@dataclass(frozen=True)
class Relief:
    """Heights [µm], (x, y), lit in shades of a colour from `low` to `high`; pale where `scar` is above 0.5.

    cap: the largest circle alone is shown.
    """

    heights: FloatArray
    colour: str
    low: float
    high: float
    scar: FloatArray | None = None
    cap: bool = False


@dataclass(frozen=True)
class Glass:
    """A surface that is seen through, heights [µm] over x and y [mm], with its nearest edge drawn."""

    x: FloatArray
    y: FloatArray
    heights: FloatArray
    colour: str


@dataclass(frozen=True)
class Towers:
    """A tower a square of `side` [mm] from `corner`, (x, y), in colours of a scale; none at zero."""

    values: FloatArray
    corner: tuple[float, float]
    side: float
    scale: Scale


@dataclass(frozen=True)
class Arrow:
    """Declare an arrow along x with its text, over the near edge at a height [µm]."""

    start: float
    end: float
    height: float
    text: str


@dataclass(frozen=True)
class Box:
    """Declare bodies in three dimensions, x and y [mm] true to scale. note: has a field for the scale."""

    title: str
    extent: Ends
    label: str
    low: float
    high: float
    parts: Sequence[Relief | Glass | Towers | Arrow]
    note: str = ""


@dataclass(frozen=True)
class Scene:
    """Bodies by name, heights [µm] (x, y): a page's script turns them, paper `still` ones from above."""

    title: str
    extent: Ends
    heights: dict[str, FloatArray]
    still: Sequence[str]
    note: str = ""


@dataclass(frozen=True)
class Text:
    """Rows of label and text, in a panel of their own."""

    rows: Sequence[tuple[str, str]]
    title: str = ""


@dataclass(frozen=True)
class Empty:
    """Keep a place without a panel."""


Panel: TypeAlias = Chart | Map | Bars | HeatMap | Box | Scene | Text | Empty


@dataclass(frozen=True)
class Figure:
    """Lay panels out, row after row. columns: panels in a row, by default all; width, height of a row [inch].

    legend: columns of one legend over all panels, 0 for none. shared: axes that panels have in common.
    """

    panels: Sequence[Panel]
    columns: int = 0
    legend: int = 0
    shared: Literal["", "x", "y", "xy"] = ""
    width: float = 0.0
    height: float = ROW


def values_of(chart: Chart, which: str) -> list[FloatArray]:
    """Collect the values along x or y that lines and levels of a chart have."""
    lines = [getattr(line, which) for line in chart.lines if isinstance(line, Line)]
    levels = [level.value for level in chart.lines if isinstance(level, Level) and level.axis == which]
    return [*lines, *(np.array([value]) for value in levels)]


def scaled(axis: Axis, *values: FloatArray) -> Axis:
    """Settle the scale of an axis that leaves it to these values, and where it begins and ends then."""
    if axis.scale != "auto":
        return axis
    every = np.concatenate([np.zeros(1), *map(np.ravel, values)])
    known = every[np.isfinite(every) & (every > 0.0)]
    if known.size and known.max() >= axis.wide * known.min():
        return replace(axis, scale="log")
    top = 1.15 * float(known.max()) if known.size else None
    return replace(axis, scale="linear", low=0.0 if axis.low is None else axis.low, high=axis.high or top)


def over_distance(*distances: FloatArray) -> Axis:
    """Make the axis of distances slid [mm], logarithmic where steps span decades."""
    first = min((float(d[0]) for d in distances if d.size), default=0.0)
    last = max((float(d[-1]) for d in distances if d.size), default=0.0)
    return Axis(DISTANCE, "log" if 0.0 < WIDE_DISTANCE * first < last else "linear")


def in_time(colour: str, count: int) -> list[Look]:
    """Choose lines for `count` states in time: a body's colour from pale to dark, the last one solid."""
    places = np.linspace(0.0, 1.0, count) if count > 1 else [0.5]
    early: tuple[Dash, ...] = ("dot", "dashdot", "dash")
    kinds: list[Dash] = [*early[: count - 1], "solid"]
    return [Look(shade(colour, float(place)), kind, 1.1) for place, kind in zip(places, kinds, strict=True)]


def lines_in_time(
    colour: str, states: Sequence[tuple[FloatArray, FloatArray, str]], step: Literal["", "post"] = ""
) -> list[Line]:
    """Make the lines of states in time, each of places, values and label, see `in_time`."""
    looks = in_time(colour, len(states))
    return [Line(*state, look, step=step) for state, look in zip(states, looks, strict=True)]


def shade(colour: str, place: float) -> str:
    """Give a shade of a colour, from a pale (0) over itself (0.5) to a dark one (1)."""
    base = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    dark, pale = 0.35 * base, base + 0.4 * (1.0 - base)
    start, end, part = (pale, base, 2.0 * place) if place <= 0.5 else (base, dark, 2.0 * place - 1.0)
    return "#" + "".join(f"{round(255.0 * v):02x}" for v in start + part * (end - start))


def look_of_group(index: int) -> Look:
    """Choose the line of a group of runs, the same in every figure.

    Colours repeat after six groups, together with their dashes only after thirty-six.
    """
    dash = DASHES[(index + index // len(GROUPS)) % len(DASHES)]
    return Look(GROUPS[index % len(GROUPS)], dash)


def look_of_measured(index: int) -> Look:
    """Choose the line of a measured course, the same in every figure."""
    return Look(GREYS[index % len(GREYS)], width=0.6, marker=MARKERS[index % len(MARKERS)], size=2.2)
