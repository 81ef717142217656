"""Sections of a run's page: which figures stand under which heading, and what is said of them."""

import math

import numpy as np

from warpwear.figures.of_run import shape
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.table import FIGURES, Plotter
from warpwear.figures.of_run.words import Fields
from warpwear.figures.sections import Section, under_headings
from warpwear.figures.wording import chosen
from warpwear.page.plots import POINTS

#: Most snapshots under a slider, and points along a side of a map.
SNAPSHOTS, SIDE = 12, 500
#: Snapshots whose maps may have the full number of points: more of them get coarser.
FULL_MAPS = 6


def _of_section(section: str) -> list[str]:
    """Name the figures that are declared for a section, in the order of their declaration."""
    return [name for name, entry in FIGURES.items() if entry.section == section]


#: Figures that show more snapshots than paper holds, in the window of the scar.
MAPS = _of_section("maps")
#: Heading, anchor, figures, and what is said of them, with fields; in the page's order.
LAYOUT = (
    ("Contact and pressure", "maps", MAPS, "{points}"),
    ("Courses", "courses", _of_section("courses"), "Move over a chart to read its values.{steps}"),
    (
        "Pieces that have left",
        "pieces",
        ["pieces"],
        "{left}. Those of a disc are counted on its whole stroke, of which a track may stand for a part.",
    ),
    (
        "Fretting",
        "fretting",
        _of_section("fretting"),
        "Loops, energies and slips of single cycles, of many that jumps stand for.",
    ),
    (
        "The scar in section",
        "profiles",
        ["profiles"],
        "Through the middle, at the end, in contact, without elastic deformation: where the bodies overlap, "
        "they are pressed in. Unworn: without the wear of the run.",
    ),
    (
        "Stress below the surface",
        "stresses",
        ["stress_map", "stress_depths"],
        "Elastic, of the pressure and of friction towards greater x: nothing has yielded in it, and what a "
        "yield strength would take off is not taken off. At the edge behind, tension grows as cells shrink.",
    ),
    (
        "Roughness in the {groove}",
        "roughness",
        ["roughness", "track_roughness"],
        "Height parameters (ISO 25178-2) of the disc in the middle of the {groove}, its form taken off.",
    ),
    ("The {groove} of the disc", "groove", ["groove"], ""),
    (
        "Load shares of the patches",
        "load_share",
        ["load_share"],
        "Load over the area of each macro cell.",
    ),
    ("The bodies in 3-D", "bodies-3d", ["bodies"], ""),
)


def sections_of(plot: Plotter, data: FigureData) -> list[Section]:
    """Lay the figures that a run has under the headings of its page. data: those of the plot."""
    indices = chosen(data.result.snapshot_distances.size, SNAPSHOTS)
    more = data.with_snapshots(indices, int(SIDE * min(1.0, math.sqrt(FULL_MAPS / max(len(indices), 1)))))
    names = [name for _, _, some, _ in LAYOUT for name in some if name in FIGURES and not plot.reason(name)]
    figures = {
        name: FIGURES[name].declare(more) if name in MAPS and more is not data else plot.declared(name)
        for name in names
    }
    if not plot.reason("setup"):  # else there is nothing to turn by hand
        figures["bodies"] = shape.turned_bodies(data)
    return under_headings(figures, LAYOUT, fields=Fields(more, FIELDS))


def _points(data: FigureData) -> str:
    n = data.window.factor
    larger = f"{n} × {n} cells and shows the largest of them, so that areas look larger than the numbers say."
    return f"A point is {larger if n > 1 else 'a cell.'}"


def _steps(data: FigureData) -> str:
    """Say that not all steps are shown, where that is so."""
    some = f" Of {data.steps} steps about {POINTS} are shown, as they are; history.csv has all."
    return some if data.steps > POINTS else ""


def _left(data: FigureData) -> str:
    """Say how many pieces have left each body, and how wide they were."""
    texts = []
    for body, diameters in data.pieces.items():
        text = f"{data.history[f'pieces_{body}'].sum():.0f} off the {data.name_of(body)}"
        median = f", {1e3 * np.median(diameters):.3g} µm wide in the median" if diameters.size else ""
        texts.append(text + median)
    return "; ".join(texts)


#: Field of a heading or a text -> what it says of a run, beside those of captions.
FIELDS = {"points": _points, "steps": _steps, "left": _left}
