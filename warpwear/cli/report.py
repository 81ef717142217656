"""The command `warpwear report`."""

from pathlib import Path

import click

from warpwear.cli.places import heavy


@click.group()
def report() -> None:
    """Write a report of many runs as one page."""


@report.command()
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("thesis-report"),
    show_default=True,
    help="Folder of the report.",
)
@click.option("--quick", is_flag=True, help="The fine rough model with cells of 5 µm instead of 1 µm.")
@click.option("--threads", type=int, help="Threads of the CPU; changes no result. [default: all cores]")
@click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
@click.option("--overwrite", is_flag=True, help="Replace the report that the folder holds.")
def thesis(out: Path, quick: bool, threads: int | None, device: str, overwrite: bool) -> None:
    """Set the thesis's printed results beside ours, with a verdict on each.

    The folder gets report.html, one page that needs nothing else, and numbers.json, all that is compared.
    """
    thesis_report = heavy("thesis_report")

    page = thesis_report(out, quick=quick, threads=threads, device=device, overwrite=overwrite, quiet=False)
    click.echo(f"written to {page}")
