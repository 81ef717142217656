"""Declare the command `warpwear record`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import FORMAT, PATH
from warpwear.cli.places import record_command


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=PATH)
@click.option("--radius", help="Radius of the track, e.g. '6 mm'; of several steps '6 mm, 9 mm'.")
@click.option("--stroke", help="Length of one stroke, where there is no position.")
@click.option("--speed", help="Sliding speed, where there is a time alone.")
@click.option("--load", help="Normal load, where it is not recorded.")
@click.option("--columns", metavar="NAMES", help="'DISTANCE,COF', 'TIME,FX,FZ' or 'TIME,FX,FZ,POSITION'.")
@click.option("--out", type=PATH, help="Folder for page, table and figures. [default: FILE's name + -record]")
@FORMAT
@click.option("--overwrite", is_flag=True, help="Replace the record that the folder holds.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out.")
def record(files: tuple[Path, ...], **options: Any) -> None:
    """Say what is in the record of a tribometer, as its machine wrote it, and draw it.

    FILE... is one record: a file, several that follow each other, or a folder of them. Prints and draws
    the coefficient of friction with its scatter, incubation, jump, overshoot, the steady value with its
    error, energy, friction loops, and what was left out. `compare`, `calibrate` and `bayes` read
    the same files.
    """
    click.echo(record_command.describe(files, **options))
