"""Panels: of one run or of several, maps with real extents, boxes in 3-D true to scale in x and y."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial, update_wrapper
from typing import Any, Generic, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LightSource, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from warpwear.figures import style as fs
from warpwear.figures.of_run.view import Window
from warpwear.grid import FloatArray

Data = TypeVar("Data")
Shown = TypeVar("Shown")
ALONG, ACROSS = "along sliding, x, mm", "across sliding, y, mm"
#: Left, bottom, width and height of a colour bar beside a map, over the map's.
BAR = (1.04, 0.0, 0.05, 1.0)
#: Part of a map's width at either end that bears no tick where maps stand side by side.
BESIDE = 0.05
#: Decades of a colour bar up to which 2 and 5 are labelled.
LABELLED = 2.5
#: Part of an axis at the corners of a box in 3-D, where the labels of two axes meet.
CORNER = 0.06
#: Height of a box in 3-D over its side.
BOX = 0.4
#: Height of a figure in 3-D [inch].
ROW_3D = 2.75
#: Where the eye is: above the plane and around the box [°].
ELEVATION = 32.0
AZIMUTH = -58.0
#: A surface whose heights differ by less is flat [mm]; what is seen then would be round-off.
FLAT = 1e-9
#: How much paler a scar is.
SCAR = 0.55
#: Mark of a title that is ours, before its text.
OURS = "warpwear: "
#: Circles and spokes of facets of a cap.
CIRCLES, SPOKES = 36, 97
LIGHT = LightSource(azdeg=300, altdeg=50)


class Panels(Generic[Data]):
    """A figure of one panel, or of several side by side, made of a function that draws data into axes.

    Called with data it returns the figure. It can be drawn into axes that are there, over what they show.
    """

    def __init__(self, draw: Callable[[Any, Data], None], *, columns: int, height: float) -> None:
        update_wrapper(self, draw)
        self._draw, self._height = draw, height
        self.columns = columns

    def __call__(self, data: Data, ax: Any = None, *, label: str | None = None, color: Any = None) -> Figure:
        """Draw the data; returns the figure, that of `ax` where it is given: axes, or as many as columns.

        label: what the legend calls the run. color: of all its lines, which keep their dashes and marks.
        """

        def draw(axes: Any) -> None:
            there = [_There.of(panel) for panel in np.ravel(axes)]
            self._draw(axes, data)
            for held in there:
                held.finish(label, color)
            if label is not None:
                for legend in [panel.get_legend() for panel in np.ravel(axes)]:
                    if legend is not None:
                        legend.remove()
                fs.legend_above(*np.ravel(axes), columns=2)

        if ax is None:
            return fs.new_figure(draw, columns=self.columns, height=self._height, fixed=True)
        draw(ax)
        figure: Figure = np.ravel(ax)[0].figure.figure  # the outermost one
        return figure


def panels(
    columns: int = 1, *, height: float = fs.ROW
) -> Callable[[Callable[[Any, Data], None]], Panels[Data]]:
    """Make a figure of a function that draws data into axes: one, or an array of them. height: [inch]"""
    return partial(Panels, columns=columns, height=height)


@dataclass(frozen=True)
class _There:
    """What axes show before a run is drawn over it."""

    axes: Axes
    lines: list[Any]
    limits: dict[str, tuple[str, float, float]]  # "x", "y" -> scale and ends; empty where they show nothing
    title: str
    is_ours: bool

    @classmethod
    def of(cls, axes: Axes) -> "_There":
        """Look at axes, and let their limits follow what comes."""
        limits = {n: (getattr(axes, f"get_{n}scale")(), *getattr(axes, f"get_{n}lim")()) for n in "xy"}
        if not axes.has_data():
            limits.clear()
        axes.autoscale(True)
        title = axes.get_title()
        is_ours = axes.title.get_label() == OURS + title
        return cls(axes, [*axes.lines, *axes.patches], limits, title, is_ours)

    def finish(self, label: str | None, color: Any) -> None:
        """Name and colour what is new, keep what was there in sight, and say nothing that holds for one only.

        A title of ours stays where it holds for all that is shown; one of a user always stays.
        """
        new: list[Any] = [line for line in (*self.axes.lines, *self.axes.patches) if line not in self.lines]
        named = [line for line in new if not str(line.get_label()).startswith("_")]
        if color is not None:
            for line in new:
                line.set_color(color)
        if label is not None:
            for line in named:
                line.set_label(f"{label}: {line.get_label()}")
            if new and not named:  # the line of the run is the last one that is neither pale nor a point
                lines = [line for line in new if line.get_alpha() is None and len(line.get_xdata()) > 1]
                (lines or new)[-1].set_label(label)
        for axis, (scale, start, end) in self.limits.items():
            if scale == getattr(self.axes, f"get_{axis}scale")():
                ends = sorted([start, end, *getattr(self.axes, f"get_{axis}lim")()])
                getattr(self.axes, f"set_{axis}lim")(*(ends[0], ends[-1])[:: 1 if start < end else -1])
        if self.title and not self.is_ours:
            self.axes.set_title(self.title)
        else:
            if self.limits and self.axes.get_title() != self.title:
                self.axes.set_title("")
            self.axes.title.set_label(OURS + self.axes.get_title())


def share(panel: Axes, other: Axes, axis: str) -> None:
    """Give a panel the limits of another one along an axis, "x" or "y", unless they have them in common."""
    if not getattr(panel, f"get_shared_{axis}_axes")().joined(panel, other):
        getattr(panel, f"share{axis}")(other)


def map_figure(draw: Callable[[Any], None], panels: int, *, above: float = 0.0) -> Figure:
    """Lay out one panel in a column, two or three side by side, four as two by two.

    draw: gets the axes, one or an array of them. above: room for a legend [inch] a row.
    """

    def draw_and_tidy(axes: Any) -> None:
        draw(axes)
        _tidy(axes)

    if panels == 4:
        return fs.new_figure(draw_and_tidy, rows=2, columns=2, height=3.0 + above)
    height = {1: 3.0, 2: 2.9, 3: 2.0}[panels] + above
    return fs.new_figure(draw_and_tidy, columns=panels, height=height)


def _tidy(axes: Any) -> None:
    """Leave labels of axes to the panels at the left and at the bottom."""
    for panel in np.atleast_1d(axes):
        panel.label_outer()


def maps_of(
    shown: Sequence[Shown],
    draw: Callable[[Any, Shown], None],
    *,
    finish: Callable[[Any], None] = lambda figure: None,
    rows: int = 1,
) -> Figure:
    """Draw each of what is shown in a square panel of its own, which `draw` gets with it, row after row.

    finish: gets the figure, for a legend or a colour bar of all panels.
    """

    def draw_all(axes: Any) -> None:
        for panel, thing in zip(np.atleast_1d(axes), shown, strict=True):
            draw(panel, thing)
            low, high = panel.get_xlim()
            room = BESIDE * (high - low)  # for labels of two panels that meet
            panel.set_xticks([tick for tick in panel.get_xticks() if low + room < tick < high - room])
        finish(panel.figure)
        _tidy(axes)

    return fs.new_figure(draw_all, rows=rows, columns=len(shown) // rows, fixed=True, square=True)


def panels_of(axes: Any, shown: Sequence[Shown]) -> Iterator[tuple[Axes, Shown]]:
    """Give each panel with what it shows."""
    return zip(np.atleast_1d(axes), shown, strict=True)


def finish_sections(axes: Any, *, heights: bool = False) -> None:
    """Label two panels as sections along and across the sliding direction, with one vertical scale.

    heights: in µm, of which is said how many times larger than lengths they are drawn.
    """
    for panel, label in zip(axes, (ALONG, ACROSS), strict=True):
        panel.set_xlabel(label)
        panel.xaxis.set_major_locator(fs.steps(6))
    share(axes[1], axes[0], "y")
    axes[1].tick_params(which="both", labelleft=False)
    if heights and isinstance(axes[0].figure, fs.Sheet):  # the panels of others may change their shape
        axes[0].set_title(" ")  # keeps its room
        axes[0].figure.when_placed.append(partial(_tell_scale, axes[0]))


def _tell_scale(panel: Axes) -> None:
    """Say in the title how many times heights in µm are drawn larger than lengths in mm."""
    panel.set_title(f"heights drawn {fs.short(float(f'{1e3 * stretch(panel):.2g}'))} times as large")


def stretch(panel: Axes) -> float:
    """Return how many times larger a panel whose place is known draws a unit of y than one of x."""
    place, figure = panel.get_position(), panel.figure.figure
    (x0, x1), (y0, y1) = panel.get_xlim(), panel.get_ylim()
    height, width = figure.get_figheight() * place.height, figure.get_figwidth() * place.width
    return float((height / (y1 - y0)) / (width / (x1 - x0)))


def draw_map(
    axes: Axes,
    values: NDArray[Any],
    window: Window,
    colours: Any,
    label: str | None,
    *,
    low: float | None = None,
    high: float | None = None,
    norm: Normalize | None = None,
) -> Any:
    """Draw a field of shape (x, y), x to the right; with a label it gets a colour bar. Returns the image.

    low, high: ends of a linear scale; or else norm.
    """
    image = axes.imshow(
        values.T,
        origin="lower",
        extent=window.extent,
        cmap=colours,
        vmin=low,
        vmax=high,
        norm=norm,
        # Cells as they are: smoothing would invent pressures and break the categories of contact.
        interpolation="nearest",
    )
    if label is not None:
        colour_bar(axes.inset_axes(BAR), image, label)
    axes.set(xlabel=ALONG, ylabel=ACROSS)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(fs.steps(4))
    return image


def colour_bar(beside: Axes, image: Any, label: str, **kind: Any) -> None:
    """Draw the colour bar of an image into axes beside it."""
    logarithmic = isinstance(image.norm, LogNorm)
    ticks = None if logarithmic else fs.steps(5)
    bar = beside.figure.colorbar(image, cax=beside, label=label, ticks=ticks, **kind)
    if logarithmic:
        bar.ax.yaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter(fs.PlainNumbers())
        bar.ax.yaxis.set_minor_formatter(fs.PlainNumbers(minor_thresholds=(LABELLED, LABELLED)))


def shared_bar(figure: Any, image: Any, label: str, **kind: Any) -> None:
    """Draw one colour bar for all maps of a figure whose places are fixed."""
    figure.bar = figure.add_axes((0.0, 0.0, 0.1, 0.1))
    colour_bar(figure.bar, image, label, **kind)


def new_3d_figure(panels: int) -> tuple[Figure, list[Any]]:
    """Make a figure of one or two boxes, placed by hand: layouts cut off the labels of 3-D."""
    with fs.style():
        figure = fs.Sheet(figsize=(fs.COLUMN if panels == 1 else fs.PAGE, ROW_3D))
        FigureCanvasAgg(figure)
        width = 1.0 / panels
        axes = [
            figure.add_axes((i * width, 0.1, 0.92 * width, 0.76), projection="3d", computed_zorder=False)
            for i in range(panels)
        ]
    return figure, axes


def finish_3d(axes: Any, window: Window, label: str, title: str) -> None:
    """Set extents, labels and the view of a box; its z limits must be set before."""
    x0, x1, y0, y1 = window.extent
    side = max(x1 - x0, y1 - y0)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    axes.set_box_aspect(((x1 - x0) / side, (y1 - y0) / side, BOX), zoom=1.17)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    with fs.style():
        axes.set_xlabel(ALONG, labelpad=-4)
        axes.set_ylabel(ACROSS, labelpad=-4)
        axes.set_zlabel(label, labelpad=-5)
        axes.set_title(title, y=1.0, pad=7)
    for artist in axes.collections:  # the box is larger than the square that axes in 3-D keep to
        artist.set_clip_on(False)
    axes.zaxis.set_major_locator(fs.steps(3))
    for axis, low, high in ((axes.xaxis, x0, x1), (axes.yaxis, y0, y1)):
        ticks, room = fs.steps(4).tick_values(low, high), CORNER * (high - low)
        axis.set_ticks([tick for tick in ticks if low + room < tick < high - room])
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
    axes.tick_params(pad=-2.5)


def draw_surface(
    axes: Any,
    heights: FloatArray,
    window: Window,
    colour: str,
    *,
    low: float,
    high: float,
    scar: FloatArray | None = None,
    cap: bool = False,
) -> None:
    """Draw a surface of heights [mm] of shape (x, y) over a window, in µm and lit.

    low, high: heights [mm] that get the darkest and the palest shade of the colour. scar: where it is above
    0.5 the surface is pale, same shape. cap: draw the largest circle alone.
    """
    x0, x1, y0, y1 = window.extent
    nx, ny = heights.shape
    x = x0 + (np.arange(nx) + 0.5) * (x1 - x0) / nx
    y = y0 + (np.arange(ny) + 0.5) * (y1 - y0) / ny
    facets: tuple[FloatArray, ...] = (*np.meshgrid(x, y, indexing="ij"), heights)
    colours = _lit(heights, x[1] - x[0], colour, low, high)
    if scar is not None:
        worn = np.asarray(scar > 0.5)[..., None] * np.array([1.0, 1.0, 1.0, 0.0])
        colours = colours + SCAR * worn * (1.0 - colours)
    if cap:
        colours = np.stack(_on_circles(*colours.transpose(2, 0, 1)), axis=-1)
        facets = _on_circles(*facets)
    axes.plot_surface(
        facets[0],
        facets[1],
        1e3 * facets[2],
        facecolors=colours,
        shade=False,
        rcount=facets[0].shape[0],
        ccount=facets[0].shape[1],
        linewidth=0.0,
        antialiased=False,
        rasterized=True,  # thousands of facets would make a PDF slow to open
    )


def _on_circles(*fields: FloatArray) -> tuple[FloatArray, ...]:
    """Sample square fields of one shape on circles around their middle, by linear interpolation."""
    n = fields[0].shape[0]
    radius = np.linspace(0.0, 0.5 * (n - 1), CIRCLES)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, SPOKES)[None, :]
    x, y = (0.5 * (n - 1) + radius * part for part in (np.cos(angle), np.sin(angle)))
    i, j = (np.clip(at.astype(int), 0, n - 2) for at in (x, y))
    u, v = x - i, y - j
    left, right = (1.0 - u, i), (u, i + 1)
    below, above = (1.0 - v, j), (v, j + 1)
    parts = [(wx * wy, a, b) for wx, a in (left, right) for wy, b in (below, above)]
    return tuple(np.sum([weight * field[a, b] for weight, a, b in parts], axis=0) for field in fields)


def _lit(heights: FloatArray, step: float, colour: str, low: float, high: float) -> FloatArray:
    """Colour heights, shape (x, y, 4): pale where they are high, brighter where they face the light."""
    flat = high - low <= FLAT
    level = np.full(heights.shape, 0.7) if flat else np.nan_to_num((heights - low) / (high - low))
    shades = fs.shades(colour)(1.0 - 0.8 * level)
    relief = np.zeros_like(heights) if flat else np.nan_to_num(heights)
    light = LIGHT.hillshade(relief, vert_exag=3.0, dx=step, dy=step)
    shades[..., :3] *= (0.6 + 0.4 * light)[..., None]
    lit: FloatArray = np.clip(shades, 0.0, 1.0)
    return lit


def exaggeration(axes: Any, window: Window) -> float:
    """Return how many times heights drawn in µm are larger than lengths, to two digits."""
    low, high = axes.get_zlim()
    side = max(window.extent[1] - window.extent[0], window.extent[3] - window.extent[2])
    return float(f"{BOX * side / (1e-3 * (high - low)):.2g}")
