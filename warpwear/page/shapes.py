"""Shapes of a run's page: both bodies in section, roughness, the groove of a track, bodies in 3-D."""

import numpy as np

from warpwear.figures.data import FigureData
from warpwear.figures.table import Plotter
from warpwear.page.parts import DISTANCE, WIDE_DISTANCE, Bodies, Chart, Coded, Line, Section, after

#: Points along a side of a body in 3-D.
BODY_SIDE = 250
PARAMETERS = (
    ("sk", "Sk", "NOMINAL", "dashdot"),
    ("svk", "Svk", "TOUCHED", "dash"),
    ("sq", "Sq", "HARDNESS", "solid"),
    ("sa", "Sa", "SUM", "solid"),
    ("spk", "Spk", "MEAN_PRESSURE", "dot"),
)


def profiles(plot: Plotter, data: FigureData) -> Section:
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
    text = (
        "Through the middle, at the end, in contact, without elastic deformation: where the bodies overlap, "
        "they are pressed in. Before: without the wear of the run."
    )
    return Section("The scar in section", charts, "profiles", text)


def roughness(plot: Plotter, data: FigureData) -> Section:
    """Height parameters of the disc in the scar, or in the groove of a track."""
    swept = data.study.is_swept
    name = "track_roughness" if swept else "roughness"
    if plot.reason(name):
        return Section("Roughness in the scar", [])
    table = data.track_roughness if swept else data.roughness
    x = table["passes" if swept else "distance"]
    lines = [
        Line(label, colour, x, table[key], dash, "lines+markers") for key, label, colour, dash in PARAMETERS
    ]
    log_x = not swept and bool(x[0] > 0.0 and x[-1] > WIDE_DISTANCE * x[0])
    place = "groove" if swept else "scar"
    label, unit = "passes, –" if swept else DISTANCE, f"roughness in the {place}, µm"
    caption = f"Height parameters (ISO 25178-2) of the disc in the middle of the {place}, its form taken off."
    title = f"Roughness in the {place}"
    return Section(title, [Chart("roughness", title, label, unit, lines, caption, name, log_x)], "roughness")


def groove(plot: Plotter, data: FigureData) -> Section:
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


def bodies(plot: Plotter, data: FigureData) -> Section:
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
    coded = {}
    for name, heights in of.items():
        known = heights[np.isfinite(heights)]
        if known.size:
            low, high = 1e3 * float(known.min()), 1e3 * float(known.max())
            coded[name] = Coded.of(1e3 * heights, low, high, bits=16)
    side = 1e3 * window.factor * data.about.cell
    caption = (
        f"Mean heights of squares of {side:.3g} µm, positive out of the material, so that the {slider} "
        "lies turned "
        "over. Heights are drawn larger than places. Drag to turn, wheel to zoom; on the keyboard the arrow "
        "keys, + and −."
    )
    still = [name for name in coded if name.endswith("worn")]
    shown = Bodies("bodies", "The bodies", window.extent, coded, still, caption)
    return Section("The bodies in 3-D", [shown], "bodies-3d")
