"""Declare the command `warpwear report`."""

from pathlib import Path

import click

from warpwear.cli.options import FOLDER
from warpwear.cli.places import results, run_page, summaries

#: Dots per inch of the pictures that stand in a page made again.
DPI = 200


@click.command()
@FOLDER
def report(folder: Path) -> None:
    """Write report.html into the folder of a run again: the page that a run leaves.

    It shows numbers, plots, assumptions and limits in a single file that needs no network.
    """
    with results.Result.open(folder) as result:
        content = run_page.content_of(result, summaries.summarise(result), result.plot)
        wanted = set(run_page.statics(content)) & set(result.plot.names())
        pictures = {name: result.plot.png(name, dpi=DPI) for name in sorted(wanted)}
        page = run_page.made_here(content, pictures)
        click.echo(run_page.write_page(result.folder or folder, page))
