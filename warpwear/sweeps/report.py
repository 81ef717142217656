"""What a sweep leaves in its folder: tables, figures, and a page that shows them without a network."""

from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.measured.course import Experiment
from warpwear.page.folder import write_report as write_folder
from warpwear.sweeps.figures import FIGURES, figures_of
from warpwear.sweeps.page import page
from warpwear.sweeps.table import SweepResult

TABLES, PAGE = ("table.csv", "table.parquet", "sweep.nc"), "sweep.html"
#: Sentences of runs that failed, and numbers of them that one sentence names.
MOST_FAILURES = 8


def write_report(result: SweepResult, folder: Path, experiments: tuple[Experiment, ...] = ()) -> list[Path]:
    """Write table.csv, table.parquet, sweep.nc, figures/ and sweep.html; return what was written."""
    result.write_tables(folder)
    texts = {"groups": group_rows(result), "failed": failures(result)}
    written = write_folder(
        folder,
        figures_of(result, experiments),
        pages={PAGE: partial(page, result, texts=texts, experiments=experiments)},
        files={},
        within="figures",
        older=FIGURES,
    )
    return [path for name in TABLES if (path := folder / name).is_file()] + written


def group_rows(result: SweepResult, column: str = "cof") -> list[dict[str, Any]]:
    """For each group of runs: label, number of runs, mean, 5th and 95th percentile of an end value."""
    values = (
        result.ends(column) if any(row.ends for row in result.rows) else np.full(len(result.rows), np.nan)
    )
    found = []
    for label, runs in result.plan.groups.items():
        known = values[runs][np.isfinite(values[runs])]
        low, high = np.percentile(known, (5.0, 95.0)) if known.size else (np.nan, np.nan)
        mean = float(known.mean()) if known.size else np.nan
        found.append(
            {"label": label or "all runs", "runs": len(runs), "mean": mean, "low": low, "high": high}
        )
    return found


def summary_text(result: SweepResult) -> str:
    """The groups of a sweep and what decides the coefficient of friction, for the screen."""
    done = sum(row.status == "done" for row in result.rows)
    lines = [f"{done} of {len(result.rows)} runs done"]
    width = max(len(row["label"]) for row in group_rows(result))
    lines += [
        f"{row['label']:<{width}}  {row['runs']:4d} runs   " + _end_told(row) for row in group_rows(result)
    ]
    if len(result.plan.keys) > 1 and done > 1:
        what = (
            "Sobol's total index"
            if result.plan.design.kind == "saltelli"
            else "rank correlation; of words and seeds η²"
        )
        told = ", ".join(f"{key} {value:.2f}" for key, value in result.influence().items())
        lines.append(f"what decides it ({what}): {told}")
    return "\n".join([*lines, *failures(result)])


def _end_told(row: dict[str, Any]) -> str:
    """What the runs of a group came to, for the screen."""
    if not np.isfinite(row["mean"]):
        return "no coefficient of friction"
    band = f"   5–95 %: {row['low']:.4g} – {row['high']:.4g}" if row["runs"] > 1 else ""
    return f"cof at the end {row['mean']:.4g}{band}"


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


def failures(result: SweepResult) -> list[str]:
    """The sentences of runs that did not end as asked, each once, with their number."""
    counted = Counter(row.status for row in result.rows if row.status != "done")
    return [f"{count} × {status}" for status, count in counted.most_common(MOST_FAILURES)]
