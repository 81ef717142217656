"""Figures of two scales: what load each patch carries, and what its asperities make of it."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from warpwear.figures import style as fs
from warpwear.figures.axes import draw_map
from warpwear.figures.data import FigureData, Window, positive
from warpwear.grid import FloatArray, Grid
from warpwear.laws.patches import Patches
from warpwear.models.patches.smooth import SmoothContact
from warpwear.results.file import ResultFile

#: Patches beside the one that is zoomed into, on each side.
NEIGHBOURS = 1
#: Room around the macro contact [macro cells].
ROOM = 1
NOT_COVERED = ListedColormap(["#E4E4E4"])
#: Left, bottom, width and height of a colour bar beside a map, over the map's.
BAR = (1.04, 0.0, 0.06, 1.0)


def load_share(data: FigureData) -> Figure:
    """Load of every patch over its area, above that of a smooth contact with a wear of its own."""
    result, patches = data.result, data.study.patch_layout
    rows = [data.row_of(float(result.snapshot_distances[index])) for index in data.shown]
    found = {"patches": result.load_share[rows]}
    smooth = smooth_shares(result, rows)
    if smooth is not None:
        found["smooth contact"] = smooth
    shown = _shown(patches, np.array([*found.values()]).max(axis=(0, 1)))
    columns = len(rows)

    def draw(axes: Any) -> None:
        for place, panel in enumerate(np.atleast_1d(axes)):
            line, column = divmod(place, columns)
            name, loads = [*found][line], [of[column] for of in found.values()]
            top = max(float(load.max()) for load in loads) / patches.area
            _draw_macro(panel, loads[line] / patches.area, patches, shown, top)
            if line == 0:
                title = fs.after(float(data.history["distance"][rows[column]]))
            elif data.study.patches.coupling == "load":
                title = "as prescribed"
            else:
                apart = load_share_error(loads[line], loads[0])
                title = f"{100.0 * apart:.2g} % of the load\non other patches"
            below = line == len(found) - 1 or columns == 1
            labels = {"xlabel": "x, mm" if below else "", "ylabel": f"{name}\ny, mm" if column == 0 else ""}
            panel.set(title=title, **labels)
            panel.tick_params(labelleft=column == 0, labelbottom=below)

    if columns == 1:  # beside each other
        return fs.new_figure(draw, columns=len(found), height=2.6)
    return fs.new_figure(draw, rows=len(found), columns=columns, height=0.66 * fs.PAGE / columns + 0.4)


def patch_zoom(data: FigureData) -> Figure:
    """From the load of the patches to the pressure of the cells of one that carries half of the most.

    At the first two snapshots shown: later patches are worn smooth, and the most loaded are so first. Grey is
    what no patch covers.
    """
    result, patches = data.result, data.study.patch_layout
    shown = data.shown[:2]
    rows = [data.row_of(float(result.snapshot_distances[index])) for index in shown]
    macro = _shown(patches, result.load_share[rows].max(axis=0))

    def draw(axes: Any) -> None:
        for line, (index, row) in enumerate(zip(shown, rows, strict=True)):
            share = result.load_share[row]
            half = int(np.where(share > 0.0, np.abs(share - 0.5 * share.max()), np.inf).argmin())
            snapshot = result.snapshot(index)
            pressure = snapshot.pressure
            left, middle, right = axes[3 * line : 3 * line + 3]
            carried = share / patches.area
            _draw_macro(left, carried, patches, macro, float(carried.max()))
            left.set_title(f"{fs.after(float(result.snapshot_distances[index]))}: patches")
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


def _draw_macro(axes: Any, values: FloatArray, patches: Patches, window: Window, high: float) -> None:
    """Draw pressures of the patches, (patches,), as macro cells."""
    square = values.reshape(patches.across, patches.across)
    _draw(axes, square[window.x, window.y], window, high, "load/area, MPa")


def _draw(axes: Any, values: FloatArray, window: Window, high: float, label: str) -> None:
    """Draw a map with a colour bar as high as itself."""
    image = draw_map(axes, positive(values), window, fs.PRESSURES, None, low=0.0, high=high)
    axes.figure.colorbar(image, cax=axes.inset_axes(BAR), label=label, ticks=MaxNLocator(4))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(3))


def _shown(patches: Patches, carried: FloatArray) -> Window:
    """Find the macro cells around the middle that ever carry something, and some room."""
    across = patches.across
    square = carried.reshape(across, across) > 0.0
    places = np.abs(np.arange(across) - 0.5 * (across - 1))
    reach = max(float(places[square.any(axis=axis)].max(initial=0.0)) for axis in (0, 1)) + ROOM
    first = max(math.floor(0.5 * (across - 1) - reach), 0)
    part = slice(first, across - first)
    return Window.of(Grid(across, across, patches.pitch * patches.domain.cell), part, part)


def _around(patches: Patches, patch: int, neighbours: int) -> Window:
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


def load_share_error(shares: FloatArray, others: FloatArray) -> float:
    """Return ½ Σ|ΔF_k| / F: the part of the load that two distributions put on different patches."""
    return float(0.5 * np.abs(shares - others).sum() / others.sum())


def smooth_shares(result: ResultFile, rows: Sequence[int]) -> FloatArray | None:
    """Return the loads [N] that a smooth macro contact with a wear of its own would give the patches.

    rows: of the history; the loads have the shape (rows, patches). None where the study has no bulk stiffness
    K_N: its elastic constants are not known.
    """
    study = result.study
    if isinstance(study.contact.bulk_stiffness, str) and study.hertz is None:
        return None
    smooth = SmoothContact(study.contact_task, study.patch_layout)
    found: dict[int, FloatArray] = {}
    slid = 0.0
    for row, increment in enumerate(result.history["increment"][: max(rows) + 1]):
        removal = sum(law.removal(slid, float(increment)) for law in study.wear_laws)
        pressure = smooth.press(foundation=study.bulk_stiffness(), removal=removal)
        slid += float(increment)
        if row in rows:
            found[row] = smooth.area * pressure
    return np.array([found[row] for row in rows])
