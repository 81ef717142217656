"""Declare the command `warpwear surface`, and the options that prepare a measured file."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DETAILS, PATH, Option, place_for, together
from warpwear.cli.places import measured, options, reports, written
from warpwear.errors import InputError

#: Keys of [disc] as options: how a measured file is read and what is done to it.
PREPARATION = {
    "--pixel": "Distance of the points, e.g. '0.5 um' or '0.5 um, 0.6 um'; overrides the file.",
    "--height-unit": "Unit of the heights: m, mm, um or nm; overrides the file.",
    "--array": "Which array, channel, column or measurement of several in the file, by name or number.",
    "--height-sign": "'down' where the file gives depths: they are turned over.",
    "--crop": "Part used: 'x0, x1, y0, y1' from the corner, of a profile 'x0, x1', or a size such as '1 mm'.",
    "--sliding-axis": "Axis of the file along sliding: x or y. [default: x]",
    "--outliers": "Remove spikes: points more than this many robust standard deviations off, e.g. 6.",
    "--level": "Form taken off: none, plane, sphere, cylinder or a degree of a polynomial. [default: plane]",
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
@DETAILS
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

    FILE is an array (.npy, .npz), a container of contact.engineering (.zip), a file of Gwyddion (.gwy), an
    archive of ISO 25178-72 (.x3p), a profile (.prf), text of points x y z or of a matrix (.xyz, .txt, .csv,
    .asc, .dat, .tsv, .hfm), any height map or profile that SurfaceTopography reads (.al3d, .sur, .opd, .plu,
    .mnt, .sdf, .tmd and others), or one of these packed (.gz).

    It may hold a profile, too: its parameters of ISO 21920, with --track the section of a groove in it.
    With --before what a wear scar has lost and piled up, with --track the volume of a worn track, with
    --ball that of a worn ball.
    """
    click.echo(describe(file, prepared(options), **options))


def describe(file: Path | None, preparation: Mapping[str, Any], **choices: Any) -> str:
    """Say what is in a measured file, as text for people or as JSON, and write its figure.

    preparation: as of `prepared`. choices: other options of the command. Raises InputError.
    """
    o = options.Options(choices)
    if (file is None) != (o["--diagonals"] is not None):
        what = "FILE is missing" if file is None else "--diagonals stand for FILE"
        raise InputError(f"{what}: allowed is a measured surface, or --ball with --radius and --diagonals")
    measured.check_together(o)
    if o["--figure"] and o["--no-figure"]:
        raise InputError("--figure and --no-figure exclude each other")
    kind = "track" if o["--track"] else "ball" if o["--ball"] else "scar" if o["--before"] else None
    is_drawn = file is not None and not (o["as_json"] or o["--no-figure"])
    default = Path(f"{file.name}-{kind or 'surface'}.png") if file is not None and is_drawn else None
    figure, notice = place_for(o["--figure"], default, overwrite=o["--overwrite"])
    if figure is not None:
        reports.check_figure(figure, overwrite=o["--overwrite"])
    report = _report(file, kind, preparation, o)
    if figure is not None:
        report.save_figure(figure, overwrite=o["--overwrite"])
        notice = f"written to {figure}"
    if o["as_json"]:
        return measured.with_options(written.to_json(report.numbers))
    return reports.closed(report.text, notice, details=o["--details"])


def _report(file: Path | None, kind: str | None, how: Mapping[str, Any], o: Any) -> Any:
    """Read what the options ask for. Raises InputError."""
    if file is None:
        if o["--radius"] is None:
            raise InputError("--diagonals needs --radius, a length such as '3 mm'")
        return measured.worn_cap(*o["--diagonals"], radius=o["--radius"])
    if kind is not None:
        names = ("before", "track_width", "track_length", "radius", "line")
        return measured.read_worn(file, kind, **how, **{name: o[name] for name in names})
    filters = {name: o[name] for name in ("lambda_c", "lambda_s") if o[name] is not None}
    if o["--line"] is None:
        with suppress(measured.HoldsAProfile):
            return measured.read_surface(file, **how, **filters)
    return measured.read_profile(file, line=o["--line"], **how, **filters)
