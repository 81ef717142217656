"""The page of a sweep: what was varied, the band of its answers, what decides them, and every run."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.batches.design import SAMPLED, Factor
from warpwear.figures.sections import PageSection, under_headings
from warpwear.figures.wording import few_of, listed
from warpwear.history.end_values import ENDS
from warpwear.history.quantities import BY_NAME
from warpwear.measured.experiment import Experiment
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.page.words import Answer
from warpwear.results import manifest
from warpwear.results.ensemble import band, is_label
from warpwear.sweeps.figures import figures_of, groups_of
from warpwear.sweeps.table import SweepResult

#: Rows of the table that the page shows; values of a key that it lists.
MOST_ROWS, MOST_VALUES = 200, 12
#: Sentences of runs that failed, and numbers of them that one sentence names.
MOST_FAILURES = 8
#: Letters of a number that was drawn, and not written by a person.
LONG = 12
BANDS = "Mean of each group, in a band of 5 to 95 % of its runs where it has several."
#: Sections of the page: heading, anchor, figures and what is said of them.
SECTIONS = (
    ("Courses", "courses", ("courses",), BANDS),
    ("What decides them", "indices", ("tornado",), ""),
    ("At the end, over what was varied", "ends", ("scatter", "heat_map"), ""),
)
#: End values at the top and in the table of runs.
ANSWERS = (
    *(ENDS[name] for name in ("patch_across", "area_contact", "pressure_mean")),
    BY_NAME["wear_volume_disc"],
    ENDS["cof"],
)


def page(result: SweepResult, pictures: Mapping[str, bytes], experiments: Sequence[Experiment]) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file."""
    plan = result.plan
    total, done = len(result.rows), sum(row.status == "done" for row in result.rows)
    assumed = {key: why for key, why in plan.study.assumptions.items() if key not in plan.keys}
    content = {
        "name": f"{plan.study.study.name}: sweep",
        "description": plan.study.study.description,
        "asked": f"{done} of {total} runs of one study, over {listed(plan.keys)}: how far do the answers "
        "reach, and what decides them?",
        "answers": _answers(result),
        "decides": _decides(result),
        "factors": [(f.key, _values_of(f), f.key in plan.band_over) for f in plan.factors],
        "design": plan.design,
        "limits": limits_of(plan.study),
        "assumptions": assumed,
        "rows": _rows(result),
        "columns": [
            *plan.names.values(),
            *(f"{answer.label.capitalize()}, {answer.unit}".removesuffix(", ") for answer in ANSWERS),
        ],
        "total": total,
        "study": plan.study.to_toml(),
        "sections": _sections(result, experiments),
        "groups": group_rows(result),
        "failed": failures(result),
    }
    return page_of("sweep.html", content, pictures)


def _values_of(factor: Factor) -> str:
    """Say what a key was varied over, in a person's words."""
    if factor.distribution is not None:
        return str(factor.distribution)
    return few_of([f"{v:g}" if isinstance(v, float) else str(v) for v in factor.values], MOST_VALUES)


def _answers(result: SweepResult) -> list[Answer]:
    """Give the numbers at the top: mean and band of a sampled design, least and most of a listed one."""
    answers = []
    notes = {
        "cof": "Not predicted: area × shear strength over load",
        "wear_volume_disc": "Not predicted: wear coefficient × load × distance",
    }
    if result.plan.study.friction.ends_as_given:
        notes["cof"] = "An input: constant, or its shear strength is fitted so that it is met"
    for answer in ANSWERS:
        if (values := result.known_ends(answer.name)) is None:
            continue
        known = answer.scaled(values[np.isfinite(values)])
        if result.plan.design.kind in SAMPLED:
            mean, low, high = (float(part[0]) for part in band(known[:, None]))
            text, error = f"{mean:.4g}", f"mean; 5 to 95 % of the runs: {low:.3g} to {high:.3g}"
        else:
            text = f"{known.min():.3g} to {known.max():.3g}" if np.ptp(known) > 0.0 else f"{known[0]:.4g}"
            error = f"least and most of {known.size} runs"
        note = notes.get(answer.name, "")
        answers.append(Answer(answer.label.capitalize(), text, answer.unit, error, input_note=note))
    return answers


def _decides(result: SweepResult) -> str:
    """Say in a sentence which key decides the coefficient of friction most."""
    if len(result.plan.keys) < 2 or result.known_ends("cof") is None:
        return ""
    key, value = next(iter(result.influence().items()))
    if not np.isfinite(value) or value == 0.0:
        return ""
    what = "η²" if result.numbers(key) is None or is_label(key) else "rank correlation"
    what = "total Sobol index" if result.plan.design.kind == "saltelli" else what
    words, indices = result.influence_in_words()[key], result.sobol()
    doubt = f" {indices.doubt}" if indices is not None and indices.doubt else ""
    return f"The coefficient of friction at the end hangs most on {key}: {what} {words}.{doubt}"


def _sections(result: SweepResult, experiments: Sequence[Experiment]) -> list[PageSection]:
    """Lay the figures under headings."""
    several = len(groups_of(result)) + len(experiments) > 1
    figures, one_legend = figures_of(result, experiments), ("courses",) if several else ()
    return under_headings(figures, SECTIONS, one_legend=one_legend)


def group_rows(result: SweepResult) -> list[dict[str, Any]]:
    """For each group of runs: label, number of runs, mean, 5th and 95th percentile of the end's CoF."""
    ends, rows = result.known_ends("cof"), []
    for label, runs in result.plan.groups.items():
        values = np.full((len(runs), 1), np.nan) if ends is None else ends[runs][:, None]
        mean, low, high = (float(part[0]) for part in band(values))
        rows.append({"label": label or "all runs", "runs": len(runs), "mean": mean, "low": low, "high": high})
    return rows


def failures(result: SweepResult) -> list[str]:
    """Return the sentences of runs that did not end as asked, each once, with their number."""
    counted = Counter(row.status for row in result.rows if row.status != "done")
    return [f"{count} × {status}" for status, count in counted.most_common(MOST_FAILURES)]


def _rows(result: SweepResult) -> list[dict[str, Any]]:
    """Rows of the table of runs: what was varied, how it ended, and where its page or folder lies."""
    unknown, rows = np.full(len(result.rows), np.nan), []
    known = [result.known_ends(answer.name) for answer in ANSWERS]
    ends = [a.factor * (unknown if v is None else v) for a, v in zip(ANSWERS, known, strict=True)]
    for point, row in list(zip(result.plan.points, result.rows, strict=True))[:MOST_ROWS]:
        values = [float(column[point.number]) for column in ends]
        varied = [
            _short(v) if isinstance(v, str) else v if isinstance(v, int | float) else ", ".join(map(str, v))
            for v in point.values.values()
        ]
        link = _link(result.folder, point.run)
        rows.append({"cells": [*varied, *values], "status": row.status, "link": link})
    return rows


def _short(text: str) -> str:
    """Write the number of a drawn value with its unit in five digits, as tables for people have it."""
    number, space, unit = text.partition(" ")
    try:
        return f"{float(number):.5g}{space}{unit}" if len(number) > LONG else text
    except ValueError:
        return text


def _link(folder: Path | None, run: str) -> str:
    """Find a run's own page beside the sweep's, or else its folder; return nothing where it has none."""
    # Not of pathlib, whose questions raise where they must not look.
    if folder is None or not run or not os.path.isdir(folder / "runs" / run):
        return ""
    page = f"runs/{run}/{manifest.PAGE}"
    return page if os.path.isfile(folder / page) else f"runs/{run}/"
