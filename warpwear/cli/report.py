"""Declare the command `warpwear report`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, FOLDER, PATH, THREADS
from warpwear.cli.places import results, thesis_page

#: Name of the command that takes a run folder; no folder has to be called so.
OF_A_RUN = "DIR"


class _Reports(click.Group):
    """Reports by name; what is no name of one is the folder of a run."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and not args[0].startswith("-") and args[0] not in self.commands:
            args = [OF_A_RUN, *args]
        return super().parse_args(ctx, args)


@click.group(cls=_Reports)
def report() -> None:
    """Write the page of a run, or a report of many runs.

    'warpwear report DIR' writes DIR/report.html again, the page that a run leaves: a single file that needs
    no network. A run folder called thesis is './thesis'.
    """


@report.command(OF_A_RUN)
@FOLDER
def of_a_run(folder: Path) -> None:
    """Write report.html into the folder of a run: its numbers, plots, assumptions and limits on one page."""
    with results.Result.open(folder) as result:
        click.echo(result.write_page())


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
