"""The commands that take the folder of a run: `warpwear plot`, `report`, `animate` and `export`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import FOLDER, FORMAT, PATH, repeated
from warpwear.cli.places import results


@click.command()
@FOLDER
@repeated("--only", "NAME", "Only this, e.g. cof.", "names")
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
def report(folder: Path) -> None:
    """Write report.html into the folder of a run again: the page that a run leaves.

    It shows numbers, plots, assumptions and limits in a single file that needs no network.
    """
    with results.Result.open(folder) as result:
        click.echo(result.write_page())


@click.command()
@FOLDER
@click.option("--out", type=PATH, help=".mp4 or .gif file. [default: DIR/animation.mp4 or .gif]")
@click.option("--fps", default=5.0, show_default=True, help="Frames a second.")
@click.option("--overwrite", is_flag=True, help="Replace a file that is there.")
def animate(folder: Path, out: Path | None, fps: float, overwrite: bool) -> None:
    """Make a film of the run in DIR.

    The film shows the wearing disc, the pressure and the coefficient of friction. A frame is a snapshot,
    so the run needs two at least (key output.snapshots). mp4 needs ffmpeg; where it is
    not installed the default is gif.
    """
    with results.Result.open(folder) as result:
        click.echo(result.animate(out, frames_per_second=fps, overwrite=overwrite))


@click.command("export")
@FOLDER
@click.option("--out", type=PATH, help="Folder to write. [default: DIR/export]")
@repeated("--format", "NAME", "One of those above.", "formats", default="sdf, xyz and npy")
@repeated("--snapshot", "WHICH", "Number, '30 mm', or all.", default="the end; all for vti and netcdf")
@repeated(
    "--body", "NAME", "counter, disc, or track of a swept run.", "bodies", default="counter-body and disc"
)
@repeated("--field", "NAME", "Field of csv, vti and netcdf, e.g. pressure.", "fields", default="all")
@click.option(
    "--points", type=int, help="Most points along a side, means of blocks. [default: 250 for stl, else all]"
)
@click.option("--crate", is_flag=True, help="The same as --format crate.")
@repeated("--add", "FILE", "A record, a surface or another file that goes into the crate.", "add")
@click.option("--overwrite", is_flag=True, help="Replace files that are there.")
def export_command(folder: Path, out: Path | None, overwrite: bool, crate: bool, **options: Any) -> None:
    """Write the worn bodies and the fields of the run in DIR for other software.

    \b
    sdf, x3p   heights for MountainsMap and Gwyddion, in metres
    stl        both bodies in their places, as closed solids in mm
    vti        fields and both bodies for ParaView; open the .pvd, which is a film
    netcdf     history and fields for xarray and MATLAB, with units
    csv        fields, a row a cell, and profiles for MATLAB and Excel
    xyz, npy   points and arrays of heights, in mm
    crate      the run with all that it was made of, as an RO-Crate in a zip, to pass on
    """
    with results.Result.open(folder) as result:
        where = out if out is not None else (result.folder or folder) / "export"
        if crate:
            options["formats"] = (*(options["formats"] or ()), "crate")
        settings = {name: value for name, value in options.items() if value not in (None, ())}
        for path in result.export(where, overwrite=overwrite, **settings):
            click.echo(path)
