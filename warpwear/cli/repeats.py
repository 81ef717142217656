"""Declare the command `warpwear repeats`."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import FORMAT, IN_TESTS, PATH, READING, place_for, repeated, together
from warpwear.cli.places import repeated_tests, written
from warpwear.cli.surface import prepared, with_preparation


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, type=PATH)
@together(*IN_TESTS.values())
@click.option("--ball-radius", help="--scar, --ball: of the unworn ball, e.g. '3 mm'.")
@click.option("--track-length", help="--profile, --section: of the whole track. [default: 2 pi --radius]")
@click.option("--distance", help="Sliding distance, where there is no record.")
@click.option("--radius", help="Radius of the track, e.g. '6 mm'.")
@READING
@repeated(
    "--than", "FILE", "A test of another pair, or a list of tests, to tell the difference to.", type=PATH
)
@repeated("--at", "KEY=VALUE", "Condition of the next test, e.g. 'load=10 N': a trend is taken over it.")
@click.option(
    "--wanted",
    type=float,
    default=0.05,
    show_default=True,
    help="Error of the mean, as a part of it, for which tests still needed are counted.",
)
@with_preparation()
@click.option("--out", type=PATH, help="Folder for page, table and figure. [default: repeats]")
@FORMAT
@click.option("--overwrite", is_flag=True, help="Replace the repeats that the folder holds.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out.")
def repeats(files: tuple[Path, ...], **options: Any) -> None:
    """Bring several tests of one pair into one answer: mean, scatter, and where the next test will lie.

    A FILE is a tribometer's record, one a test, or a TOML file with tables [[test]]: record, profile, scar,
    volume and conditions of each. Scars, profiles and volumes may be given here, too, in the order of the
    tests. Prints the sentence for a paper; level, incubation, jump, overshoot
    and wear coefficients with their scatter and the next test's interval; and which test the others
    predict worst.

    \b
    warpwear repeats test-1.csv test-2.csv --profile track-1.txt --profile track-2.txt --radius "6 mm"
    """
    tests: Any = files
    measured = {key: options.pop(key) for key in IN_TESTS}
    sizes = {key: options.pop(key) for key in ("track_length", "distance")}
    sizes["radius"] = options.pop("ball_radius")
    if any(measured.values()) or any(sizes.values()):
        tests = repeated_tests.in_order(sizes, record=files, **measured)
    preparation, as_json = prepared(options), options.pop("as_json")
    how = {"file_format": options.pop("file_format"), "overwrite": options.pop("overwrite")}
    default = None if as_json else Path("repeats")
    folder, end = place_for(options.pop("out"), default, overwrite=how["overwrite"])
    if folder is not None:
        repeated_tests.RepeatedTests.check_out(folder, **how)
    at = dict(text.partition("=")[::2] for text in options.pop("at"))
    report = repeated_tests.repeats(tests, at=at, preparation=preparation, **options)
    if folder is not None:
        report.write(folder, **how)
        end = f"written to {folder}/: repeats.html, repeats.csv, repeats.json, figure"
    click.echo(written.to_json(report.numbers) if as_json else "\n".join(filter(None, [str(report), end])))
