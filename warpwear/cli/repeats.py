"""Declare the command `warpwear repeats`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import FORMAT, PATH, repeated, together
from warpwear.cli.places import repeated_tests, written
from warpwear.cli.surface import prepared, with_preparation
from warpwear.errors import InputError

#: What was measured beside the records, one a test in the order of FILE... -> its key and its help.
BESIDE = {
    "--profile": ("profile", "Profile across the track of a disc, or its topography. Needs --length."),
    "--volume-disc": ("volume_disc", "Worn volume of the disc, e.g. '0.02 +- 0.001 mm^3'."),
    "--volume-counter": ("volume_counter", "Worn volume of the ball."),
}


@click.command()
@click.argument("files", metavar="[FILE]...", nargs=-1, type=PATH)
@click.option("--radius", help="Radius of the track, e.g. '6 mm'.")
@click.option("--stroke", help="Length of one stroke, where there is no position.")
@click.option("--speed", help="Sliding speed, where there is a time alone.")
@click.option("--load", help="Normal load, where it is not recorded.")
@click.option("--columns", metavar="NAMES", help="Which columns of the records to take.")
@together(*(repeated(option, "X", f"{text} One a FILE.", name) for option, (name, text) in BESIDE.items()))
@click.option("--length", help="--profile: length of the whole track.")
@repeated("--than", "FILE", "A test of another pair, or a list of them: the difference to it.", type=PATH)
@repeated("--at", "KEY=VALUE", "Condition of the next test, e.g. 'load=10 N': a trend is taken over it.")
@click.option("--wanted", type=float, default=0.05, show_default=True, help="Error, as a part of the mean.")
@with_preparation()
@click.option("--out", type=PATH, help="Folder for page, table and figure. [default: repeats]")
@FORMAT
@click.option("--overwrite", is_flag=True, help="Replace the repeats that the folder holds.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out.")
def repeats(files: tuple[Path, ...], **options: Any) -> None:
    """Bring several tests of one pair into one answer: mean, scatter, and where the next test will lie.

    A FILE is a tribometer's record, one a test, or a TOML file with tables [[test]]: record, profile, scar,
    volume and conditions of each. Prints the sentence for a paper; level, incubation, jump, overshoot
    and wear coefficients with their scatter and the next test's interval; and which test the others
    foretell the worst.

    \b
    warpwear repeats test-1.csv test-2.csv test-3.csv --radius "6 mm"
    """
    preparation, as_json = prepared(options), options.pop("as_json")
    how = {"file_format": options.pop("file_format"), "overwrite": options.pop("overwrite")}
    out, length = options.pop("out"), options.pop("length")
    tests: list[Any] = [*files]
    for option, (name, _) in BESIDE.items():
        values = options.pop(name)
        tests = tests or [{} for _ in values]
        if values and len(values) != len(tests):
            raise InputError(f"{option} is given {len(values)} times, FILE {len(tests)} times: one a FILE")
        if values:
            tests = [test if isinstance(test, dict) else {"record": test} for test in tests]
            tests = [
                {**test, name: value, "length": length} for test, value in zip(tests, values, strict=True)
            ]
    if not tests:
        raise InputError(f"what was measured is missing: FILE, or one of {', '.join(BESIDE)}")
    folder, end = out or (None if as_json else Path("repeats")), ""
    if out is None and folder is not None and folder.exists() and not how["overwrite"]:
        folder, end = None, f"\n{folder} is there already and was not written again: --overwrite replaces it"
    if folder is not None:
        repeated_tests.check_out(folder, **how)
    at = dict(text.partition("=")[::2] for text in options.pop("at"))
    report = repeated_tests.repeats(tests, at=at, preparation=preparation, **options)
    if folder is not None:
        report.write(folder, **how)
        names = repeated_tests.PAGE, repeated_tests.TABLE, repeated_tests.MARK
        end = f"\nwritten to {folder}/: {', '.join(names)}, figure"
    click.echo(written.to_json(report.numbers) if as_json else f"{report}{end}")
