"""The command `warpwear new`: a commented study of one rig, ready to run."""

import shlex
import warnings
from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import IN_TESTS, PATH, repeated, together
from warpwear.cli.places import drafts, repeated_tests
from warpwear.cli.study import CHANGES, parsed_changes
from warpwear.cli.surface import prepared, with_preparation
from warpwear.errors import InputError, StudyWarning

KINDS = ("reciprocating", "rotating", "fretting", "pin", "block-on-ring")


@click.command()
@click.argument("file", type=PATH)
@click.option("--like", type=click.Choice(KINDS), default="reciprocating", show_default=True, help="The rig.")
@click.option("--surface", type=PATH, help="Measured surface of the disc or flat; made-up without one.")
@repeated("--record", "FILE", "A tribometer's record of a test.", "--repeat", "records", type=PATH)
@together(*IN_TESTS.values())
@click.option("--tests", type=PATH, help="A TOML file with tables [[test]] instead, and maybe keys.")
@click.option("--columns", metavar="NAMES", help="Which columns of the records to take.")
@with_preparation()
@CHANGES
@click.option("--overwrite", is_flag=True, help="Replace the file that is there.")
def new(file: Path, changes: tuple[str, ...], **options: Any) -> None:
    """Write a commented study FILE of a rig, such as my-test.toml, with the keys that such a test needs.

    \b
    reciprocating   a ball slides to and fro on a disc
    rotating        a ball slides on a rotating disc
    fretting        a cylinder frets on a flat, in gross slip
    pin             a flat pin slides on a rotating disc
    block-on-ring   a ring turns on a block

    Put in what your test says, by --set or in the file: load, sizes, materials, wear coefficients. With
    --surface the cells are those of the measurement, as far as the contact needs them.

    Or let the files of your tests say it: load, way, speed, distance, friction, and wear coefficients from
    profiles, scars or volumes, in the order of the records. Each comment says where a number is from; what
    no file says is asked for by name.

    \b
    warpwear new my-test.toml --like rotating --record test-1.csv --repeat test-2.csv \\
        --profile track-1.txt --profile track-2.txt --set counter.diameter="6 mm" ...
    """
    records, tests = options.pop("records"), options.pop("tests")
    measured = {key: options.pop(key) for key in IN_TESTS}
    if records or any(measured.values()):
        if tests is not None:
            raise InputError("--tests and --record exclude each other: the file lists the records")
        tests = repeated_tests.in_order({}, record=records, **measured)
    options |= {"preparation": prepared(options), "changes": parsed_changes(changes), "tests": tests}
    with warnings.catch_warnings(record=True, action="always") as doubts:
        study = drafts.new_study(file, **options)
    place, name = shlex.quote(str(file)), shlex.quote(study.study.name)
    told = [study.study.description, *(f"warning: {d.message}" for d in doubts if d.category is StudyWarning)]
    click.echo("\n  ".join([f"{file}: {drafts.outlook(study)}", *filter(None, told)]))
    if tests is None:
        click.echo(f"put in your numbers, then: warpwear run {place} --dry-run, and without it")
    else:
        beside = "".join(f" --experiment {shlex.quote(str(path))}" for path in records or ["RECORD"])
        click.echo(f"then: warpwear run {place}\n      warpwear compare {name}{beside}")
