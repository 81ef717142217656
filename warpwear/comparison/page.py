"""The page of a comparison: what differs between the runs, their courses over each other, their answers."""

import os
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from warpwear.comparison.figures import figures_of
from warpwear.comparison.gather import Comparison
from warpwear.comparison.groups import RunData, differing, listed, names_by_sentence
from warpwear.comparison.scar import answers_of
from warpwear.comparison.table import BANDS, PASSES, columns, has_bands, with_scatter
from warpwear.figures.sections import PageSection, under_headings
from warpwear.figures.wording import counted, few_of
from warpwear.history.end_values import ENDS, Value
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.results import manifest
from warpwear.study.text import readable

#: End values that answer a comparison.
ANSWERS = (
    *("patch_along", "patch_across", "area_contact", "pressure_mean"),
    *("volume_counter", "volume_disc", "cof", "shear_strength"),
)
#: More groups than this are rows of what differs, not columns; values of a key listed for a group.
BESIDE, LISTED = 4, 4
#: Letters of a value that stand in a cell.
LONGEST = 60
PROFILES = "Mean of the middle eighth of the scar, at the end; of a track the mean section of its groove."
GROOVE = "Measured with its standard error, from what such a mean finds on unworn surface."
#: Sections of the page: heading, anchor, figures and what is said of them; courses are all other figures.
SECTIONS = (
    ("What wear has left", "profiles", ("profiles",), PROFILES),
    ("Area against load", "loads", ("area_load",), ""),
    ("The scar, measured and computed", "scar", ("scar",), "Both depths on one scale."),
    ("Mean profiles of the scar", "groove", ("groove",), GROOVE),
)
#: Relative differences below this are round-off.
ALIKE = 5e-4


def page(comparison: Comparison, pictures: Mapping[str, bytes], folder: Path) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file; folder: where the page will lie, for links."""
    runs, measured = len(comparison.runs), len(comparison.experiments)
    groups = f" in {len(comparison.groups)} groups" * (len(comparison.groups) < runs)
    counts = [counted(runs, "run") + groups] * (runs > 0)
    counts += [counted(measured, "measured course")] * (measured > 0)
    content = {
        "name": "Comparison",
        "asked": f"{' and '.join(counts)}, laid over each other: what differs between them, and what does it "
        "change in scar, contact, wear and friction?",
        "differ": _differ(comparison),
        "answers": _answers(comparison),
        "notes": comparison.notes,
        "scar": answers_of(comparison.scar) if comparison.scar is not None else None,
        "readings": [BANDS] * has_bands(comparison)
        + [PASSES] * any(r.study.is_swept for r in comparison.runs),
        "limits": _limits(comparison.runs),
        "runs": [_link(run, folder) for run in comparison.runs],
        "sections": _sections(comparison),
    }
    return page_of("compare.html", content, pictures)


def _differ(comparison: Comparison) -> dict[str, Any]:
    """Return head and rows of the keys in which groups differ: a row a key, or of many groups a row each."""
    starts = np.cumsum([0, *(len(group.runs) for group in comparison.groups)])
    names = [group.name for group in comparison.groups]
    rows = []
    for key, values in differing(comparison.runs).items():
        cells = []
        for first, last in pairwise(starts):
            cells.append(few_of(list(dict.fromkeys(map(_readable, values[first:last]))), LISTED))
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
    text = ", ".join(re.sub(r"\.0(?= |$)", "", part) for part in parts)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _answers(comparison: Comparison) -> dict[str, Any]:
    """Return head and rows of the table of answers: value, scatter and difference to the first of each."""
    table, scatter = columns(comparison), columns(comparison, scatter=True)
    known = [key for key in ANSWERS if any(isinstance(row[key], int | float) for row in table.values())]
    inputs = {g.name for g in comparison.groups if any(r.study.friction.ends_as_given for r in g.runs)}
    rows: list[list[Any]] = []
    firsts: dict[str, Value] = {}
    for name, values in table.items():
        cells: list[dict[str, Any]] = []
        for key in known:
            value, than, is_known = values[key], "", isinstance(values[key], int | float)
            if is_known:
                than = _than(value, firsts[key]) if key in firsts else ""
                firsts.setdefault(key, value)
            text = with_scatter(value, scatter[name].get(key), ENDS[key].factor)
            is_input = is_known and key == "cof" and name in inputs
            cells.append({"text": text, "than": than, "is_input": is_input})
        rows.append([{"text": f"{name} (measured)" * (values["kind"] == "experiment") or name}, *cells])
    head = [{"text": f"{ENDS[key].label}, {ENDS[key].unit}".removesuffix(", ")} for key in known]
    if len(rows) > BESIDE:
        return {"head": [{"text": "run"}, *head], "rows": rows}
    first, *turned = zip([{"text": ""}, *head], *rows, strict=True)
    return {"head": first, "rows": turned}


def _than(value: Value, first: Value) -> str:
    """Say how a value differs from the first."""
    if not isinstance(value, int | float) or not isinstance(first, int | float) or not first:
        return ""
    part = value / first - 1.0
    if abs(part) < ALIKE:
        return "the same"
    return f"{100.0 * part:+.3g} %".replace("-", "−") if abs(part) < 1.0 else f"× {value / first:.3g}"


def _limits(runs: Sequence[RunData]) -> list[str]:
    """List what the models cannot show, with the names of the runs that it holds for where not for all."""
    names = names_by_sentence([(run, sentence) for run in runs for sentence in limits_of(run.study)])
    return [s if len(who) == len(runs) else f"{listed(who, len(runs))}: {s}" for s, who in names.items()]


def _link(run: RunData, folder: Path) -> tuple[str, str, str]:
    """Return name, path and link of a run: to its own page, where it has one, else to its folder."""
    target = run.folder / manifest.PAGE
    path = target if target.is_file() else run.folder
    return run.name, str(run.folder), quote(os.path.relpath(path.resolve(), folder.resolve()))


def _sections(comparison: Comparison) -> list[PageSection]:
    """Lay the figures under headings."""
    every, elsewhere = figures_of(comparison), {name for _, _, names, _ in SECTIONS for name in names}
    courses = [name for name in every if name not in elsewhere]
    layout = [("Courses", "courses", courses, "Move over a chart to read its values."), *SECTIONS]
    several = len(comparison.groups) + len(comparison.experiments) > 1
    return under_headings(every, layout, one_legend=("courses", "profiles") if several else ())
