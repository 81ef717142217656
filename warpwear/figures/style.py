"""The one style of all figures: sizes, colours, line styles, axes. Nothing here knows what is drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, LogLocator, MaxNLocator, NullLocator, ScalarFormatter

from warpwear.errors import InputError
from warpwear.grid import FloatArray

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
COLOURS: dict[str, Any] = {"pressures": PRESSURES, "heights": HEIGHTS, "depths": DEPTHS}
COLOURS["signed"] = matplotlib.colormaps["RdBu_r"]

#: Formats of files, each with the metadata of them in which Matplotlib would write the date.
FORMATS: dict[str, dict[str, None]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}

STYLE: Any = {
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.2,
    "grid.color": "#DDDDDD",
    "axes.formatter.useoffset": False,  # 0.999 and not 9.99 with "+9.9e-1" at the axis's end
    "figure.dpi": 300.0,
    "text.parse_math": False,  # a $ in the name of a run is a $
    "pdf.fonttype": 42,  # TrueType: publishers refuse Type 3
    "svg.hashsalt": "warpwear",
}
#: Inches that a character of a legend takes, and a line with its room beside the text.
CHARACTER, LEGEND_LINE = 0.055, 0.5
#: Fewer decades than this of a logarithmic axis keep all their ticks, of which all have a number.
LEAST_THINNED = 0.5
#: More decades than this of a logarithmic axis have no number between them.
LABELLED = 2.3
#: How powers of ten are written.
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: From here on thousands are set apart by a narrow space, as SI writes them.
THOUSANDS = 1e4
#: More decades than this from the first state of a scar have a number at each only.
DECADES = 2.2
#: Compression of PNG: more makes files a quarter smaller, and takes a third of a figure's time.
COMPRESSION = {"compress_level": 1}


def style() -> Any:
    """Open the context in which figures are made and written."""
    return matplotlib.rc_context(STYLE)


def check_format(file_format: str) -> None:
    """Raise InputError for a format of files that is not in FORMATS."""
    if file_format not in FORMATS:
        raise InputError(f"format = '{file_format}' is not known; allowed: {', '.join(FORMATS)}")


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as its path ends, without a date: the same run gives the same file."""
    path.write_bytes(bytes_of(figure, path.suffix.removeprefix(".")))


def bytes_of(figure: Figure, file_format: str = "png", *, dpi: float | str = "figure") -> bytes:
    """Return the content of the file that holds a figure in one of `FORMATS`."""
    written = BytesIO()
    more: Any = {"pil_kwargs": COMPRESSION} if file_format == "png" else {}
    with style():
        figure.savefig(written, format=file_format, dpi=dpi, metadata=FORMATS[file_format], **more)
    return written.getvalue()


@dataclass(frozen=True)
class Room:
    """Room around panels that are placed without measuring their texts [inch]."""

    left: float = 0.56  # of tick labels and a label
    ticks: float = 0.34  # of tick labels alone
    right: float = 0.56  # of a second scale or one colour bar for all
    bar: float = 0.7  # of a colour bar of a panel's own
    below: float = 0.4
    line: float = 0.135  # of a title
    legend: float = 0.165  # of a row of a legend
    edge: float = 0.1
    last: float = 0.16  # beyond the last panel: half of its last tick label


ROOM = Room()
#: Left edge, from the right edge of its panel, and width of a colour bar [inch].
BAR, BAR_WIDTH = 0.08, 0.08


