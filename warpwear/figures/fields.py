"""Figures of fields: pressure, state of contact, sliding distance; as maps, in 3-D, as lines."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from warpwear.figures import style as fs
from warpwear.figures.axes import (
    ACROSS,
    ALONG,
    draw_map,
    finish_3d,
    finish_sections,
    maps_of,
    new_3d_figure,
    panels,
    shared_bar,
)
from warpwear.figures.view import FilmState, State, View, coarsen, positive
from warpwear.grid import FloatArray
from warpwear.laws.archard import distance_factor

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

STATES = {
    State.UNTOUCHED: ("never touched", "#FFFFFF"),
    State.TOUCHED: ("touched before", fs.TOUCHED),
    State.IN_CONTACT: ("in contact", fs.CONTACT),
    State.AT_HARDNESS: ("at hardness", fs.HARDNESS),
}
FILMS = {
    FilmState.ELSEWHERE: ("neither bare nor in contact", "#FFFFFF"),
    FilmState.BARE_BESIDE: ("bare, not in contact", "#DDDDDD"),
    FilmState.ON_FILM: ("in contact on film", fs.TOUCHED),
    FilmState.ON_METAL: ("in contact, bare", fs.DISC),
}
#: Pressures over more than this many times the lowest mean are drawn on a logarithmic scale.
WIDE = 5.0
#: Percentage of places whose pressure may lie below a logarithmic scale, and its largest span.
BELOW, SPAN = 2.0, 1e3
#: Bars along a side.
BARS = 45
#: Half the width shown over the wider of two contacts.
MARGIN = 1.3


def pressure_scale(fields: Sequence[FloatArray], means: Sequence[float]) -> Normalize:
    """Choose one scale for pressures: logarithmic where they span much, else linear from 0.

    fields: [MPa], of any shape, 0 where there is no contact; means: of the pressure in contact of each [MPa].
    """
    most = max(float(field.max()) for field in fields)
    if most <= WIDE * min(means):
        return Normalize(0.0, most or 1.0)
    low = min(float(np.percentile(field[field > 0.0], BELOW)) for field in fields if field.any())
    return LogNorm(max(0.8 * low, most / SPAN), most)


def pressure_map(data: "FigureData") -> Figure:
    """Pressure on the cells in contact at the snapshots, all on one scale, with its mean ± deviation."""
    means, scatter = (data.history[name] for name in ("pressure_mean", "pressure_std"))
    norm = pressure_scale([view.pressure for view in data.views], [means[view.row] for view in data.views])

    def draw(panel: Any, view: View) -> None:
        draw_map(panel, positive(view.pressure), data.window, fs.PRESSURES, None, norm=norm)
        told = fs.with_scatter(float(means[view.row]), float(scatter[view.row]))
        panel.set_title(f"{fs.after(view.distance)}\n{told} MPa")

    def bar(figure: Any) -> None:
        below = "min" if isinstance(norm, LogNorm) else "neither"
        shared_bar(figure, figure.axes[0].images[0], "pressure in contact, MPa", extend=below)

    return maps_of(data.views, draw, finish=bar)


def pressure_3d(data: "FigureData") -> Figure:
    """Load over area on coarse squares at the first and the last snapshot, as bars."""
    shown = sorted({data.shown[0], data.shown[-1]})
    figure, panels = new_3d_figure(len(shown))
    fields = [coarsen(data.window.means(data.snapshot(index).pressure), BARS) for index in shown]
    # The axes differ, as the pressures do; the colours are of one scale.
    norm = pressure_scale([field for field, _ in fields], [field[field > 0.0].mean() for field, _ in fields])
    for axes, index, (pressure, blocks) in zip(panels, shown, fields, strict=True):
        snapshot = data.snapshot(index)
        side = blocks * data.window.factor * data.about.cell
        x, y = np.nonzero(pressure)
        values = pressure[x, y]
        colours = fs.PRESSURES(norm(values).filled(0.0))
        left, bottom = data.window.extent[0], data.window.extent[2]
        axes.bar3d(left + side * x, bottom + side * y, 0.0, side, side, values, color=colours, linewidth=0.0)
        axes.set_zlim(0.0, 1.15 * values.max())
        title = f"{fs.after(snapshot.distance)}\nload over area, {1e3 * side:.3g} µm squares"
        finish_3d(axes, data.window, "pressure, MPa", title)
    return figure


@panels(2)
def pressure_profiles(axes: Any, data: "FigureData") -> None:
    """Pressure along and across the sliding direction in the middle, all snapshots overlaid."""
    views = data.views
    tops = [float(max(v.along.pressure.max(), v.across.pressure.max())) for v in views]
    seen = [top for top in tops if top > 0.0]
    for view, line in zip(views, fs.in_time(fs.CONTACT, len(views)), strict=True):
        for panel, profile in zip(axes, (view.along, view.across), strict=True):
            panel.plot(profile.bins, profile.pressure, label=fs.after(view.distance), **line)
    for panel in axes:
        if seen and (panel.get_yscale() == "log" or max(seen) > 5.0 * min(seen)):
            fs.logarithmic(panel)
            panel.set_ylim(0.2 * min(seen), 1.5 * max(seen))
        else:
            panel.set_ylim(0.0, 1.15 * max(tops) or None)
    finish_sections(axes)
    axes[0].set_ylabel(f"pressure, mean of middle {1e3 * data.strip:.3g} µm, MPa")
    fs.legend_above(axes[0], columns=4)


def contact_map(data: "FigureData") -> Figure:
    """What each cell does at the snapshots: in contact, at the hardness, touched before or never."""
    area = data.history["area_contact"]
    return _states(data, STATES, lambda view: view.state, lambda row: f"{area[row]:.3g} mm² in contact")


def bare_map(data: "FigureData") -> Figure:
    """Where the film is gone at the snapshots, among the cells in contact and beside them."""
    fraction = data.history["bare_fraction"]
    return _states(
        data, FILMS, lambda view: view.film, lambda row: f"{100.0 * fraction[row]:.3g} % of the contact bare"
    )


def _states(
    data: "FigureData",
    kinds: Mapping[Any, tuple[str, str]],
    of: Callable[[View], Any],
    says: Callable[[int], str],
) -> Figure:
    """Draw the state of every block at the snapshots, and say something of each row of the history."""
    views = data.views
    colours = ListedColormap([colour for _, colour in kinds.values()])
    present = {state for view in views for state in np.unique(of(view))}
    handles = [
        Patch(facecolor=colour, edgecolor="#777777", lw=0.5, label=label)
        for state, (label, colour) in kinds.items()
        if state in present
    ]

    def draw(panel: Any, view: View) -> None:
        draw_map(panel, of(view), data.window, colours, None, low=-0.5, high=3.5)
        panel.set_title(f"{fs.after(view.distance)}\n{says(view.row)}")

    def legend(figure: Any) -> None:
        labels = [str(handle.get_label()) for handle in handles]
        figure.legend_above(handles, labels, columns=4 if len(views) > 1 else 2)

    return maps_of(views, draw, finish=legend)


@panels(2)
def hertz(axes: Any, data: "FigureData") -> None:
    """Pressure along the sliding direction through the middle, beside Hertz's of the unworn bodies."""
    theory, places = data.hertz, data.middle.places
    assert theory is not None  # or the figure is left out
    r = np.linspace(0.0, theory.radius, 200)
    both = np.concatenate([-r[::-1], r])
    unworn = {"color": fs.NEUTRAL, "ls": "--", "label": "Hertz, unworn bodies"}
    worn = {"color": fs.MEAN_PRESSURE, "where": "mid", "label": "elastic foundation"}
    for panel, (distance, line) in zip(axes, data.middle.pressures, strict=True):
        shown = np.flatnonzero(line > 0.0)
        shown = np.arange(max(shown[0] - 1, 0), min(shown[-1] + 2, line.size))
        panel.plot(both, theory.pressure(np.abs(both)), **unworn)
        panel.step(places[shown], line[shown], **worn)
        half = MARGIN * max(theory.radius, float(np.abs(places[shown]).max()))
        panel.set(xlim=(-half, half), xlabel=ALONG, ylabel="pressure, MPa")
        panel.xaxis.set_major_locator(fs.steps(5))
        panel.set_title(fs.after(distance))
    axes[0].set_ylim(bottom=0.0)
    fs.logarithmic(axes[1])
    axes[1].set_ylim(0.3 * data.middle.median, 2.0 * theory.peak_pressure)
    fs.legend_above(axes[0], columns=2)


@panels(2, height=2.9)
def factor(axes: Any, data: "FigureData") -> None:
    """Sliding distance of disc cells over that in the middle (thesis eq 4.22), at the scar and its margin."""
    study, window = data.study, data.window
    factors = distance_factor(study.cells, study.wear.distance_factor, curvature=study.sphere.curvature)
    whole = np.broadcast_to(factors, study.cells.shape)
    draw_map(axes[0], whole[window.x, window.y], window, fs.HEIGHTS, "relative sliding distance, –")
    axes[1].plot(study.cells.y[window.y], whole[study.cells.nx // 2, window.y], color=fs.DISC)
    axes[1].set(xlabel=ACROSS, ylabel="relative sliding distance, –")
    axes[1].set_title("1 = sliding distance in the middle")
    axes[1].ticklabel_format(axis="y", useOffset=False)
