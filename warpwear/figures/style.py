"""The one style of all figures: sizes, colours, line styles, axes. Nothing here knows what is drawn."""

from collections.abc import Callable
from functools import partial, update_wrapper
from pathlib import Path
from typing import Any, Generic, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, MaxNLocator

from warpwear.errors import InputError
from warpwear.grid import FloatArray

Data = TypeVar("Data")
#: Width of one column of a journal [inch].
COLUMN = 3.5
#: Width of two columns of a journal [inch].
PAGE = 7.0
#: Height of one row of panels [inch].
ROW = 2.6

# Okabe and Ito's colours, told apart by colour-blind readers. A body keeps its colour in every figure, and
# so does each kind of contact; where two could meet in grey, their lines differ too.
SPHERE, DISC = "#0072B2", "#D55E00"
CONTACT, TOUCHED, HARDNESS, NOMINAL, SUM = "#009E73", "#56B4E9", "#000000", "#777777", "#E69F00"
NEUTRAL, MEAN_PRESSURE = "#444444", "#A3487F"

#: Pale to dark, so that little pressure is still seen on white paper and grey keeps the order.
PRESSURES = LinearSegmentedColormap.from_list(
    "pressures", matplotlib.colormaps["viridis"](np.linspace(0.93, 0.0, 256))
)
HEIGHTS = matplotlib.colormaps["cividis"]
DEPTHS = matplotlib.colormaps["magma_r"]

#: Formats of files, each with the metadata of them in which Matplotlib would write the date.
FORMATS: dict[str, dict[str, None]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}

STYLE = matplotlib.rc_params_from_file(
    Path(__file__).parent / "warpwear.mplstyle", use_default_template=False
)


def style() -> Any:
    """Open the context in which figures are made and written."""
    return matplotlib.rc_context(STYLE)


def check_format(file_format: str) -> None:
    """Raise InputError for a format of files that is not in FORMATS."""
    if file_format not in FORMATS:
        raise InputError(f"format = '{file_format}' is not known; allowed: {', '.join(FORMATS)}")


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as its path ends, without a date: the same run gives the same file."""
    with style():
        figure.savefig(path, metadata=FORMATS[path.suffix.removeprefix(".")])


class Sheet(Figure):
    """A figure that holds nothing of others, so that one legend may stand over all of it."""


def new_figure(
    draw: Callable[[Any], None],
    *,
    rows: int = 1,
    columns: int = 1,
    height: float = ROW,
    width: float | None = None,
) -> Figure:
    """Make a figure of one column's width, or of the page's where panels stand side by side.

    draw: gets the axes, one or an array of shape (rows × columns,). height: of a row [inch].
    """
    with style():
        size = (width or (COLUMN if columns == 1 else PAGE), height * rows)
        figure = Sheet(figsize=size, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns)
        draw(axes.ravel() if rows * columns > 1 else axes)
    return figure


class Panels(Generic[Data]):
    """A figure of one panel, or of several side by side, made of a function that draws data into axes.

    Called with data it returns the figure. A single panel can be drawn into axes that are there.
    """

    def __init__(self, draw: Callable[[Any, Data], None], *, columns: int, height: float) -> None:
        update_wrapper(self, draw)
        self._draw, self._height = draw, height
        self.columns = columns

    def __call__(self, data: Data, ax: Axes | None = None) -> Figure:
        """Draw the data; returns the figure, that of `ax` where it is given. Needs one column for `ax`."""
        if ax is None:
            return new_figure(lambda axes: self._draw(axes, data), columns=self.columns, height=self._height)
        self._draw(ax, data)
        return ax.figure.figure  # the outermost one


def panels(columns: int = 1, *, height: float = ROW) -> Callable[[Callable[[Any, Data], None]], Panels[Data]]:
    """Make a figure of a function that draws data into axes: one, or an array of them. height: [inch]"""
    return partial(Panels, columns=columns, height=height)


def in_time(colour: str, count: int) -> list[dict[str, Any]]:
    """Choose lines for `count` states in time: a body's colour from pale to dark, the last one solid."""
    scale = shades(colour)
    places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
    kinds = [*(":", "-.", "--")[: count - 1], "-"]
    return [{"color": scale(place), "ls": kind, "lw": 1.1} for place, kind in zip(places, kinds, strict=True)]


def shades(colour: str) -> LinearSegmentedColormap:
    """Make a map of colours from a pale to a dark shade of a body's colour."""
    base = np.array(to_rgb(colour))
    dark, pale = 0.35 * base, base + 0.4 * (1.0 - base)
    return LinearSegmentedColormap.from_list("shades", [pale, base, dark])


def over_distance(
    axes: Axes, distance: FloatArray, values: FloatArray, *, xlabel: str = "sliding distance, mm", **line: Any
) -> None:
    """Draw a quantity over the distance slid [mm], or over what xlabel says."""
    axes.plot(distance, values, **line)
    axes.set_xlabel(xlabel)
    axes.xaxis.set_major_locator(MaxNLocator(6))


def scale_distance(axes: Axes, distance: FloatArray) -> None:
    """Make the distance logarithmic where the steps span decades; call it after the lines are drawn."""
    if distance[-1] > 30.0 * distance[0]:
        axes.set_xscale("log")


def scale_values(axes: Axes, *values: FloatArray) -> None:
    """Make values logarithmic where they differ much; else linear from zero, so a constant looks like one."""
    known = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in values])
    if known.size == 0 or known.max() < 5.0 * known.min():
        top = 1.15 * known.max() if known.size else None
        axes.set_ylim(0.0, top)
        axes.yaxis.set_major_locator(MaxNLocator(6))
    else:
        logarithmic(axes)


def logarithmic(axes: Axes) -> None:
    """Make values logarithmic, with plain numbers where they are short; call it before setting limits."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if low > 1e-3 and high < 1e4:
        plain_numbers(axes.yaxis)


def plain_numbers(axis: Axis, *, decades: float = 0.5) -> None:
    """Write 0.1 instead of 1e-01 along a logarithmic axis, between decades where it spans few.

    decades: span of the axis up to which all ticks are labelled, see `minor_thresholds` of LogFormatter.
    """
    axis.set_major_formatter(PlainNumbers())
    axis.set_minor_formatter(PlainNumbers(minor_thresholds=(1.2, decades)))


class PlainNumbers(LogFormatter):
    """Writes 0.1 instead of 1e-01, at the ticks that a logarithmic axis labels."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def legend_above(*panels: Axes, columns: int) -> None:
    """Put one legend of all panels over their figure, where it hides no line; in others' figures inside."""
    found: dict[str, Any] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure = panels[0].figure.figure
    if isinstance(figure, Sheet):
        figure.legend(list(found.values()), list(found), loc="outside upper center", ncols=columns)
    else:
        panels[-1].legend(list(found.values()), list(found))


def after(distance: float) -> str:
    """Say in words when a snapshot was taken. distance: [mm]"""
    return f"after {distance:.4g} mm" if distance else "static contact"


def with_scatter(mean: float, scatter: float) -> str:
    """Write mean ± standard deviation; the latter left out where it is only round-off."""
    shown = f"{float(f'{mean:.3g}'):g}"
    return f"{shown} ± {float(f'{scatter:.2g}'):g}" if scatter > 1e-6 * mean else shown