class Sheet(Figure):
    """A figure that holds nothing of others, so that one legend may stand over all of it."""

    #: Axes of a colour bar that is for all panels.
    bar: Axes | None = None
    _legend_rows = 0

    def __init__(self, *given: Any, **more: Any) -> None:
        super().__init__(*given, **more)
        #: What is said of panels whose places are known, by functions that are called then.
        self.when_placed: list[Callable[[], None]] = []

    def legend_above(self, handles: list[Any], labels: list[str], *, columns: int) -> None:
        """Put a legend over all panels, in fewer columns where they are too wide for the figure."""
        columns = next(n for n in range(columns, 0, -1) if n == 1 or _width(labels, n) <= self.get_figwidth())
        for older in [*self.legends]:
            older.remove()
        where: Any = "outside upper center" if self.get_layout_engine() else "upper center"
        self.legend(handles, labels, loc=where, ncols=columns, borderaxespad=0.3)
        self._legend_rows = -(-len(labels) // columns)

    def place(self, panels: "np.ndarray[Any, Any]", *, square: bool) -> None:
        """Give panels, (rows, columns), their places by what they say: measuring it takes most of the time.

        square: the height of the figure follows from its width.
        """
        for axis in (axis for panel in self.axes for axis in (panel.xaxis, panel.yaxis)):
            _thin_ticks(axis)

        def says(line: Any, what: str) -> bool:
            return any(getattr(panel, what)() for panel in line)

        def left(column: Any) -> float:
            shown = any(panel.yaxis.get_tick_params().get("labelleft", True) for panel in column)
            return ROOM.left if says(column, "get_ylabel") else ROOM.ticks if shown else 0.0

        def right(column: Any) -> float:
            twins = (axes for axes in self.axes if axes is not self.bar and axes not in panels)
            beside = [axes for panel in column for axes in panel.child_axes]
            if any(hasattr(axes, "_colorbar") for axes in beside):
                return ROOM.bar
            return ROOM.right if beside or any(twins) else 0.0

        def above(row: Any) -> float:
            lines = max(panel.get_title().count("\n") + 1 if panel.get_title() else 0 for panel in row)
            return ROOM.line * lines + ROOM.edge

        lefts, rights = [left(c) + ROOM.edge for c in panels.T], [right(c) for c in panels.T]
        aboves = [above(row) for row in panels]
        belows = [ROOM.below if says(row, "get_xlabel") else 0.5 * ROOM.edge for row in panels]
        legend = self._legend_rows * ROOM.legend
        end = ROOM.right + 2.0 * ROOM.edge if self.bar is not None else ROOM.last
        width, height = self.get_size_inches()
        side = (width - sum(lefts) - sum(rights) - end) / panels.shape[1]
        taken = legend + sum(aboves) + sum(belows)
        high = side if square else (height - taken) / panels.shape[0]
        height = taken + high * panels.shape[0]
        self.set_size_inches(width, height)
        top = height - legend
        for row, over, under in zip(panels, aboves, belows, strict=True):
            top -= over + high
            at = 0.0
            for panel, before, after in zip(row, lefts, rights, strict=True):
                at += before
                panel.set_position((at / width, top / height, side / width, high / height))
                at += side + after
            top -= under
        if self.bar is not None:
            whole = height - legend - aboves[0] - belows[-1]
            low, tall = belows[-1] + 0.1 * whole, 0.8 * whole
            start = width - ROOM.right - ROOM.edge
            self.bar.set_position((start / width, low / height, BAR_WIDTH / width, tall / height))
        for tell in self.when_placed:
            tell()


def _width(labels: list[str], columns: int) -> float:
    """Estimate the width of a legend [inch], whose labels fill one column after another."""
    longest = (max(map(len, part), default=0) for part in np.array_split(np.array(labels, object), columns))
    return sum(CHARACTER * characters + LEGEND_LINE for characters in longest)


def _thin_ticks(axis: Axis) -> None:
    """Keep two ticks between decades of a logarithmic axis, numbered where decades are few.

    Each tick takes time.
    """
    low, high = sorted(axis.get_view_interval())
    if axis.get_scale() == "log" and low > 0.0 and high > 10.0**LEAST_THINNED * low:
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0), numticks=50))
        if high < 10.0**LABELLED * low and isinstance(axis.get_minor_formatter(), PlainNumbers):
            plain_numbers(axis, decades=LABELLED)


