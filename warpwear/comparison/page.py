"""The page of a comparison: what differs between the runs, their courses laid over each other, their "
"answers."""

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from warpwear.comparison import figures
from warpwear.comparison.area_load import STYLES, has_loads, loads_of, series_of, theories_of
from warpwear.comparison.gather import BODIES, Comparison
from warpwear.comparison.groups import Course, RunData, differing, listed
from warpwear.comparison.scar import ScarComparison, answers_of
from warpwear.comparison.table import BANDS, PASSES, columns, has_bands
from warpwear.history.end_values import ENDS, Value
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.page.parts import Chart, Coded, Line, Map, Section, banded, overlaid, thinned
from warpwear.results import manifest
from warpwear.results.report import shown
from warpwear.study.text import readable
from warpwear.version import __version__

#: What answers a comparison: name of a quantity, what to call it, its unit, and the factor to that.
NAMES = ("patch_along", "patch_across", "area_contact", "pressure_mean", "volume_sphere", "volume_disc")
ANSWERS = tuple(
    (name, ENDS[name].label, ENDS[name].unit, ENDS[name].factor) for name in (*NAMES, "cof", "shear_strength")
)
#: More groups than this are rows of what differs, not columns; values of a key listed for a group.
BESIDE, LISTED = 4, 4
#: Letters of a value that stand in a cell.
LONGEST = 60
#: Most points along a side of a map.
MAP_SIDE = 300
#: Relative differences below this are round-off.
ALIKE = 5e-4


def page(comparison: Comparison, pictures: Mapping[str, bytes], folder: Path) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file; folder: where the page will lie, for its "
    "links."""
    runs, measured = len(comparison.runs), len(comparison.experiments)
    several = len(comparison.groups) < runs
    told = [f"{runs} run{'s' * (runs != 1)}" + f" in {len(comparison.groups)} groups" * several] * (runs > 0)
    told += [f"{measured} measured course{'s' * (measured != 1)}"] * (measured > 0)
    content = {
        "name": "Comparison",
        "version": __version__,
        "asked": f"{' and '.join(told)}, laid over each other: what differs between them, and what does it "
        "change in scar, contact, wear and friction?",
        "differ": _differ(comparison),
        "answers": _answers(comparison),
        "notes": comparison.notes,
        "scar": answers_of(comparison.scar) if comparison.scar is not None else None,
        "readings": [BANDS] * has_bands(comparison)
        + [PASSES] * any(r.study.is_swept for r in comparison.runs),
        "limits": _limits(comparison.runs),
        "runs": [_link(run, folder) for run in comparison.runs],
        "sections": [asdict(section) for section in _sections(comparison) if section.plots],
    }
    return page_of("compare.html", content, pictures)


def _differ(comparison: Comparison) -> dict[str, Any]:
    """Return head and rows of a table of the keys in which groups differ: a row a key, or of many groups "
    "one."""
    found = differing(comparison.runs)
    starts = np.cumsum([0, *(len(group.runs) for group in comparison.groups)])
    names = [group.name for group in comparison.groups]
    rows = []
    for key, values in found.items():
        cells = []
        for first, last in pairwise(starts):
            of = list(dict.fromkeys(map(_readable, values[first:last])))
            more = f" and {len(of) - LISTED} more" if len(of) > LISTED else ""
            cells.append(", ".join(of[:LISTED]) + more)
        rows.append([key, *cells])
    if len(names) <= BESIDE:
        return {"head": ["key", *names], "rows": rows}
    return {
        "head": ["run", *(row[0] for row in rows)],
        "rows": list(zip(names, *(row[1:] for row in rows), strict=True)),
    }


def _readable(value: str) -> str:
    """Write a value of a study as people do, a list of them without its brackets, and not too long."""
    parts = [str(readable(part)).strip() for part in re.sub(r'[\[\]"]', "", value).split(", ")]
    told = ", ".join(re.sub(r"\.0(?= |$)", "", part) for part in parts)
    return told if len(told) <= LONGEST else f"{told[: LONGEST - 1]}…"


