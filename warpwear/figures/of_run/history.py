"""Figures of what a run's history says: one value a step, over distance or time.

Where a ball slides over a track, steps that are cut short are not drawn, except in volumes and depths, and
the means of many passes are drawn over their steps, which vary along the track. What a column is called, its
unit and its line are those of its quantity.
"""

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, over_distance
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.view import PASSES, last_at_hardness
from warpwear.grid import FloatArray
from warpwear.history.distances import with_unit
from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.laws.archard import BODIES
from warpwear.results.summary import bare_course
from warpwear.results.track import pass_numbers, whole_steps

#: Areas in contact and of the scar.
AREAS = ("area_contact", "area_plastic", "area_touched", "area_nominal")
#: Worn volumes of both bodies.
VOLUMES = tuple(f"wear_volume_{body}" for body in BODIES)
#: The running sum of areas is no area: it is drawn where friction is of it.
SUMMED = "area_cumulative"
#: Part of the smallest area in contact down to which areas are shown: cells at the hardness become none.
LEAST = 0.03
#: Bins of distances in which pieces are counted.
PIECES_BINS = 30


def look_of(quantity: Quantity, **changes: float) -> Look:
    """Give the look of a quantity's line."""
    return Look(getattr(describe, quantity.colour), quantity.dash, **changes)  # type: ignore[arg-type]


def axis_of(quantity: Quantity) -> Axis:
    """Give the axis of a quantity that stands alone, logarithmic where its values span decades."""
    return Axis(quantity.axis, "auto") if quantity.log else Axis(quantity.axis, low=0.0)


@words.figure(words.NO_COURSE, words.NO_COF, essential=True, section="courses", overlaid=("cof",))
def cof(data: FigureData) -> Figure:
    """Coefficient of friction over the sliding distance. {friction}{passes}"""
    return _of_cof(data, data.course["distance"], _course(data, "cof"), describe.DISTANCE)


@words.figure(words.NO_COURSE, words.NO_COF, words.NO_TIME)
def cof_time(data: FigureData) -> Figure:
    """Coefficient of friction over the sliding time. {friction}"""
    time = data.course["time"]
    return _of_cof(data, time, [Line(time, data.course["cof"])], describe.TIME)


def _of_cof(data: FigureData, places: FloatArray, lines: list[Line], over: str) -> Figure:
    """Label the coefficient, mark what is an input of it, and say which area shears and how strongly."""
    friction = data.study.friction
    if friction.fitted in ("end", "initial"):
        place = slice(-1, None) if friction.calibrate == "end" else slice(1)
        mark = Line(places[place], np.array([friction.coefficient]), look=describe.RING, clipped=False)
        lines = [*lines, mark]
    note = f"area that shears: {BY_NAME[f'area_{friction.area}'].short}\n{data.shear}"
    note = data.shear if friction.law != "shear-strength" else note
    value = axis_of(BY_NAME["cof"])
    return Figure([Chart("Coefficient of friction", Axis(over, low=0.0), value, lines, note)])


def _course(
    data: FigureData, name: str, label: str = "", *, largest: bool = False, power: float = 1.0
) -> list[Line]:
    """Give values of the steps; of many passes over a track pale, under each pass's mean or largest value.

    What comes before the middle of the first pass stays as it is. power: of the values that is shown.
    """
    quantity, distance, lap = BY_NAME[name], data.course["distance"], data.study.blocks[0].lap
    values, look = quantity.scaled(data.course[name]) ** power, look_of(quantity)
    slides = data.study.is_swept and data.study.passes_at(distance[-1]) + 1e-9 >= PASSES
    if lap is None or not slides:
        return [Line(distance, values, label, look)]
    # Computed passes: one that stands for many is one, however far it slides.
    of_steps = pass_numbers(data.result)
    number, passes = of_steps[whole_steps(data.result)], int(of_steps[-1])
    passes += np.count_nonzero(of_steps == passes) == data.study.tracks[-1].steps_of_pass
    slid = np.bincount(of_steps, data.history["increment"])[:passes]
    whole, starts = number < passes, np.searchsorted(number, np.arange(passes))
    if largest:
        of_passes = np.maximum.reduceat(values[whole], starts)
    else:
        weights = data.course["increment"][whole]
        of_passes = np.add.reduceat(values[whole] * weights, starts) / np.add.reduceat(weights, starts)
    first = distance < 0.5 * lap
    places = np.concatenate([distance[first], np.cumsum(slid) - 0.5 * slid])
    means = Line(places, np.concatenate([values[first], of_passes]), label, look)
    steps = Line(distance, values, look=Look(look.colour, width=0.4, alpha=0.4))
    return [means] if largest else [steps, means]


