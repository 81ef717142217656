"""What `warpwear sweep` does: reads what is varied, says what it will cost, makes the runs, reports."""

import signal
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from warpwear.batches import batch
from warpwear.batches.plan import read_plan
from warpwear.batches.run_one import RunRow
from warpwear.errors import InputError
from warpwear.runs.console import EVERY_SECONDS
from warpwear.study.loading import value_of_text
from warpwear.sweeps.report import failed_sentence, summary_text
from warpwear.sweeps.sweep import make_sweep


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
