"""The command `warpwear report`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, PATH, THREADS
from warpwear.cli.places import thesis_page


@click.group()
def report() -> None:
    """Write a report of many runs as one page."""


@report.command()
@click.option(
    "--out", type=PATH, default=Path("thesis-report"), show_default=True, help="Folder of the report."
)
@click.option("--quick", is_flag=True, help="The fine rough model with cells of 5 µm instead of 1 µm.")
@THREADS
@DEVICE
@click.option("--overwrite", is_flag=True, help="Replace the report that the folder holds.")
def thesis(out: Path, **options: Any) -> None:
    """Set the thesis's printed results beside ours, with a verdict on each.

    The folder gets report.html, one page that needs nothing else, and numbers.json, all that is compared.
    """
    click.echo(f"written to {thesis_page.thesis_report(out, quiet=False, **options)}")
