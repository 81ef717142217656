"""Figures of what a run's history says: one value a step, over distance or time.

Where a sphere slides over a track, steps that are cut short are not drawn, except in volumes and depths, and
the means of many passes are drawn over their steps, which vary along the track.
"""

import numpy as np

from warpwear.figures.data import FigureData
from warpwear.figures.describe import (
    CONTACT,
    DISC,
    DISTANCE,
    HARDNESS,
    MEAN_PRESSURE,
    NEUTRAL,
    NOMINAL,
    SPHERE,
    SUM,
    TOUCHED,
    Axis,
    Chart,
    Figure,
    Level,
    Line,
    Look,
    over_distance,
)
from warpwear.figures.view import PASSES, last_at_hardness
from warpwear.grid import FloatArray

#: Area -> what it is called, and its line.
AREAS: dict[str, tuple[str, Look]] = {
    "contact": ("in contact", Look(CONTACT)),
    "plastic": ("at hardness", Look(HARDNESS, "dot")),
    "touched": ("ever touched", Look(TOUCHED, "dash")),
    "nominal": ("nominal (scar)", Look(NOMINAL, "dashdot")),
    "cumulative": ("running sum", Look(SUM, "longdash")),
}
OF_BODIES = {"sphere": Look(SPHERE, "dash"), "disc": Look(DISC)}
#: The running sum of areas is no area: it is drawn where friction is of it.
SUMMED = "cumulative"
#: Part of the smallest area in contact down to which areas are shown: cells at the hardness become none.
LEAST = 0.03
#: Bins of distances in which pieces are counted.
PIECES_BINS = 30
#: Shortest time shown in the unit [s], unit, seconds of it.
TIMES = ((36000.0, "h", 3600.0), (600.0, "min", 60.0), (0.0, "s", 1.0))
COF = "coefficient of friction, –"


def cof(data: FigureData) -> Figure:
    """Coefficient of friction over the distance slid."""
    course = _course(data, data.course["cof"], Look(NEUTRAL))
    return _of_cof(data, data.course["distance"], course, DISTANCE)


def cof_time(data: FigureData) -> Figure:
    """Coefficient of friction over the sliding time."""
    time = data.course["time"]
    unit, seconds = next((unit, s) for least, unit, s in TIMES if time[-1] >= least)
    line = Line(time / seconds, data.course["cof"])
    return _of_cof(data, time / seconds, [line], f"sliding time, {unit}")


def _of_cof(data: FigureData, places: FloatArray, lines: list[Line], over: str) -> Figure:
    """Label the coefficient, mark what is an input of it, and say which area shears and how strongly."""
    fitted = data.about.fitted_cof
    if fitted is not None:
        place = slice(-1, None) if fitted.at_end else slice(1)
        mark = Look(NEUTRAL, "", marker="o", size=4.0, hollow=True)
        lines = [*lines, Line(places[place], np.array([fitted.value]), look=mark, clipped=False)]
    note = f"area that shears: {AREAS[data.about.friction_area][0]}\n{data.about.shear}"
    chart = Chart("Coefficient of friction", Axis(over, low=0.0), Axis(COF, low=0.0), lines, note)
    return Figure([chart])


def _course(
    data: FigureData, values: FloatArray, look: Look, label: str = "", *, largest: bool = False
) -> list[Line]:
    """Give values of the steps; of many passes over a track pale, under each pass's mean or largest value.

    What comes before the middle of the first pass stays as it is.
    """
    distance, lap = data.course["distance"], data.about.lap
    passes = int(distance[-1] / lap + 1e-9) if lap is not None else 0
    if lap is None or passes < PASSES:
        return [Line(distance, values, label, look)]
    number = np.maximum(np.ceil(distance / lap - 1e-9).astype(int) - 1, 0)
    whole, starts = number < passes, np.searchsorted(number, np.arange(passes))
    if largest:
        of_passes = np.maximum.reduceat(values[whole], starts)
    else:
        weights = data.course["increment"][whole]
        of_passes = np.add.reduceat(values[whole] * weights, starts) / np.add.reduceat(weights, starts)
    first = distance < 0.5 * lap
    places = np.concatenate([distance[first], (np.arange(passes) + 0.5) * lap])
    means = Line(places, np.concatenate([values[first], of_passes]), label, look)
    steps = Line(distance, values, look=Look(look.colour, width=0.4, alpha=0.4))
    return [means] if largest else [steps, means]


def bare_fraction(data: FigureData) -> Figure:
    """Part of the area in contact that is bare of film over the distance slid, and its fitted course."""
    lines = _course(data, data.course["bare_fraction"], Look(DISC), "computed")
    fit = data.bare_fit
    if not isinstance(fit, str):
        places = np.linspace(0.0, float(data.course["distance"][-1]), 200)
        label = f"{fit.plateau:.2g} (1 − e^(−(L − {fit.start:.3g} mm)/{fit.length:.3g} mm))"
        lines.append(Line(places, fit.at(places), label, Look(NEUTRAL, "dash")))
    part = Axis("bare fraction of the area in contact, –", low=0.0, high=1.0)
    return Figure([Chart("Bare of film", Axis(DISTANCE, low=0.0), part, lines)], legend=1)


