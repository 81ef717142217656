"""The one style of all figures: sizes, colours, line styles, axes. Nothing here knows what is drawn."""

from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, MaxNLocator

from warpwear.grid import FloatArray

#: Width of one and of two columns of a journal, height of one row of panels [inch].
COLUMN, PAGE, ROW = 3.5, 7.0, 2.6

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

STYLE: dict[Any, Any] = {
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.2,
    "grid.color": "#DDDDDD",
    "figure.dpi": 300,
    "pdf.fonttype": 42,  # TrueType: publishers refuse Type 3
    "svg.hashsalt": "warpwear",
}


def style() -> Any:
    """Context in which figures are made and written."""
    return matplotlib.rc_context(STYLE)


def new_figure(
    draw: Callable[[Any], None],
    *,
    rows: int = 1,
    columns: int = 1,
    height: float = ROW,
    width: float | None = None,
) -> Figure:
    """A figure of one column's width, or of the page's where panels stand side by side.

    draw: gets the axes, one or an array of shape (rows × columns,). height: of a row [inch].
    """
    with style():
        size = (width or (COLUMN if columns == 1 else PAGE), height * rows)
        figure = Figure(figsize=size, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns)
        draw(axes.ravel() if rows * columns > 1 else axes)
    return figure


def in_time(colour: str, count: int) -> list[dict[str, Any]]:
    """Lines for what follows in time: a body's colour from pale to dark, the last one solid."""
    scale = shades(colour)
    places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
    kinds = [*(":", "-.", "--")[: count - 1], "-"]
    return [{"color": scale(place), "ls": kind, "lw": 1.1} for place, kind in zip(places, kinds, strict=True)]


def shades(colour: str) -> LinearSegmentedColormap:
    """From a pale to a dark shade of a body's colour."""
    base = np.array(to_rgb(colour))
    dark, pale = 0.35 * base, base + 0.4 * (1.0 - base)
    return LinearSegmentedColormap.from_list("shades", [pale, base, dark])


def over_distance(axes: Axes, distance: FloatArray, values: FloatArray, **line: Any) -> None:
    """A quantity over the distance slid [mm]."""
    axes.plot(distance, values, **line)
    axes.set_xlabel("sliding distance, mm")
    axes.xaxis.set_major_locator(MaxNLocator(6))


def scale_distance(axes: Axes, distance: FloatArray) -> None:
    """Logarithmic where the steps span decades; call it after the lines are drawn."""
    if distance[-1] > 30.0 * distance[0]:
        axes.set_xscale("log")


def scale_values(axes: Axes, *values: FloatArray) -> None:
    """Logarithmic where values differ much; else linear from zero, so that a constant looks like one."""
    known = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in values])
    if known.size == 0 or known.max() < 5.0 * known.min():
        top = 1.15 * known.max() if known.size else None
        axes.set_ylim(0.0, top)
        axes.yaxis.set_major_locator(MaxNLocator(6))
    else:
        logarithmic(axes)


def logarithmic(axes: Axes) -> None:
    """A logarithmic scale of values, with plain numbers where they are short; call it before the limits."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if low > 1e-3 and high < 1e4:
        axes.yaxis.set_major_formatter(PlainNumbers())
        axes.yaxis.set_minor_formatter(PlainNumbers(minor_thresholds=(1.2, 0.5)))


class PlainNumbers(LogFormatter):
    """0.1 instead of 1e-01, at the ticks that a logarithmic axis labels."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def legend_above(*panels: Axes, columns: int) -> None:
    """One legend over the figure of these panels, where it hides no line."""
    found: dict[str, Any] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure = panels[0].get_figure(root=True)
    assert figure is not None
    figure.legend(list(found.values()), list(found), loc="outside upper center", ncols=columns)


def after(distance: float) -> str:
    """The state of a snapshot in words. distance: [mm]"""
    return f"after {distance:.4g} mm" if distance else "static contact"


def with_scatter(mean: float, scatter: float) -> str:
    """Mean ± standard deviation; the latter left out where it is only round-off."""
    shown = f"{float(f'{mean:.3g}'):g}"
    return f"{shown} ± {float(f'{scatter:.2g}'):g}" if scatter > 1e-6 * mean else shown