def _answers(comparison: Comparison) -> dict[str, Any]:
    """Return head and rows of the table of answers: value, scatter and difference to the first of each."""
    table, scatter = columns(comparison), columns(comparison, scatter=True)
    kept = [a for a in ANSWERS if any(isinstance(row[a[0]], int | float) for row in table.values())]
    inputs = {g.name for g in comparison.groups if any(r.study.friction.fitted == "end" for r in g.runs)}
    rows: list[list[Any]] = []
    firsts: dict[str, Value] = {}
    for name, values in table.items():
        cells: list[dict[str, Any]] = []
        for key, _, _, factor in kept:
            value, error = values[key], scatter[name].get(key)
            if not isinstance(value, int | float):
                cells.append({"text": "–", "than": "", "given": False})
                continue
            text = shown(factor * float(value))
            if isinstance(error, float) and error > 1e-9 * abs(value):
                text = f"{factor * value:.3g} ± {factor * error:.2g}"
            than = _than(value, firsts[key]) if key in firsts else ""
            firsts.setdefault(key, value)
            cells.append({"text": text, "than": than, "given": key == "cof" and name in inputs})
        rows.append([{"text": f"{name} (measured)" * (values["kind"] == "experiment") or name}, *cells])
    head = [{"text": f"{label}, {unit}" if unit else label} for _, label, unit, _ in kept]
    found = [[{"text": "run"}, *head], *rows]
    if len(rows) > BESIDE:
        return {"head": found[0], "rows": found[1:]}
    turned = list(zip(*found, strict=True))
    return {"head": [{"text": ""}, *turned[0][1:]], "rows": turned[1:]}


def _than(value: float, first: Value) -> str:
    """Say how a value differs from the first."""
    if not isinstance(first, int | float) or not first or not math.isfinite(value):
        return ""
    part = value / first - 1.0
    if abs(part) < ALIKE:
        return "the same"
    return f"{100.0 * part:+.3g} %".replace("-", "−") if abs(part) < 1.0 else f"× {value / first:.3g}"


def _limits(runs: Sequence[RunData]) -> list[str]:
    """List what the models cannot show, with the names of the runs that it holds for where not for all."""
    names: dict[str, list[str]] = {}
    for run in runs:
        for sentence in limits_of(run.study):
            names.setdefault(sentence, []).append(run.name)
    return [s if len(of) == len(runs) else f"{listed(of, len(runs))}: {s}" for s, of in names.items()]


def _link(run: RunData, folder: Path) -> tuple[str, str, str]:
    """Return name, path and link of a run: to its own page, where it has one, else to its folder."""
    target = run.folder / manifest.PAGE
    path = target if target.is_file() else run.folder
    return run.name, str(run.folder), quote(os.path.relpath(path.resolve(), folder.resolve()))


def _sections(comparison: Comparison) -> list[Section]:
    column, chart = figures.column_of, partial(_chart, comparison)
    courses = [
        chart("cof", "Coefficient of friction", "coefficient of friction, –", figures.cof_of, log=False),
        chart("area", "Area in contact", "area in contact, mm²", column("area_contact")),
        chart("pressure", "Mean pressure", "mean pressure in contact, MPa", column("pressure_mean")),
        *(
            chart(
                "volumes",
                f"Worn volume, {body}",
                "worn volume, 10⁻³ mm³",
                column(f"wear_volume_{body}", 1e3),
                log=False,
            )
            for body in BODIES
        ),
    ]
    worn = [
        chart(
            "profiles",
            f"Wear of the {body}",
            "height lost by wear, µm",
            partial(figures.profile_of, body),
            log=False,
        )
        for body in BODIES
    ]
    worn = [replace(c, x="across sliding, mm", lines=_within(c.lines, _reach(comparison))) for c in worn if c]
    one = len(comparison.groups) + len(comparison.experiments) > 1
    told = "Mean of the middle eighth of the scar, at the end; of a track the mean section of its groove."
    return [
        Section(
            "Courses",
            [c for c in courses if c],
            "courses",
            "Move over a chart to read its values.",
            one_legend=one,
        ),
        Section("What wear has left", worn, "profiles", told, one_legend=one),
        Section("Area against load", _loads(comparison), "loads"),
        *(_of_scar(comparison.scar) if comparison.scar is not None else []),
    ]


