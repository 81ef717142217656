"""The command `warpwear compare`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import BAND_OVER, EXPERIMENTS, FORMAT, PATH
from warpwear.cli.places import compared, comparison_table
from warpwear.cli.surface import prepared, with_preparation


@click.command()
@click.argument("folders", metavar="[DIR]...", nargs=-1, type=PATH)
@BAND_OVER
@EXPERIMENTS
@click.option(
    "--out", type=PATH, default=Path("compare"), show_default=True, help="Folder for figures and table."
)
@FORMAT
@click.option("--overwrite", is_flag=True, help="Replace the comparison that the folder holds.")
@click.option("--speed", help="Of an experiment that gives times. [default: that of the runs]")
@click.option("--stroke", help="Of an experiment that gives cycles or positions. [default: that of the runs]")
@click.option("--radius", help="Track's, of an experiment that gives turns. [default: that of the runs]")
@click.option(
    "--columns",
    metavar="NAMES",
    help="Columns of experiments, 'DISTANCE,COF', 'TIME,FX,FZ' or 'TIME,FX,FZ,POSITION'; by name or number.",
)
@click.option("--scar", type=PATH, help="The worn disc, a measured surface, to lay over the computed scars.")
@click.option("--before", type=PATH, help="The same place of --scar before it was worn.")
@with_preparation()
def compare(folders: tuple[Path, ...], out: Path, file_format: str, overwrite: bool, **settings: Any) -> None:
    """Lay the runs in DIR... and measured courses of friction over each other.

    DIR is the folder of a run, or of a sweep for all its runs. With

    \b
    warpwear compare loads --band-over disc.synthetic.seed

    surfaces of several seeds are one line, their mean, in a band from 5 to 95 % of the runs, and one
    column of the table, mean ± standard deviation.

    With

    \b
    warpwear compare RUN --scar after.sur --before before.sur

    the measured wear scar is laid over the computed ones.

    Prints a table, and writes it with overlaid figures: coefficient of friction, area in contact (over
    the load too, where runs differ in it), mean pressure, worn volumes, worn profiles. compare.html
    shows all of it on one page.
    """
    how, scar = prepared(settings), settings["scar"]
    of_scar = {"before": settings["before"], **how}
    compared.check_choice(folders, settings["experiments"], scar, of_scar)
    compared.ComparedRuns.check_out(out, file_format=file_format, overwrite=overwrite)
    comparison = compared.compare(*folders, **settings, **how)
    click.echo(comparison_table.to_text(comparison))
    for path in comparison.write(out, file_format=file_format, overwrite=overwrite):
        click.echo(path)
