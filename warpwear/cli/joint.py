"""Declare the command `warpwear joint`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DEVICE, PATH
from warpwear.cli.places import joints, written
from warpwear.cli.surface import prepared, with_preparation
from warpwear.errors import InputError


@click.command()
@click.argument("surface", type=PATH)
@click.option("--against", type=PATH, help="File of the other surface. [default: a smooth plane]")
@click.option("--load", required=True, help="Mean pressures: '0.1:100 MPa', 13 of them, or '1, 5, 20 MPa'.")
@click.option("--material", required=True, help="Known material of the body, see `warpwear materials`.")
@click.option("--against-material", help="Of the other body. [default: the same]")
@click.option("--hardness", help="Largest pressure of a cell. [default: hardness of the softer material]")
@with_preparation()
@DEVICE
@click.option("--table", type=PATH, help="Write the table over the loads, CSV, to this file, too.")
@click.option("--out", type=PATH, help="Folder for page, table and figures. [default: SURFACE + -joint]")
@click.option("--overwrite", is_flag=True, help="Replace the joint that the folder holds, and the table.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out.")
def joint(surface: Path, **options: Any) -> None:
    """Press a measured SURFACE on a plane, or on another one: what the joint does over the load.

    Thermal and electrical conductance, stiffness as it is loaded and unloaded, real area and gap, with what
    wider cells change, and whether its asperities flow.
    """
    overwrite, as_json, table, folder = (
        options.pop(name) for name in ("overwrite", "as_json", "table", "out")
    )
    if folder is None and not as_json:
        folder = Path(f"{surface.name}-joint")
    if folder is not None:
        joints.JointCurve.check_out(folder, overwrite=overwrite)
    read = {file.resolve() for file in (surface, options["against"]) if file is not None}
    if table is not None and table.exists() and (table.resolve() in read or not overwrite):
        cure = "" if table.resolve() in read else ", or --overwrite"
        raise InputError(f"--table = {table} is there already: give another name{cure}")
    given = {name: value for name, value in (prepared(options) | options).items() if value is not None}
    curve = joints.joint_curve(surface, **given)
    if folder is not None:
        curve.write(folder, overwrite=overwrite)
    if table is not None:
        curve.write_table(table)
    end = f"written to {folder}/: joint.html, joint.csv, {curve.MARK}, figures"
    click.echo(written.to_json(curve.numbers) if as_json else f"{curve.text}\n{end}")
