"""The page of a sweep: what was varied, the band of its answers, what decides them, and every run."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpwear.batches.batch import RUNS
from warpwear.batches.design import SAMPLED, Factor
from warpwear.ensembles.ensemble import Group
from warpwear.ensembles.page import answers_of, known_answers, link_to, titled
from warpwear.figures.sections import under_headings
from warpwear.figures.wording import few_of, listed
from warpwear.history.quantities import Quantity
from warpwear.measured.experiment import Experiment
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.page.words import Answer
from warpwear.results.ensemble import band_name, is_label
from warpwear.sweeps.figures import TEXTS, drawn, figures_of
from warpwear.sweeps.table import SweepResult, SweepRow

#: Rows of the table that the page shows; values of a key that it lists.
MOST_ROWS, MOST_VALUES = 200, 12
#: Sentences of runs that failed, and numbers of them that one sentence names.
MOST_FAILURES = 8
#: Letters of a number that was drawn, and not written by a person.
LONG = 12


def page(result: SweepResult, pictures: Mapping[str, bytes], experiments: Sequence[Experiment]) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file."""
    plan, ensemble, everyone = result.plan, result.ensemble(experiments), Group("", tuple(result.runs))
    total, done = len(result.rows), sum(row.status == "done" for row in result.rows)
    inputs = {group.name for group in ensemble.groups} if plan.study.friction.ends_as_given else set()
    known, figures = known_answers([everyone]), figures_of(result, experiments)
    content = {
        "name": f"{plan.study.study.name}: sweep",
        "description": plan.study.study.description,
        "asked": f"{done} of {total} runs of one study, over {listed(plan.keys)}: how far do the answers "
        "reach, and what decides them?",
        "cards": [_card(result, everyone, quantity) for quantity in known],
        "answers": answers_of(ensemble, inputs),
        "decides": _decides(result),
        "factors": [(f.key, _values_of(f), f.key in plan.band_over) for f in plan.factors],
        "design": plan.design,
        "limits": limits_of(plan.study),
        "assumptions": {key: why for key, why in plan.study.assumptions.items() if key not in plan.keys},
        "rows": [_row(result, run, known) for run in result.runs[:MOST_ROWS]],
        "columns": [*plan.names.values(), *map(titled, known)],
        "total": total,
        "study": plan.study.to_toml(),
        "sections": under_headings(
            figures, TEXTS["sections"], one_legend=drawn(result, experiments).one_legend
        ),
        "failed": failures(result),
    }
    return page_of("sweep.html", content, pictures)


def _values_of(factor: Factor) -> str:
    """Say what a key was varied over, in a person's words."""
    if factor.distribution is not None:
        return str(factor.distribution)
    return few_of([f"{v:g}" if isinstance(v, float) else str(v) for v in factor.values], MOST_VALUES)


def _card(result: SweepResult, everyone: Group[SweepRow], quantity: Quantity) -> Answer:
    """Give a number at the top: mean and band of a sampled design, least and most of a listed one."""
    known = [quantity.factor * value for value in everyone.numbers(quantity.name)]
    if result.plan.design.kind in SAMPLED:
        mean, low, high = (quantity.factor * value for value in everyone.band(quantity.name))
        text, error = f"{mean:.4g}", f"mean; {band_name(len(known))} of the runs: {low:.3g} to {high:.3g}"
    else:
        least, most = min(known), max(known)
        text = f"{least:.3g} to {most:.3g}" if least < most else f"{least:.4g}"
        error = f"least and most of {len(known)} runs"
    is_input = quantity.name == "cof" and result.plan.study.friction.ends_as_given
    note = TEXTS["input"] if is_input else TEXTS["notes"].get(quantity.name, "")
    return Answer(quantity.label.capitalize(), text, quantity.unit, error, input_note=note)


def _decides(result: SweepResult) -> str:
    """Say in a sentence which key decides the coefficient of friction most."""
    if len(result.plan.keys) < 2 or not Group("", tuple(result.runs)).numbers("cof"):
        return ""
    key, value = next(iter(result.influence().items()))
    if not np.isfinite(value) or value == 0.0:
        return ""
    what = "η²" if result.numbers(key) is None or is_label(key) else "rank correlation"
    what = "total Sobol index" if result.plan.design.kind == "saltelli" else what
    words, indices = result.influence_in_words()[key], result.sobol()
    doubt = f" {indices.doubt}" if indices is not None and indices.doubt else ""
    return f"The coefficient of friction at the end hangs most on {key}: {what} {words}.{doubt}"


def failures(result: SweepResult) -> list[str]:
    """Return the sentences of runs that did not end as asked, each once, with their number."""
    counted = Counter(row.status for row in result.rows if row.status != "done")
    return [f"{count} × {status}" for status, count in counted.most_common(MOST_FAILURES)]


def _row(result: SweepResult, run: SweepRow, known: Sequence[Quantity]) -> dict[str, Any]:
    """Fill a row of the table of runs: what was varied, how it ended, and where its page or folder lies."""
    cells: list[Any] = [
        _short(v) if isinstance(v, str) else v if isinstance(v, int | float) else ", ".join(map(str, v))
        for v in run.point.values.values()
    ]
    ends = ((run.ends.get(quantity.name), quantity.factor) for quantity in known)
    cells += [factor * value if isinstance(value, int | float) else None for value, factor in ends]
    place = result.folder / RUNS / run.name if result.folder and run.point.run else None
    # Not of pathlib, whose questions raise where they must not look.
    link = link_to(place, place.parents[1]) if place and os.path.isdir(place) else ""
    return {"cells": cells, "status": run.status, "link": link}


def _short(text: str) -> str:
    """Write the number of a drawn value with its unit in five digits, as tables for people have it."""
    number, space, unit = text.partition(" ")
    try:
        return f"{float(number):.5g}{space}{unit}" if len(number) > LONG else text
    except ValueError:
        return text
