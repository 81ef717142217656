"""Figures of what a run's history says: one value a step, over distance or time; and runs laid over others.

Where a sphere slides over a track, steps that are cut short are not drawn, except in volumes and depths, and
the means of many passes are drawn over their steps, which vary along the track. What a column is called, its
unit and its line are those of its quantity.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from warpwear.figures import describe
from warpwear.figures.data import FigureData
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, over_distance
from warpwear.figures.view import last_at_hardness
from warpwear.grid import FloatArray
from warpwear.history.quantities import BODIES, BY_NAME, Quantity
from warpwear.results.ensemble import band, band_told, in_legend

#: Areas in contact and of the scar.
AREAS = ("area_contact", "area_plastic", "area_touched", "area_nominal")
#: The running sum of areas is no area: it is drawn where friction is of it.
SUMMED = "area_cumulative"
#: Part of the smallest area in contact down to which areas are shown: cells at the hardness become none.
LEAST = 0.03
#: Bins of distances in which pieces are counted.
PIECES_BINS = 30
#: From this number of whole passes on, their means are drawn over the steps.
PASSES = 8
#: Shortest time shown in the unit [s], unit, seconds of it.
TIMES = ((36000.0, "h", 3600.0), (600.0, "min", 60.0), (0.0, "s", 1.0))
#: Figures of runs laid over others -> columns of the history, a panel each.
OVERLAID = {
    "cof": ("cof",),
    "area": ("area_contact",),
    "pressure": ("pressure_mean",),
    "volumes": ("wear_volume_sphere", "wear_volume_disc"),
}


@dataclass(frozen=True)
class Courses:
    """Runs that are laid over others under one label.

    of: gives the places, (n,), and the values, (runs, n), NaN where a run has none, of a column of the history;
    None where there are none.
    """

    label: str
    look: Look
    of: Callable[[str], tuple[FloatArray, FloatArray] | None]


def look_of(quantity: Quantity, **changes: float) -> Look:
    """Give the look of a quantity's line."""
    return Look(getattr(describe, quantity.colour), quantity.dash, **changes)  # type: ignore[arg-type]


def axis_of(quantity: Quantity) -> Axis:
    """Give the axis of a quantity that stands alone: logarithmic where its values span decades, if it may be."""
    return Axis(quantity.axis, "auto") if quantity.log else Axis(quantity.axis, low=0.0)


def banded(label: str, look: Look, places: FloatArray, values: FloatArray) -> Line:
    """Make the line of a mean, in a band of 5 to 95 % where there are several. values: (runs, places)"""
    mean, low, high = band(values)
    ends = (low, high) if len(values) > 1 else (None, None)
    return Line(places, mean, in_legend(label), look, *ends)


def overlaid(name: str, groups: Sequence[Courses], *, measured: Sequence[Line] = ()) -> Figure:
    """Lay runs over others: a panel a column of `OVERLAID`, in it a line a group; measured ones with friction."""
    panels = []
    for column in OVERLAID[name]:
        quantity = BY_NAME[column]
        courses = [(group, group.of(column)) for group in groups]
        lines = [
            banded(group.label, group.look, course[0], quantity.scaled(course[1]))
            for group, course in courses
            if course is not None
        ]
        over = Axis(describe.DISTANCE, low=0.0)
        if quantity.log:
            over = over_distance(*(line.x for line in lines))
        lines = [*(measured if column == "cof" else ()), *lines]
        note = band_told([len(course[1]) for _, course in courses if course is not None])
        title = quantity.label[:1].upper() + quantity.label[1:]
        panels.append(Chart(title, over, axis_of(quantity), lines, note))
    return Figure(panels, legend=6)


def cof(data: FigureData) -> Figure:
    """Coefficient of friction over the distance slid."""
    return _of_cof(data, data.course["distance"], _course(data, "cof"), describe.DISTANCE)


def cof_time(data: FigureData) -> Figure:
    """Coefficient of friction over the sliding time."""
    time = data.course["time"]
    unit, seconds = next((unit, s) for least, unit, s in TIMES if time[-1] >= least)
    line = Line(time / seconds, data.course["cof"])
    return _of_cof(data, time / seconds, [line], f"sliding time, {unit}")


def _of_cof(data: FigureData, places: FloatArray, lines: list[Line], over: str) -> Figure:
    """Label the coefficient, mark what is an input of it, and say which area shears and how strongly."""
    friction = data.study.friction
    if friction.shear_strength is None:
        place = slice(-1, None) if friction.calibrate == "end" else slice(1)
        mark = Look(dash="", marker="o", size=4.0, hollow=True)
        lines = [*lines, Line(places[place], np.array([friction.coefficient]), look=mark, clipped=False)]
    note = f"area that shears: {BY_NAME[f'area_{friction.area}'].short}\n{data.shear}"
    value = axis_of(BY_NAME["cof"])
    return Figure([Chart("Coefficient of friction", Axis(over, low=0.0), value, lines, note)])


