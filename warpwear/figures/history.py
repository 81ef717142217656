"""Figures of what a run's history says: one value a step, over distance or time.

Of a sphere that slides over a track, steps that are cut short are not drawn, except in volumes and depths.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.figures import style as fs
from warpwear.figures.data import FigureData
from warpwear.grid import FloatArray
from warpwear.results.friction import mean_over

AREAS: dict[str, tuple[str, dict[str, Any]]] = {
    "contact": ("in contact", {"color": fs.CONTACT, "ls": "-"}),
    "plastic": ("at hardness", {"color": fs.HARDNESS, "ls": ":"}),
    "touched": ("ever touched", {"color": fs.TOUCHED, "ls": "--"}),
    "nominal": ("nominal (scar)", {"color": fs.NOMINAL, "ls": "-."}),
    "cumulative": ("running sum", {"color": fs.SUM, "ls": (0, (6, 1))}),
}
#: Shortest time shown in the unit [s], unit, seconds of it.
TIMES = ((36000.0, "h", 3600.0), (600.0, "min", 60.0), (0.0, "s", 1.0))


def cof(data: FigureData) -> Figure:
    """Coefficient of friction over the distance slid, and relative to its end: to a last pass's mean."""

    def draw(axes: Axes) -> None:
        fs.over_distance(axes, data.course["distance"], data.course["cof"], color=fs.NEUTRAL)
        _finish_cof(axes, data)

    return fs.new_figure(draw)


def cof_time(data: FigureData) -> Figure:
    """The same over the sliding time."""

    def draw(axes: Axes) -> None:
        time = data.course["time"]
        unit, seconds = next((unit, s) for least, unit, s in TIMES if time[-1] >= least)
        axes.plot(time / seconds, data.course["cof"], color=fs.NEUTRAL)
        axes.set_xlabel(f"sliding time, {unit}")
        axes.xaxis.set_major_locator(MaxNLocator(6))
        _finish_cof(axes, data)

    return fs.new_figure(draw)


def _finish_cof(axes: Axes, data: FigureData) -> None:
    axes.set_ylabel("coefficient of friction, –")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(left=0.0)
    lap = data.study.lap
    end = mean_over(data.history, data.history["cof"], "end", lap)
    if end > 0.0:
        to_relative: Any = (lambda v: v / end, lambda v: v * end)
        relative = axes.secondary_yaxis("right", functions=to_relative)
        relative.set_ylabel(f"relative to {'its end value' if lap is None else 'the last pass’s mean'}, –")
        relative.spines["right"].set_visible(True)
    axes.set_title(f"area that shears: {AREAS[data.study.friction.area][0]}")


def areas(data: FigureData) -> Figure:
    """The four areas and the nominal one over the distance slid."""
    distance = data.course["distance"]

    def draw(axes: Axes) -> None:
        for name, (label, line) in AREAS.items():
            values = _positive(data.course[f"area_{name}"])
            if np.isfinite(values).any():
                fs.over_distance(axes, distance, values, label=label, **line)
        fs.scale_distance(axes, distance)
        fs.scale_values(axes, *(data.course[f"area_{name}"] for name in AREAS))
        axes.set_ylabel("area, mm²")
        fs.legend_above(axes, columns=3)

    return fs.new_figure(draw)


def pressure(data: FigureData) -> Figure:
    """Mean and largest pressure of the cells in contact over the distance slid."""
    history, hardness = data.course, data.study.hardness
    distance, mean, largest = history["distance"], history["pressure_mean"], history["pressure_max"]

    def draw(axes: Axes) -> None:
        fs.over_distance(axes, distance, largest, color=fs.NEUTRAL, ls=":", label="largest")
        fs.over_distance(axes, distance, mean, color=fs.MEAN_PRESSURE, label="mean")
        shown = [mean, largest]
        if np.isfinite(hardness):
            axes.axhline(hardness, color=fs.HARDNESS, lw=0.8, ls="--", label="hardness")
            shown.append(np.array([hardness]))
        fs.scale_distance(axes, distance)
        fs.scale_values(axes, *shown)
        axes.set_ylabel("pressure in contact, MPa")
        fs.legend_above(axes, columns=3)

    return fs.new_figure(draw)


def contact_radius(data: FigureData) -> Figure:
    """Radius of the scar, radius of a circle of the area in contact, and mean pressure over the distance."""
    history = data.course
    distance, mean = history["distance"], history["pressure_mean"]
    radii = {name: np.sqrt(history[f"area_{name}"] / np.pi) for name in ("nominal", "contact")}

    def draw(axes: Axes) -> None:
        for name, label in (("nominal", "√(scar area/π)"), ("contact", "√(area in contact/π)")):
            fs.over_distance(axes, distance, radii[name], label=label, **AREAS[name][1])
        axes.set_ylabel("radius, mm")
        right = axes.twinx()
        right.spines["right"].set_visible(True)
        right.plot(distance, mean, color=fs.MEAN_PRESSURE, ls=":", label="mean pressure (right)")
        right.set_ylabel("mean pressure in contact, MPa")
        fs.scale_distance(axes, distance)
        fs.scale_values(axes, *radii.values())
        fs.scale_values(right, mean)
        fs.legend_above(axes, right, columns=2)

    return fs.new_figure(draw)


def volumes(data: FigureData) -> Figure:
    """Worn volume and deepest cell of both bodies over the distance slid."""
    history = data.history

    def draw(axes: Any) -> None:
        for body, color, line in (("sphere", fs.SPHERE, "--"), ("disc", fs.DISC, "-")):
            style = {"color": color, "ls": line, "label": data.name_of(body)}
            volume, depth = history[f"wear_volume_{body}"], history[f"wear_depth_{body}"]
            fs.over_distance(axes[0], history["distance"], 1e3 * volume, **style)
            fs.over_distance(axes[1], history["distance"], 1e3 * depth, **style)
        axes[0].set_ylabel("worn volume, 10⁻³ mm³")
        axes[1].set_ylabel("wear depth (deepest cell), µm")
        for panel in axes:
            panel.set_ylim(bottom=0.0)
            panel.set_xlim(left=0.0)
        fs.legend_above(axes[0], columns=2)

    return fs.new_figure(draw, columns=2)


def _positive(values: FloatArray) -> FloatArray:
    return np.where(values > 0.0, values, np.nan)
