"""Matplotlib's painter of what is no line and no map: boxes in three dimensions, bars, grids, texts."""

import textwrap
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]

from warpwear import lazy
from warpwear.figures import describe, style
from warpwear.figures.describe import ACROSS, ALONG, Arrow, Bars, Box, Glass, HeatMap, Relief, Text, Towers
from warpwear.grid import FloatArray

ndimage = lazy.module("scipy.ndimage")

#: Part of an axis at the corners of a box in 3-D, where the labels of two axes meet.
CORNER = 0.06
#: Height of a box in 3-D over its side.
HEIGHT = 0.4
#: Where the eye is: above the plane and around the box [°].
ELEVATION, AZIMUTH = 32.0, -58.0
#: A surface whose heights differ by less is flat [µm]; what is seen then would be round-off.
FLAT = 1e-6
#: How much paler a scar is.
SCAR = 0.55
#: Circles and spokes of facets of a cap.
CIRCLES, SPOKES = 36, 97
LIGHT = LightSource(azdeg=300, altdeg=50)
#: Width over length of a box at least, as it is drawn.
NARROW = 0.85
#: Most values of a grid that are written into it.
WRITTEN = 49
#: Characters of a line of text, where it begins behind its label, and its height [points].
LINE, INDENT, HIGH = 56, 44.0, 10.0


def paint_box(axes: Any, box: Box) -> None:
    """Draw a box into axes of three dimensions."""
    x0, x1, y0, y1 = box.extent
    side = max(x1 - x0, y1 - y0)
    width = max(y1 - y0, NARROW * (x1 - x0))
    axes.set_zlim(box.low, box.high)
    for part in box.parts:
        if not isinstance(part, Arrow):
            PARTS[type(part)](axes, part, box.extent)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), zlim=(box.low, box.high))
    axes.set_box_aspect(((x1 - x0) / side, width / side, HEIGHT), zoom=1.17)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    axes.set_xlabel(ALONG, labelpad=-4)
    axes.set_ylabel(ACROSS, labelpad=-4)
    axes.set_zlabel(box.label, labelpad=-5)
    larger = float(f"{HEIGHT * side / (1e-3 * (box.high - box.low)):.2g}")
    stretched = f" (y {width / (y1 - y0):.2g} times)" if width > y1 - y0 else ""
    axes.set_title(box.note.format(larger=f"{larger:g}") + stretched, y=1.0, pad=7)
    for artist in axes.collections:  # the box is larger than the square that axes in 3-D keep to
        artist.set_clip_on(False)
    axes.zaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
    axes.set(xticks=style.inner_ticks((x0, x1), CORNER), yticks=style.inner_ticks((y0, y1), CORNER))
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
    axes.tick_params(pad=-2.5)
    for part in box.parts:
        if isinstance(part, Arrow):
            _arrow(axes, part, y0)


def _arrow(axes: Any, arrow: Arrow, y: float) -> None:
    """Draw an arrow along +x over the near edge, where nothing hides it; the view is final."""
    places = ([arrow.start, arrow.end], [y, y], [arrow.height, arrow.height])
    (x0, x1), (y0, y1), _ = proj3d.proj_transform(*places, axes.get_proj())
    look = {"arrowstyle": "-|>", "color": "black", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x1, y1), (x0, y0), arrowprops=look, zorder=20)
    paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
    axes.annotate(arrow.text, (x0, y0), ha="right", va="bottom", fontsize=7, bbox=paper, zorder=21)


def _glass(axes: Any, glass: Glass, _: Any) -> None:
    # It lies over all else: its order of drawing is known, so it is not left to be guessed.
    grid = np.meshgrid(glass.x, glass.y, indexing="ij")
    kind: Any = {"color": glass.colour, "linewidth": 0.0, "shade": False}
    axes.plot_surface(*grid, glass.heights, alpha=0.3, zorder=5, **kind)
    axes.plot_wireframe(*grid, glass.heights, rstride=6, cstride=6, color=glass.colour, lw=0.4, zorder=6)
    edge = np.full(glass.x.size, glass.y[0])
    axes.plot(glass.x, edge, glass.heights[:, 0], color=glass.colour, lw=1.4, zorder=7)


def _towers(axes: Any, towers: Towers, _: Any) -> None:
    scale = towers.scale
    norm = (LogNorm if scale.log else Normalize)(scale.low, scale.high)
    x, y = np.nonzero(towers.values)
    values = towers.values[x, y]
    colours = style.COLOURS[scale.colours](norm(values).filled(0.0))
    left, bottom, side = *towers.corner, towers.side
    axes.bar3d(left + side * x, bottom + side * y, 0.0, side, side, values, color=colours, linewidth=0.0)


