"""The command `warpwear compare`."""

from pathlib import Path

import click

from warpwear.cli.places import heavy


@click.command()
@click.argument("folders", metavar="[DIR]...", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--experiment",
    "experiments",
    metavar="FILE",
    multiple=True,
    type=click.Path(path_type=Path),
    help="A measured course of friction, .csv or other text. Repeatable.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("compare"),
    show_default=True,
    help="Folder for figures and table.",
)
@click.option("--format", "file_format", default="png", show_default=True, help="png, pdf or svg.")
@click.option("--overwrite", is_flag=True, help="Replace the comparison that the folder holds.")
@click.option("--speed", help="Of an experiment that gives times. [default: that of the runs]")
@click.option("--stroke", help="Of an experiment that gives cycles or positions. [default: that of the runs]")
@click.option(
    "--columns",
    metavar="NAMES",
    help="Columns of the experiments, 'DISTANCE,COF' or 'TIME,FX,FZ,POSITION', by name or number.",
)
def compare(
    folders: tuple[Path, ...],
    experiments: tuple[Path, ...],
    out: Path,
    file_format: str,
    overwrite: bool,
    speed: str | None,
    stroke: str | None,
    columns: str | None,
) -> None:
    """Lay the runs in DIR... and measured courses of friction over each other.

    Prints a table, and writes it with overlaid figures: coefficient of friction, area in contact (over
    the load too, where runs differ in it), mean pressure, worn volumes, worn profiles.
    """
    check_out = heavy("check_out")
    write = heavy("write")
    check_number = heavy("check_number")
    gather = heavy("gather")
    to_text = heavy("to_text")

    check_number(folders, experiments)
    check_out(out, file_format=file_format, overwrite=overwrite)
    comparison = gather(folders, experiments, speed=speed, stroke=stroke, columns=columns)
    click.echo(to_text(comparison))
    for path in write(comparison, out, file_format=file_format, overwrite=overwrite):
        click.echo(path)
