"""Figures of a sweep: courses with bands, end values over what was varied, what decides them."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from warpwear.figures import style as fs
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME, printed
from warpwear.measured.course import Experiment
from warpwear.results.ensemble import band_told, in_legend, is_label, short_names
from warpwear.sweeps.table import SweepResult

#: Okabe and Ito's colours, told apart by colour-blind readers, for groups.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
LINES = ("-", "--", "-.", ":")
GREYS = ("#444444", "#888888", "#bbbbbb")
#: Columns of the courses and of the scatter, each with its axis.
SHOWN = {
    name: BY_NAME[name].axis for name in ("cof", "area_contact", "wear_volume_sphere", "wear_volume_disc")
}
#: What values are multiplied by where the axis has another unit than the column.
SCALES = {name: BY_NAME[name].factor for name in SHOWN}
#: Numbers with a power of ten.
NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)")
#: Groups that are drawn one by one; more are only told apart by the table.
MOST_GROUPS = 28


def drawn(result: SweepResult, experiments: tuple[Experiment, ...] = ()) -> Iterator[tuple[str, Figure]]:
    """Draw each figure that has something to show, with its name."""
    columns = columns_of(result)
    if not columns:
        return
    if result.distance.size > 1:
        yield "courses", courses(result, columns, experiments)
    varied = varied_of(result)
    if varied:
        yield "scatter", scatter(result, columns[0], varied)
    if keys := pair_of(result, varied):
        yield "heat_map", heat_map(result, columns[0], [(key, *varied[key]) for key in keys])
    if len(result.plan.keys) > 1:
        yield "tornado", tornado(result, columns[:1] + [c for c in columns[1:] if c != columns[0]][:1])


def columns_of(result: SweepResult) -> list[str]:
    """Name the columns of `SHOWN` that any run has."""
    return [name for name in SHOWN if result.distance.size and np.isfinite(result.courses(name)).any()]


def varied_of(result: SweepResult) -> dict[str, tuple[FloatArray, str]]:
    """Map the keys that are numbers, and of which there are several, to their values and unit."""
    numbers = {key: number for key in result.plan.keys if (number := result.numbers(key)) is not None}
    return {key: number for key, number in numbers.items() if np.unique(number[0]).size > 1}


def scattered(varied: dict[str, tuple[FloatArray, str]]) -> list[str]:
    """Choose the keys over which end values are drawn: over a seed there is only scatter."""
    return [key for key in varied if not is_label(key)][:4] or list(varied)[:4]


def pair_of(result: SweepResult, varied: dict[str, tuple[FloatArray, str]]) -> list[str]:
    """Name the two keys of a grid whose values make a heat map; none where there are not just two."""
    keys = [key for key in varied if key not in result.plan.band_over]
    return keys if result.plan.design.kind == "grid" and len(keys) == 2 else []


def groups_of(result: SweepResult) -> list[tuple[str, list[int]]]:
    """List the groups of runs that are drawn one by one: label, and numbers of the runs."""
    known = result.plan.groups.items()
    return [(label, runs) for label, runs in known if any(result.rows[r].courses for r in runs)][:MOST_GROUPS]


def means_of(
    result: SweepResult, column: str, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the values of two keys, (nx,) and (ny,), and the mean end value of each pair, (ny, nx)."""
    xs, ys = np.unique(x), np.unique(y)
    values = SCALES.get(column, 1.0) * result.ends(column)
    return xs, ys, np.array([[_mean(values[(x == a) & (y == b)]) for a in xs] for b in ys])


