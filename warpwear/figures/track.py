"""Figures of a sphere that slides over a track: groove, track, each pass, friction along the stroke."""

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS, ALONG, colour_bar, draw_map, panels, stretch
from warpwear.figures.snapshots import PARAMETERS
from warpwear.figures.view import positive
from warpwear.grid import FloatArray

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

#: Passes in one figure.
SHOWN = 4


@panels(2)
def groove_figure(axes: Any, data: "FigureData") -> None:
    """Mean cross-section of the groove at the snapshots; its mean depth along the track at the end."""
    sections = data.grooves
    last = sections[-1]
    shown = float(np.abs(last.y[last.depth > 0.0]).max(initial=2.0 * data.about.cell)) * 1.15
    across, along = axes
    for section, line in zip(sections, fs.in_time(fs.DISC, len(sections)), strict=True):
        across.plot(section.y, -1e3 * section.depth, label=fs.after(section.distance), **line)
    if last.displaced.any():
        across.plot(last.y, -1e3 * last.worn, color=fs.NEUTRAL, lw=0.8, label="of which worn")
    across.set(xlabel=ACROSS, ylabel="change of height, µm", xlim=(-shown, shown))
    across.set_title("mean along sliding")
    places, depths = data.depth_along
    along.plot(places, -1e3 * depths, color=fs.shades(fs.DISC)(1.0), lw=0.9)
    mean = {"color": fs.NOMINAL, "lw": 0.8, "ls": "--"}
    along.axhline(-1e3 * last.mean_depth, label=f"mean depth {1e3 * last.mean_depth:.3g} µm", **mean)
    along.set(xlabel=ALONG, ylabel="change of height, µm", ylim=(None, 0.0))
    along.set_ylim(bottom=1.15 * along.get_ylim()[0])
    along.set_title(f"mean over the groove's width of {last.width:.3g} mm")
    for panel in axes:
        panel.xaxis.set_major_locator(fs.steps(6))
        panel.yaxis.set_major_locator(fs.steps(6))
    fs.legend_above(across, along, columns=6)


def track_map(data: "FigureData") -> Figure:
    """The whole track at the end: its heights, and what is gone of them; x and y not to one scale."""
    track = data.track
    title = f"track {fs.after(data.distances[-1])}"

    def show(panel: Any, field: FloatArray, colours: Any, label: str, low: float | None = None) -> None:
        known = field[np.isfinite(field)]
        least, most = np.percentile(known, (0.1, 99.9)) if known.size else (0.0, 1.0)
        low, beyond = (least, "both") if low is None else (low, "max")
        image = draw_map(panel, field, track, colours, None, low=low, high=most)
        colour_bar(panel.inset_axes((1.012, 0.0, 0.012, 1.0)), image, label, extend=beyond)
        panel.set_aspect("auto")
        panel.xaxis.set_major_locator(fs.steps(8))

    def draw(axes: Any) -> None:
        show(axes[0], 1e3 * track.heights, fs.HEIGHTS, "height, µm")
        show(axes[1], positive(1e3 * track.loss), fs.DEPTHS, "depth, µm", low=0.0)
        axes[0].set(title=title, xlabel="")
        axes[0].figure.when_placed.append(partial(_tell_shape, axes[0], title))
        axes[1].set_title("what is gone of it, worn or pressed down")
        axes[0].tick_params(labelbottom=False)

    return fs.new_figure(draw, rows=2, height=1.9, width=fs.PAGE, fixed=True)


def _tell_shape(panel: Axes, title: str) -> None:
    """Say in the title how many times larger lengths across the track are drawn than along it."""
    panel.set_title(f"{title} (y drawn {stretch(panel):.2g} times as large as x)")


@panels()
def wear_per_pass(axes: Axes, data: "FigureData") -> None:
    """Mean depth that each pass adds to the groove, by wear and by plastic flow."""
    table, stroke = data.passes, data.about.lap
    assert stroke is not None  # or the figure is left out
    whole = table["distance"] > 0.99 * stroke
    if not whole.any():
        whole[:] = True
    lines: tuple[tuple[str, str, dict[str, Any]], ...] = (
        ("wear_volume_disc", "worn", {"color": fs.DISC, "ls": "-"}),
        ("plastic_volume_disc", "displaced", {"color": fs.NEUTRAL, "ls": ":"}),
    )
    number = table["number"][whole]
    marker = "o" if number.size < 12 else None
    depths = {}
    for name, label, line in lines:
        if table[name].any():
            depths[name] = 1e3 * (table[name] / (table["distance"] * table["patch_across"]))[whole]
            axes.plot(number, depths[name], label=label, marker=marker, ms=3, **line)
    fs.scale_values(axes, *depths.values())
    axes.set(xlabel="pass, –", ylabel="mean depth of a pass, µm")
    axes.xaxis.set_major_locator(fs.steps(6, integer=True))
    if len(depths) > 1:
        fs.legend_above(axes, columns=2)


@panels()
def cof_stroke(axes: Axes, data: "FigureData") -> None:
    """Coefficient of friction over the position in the stroke, for some passes."""
    history, stroke = data.course, data.about.lap
    assert stroke is not None  # or the figure is left out
    number = np.maximum(np.ceil(history["distance"] / stroke - 1e-9).astype(int), 1)
    passes = np.unique(number)
    places = np.linspace(0, passes.size - 1, min(SHOWN, passes.size)).round().astype(int)
    for at, line in zip(passes[places], fs.in_time(fs.NEUTRAL, places.size), strict=True):
        inside = number == at
        axes.plot(history["position"][inside], history["cof"][inside], label=f"pass {at}", **line)
    axes.set(xlabel="position along the track, mm", ylabel="coefficient of friction, –", ylim=(0.0, None))
    axes.xaxis.set_major_locator(fs.steps(6))
    fs.legend_above(axes, columns=4)


@panels()
def track_roughness(axes: Axes, data: "FigureData") -> None:
    """Height parameters of the disc in the middle of the groove over the passes."""
    table = data.track_roughness
    for name, (label, line) in PARAMETERS.items():
        axes.plot(table["passes"], table[name], label=label, ms=3, **line)
    fs.scale_from_unworn(axes, table["passes"], "passes, –")
    axes.set(ylabel="roughness in the groove, µm", ylim=(0.0, None))
    fs.legend_above(axes, columns=5)
