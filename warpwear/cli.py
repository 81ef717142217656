"""The command line. Exit status 0, 2 for bad input with one plain sentence, 130 when interrupted."""

import os
import signal
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from warpwear import __version__
from warpwear.cli_calibrate import calibrate
from warpwear.cli_compare import compare
from warpwear.cli_report import report
from warpwear.cli_surface import surface
from warpwear.errors import ConvergenceError, InputError

STUDY = "STUDY is a TOML file, a run folder or the name of a preset (see 'warpwear studies')."


def main(arguments: list[str] | None = None) -> None:
    """Entry point: turns errors for people into one sentence and an exit status."""
    try:
        status = commands.main(arguments, prog_name="warpwear", standalone_mode=False)
    except (InputError, ConvergenceError) as error:
        _fail(str(error), at_once=isinstance(error.__cause__, MemoryError))
    except MemoryError:
        _fail(
            "the memory ran out; larger cells (grid.cell) or a smaller grid.extent are needed.", at_once=True
        )
    except click.ClickException as error:
        _fail(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        click.echo("warpwear: interrupted.", err=True)
        sys.exit(130)
    except BrokenPipeError:  # the reader of a pipe has left
        sys.exit(0)
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: str, *, at_once: bool = False) -> None:
    """at_once: without the interpreter's own end, in which HDF5 may crash after the memory ran out."""
    click.echo(f"warpwear: {message}", err=True)
    if at_once:
        sys.stdout.flush()
        os._exit(2)
    sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="%(prog)s %(version)s")
def commands() -> None:
    """Contact, wear and friction of rough surfaces on fine meshes.

    \b
    warpwear run v3-fine            the main job: 1 µm cells, well under half a minute
    warpwear run my-disc.toml       the same for your own disc
    """


def with_changes(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option --set."""
    return click.option(
        "--set",
        "changes",
        metavar="KEY=VALUE",
        multiple=True,
        help="Change a key of the study by its dotted name, e.g. --set grid.cell='2 um'. Repeatable.",
    )(command)


@commands.command(epilog=STUDY)
@click.argument("study")
@click.option("--out", type=click.Path(path_type=Path), help="Run folder. [default: the study's name]")
@click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
@click.option("--threads", type=int, help="Threads of the CPU; changes no result. [default: all cores]")
@with_changes
@click.option("--no-plots", is_flag=True, help="Draw no figures.")
@click.option("--overwrite", is_flag=True, help="Replace the run that the folder holds.")
@click.option("--resume", is_flag=True, help="Go on with the run that was stopped in the folder.")
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

    The folder gets study.toml, result.h5, history.csv, summary.json, figures and log.txt; while the run goes
    on, every 2 minutes (run.checkpoint) and when it is interrupted, a checkpoint for --resume.
    """
    from warpwear import checkpoint, run_folder
    from warpwear.results import Result
    from warpwear.runner import run as run_study
    from warpwear.summary_text import summary_text

    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a batch system's way of pressing Ctrl-C
    loaded = _load(study, changes)
    folder = out if out is not None else Path(loaded.study.name)
    if resume and not overwrite and run_folder.is_finished(folder, loaded):
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
        if checkpoint.is_one(folder / checkpoint.FILE_NAME):
            click.echo("the same command with --resume goes on from here", err=True)
        raise
    with result:
        click.echo(summary_text(result.summary))
    click.echo(f"written to {folder}/")


@commands.command()
def studies() -> None:
    """List the presets."""
    from warpwear.study import Study
    from warpwear.study_file import presets

    for name in presets():
        click.echo(f"{name:<10} {Study.load(name).study.description}")


@commands.command(epilog=STUDY)
@click.argument("study")
@with_changes
def show(study: str, changes: tuple[str, ...]) -> None:
    """Print the whole STUDY after defaults, each assumption marked."""
    from warpwear import render

    loaded = _load(study, changes)
    click.echo(render.to_marked_toml(loaded))
    for notice in loaded.notices():
        click.echo(f"note: {notice}", err=True)


@commands.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--only", "names", metavar="NAME", multiple=True, help="Only this figure. Repeatable.")
@click.option("--format", "file_format", default="png", show_default=True, help="png, pdf or svg.")
def plot(folder: Path, names: tuple[str, ...], file_format: str) -> None:
    """Draw the figures of the run in DIR (again).

    They go into DIR/figures. Figures that make no sense for the run are left out, with the reason.
    """
    from warpwear.results import Result

    with Result.open(folder) as result:
        plotter, where = result.plot, (result.folder or folder) / "figures"
        plotter.check(names, file_format=file_format)
        left_out = {} if names else plotter.left_out
        for name in dict.fromkeys(names or plotter.NAMES):
            if name not in left_out:
                click.echo(plotter.save(name, where, file_format=file_format))
        for reason in dict.fromkeys(left_out.values()):
            missing = ", ".join(name for name, why in left_out.items() if why == reason)
            click.echo(f"note: no {missing}: {reason}", err=True)


@commands.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), help=".mp4 or .gif file. [default: DIR/animation.mp4 or .gif]"
)
@click.option("--fps", default=5.0, show_default=True, help="Frames a second; a frame is a snapshot.")
@click.option("--overwrite", is_flag=True, help="Replace a file that is there.")
def animate(folder: Path, out: Path | None, fps: float, overwrite: bool) -> None:
    """Film the run in DIR: the wearing disc, the pressure and the coefficient of friction.

    mp4 needs ffmpeg; without it the default is gif.
    """
    from warpwear.animation import animate as animate_result
    from warpwear.results import Result

    with Result.open(folder) as result:
        click.echo(animate_result(result, out, frames_per_second=fps, overwrite=overwrite))


