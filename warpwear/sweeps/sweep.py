"""A sweep: many runs of one study, in a folder with their tables and a page."""

import csv
from collections.abc import Mapping
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from warpwear.batches.batch import check_folder, make_all, opened_folder
from warpwear.batches.plan import Plan, section_of
from warpwear.errors import InputError
from warpwear.runs.console import warn
from warpwear.study.study import Study
from warpwear.sweeps.report import FILES, failed_sentence, write_report
from warpwear.sweeps.table import TABLES, SweepResult


def sweep(
    study: Study | str | Path,
    *,
    vary: Mapping[str, Any],
    design: str = "grid",
    samples: int | None = None,
    seed: int = 0,
    band_over: str | list[str] | None = None,
    out: str | Path | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    device: str = "cpu",
) -> SweepResult:
    """Run a study for every point of a design of its keys; return its table, courses and bands.

    vary: dotted key -> a list of values, a range "1:20" (both ends), {"positions": 12, "seed": 1} for
    disc.crop of a measured disc, or a distribution such as "normal 9.4e-4 +- 0.7e-4 mm^3/N/m". design:
    "grid", "zip"; or "sobol", "latin-hypercube", "saltelli" with samples. band_over: keys whose scatter
    bands show.
    out: folder of the sweep; runs that it holds are not made again, and without it nothing is kept.
    executor: anything like concurrent.futures.Executor, such as `Client(address).get_executor(pure=False)`
    of dask.distributed or mpi4py's MPIPoolExecutor; by default `workers` processes here, one a core.

    `logging.basicConfig(level=logging.INFO)` shows a line for each run that is done, and the time left.

    Raises InputError for what makes no sweep. A run that fails is a row whose status says why, and a
    StudyWarning at the end names it.
    """
    study = study if isinstance(study, Study) else Study.load(study)
    options = {"design": design, "samples": samples, "seed": seed, "band_over": band_over}
    plan = Plan(study, section_of({"vary": dict(vary)}, options), device=device)
    out = None if out is None else Path(out)
    if out is not None:
        check_folder(out, resume=True, files=FILES)
        check_runs(plan, out)
    with opened_folder(out) as folder:
        rows = make_all(plan, folder, executor=executor, workers=workers)
        result = SweepResult(plan, rows, None if out is None else folder)
        if out is not None:
            write_report(result, folder)
    failed = failed_sentence(result)
    if failed is not None:
        warn(f"{failed}.")
    return result


def check_runs(plan: Plan, folder: Path) -> None:
    """Raise InputError for the folder of a sweep with runs that this one has not: its tables would go.

    A sweep may grow, so that its runs are part of those of a larger one. Runs that failed are no loss, and
    neither is a row that was cut off while it was written.
    """
    path = folder / TABLES[0]
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [row for row in csv.DictReader(file) if None not in row.values()]
        stored = {row["run"] for row in rows if not row["status"].startswith("failed")}
    except FileNotFoundError:
        return
    except (OSError, UnicodeError, csv.Error, KeyError) as error:
        raise InputError(
            f"{path} cannot be read as the table of a sweep, which would be lost ({error}): give "
            "another folder, or move it away."
        ) from error
    others = stored - {point.run for point in plan.points}
    if others:
        raise InputError(
            f"out = {folder} holds a sweep with {len(stored)} runs, {len(others)} of which this one has not: "
            "its tables would be lost; give another folder, or the same study and device and its values, too."
        )