def new_figure(
    draw: Callable[[Any], None],
    *,
    rows: int = 1,
    columns: int = 1,
    height: float = ROW,
    width: float | None = None,
    fixed: bool = False,
    square: bool = False,
) -> Figure:
    """Make a figure of one column's width, or of the page's where panels stand side by side.

    draw: gets the axes, one or an array of shape (rows × columns,). height: of a row [inch]. fixed: panels
    are placed without measuring texts, see `Sheet.place`; square: and are square, whatever the height.
    """
    with style():
        size = (width or (COLUMN if columns == 1 else PAGE), height * rows)
        figure = Sheet(figsize=size, layout=None if fixed else "constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns, squeeze=False)
        draw(axes.ravel() if rows * columns > 1 else axes[0, 0])
        if fixed:
            figure.place(axes, square=square)
    return figure


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
    axes.xaxis.set_major_locator(steps(6))
    axes.xaxis.set_major_formatter(Thousands())


def steps(most: int, **more: Any) -> MaxNLocator:
    """Make a locator of at most so many steps of 1, 2 or 5, which people count in."""
    return MaxNLocator(most, steps=[1, 2, 5, 10], **more)


def scale_from_unworn(axes: Axes, places: FloatArray, xlabel: str) -> None:
    """Make a logarithmic axis before which 0, the unworn state, has a place of its own. places: rising"""
    first, last = np.log10(places[places > 0.0][0]), np.log10(places[-1])
    start = 10.0 ** np.floor(first)
    axes.set_xscale("symlog", linthresh=start, linscale=0.5)
    digits = (1.0, 2.0, 5.0) if last - first < DECADES else (1.0,)
    ticks = [digit * 10.0**power for power in range(round(np.log10(start)), 10) for digit in digits]
    axes.set_xticks([0.0, *(tick for tick in ticks if tick <= 1.05 * places[-1])])
    axes.xaxis.set_major_formatter(lambda value, _: short(value) if value else "unworn")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set(xlabel=xlabel, xlim=(0.0, 1.15 * places[-1]))


def scale_distance(axes: Axes, distance: FloatArray) -> None:
    """Make the distance logarithmic where the steps span decades; call it after the lines are drawn."""
    if distance[-1] > 30.0 * distance[0]:
        axes.set_xscale("log")
        plain_numbers(axes.xaxis)


def scale_values(axes: Axes, *values: FloatArray) -> None:
    """Make values logarithmic where they differ much; else linear from zero, so a constant looks like one.

    What the axes show already counts, too.
    """
    there = (np.asarray(line.get_ydata(), dtype=np.float64) for line in axes.lines)
    known = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in (*values, *there)])
    if axes.get_yscale() != "log" and (known.size == 0 or known.max() < 5.0 * known.min()):
        top = 1.15 * known.max() if known.size else None
        axes.set_ylim(0.0, top)
        axes.yaxis.set_major_locator(steps(6))
    else:
        logarithmic(axes)


def logarithmic(axes: Axes) -> None:
    """Make values logarithmic; call it before setting limits."""
    axes.set_yscale("log")
    plain_numbers(axes.yaxis)


def plain_numbers(axis: Axis, *, decades: float = 0.5) -> None:
    """Write 0.1 or 10⁻⁵ instead of 1e-01 along a logarithmic axis, between decades where it spans few.

    decades: span of the axis up to which all ticks are labelled, see `minor_thresholds` of LogFormatter.
    """
    axis.set_major_formatter(PlainNumbers())
    axis.set_minor_formatter(PlainNumbers(minor_thresholds=(1.2, decades)))


class PlainNumbers(LogFormatter):
    """Writes 0.1 or 10⁻⁵ instead of 1e-01, at the ticks that a logarithmic axis labels.

    Without the setting of formulas, which takes as long as the rest of a small figure.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        return short(x) if super().__call__(x, pos) else ""


class Thousands(ScalarFormatter):
    """Writes 20 000 instead of 20000 along a linear axis."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return short(x) if THOUSANDS <= abs(x) < 1e5 else super().__call__(x, pos)


def short(value: float) -> str:
    """Write a number as people do: 0.001, 20, 20 000, 10⁻⁵, 2·10⁶."""
    if THOUSANDS <= abs(value) < 1e5 and value == round(value):
        return f"{value:,.0f}".replace(",", "\u202f")  # a narrow space
    if 1e-3 <= abs(value) < 1e5 or value == 0.0:
        return f"{value:g}"
    digits, _, power = f"{value:e}".partition("e")
    raised = str(int(power)).translate(RAISED)
    return f"10{raised}" if float(digits) == 1.0 else f"{float(digits):g}·10{raised}"


def legend_above(*panels: Axes, columns: int) -> None:
    """Put one legend of all panels over their figure, where it hides no line; in others' figures inside."""
    found: dict[str, Any] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure = panels[0].figure.figure
    if isinstance(figure, Sheet):
        figure.legend_above(list(found.values()), list(found), columns=columns)
    else:
        panels[-1].legend(list(found.values()), list(found))


def after(distance: float) -> str:
    """Say in words when a snapshot was taken. distance: [mm]"""
    return f"after {distance:.4g} mm" if distance else "static contact"


def with_scatter(mean: float, scatter: float) -> str:
    """Write mean ± standard deviation, to the same digit; the latter left out where it is only round-off."""
    if not scatter > 1e-6 * mean:
        return f"{float(f'{mean:.3g}'):g}"
    decimals = 1 - int(np.floor(np.log10(scatter)))
    known = max(decimals, 0)
    return f"{round(mean, decimals):.{known}f} ± {float(f'{scatter:.2g}'):.{known}f}"
