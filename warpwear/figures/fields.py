"""Figures of fields over the domain: pressure and state of contact, as maps, in 3-D and along lines."""

from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS, ALONG, draw_map, finish_3d, map_figure, new_3d_figure, panels_of
from warpwear.figures.data import FigureData, State
from warpwear.grid import FloatArray

STATES = {
    State.UNTOUCHED: ("never touched", "#FFFFFF"),
    State.TOUCHED: ("touched before", fs.TOUCHED),
    State.IN_CONTACT: ("in contact", fs.CONTACT),
    State.AT_HARDNESS: ("at hardness", fs.HARDNESS),
}
#: Pressures that scatter by less than this part of their mean count as one.
UNIFORM = 0.1
#: Bars along a side.
BARS = 45


def pressure_map(data: FigureData) -> Figure:
    """Pressure on the cells in contact at the snapshots, with its mean ± standard deviation."""
    views = data.views

    def draw(axes: Any) -> None:
        for panel, view in panels_of(axes, views):
            pressure = np.where(view.pressure > 0.0, view.pressure, np.nan)
            mean, scatter = (float(data.history[f"pressure_{n}"][view.row]) for n in ("mean", "std"))
            top = float(data.history["pressure_max"][view.row])
            # A uniform pressure gets the middle of the colours; their end is for the hardness.
            if scatter < UNIFORM * mean and not (view.state == State.AT_HARDNESS).any():
                top *= 2.0
            draw_map(panel, pressure, data.window, fs.PRESSURES, "pressure, MPa", low=0.0, high=top)
            panel.set_title(f"{fs.after(view.distance)}\n{fs.with_scatter(mean, scatter)} MPa")

    return map_figure(draw, len(views))


def pressure_3d(data: FigureData) -> Figure:
    """Load over area on coarse squares at the first and the last snapshot, as bars."""
    views = [data.view(index) for index in sorted({data.shown[0], data.shown[-1]})]
    figure, panels = new_3d_figure(len(views))
    for axes, view in zip(panels, views, strict=True):
        pressure, side = _coarse(view.pressure_mean, data)
        x, y = np.nonzero(pressure)
        values = pressure[x, y]
        colours = fs.PRESSURES(0.15 + 0.7 * values / values.max())
        left, bottom = data.window.extent[0], data.window.extent[2]
        axes.bar3d(left + side * x, bottom + side * y, 0.0, side, side, values, color=colours, linewidth=0.0)
        axes.set_zlim(0.0, 1.15 * values.max())
        title = f"{fs.after(view.distance)}\nload over area, {1e3 * side:.3g} µm squares"
        finish_3d(axes, data.window, "pressure, MPa", title)
    return figure


def _coarse(field: FloatArray, data: FigureData) -> tuple[FloatArray, float]:
    """Means over squares that 3-D can show, and the squares' side [mm]."""
    n = -(-max(field.shape) // BARS)
    nx, ny = field.shape[0] // n, field.shape[1] // n
    coarse: FloatArray = field[: nx * n, : ny * n].reshape(nx, n, ny, n).mean(axis=(1, 3))
    return coarse, n * data.window.factor * data.study.grid.cell


def pressure_profiles(data: FigureData) -> Figure:
    """Pressure along and across the sliding direction in the middle, all snapshots overlaid."""
    views = data.views
    everything = np.concatenate([p.pressure for v in views for p in (v.along, v.across)])
    tops = [max(v.along.pressure.max(), v.across.pressure.max()) for v in views]
    tops = [top for top in tops if top > 0.0]

    def draw(axes: Any) -> None:
        logarithmic = bool(tops) and max(tops) > 5.0 * min(tops)
        for view, line in zip(views, fs.in_time(fs.CONTACT, len(views)), strict=True):
            for panel, profile in zip(axes, (view.along, view.across), strict=True):
                panel.plot(profile.bins, profile.pressure, label=fs.after(view.distance), **line)
        for panel, label in zip(axes, (ALONG, ACROSS), strict=True):
            panel.set_xlabel(label)
            panel.xaxis.set_major_locator(MaxNLocator(6))
            if logarithmic:
                fs.logarithmic(panel)
                panel.set_ylim(0.2 * min(tops), 1.5 * max(tops))
            else:
                panel.set_ylim(0.0, 1.15 * float(everything.max()) or None)
        axes[1].sharey(axes[0])
        axes[0].set_ylabel(f"mean pressure, middle {1e3 * data.strip:.3g} µm, MPa")
        axes[1].tick_params(which="both", labelleft=False)
        fs.legend_above(axes[0], columns=4)

    return fs.new_figure(draw, columns=2)


def contact_map(data: FigureData) -> Figure:
    """What each cell does at the snapshots: in contact, at the hardness, touched before or never."""
    views = data.views
    colours = ListedColormap([colour for _, colour in STATES.values()])

    def draw(axes: Any) -> None:
        present: set[float] = set()
        for panel, view in panels_of(axes, views):
            draw_map(panel, view.state, data.window, colours, None, low=-0.5, high=3.5)
            present |= set(np.unique(view.state))
            area = float(data.history["area_contact"][view.row])
            panel.set_title(f"{fs.after(view.distance)}\n{area:.3g} mm² in contact")
            figure = panel.figure
        handles = [
            Patch(facecolor=colour, edgecolor="#777777", lw=0.5, label=label)
            for state, (label, colour) in STATES.items()
            if state in present
        ]
        columns = 4 if len(views) > 1 else 2
        figure.legend(handles=handles, loc="outside upper center", ncols=columns)

    return map_figure(draw, len(views), above=0.25)
