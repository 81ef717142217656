"""Figures of what a run's history says: one value a step, over distance or time.

Where a sphere slides over a track, steps that are cut short are not drawn, except in volumes and depths, and
the means of many passes are drawn over their steps, which vary along the track.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.figures.axes import panels
from warpwear.figures.view import PASSES, last_at_hardness
from warpwear.grid import FloatArray

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

AREAS: dict[str, tuple[str, dict[str, Any]]] = {
    "contact": ("in contact", {"color": fs.CONTACT, "ls": "-"}),
    "plastic": ("at hardness", {"color": fs.HARDNESS, "ls": ":"}),
    "touched": ("ever touched", {"color": fs.TOUCHED, "ls": "--"}),
    "nominal": ("nominal (scar)", {"color": fs.NOMINAL, "ls": "-."}),
    "cumulative": ("running sum", {"color": fs.SUM, "ls": (0, (6, 1))}),
}
#: The running sum of areas is no area: it is drawn where friction is of it.
SUMMED = "cumulative"
#: How much paler and thinner the steps are then.
STEPS: dict[str, Any] = {"ls": "-", "lw": 0.4, "alpha": 0.4}
#: Part of the smallest area in contact down to which areas are shown: cells at the hardness become none.
LEAST = 0.03
#: Bins of distances in which pieces are counted.
PIECES_BINS = 30
#: Shortest time shown in the unit [s], unit, seconds of it.
TIMES = ((36000.0, "h", 3600.0), (600.0, "min", 60.0), (0.0, "s", 1.0))


@panels()
def cof(axes: Axes, data: "FigureData") -> None:
    """Coefficient of friction over the distance slid."""
    _course(axes, data, data.course["cof"], color=fs.NEUTRAL)
    _finish_cof(axes, data, data.course["distance"])


def _course(
    axes: Axes, data: "FigureData", values: FloatArray, *, largest: bool = False, **line: Any
) -> None:
    """Draw values of the steps; of many passes over a track pale, under each pass's mean or largest value.

    What comes before the middle of the first pass stays as it is.
    """
    distance, lap = data.course["distance"], data.about.lap
    passes = int(distance[-1] / lap + 1e-9) if lap is not None else 0
    if lap is None or passes < PASSES:
        fs.over_distance(axes, distance, values, **line)
        return
    fs.over_distance(axes, distance, values, **STEPS | {"color": line["color"]})
    number = np.maximum(np.ceil(distance / lap - 1e-9).astype(int) - 1, 0)
    whole, starts = number < passes, np.searchsorted(number, np.arange(passes))
    if largest:
        axes.lines[-1].set_visible(False)
        of_passes = np.maximum.reduceat(values[whole], starts)
    else:
        weights = data.course["increment"][whole]
        of_passes = np.add.reduceat(values[whole] * weights, starts) / np.add.reduceat(weights, starts)
    first = distance < 0.5 * lap
    places = np.concatenate([distance[first], (np.arange(passes) + 0.5) * lap])
    axes.plot(places, np.concatenate([values[first], of_passes]), **line)


@panels()
def cof_time(axes: Axes, data: "FigureData") -> None:
    """Coefficient of friction over the sliding time."""
    time, label = data.course["time"], "sliding time, {}"
    held = {label.format(unit): (unit, s) for _, unit, s in TIMES}.get(axes.get_xlabel())  # of another run
    unit, seconds = held or next((unit, s) for least, unit, s in TIMES if time[-1] >= least)
    label = label.format(unit)
    fs.over_distance(axes, time / seconds, data.course["cof"], xlabel=label, color=fs.NEUTRAL)
    _finish_cof(axes, data, time / seconds)


def _finish_cof(axes: Axes, data: "FigureData", places: FloatArray) -> None:
    """Label the coefficient, mark what is an input of it, and say which area shears and how strongly."""
    fitted = data.about.fitted_cof
    if fitted is not None:
        place = places[-1 if fitted.at_end else 0]
        given: dict[str, Any] = {"color": fs.NEUTRAL, "mfc": "white", "ms": 4, "clip_on": False, "zorder": 3}
        axes.plot(place, fitted.value, "o", **given)
    axes.set(ylabel="coefficient of friction, –", xlim=(0.0, None), ylim=(0.0, None))
    area = AREAS[data.about.friction_area][0]
    axes.set_title(f"area that shears: {area}\n{data.about.shear}")


@panels()
def bare_fraction(axes: Axes, data: "FigureData") -> None:
    """Part of the area in contact that is bare of film over the distance slid, and its fitted course."""
    distance = data.course["distance"]
    _course(axes, data, data.course["bare_fraction"], color=fs.DISC, label="computed")
    fit = data.bare_fit
    if not isinstance(fit, str):
        places = np.linspace(0.0, float(distance[-1]), 200)
        label = f"{fit.plateau:.2g} (1 − e^(−(L − {fit.start:.3g} mm)/{fit.length:.3g} mm))"
        axes.plot(places, fit.at(places), color=fs.NEUTRAL, ls="--", label=label)
        fs.legend_above(axes, columns=1)
    axes.set(ylabel="bare fraction of the area in contact, –", xlim=(0.0, None), ylim=(0.0, 1.0))


@panels()
def areas(axes: Axes, data: "FigureData") -> None:
    """Areas in contact, at the hardness, ever touched and nominal over the distance slid.

    The running sum of areas is there where it is the one that shears.
    """
    distance = data.course["distance"]
    shown = {name: data.course[f"area_{name}"] for name in AREAS}
    if data.about.friction_area != SUMMED:
        del shown[SUMMED]
    for name, area in shown.items():
        label, line = AREAS[name]
        if (area > 0.0).any():
            _course(axes, data, area, label=label, **line)
    if "area_static" in data.history:
        places: dict[str, Any] = {"ls": "none", "marker": ".", "ms": 2.0, "color": fs.NEUTRAL}
        static = data.history["area_static"]
        fs.over_distance(axes, data.history["distance"], static, label="without wear in the step", **places)
    fs.scale_distance(axes, distance)
    fs.scale_values(axes, *shown.values())
    if axes.get_yscale() == "log":
        known = shown["contact"][shown["contact"] > 0.0]
        axes.set_ylim(bottom=max(axes.get_ylim()[0], LEAST * float(known.min())))
    axes.set_ylabel("area, mm²")
    fs.legend_above(axes, columns=3)


@panels()
def pressure(axes: Axes, data: "FigureData") -> None:
    """Mean and largest pressure of the cells in contact over the distance slid."""
    history, hardness = data.course, data.study.hardness
    distance, mean, largest = history["distance"], history["pressure_mean"], history["pressure_max"]
    _course(axes, data, largest, largest=True, color=fs.NEUTRAL, ls=":", label="largest")
    _course(axes, data, mean, color=fs.MEAN_PRESSURE, label="mean")
    shown = [mean, largest]
    if np.isfinite(hardness):
        axes.axhline(hardness, color=fs.HARDNESS, lw=0.8, ls="--", label="hardness")
        shown.append(np.array([hardness]))
    at = last_at_hardness(history)
    if at is not None:
        axes.set_title(f"after {distance[at]:.3g} mm no cell is at the hardness")
    fs.scale_distance(axes, distance)
    fs.scale_values(axes, *shown)
    axes.set_ylabel("pressure in contact, MPa")
    fs.legend_above(axes, columns=3)


@panels()
def contact_radius(axes: Axes, data: "FigureData") -> None:
    """Radius of the scar and that of a circle of the area in contact over the distance slid."""
    distance = data.course["distance"]
    radii = {name: np.sqrt(data.course[f"area_{name}"] / np.pi) for name in ("nominal", "contact")}
    for name, label in (("nominal", "scar: √(area/π)"), ("contact", "in contact: √(area/π)")):
        _course(axes, data, radii[name], label=label, **AREAS[name][1])
    axes.set_ylabel("radius, mm")
    fs.scale_distance(axes, distance)
    fs.scale_values(axes, *radii.values())
    fs.legend_above(axes, columns=2)


@panels(2)
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


@panels(2)
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
        rates.stairs(np.diff(np.interp(ends, slid, left)) / np.diff(ends), ends, baseline=None, **line)
    if asked is not None:
        sizes.axvline(1e3 * asked, color=fs.HARDNESS, lw=1.0, label=f"asked for, {1e3 * asked:.3g} µm")
    sizes.set(xlabel="diameter as cut, µm", ylabel="share of pieces up to this, –", ylim=(0.0, 1.02))
    rates.set(xlabel="sliding distance, mm", ylabel="pieces per mm of sliding, 1/mm", ylim=(0.0, None))
    for panel in axes:
        panel.set_xlim(0.0, None)
        panel.xaxis.set_major_locator(fs.steps(6))
    fs.legend_above(sizes, columns=3)