def courses(result: SweepResult, columns: list[str], experiments: tuple[Experiment, ...]) -> Figure:
    """Draw courses: the mean of each group over the distance slid, and a band of 5 to 95 % of its runs.

    Areas, which grow over decades, have logarithmic axes: what differs at first is seen there.
    """
    groups = groups_of(result)
    lines, handles = lines_of(result, groups)
    measured: list[dict[str, Any]] = [
        {"color": GREYS[n % len(GREYS)], "lw": 0.8, "label": in_legend(e.name)}
        for n, e in enumerate(experiments)
    ]
    handles += [Line2D([], [], **line) for line in measured]
    several = len(handles) if len(groups) > 1 or experiments else 0

    def draw(axes: Any) -> None:
        panels = list(np.atleast_1d(axes))
        for (_, runs), line in zip(groups, lines, strict=True):
            for panel, name in zip(panels, columns, strict=False):
                mean, low, high = (SCALES.get(name, 1.0) * part for part in result.band(name, runs))
                panel.plot(result.distance, mean, **line)
                if len(runs) > 1:
                    panel.fill_between(result.distance, low, high, color=line["color"], alpha=0.2, lw=0)
        for experiment, line in zip(experiments if columns[0] == "cof" else (), measured, strict=False):
            panels[0].plot(experiment.distance, experiment.cof, **line)
        for panel, name in zip(panels, columns, strict=False):
            panel.set(xlabel="sliding distance, mm", ylabel=SHOWN[name])
            if name == "area_contact" and result.distance[0] > 0.0:
                panel.set_xscale("log")
                fs.plain_numbers(panel.xaxis)
                fs.logarithmic(panel)
            else:
                panel.set(xlim=(0.0, None), ylim=(0.0, None))
        panels[0].set_title(band_told([len(runs) for _, runs in groups]))
        for panel in panels[len(columns) :]:
            panel.set_visible(False)
        if several:
            names = [str(handle.get_label()) for handle in handles]
            panels[0].figure.figure.legend_above(handles, [*map(_told, names)], columns=_beside(handles))

    count = len(columns)
    legend = 0.16 * -(-several // _beside(handles)) if several else 0.0
    rows = -(-count // 2)
    return fs.new_figure(draw, rows=rows, columns=min(2, count), height=fs.ROW + legend / rows, fixed=True)


def _beside(handles: list[Line2D]) -> int:
    """How many names of a legend stand beside each other over a page: a character takes some 0.055 inch."""
    longest = max((len(str(handle.get_label())) for handle in handles), default=1)
    return max(1, min(len(handles), int(fs.PAGE / (0.055 * longest + 0.5))))


def lines_of(
    result: SweepResult, groups: list[tuple[str, list[int]]]
) -> tuple[list[dict[str, Any]], list[Line2D]]:
    """Choose a line for each group, and what the legend shows.

    Groups of two keys have a colour for each value of the one and a kind of line for each of the other: a
    pale broad line is seen under a dark broken one where a key changes nothing.
    """
    plan = result.plan
    names = {key: name for key, name in short_names(plan.keys).items() if key not in plan.band_over}
    of = [{key: str(plan.points[runs[0]].values[key]) for key in names} for _, runs in groups]
    values = {key: list(dict.fromkeys(found[key] for found in of)) for key in names}
    two = sorted(names, key=lambda key: -len(values[key]))
    if len(two) != 2 or len(values[two[0]]) > len(COLOURS) or len(values[two[1]]) > len(LINES):
        lines = [_line(index) for index in range(len(groups))]
        labels = [label or "mean of all runs" for label, _ in groups]
        return lines, [
            Line2D([], [], label=in_legend(n), **line) for n, line in zip(labels, lines, strict=True)
        ]
    colours, kinds = (values[key] for key in two)
    shades = np.linspace(0.0, 0.9, len(kinds))

    def line(colour: str, kind: int) -> dict[str, Any]:
        shade = to_hex(fs.shades(colour)(shades[kind]))
        return {"color": shade, "ls": LINES[kind], "lw": 1.1 if kind else 2.4}

    lines = [line(COLOURS[colours.index(found[two[0]])], kinds.index(found[two[1]])) for found in of]
    named: list[dict[str, Any]] = [
        {"color": c, "lw": 2.4, "label": v} for c, v in zip(COLOURS, colours, strict=False)
    ]
    named += [line(fs.NOMINAL, n) | {"label": value} for n, value in enumerate(kinds)]
    keys = [names[two[0]]] * len(colours) + [names[two[1]]] * len(kinds)
    both = zip(keys, named, strict=True)
    return lines, [
        Line2D([], [], **look | {"label": in_legend(f"{key} {look['label']}")}) for key, look in both
    ]


def scatter(result: SweepResult, column: str, varied: dict[str, tuple[FloatArray, str]]) -> Figure:
    """Draw an end value of every run over each key that is a number."""
    keys = scattered(varied)
    names, ends = short_names(result.plan.keys), SCALES.get(column, 1.0) * result.ends(column)

    def draw(axes: Any) -> None:
        for panel, key in zip(np.atleast_1d(axes), keys, strict=False):
            values, unit = varied[key]
            panel.plot(values, ends, "o", ms=3, color=COLOURS[0], alpha=0.6)
            panel.set(xlabel=axis_of(names[key], unit), ylabel=at_the_end(column))
            panel.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10], integer=is_label(key)))
            panel.set_ylim(0.0 if np.nanmin(ends) > 0.0 else None, None)
            if np.nanmin(values) > 0.0:
                fs.scale_distance(panel, np.sort(values[np.isfinite(values)]))
        for panel in list(np.atleast_1d(axes))[len(keys) :]:
            panel.set_visible(False)

    return fs.new_figure(draw, rows=-(-len(keys) // 2), columns=min(2, len(keys)), fixed=True)


def heat_map(result: SweepResult, column: str, keys: list[tuple[str, FloatArray, str]]) -> Figure:
    """Draw the mean end value for each pair of values of two keys."""
    (first, x, x_unit), (second, y, y_unit) = keys
    xs, ys, means = means_of(result, column, x, y)
    names = short_names(result.plan.keys)

    def draw(axes: Any) -> None:
        image = axes.imshow(means, origin="lower", aspect="auto", cmap=fs.HEIGHTS)
        axes.set_xticks(range(xs.size), [f"{v:.4g}" for v in xs])
        axes.set_yticks(range(ys.size), [f"{v:.4g}" for v in ys])
        axes.set(xlabel=axis_of(names[first], x_unit), ylabel=axis_of(names[second], y_unit))
        if means.size <= 49:
            middle = 0.5 * (np.nanmin(means) + np.nanmax(means))
            for row, column_of in np.ndindex(means.shape):
                value = means[row, column_of]
                colour = "white" if value < middle else "black"
                told = f"{value:#.3g}" if np.isfinite(value) else "–"
                axes.text(column_of, row, told, ha="center", va="center", color=colour, fontsize=7)
        axes.figure.colorbar(image, ax=axes, label=at_the_end(column))

    return fs.new_figure(draw, width=1.3 * fs.COLUMN)


def tornado(result: SweepResult, columns: list[str]) -> Figure:
    """Draw how strongly each key decides the end values, the strongest on top."""
    sampled = result.plan.design.kind == "saltelli"
    names = short_names(result.plan.keys)

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
            panel.set_yticks(range(len(keys)), [names[key] for key in keys])
            panel.set_title(f"{SHOWN[column].partition(',')[0]} at the end", fontsize=8)
            panel.set_xlabel(
                "Sobol: total (bar, 95 %), first order (dot)"
                if sampled
                else "rank correlation (words, seeds: η²)"
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


def at_the_end(column: str) -> str:
    """Name an end value with its unit, which stands last."""
    what, comma, unit = SHOWN[column].partition(",")
    return f"{what} at the end{comma}{unit}"


def axis_of(key: str, unit: str) -> str:
    return f"{key}, {_told(unit)}" if unit else key


def _told(text: str) -> str:
    """Write quantities as papers do: 5e-4 mm^3/N/m is 5·10⁻⁴ mm³/(N·m)."""
    return NUMBER.sub(lambda found: f"{found[1]}·10{str(int(found[2])).translate(fs.RAISED)}", printed(text))


def _mean(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")
