"""What a sweep leaves in its folder: tables, figures, and a page that shows them without a network."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.measured.course import Experiment
from warpwear.page.html import embedded, render
from warpwear.sweeps import figures
from warpwear.sweeps.table import SweepResult

#: Figure -> what the page says of it.
CAPTIONS = {
    "courses": "Courses over the distance: the mean of each group, and a band of 5 to 95 % of its runs.",
    "scatter": "The value at the end of every run, over what was varied.",
    "heat_map": "The mean of the values at the end, for each pair of values.",
    "tornado": "How strongly each key decides the value at the end.",
}
#: Rows of the table that the page shows.
MOST_ROWS = 200
#: Sentences of runs that failed.
MOST_FAILURES = 8


def write_report(result: SweepResult, folder: Path, experiments: tuple[Experiment, ...] = ()) -> list[Path]:
    """Write table.csv, table.parquet, sweep.nc, figures/ and sweep.html; return what was written."""
    result.write_tables(folder)
    drawn = dict(figures.drawn(result, experiments))
    (folder / "figures").mkdir(exist_ok=True)
    pictures = {name: folder / "figures" / f"{name}.png" for name in drawn}
    for name, figure in drawn.items():
        fs.write_figure(figure, pictures[name])
    (folder / "sweep.html").write_text(_page(result, drawn), encoding="utf-8")
    names = ("table.csv", "table.parquet", "sweep.nc", "sweep.html")
    return [folder / name for name in names if (folder / name).is_file()] + list(pictures.values())


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


def _page(result: SweepResult, drawn: dict[str, Figure]) -> str:
    table = result.table
    columns = [name for name in table if name != "run"]
    shown = min(MOST_ROWS, len(result.rows))
    return render(
        "sweep.html",
        {"number": _shown},
        title=result.plan.study.study.name,
        groups=group_rows(result),
        pictures=[(embedded(figure), CAPTIONS[name]) for name, figure in drawn.items()],
        columns=columns,
        rows=[[table[name][n] for name in columns] for n in range(shown)],
        total=len(result.rows),
        study=result.plan.study.to_toml(),
        design=result.plan.design,
        keys=result.plan.keys,
        done=sum(row.status == "done" for row in result.rows),
        failed=failures(result),
    )


def failures(result: SweepResult) -> list[str]:
    """The sentences of runs that did not end as asked, each once, with their number."""
    counted = Counter(row.status for row in result.rows if row.status != "done")
    return [f"{count} × {status}" for status, count in counted.most_common(MOST_FAILURES)]


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.5g}" if np.isfinite(value) else "–"
    return str(value)
