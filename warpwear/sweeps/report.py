"""What a sweep leaves in its folder: tables, figures, and a page that shows them without a network."""

import os
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.batches.batch import RUNS
from warpwear.batches.design import SAMPLED, Factor
from warpwear.ensembles.ensemble import Group
from warpwear.ensembles.page import answers_of, known_answers, link_to, titled
from warpwear.errors import InputError
from warpwear.figures.sections import under_headings
from warpwear.figures.wording import few_of, listed
from warpwear.history.end_values import ENDS
from warpwear.history.quantities import Quantity
from warpwear.measured.experiment import Experiment
from warpwear.page.folder import write_report as write_folder
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of
from warpwear.page.words import Answer
from warpwear.results import manifest
from warpwear.results.ensemble import band_name, is_label
from warpwear.sweeps.figures import TEXTS, drawn, figures_of
from warpwear.sweeps.table import TABLES, SweepResult, SweepRow

#: Rows of the table that the page shows; values of a key that it lists.
MOST_ROWS, MOST_VALUES = 200, 12
#: Sentences of runs that failed, and numbers of them that one sentence names.
MOST_FAILURES = 8
#: Letters of a number that was drawn, and not written by a person.
LONG = 12
#: The page of a sweep.
PAGE = "sweep.html"
#: What a sweep writes beside its runs and figures.
FILES = (*TABLES, PAGE)
#: Index or correlation below which a key decides nothing.
IDLE = 0.02


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


def write_report(result: SweepResult, folder: Path, experiments: tuple[Experiment, ...] = ()) -> list[Path]:
    """Write `FILES` and figures/, each as a whole; return what was written.

    Raises InputError where they cannot be written; the runs are kept.
    """
    try:
        with tempfile.TemporaryDirectory(prefix=".tables-", dir=folder) as name:
            work = Path(name)
            result.write_tables(work)
            figures, make = figures_of(result, experiments), partial(page, result, experiments=experiments)
            write_folder(work, figures, pages={PAGE: make}, within=manifest.FIGURES)
            return _moved(work, folder)
    except (OSError, InputError) as error:
        cause = error.__cause__ if isinstance(error, InputError) else error
        if not isinstance(cause, OSError):
            raise
        raise InputError(
            f"out = {folder}: tables and figures could not be written: {cause.strerror or cause}; the runs "
            "are kept, and the same command with --resume writes them"
        ) from error


def _moved(work: Path, folder: Path) -> list[Path]:
    """Move tables and figures into the folder of a sweep, in place of its older ones alone."""
    ours = manifest.written(folder)
    tables = [name for name in FILES if (work / name).is_file()]
    names = [*tables, *sorted(f"{manifest.FIGURES}/{path.name}" for path in work.glob("*/*.png"))]
    (folder / manifest.FIGURES).mkdir(exist_ok=True)
    for name in {*names} - ours:
        manifest.set_aside(folder / name)
    manifest.write(folder, ours | {*names}, work=work)
    return [(work / name).replace(folder / name) for name in names]


def summary_text(result: SweepResult) -> str:
    """Return the groups of a sweep and what decides the coefficient of friction, for the screen."""
    done = sum(row.status == "done" for row in result.rows)
    lines = [f"{done} of {len(result.rows)} runs done"]
    groups = result.ensemble().groups
    width = max(len(group.name) for group in groups)
    given = result.plan.study.friction.fitted in ("end", "coulomb", "states")  # then it is no answer
    told = ENDS["area_contact" if given else "cof"]
    lines += [f"{g.name:<{width}}  {_end_of(g, told)}" for g in groups]
    if len(result.plan.keys) > 1 and done > 1:
        indices, what = result.sobol(), "rank correlation; of words and seeds η²"
        what = what if indices is None else "Sobol's total index, 95 % interval"
        shares = ", ".join(f"{key} {words}" for key, words in result.influence_in_words().items())
        lines.append(f"what decides it ({what}): {shares}")
        lines += [indices.doubt] if indices is not None and indices.doubt else []
        lines += _without_influence(result)
    return "\n".join([*lines, *failures(result)])


def _without_influence(result: SweepResult) -> list[str]:
    """Say why a hardness that is varied decides nothing: of a disc at rest that has run in."""
    study, influence = result.plan.study, result.influence()
    idle = [key for key in influence if key.endswith(".hardness") and abs(influence[key]) < IDLE]
    runs_in = not study.is_swept and study.study.model == "micro" and study.stepping.scheme == "implicit"
    if not idle or not runs_in:
        return []
    why = "a disc at rest runs in until no cell is at the hardness; it decides early friction, and a track"
    return [f"{' and '.join(idle)} without influence at the end: {why}"]


def _end_of(group: Group[SweepRow], told: Quantity) -> str:
    """Return what the runs of a group came to, for the screen."""
    mean, low, high = group.band(told.name)
    if not np.isfinite(mean):
        return f"no {told.label}"
    name = band_name(len(group.numbers(told.name)))
    band = f", {name} of {len(group.rows)} runs: {low:.4g} to {high:.4g}" * (len(group.rows) > 1)
    return f"{told.label} {mean:.4g} {told.unit}".rstrip() + band


def failed_sentence(result: SweepResult) -> str | None:
    """Say how many runs failed, which, and where it says why; None where all are done."""
    failed = [number for number, row in enumerate(result.rows) if row.status != "done"]
    if not failed:
        return None
    named = ", ".join(map(str, failed[:MOST_FAILURES])) + (", …" if len(failed) > MOST_FAILURES else "")
    where = "the result's table" if result.folder is None else str(result.folder / "table.csv")
    return (
        f"{len(failed)} of {len(result.rows)} runs failed, row{'s' * (len(failed) > 1)} {named} from 0: the "
        f"column status of {where} says why"
    )
