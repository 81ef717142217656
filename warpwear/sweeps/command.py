"""What `warpwear sweep` does: reads what is varied, says what it will cost, makes the runs, reports."""

import signal
import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from warpwear.batches import batch
from warpwear.batches.cluster import connected
from warpwear.batches.plan import Plan, read_plan
from warpwear.batches.run_one import Row
from warpwear.errors import InputError
from warpwear.measured.course import read_experiment
from warpwear.runs.console import EVERY_SECONDS
from warpwear.study.loading import value_of_text
from warpwear.sweeps.report import FILES, failed_sentence, summary_text, write_report
from warpwear.sweeps.sweep import check_runs
from warpwear.sweeps.table import SweepResult


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
    runs: Path | None,
    device: str,
    resume: bool,
    dry_run: bool,
    experiments: Sequence[Path],
    **where: Any,
) -> int:
    """Make a sweep from the command line; return its exit status, 1 where runs failed.

    where: workers, cluster, insecure, gpus.
    """
    plan = read_plan(study, changes, options, device="cuda:0" if where["gpus"] else device)
    sliding, load = plan.study.sliding, plan.study.same_load
    motion: Any = {"speed": sliding.speed, "stroke": sliding.stroke, "radius": plan.study.same_radius}
    measured = tuple(read_experiment(path, load=load, **motion) for path in experiments)
    folder = out if out is not None else Path(f"{plan.study.study.name}-sweep")
    batch.check_folder(folder, resume=resume, files=FILES)
    check_runs(plan, folder)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if runs is not None and not dry_run:
        batch.share_runs(folder, runs)
    place = nullcontext() if dry_run else batch.opened_folder(folder)
    with place, _executor(plan, **where) as (executor, threads, workers):
        place_of_pilot = None if dry_run else folder
        cost = batch.estimate(plan, place_of_pilot, executor, threads=threads, workers=workers)
        click.echo(cost, err=not dry_run)
        if dry_run:
            return 0
        with tqdm(total=len(plan.points), unit="run", disable=not sys.stderr.isatty(), leave=False) as bar:
            counted, said = batch.Count(len(plan.points)), time.monotonic()

            def on_row(number: int, row: Row) -> None:
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

            try:
                rows = batch.make_runs(
                    plan, folder, executor, threads=threads, on_row=on_row, on_warning=on_warning
                )
            except KeyboardInterrupt:
                click.echo("the same command with --resume goes on from here", err=True)
                raise
        result = SweepResult(plan, rows, folder)
        written = write_report(result, folder, measured)
    click.echo(summary_text(result))
    click.echo(f"written to {folder}/: {', '.join(path.name for path in written)}")
    failed = failed_sentence(result)
    if failed is not None:
        click.echo(f"warpwear: {failed}. The same command with --resume tries them again.", err=True)
    return int(failed is not None)


def _executor(
    plan: Plan, *, workers: int | None, cluster: str | None, insecure: bool, gpus: str | None
) -> AbstractContextManager[tuple[Executor, int, int]]:
    """Return the executor that was asked for, the threads of a run, and the number of workers."""
    if cluster is None:
        return batch.local_executor(plan, workers=workers, gpus=gpus is not None)
    if workers is not None or gpus is not None:
        raise InputError("--cluster excludes --workers and --gpus: its own workers make the runs.")
    return connected(cluster, insecure=insecure, device=plan.device)
