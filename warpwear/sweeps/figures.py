"""Figures of a sweep: courses with bands, end values over what was varied, what decides them."""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from warpwear.batches.plan import Plan
from warpwear.ensembles.ensemble import Ensemble, Group
from warpwear.ensembles.figures import OVERLAID, chart_of, figure_of
from warpwear.errors import prose
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Bars, Chart, Figure, HeatMap, Line, Look
from warpwear.figures.wording import power_of_ten
from warpwear.grid import FloatArray
from warpwear.history.quantities import Quantity, printed
from warpwear.measured.experiment import Experiment
from warpwear.results.ensemble import in_legend, is_label
from warpwear.sweeps.table import SweepResult, SweepRow

#: Numbers with a power of ten.
NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)")
#: Groups that are drawn one by one; more are only told apart by the table.
MOST_GROUPS = 28
#: Values of two keys that have a colour and a kind of line each.
COLOURS, KINDS = describe.GROUPS, describe.DASHES[:4]
TEXTS = prose("reports")["sweep"]


def figures_of(result: SweepResult, experiments: Sequence[Experiment] = ()) -> dict[str, Figure]:
    """Declare each figure that has something to show."""
    quantities = quantities_of(result)
    figures: dict[str, Figure] = {}
    if not quantities:
        return figures
    if result.distance.size > 1:
        figures["courses"] = courses(result, quantities, experiments)
    varied = _varied(result)
    if varied:
        figures["scatter"] = scatter(result, quantities[0], varied)
    keys = [key for key in varied if key not in result.plan.band_over]
    if result.plan.design.kind == "grid" and len(keys) == 2:
        figures["heat_map"] = heat_map(result, quantities[0], {key: varied[key] for key in keys})
    if len(result.plan.keys) > 1:
        figures["tornado"] = tornado(result, quantities[:2])
    return figures


def quantities_of(result: SweepResult) -> list[Quantity]:
    """Choose the quantities that are laid over each other and that any run has."""
    every = [quantity for of_figure in OVERLAID.values() for quantity in of_figure]
    return [q for q in every if np.isfinite(result.courses(q.name)).any()]


def drawn(result: SweepResult, experiments: Sequence[Experiment] = ()) -> Ensemble[SweepRow]:
    """Choose the groups that are drawn one by one."""
    ensemble = result.ensemble(experiments)
    known = [group for group in ensemble.groups if any(run.courses for run in group.rows)]
    return replace(ensemble, groups=tuple(known[:MOST_GROUPS]))


def courses(
    result: SweepResult, quantities: Sequence[Quantity], experiments: Sequence[Experiment] = ()
) -> Figure:
    """Courses: the mean of each group over the distance slid, and a band of 5 to 95 % of its runs."""
    ensemble = drawn(result, experiments)
    looks, names = _looks(result.plan, ensemble.groups)
    charts = [chart_of(ensemble, quantity, looks=looks, names=names) for quantity in quantities]
    studies = [run.point.study for run in ensemble.rows if run.point.study]
    return figure_of(ensemble, charts, studies, columns=min(2, len(charts)))


def scatter(result: SweepResult, quantity: Quantity, varied: dict[str, tuple[FloatArray, str]]) -> Figure:
    """Draw an end value of every run over each key that is a number; over a seed there is only scatter."""
    keys = [key for key in varied if not is_label(key)][:4] or list(varied)[:4]
    ends, look = (
        quantity.scaled(result.ends(quantity.name)),
        Look(describe.COUNTER, "", marker="o", alpha=0.6),
    )
    wide = 0.0 < np.nanmin(ends) < 0.5 * np.nanmax(ends)  # else points of one height would lie at the top
    up, charts = Axis(_at_the_end(quantity), low=0.0 if wide else None), []
    for key in keys:
        (values, unit), name = varied[key], result.plan.names[key]
        scale: Any = "auto" if np.nanmin(values) > 0.0 else "linear"
        along = Axis(_axis_of(name, unit), scale, wide=describe.WIDE_DISTANCE, integer=is_label(key))
        charts.append(Chart(f"Over {name}", along, up, [Line(values, ends, look=look)]))
    return Figure(charts, columns=min(2, len(keys)))


