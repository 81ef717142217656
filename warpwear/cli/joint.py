"""Declare the commands `warpwear joint` and `warpwear contact`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, PATH, repeated, together
from warpwear.cli.places import joints, written
from warpwear.cli.study import parsed_changes
from warpwear.cli.surface import prepared, with_preparation
from warpwear.errors import InputError

BODIES = together(
    click.argument("surface", type=PATH),
    click.option("--against", type=PATH, help="File of the other surface. [default: a smooth plane]"),
    click.option("--material", required=True, help="Known material of the body, see `warpwear materials`."),
    click.option("--hardness", help="Largest pressure of a cell. [default: hardness of the softer material]"),
    with_preparation(),
    DEVICE,
    click.option("--out", type=PATH, help="Folder for page, table and figures. [default: from SURFACE]"),
    click.option("--overwrite", is_flag=True, help="Replace what the folder holds, and a --table."),
    click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out."),
)


@click.command()
@click.option("--load", required=True, help="Mean pressures: '0.1:100 MPa', 13 of them, or '1, 5, 20 MPa'.")
@BODIES
@click.option("--against-material", help="Of the other body. [default: the same]")
@click.option("--flow/--no-flow", default=True, help="Find what flows, too, which takes most of the time.")
@click.option("--table", type=PATH, help="Write the table over the loads, CSV, to this file, too.")
def joint(surface: Path, **options: Any) -> None:
    """Press a measured SURFACE on a plane, or on another one: what the joint does over the load.

    Thermal and electrical conductance, stiffness as it is loaded and unloaded, real area and gap, with what
    wider cells change, and whether its asperities flow.
    """
    _tell(joints.joint_curve, joints.JointCurve, surface, options)


@click.command()
@click.option("--load", required=True, help="A force, '5 N', or of a plane a mean pressure, '10 MPa'.")
@BODIES
@repeated(
    "--set", "KEY=VALUE", "A key of [counter]: counter.radius='3 mm', counter.material='PEEK'.", "changes"
)
@click.option("--flow", is_flag=True, help="Find what flows through the gap, too.")
@click.option("--stresses", is_flag=True, help="Find the stresses below the surface, too.")
def contact(surface: Path, changes: tuple[str, ...], **options: Any) -> None:
    """Press a measured SURFACE with one load: on a plane, another one, or a counter-body that --set says.

    \b
    warpwear contact disc.x3p --load "5 N" --material "AISI 304" \\
        --set counter.radius="3 mm" --set counter.material="AISI 52100"

    Areas, pressures, gaps, spots, stiffness and conductance, with maps, what wider cells change and, of
    smooth bodies, Hertz's contact.
    """
    counter = {key.removeprefix("counter."): str(of) for key, of in parsed_changes(changes).items()}
    _tell(joints.measured_contact, joints.MeasuredContact, surface, options | {"counter": counter})


def _tell(call: Any, kind: Any, surface: Path, options: dict[str, Any]) -> None:
    """Call what finds a report, write its folder and its table, and print it."""
    overwrite, as_json, folder = (options.pop(name) for name in ("overwrite", "as_json", "out"))
    table, name = options.pop("table", None), kind.MARK.removesuffix(".json")
    if folder is None and not as_json:
        folder = Path(f"{surface.name}-{name}")
    if folder is not None:
        kind.check_out(folder, overwrite=overwrite)
    read = {file.resolve() for file in (surface, options["against"]) if file is not None}
    if table is not None and (table.is_dir() or not table.absolute().parent.is_dir()):
        raise InputError(f"--table = {table}: the name of a file in a folder that is there is allowed")
    if table is not None and table.exists() and (table.resolve() in read or not overwrite):
        cure = "" if table.resolve() in read else ", or --overwrite"
        raise InputError(f"--table = {table} is there already: give another name{cure}")
    given = {key: value for key, value in (prepared(options) | options).items() if value is not None}
    report = call(surface, **given)
    if folder is not None:
        report.write(folder, overwrite=overwrite)
    if table is not None:
        report.write_table(table)
    end = f"written to {folder}/: {name}.html, {name}.csv, {kind.MARK}, figures"
    click.echo(written.to_json(report.numbers) if as_json else f"{report.text}\n{end}")
