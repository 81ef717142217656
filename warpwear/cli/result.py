"""The commands that take the folder of a run: `warpwear plot`, `animate` and `export`."""

from pathlib import Path

import click

from warpwear.cli.options import FOLDER, FORMAT, PATH
from warpwear.cli.places import exported, film, results


@click.command()
@FOLDER
@click.option("--only", "names", metavar="NAME", multiple=True, help="Only this, e.g. cof. Repeatable.")
@FORMAT
def plot(folder: Path, names: tuple[str, ...], file_format: str) -> None:
    """Draw the figures of the run in DIR.

    They go into DIR/figures and replace those that are there. Figures that make no sense for the run are
    left out, and the reason is said.
    """
    with results.Result.open(folder) as result:
        plotter, where = result.plot, (result.folder or folder) / "figures"
        plotter.check(names, file_format=file_format)
        left_out = {} if names else plotter.left_out
        for name in dict.fromkeys(names or plotter.NAMES):
            if name not in left_out:
                click.echo(plotter.save(name, where, file_format=file_format))
        plotter.save_captions(where)
        for reason in dict.fromkeys(left_out.values()):
            missing = ", ".join(name for name, why in left_out.items() if why == reason)
            click.echo(f"note: no {missing}: {reason}", err=True)


@click.command()
@FOLDER
@click.option("--out", type=PATH, help=".mp4 or .gif file. [default: DIR/animation.mp4 or .gif]")
@click.option("--fps", default=5.0, show_default=True, help="Frames a second.")
@click.option("--overwrite", is_flag=True, help="Replace a file that is there.")
def animate(folder: Path, out: Path | None, fps: float, overwrite: bool) -> None:
    """Film the run in DIR.

    The film shows the wearing disc, the pressure and the coefficient of friction. A frame is a snapshot,
    so the run needs two at least (key output.snapshots). mp4 needs ffmpeg; where it is
    not installed the default is gif.
    """
    with results.Result.open(folder) as result:
        click.echo(film.animate(result, out, frames_per_second=fps, overwrite=overwrite))


@click.command("export")
@FOLDER
@click.option("--out", type=PATH, help="Folder to write. [default: DIR/export]")
@click.option("--format", "formats", multiple=True, help="sdf, xyz or npy; repeatable. [default: all]")
@click.option("--snapshot", default=-1, show_default=True, help="Number of the snapshot; -1 is the end.")
@click.option("--overwrite", is_flag=True, help="Replace files that are there.")
def export_command(
    folder: Path, out: Path | None, formats: tuple[str, ...], snapshot: int, overwrite: bool
) -> None:
    """Write both worn bodies of the run in DIR.

    The files hold heights for other software: sdf is ASCII after ISO 25178-71, xyz has a line a point in
    mm, npy is an array of heights in mm.
    """
    with results.Result.open(folder) as result:
        where = out if out is not None else (result.folder or folder) / "export"
        chosen = formats or tuple(exported.WRITERS)
        for path in exported.export(result, where, snapshot=snapshot, formats=chosen, overwrite=overwrite):
            click.echo(path)
