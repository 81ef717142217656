"""Sections of a run's page: which figures stand under which heading, and what is said of them."""

import math

import numpy as np

from warpwear.errors import prose
from warpwear.figures.of_run import shape
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.table import FIGURES, Plotter
from warpwear.figures.of_run.words import TemplateFields
from warpwear.figures.sections import PageSection, under_headings
from warpwear.figures.wording import chosen
from warpwear.page.plots import POINTS

#: Most snapshots under a slider, and points along a side of a map.
SNAPSHOTS, SIDE = 12, 500
#: Snapshots whose maps may have the full number of points: more of them get coarser.
FULL_MAPS = 6
#: Anchor of a section -> its heading and what is said of it, with fields; in the page's order.
SECTIONS = prose("sections")


def sections_of(plot: Plotter, data: FigureData) -> list[PageSection]:
    """Lay the figures that a run has under the headings of its page. data: those of the plot."""
    indices = chosen(data.result.snapshot_distances.size, SNAPSHOTS)
    more = data.with_snapshots(indices, int(SIDE * min(1.0, math.sqrt(FULL_MAPS / max(len(indices), 1)))))
    inside: dict[str, list[str]] = {anchor: [] for anchor in SECTIONS}
    figures = {}
    for name, entry in FIGURES.items():
        if entry.section and not plot.reason(name):
            inside[entry.section].append(name)
            # more snapshots than paper holds, in the window of the scar
            is_map = entry.section == "maps" and more is not data
            figures[name] = entry.declare(more) if is_map else plot.declared(name)
    if not plot.reason("setup"):  # else there is nothing to turn by hand
        inside["bodies-3d"], figures["bodies"] = ["bodies"], shape.turned_bodies(data)
    layout = [
        (SECTIONS[anchor]["title"], anchor, some, SECTIONS[anchor]["text"]) for anchor, some in inside.items()
    ]
    return under_headings(figures, layout, fields=TemplateFields(more, FIELDS))


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
