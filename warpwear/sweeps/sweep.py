"""A sweep: many runs of one study, in a folder with their tables and a page."""

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from warpwear.batches.batch import (
    check_folder,
    estimate,
    executor_for,
    logging_each,
    make_runs,
    opened_folder,
    share_runs,
)
from warpwear.batches.plan import Plan, read_plan
from warpwear.batches.run_one import RunRow
from warpwear.ensembles.table import read_csv
from warpwear.errors import InputError, named_in_python
from warpwear.measured.course import experiment_of
from warpwear.measured.motion import motion_of_runs
from warpwear.measured.rows import Paths, read_rows
from warpwear.runs.console import warn
from warpwear.study.study import Study
from warpwear.study.units import several
from warpwear.sweeps.report import FILES, failed_sentence, write_report
from warpwear.sweeps.table import TABLES, SweepResult


@named_in_python()
def sweep(
    study: Study | str | Path,
    *,
    vary: Mapping[str, Any] | None = None,
    design: str | None = None,
    samples: int | None = None,
    seed: int | None = None,
    band_over: str | list[str] | None = None,
    out: str | Path | None = None,
    runs: str | Path | None = None,
    experiments: Paths = (),
    dry_run: bool = False,
    **where: Any,
) -> SweepResult:
    """Run a study for every point of a design of its keys; return its table, courses and bands.

    `logging.basicConfig(level=logging.INFO)` shows a line for each run that is done, and the time left. A run
    that fails is a row whose status says why, and a StudyWarning at the end names it.

    Parameters
    ----------
    study : Study, path or str
        A study, its file, or the name of a preset. What a file says in its section [sweep] holds where the
        options do not say otherwise.
    vary : dict, optional
        Key with dots -> a list of values, a range ``"1:20"`` (both ends), ``{"positions": 12, "seed": 1}``
        for disc.crop of a measured disc, or a distribution such as ``"normal 9.4e-4 +- 0.7e-4 mm^3/N/m"``.
    design : {"grid", "zip", "sobol", "latin-hypercube", "saltelli"}, optional
        By default a grid.
    samples, seed : int, optional
        Of the last three: how many, and of their draws, by default 0.
    band_over : str or list of str, optional
        Keys whose scatter bands show.
    out : path, optional
        Folder of the sweep; runs that it holds are not made again, and without it nothing is kept.
    runs : path, optional
        Folder of runs that sweeps share, by default runs/ in `out`.
    experiments : path or list of path, optional
        Tribometers' records of friction, drawn into the figures of `out`.
    dry_run : bool
        Whether to make one run, say from it in ``cost`` what all will take, and keep nothing.
    **where
        workers : processes here, by default one a core, or one a GPU. gpus : ``"all"`` shares them among all
        GPUs here. device : ``"cpu"`` or ``"cuda:0"``. cluster : address of a Dask scheduler instead, such as
        ``"tls://host:8786"``, with insecure : whether one that is neither encrypted nor here is allowed.
        executor : anything like concurrent.futures.Executor instead, such as
        ``Client(address).get_executor(pure=False)`` of dask.distributed or mpi4py's MPIPoolExecutor.

    Returns
    -------
    SweepResult
        Table, courses, bands and what decides the end values.

    Raises
    ------
    InputError
        For what makes no sweep.
    TypeError
        For an unknown option.

    References
    ----------
    A. Saltelli and others, Computer Physics Communications 181 (2010) 259 (Sobol's indices).

    Examples
    --------
    >>> study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "3 mm"})
    >>> swept = warpwear.sweep(study, vary={"contact.load": ["4 N", "8 N"]}, workers=1)
    >>> swept.table["status"], swept.ends("area_contact").round(3).tolist()
    (['done', 'done'], [0.015, 0.026])
    """
    device = where.pop("device", "cpu")
    options = {"vary": vary or {}, "design": design, "samples": samples, "seed": seed, "band_over": band_over}
    plan = read_plan(study, {}, options, device="cuda:0" if where.get("gpus") else device)
    if out is None and (runs is not None or experiments):
        raise InputError("--runs and --experiment, experiments=[…] need --out, the folder of the sweep")
    how: Any = {"runs": runs, "experiments": several(experiments), "dry_run": dry_run}
    result = make_sweep(plan, None if out is None else Path(out), where, **how, **logging_each(plan))
    if not dry_run and (failed := failed_sentence(result)) is not None:
        warn(f"{failed}.")
    return result


def make_sweep(
    plan: Plan,
    out: Path | None,
    where: Mapping[str, Any],
    *,
    runs: str | Path | None,
    experiments: Sequence[str | Path],
    dry_run: bool,
    resume: bool = True,
    on_cost: Callable[[str], object] | None = None,
    **calls: Any,
) -> SweepResult:
    """Make the runs of a plan and write what is told of them into the folder, if there is one.

    where: as of `executor_for`. on_cost: is called with what it will take, which one run tells. calls: of
    `make_runs`. Raises InputError.
    """
    motion = motion_of_runs(plan.study)
    measured = tuple(experiment_of(read_rows(path), motion) for path in experiments)
    if out is not None:
        check_folder(out, resume=resume, files=FILES)
        check_runs(plan, out)
        if runs is not None and not dry_run:
            share_runs(out, Path(runs))
    place, pool = opened_folder(None if dry_run else out), executor_for(plan, **where)
    with place as folder, pool as (executor, threads, workers):
        if dry_run or on_cost is not None:
            cost = estimate(plan, folder, executor, threads=threads, workers=workers)
        if dry_run:
            return SweepResult(plan, [RunRow("not made")] * len(plan.points), cost=cost)
        if on_cost is not None:
            on_cost(cost)
        rows = make_runs(plan, folder, executor, threads=threads, **calls)
        result = SweepResult(plan, rows, out)
        if out is not None:
            result.written = write_report(result, folder, measured)
    return result


def check_runs(plan: Plan, folder: Path) -> None:
    """Raise InputError for the folder of a sweep with runs that this one has not: its tables would go.

    A sweep may grow, so that its runs are part of those of a larger one. Runs that failed are no loss, and
    neither is a row that was cut off while it was written.
    """
    path = folder / TABLES[0]
    try:
        stored = {row["run"] for row in read_csv(path) if not row["status"].startswith("failed")}
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
