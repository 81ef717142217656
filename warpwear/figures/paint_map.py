"""Paint maps with Matplotlib: fields, states, outlines, and bodies seen from above."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, ListedColormap, LogNorm, Normalize
from matplotlib.patches import Ellipse, Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from warpwear.figures import style
from warpwear.figures.coarse import coarsen
from warpwear.figures.describe import Map
from warpwear.figures.paint_chart import DASHES, paint_level

#: Points along a side from which lines of equal height are drawn.
CONTOURED = 60
HIDDEN = ListedColormap(["#E4E4E4"])
#: Light from the upper left on bodies seen from above; how much steeper slopes look.
LIGHT, STEEPER = LightSource(azdeg=315.0, altdeg=45.0), 4.0


def paint_map(axes: Axes, field: Map) -> Any:
    """Draw a map of one field into axes, x to the right; returns the image."""
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
    image = axes.imshow(values.T, cmap=colours, norm=norm, visible=not field.lit, **kind)
    if field.contours:
        _contours(axes, field)
    if field.hatched is not None:
        hatches: Any = {"levels": [0.5, 1.5], "colors": ["0.8"], "alpha": 0.6, "hatches": ["//////"]}
        _on_pixels(axes, field, field.hatched, **hatches)
    for region, look in field.regions:
        edge: Any = {"colors": [look.colour], "linewidths": look.width, "linestyles": DASHES[look.dash]}
        _on_pixels(axes, field, region, levels=[0.5], **edge)
    for outline in field.outlines:
        (x0, x1, y0, y1), look = outline.ends, outline.look
        line: Any = {"fill": False, "ec": look.colour, "lw": look.width, "ls": DASHES[look.dash]}
        middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
        round_one = Ellipse(middle, x1 - x0, y1 - y0, **line)
        axes.add_patch(round_one if outline.round else Rectangle((x0, y0), x1 - x0, y1 - y0, **line))
    for level in field.levels:
        paint_level(axes, level)
    axes.set(xlabel=field.x, ylabel=field.y)
    title = "\n".join(filter(None, [*field.labels, *field.notes]))
    axes.set_title(title or (" " if field.stretch_note else ""))
    for axis, most in ((axes.xaxis, 4 if field.square else 8), (axes.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))
    if not field.square:
        axes.set_aspect("auto")
    return image


def _on_pixels(axes: Axes, field: Map, region: NDArray[np.bool_], **how: Any) -> None:
    """Draw a region of cells, filled where it has hatches, else its outline; shape (nx, ny)."""
    (nx, ny), (x0, x1, y0, y1) = region.shape, field.extent
    edged = np.pad(region, 1, mode="edge").astype(np.float64)  # or what lies at the rim would be cut in half
    x, y = (a + (np.arange(n + 2) - 0.5) * (b - a) / n for n, a, b in ((nx, x0, x1), (ny, y0, y1)))
    (axes.contourf if "hatches" in how else axes.contour)(x, y, edged.T, **how)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))


def _colours(field: Map) -> tuple[Any, Normalize]:
    """Choose colours and scale of a map."""
    states, scale = field.states, field.scale
    if states:
        return ListedColormap([colour for _, colour in states]), Normalize(-0.5, len(states) - 0.5)
    return style.COLOURS[scale.colours], (LogNorm if scale.log else Normalize)(scale.low, scale.high)


def _contours(axes: Axes, field: Map) -> None:
    """Draw lines of equal value over a map: where they lie far apart what it shows is flat."""
    values, (x0, x1, y0, y1) = field.fields[0], field.extent
    coarse, _ = coarsen(np.nan_to_num(values, nan=field.scale.low), CONTOURED)
    nx, ny = coarse.shape
    x, y = np.linspace(x0, x1, 2 * nx + 1)[1::2], np.linspace(y0, y1, 2 * ny + 1)[1::2]
    levels = MaxNLocator(field.contours).tick_values(field.scale.low, field.scale.high)
    kind: Any = {"colors": "black", "linewidths": 0.4, "linestyles": "-", "alpha": 0.7}
    axes.contour(x, y, coarse.T, levels=levels, **kind)
