"""The page of a sweep: what was varied, the band of its answers, what decides them, and every run."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.figures.style import NOMINAL
from warpwear.grid import FloatArray
from warpwear.history.end_values import ENDS
from warpwear.history.quantities import BY_NAME
from warpwear.measured.course import Experiment
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.page.parts import Bars, Chart, Grid, Line, Section, banded, overlaid, thinned
from warpwear.results import manifest
from warpwear.results.ensemble import is_label, short_names
from warpwear.study.text import assumptions
from warpwear.sweeps import figures
from warpwear.sweeps.design import SAMPLED, Factor
from warpwear.sweeps.table import SweepResult
from warpwear.version import __version__

#: Rows of the table that the page shows; values of a key that it lists.
MOST_ROWS, MOST_VALUES = 200, 12
#: End values at the top and in the table of runs: column, what to call it, unit, factor to that.
ANSWERS = tuple(
    (quantity.name, quantity.label.capitalize(), quantity.unit, quantity.factor)
    for quantity in (
        *(ENDS[name] for name in ("patch_across", "area_contact", "pressure_mean")),
        BY_NAME["wear_volume_disc"],
        ENDS["cof"],
    )
)


def page(
    result: SweepResult,
    pictures: Mapping[str, bytes],
    told: Mapping[str, Any],
    experiments: tuple[Experiment, ...],
) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file. told: groups and failures, as texts."""
    plan = result.plan
    total, done = len(result.rows), sum(row.status == "done" for row in result.rows)
    assumed = {key: why for key, why in assumptions(plan.study).items() if key not in plan.keys}
    content = {
        "name": f"{plan.study.study.name}: sweep",
        "description": plan.study.study.description,
        "version": __version__,
        "asked": f"{done} of {total} runs of one study, over {_listed(plan.keys)}: how far do the answers "
        "reach, and what decides them?",
        "answers": _answers(result),
        "decides": _decides(result),
        "factors": [(f.key, _told(f), f.key in plan.band_over) for f in plan.factors],
        "design": plan.design,
        "limits": limits_of(plan.study),
        "assumptions": assumed,
        "rows": _rows(result),
        "columns": [
            *short_names(plan.keys).values(),
            *(f"{label}, {unit}".removesuffix(", ") for _, label, unit, _ in ANSWERS),
        ],
        "total": total,
        "study": plan.study.to_toml(),
        "sections": [asdict(section) for section in _sections(result, experiments) if section.plots],
        **told,
    }
    return page_of("sweep.html", content, pictures)


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _told(factor: Factor) -> str:
    """Say what a key was varied over, in a person's words."""
    if (of := factor.distribution) is None:
        values = [
            v if isinstance(v, str) else f"{v:g}" if isinstance(v, float) else str(v) for v in factor.values
        ]
        more = f" and {len(values) - MOST_VALUES} more" if len(values) > MOST_VALUES else ""
        return ", ".join(values[:MOST_VALUES]) + more
    sign = "to" if of.kind.endswith("uniform") else "±"
    within = f", within {of.within[0]:g} to {of.within[1]:g}" if of.within else ""
    return f"{of.kind}: {of.first:g} {sign} {of.second:g}{within} {of.unit}".rstrip()


def _ends(result: SweepResult, column: str) -> FloatArray | None:
    """End values of a column; None where no run has any."""
    if not any(f"{column} [" in name for row in result.rows for name in row.ends):
        return None
    values = result.ends(column)
    return values if np.isfinite(values).any() else None


def _answers(result: SweepResult) -> list[dict[str, str]]:
    """Give the numbers at the top: mean and band of a sampled design, least and most of a listed one."""
    found = []
    for column, label, unit, factor in ANSWERS:
        if (values := _ends(result, column)) is None:
            continue
        known = factor * values[np.isfinite(values)]
        given = ""
        if column == "cof":
            fitted = result.plan.study.friction.fitted == "end"
            given = "An input: its shear strength is fitted so that it is met" if fitted else ""
            given = given or "Not predicted: area × shear strength over load"
        if column.startswith("wear_volume"):
            given = "Not predicted: wear coefficient × load × distance"
        if result.plan.design.kind in SAMPLED:
            low, high = np.percentile(known, (5.0, 95.0))
            text, error = f"{known.mean():.4g}", f"mean; 5 to 95 % of the runs: {low:.3g} to {high:.3g}"
        else:
            text = f"{known.min():.3g} to {known.max():.3g}" if np.ptp(known) > 0.0 else f"{known[0]:.4g}"
            error = f"least and most of {known.size} runs"
        found.append(
            {"label": label, "value": text, "unit": unit, "error": error, "note": "", "given": given}
        )
    return found


def _decides(result: SweepResult) -> str:
    """Say in a sentence which key decides the coefficient of friction most."""
    if len(result.plan.keys) < 2 or _ends(result, "cof") is None:
        return ""
    key, value = next(iter(result.influence().items()))
    if not np.isfinite(value) or value == 0.0:
        return ""
    what = "η²" if result.numbers(key) is None or is_label(key) else "rank correlation"
    what = "total Sobol index" if result.plan.design.kind == "saltelli" else what
    told = f"{value:.2f}".replace("-", "−")
    return f"The coefficient of friction at the end hangs most on {key}: {what} {told}."


