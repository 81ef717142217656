"""Declare the command `warpwear record`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import DETAILS, FORMAT, PATH, READING, place_for
from warpwear.cli.places import records, reports, written


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=PATH)
@click.option("--radius", help="Radius of the track, e.g. '6 mm'; of several steps '6 mm, 9 mm'.")
@READING
@click.option("--zero", is_flag=True, help="Take off the friction force that is shown without load.")
@click.option("--out", type=PATH, help="Folder for page, table and figures. [default: FILE's name + -record]")
@FORMAT
@click.option("--overwrite", is_flag=True, help="Replace the record that the folder holds.")
@DETAILS
@click.option("--json", "as_json", is_flag=True, help="Print JSON; a folder only with --out.")
def record(files: tuple[Path, ...], **options: Any) -> None:
    """Say what is in the record of a tribometer, as its machine wrote it, and draw it.

    FILE... is one record: a file, several that follow each other, or a folder of them: tables of text (.csv,
    .txt, .tsv, any encoding and decimal sign) or .xlsx; exports of Rtec, CETR or Bruker UMT, Phoenix
    (Compend), Anton Paar or CSM, PCS, Optimol SRV, Ducom, Nanovea, LabVIEW, Kyowa logger and ITeR T-11 are
    known by what they say. Prints and draws
    the coefficient of friction with its scatter, incubation, jump, overshoot, the steady value with its
    error, energy, friction loops, and what was left out. `compare`, `calibrate` and `bayes` read
    the same files.
    """
    click.echo(describe(files, **options))


def describe(files: Sequence[Path], **choices: Any) -> str:
    """Say what a record of friction holds, as text for people or as JSON, and write its folder.

    choices: options of the command; the folder is by default named after the file, and with as_json there is
    none. Raises InputError.
    """
    details = choices.pop("details", False)
    overwrite, as_json = choices.pop("overwrite", False), choices.pop("as_json", False)
    how = {"file_format": choices.pop("file_format", "png"), "overwrite": overwrite}
    first = files[0].resolve()
    default = None if as_json else Path(f"{first.name if first.is_dir() else first.stem}-record")
    folder, end = place_for(choices.pop("out", None), default, overwrite=overwrite)
    if folder is not None:
        records.FrictionRecord.check_out(folder, **how)
    report = records.read_record(files if len(files) > 1 else files[0], **choices)
    if folder is not None:
        report.write(folder, **how)
        end = f"written to {folder}/: {records.PAGE}, {records.TABLE}, {report.MARK}, figures"
    return written.to_json(report.numbers) if as_json else reports.closed(report.text, end, details=details)
