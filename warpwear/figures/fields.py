"""Figures of fields over the domain: pressure and state of contact, as maps, in 3-D and along lines."""

from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from warpwear.figures import style as fs
from warpwear.figures.axes import draw_map, finish_3d, finish_sections, maps_of, new_3d_figure
from warpwear.figures.data import FigureData, State, View, coarsen, positive

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

    def draw(panel: Any, view: View) -> None:
        mean, scatter = data.pressure_at(view.row)
        top = float(data.history["pressure_max"][view.row])
        # A uniform pressure gets the middle of the colours; their end is for the hardness.
        if scatter < UNIFORM * mean and not (view.state == State.AT_HARDNESS).any():
            top *= 2.0
        pressure = positive(view.pressure)
        draw_map(panel, pressure, data.window, fs.PRESSURES, "pressure, MPa", low=0.0, high=top)
        panel.set_title(f"{fs.after(view.distance)}\n{fs.with_scatter(mean, scatter)} MPa")

    return maps_of(data.views, draw)


def pressure_3d(data: FigureData) -> Figure:
    """Load over area on coarse squares at the first and the last snapshot, as bars."""
    views = [data.view(index) for index in sorted({data.shown[0], data.shown[-1]})]
    figure, panels = new_3d_figure(len(views))
    for axes, view in zip(panels, views, strict=True):
        pressure, blocks = coarsen(view.pressure_mean, BARS)
        side = blocks * data.window.factor * data.study.grid.cell
        x, y = np.nonzero(pressure)
        values = pressure[x, y]
        colours = fs.PRESSURES(0.15 + 0.7 * values / values.max())
        left, bottom = data.window.extent[0], data.window.extent[2]
        axes.bar3d(left + side * x, bottom + side * y, 0.0, side, side, values, color=colours, linewidth=0.0)
        axes.set_zlim(0.0, 1.15 * values.max())
        title = f"{fs.after(view.distance)}\nload over area, {1e3 * side:.3g} µm squares"
        finish_3d(axes, data.window, "pressure, MPa", title)
    return figure


@fs.panels(2)
def pressure_profiles(axes: Any, data: FigureData) -> None:
    """Pressure along and across the sliding direction in the middle, all snapshots overlaid."""
    views = data.views
    tops = [float(max(v.along.pressure.max(), v.across.pressure.max())) for v in views]
    seen = [top for top in tops if top > 0.0]
    for view, line in zip(views, fs.in_time(fs.CONTACT, len(views)), strict=True):
        for panel, profile in zip(axes, (view.along, view.across), strict=True):
            panel.plot(profile.bins, profile.pressure, label=fs.after(view.distance), **line)
    for panel in axes:
        if seen and max(seen) > 5.0 * min(seen):
            fs.logarithmic(panel)
            panel.set_ylim(0.2 * min(seen), 1.5 * max(seen))
        else:
            panel.set_ylim(0.0, 1.15 * max(tops) or None)
    finish_sections(axes)
    axes[0].set_ylabel(f"mean pressure, middle {1e3 * data.strip:.3g} µm, MPa")
    fs.legend_above(axes[0], columns=4)


def contact_map(data: FigureData) -> Figure:
    """What each cell does at the snapshots: in contact, at the hardness, touched before or never."""
    views = data.views
    colours = ListedColormap([colour for _, colour in STATES.values()])
    present = {state for view in views for state in np.unique(view.state)}
    handles = [
        Patch(facecolor=colour, edgecolor="#777777", lw=0.5, label=label)
        for state, (label, colour) in STATES.items()
        if state in present
    ]

    def draw(panel: Any, view: View) -> None:
        draw_map(panel, view.state, data.window, colours, None, low=-0.5, high=3.5)
        area = float(data.history["area_contact"][view.row])
        panel.set_title(f"{fs.after(view.distance)}\n{area:.3g} mm² in contact")

    figure = maps_of(views, draw, above=0.25)
    with fs.style():
        figure.legend(handles=handles, loc="outside upper center", ncols=4 if len(views) > 1 else 2)
    return figure