@commands.command("export")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder to write. [default: DIR/export]")
@click.option("--format", "formats", multiple=True, help="sdf, xyz or npy; repeatable. [default: all]")
@click.option("--snapshot", default=-1, show_default=True, help="Number of the snapshot; -1 is the end.")
@click.option("--overwrite", is_flag=True, help="Replace files that are there.")
def export_command(
    folder: Path, out: Path | None, formats: tuple[str, ...], snapshot: int, overwrite: bool
) -> None:
    """Write both worn bodies of the run in DIR as files for other software.

    sdf is ASCII after ISO 25178-71, xyz a line a point in mm, npy heights in mm.
    """
    from warpwear.export import WRITERS, export
    from warpwear.results import Result

    with Result.open(folder) as result:
        where = out if out is not None else (result.folder or folder) / "export"
        chosen = formats or tuple(WRITERS)
        for path in export(result, where, snapshot=snapshot, formats=chosen, overwrite=overwrite):
            click.echo(path)


@commands.command("materials")
def list_materials() -> None:
    """List the known materials: elastic constants and hardness, each with its source."""
    from warpwear.materials import material, names

    for name in names():
        known = material(name)
        click.echo(
            f"{known.name}, {known.condition}: E {1e-3 * known.young:g} GPa, ν {known.poisson:g}, "
            f"hardness {1e-3 * known.hardness:.3g} GPa"
        )
        for value, source in known.sources.items():
            click.echo(f"    {value}: {source}")


for command in (surface, compare, calibrate, report):
    commands.add_command(command)


def _load(study: str, changes: tuple[str, ...]) -> Any:
    from warpwear.study import Study

    parsed = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals:
            raise InputError(f"--set {change!r}: KEY=VALUE is expected, such as grid.cell='2 um'.")
        parsed[key.strip()] = _value(value.strip())
    return Study.load(study).replace(parsed)


def _value(text: str) -> Any:
    """A value as TOML reads it; anything else is text, so that quotes may be left to the shell."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML, a number of thousands of digits, endless nesting
        return text
