"""The report of the thesis shows its printed results beside ours, as one page and one file of numbers."""

import platform
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import warp

from warpwear.page.folder import write_report
from warpwear.page.html import embedded, render
from warpwear.result import Result
from warpwear.results.folder import check_folder
from warpwear.results.report import to_json
from warpwear.study.keys import value_of
from warpwear.study.text import readable
from warpwear.thesis import items
from warpwear.thesis.figures import CAPTIONS, FIGURES
from warpwear.thesis.numbers import Numbers, collect
from warpwear.thesis.printed import TOLERANCES
from warpwear.thesis.runs import LABELS, SURFACE, VERSIONS, Plan, Runs, published, running
from warpwear.version import __version__

PAGE = "report.html"
NUMBERS = "numbers.json"
#: Columns of the table at the top.
PRINTED_COLUMNS = ("thesis V1", "thesis V2", "thesis V3", "experiment")


def thesis_report(
    out: str | Path,
    *,
    quick: bool = False,
    threads: int | None = None,
    device: str = "cpu",
    overwrite: bool = False,
    plan: Plan | None = None,
    quiet: bool = True,
) -> Path:
    """Compute everything and write the folder `out` with report.html and numbers.json; return the page.

    quick: the fine rough model with cells of 5 µm. plan: other studies than the published ones. quiet:
    without a line a run on standard error. Raises InputError for a folder or a device that cannot be used,
    and leaves nothing behind then.
    """
    folder = Path(out)
    check_folder(folder, (PAGE, NUMBERS), what="a report", overwrite=overwrite)
    started = time.perf_counter()
    with running(plan or published(quick=quick), device=device, threads=threads, quiet=quiet) as runs:
        numbers = collect(runs)
        verdicts = judge(numbers)
        page = render_page(runs, numbers, verdicts, quick=quick, started=started)
    files = {PAGE: page, NUMBERS: as_json(numbers, verdicts)}
    write_report(folder, {}, files=files, marks=[*files])
    return folder / PAGE


def judge(numbers: Mapping[str, float]) -> dict[str, items.Verdict]:
    """Judge every item by these numbers: its id -> verdict."""
    return {item.id: item.rule.judge(numbers) for item in items.ALL_ITEMS}


def as_json(numbers: Numbers, verdicts: Mapping[str, items.Verdict]) -> str:
    """Write everything that is compared as JSON; without times, so that equal runs give equal files."""
    content = {
        "summary": [
            _record(line.row, numbers) | {"verdict": line.judge(numbers), "item": line.item}
            for line in items.SUMMARY
        ],
        "items": [
            {
                "id": item.id,
                "place": item.place,
                "title": item.title,
                "verdict": verdicts[item.id].kind,
                "reason": verdicts[item.id].reason,
                "rows": [_record(row, numbers) for row in item.rows],
            }
            for item in items.ALL_ITEMS
        ],
        "numbers": numbers,
    }
    return to_json(content, indent=1) + "\n"


def _record(row: items.Row, numbers: Numbers) -> dict[str, Any]:
    """Turn a row into values: ours in the row's unit, printed ones as printed."""
    return {
        "quantity": row.quantity,
        "unit": row.unit,
        "printed": {
            column: {"value": p.value, "unit": p.unit, "place": p.place} for column, p in row.printed.items()
        },
        "ours": {column: row.factor * numbers[name] for column, name in row.ours.items()},
    }


def render_page(
    runs: Runs, numbers: Numbers, verdicts: Mapping[str, items.Verdict], *, quick: bool, started: float
) -> str:
    """Draw all figures and fill the page. started: when the first run began [s], by `time.perf_counter`."""
    attributes = runs["v1"].attributes
    pictures = {name: embedded(declare(runs, numbers)) for name, declare in FIGURES.items()}
    return render(
        "thesis.html",
        {"num": items.number, "as_printed": items.as_printed},
        printed_columns=PRINTED_COLUMNS,
        versions=VERSIONS,
        summary=[(line.row, line.judge(numbers), line.item) for line in items.SUMMARY],
        tolerance=TOLERANCES,
        places={item.id: item.place or "finding" for item in items.ALL_ITEMS},
        items=items.OF_THESIS,
        findings=items.FINDINGS,
        verdicts=verdicts,
        kinds=_count(verdicts),
        captions=CAPTIONS,
        pictures=pictures,
        n=numbers,
        # The other surfaces have one line together.
        made=[_how(name, result) for name, result in runs.results.items() if SURFACE not in name],
        runs=runs,
        assumptions=_assumptions(runs),
        quick=quick,
        environment={
            "warpwear": __version__,
            "Warp": warp.__version__,
            "Python": platform.python_version(),
            "platform": platform.platform(),
            **{name: attributes[name] for name in ("device", "threads", "precision")},
            "elapsed": f"{time.perf_counter() - started:.0f} s for all runs and figures",
        },
    )


def _count(verdicts: Mapping[str, items.Verdict]) -> dict[items.Kind, int]:
    """Count figures and tables of the thesis by their verdict."""
    of_thesis = [verdicts[item.id].kind for item in items.OF_THESIS]
    return {kind: of_thesis.count(kind) for kind in items.Kind if kind in of_thesis}


def _how(name: str, result: Result) -> dict[str, Any]:
    """Say in words how a run was computed."""
    study = result.study
    first, growth, largest = study.increments
    steps = f"{first:g} mm" if growth == 1.0 else f"{1e3 * first:g} µm growing to {largest:g} mm"
    law = f"hardness {study.hardness:g} MPa"
    if study.study.model == "macro":
        law = f"foundation, {items.number(study.stiffness)} N/mm³"
    return {
        "name": LABELS.get(name, name),
        "law": law,
        "stepping": f"{study.stepping.scheme}, {steps}",
        "steps": result.history["distance"].size,
        "study": study,
        "warnings": result.record["warnings"],
    }


def _assumptions(runs: Runs) -> list[tuple[tuple[str, str, str], list[str]]]:
    """List each assumed key with its value and reason, and the names of the studies that assume it."""
    assumed_by: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for name, label in VERSIONS.items():
        study = runs[name].study.model_dump()
        for key, reason in runs[name].summary["assumptions"].items():
            value = value_of(study, key)
            text = "" if value is None else str(readable(value))
            assumed_by[key, text, reason].append(label)
    return sorted(assumed_by.items())
