"""The command `warpwear run`: a study in, a run folder out."""

import signal
from pathlib import Path

import click

from warpwear.cli.places import heavy
from warpwear.cli.study import STUDY, load_study, with_changes


@click.command(epilog=STUDY)
@click.argument("study")
@click.option("--out", type=click.Path(path_type=Path), help="Run folder. [default: the study's name, here]")
@click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
@click.option("--threads", type=int, help="Threads of the CPU; changes no result. [default: all cores]")
@with_changes
@click.option("--no-plots", is_flag=True, help="Draw no figures; `warpwear plot` draws them later.")
@click.option("--overwrite", is_flag=True, help="Replace the run that the folder holds.")
@click.option("--resume", is_flag=True, help="Go on from the checkpoint in the folder.")
def run(
    study: str,
    out: Path | None,
    device: str,
    threads: int | None,
    changes: tuple[str, ...],
    no_plots: bool,
    overwrite: bool,
    resume: bool,
) -> None:
    """Run STUDY and write its run folder.

    \b
    study.toml     the whole study, with every default and assumption
    result.h5      history and snapshots, in plain HDF5
    history.csv    one row a step, units in the header
    surface.csv    roughness inside the scar and islands of contact, one row a snapshot
    summary.json   the numbers at the end, every assumption and warning
    figures/       what can be drawn of the run
    log.txt        what was computed, where and how long it took

    A checkpoint for --resume is written every 2 minutes (key run.checkpoint) and on Ctrl-C.
    """
    Result = heavy("Result")
    summary_text = heavy("summary_text")
    holds_checkpoint = heavy("holds_checkpoint")
    is_finished = heavy("is_finished")
    run_study = heavy("run_study")

    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a batch system's way of pressing Ctrl-C
    loaded = load_study(study, changes)
    folder = out if out is not None else Path(loaded.study.name)
    if resume and not overwrite and is_finished(folder, loaded):
        click.echo(f"{folder}/ holds this run, finished: nothing is left to do")
        return
    try:
        result = run_study(
            loaded,
            out=folder,
            device=device,
            threads=threads,
            plots=not no_plots,
            overwrite=overwrite,
            resume=resume,
            progress=True,
        )
    except KeyboardInterrupt:
        if (folder / "result.h5").is_file():
            with Result.open(folder) as result:
                how = "finished, without all its figures" if result.finished else "unfinished"
                click.echo(f"{folder}/ holds the run as far as it came: {how}", err=True)
        if holds_checkpoint(folder):
            click.echo("the same command with --resume goes on from here", err=True)
        raise
    with result:
        click.echo(summary_text(result.summary))
    click.echo(f"written to {folder}/")