def _chart(
    comparison: Comparison,
    name: str,
    title: str,
    unit: str,
    of: Callable[[RunData], Course | None],
    *,
    log: bool = True,
) -> Chart | None:
    """Lay a course of all groups over each other, of friction the measured ones too."""
    lines = [_measured(e, line) for e, line in figures.looks_of_measured(comparison)] if name == "cof" else []
    for group, line in figures.looks_of(comparison):
        if (found := group.courses(of)) is not None:
            lines.append(banded(group.name, line, *found))
    return overlaid(name, title, unit, lines, log=log)


def _reach(comparison: Comparison) -> float:
    """How far from the middle any run has worn [mm], and some room."""
    ends = (
        np.abs(run.across[of > 0.0]).max(initial=0.0) for run in comparison.runs for of in run.wear.values()
    )
    return 1.15 * float(max(ends, default=0.0))


def _within(lines: list[Line], reach: float) -> list[Line]:
    """Cut lines off beyond a distance from the middle."""

    def cut(line: Line) -> Line:
        near = np.abs(line.x) <= reach
        low, high = (None if of is None else of[near] for of in (line.low, line.high))
        return replace(line, x=line.x[near], y=line.y[near], low=low, high=high)

    return [cut(line) for line in lines] if reach else lines


def _measured(experiment: figures.Experiment, line: dict[str, Any]) -> Line:
    distance, values, scatter = figures.measured_course(experiment)
    at = thinned(distance)
    ends = (None, None) if scatter is None else ((values - scatter)[at], (values + scatter)[at])
    return Line(experiment.name, line["color"], distance[at], values[at], "solid", "lines", False, *ends)


def _of_scar(scar: ScarComparison) -> list[Section]:
    """Maps of the measured scar and of the first run's on one scale, and their mean profiles."""
    first, step = scar.computed[0], [max(1, -(-n // MAP_SIDE)) for n in scar.measured.lost.shape]
    fields = {
        "measured": scar.measured.lost,
        first.name: first.lost,
        f"measured − {first.name}": scar.measured.lost - first.lost,
    }
    low = 1e3 * min(float(v.min()) for v in fields.values())
    high = 1e3 * max(float(v.max()) for v in fields.values())
    inside = scar.measured.patch
    maps = [
        Map(
            f"scar_{number}",
            f"Depth lost: {name}",
            [""],
            scar.extent,
            [Coded.of(1e3 * lost[:: step[0], :: step[1]], low, high)],
            [f"mean {1e3 * float(lost[inside].mean()):.3g} µm in the scar"],
            unit="µm",
            static="" if number else "scar",
        )
        for number, (name, lost) in enumerate(fields.items())
    ]
    y, depth, band = scar.y, 1e3 * scar.profile.depth, 1e3 * scar.profile.band
    lines = [Line("measured", figures.GREYS[0], y, -depth, low=-depth - band, high=-depth + band)]
    for number, run in enumerate(scar.computed):
        lines.append(Line(run.name, figures.COLOURS[number % len(figures.COLOURS)], y, -1e3 * run.profile))
    profiles = Chart(
        "groove", "Mean profiles", "across sliding, mm", "change of height, µm", lines, static="groove"
    )
    told = "Measured with its standard error, from what such a mean finds on unworn surface."
    return [
        Section("The scar, measured and computed", maps, "scar", "All on one scale."),
        Section("Mean profiles of the scar", [profiles], "groove", told),
    ]


def _loads(comparison: Comparison) -> list[Chart]:
    """Area in contact after the first step over the load, beside theories; nothing where no loads differ."""
    if not has_loads(comparison):
        return []
    lines = []
    for (name, (force, area, low, high)), (colour, _) in zip(
        series_of(comparison).items(), STYLES * 9, strict=False
    ):
        lines.append(Line(name, colour, force, area, "solid", "lines+markers", False, low, high))
    loads = loads_of(comparison)
    for (name, theory), dash in zip(
        theories_of(comparison, loads).items(), ("dash", "dot", "dashdot"), strict=False
    ):
        lines.append(Line(name, "NEUTRAL", loads, 1e3 * theory, dash))
    title, unit = "Area in contact after the first step", "area in contact at first, 10⁻³ mm²"
    return [
        Chart("area_load", title, "normal load, N", unit, lines, static="area_load", log_x=True, log_y=True)
    ]
