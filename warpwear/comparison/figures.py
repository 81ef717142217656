"""Figures of a comparison: the courses of runs and experiments, and worn profiles, laid over each other."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.comparison.area_load import area_load, has_loads
from warpwear.comparison.gather import BODIES, Comparison, RunData
from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS
from warpwear.grid import FloatArray
from warpwear.measured.course import Experiment, mean_of_last_tenth

COLOURS = (fs.SPHERE, fs.DISC, fs.CONTACT, fs.MEAN_PRESSURE, fs.SUM, fs.TOUCHED)
LINES = ("-", "--", "-.", ":", (0, (6, 1)), (0, (3, 1, 1, 1)))
#: Measured courses are grey: they are what the runs are held against.
GREYS = ("#000000", "#888888", "#555555")
MARKERS = ("o", "s", "^")
#: Parts that a measured course of many more points is averaged in, its scatter a band.
POINTS = 120
#: Markers along a measured course, about.
MARKED = 30
#: Height of a row of the legend [inch].
LEGEND_ROW = 0.15


def cof(axes: Any, comparison: Comparison) -> None:
    """Draw the coefficient of friction over the distance slid, and over its mean in the last tenth of it.

    A swept run has the means of its passes, if it made more than one.
    """
    for experiment, line in _experiments(comparison):
        for panel, end in zip(axes, (1.0, experiment.final_cof), strict=True):
            if end > 0.0:
                _measured(panel, experiment, end, line)
    for run, line in _runs(comparison):
        if run.cof is not None:
            distance, values = run.course
            if values.size < run.cof.size and values.size < 2:
                distance, values = run.history["distance"], run.cof
            fs.over_distance(axes[0], distance, values, **line)
            if run.study.friction.shear_strength is None:
                at = -1 if run.study.friction.calibrate == "end" else 0
                axes[0].plot(distance[at], values[at], "o", ms=4, mfc="white", mec=line["color"], zorder=3)
                axes[0].set_title("○: calibrated to this value")
            end = mean_of_last_tenth(distance, values)
            if values.size > 1 and end > 0.0:
                fs.over_distance(axes[1], distance, values / end, **line)
    given = sum(run.study.friction.fitted == "end" for run in comparison.runs)
    if given:
        axes[0].set_title(f"the end is an input of {given} of {len(comparison.runs)} runs")
    axes[0].set_ylabel("coefficient of friction, –")
    axes[1].set_ylabel("relative coefficient, –")
    axes[1].set_title("over its mean in the last tenth of the distance")
    for panel in axes:
        panel.set(xlabel="sliding distance, mm", xlim=(0.0, None), ylim=(0.0, None))


def area(axes: Axes, comparison: Comparison) -> None:
    """Draw the area in contact over the distance slid, both logarithmic."""
    for run, line in _runs(comparison):
        distance, values = run.history["distance"], run.history["area_contact"]
        fs.over_distance(axes, distance, np.where(values > 0.0, values, np.nan), **line)
    if _longest(comparison)[-1] > 0.0:  # not static contacts alone
        axes.set_xscale("log")
        fs.plain_numbers(axes.xaxis)
    fs.logarithmic(axes)
    axes.set_ylabel("area in contact, mm²")


def pressure(axes: Axes, comparison: Comparison) -> None:
    """Draw the mean pressure of the cells in contact over the distance slid."""
    for run, line in _runs(comparison):
        fs.over_distance(axes, run.history["distance"], run.history["pressure_mean"], **line)
    fs.scale_distance(axes, _longest(comparison))
    fs.scale_values(axes, *(run.history["pressure_mean"] for run in comparison.runs))
    axes.set_ylabel("mean pressure in contact, MPa")


def volumes(axes: Any, comparison: Comparison) -> None:
    """Draw the worn volume of sphere and disc over the distance slid."""
    for run, line in _runs(comparison):
        for panel, body in zip(axes, BODIES, strict=True):
            volume = 1.0e3 * run.history[f"wear_volume_{body}"]
            fs.over_distance(panel, run.history["distance"], volume, **line)
    for panel, body in zip(axes, BODIES, strict=True):
        panel.set_title(body)
        panel.set(ylabel="worn volume, 10⁻³ mm³", xlim=(0.0, None), ylim=(0.0, None))


def profiles(axes: Any, comparison: Comparison) -> None:
    """Draw the wear of sphere and disc across sliding at each run's end, mean of the scar's middle eighth.

    A track's is the mean cross-section of its groove.
    """
    reach = 0.0
    for run, line in _runs(comparison):
        for panel, body in zip(axes, BODIES, strict=True):
            if run.wear:
                depth = run.wear[body]
                panel.plot(run.across, -1.0e3 * depth, **(line | {"marker": ""}))
                reach = max(reach, float(np.abs(run.across[depth > 0.0]).max(initial=0.0)))
    for panel, body in zip(axes, BODIES, strict=True):
        panel.set_title(f"{body}, at the end")
        panel.set(xlabel=ACROSS, ylabel="height lost by wear, µm", ylim=(None, 0.0))
        panel.xaxis.set_major_locator(MaxNLocator(6))
        if reach > 0.0:
            panel.set_xlim(-1.15 * reach, 1.15 * reach)


def _laid_over(
    draw: Callable[[Any, Comparison], None],
    comparison: Comparison,
    *,
    panels: int = 1,
    measured: bool = False,
) -> Figure:
    """Make a figure with the legend over it, which makes the figure higher, not its panels lower.

    draw: gets the axes, one or an array of them. measured: the legend names the experiments, too.
    """
    lines: list[Experiment | RunData] = [*(comparison.experiments if measured else ()), *comparison.runs]
    width = fs.PAGE if panels > 1 else fs.COLUMN
    # The width holds this many names beside each other, a character some 0.055 inch and a line 0.45.
    longest = max(len(line.name) for line in lines)
    beside = max(1, min(len(lines), int(width / (0.055 * longest + 0.45))))

    def draw_all(axes: Any) -> None:
        draw(axes, comparison)
        fs.legend_above(*np.atleast_1d(axes), columns=beside)

    rows = -(-len(lines) // beside)
    return fs.new_figure(draw_all, columns=panels, height=fs.ROW + LEGEND_ROW * (rows - 1))


#: Name of the file -> how it is drawn.
FIGURES: dict[str, Callable[[Comparison], Figure]] = {
    "cof": partial(_laid_over, cof, panels=2, measured=True),
    "area": partial(_laid_over, area),
    "area_load": area_load,
    "pressure": partial(_laid_over, pressure),
    "volumes": partial(_laid_over, volumes, panels=2),
    "profiles": partial(_laid_over, profiles, panels=2),
}


def drawn(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Draw each figure that has something to show, with its name."""
    known = bool(comparison.experiments) or any(run.cof is not None for run in comparison.runs)
    shown = {"cof": known, "profiles": any(run.wear for run in comparison.runs)}
    shown["area_load"] = has_loads(comparison)
    for name, draw in FIGURES.items():
        if shown.get(name, bool(comparison.runs)):
            yield name, draw(comparison)


