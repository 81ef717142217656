"""The command `warpwear run`: a study in, a run folder out."""

import signal
import sys
import time
from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, PATH, THREADS
from warpwear.cli.places import results, run_checkpoint, runner
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
@click.option("--notes", is_flag=True, help="Tell all notes here, not the three heaviest alone.")
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
    notes: bool,
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

    A checkpoint for --resume is written every 2 minutes (key run.checkpoint) and on Ctrl-C.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a batch system's way of pressing Ctrl-C
    if sys.stderr.isatty():  # a sign of life: what comes next is imported for a second
        click.echo(f"warpwear {__version__}: {study}", err=True)
    loaded = load_study(study, changes)
    # A run folder that is to be resumed is itself where it goes on.
    own = Path(study) if options["resume"] and Path(study).is_dir() else Path(loaded.study.name)
    folder = own if out is None else out
    try:
        with runner.Progress(loaded.study.name, all_notes=notes) as progress:
            run_options = runner.RunOptions(
                out=folder,
                plots="none" if no_plots else plots,
                progress=progress,
                import_seconds=0.0 if started is None else time.perf_counter() - started,
                **options,
            )
            with runner.run_study(loaded, run_options) as result:
                if not result.seconds:
                    click.echo(f"{folder}/ holds this run, finished: nothing is left to do")
                    return
                click.echo(result)
            page = "report.html" if (folder / "report.html").exists() else "summary.json"
            progress.elsewhere = f"{folder / page}, or --notes"
    except KeyboardInterrupt:
        if (folder / "result.h5").is_file():
            with results.Result.open(folder) as result:
                how = "finished, without all its figures" if result.finished else "unfinished"
                click.echo(f"{folder}/ holds the run as far as it came: {how}", err=True)
        if run_checkpoint.holds_checkpoint(folder):
            click.echo("the same command with --resume goes on from here", err=True)
        raise
    took = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.seconds.items() if seconds >= 0.05)
    click.echo(f"written to {folder}/" + (f" ({took})" if took else ""))
