"""The command `warpwear surface`, and the options that prepare a measured file."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import PATH, Option, together
from warpwear.cli.places import surface_command

#: Keys of [disc] as options: how a measured file is read and what is done to it.
PREPARATION = {
    "--pixel": "Distance of the points, e.g. '0.5 um' or '0.5 um, 0.6 um'; overrides the file.",
    "--height-unit": "Unit of the heights: m, mm, um or nm; overrides the file.",
    "--array": "Which array of a .npz, or measurement of a .zip, by name or number.",
    "--height-sign": "down turns heights over (the file gives depths).",
    "--crop": "Part used: 'x0, x1, y0, y1' from the file's corner, or a size such as '1 mm'.",
    "--sliding-axis": "Axis of the file along sliding: x or y. [default: x]",
    "--outliers": "Remove spikes: points more than this many robust standard deviations off, e.g. 6.",
    "--level": "none, plane, sphere, cylinder or a degree of a polynomial. [default: plane]",
    "--s-filter": "Take off shorter waves than this, e.g. '8 um'.",
    "--l-filter": "Take off longer waves than this, e.g. '0.8 mm'.",
}


def with_preparation(**other: str) -> Option:
    """Make the options of `PREPARATION`. other: name without dashes -> another help."""
    texts = PREPARATION | {f"--{name}": text for name, text in other.items()}
    return together(*(click.option(name, metavar="VALUE", help=text) for name, text in texts.items()))


def prepared(options: dict[str, Any]) -> dict[str, str | None]:
    """Take what `with_preparation` gave out of a command's options: key of [disc] -> text or None."""
    return {key: options.pop(key) for name in PREPARATION if (key := name[2:].replace("-", "_"))}


@click.command()
@click.argument("file", required=False, type=PATH)
@with_preparation()
@click.option("--line", help="A line of a map as a profile: axis along it and place, e.g. 'y, 0.5 mm'.")
@click.option("--lambda-c", help="Cut-off λc of profiles. [default: 2.5 mm; of a profile by ISO 21920-3]")
@click.option("--lambda-s", help="Cut-off λs of profiles. [default: 8 um; of a profile by ISO 21920-3]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a figure only with --figure.")
@click.option("--figure", type=PATH, help="[default: FILE's name + -surface.png, here]")
@click.option("--no-figure", is_flag=True, help="Draw no figure.")
@click.option("--overwrite", is_flag=True, help="Replace the figure that is there.")
@click.option("--track", is_flag=True, help="FILE is a worn track along the sliding axis: its volume.")
@click.option("--track-width", help="Width of the track with its pile-up, when it is not found.")
@click.option("--track-length", help="Length of the whole track, to which its volume is extended.")
@click.option("--before", type=PATH, help="The same place before it was worn, laid over FILE and taken off.")
@click.option("--ball", is_flag=True, help="FILE is a worn ball: its volume; or without FILE, --diagonals.")
@click.option("--radius", help="Radius of the ball, e.g. '3 mm'. [default: fitted]")
@click.option(
    "--diagonals", nargs=2, metavar="A B", help="Diagonals of the worn patch, e.g. '0.8 mm' '0.82 mm'."
)
def surface(file: Path | None, **options: Any) -> None:
    """Say what is in a measured surface FILE: grid, units, roughness, spectrum, and draw it.

    FILE may hold a profile, too: its parameters of ISO 21920, with --track the section of a groove in it.
    With --before what a wear scar has lost and piled up, with --track the volume of a worn track, with
    --ball that of a worn ball.
    """
    click.echo(surface_command.describe(file, prepared(options), **options))