def heat_map(result: SweepResult, quantity: Quantity, keys: dict[str, tuple[FloatArray, str]]) -> Figure:
    """Draw the mean end value for each pair of values of two keys."""
    names, unit = [result.plan.names[key] for key in keys], _at_the_end(quantity)
    x, y = (values for values, _ in keys.values())
    along, up = (_axis_of(name, unit) for name, (_, unit) in zip(names, keys.values(), strict=True))
    xs, ys, ends = np.unique(x), np.unique(y), quantity.scaled(result.ends(quantity.name))
    means = np.array([[_mean(ends[(x == a) & (y == b)]) for b in ys] for a in xs])
    title = f"{unit[:1].upper()}{unit[1:]}, over {' and '.join(names)}"
    across, down = ([f"{value:.4g}" for value in values] for values in (xs, ys))
    return Figure([HeatMap(title, across, down, means, along, up, unit)], width=1.3 * describe.COLUMN)


def tornado(result: SweepResult, quantities: Sequence[Quantity]) -> Figure:
    """How strongly each key decides the end values, the strongest on top."""
    names, bars = result.plan.names, []
    for quantity in quantities:
        influence, indices = result.influence(quantity.name), result.sobol(quantity.name)
        title = f"{quantity.label[:1].upper()}{quantity.label[1:]} at the end"
        bar = title, [names[key] for key in influence], np.array(list(influence.values()))
        if indices is None:
            axis = Axis("rank correlation; of words and seeds η²", low=-1.05, high=1.05)
            bars.append(Bars(*bar, axis, note=TEXTS["ranks"]))
            continue
        order = [result.plan.keys.index(key) for key in influence]
        axis = Axis("Sobol's index: part of the variance", low=-0.05, high=1.05)
        ends, dots = indices.total_interval[:, order], indices.first[order]
        bars.append(Bars(*bar, axis, ends, dots, note=TEXTS["indices"]))
    return Figure(bars, height=max(1.4, 0.3 * len(result.plan.keys) + 0.9))


def _varied(result: SweepResult) -> dict[str, tuple[FloatArray, str]]:
    """Map the keys that are numbers, and of which there are several, to their values and unit."""
    numbers = {key: number for key in result.plan.keys if (number := result.numbers(key)) is not None}
    return {key: number for key, number in numbers.items() if np.unique(number[0]).size > 1}


def _looks(plan: Plan, groups: Sequence[Group[SweepRow]]) -> tuple[list[Look], list[Line]]:
    """Choose a line for each group, and names of values for the legend where it does not name the groups.

    Groups of two keys have a colour for each value of the one and a kind of line for each of the other: a
    pale broad line is seen under a dark broken one where a key changes nothing.
    """
    names = {key: name for key, name in plan.names.items() if key not in plan.band_over}
    values = [{key: str(group.rows[0].point.values[key]) for key in names} for group in groups]
    levels = {key: list(dict.fromkeys(point[key] for point in values)) for key in names}
    two = sorted(names, key=lambda key: -len(levels[key]))
    if len(two) != 2 or len(levels[two[0]]) > len(COLOURS) or len(levels[two[1]]) > len(KINDS):
        return [], []
    colours, kinds = (levels[key] for key in two)
    shades = np.linspace(0.0, 0.9, len(kinds))

    def in_kind(colour: str, kind: int) -> Look:
        return Look(describe.shade(colour, float(shades[kind])), KINDS[kind], 1.1 if kind else 2.4)

    looks = [in_kind(COLOURS[colours.index(point[two[0]])], kinds.index(point[two[1]])) for point in values]
    entries = [(two[0], value, Look(COLOURS[n], width=2.4)) for n, value in enumerate(colours)]
    entries += [(two[1], value, in_kind(describe.NOMINAL, n)) for n, value in enumerate(kinds)]
    none = np.zeros(0)
    return looks, [Line(none, none, in_legend(_written(f"{names[k]} {v}")), look) for k, v, look in entries]


def _at_the_end(quantity: Quantity) -> str:
    """Name an end value with its unit, which stands last."""
    return f"{quantity.label} at the end, {quantity.unit or '–'}"


def _axis_of(key: str, unit: str) -> str:
    return f"{key}, {_written(unit)}" if unit else key


def _written(text: str) -> str:
    """Write quantities as papers do: 5e-4 mm^3/N/m is 5·10⁻⁴ mm³/(N·m)."""
    return NUMBER.sub(lambda match: f"{match[1]}·{power_of_ten(match[2])}", printed(text))


def _mean(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")
