"""What is fit to print: checks of a drawn figure, shared by tests."""

import itertools
import re
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.text import Text

from warpwear import Result
from warpwear.figures.of_run import words
from warpwear.figures.of_run.table import FIGURES


def left_out_for(*reasons: words.Reason) -> set[str]:
    """Names of the figures that the table leaves out for one of these reasons."""
    return {name for name, entry in FIGURES.items() if {*reasons} & {*entry.reasons}}


OF_TRACKS = left_out_for(words.STILL)
OF_PATCHES = left_out_for(words.ONE_SCALE)
OF_STRESSES = left_out_for(words.NO_STRESSES)
OF_FRETTING = left_out_for(words.NO_FRETTING)
OF_FILMS = left_out_for(words.NO_FILM) | left_out_for(words.NO_LAYERS)


def is_map(axes: Axes) -> bool:
    """Whether axes show a map, and not lines or a scale of colours."""
    return bool(axes.images) and not hasattr(axes, "_colorbar")


def drawn(result: Result, name: str) -> tuple[Figure, Any]:
    """A figure of a result, laid out, and the renderer that knows where its texts are."""
    figure: Figure = getattr(result.plot, name)()
    figure.draw_without_rendering()
    return figure, figure.canvas.get_renderer()  # type: ignore[attr-defined]


def axes_of(figure: Figure) -> list[Axes]:
    """All axes: panels, colour bars, secondary axes."""
    return [child for axes in figure.axes for child in (axes, *axes.child_axes)]


def axes_lines(axes: Axes) -> list[Any]:
    """The axis objects of x, y and z that these axes have."""
    return [getattr(axes, f"{n}axis") for n in "xyz" if hasattr(axes, f"{n}axis")]


def shown_ticks(axis: Any) -> list[Text]:
    """Labels of the ticks that lie inside the axis's view."""
    low, high = sorted(axis.get_view_interval())
    room = 1e-9 * (high - low)
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    inside = [t for t in ticks if low - room <= t.get_loc() <= high + room]
    labels = [label for t in inside for label in (t.label1, t.label2)]
    return [label for label in labels if label.get_visible() and label.get_text()]


def texts_of(figure: Figure) -> list[Text]:
    """Every text that the figure shows: labels, ticks, titles, notes and legends."""
    found: list[Text] = []
    for axes in axes_of(figure):
        for axis in axes_lines(axes):
            found += [axis.label, *shown_ticks(axis)]
        found += [axes.title, *axes.texts]
    for legend in figure.legends:
        found += legend.get_texts()
    return [text for text in found if text.get_visible() and text.get_text()]


def outline(text: Text, renderer: Any) -> Polygon:
    """Corners of a text, turned as it is and half a pixel smaller on each side [pixels]."""
    turned = text.get_window_extent(renderer)
    angle = text.get_rotation()
    text.set_rotation(0.0)
    flat = text.get_window_extent(renderer)
    text.set_rotation(angle)
    half = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [flat.width - 1.0, flat.height - 1.0]
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    middle = np.array([turned.x0 + turned.x1, turned.y0 + turned.y1]) / 2.0
    return Polygon(half @ np.array([[c, s], [-s, c]]) + middle)


def is_empty(axes: Axes) -> bool:
    """Whether no image, line or collection of the axes shows a number."""
    values = [image.get_array() for image in axes.images]
    values += [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines]
    if any(np.isfinite(np.ma.filled(v, np.nan)).any() for v in values if v is not None):
        return False
    return not axes.collections


def faults_of(where: str, figure: Figure, renderer: Any) -> list[str]:
    """A sentence for everything of a figure that is not fit to print; `where` opens each."""
    faults: list[str] = []
    if figure.get_figwidth() not in (3.5, 7.0):
        faults.append(f"{where}: {figure.get_figwidth()} inch is no column's width")
    for axes in axes_of(figure):
        if axes in figure.axes and not hasattr(axes, "_colorbar") and is_empty(axes):
            faults.append(f"{where}: an empty panel")
        for axis in axes_lines(axes):
            label = axis.label.get_text()
            if shown_ticks(axis) and not re.search(
                r", (–|mm|mm²|µm|MPa|N|J|mJ|s|min|h|10⁻³ mm³|µm⁴|1/mm)$", label
            ):
                faults.append(f"{where}: an axis without a unit: '{label}'")
    texts = [(text.get_text(), outline(text, renderer)) for text in texts_of(figure)]
    for (a, outline_a), (b, outline_b) in itertools.combinations(texts, 2):
        if outline_a.get_path().intersects_path(outline_b.get_path()):
            faults.append(f"{where}: '{a}' and '{b}' overlap")
    for text, shape in texts:
        low, high = shape.get_xy().min(axis=0), shape.get_xy().max(axis=0)
        if (low < -1.0).any() or (high > np.array([figure.bbox.x1, figure.bbox.y1]) + 1.0).any():
            faults.append(f"{where}: '{text}' leaves the page")
    for axes, other in itertools.permutations(figure.axes, 2):
        if axes.title.get_text() and axes.title.get_window_extent(renderer).overlaps(other.bbox):
            faults.append(f"{where}: '{axes.title.get_text()}' runs into another panel")
    small = [t.get_text() for t in texts_of(figure) if float(t.get_fontsize()) < 7.0]
    if small:
        faults.append(f"{where}: {small} too small to read")
    return faults