def _surface(axes: Any, surface: Relief, extent: describe.Ends) -> None:
    """Draw heights over the extent, lit; as many facets as places."""
    x0, x1, y0, y1 = extent
    nx, ny = surface.heights.shape
    x = x0 + (np.arange(nx) + 0.5) * (x1 - x0) / nx
    y = y0 + (np.arange(ny) + 0.5) * (y1 - y0) / ny
    facets: tuple[FloatArray, ...] = (*np.meshgrid(x, y, indexing="ij"), surface.heights)
    colours = _lit(surface, x[1] - x[0])
    if surface.scar is not None:
        worn = np.asarray(surface.scar > 0.5)[..., None] * np.array([1.0, 1.0, 1.0, 0.0])
        colours = colours + SCAR * worn * (1.0 - colours)
    if surface.cap:
        colours = np.stack(_on_circles(*colours.transpose(2, 0, 1)), axis=-1)
        facets = _on_circles(*facets)
    count = dict(zip(("rcount", "ccount"), facets[0].shape, strict=True))
    # thousands of facets would make a PDF slow to open
    kind: Any = {"shade": False, "linewidth": 0.0, "antialiased": False, "rasterized": True}
    axes.plot_surface(*facets, facecolors=colours, **count, **kind)


def _on_circles(*fields: FloatArray) -> tuple[FloatArray, ...]:
    """Sample square fields of one shape on circles around their middle, by linear interpolation."""
    middle = 0.5 * (fields[0].shape[0] - 1)
    radius, angle = np.linspace(0.0, middle, CIRCLES)[:, None], np.linspace(0.0, 2.0 * np.pi, SPOKES)
    places = middle + radius * np.cos(angle), middle + radius * np.sin(angle)
    return tuple(ndimage.map_coordinates(field, places, order=1, mode="nearest") for field in fields)


def _lit(surface: Relief, step: float) -> FloatArray:
    """Colour heights, shape (x, y, 4): pale where they are high, brighter where they face the light."""
    heights, low, high = surface.heights, surface.low, surface.high
    flat = high - low <= FLAT
    level = np.full(heights.shape, 0.7) if flat else np.nan_to_num((heights - low) / (high - low))
    colours = LinearSegmentedColormap.from_list(
        "shades", [describe.shade(surface.colour, place) for place in (0.0, 0.5, 1.0)]
    )
    shades = colours(1.0 - 0.8 * level)
    relief = np.zeros_like(heights) if flat else 1e-3 * np.nan_to_num(heights)
    light = LIGHT.hillshade(relief, vert_exag=3.0, dx=step, dy=step)
    shades[..., :3] *= (0.6 + 0.4 * light)[..., None]
    return np.clip(shades, 0.0, 1.0)


PARTS: dict[type, Callable[..., None]] = {Glass: _glass, Towers: _towers, Relief: _surface}


def paint_bars(axes: Axes, bars: Bars) -> None:
    """Draw bars, with their intervals and dots, or their values behind them."""
    places = np.arange(len(bars.names))
    drawn = axes.barh(-places, bars.values, color=[*bars.colours])
    for place in places:
        if bars.ends is not None:
            axes.plot(bars.ends[:, place], [-place, -place], color=describe.HARDNESS, lw=1.0)
        if bars.dots is not None:
            axes.plot(bars.dots[place], -place, "o", color=describe.SUM, ms=4)
    if bars.written:
        axes.bar_label(drawn, [bars.written.format(v) for v in bars.values], fontsize=7, padding=2)
        axes.margins(x=0.25)
    axes.set_yticks(-places, bars.names)
    axes.set_xlabel(bars.axis.label)
    axes.set_xlim(bars.axis.low, bars.axis.high)
    axes.axvline(0.0, color=describe.HARDNESS, lw=0.6)
    axes.set_title(bars.title)


def paint_grid(axes: Axes, grid: HeatMap) -> None:
    """Draw a value for each pair, written into it where there are few."""
    image = axes.imshow(grid.values.T, origin="lower", aspect="auto", cmap=style.COLOURS["heights"])
    axes.set_xticks(range(len(grid.across)), grid.across)
    axes.set_yticks(range(len(grid.down)), grid.down)
    axes.set(xlabel=grid.x, ylabel=grid.y)
    middle = 0.5 * (np.nanmin(grid.values) + np.nanmax(grid.values))
    for (x, y), value in np.ndenumerate(grid.values) if grid.values.size <= WRITTEN else ():
        text = f"{value:#.3g}" if np.isfinite(value) else "–"
        colour = "white" if value < middle else "black"
        axes.text(x, y, text, ha="center", va="center", color=colour, fontsize=7)
    axes.figure.colorbar(image, ax=axes, label=grid.unit)


def paint_text(axes: Axes, text: Text) -> None:
    """Write rows of label and text, from the top down."""
    axes.set_axis_off()
    how: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "fontsize": 7}
    down = 0.0
    for label, words in text.rows:
        for number, line in enumerate(textwrap.wrap(words, LINE)):
            down -= HIGH
            parts = ((0.0, "" if number else label, describe.NEUTRAL), (INDENT, line, "black"))
            for place, part, colour in parts:
                written = axes.annotate(part, (0.0, 1.0), (place, down), color=colour, **how)
                written.set_in_layout(False)
                written.set_annotation_clip(False)


PAINT_OTHERS: dict[type, Callable[..., None]] = {Bars: paint_bars, HeatMap: paint_grid, Text: paint_text}