def _runs(comparison: Comparison) -> Iterator[tuple[RunData, dict[str, Any]]]:
    """Give each run with its line, which is the same in every figure."""
    for index, run in enumerate(comparison.runs):
        # Colours repeat after six runs, together with their lines only after thirty-six.
        style = LINES[(index + index // len(COLOURS)) % len(LINES)]
        line = {"color": COLOURS[index % len(COLOURS)], "ls": style, "label": run.name}
        yield run, line | ({"marker": "o", "ms": 4} if run.history["distance"].size == 1 else {})


def _experiments(comparison: Comparison) -> Iterator[tuple[Experiment, dict[str, Any]]]:
    """Give each experiment with its line, which is the same in every figure."""
    for index, experiment in enumerate(comparison.experiments):
        colour, marker = GREYS[index % len(GREYS)], MARKERS[index % len(MARKERS)]
        line = {"color": colour, "marker": marker, "ms": 2.2, "lw": 0.6, "label": experiment.name}
        yield experiment, line


def _measured(panel: Axes, experiment: Experiment, end: float, line: dict[str, Any]) -> None:
    """Draw measured points; very many as means of parts of the distance in a band of their scatter."""
    distance, values = experiment.distance, experiment.cof / end
    if distance.size > 2 * POINTS:
        edges = np.linspace(0.0, distance[-1], POINTS + 1)
        part = np.clip(np.searchsorted(edges, distance, side="right") - 1, 0, POINTS - 1)
        number = np.bincount(part, minlength=POINTS)
        filled = number > 0
        sums = [np.bincount(part, weights=v, minlength=POINTS)[filled] for v in (distance, values, values**2)]
        distance, values, squares = (s / number[filled] for s in sums)
        scatter = np.sqrt(np.clip(squares - values**2, 0.0, None))
        low, high = values - scatter, values + scatter
        panel.fill_between(distance, low, high, color=line["color"], alpha=0.15, lw=0)
    panel.plot(distance, values, markevery=max(1, distance.size // MARKED), **line)


def _longest(comparison: Comparison) -> FloatArray:
    return max((run.history["distance"] for run in comparison.runs), key=lambda d: d[-1])
