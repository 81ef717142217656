"""A sweep: many runs of one study, in a folder with their tables and a page; also from the command line."""

import csv
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from warpwear.batches import batch
from warpwear.batches.plan import Plan, read_plan
from warpwear.batches.run_one import RunRow
from warpwear.ensembles.table import read_csv
from warpwear.errors import InputError, named_in_python
from warpwear.measured.course import experiment_of
from warpwear.measured.motion import motion_of_runs
from warpwear.measured.rows import Paths, read_rows
from warpwear.runs.console import EVERY_SECONDS, warn
from warpwear.study.loading import value_of_text
from warpwear.study.study import Study
from warpwear.study.units import several
from warpwear.sweeps.report import FILES, failed_sentence, summary_text, write_report
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
    result = make_sweep(plan, None if out is None else Path(out), where, **how, **batch.logging_each(plan))
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
        batch.check_folder(out, resume=resume, files=FILES)
        check_runs(plan, out)
        if runs is not None and not dry_run:
            batch.share_runs(out, Path(runs))
    place, pool = batch.opened_folder(None if dry_run else out), batch.executor_for(plan, **where)
    with place as folder, pool as (executor, threads, workers):
        if dry_run or on_cost is not None:
            cost = batch.estimate(plan, folder, executor, threads=threads, workers=workers)
        if dry_run:
            return SweepResult(plan, [RunRow("not made")] * len(plan.points), cost=cost)
        if on_cost is not None:
            on_cost(cost)
        rows = batch.make_runs(plan, folder, executor, threads=threads, **calls)
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


def varied(texts: Sequence[str]) -> dict[str, Any]:
    """Key -> what it is varied over, from texts KEY=VALUES. Raises InputError."""
    vary: dict[str, Any] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not equals or not values:
            raise InputError(f"--vary {text!r}: KEY=VALUES is expected, such as 'contact.load=2 N,4 N,8 N'.")
        vary[key] = values_of_text(values)
    return vary


def values_of_text(text: str) -> Any:
    """Return a list of the values between commas; a range, a distribution or {positions = 12} as it is."""
    value = value_of_text(text)
    if not isinstance(value, str):
        return value if isinstance(value, list | dict) else [value]
    first = value.split(None, 1)[0] if value else ""
    if ":" in value or first in ("normal", "log-normal", "uniform", "log-uniform", "truncated"):
        return value
    return [value_of_text(part.strip()) for part in value.split(",")]


def command(
    study: str,
    changes: Mapping[str, Any],
    options: Mapping[str, Any],
    *,
    out: Path | None,
    experiments: Sequence[Path],
    runs: Path | None,
    resume: bool,
    dry_run: bool,
    device: str,
    **where: Any,
) -> int:
    """Make a sweep from the command line; return its exit status, 1 where runs failed.

    where: as of `executor_for`.
    """
    plan = read_plan(study, changes, options, device="cuda:0" if where["gpus"] else device)
    folder = out if out is not None else Path(f"{plan.study.study.name}-sweep")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with tqdm(total=len(plan.points), unit="run", disable=not sys.stderr.isatty(), leave=False) as bar:
        counted, said = batch.Count(len(plan.points)), time.monotonic()

        def on_cost(cost: str) -> None:
            nonlocal counted
            counted = batch.Count(len(plan.points))
            bar.write(cost, file=sys.stderr)

        def on_row(number: int, row: RunRow) -> None:
            nonlocal said
            bar.update()
            if row.status.startswith("failed"):
                bar.write(f"run {number}: {row.status}", file=sys.stderr)
            line = counted.one(row)
            if bar.disable and time.monotonic() - said > EVERY_SECONDS:  # a log shows no bar
                said = time.monotonic()
                bar.write(line, file=sys.stderr)

        def on_warning(sentence: str) -> None:
            bar.write(f"warning: {sentence}", file=sys.stderr)

        how: Any = {"runs": runs, "experiments": experiments, "dry_run": dry_run, "resume": resume}
        how |= {"on_cost": on_cost, "on_row": on_row, "on_warning": on_warning}
        try:
            result = make_sweep(plan, folder, where, **how)
        except KeyboardInterrupt:
            click.echo("the same command with --resume goes on from here", err=True)
            raise
    if dry_run:
        click.echo(result.cost)
        return 0
    click.echo(summary_text(result))
    click.echo(f"written to {folder}/: {', '.join(path.name for path in result.written)}")
    failed = failed_sentence(result)
    if failed is not None:
        click.echo(f"warpwear: {failed}. The same command with --resume tries them again.", err=True)
    return int(failed is not None)