def areas(data: FigureData) -> Figure:
    """Areas in contact, at the hardness, ever touched and nominal over the distance slid.

    The running sum of areas is there where it is the one that shears.
    """
    columns = {name: data.course[f"area_{name}"] for name in AREAS}
    if data.about.friction_area != SUMMED:
        del columns[SUMMED]
    lines = [
        line
        for name, area in columns.items()
        if (area > 0.0).any()
        for line in _course(data, area, AREAS[name][1], AREAS[name][0])
    ]
    if "area_static" in data.history:
        dots = Look(NEUTRAL, "", marker=".", size=2.0)
        static = data.history["area_static"]
        lines.append(Line(data.history["distance"], static, "without wear in the step", dots))
    contact = columns["contact"][columns["contact"] > 0.0]
    area = Axis("area, mm²", "auto", least=LEAST * float(contact.min(initial=np.inf)))
    return Figure([Chart("Areas", over_distance(data.course["distance"]), area, lines)], legend=3)


def pressure(data: FigureData) -> Figure:
    """Mean and largest pressure of the cells in contact over the distance slid."""
    course, hardness = data.course, data.study.hardness
    lines: list[Line | Level] = [
        *_course(data, course["pressure_max"], Look(NEUTRAL, "dot"), "largest", largest=True),
        *_course(data, course["pressure_mean"], Look(MEAN_PRESSURE), "mean"),
    ]
    if np.isfinite(hardness):
        lines.append(Level(hardness, "hardness", Look(HARDNESS, "dash", 0.8)))
    last = last_at_hardness(course)
    note = "" if last is None else f"after {course['distance'][last]:.3g} mm no cell is at the hardness"
    axes = over_distance(course["distance"]), Axis("pressure in contact, MPa", "auto")
    return Figure([Chart("Pressure", *axes, lines, note)], legend=3)


def contact_radius(data: FigureData) -> Figure:
    """Radius of the scar and that of a circle of the area in contact over the distance slid."""
    lines = [
        line
        for name, label in (("nominal", "scar: √(area/π)"), ("contact", "in contact: √(area/π)"))
        for line in _course(data, np.sqrt(data.course[f"area_{name}"] / np.pi), AREAS[name][1], label)
    ]
    axes = over_distance(data.course["distance"]), Axis("radius, mm", "auto")
    return Figure([Chart("Radii", *axes, lines)], legend=2)


def volumes(data: FigureData) -> Figure:
    """Worn volume and deepest cell of both bodies over the distance slid."""
    history, distance = data.history, Axis(DISTANCE, low=0.0)
    panels = []
    for name, title, label in (
        ("wear_volume", "Worn volume", "worn volume, 10⁻³ mm³"),
        ("wear_depth", "Wear depth", "wear depth (deepest cell), µm"),
    ):
        lines = [
            Line(history["distance"], 1e3 * history[f"{name}_{body}"], data.about.name_of(body), look)
            for body, look in OF_BODIES.items()
        ]
        panels.append(Chart(title, distance, Axis(label, low=0.0), lines))
    return Figure(panels, legend=2)


def pieces(data: FigureData) -> Figure:
    """Share of the pieces up to a diameter as cut, and how many have left either body per distance.

    Those of a disc are counted on its whole stroke, of which a track may stand for a part.
    """
    history, asked = data.history, data.pieces.asked
    ends = np.linspace(0.0, history["distance"][-1], PIECES_BINS + 1)
    slid = np.append(0.0, history["distance"])
    sizes: list[Line | Level] = []
    rates: list[Line] = []
    for body, look in OF_BODIES.items():
        cut, label = 1e3 * data.pieces.cut[body], data.about.name_of(body)
        left = np.append(0.0, np.cumsum(history[f"pieces_{body}"]))
        rate = np.diff(np.interp(ends, slid, left)) / np.diff(ends)
        sizes.append(Line(np.append(0.0, cut), np.linspace(0.0, 1.0, cut.size + 1), label, look, step="post"))
        rates.append(Line(ends, np.append(rate, rate[-1]), "", look, step="post"))
    if asked is not None:
        line = Look(HARDNESS, width=1.0)
        sizes.append(Level(1e3 * asked, f"asked for, {1e3 * asked:.3g} µm", line, axis="x"))
    share = Axis("share of pieces up to this, –", low=0.0, high=1.02)
    rate_axis = Axis("pieces per mm of sliding, 1/mm", low=0.0)
    both = [
        Chart("How wide they are", Axis("diameter as cut, µm", low=0.0), share, sizes),
        Chart("Pieces in a distance", Axis(DISTANCE, low=0.0), rate_axis, rates),
    ]
    return Figure(both, legend=3)
