"""Paint maps with Matplotlib: fields, states, outlines, and bodies seen from above."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, ListedColormap, LogNorm, Normalize
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from warpwear.figures import describe, style
from warpwear.figures.coarse import coarsen
from warpwear.figures.describe import Ends, Map
from warpwear.figures.paint_chart import DASHES, paint_level
from warpwear.grid import FloatArray

#: Points along a side from which lines of equal height are drawn.
CONTOURED = 60
HIDDEN = ListedColormap(["#E4E4E4"])
#: Light from the upper left on bodies seen from above; how much steeper slopes look.
LIGHT, STEEPER = LightSource(azdeg=315.0, altdeg=45.0), 4.0


def paint_map(axes: Axes, field: Map) -> None:
    """Draw a map of one field into axes, x to the right."""
    values, ends = field.fields[0], field.extent
    colours, norm = _colours(field)
    if field.lit:
        step = 1e3 * (ends[1] - ends[0]) / values.shape[0]
        filled = np.where(np.isfinite(values), values, np.nanmin(values)).T
        lit = LIGHT.shade(filled, colours, norm, blend_mode="soft", vert_exag=STEEPER, dx=step, dy=step)
        axes.imshow(lit, origin="lower", extent=ends)
    # Cells as they are: smoothing would invent pressures and break the categories of contact.
    kind: Any = {"origin": "lower", "extent": ends, "interpolation": "nearest"}
    if field.hidden is not None:
        axes.imshow(np.where(field.hidden, 1.0, np.nan).T, cmap=HIDDEN, **kind)
    axes.imshow(values.T, cmap=colours, norm=norm, visible=not field.lit, **kind)
    if field.contours:  # where they lie far apart what the map shows is flat
        coarse, _ = coarsen(np.nan_to_num(values, nan=field.scale.low), CONTOURED)
        levels = MaxNLocator(field.contours).tick_values(field.scale.low, field.scale.high)
        thin: Any = {"colors": "black", "linewidths": 0.4, "linestyles": "-", "alpha": 0.7}
        axes.contour(*_middles(coarse, ends), coarse.T, levels=levels, **thin)
    if field.hatched is not None:
        hatches: Any = {"levels": [0.5, 1.5], "colors": ["0.8"], "alpha": 0.6, "hatches": ["//////"]}
        axes.contourf(*_edged(field.hatched, ends), **hatches)
    for region, look in field.regions:
        edge: Any = {"colors": [look.colour], "linewidths": look.width, "linestyles": DASHES[look.dash]}
        axes.contour(*_edged(region, ends), levels=[0.5], **edge)
    axes.set(xlim=ends[:2], ylim=ends[2:])
    for x0, x1, y0, y1 in field.frames:
        axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, ec=describe.DISC, lw=1.0))
    for level in field.levels:
        paint_level(axes, level)
    axes.set(xlabel=field.x, ylabel=field.y)
    title = "\n".join(filter(None, [*field.labels, *field.notes]))
    axes.set_title(title or (" " if field.stretch_note else ""))
    for axis, most in ((axes.xaxis, 4 if field.square else 8), (axes.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))
    if not field.square:
        axes.set_aspect("auto")


def _middles(cells: NDArray[Any], ends: Ends, beyond: int = 0) -> list[FloatArray]:
    """Return x and y [mm] of the middles of cells (nx, ny) in an extent, and of some `beyond` either end."""
    sides = zip(cells.shape, ends[::2], ends[1::2], strict=True)
    return [a + (np.arange(-beyond, n + beyond) + 0.5) * (b - a) / n for n, a, b in sides]


def _edged(region: NDArray[np.bool_], ends: Ends) -> tuple[FloatArray, ...]:
    """Return places and values of a region to draw, a cell beyond the rim, which would cut it in half."""
    return *_middles(region, ends, 1), np.pad(region, 1, mode="edge").astype(np.float64).T


def _colours(field: Map) -> tuple[Any, Normalize]:
    """Choose colours and scale of a map."""
    states, scale = field.states, field.scale
    if states:
        return ListedColormap([colour for _, colour in states]), Normalize(-0.5, len(states) - 0.5)
    return style.COLOURS[scale.colours], (LogNorm if scale.log else Normalize)(scale.low, scale.high)