def _course(
    data: FigureData, name: str, label: str = "", *, largest: bool = False, power: float = 1.0
) -> list[Line]:
    """Give values of the steps; of many passes over a track pale, under each pass's mean or largest value.

    What comes before the middle of the first pass stays as it is. power: of the values that is shown.
    """
    quantity, distance, lap = BY_NAME[name], data.course["distance"], data.study.lap
    values, look = quantity.scaled(data.course[name]) ** power, look_of(quantity)
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
    lines = _course(data, "bare_fraction", "computed")
    fit = data.bare_fit
    if not isinstance(fit, str):
        places = np.linspace(0.0, float(data.course["distance"][-1]), 200)
        label = f"{fit.plateau:.2g} (1 − e^(−(L − {fit.start:.3g} mm)/{fit.length:.3g} mm))"
        lines.append(Line(places, fit.at(places), label, Look(dash="dash")))
    part = Axis(BY_NAME["bare_fraction"].axis, low=0.0, high=1.0)
    return Figure([Chart("Bare of film", Axis(describe.DISTANCE, low=0.0), part, lines)], legend=1)


def areas(data: FigureData) -> Figure:
    """Areas in contact, at the hardness, ever touched and nominal over the distance slid.

    The running sum of areas is there where it is the one that shears.
    """
    summed = [SUMMED] if f"area_{data.study.friction.area}" == SUMMED else []
    names = [name for name in (*AREAS, *summed) if (data.course[name] > 0.0).any()]
    lines = [line for name in names for line in _course(data, name, BY_NAME[name].short)]
    if "area_static" in data.history:
        dots, static = Look(dash="", marker=".", size=2.0), BY_NAME["area_static"]
        lines.append(Line(data.history["distance"], data.history[static.name], static.short, dots))
    contact = data.course["area_contact"]
    least = LEAST * float(contact.min(initial=np.inf, where=contact > 0.0))
    area = Axis(BY_NAME["area_contact"].family_axis, "auto", least=least)
    return Figure([Chart("Areas", over_distance(data.course["distance"]), area, lines)], legend=3)


def pressure(data: FigureData) -> Figure:
    """Mean and largest pressure of the cells in contact over the distance slid."""
    course, hardness = data.course, data.study.hardness
    lines: list[Line | Level] = [
        *_course(data, "pressure_max", "largest", largest=True),
        *_course(data, "pressure_mean", "mean"),
    ]
    if np.isfinite(hardness):
        lines.append(Level(hardness, "hardness", Look(describe.HARDNESS, "dash", 0.8)))
    last = last_at_hardness(course)
    note = "" if last is None else f"after {course['distance'][last]:.3g} mm no cell is at the hardness"
    axes = over_distance(course["distance"]), Axis(BY_NAME["pressure_mean"].family_axis, "auto")
    return Figure([Chart("Pressure", *axes, lines, note)], legend=3)


def contact_radius(data: FigureData) -> Figure:
    """Radius of the scar and that of a circle of the area in contact over the distance slid."""
    lines = [
        Line(line.x, line.y / np.sqrt(np.pi), line.label, line.look)
        for name, label in (("area_nominal", "scar: √(area/π)"), ("area_contact", "in contact: √(area/π)"))
        for line in _course(data, name, label, power=0.5)
    ]
    axes = over_distance(data.course["distance"]), Axis("radius, mm", "auto")
    return Figure([Chart("Radii", *axes, lines)], legend=2)


def volumes(data: FigureData) -> Figure:
    """Worn volume and deepest cell of both bodies over the distance slid."""
    panels = []
    for prefix, title in (("wear_volume", "Worn volume"), ("wear_depth", "Wear depth")):
        quantities = {body: BY_NAME[f"{prefix}_{body}"] for body in BODIES}
        lines = [
            Line(data.history["distance"], of.scaled(data.history[of.name]), data.name_of(body), look_of(of))
            for body, of in quantities.items()
        ]
        label = quantities["disc"].family_axis
        panels.append(Chart(title, Axis(describe.DISTANCE, low=0.0), Axis(label, low=0.0), lines))
    return Figure(panels, legend=2)


def pieces(data: FigureData) -> Figure:
    """Share of the pieces up to a diameter as cut, and how many have left either body per distance.

    Those of a disc are counted on its whole stroke, of which a track may stand for a part.
    """
    history, asked = data.history, data.study.pieces
    ends, diameter = np.linspace(0.0, history["distance"][-1], PIECES_BINS + 1), BY_NAME["diameter"]
    sizes: list[Line | Level] = []
    rates: list[Line] = []
    for body in BODIES:
        cut, look = diameter.scaled(data.pieces[body]), look_of(BY_NAME[f"wear_volume_{body}"])
        left = np.append(0.0, np.cumsum(history[f"pieces_{body}"]))
        rate = np.diff(np.interp(ends, np.append(0.0, history["distance"]), left)) / np.diff(ends)
        shares = np.linspace(0.0, 1.0, cut.size + 1)
        sizes.append(Line(np.append(0.0, cut), shares, data.name_of(body), look, step="post"))
        rates.append(Line(ends, np.append(rate, rate[-1]), "", look, step="post"))
    if asked is not None:
        wanted = diameter.factor * asked.diameter
        line = Look(describe.HARDNESS, width=1.0)
        sizes.append(Level(wanted, f"asked for, {wanted:.3g} µm", line, axis="x"))
    share = Axis("share of pieces up to this, –", low=0.0, high=1.02)
    per_distance = Axis("pieces per mm of sliding, 1/mm", low=0.0)
    both = [
        Chart("How wide they are", Axis(diameter.axis, low=0.0), share, sizes),
        Chart("Pieces in a distance", Axis(describe.DISTANCE, low=0.0), per_distance, rates),
    ]
    return Figure(both, legend=3)
