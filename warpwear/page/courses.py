"""Courses of a run's page: everything that has one value a step, and the pieces that bodies have lost."""

import math

import numpy as np

from warpwear.figures.data import FigureData
from warpwear.figures.table import Plotter
from warpwear.page.parts import (
    DISTANCE,
    POINTS,
    WIDE_DISTANCE,
    Chart,
    Line,
    Section,
    chosen,
    is_wide,
    thinned,
)

#: Parts of the distance over which pieces are counted.
BINS = 40
AREAS = (
    ("contact", "in contact", "CONTACT", "solid"),
    ("plastic", "at hardness", "HARDNESS", "dot"),
    ("touched", "ever touched", "TOUCHED", "dash"),
    ("nominal", "nominal (scar)", "NOMINAL", "dashdot"),
    ("cumulative", "running sum", "SUM", "longdash"),
)


def courses(plot: Plotter, data: FigureData) -> Section:
    """Everything that has one value a step."""
    course, history, about = data.course, data.history, data.about
    at, end = thinned(course["distance"]), thinned(history["distance"])
    over, x, whole = course["distance"][at], history["distance"][end], data.steps
    log_x = bool(x.size and x[0] > 0.0 and x[-1] > WIDE_DISTANCE * x[0])
    charts: list[Chart] = []

    def chart(
        name: str, title: str, unit: str, lines: list[Line], *, log: bool = True, note: str = ""
    ) -> None:
        lines = [line for line in lines if np.isfinite(line.y).any() and (line.y != 0.0).any()]
        if lines and not plot.reason(name):
            wide = log and is_wide(*(line.y for line in lines))
            charts.append(Chart(title.lower(), title, DISTANCE, unit, lines, note, name, log_x, wide))

    def line(column: str, name: str, colour: str, dash: str = "solid", factor: float = 1.0) -> Line:
        return Line(name, colour, over, factor * course[column][at], dash)

    def total(column: str, name: str, colour: str, dash: str = "solid", factor: float = 1.0) -> Line:
        return Line(name, colour, x, factor * history[column][end], dash)

    names = {area: name for area, name, *_ in AREAS}
    areas = [line(f"area_{key}", name, colour, dash) for key, name, colour, dash in AREAS]
    chart("areas", "Areas", "area, mm²", areas)
    film, shear = data.study.friction.film, about.shear.removesuffix(", as given")
    shear = f"{shear} of bare metal, {film.shear_strength:g} MPa under the film" if film else shear
    of_area = f"The area that shears: {names[about.friction_area]}; {shear}."
    cof = [line("cof", "coefficient of friction", "NEUTRAL")]
    chart("cof", "Coefficient of friction", "coefficient of friction, –", cof, log=False, note=of_area)
    pressures = [
        line("pressure_mean", "mean", "MEAN_PRESSURE"),
        line("pressure_max", "largest", "NEUTRAL", "dot"),
    ]
    if math.isfinite(data.study.hardness):
        pressures.append(Line("hardness", "HARDNESS", over, np.full(over.size, data.study.hardness), "dash"))
    note = "The largest is one cell's: it falls from the hardness at once when the last cell leaves it."
    drops = math.isfinite(data.study.hardness) and bool(
        (course["pressure_max"][0] > 0.99 * data.study.hardness)
        & (course["pressure_max"][-1] < 0.9 * data.study.hardness)
    )
    chart("pressure", "Pressure", "pressure in contact, MPa", pressures, note=note if drops else "")
    bodies = (("sphere", about.slider, "SPHERE", "dash"), ("disc", "disc", "DISC", "solid"))
    for name, title, unit, factor in (
        ("wear_volume", "Worn volume", "worn volume, 10⁻³ mm³", 1e3),
        ("wear_depth", "Wear depth", "depth of the deepest cell, µm", 1e3),
    ):
        lost = [total(f"{name}_{b}", label, colour, dash, factor) for b, label, colour, dash in bodies]
        chart("volumes", title, unit, lost, log=False)
    if data.study.film is not None:
        bare = [line("bare_fraction", "bare, of the area in contact", "DISC")]
        fit = data.bare_fit
        if not isinstance(fit, str):
            bare.append(Line("fitted course", "NEUTRAL", over, fit.at(over), "dash"))
        chart("bare_fraction", "Bare of film", "bare fraction, –", bare, log=False)
    text = "Move over a chart to read its values."
    if whole > POINTS:
        text += f" Of {whole} steps about {POINTS} are shown, as they are; history.csv has all."
    return Section("Courses", charts, "courses", text)


def pieces(plot: Plotter, data: FigureData) -> Section:
    """How many pieces have left each body in a distance, and how wide they were."""
    title = "Pieces that have left"
    if plot.reason("pieces"):
        return Section(title, [])
    history, found, about = data.history, data.pieces, data.about
    slid, ends = np.append(0.0, history["distance"]), np.linspace(0.0, history["distance"][-1], BINS + 1)
    rates, sizes, said = [], [], []
    for body, colour, dash in (("sphere", "SPHERE", "dash"), ("disc", "DISC", "solid")):
        name, cut = about.name_of(body), 1e3 * found.cut[body]
        left = np.append(0.0, np.cumsum(history[f"pieces_{body}"]))
        rate = np.diff(np.interp(ends, slid, left)) / np.diff(ends)
        rates.append(Line(name, colour, 0.5 * (ends[1:] + ends[:-1]), rate, dash))
        if cut.size:
            at = chosen(cut.size, POINTS)
            sizes.append(Line(name, colour, cut[at], (np.array(at) + 1.0) / cut.size, dash))
        told = f"{left[-1]:.0f} off the {name}"
        said.append(f"{told}, {np.median(cut):.3g} µm wide in the median" if cut.size else told)
    if found.asked is not None:
        d = np.full(2, 1e3 * found.asked)
        sizes.append(Line("asked for, d*", "HARDNESS", d, np.array([0.0, 1.0]), "dot"))
    note = "Those of a disc are counted on its whole stroke, of which a track may stand for a part."
    charts = [
        Chart(
            "rates", "Pieces in a distance", DISTANCE, "pieces per mm of sliding, 1/mm", rates, note, "pieces"
        ),
        Chart("sizes", "How wide they are", "diameter as cut, µm", "share of pieces up to it, –", sizes),
    ]
    return Section(title, charts, "pieces", "; ".join(said) + ".")
