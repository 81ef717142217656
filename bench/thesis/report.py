"""The thesis's printed results beside what its equations give here, as one page and one file of numbers.

    python bench/thesis/report.py                    # writes thesis-report/, about a minute on two cores
    python bench/thesis/report.py --quick            # the fine rough model with cells of 5 µm instead of 1 µm
    python bench/thesis/report.py --calibration      # Table 4.1 beside the worn patch; --json for programs

The folder gets report.html, one page that needs nothing else, and numbers.json, all that is compared. Each
figure and table of the thesis has a verdict, computed from the numbers that stand beside it.
"""

import base64
import json
import math
import os
import platform
import sys
import time
import tomllib
from collections import defaultdict
from collections.abc import Mapping
from functools import reduce
from io import BytesIO
from pathlib import Path
from typing import Any

import click
import coefficients
import items
import jinja2
import warp
from compared import Numbers, collect
from pictures import CAPTIONS, FIGURES, drawn
from pictures import PAGE as PAGE_WIDTH
from printed import TOLERANCES
from recomputed import LABELS, SURFACE, VERSIONS, Plan, Runs, published, running

import warpwear
from warpwear import InputError, Result

PAGE, NUMBERS = "report.html", "numbers.json"
#: Columns of the table at the top.
PRINTED_COLUMNS = ("thesis V1", "thesis V2", "thesis V3", "experiment")
#: Dots per inch of pictures.
DPI = 160


def thesis_report(
    out: str | Path,
    *,
    quick: bool = False,
    threads: int | None = None,
    device: str = "cpu",
    overwrite: bool = False,
    plan: Plan | None = None,
    quiet: bool = True,
    dpi: int = DPI,
) -> Path:
    """Compute everything and write the folder `out` with report.html and numbers.json; return the page.

    quick: the fine rough model with cells of 5 µm. plan: other studies than the published ones. quiet:
    without a line a run on standard error. dpi: of pictures. Raises InputError for a folder or a device that
    cannot be used, and leaves nothing behind then.
    """
    folder = Path(out)
    check_folder(folder, overwrite=overwrite)
    started = time.perf_counter()
    with running(plan or published(quick=quick), device=device, threads=threads, quiet=quiet) as runs:
        numbers = collect(runs)
        verdicts = judge(numbers)
        page = render_page(runs, numbers, verdicts, quick=quick, started=started, dpi=dpi)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in ((PAGE, page), (NUMBERS, as_json(numbers, verdicts))):
        unfinished = folder / f".{name}"
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        os.replace(unfinished, folder / name)
    return folder / PAGE


def check_folder(folder: Path, *, overwrite: bool) -> None:
    """Raise InputError unless a report may be written into the folder."""
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected")
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if there and not {PAGE, NUMBERS} <= there:
        raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected")
    if there and not overwrite:
        raise InputError(f"out = {folder} already holds a report; give another folder, or --overwrite")


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
    return json.dumps(_finite(content), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    """Turn numbers that are none into None, within mappings and lists too."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


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
    runs: Runs,
    numbers: Numbers,
    verdicts: Mapping[str, items.Verdict],
    *,
    quick: bool,
    started: float,
    dpi: int,
) -> str:
    """Draw all figures and fill the page. started: when the first run began [s], by `time.perf_counter`."""
    pages = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    pages.filters |= {"num": items.number, "as_printed": items.as_printed}
    summary = runs["v1"].summary
    return pages.get_template("page.html").render(
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
        pictures={name: embedded(drawn(name, runs, numbers), dpi=dpi) for name in FIGURES},
        n=numbers,
        # The other surfaces have one line together.
        made=[_how(name, result) for name, result in runs.results.items() if SURFACE not in name],
        runs=runs,
        assumptions=_assumptions(runs),
        quick=quick,
        environment={
            "warpwear": warpwear.__version__,
            "Warp": warp.__version__,
            "Python": platform.python_version(),
            "platform": platform.platform(),
            **{name: summary[name] for name in ("device", "threads", "precision")},
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
    stepping, stiffness = study.stepping, result.summary["foundation_N_per_mm3"]
    steps = f"{stepping.increment or 0.0:g} mm"
    if stepping.increment is None:
        steps = f"{1e3 * stepping.first:g} µm growing to {stepping.largest:g} mm"
    law = f"foundation, {items.number(stiffness)} N/mm³" if stiffness else ""
    return {
        "name": LABELS.get(name, name),
        "law": law or f"hardness {study.contact.hardness:g} MPa",
        "stepping": f"{stepping.scheme}, {steps}",
        "steps": result.history["distance"].size,
        "study": study,
        "warnings": result.record["warnings"],
    }


def _assumptions(runs: Runs) -> list[tuple[tuple[str, str, str], list[str]]]:
    """List each assumed key with its value and reason, and the names of the studies that assume it."""
    assumed_by: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for name, label in VERSIONS.items():
        keys = tomllib.loads(runs[name].study.to_toml(marked=True))
        for key, reason in runs[name].summary["assumptions"].items():
            value = reduce(lambda table, part: table[part], key.split("."), keys)
            assumed_by[key, str(value), reason].append(label)
    return sorted(assumed_by.items())


def embedded(figure: Any, *, dpi: int) -> dict[str, Any]:
    """Make a picture of a figure that a page can hold, as wide as lettering is equally large in all [%]."""
    png = BytesIO()
    figure.savefig(png, format="png", dpi=dpi, metadata={})
    source = f"data:image/png;base64,{base64.b64encode(png.getvalue()).decode('ascii')}"
    return {"source": source, "width": round(100.0 * min(1.0, figure.get_figwidth() / PAGE_WIDTH))}


@click.command(help=__doc__, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--out", type=click.Path(path_type=Path), default="thesis-report", show_default=True)
@click.option("--quick", is_flag=True, help="The fine rough model with cells of 5 µm instead of 1 µm.")
@click.option("--threads", type=click.IntRange(1), help="Threads of the CPU. [default: all]")
@click.option("--device", default="cpu", show_default=True, help="cpu or cuda:0.")
@click.option("--overwrite", is_flag=True, help="Replace the report that the folder holds.")
@click.option("--calibration", is_flag=True, help="Table 4.1 beside the worn patch; nothing is run.")
@click.option("--json", "as_json", is_flag=True, help="--calibration: for programs.")
def main(out: Path, calibration: bool, as_json: bool, **options: Any) -> None:
    """Write the report, or say what is known of Table 4.1."""
    if calibration or as_json:
        record = json.dumps(coefficients.record(), indent=2, ensure_ascii=False)
        click.echo(record if as_json else coefficients.text())
        return
    try:
        click.echo(f"written to {thesis_report(out, quiet=False, **options)}")
    except InputError as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(2)


if __name__ == "__main__":
    main()
