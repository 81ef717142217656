"""Figures of a sweep: courses with bands, end values over what was varied, what decides them."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.grid import FloatArray
from warpwear.measured.course import Experiment
from warpwear.sweeps.table import SweepResult

#: Okabe and Ito's colours, told apart by colour-blind readers, for groups.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
LINES = ("-", "--", "-.", ":")
GREYS = ("#444444", "#888888", "#bbbbbb")
#: Columns of the courses and of the scatter, each with its axis.
SHOWN = {
    "cof": "coefficient of friction",
    "area_contact": "area in contact, mm²",
    "wear_volume_sphere": "worn volume of the ball, mm³",
    "wear_volume_disc": "worn volume of the disc, mm³",
}
#: Groups that are drawn one by one; more are only told apart by the table.
MOST_GROUPS = 28


def drawn(result: SweepResult, experiments: tuple[Experiment, ...] = ()) -> Iterator[tuple[str, Figure]]:
    """Draw each figure that has something to show, with its name."""
    columns = [name for name in SHOWN if result.distance.size and np.isfinite(result.courses(name)).any()]
    if not columns:
        return
    if result.distance.size > 1:
        yield "courses", courses(result, columns, experiments)
    numbers = {key: number for key in result.plan.keys if (number := result.numbers(key)) is not None}
    varied = {key: (values, unit) for key, (values, unit) in numbers.items() if np.unique(values).size > 1}
    if varied:
        yield "scatter", scatter(result, columns[0], varied)
    if result.plan.design.kind == "grid":
        keys = [key for key in varied if key not in result.plan.band_over]
        if len(keys) == 2 and all(np.unique(varied[key][0]).size > 1 for key in keys):
            yield "heat_map", heat_map(result, columns[0], [(key, *varied[key]) for key in keys])
    if len(result.plan.keys) > 1:
        yield "tornado", tornado(result, columns[:1] + [c for c in columns[1:] if c != columns[0]][:1])


def courses(result: SweepResult, columns: list[str], experiments: tuple[Experiment, ...]) -> Figure:
    """Draw courses: the mean of each group over the distance slid, and a band of 5 to 95 % of its runs."""
    groups = list(result.plan.groups.items())[:MOST_GROUPS]

    def draw(axes: Any) -> None:
        panels = list(np.atleast_1d(axes))
        for index, (label, runs) in enumerate(groups):
            line = _line(index)
            for panel, name in zip(panels, columns, strict=False):
                mean, low, high = result.band(name, runs)
                panel.plot(result.distance, mean, label=label or "mean of all runs", **line)
                if len(runs) > 1:
                    panel.fill_between(result.distance, low, high, color=line["color"], alpha=0.2, lw=0)
        for index, experiment in enumerate(experiments if columns[0] == "cof" else ()):
            colour = GREYS[index % len(GREYS)]
            panels[0].plot(experiment.distance, experiment.cof, color=colour, lw=0.8, label=experiment.name)
        for panel, name in zip(panels, columns, strict=False):
            panel.set(xlabel="sliding distance, mm", ylabel=SHOWN[name])
            panel.set_ylim(0.0, None)
        for panel in panels[len(columns) :]:
            panel.set_visible(False)
        if len(groups) > 1 or experiments:
            fs.legend_above(*panels, columns=min(3, len(groups) + len(experiments)))

    count = len(columns)
    legend = 0.16 * -(-(len(groups) + len(experiments)) // 3) if len(groups) > 1 or experiments else 0.0
    rows = -(-count // 2)
    return fs.new_figure(draw, rows=rows, columns=min(2, count), height=fs.ROW + legend / rows)


def scatter(result: SweepResult, column: str, varied: dict[str, tuple[FloatArray, str]]) -> Figure:
    """Draw an end value of every run over each key that is a number."""
    keys = list(varied)[:4]

    def draw(axes: Any) -> None:
        for panel, key in zip(np.atleast_1d(axes), keys, strict=False):
            values, unit = varied[key]
            panel.plot(values, result.ends(column), "o", ms=3, color=COLOURS[0], alpha=0.6)
            panel.set(xlabel=_axis(key, unit), ylabel=f"{SHOWN[column]} at the end")
            if np.nanmin(values) > 0.0:
                fs.scale_distance(panel, np.sort(values[np.isfinite(values)]))
        for panel in list(np.atleast_1d(axes))[len(keys) :]:
            panel.set_visible(False)

    return fs.new_figure(draw, rows=-(-len(keys) // 2), columns=min(2, len(keys)))


def heat_map(result: SweepResult, column: str, keys: list[tuple[str, FloatArray, str]]) -> Figure:
    """Draw the mean end value for each pair of values of two keys."""
    (first, x, x_unit), (second, y, y_unit) = keys
    xs, ys = np.unique(x), np.unique(y)
    values = result.ends(column)
    means = np.array([[_mean(values[(x == a) & (y == b)]) for a in xs] for b in ys])

    def draw(axes: Any) -> None:
        image = axes.imshow(means, origin="lower", aspect="auto", cmap=fs.HEIGHTS)
        axes.set_xticks(range(xs.size), [f"{v:.4g}" for v in xs])
        axes.set_yticks(range(ys.size), [f"{v:.4g}" for v in ys])
        axes.set(xlabel=_axis(first, x_unit), ylabel=_axis(second, y_unit))
        if means.size <= 49:
            middle = 0.5 * (np.nanmin(means) + np.nanmax(means))
            for row, column_of in np.ndindex(means.shape):
                value = means[row, column_of]
                colour = "white" if value < middle else "black"
                axes.text(column_of, row, f"{value:.3g}", ha="center", va="center", color=colour, fontsize=7)
        axes.figure.colorbar(image, ax=axes, label=f"{SHOWN[column]} at the end")

    return fs.new_figure(draw, width=1.3 * fs.COLUMN)


def tornado(result: SweepResult, columns: list[str]) -> Figure:
    """Draw how strongly each key decides the end values, the strongest on top."""
    sampled = result.plan.design.kind == "saltelli"

    def draw(axes: Any) -> None:
        for panel, column in zip(np.atleast_1d(axes), columns, strict=False):
            found = result.influence(column)
            keys = list(found)[::-1]
            panel.barh(range(len(keys)), [found[key] for key in keys], color=COLOURS[0])
            indices = result.sobol(column)
            if indices is not None:
                for place, key in enumerate(keys):
                    factor = result.plan.keys.index(key)
                    low, high = indices.total_interval[:, factor]
                    panel.plot([low, high], [place, place], color="black", lw=1.0)
                    panel.plot(indices.first[factor], place, "o", color=COLOURS[4], ms=4)
            panel.set_yticks(range(len(keys)), keys)
            panel.set_title(f"{SHOWN[column].partition(',')[0]} at the end", fontsize=8)
            panel.set_xlabel(
                "Sobol: total (bar, 95 %), first order (dot)" if sampled else "rank correlation (words: η²)"
            )
            panel.axvline(0.0, color="black", lw=0.6)
            panel.set_xlim(0.0 if sampled else -1.05, 1.05)

    return fs.new_figure(draw, columns=len(columns), height=max(1.4, 0.3 * len(result.plan.keys) + 0.9))


def _line(index: int) -> dict[str, Any]:
    return {
        "color": COLOURS[index % len(COLOURS)],
        "ls": LINES[(index // len(COLOURS)) % len(LINES)],
        "lw": 1.1,
    }


def _axis(key: str, unit: str) -> str:
    return f"{key}, {unit}" if unit else key


def _mean(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")
