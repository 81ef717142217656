"""What a run's page plots, as plain arrays: courses, sections, maps over the snapshots, bodies in 3-D.

Colours are names of `warpwear.figures.style` and arrays stay arrays, so that nothing here draws; the page's
script does, of what `warpwear.page.html` writes into the page.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from warpwear.figures.data import FigureData
from warpwear.figures.table import Plotter
from warpwear.grid import FloatArray

#: Most points of a line, snapshots under a slider, points along a side of a map and of a body in 3-D.
POINTS, SNAPSHOTS, SIDE, BODY_SIDE = 1500, 12, 500, 250
#: Snapshots whose maps may have the full number of points: more of them get coarser.
FULL_MAPS = 6
#: Values over more than this many times the least are drawn on a logarithmic scale; distances alike.
WIDE, WIDE_DISTANCE = 5.0, 30.0
#: Largest span of a logarithmic scale of pressures, and the percentage of places that may lie below it.
SPAN, BELOW = 1e3, 2.0
AREAS = (
    ("contact", "in contact", "CONTACT", "solid"),
    ("plastic", "at hardness", "HARDNESS", "dot"),
    ("touched", "ever touched", "TOUCHED", "dash"),
    ("nominal", "nominal (scar)", "NOMINAL", "dashdot"),
    ("cumulative", "running sum", "SUM", "longdash"),
)
PARAMETERS = (
    ("sk", "Sk", "NOMINAL", "dashdot"),
    ("svk", "Svk", "TOUCHED", "dash"),
    ("sq", "Sq", "HARDNESS", "solid"),
    ("sa", "Sa", "SUM", "solid"),
    ("spk", "Spk", "MEAN_PRESSURE", "dot"),
)
STATES = (
    ("never touched", "clear"),
    ("touched before", "TOUCHED"),
    ("in contact", "CONTACT"),
    ("at hardness", "HARDNESS"),
)
DISTANCE = "sliding distance, mm"


@dataclass(frozen=True)
class Line:
    """A line of a chart. x, y: (points,), of one length."""

    name: str
    colour: str
    x: FloatArray
    y: FloatArray
    dash: str = "solid"
    markers: bool = False
    wide: bool = False


@dataclass(frozen=True)
class Chart:
    """Lines over one axis. static: the figure of the run that shows the same, for a page without scripts."""

    id: str
    title: str
    x: str
    y: str
    lines: list[Line]
    caption: str = ""
    static: str = ""
    log_x: bool = False
    log_y: bool = False
    kind: str = "chart"


@dataclass(frozen=True)
class Coded:
    """An array as whole numbers of few bits: value = low + step · code, of its logarithm to 10 where `log`.

    codes: uint8 or uint16, 0 where there is no value.
    """

    codes: "np.ndarray[Any, Any]"
    low: float
    step: float
    log: bool = False

    @classmethod
    def of(cls, values: FloatArray, low: float, high: float, *, bits: int = 8, log: bool = False) -> "Coded":
        """Code the finite values (above zero, where `log`) between low and high; beyond these the nearest."""
        most = 2**bits - 2
        known = np.isfinite(values) & ((values > 0.0) | (not log))
        shown = np.where(known, values, low)
        if log:
            low, high, shown = math.log10(low), math.log10(high), np.log10(shown)
        step = (high - low) / most or 1.0
        codes = np.where(known, 1.0 + np.clip(np.rint((shown - low) / step), 0.0, most), 0.0)
        return cls(codes.astype(f"u{bits // 8}"), float(low - step), float(step), log)


@dataclass(frozen=True)
class Map:
    """A field at each of some distances. extent: first x, last x, first y, last y [mm].

    fields: one a distance, shape (x, y). says: a sentence a field. states: label and colour of each code of a
    field that holds states. scale: "PRESSURES" or "LOADS".
    """

    id: str
    title: str
    labels: list[str]
    extent: tuple[float, ...]
    fields: list[Coded]
    says: list[str]
    unit: str = ""
    states: tuple[tuple[str, str], ...] = ()
    caption: str = ""
    static: str = ""
    kind: str = "map"


@dataclass(frozen=True)
class Bodies:
    """Bodies in 3-D by name, heights [µm], (x, y). extent: first x, last x, first y, last y [mm]."""

    id: str
    title: str
    extent: tuple[float, ...]
    bodies: dict[str, Coded]
    caption: str
    static: str = "setup"
    kind: str = "bodies"


@dataclass(frozen=True)
class Section:
    """Plots under one heading, which share a slider where they have one."""

    title: str
    plots: list[Any]
    id: str = ""
    text: str = ""
    slider: list[str] = field(default_factory=list)


def sections_of(plot: Plotter) -> list[dict[str, Any]]:
    """Collect the plots of a run under their headings, in the order of the page, as plain content."""
    with plot.data as data:
        found = [section for make in SECTIONS if (section := make(plot, data)).plots]
    return [asdict(section) for section in found]


def chosen(count: int, most: int) -> list[int]:
    """Choose at most so many of `count` numbers, the first and the last among them."""
    return sorted({round(float(at)) for at in np.linspace(0, count - 1, min(most, count))})


def thinned(distance: FloatArray) -> "np.ndarray[Any, Any]":
    """Choose at most about `POINTS` steps: evenly in number and in the distance's logarithm."""
    count = distance.size
    if count <= POINTS:
        return np.arange(count)
    first = max(float(distance[0]), 1e-6 * float(distance[-1]))
    spaced = np.searchsorted(distance, np.geomspace(first, float(distance[-1]), POINTS // 2))
    evenly = np.linspace(0, count - 1, POINTS // 2).round().astype(int)
    return np.unique(np.concatenate([evenly, np.minimum(spaced, count - 1)]))


def is_wide(*values: FloatArray) -> bool:
    """Tell whether values above zero differ so much that they need a logarithmic scale."""
    known = np.concatenate([np.ravel(v)[np.isfinite(np.ravel(v)) & (np.ravel(v) > 0.0)] for v in values])
    return bool(known.size and known.max() >= WIDE * known.min())


def after(distance: float) -> str:
    """Say in words when a snapshot was taken. distance: [mm]"""
    return f"after {distance:.4g} mm" if distance else "static contact"


def _maps(plot: Plotter, data: FigureData) -> Section:
    """Pressure and state of contact over the snapshots, in the window of the scar."""
    if plot.reason("pressure_map"):
        return Section("Contact and pressure", [])
    indices = chosen(data.result.snapshot_distances.size, SNAPSHOTS)
    side = int(SIDE * min(1.0, math.sqrt(FULL_MAPS / len(indices))))
    kept = dict(zip(data.shown, data.views, strict=True)) if side == SIDE else {}
    views = [kept.get(index) or data.view(index, most=side) for index in indices]
    history, labels = data.history, [after(view.distance) for view in views]
    means, scatter, area = (history[name] for name in ("pressure_mean", "pressure_std", "area_contact"))
    most = max(float(view.pressure.max()) for view in views) or 1.0
    log = most > WIDE * min(float(means[view.row]) for view in views)
    low = 0.0
    if log:
        seen = [v.pressure[v.pressure > 0.0] for v in views if v.pressure.any()]
        low = max(0.8 * min(float(np.percentile(values, BELOW)) for values in seen), most / SPAN)
    pressures = [Coded.of(np.where(v.pressure > 0.0, v.pressure, np.nan), low, most, log=log) for v in views]
    window = data.window_of(side)
    states = [Coded(view.state, 0.0, 1.0) for view in views]
    caption = "A point is a cell."
    if window.factor > 1:
        caption = (
            f"A point is {window.factor} × {window.factor} cells and shows the largest of them, so that "
            "areas look larger than the numbers say."
        )
    return Section(
        "Contact and pressure",
        [
            Map(
                "pressure_map",
                "Pressure in contact",
                labels,
                window.extent,
                pressures,
                [f"mean {means[v.row]:.4g}, standard deviation {scatter[v.row]:.3g} MPa" for v in views],
                unit="MPa",
                static="pressure_map",
            ),
            Map(
                "contact_map",
                "State of contact",
                labels,
                window.extent,
                states,
                [f"{area[v.row]:.4g} mm² in contact" for v in views],
                states=STATES,
                static="contact_map",
            ),
        ],
        "maps",
        caption,
        labels,
    )


def _courses(plot: Plotter, data: FigureData) -> Section:
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
    of_area = f"The area that shears: {names[about.friction_area]}; {about.shear.removesuffix(', as given')}."
    cof = [line("cof", "coefficient of friction", "NEUTRAL")]
    chart("cof", "Coefficient of friction", "coefficient of friction, –", cof, log=False, note=of_area)
    pressures = [
        line("pressure_mean", "mean", "MEAN_PRESSURE"),
        line("pressure_max", "largest", "NEUTRAL", "dot"),
    ]
    if math.isfinite(data.study.hardness):
        pressures.append(Line("hardness", "HARDNESS", over, np.full(over.size, data.study.hardness), "dash"))
    chart("pressure", "Pressure", "pressure in contact, MPa", pressures)
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
    if data.study.wear.sheds:
        left = [
            Line(label, colour, x, np.cumsum(history[f"pieces_{b}"])[end], dash)
            for b, label, colour, dash in bodies
        ]
        chart("pieces", "Pieces that have left", "number of pieces, –", left, log=False)
    text = "Move over a chart to read its values."
    if whole > POINTS:
        text += f" Of {whole} steps about {POINTS} are shown, as they are; history.csv has all."
    return Section("Courses", charts, "courses", text)


def _profiles(plot: Plotter, data: FigureData) -> Section:
    """Both bodies before and after, in contact, through the middle."""
    if plot.reason("profiles"):
        return Section("The scar in section", [])
    view = data.views[-1]
    approach, slider = float(data.history["approach"][view.row]), data.about.slider
    charts = []
    for cut, title in ((view.along, "Along the sliding direction"), (view.across, "Across it")):
        sphere, disc = cut.sphere - approach, cut.disc
        found = (
            ("disc before", "NOMINAL", disc + cut.wear_disc, "dot", False),
            (f"{slider} before", "SPHERE", sphere - cut.wear_sphere, "dash", False),
            (f"{slider} after", "TOUCHED", sphere, "solid", True),
            ("disc after", "DISC", disc, "solid", False),
        )
        lines = [Line(name, c, cut.place, 1e3 * y, dash, wide=wide) for name, c, y, dash, wide in found]
        charts.append(
            Chart(title.lower(), title, "place, mm", "height over the disc, µm", lines, static="profiles")
        )
    text = "Through the middle, at the end, in contact. Before: without the wear of the run."
    return Section("The scar in section", charts, "profiles", text)


def _roughness(plot: Plotter, data: FigureData) -> Section:
    """Height parameters of the disc in the scar, or in the groove of a track."""
    swept = data.study.is_swept
    name = "track_roughness" if swept else "roughness"
    if plot.reason(name):
        return Section("Roughness in the scar", [])
    table = data.track_roughness if swept else data.roughness
    x = table["passes" if swept else "distance"]
    lines = [Line(label, colour, x, table[key], dash, True) for key, label, colour, dash in PARAMETERS]
    label, unit = (
        ("passes, –", "roughness in the groove, µm") if swept else (DISTANCE, "roughness in the scar, µm")
    )
    log_x = not swept and bool(x[0] > 0.0 and x[-1] > WIDE_DISTANCE * x[0])
    place = "groove" if swept else "scar"
    label, unit = "passes, –" if swept else DISTANCE, f"roughness in the {place}, µm"
    caption = f"Height parameters (ISO 25178-2) of the disc in the middle of the {place}, its form taken off."
    title = f"Roughness in the {place}"
    return Section(title, [Chart("roughness", title, label, unit, lines, caption, name, log_x)], "roughness")


def _groove(plot: Plotter, data: FigureData) -> Section:
    """Cross-section of the groove at the snapshots, and its depth along the track."""
    if plot.reason("groove"):
        return Section("The groove", [])
    shades = ("TOUCHED", "SUM", "NOMINAL", "DISC")[-len(data.grooves) :]
    dashes = ("dot", "dashdot", "dash", "solid")[-len(data.grooves) :]
    sections = [
        Line(after(g.distance), colour, g.y, -1e3 * g.depth, dash)
        for g, colour, dash in zip(data.grooves, shades, dashes, strict=True)
    ]
    places, depths = data.depth_along
    along, change = [Line("at the end", "DISC", places, -1e3 * depths)], "change of height, µm"
    return Section(
        "The groove",
        [
            Chart("across", "Mean section of the groove", "across, mm", change, sections, static="groove"),
            Chart("along", "Depth along the track", "along, mm", change, along),
        ],
        "groove",
    )


def _loads(plot: Plotter, data: FigureData) -> Section:
    """Loads of the patches over their area, beside those of a smooth contact."""
    if plot.reason("load_share"):
        return Section("Load shares", [])
    loads, labels = data.loads, [after(distance) for distance in data.distances]
    most, log = max(float(of.max()) for of in loads.of.values()), is_wide(*loads.of.values())
    least = min(float(of[of > 0.0].min(initial=most)) for of in loads.of.values())
    low = max(least, most / SPAN) if log else 0.0
    apart = ["as prescribed"] * len(labels)
    if loads.apart and not loads.prescribed:
        apart = [f"{100.0 * part:.2g} % of the load on other patches" for part in loads.apart]
    maps = [
        Map(
            f"load_{number}",
            f"Load over area: {name}",
            labels,
            loads.window.extent,
            [Coded.of(np.where(of > 0.0, of, np.nan), low, most, log=log) for of in fields],
            apart if number else [""] * len(labels),
            unit="MPa",
            static="" if number else "load_share",
        )
        for number, (name, fields) in enumerate(loads.of.items())
    ]
    return Section("Load shares of the patches", maps, "loads", "", labels)


def _bodies(plot: Plotter, data: FigureData) -> Section:
    """Both bodies at the end and before, to turn by hand."""
    if plot.reason("setup"):
        return Section("The bodies in 3-D", [])
    found, window = data.bodies_at(data.shown[-1], most=BODY_SIDE), data.window_of(BODY_SIDE)
    slider = data.about.slider
    of = {
        "disc, worn": found.disc,
        "disc, before": found.disc + found.wear_disc,
        f"{slider}, worn": found.sphere,
        f"{slider}, before": found.sphere + found.wear_sphere,
    }
    bodies = {}
    for name, heights in of.items():
        known = heights[np.isfinite(heights)]
        if known.size:
            low, high = 1e3 * float(known.min()), 1e3 * float(known.max())
            bodies[name] = Coded.of(1e3 * heights, low, high, bits=16)
    side = 1e3 * window.factor * data.about.cell
    caption = (
        f"Mean heights of squares of {side:.3g} µm, positive out of the material, so that the {slider} lies "
        f"turned "
        "over. Heights are drawn larger than places. Drag to turn, wheel to zoom; on the keyboard the arrow "
        "keys, + and −."
    )
    return Section(
        "The bodies in 3-D", [Bodies("bodies", "The bodies", window.extent, bodies, caption)], "bodies-3d"
    )


SECTIONS: tuple[Callable[[Plotter, FigureData], Section], ...] = (
    _maps,
    _courses,
    _profiles,
    _roughness,
    _groove,
    _loads,
    _bodies,
)
