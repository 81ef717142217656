"""Sections of a run's page: which figures stand under which heading, and what is said of them."""

import math
from collections.abc import Callable

import numpy as np

from warpwear.figures.describe import Figure, Section
from warpwear.figures.of_run import shape
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.table import FIGURES, Plotter
from warpwear.figures.wording import chosen
from warpwear.page.plots import POINTS

#: What is said of sections through the middle.
IN_SECTION = (
    "Through the middle, at the end, in contact, without elastic deformation: where the bodies overlap, they "
    "are pressed in. Unworn: without the wear of the run."
)
#: What is said of the cycles of a fretting run.
IN_CYCLES = "Loops, energies and slips of single cycles, of many that jumps stand for."
#: Most snapshots under a slider, and points along a side of a map.
SNAPSHOTS, SIDE = 12, 500
#: Snapshots whose maps may have the full number of points: more of them get coarser.
FULL_MAPS = 6


def _figures(plot: Plotter, data: FigureData, *names: str) -> dict[str, Figure]:
    """Declare those of some figures that the run has. data: those of the plot, or more snapshots."""
    return {
        name: plot.declared(name) if data is plot.data else FIGURES[name].declare(data)
        for name in names
        if not plot.reason(name)
    }


def _of_section(section: str) -> list[str]:
    """Name the figures that are declared for a section, in the order of their declaration."""
    return [name for name, entry in FIGURES.items() if entry.section == section]


def maps(plot: Plotter, data: FigureData) -> Section:
    """Show pressure and state of contact over more snapshots than paper holds, in the window of the scar."""
    indices = chosen(data.result.snapshot_distances.size, SNAPSHOTS)
    more = data.with_snapshots(indices, int(SIDE * min(1.0, math.sqrt(FULL_MAPS / max(len(indices), 1)))))
    figures = _figures(plot, more, *_of_section("maps"))
    text = ""
    if figures:
        n = more.window.factor
        text = "A point is a cell."
        if n > 1:
            text = (
                f"A point is {n} × {n} cells and shows the largest of them, so that areas look larger than "
                "the numbers say."
            )
    return Section("Contact and pressure", figures, "maps", text)


def courses(plot: Plotter, data: FigureData) -> Section:
    """Show everything that has one value a step."""
    figures = _figures(plot, data, *_of_section("courses"))
    text = "Move over a chart to read its values."
    if data.steps > POINTS:
        text += f" Of {data.steps} steps about {POINTS} are shown, as they are; history.csv has all."
    return Section("Courses", figures, "courses", text)


def pieces(plot: Plotter, data: FigureData) -> Section:
    """Show how many pieces have left each body in a distance, and how wide they were."""
    figures = _figures(plot, data, "pieces")
    texts = []
    for body, diameters in data.pieces.items() if figures else ():
        cut, name = 1e3 * diameters, data.name_of(body)
        text = f"{data.history[f'pieces_{body}'].sum():.0f} off the {name}"
        texts.append(f"{text}, {np.median(cut):.3g} µm wide in the median" if cut.size else text)
    text = (
        "; ".join(texts)
        + ". Those of a disc are counted on its whole stroke, of which a track may stand for a part."
    )
    return Section("Pieces that have left", figures, "pieces", text)


def stresses(plot: Plotter, data: FigureData) -> Section:
    """Show what lies below the disc's surface."""
    text = (
        "Elastic, of the pressure and of friction towards greater x: nothing has yielded in it, and what a "
        "yield strength would take off is not taken off. At the edge behind, tension grows as cells shrink."
    )
    figures = _figures(plot, data, "stress_map", "stress_depths")
    return Section("Stress below the surface", figures, "stresses", text)


def roughness(plot: Plotter, data: FigureData) -> Section:
    """Show the disc's height parameters in the scar, or in the groove of a track."""
    place, name = data.groove, "track_roughness" if data.study.is_swept else "roughness"
    text = f"Height parameters (ISO 25178-2) of the disc in the middle of the {place}, its form taken off."
    return Section(f"Roughness in the {place}", _figures(plot, data, name), "roughness", text)


def _of_one(name: str, title: str, text: str = "") -> Callable[[Plotter, FigureData], Section]:
    """Show one figure under a heading."""
    return lambda plot, data: Section(title, _figures(plot, data, name), name, text)


def bodies(plot: Plotter, data: FigureData) -> Section:
    """Show both bodies at the end and before, to turn by hand."""
    figures = {} if plot.reason("setup") else {"bodies": shape.turned_bodies(data)}
    return Section("The bodies in 3-D", figures, "bodies-3d")


#: What makes each section of a run's page, in the page's order.
SECTIONS: tuple[Callable[[Plotter, FigureData], Section], ...] = (
    maps,
    courses,
    pieces,
    lambda plot, data: Section(
        "Fretting", _figures(plot, data, *_of_section("fretting")), "fretting", IN_CYCLES
    ),
    _of_one("profiles", "The scar in section", IN_SECTION),
    stresses,
    roughness,
    lambda plot, data: _of_one("groove", f"The {data.groove} of the disc")(plot, data),
    _of_one("load_share", "Load shares of the patches", "Load over the area of each macro cell."),
    bodies,
)