@words.figure(words.NO_FILM, words.NO_COURSE, essential=True, section="courses")
def bare_fraction(data: FigureData) -> Figure:
    """Part of the area in contact that is bare of film over the sliding distance, and its fitted
    course.{passes}
    """
    lines = _course(data, "bare_fraction", "computed")
    fit = bare_course(data.result)
    if not isinstance(fit, str):
        places = np.linspace(0.0, float(data.course["distance"][-1]), 200)
        label = f"{fit.plateau:.2g} (1 − e^(−(L − {fit.start:.3g} mm)/{fit.length:.3g} mm))"
        lines.append(Line(places, fit.at(places), label, Look(dash="dash")))
    part = Axis(BY_NAME["bare_fraction"].axis, low=0.0, high=1.0)
    chart = Chart("Bare of film", Axis(describe.DISTANCE, low=0.0), part, lines)
    return Figure([chart], legend=0 if isinstance(fit, str) else 1)


@words.figure(words.NO_COURSE, essential=True, section="courses", overlaid=("area_contact",))
def areas(data: FigureData) -> Figure:
    """Real areas of contact and the nominal area of the scar, its {outline}, over the sliding
    distance.{passes}

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


@words.figure(words.NO_COURSE, section="courses", overlaid=("pressure_mean",))
def pressure(data: FigureData) -> Figure:
    """Mean and largest pressure of the cells in contact over the sliding distance.{fall}{passes}"""
    course, hardness = data.course, data.study.hardness
    lines: list[Line | Level] = [
        *_course(data, "pressure_max", "largest", largest=True),
        *_course(data, "pressure_mean", "mean"),
    ]
    if np.isfinite(hardness):
        lines.append(Level(hardness, "hardness", Look(describe.HARDNESS, "dash", 0.8)))
    last = last_at_hardness(course)
    until = "" if last is None else with_unit(course["distance"][last], 4)
    note = until and f"after {until} no cell is at the hardness"
    axes = over_distance(course["distance"]), Axis(BY_NAME["pressure_mean"].family_axis, "auto")
    return Figure([Chart("Pressure", *axes, lines, note)], legend=3)


@words.figure(words.NO_COURSE, words.NO_RADIUS)
def contact_radius(data: FigureData) -> Figure:
    """Radii of circles of the scar's nominal area and of the area in contact over the sliding distance:
    where they meet the contact fills its scar.{passes}
    """
    lines = [
        Line(line.x, line.y / np.sqrt(np.pi), line.label, line.look)
        for name, label in (("area_nominal", "scar: √(area/π)"), ("area_contact", "in contact: √(area/π)"))
        for line in _course(data, name, label, power=0.5)
    ]
    axes = over_distance(data.course["distance"]), Axis("radius, mm", "auto")
    return Figure([Chart("Radii", *axes, lines)], legend=2)


@words.figure(words.NO_COURSE, words.UNWORN, essential=True, section="courses", overlaid=VOLUMES)
def volumes(data: FigureData) -> Figure:
    """Worn volume and depth of the deepest cell of {slider} and disc over the sliding distance."""
    panels, distance = [], data.history["distance"]
    for prefix, title in (("wear_volume", "Worn volume"), ("wear_depth", "Wear depth")):
        quantities = {body: BY_NAME[f"{prefix}_{body}"] for body in BODIES}
        lines = [
            Line(distance, column.scaled(data.history[column.name]), data.name_of(body), look_of(column))
            for body, column in quantities.items()
        ]
        label = quantities["disc"].family_axis
        strip = data.study.strip if prefix == "wear_volume" else None
        note = f"of {strip:.4g} mm of the line" if strip else ""
        panels.append(Chart(title, Axis(describe.DISTANCE, low=0.0), Axis(label, low=0.0), lines, note))
    return Figure(panels, legend=2)


@words.figure(words.NO_PIECES, essential=True, section="pieces")
def pieces(data: FigureData) -> Figure:
    """Diameters of the pieces as they were cut, and how many left {slider} and disc per distance slid.

    Those of a disc are counted on its whole stroke, of which a track may stand for a part.
    """
    history, cutting = data.history, data.study.pair.pieces
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
    if cutting is not None:
        wanted = diameter.factor * cutting.diameter
        line = Look(describe.HARDNESS, width=1.0)
        sizes.append(Level(wanted, f"asked for, {wanted:.3g} µm", line, axis="x"))
    share = Axis("share of pieces up to this, –", low=0.0, high=1.02)
    per_distance = Axis("pieces per mm of sliding, 1/mm", low=0.0)
    both = [
        Chart("How wide they are", Axis(diameter.axis, low=0.0), share, sizes),
        Chart("Pieces in a distance", Axis(describe.DISTANCE, low=0.0), per_distance, rates),
    ]
    return Figure(both, legend=3)
