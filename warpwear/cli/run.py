"""The command `warpwear run`: a study in, a run folder out."""

import shlex
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, PATH, THREADS
from warpwear.cli.places import results, run_checkpoint, runner, summaries, written
from warpwear.cli.study import CHANGES, STUDY, load_study
from warpwear.version import __version__


@click.command(epilog=STUDY)
@click.argument("study")
@click.option("--out", type=PATH, help="Run folder. [default: the study's name, here]")
@DEVICE
@THREADS
@CHANGES
@click.option(
    "--plots",
    type=click.Choice(("essential", "all", "none")),
    default="essential",
    show_default=True,
    help="Figures to draw: what goes into a paper, or all; `warpwear plot` draws them later.",
)
@click.option("--no-plots", is_flag=True, help="Draw no figures, as --plots none.")
@click.option("--details", is_flag=True, help="Print all numbers and notes before the ten lines.")
@click.option("--dry-run", is_flag=True, help="Say from the first contacts how long it takes, and stop.")
@click.option("--overwrite", is_flag=True, help="Replace the run that the folder holds.")
@click.option("--resume", is_flag=True, help="Go on from the checkpoint in the folder.")
@click.pass_obj
def run(
    started: float | None,
    study: str,
    changes: tuple[str, ...],
    out: Path | None,
    plots: str,
    no_plots: bool,
    details: bool,
    dry_run: bool,
    **options: Any,
) -> None:
    """Run STUDY and write its run folder.

    \b
    report.html    all of it on one page, to be opened in a browser; without figures there is none
    study.toml     the whole study, with every default and assumption
    result.h5      history and snapshots, in plain HDF5
    history.csv    one row a step, units in the header
    surface.csv    roughness in the middle of the scar and islands of contact, one row a snapshot
    summary.json   the numbers at the end, every assumption and warning, the seconds it took
    figures/       what goes into a paper; with --plots all, all that can be drawn of the run
    log.txt        what was computed, where and how long it took
    ro-crate-metadata.json  what stands in these files and in which unit, for other programs
    manifest.json  which files the run wrote; no other is ever replaced

    Ten lines at the end say what came out, and how far to trust it. A checkpoint for --resume is written
    every 2 minutes (key run.checkpoint) and on Ctrl-C.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a batch system's way of pressing Ctrl-C
    if sys.stderr.isatty():  # a sign of life: what comes next is imported for a second
        click.echo(f"warpwear {__version__}: {study}", err=True)
    loaded = load_study(study, changes)
    # A run folder that is to be resumed is itself where it goes on.
    own = Path(study) if options["resume"] and Path(study).is_dir() else Path(loaded.study.name)
    folder = own if out is None else out
    run_options = runner.RunOptions(
        out=None if dry_run else folder,
        plots="none" if no_plots or dry_run else plots,
        import_seconds=0.0 if started is None else time.perf_counter() - started,
        **options,
    )
    if dry_run:
        click.echo(runner.foresee(loaded, run_options))
        return
    try:
        progress = runner.Progress(loaded.study.name, most_notes=0)
        with progress, runner.run_study(loaded, replace(run_options, progress=progress)) as result:
            if details:
                click.echo(summaries.summary_text(summaries.summarise(result)))
                progress.tell_notes()
            click.echo(result)
    except KeyboardInterrupt:
        if (folder / "result.h5").is_file():
            with results.Result.open(folder) as result:
                click.echo(result, err=True)
        if run_checkpoint.holds_checkpoint(folder):
            _close("go on", f"warpwear run {shlex.quote(str(folder))} --resume", err=True)
        raise
    page = next(name for name in ("report.html", "summary.json") if (folder / name).exists())
    took = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.seconds.items() if seconds >= 0.05)
    _close("page", f"{folder / page} ({took or 'finished before: nothing was left to do'})")


def _close(label: str, text: str, *, err: bool = False) -> None:
    """Print the last of the ten lines."""
    click.echo("\n".join(written.lines([written.Row(label, "", text)])), err=err)
