"""The command `warpwear new`: a commented study of one rig, ready to run."""

import shlex
from pathlib import Path

import click

from warpwear.cli.options import PATH
from warpwear.cli.places import drafts
from warpwear.cli.study import CHANGES, parsed_changes

KINDS = ("reciprocating", "rotating", "fretting", "pin", "block-on-ring")


@click.command()
@click.argument("file", type=PATH)
@click.option("--like", type=click.Choice(KINDS), default="reciprocating", show_default=True, help="The rig.")
@click.option("--surface", type=PATH, help="Measured surface of the disc or flat; made-up without one.")
@CHANGES
@click.option("--overwrite", is_flag=True, help="Replace the file that is there.")
def new(file: Path, like: str, surface: Path | None, changes: tuple[str, ...], overwrite: bool) -> None:
    """Write a commented study FILE of a rig, such as my-test.toml, with the keys that such a test needs.

    \b
    reciprocating   a ball slides to and fro on a disc
    rotating        a ball slides on a rotating disc
    fretting        a cylinder frets on a flat, in gross slip
    pin             a flat pin slides on a rotating disc
    block-on-ring   a ring turns on a block

    Put in what your test says, by --set or in the file: load, sizes, materials, wear coefficients. With
    --surface the cells are those of the measurement, as far as the contact needs them.
    """
    values = parsed_changes(changes)
    study = drafts.new_study(file, like=like, surface=surface, changes=values, overwrite=overwrite)
    click.echo(f"{file}: {drafts.outlook(study)}")
    click.echo(f"put in your numbers, then: warpwear run {shlex.quote(str(file))} --dry-run, and without it")
