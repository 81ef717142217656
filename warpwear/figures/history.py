"""Figures of what a run's history says: one value a step, over distance or time.

Where a sphere slides over a track, steps that are cut short are not drawn, except in volumes and depths.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.figures.view import positive

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

AREAS: dict[str, tuple[str, dict[str, Any]]] = {
    "contact": ("in contact", {"color": fs.CONTACT, "ls": "-"}),
    "plastic": ("at hardness", {"color": fs.HARDNESS, "ls": ":"}),
    "touched": ("ever touched", {"color": fs.TOUCHED, "ls": "--"}),
    "nominal": ("nominal (scar)", {"color": fs.NOMINAL, "ls": "-."}),
    "cumulative": ("running sum", {"color": fs.SUM, "ls": (0, (6, 1))}),
}
#: Bins of distances in which pieces are counted.
PIECES_BINS = 30
#: Shortest time shown in the unit [s], unit, seconds of it.
TIMES = ((36000.0, "h", 3600.0), (600.0, "min", 60.0), (0.0, "s", 1.0))


@fs.panels()
def cof(axes: Axes, data: "FigureData") -> None:
    """Coefficient of friction over the distance slid."""
    fs.over_distance(axes, data.course["distance"], data.course["cof"], color=fs.NEUTRAL)
    _finish_cof(axes, data)


@fs.panels()
def cof_time(axes: Axes, data: "FigureData") -> None:
    """Coefficient of friction over the sliding time."""
    time = data.course["time"]
    unit, seconds = next((unit, s) for least, unit, s in TIMES if time[-1] >= least)
    label = f"sliding time, {unit}"
    fs.over_distance(axes, time / seconds, data.course["cof"], xlabel=label, color=fs.NEUTRAL)
    _finish_cof(axes, data)


def _finish_cof(axes: Axes, data: "FigureData") -> None:
    """Label the coefficient and say which area shears and where its shear strength comes from."""
    axes.set(ylabel="coefficient of friction, –", xlim=(0.0, None), ylim=(0.0, None))
    area = AREAS[data.about.friction_area][0]
    axes.set_title(f"area that shears: {area}\n{data.about.shear}")


@fs.panels()
def bare_fraction(axes: Axes, data: "FigureData") -> None:
    """Part of the area in contact that is bare of film over the distance slid, and its fitted course."""
    distance = data.course["distance"]
    fs.over_distance(
        axes, distance, data.course["bare_fraction"], color=fs.DISC, label="bare, of the area in contact"
    )
    fit = data.bare_fit
    if not isinstance(fit, str):
        places = np.linspace(0.0, float(distance[-1]), 200)
        label = f"{fit.plateau:.2g} (1 − e^(−(L − {fit.start:.3g} mm)/{fit.length:.3g} mm))"
        axes.plot(places, fit.at(places), color=fs.NEUTRAL, ls="--", label=label)
    axes.set(ylabel="bare fraction, –", xlim=(0.0, None), ylim=(0.0, 1.05))
    fs.legend_above(axes, columns=1)


@fs.panels()
def areas(axes: Axes, data: "FigureData") -> None:
    """The four areas and the nominal one over the distance slid."""
    distance = data.course["distance"]
    values = [data.course[f"area_{name}"] for name in AREAS]
    for area, (label, line) in zip(values, AREAS.values(), strict=True):
        if (area > 0.0).any():
            fs.over_distance(axes, distance, positive(area), label=label, **line)
    if "area_static" in data.history:
        places: dict[str, Any] = {"ls": "none", "marker": ".", "ms": 2.0, "color": fs.NEUTRAL}
        static = data.history["area_static"]
        fs.over_distance(axes, data.history["distance"], static, label="without wear in the step", **places)
    fs.scale_distance(axes, distance)
    fs.scale_values(axes, *values)
    axes.set_ylabel("area, mm²")
    fs.legend_above(axes, columns=3)


@fs.panels()
def pressure(axes: Axes, data: "FigureData") -> None:
    """Mean and largest pressure of the cells in contact over the distance slid."""
    history, hardness = data.course, data.study.hardness
    distance, mean, largest = history["distance"], history["pressure_mean"], history["pressure_max"]
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


@fs.panels()
def contact_radius(axes: Axes, data: "FigureData") -> None:
    """Radius of the scar, radius of a circle of the area in contact, and mean pressure over the distance."""
    history = data.course
    distance, mean = history["distance"], history["pressure_mean"]
    radii = {name: np.sqrt(history[f"area_{name}"] / np.pi) for name in ("nominal", "contact")}
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


@fs.panels(2)
def volumes(axes: Any, data: "FigureData") -> None:
    """Worn volume and deepest cell of both bodies over the distance slid."""
    history = data.history
    for body, color, line in (("sphere", fs.SPHERE, "--"), ("disc", fs.DISC, "-")):
        style = {"color": color, "ls": line, "label": data.about.name_of(body)}
        volume, depth = history[f"wear_volume_{body}"], history[f"wear_depth_{body}"]
        fs.over_distance(axes[0], history["distance"], 1e3 * volume, **style)
        fs.over_distance(axes[1], history["distance"], 1e3 * depth, **style)
    axes[0].set_ylabel("worn volume, 10⁻³ mm³")
    axes[1].set_ylabel("wear depth (deepest cell), µm")
    for panel in axes:
        panel.set(xlim=(0.0, None), ylim=(0.0, None))
    fs.legend_above(axes[0], columns=2)


@fs.panels(2)
def pieces(axes: Any, data: "FigureData") -> None:
    """Share of the pieces up to a diameter as cut, and how many have left either body per distance.

    Those of a disc are counted on its whole stroke, of which a track may stand for a part.
    """
    history, asked = data.history, data.pieces.asked
    sizes, rates = axes
    ends = np.linspace(0.0, history["distance"][-1], PIECES_BINS + 1)
    for body, line in (("sphere", {"color": fs.SPHERE, "ls": "--"}), ("disc", {"color": fs.DISC})):
        cut, label = 1e3 * data.pieces.cut[body], data.about.name_of(body)
        shares = np.linspace(0.0, 1.0, cut.size + 1)
        sizes.step(np.append(0.0, cut), shares, where="post", label=label, **line)
        left = np.append(0.0, np.cumsum(history[f"pieces_{body}"]))
        slid = np.append(0.0, history["distance"])
        rates.stairs(np.diff(np.interp(ends, slid, left)) / np.diff(ends), ends, **line)
    if asked is not None:
        sizes.axvline(1e3 * asked, color=fs.HARDNESS, lw=1.0, label="d*")
    sizes.set(xlabel="diameter as cut, µm", ylabel="pieces up to this diameter, share, –", ylim=(0.0, 1.02))
    rates.set(xlabel="sliding distance, mm", ylabel="pieces per mm of sliding, 1/mm", ylim=(0.0, None))
    for panel in axes:
        panel.set_xlim(0.0, None)
    fs.legend_above(sizes, columns=3)
