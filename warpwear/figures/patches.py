"""Figures of two scales: what load each patch carries, and what its asperities make of it."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from warpwear.figures import style as fs
from warpwear.figures.axes import draw_map, maps_of, shared_bar
from warpwear.figures.fields import pressure_scale
from warpwear.figures.view import Window, positive
from warpwear.grid import FloatArray

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData
    from warpwear.laws.patches import Patches

#: Patches beside the one that is zoomed into, on each side.
NEIGHBOURS = 1
NOT_COVERED = ListedColormap(["#E4E4E4"])


def load_share(data: "FigureData") -> Figure:
    """Load of every patch over its area, above that of a smooth contact with a wear of its own."""
    loads, columns = data.loads, len(data.distances)
    fields = [field for of in loads.of.values() for field in of]
    norm = pressure_scale(fields, [float(field[field > 0.0].mean()) for field in fields])

    def draw(panel: Any, place: int) -> None:
        line, column = divmod(place, columns)
        name = [*loads.of][line]
        draw_map(panel, positive(loads.of[name][column]), loads.window, fs.PRESSURES, None, norm=norm)
        if line == 0:
            title = f"{name}\n{fs.after(data.distances[column])}"
        elif loads.prescribed:
            title = f"{name}\nprescribes them"
        else:
            title = f"{name}: {100.0 * loads.apart[column]:.2g} %\nof the load elsewhere"
        panel.set_title(title)

    def bar(figure: Any) -> None:
        below = "min" if isinstance(norm, LogNorm) else "neither"
        shared_bar(figure, figure.axes[0].images[0], "load over area, MPa", extend=below)

    rows = 1 if columns == 1 else len(loads.of)
    return maps_of([*range(len(fields))], draw, finish=bar, rows=rows)


def patch_zoom(data: "FigureData") -> Figure:
    """From the load of the patches to the pressure of the cells of one that carries half of the most.

    At the first two snapshots shown: later patches are worn smooth, and the most loaded are so first. Grey is
    what no patch covers.
    """
    result, patches = data.result, data.study.patch_layout
    shown = data.shown[:2]
    macro, size = data.loads.window, (patches.across, patches.across)

    def draw(axes: Any) -> None:
        for line, index in enumerate(shown):
            snapshot = data.snapshot(index)
            share = result.load_share[data.row_of(snapshot.distance)]
            half = int(np.where(share > 0.0, np.abs(share - 0.5 * share.max()), np.inf).argmin())
            pressure = snapshot.pressure
            left, middle, right = axes[3 * line : 3 * line + 3]
            carried = (share / patches.area).reshape(size)[macro.x, macro.y]
            _draw(left, carried, macro, float(carried.max()), "load/area, MPa")
            left.set_title(f"{fs.after(snapshot.distance)}: patches")
            near, alone = (_around(patches, half, neighbours) for neighbours in (NEIGHBOURS, 0))
            top = float(pressure[near.x, near.y].max())
            for panel, window, title in (
                (middle, near, "around one of them"),
                (right, alone, f"this patch: {share[half]:.3g} N"),
            ):
                beside = np.where(np.isnan(snapshot.gap[window.x, window.y]), 1.0, np.nan)
                draw_map(panel, beside, window, NOT_COVERED, None)
                _draw(panel, pressure[window.x, window.y], window, top, "pressure, MPa")
                panel.set_title(title)
            _frame(left, near)
            _frame(middle, alone)

    return fs.new_figure(draw, rows=len(shown), columns=3, height=2.0)


def _draw(axes: Any, values: FloatArray, window: Window, high: float, label: str) -> None:
    """Draw a map with a colour bar as high as itself."""
    draw_map(axes, positive(values), window, fs.PRESSURES, label, low=0.0, high=high)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(fs.steps(3))


def _around(patches: "Patches", patch: int, neighbours: int) -> Window:
    """Find the cells of a patch, or with neighbours of its macro cell and those beside it."""
    starts, pitch = (int(patches.first_row[patch]), int(patches.first_column[patch])), patches.pitch
    parts = [slice(start, start + patches.side) for start in starts]
    if neighbours:
        places = divmod(patch, patches.across)
        ends = [(max(at - neighbours, 0), min(at + neighbours + 1, patches.across)) for at in places]
        parts = [slice(low * pitch, high * pitch) for low, high in ends]
    return Window.of(patches.domain, parts[0], parts[1])


def _frame(axes: Any, window: Window) -> None:
    x0, x1, y0, y1 = window.extent
    axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, ec=fs.DISC, lw=1.0))