def _sections(result: SweepResult, experiments: tuple[Experiment, ...]) -> list[Section]:
    shown = figures.columns_of(result)
    if not shown:
        return []
    courses = [c for column in shown if (c := _course(result, column, experiments))]
    varied = figures.varied_of(result)
    reached = [_scatter(result, shown[0], key, *varied[key]) for key in figures.scattered(varied)]
    keys = figures.pair_of(result, varied)
    maps = [_heat_map(result, shown[0], [(key, *varied[key]) for key in keys])] if keys else []
    bars = [_bars(result, column) for column in shown[:2]] if len(result.plan.keys) > 1 else []
    one = len(figures.groups_of(result)) + len(experiments) > 1
    text = "Mean of each group, in a band of 5 to 95 % of its runs where it has several."
    return [
        Section("Courses", courses if result.distance.size > 1 else [], "courses", text, one_legend=one),
        Section("What decides them", bars, "indices"),
        Section("At the end, over what was varied", [*reached, *maps], "ends"),
    ]


def _course(result: SweepResult, column: str, experiments: tuple[Experiment, ...]) -> Chart | None:
    groups = figures.groups_of(result)
    looks, _ = figures.lines_of(result, groups)
    factor = figures.SCALES.get(column, 1.0)
    lines = []
    for experiment in experiments if column == "cof" else ():
        at = thinned(experiment.distance)
        lines.append(Line(experiment.name, NOMINAL, experiment.distance[at], experiment.cof[at]))
    for (label, runs), look in zip(groups, looks, strict=True):
        lines.append(
            banded(label or "all runs", look, result.distance, factor * result.courses(column)[runs])
        )
    title, unit = figures.SHOWN[column].partition(",")[0], figures.SHOWN[column]
    return overlaid("courses", title.capitalize(), unit, lines, log=column == "area_contact")


def _bars(result: SweepResult, column: str) -> Bars:
    """What decides an end value, the strongest on top."""
    found, indices = result.influence(column), result.sobol(column)
    names = short_names(result.plan.keys)
    title = f"{figures.SHOWN[column].partition(',')[0].capitalize()} at the end"
    made = (column, title, [names[key] for key in found], np.array(list(found.values())))
    if indices is None:
        note = "Rank correlation (Spearman) sees only what rises or falls throughout; of words and seeds η²."
        return Bars(
            *made, "rank correlation; of words and seeds η²", (-1.05, 1.05), None, None, note, "tornado"
        )
    order = [result.plan.keys.index(key) for key in found]
    reach = np.append(indices.total_interval[np.isfinite(indices.total_interval)], (0.0, 1.0))
    least, most = 1.05 * float(reach.min()), 1.05 * float(reach.max())
    note = (
        "Bar: the total index, interactions included, with its interval of 95 %. Dot: the first-order index."
    )
    ends, dots = indices.total_interval[:, order], indices.first[order]
    return Bars(*made, "Sobol's index: part of the variance", (least, most), ends, dots, note, "tornado")


def _scatter(result: SweepResult, column: str, key: str, values: FloatArray, unit: str) -> Chart:
    """An end value of every run over one key."""
    name = figures.axis_of(short_names(result.plan.keys)[key], unit)
    ends = figures.SCALES.get(column, 1.0) * result.ends(column)
    line = Line("runs", figures.COLOURS[0], values, ends, marks="markers")
    return Chart(
        key, f"Over {name.partition(',')[0]}", name, figures.at_the_end(column), [line], static="scatter"
    )


def _heat_map(result: SweepResult, column: str, keys: list[tuple[str, FloatArray, str]]) -> Grid:
    """The mean end value of each pair of values of two keys."""
    (first, x, x_unit), (second, y, y_unit) = keys
    names = short_names(result.plan.keys)
    xs, ys, means = figures.means_of(result, column, x, y)
    across, down = ([f"{v:.4g}" for v in of] for of in (xs, ys))
    unit = figures.at_the_end(column)
    title = f"{unit[:1].upper()}{unit[1:]}, over {names[first]} and {names[second]}"
    axes = figures.axis_of(names[first], x_unit), figures.axis_of(names[second], y_unit)
    return Grid("heat_map", title, across, down, means.T, *axes, unit, static="heat_map")


def _rows(result: SweepResult) -> list[dict[str, Any]]:
    """Rows of the table of runs: what was varied, how it ended, and where its page or folder lies."""
    ends = [_ends(result, column) for column, *_ in ANSWERS]
    found = []
    for point, row in list(zip(result.plan.points, result.rows, strict=True))[:MOST_ROWS]:
        values = [
            float("nan") if of is None else factor * float(of[point.number])
            for of, (*_, factor) in zip(ends, ANSWERS, strict=True)
        ]
        varied = [
            v if isinstance(v, str | int | float) else ", ".join(map(str, v)) for v in point.values.values()
        ]
        found.append(
            {"cells": [*varied, *values], "status": row.status, "link": _link(result.folder, point.run)}
        )
    return found


def _link(folder: Path | None, run: str) -> str:
    """Where the run's own page lies beside the sweep's, or else its folder; nothing for a run that has "
    "none."""
    if folder is None or not run or not (folder / "runs" / run).is_dir():
        return ""
    page = f"runs/{run}/{manifest.PAGE}"
    return page if (folder / page).is_file() else f"runs/{run}/"
