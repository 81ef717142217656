"""Arguments and options that several commands have."""

from collections.abc import Callable
from functools import reduce
from pathlib import Path
from typing import Any

import click

Option = Callable[[Any], Any]

PATH = click.Path(path_type=Path)


def repeated(name: str, metavar: str, text: str, *parameter: str, default: str = "", **others: Any) -> Option:
    """Make an option that may be given several times. parameter: its name in Python, another than its own."""
    text = f"{text} Repeatable." + (f" [default: {default}]" if default else "")
    return click.option(name, *parameter, metavar=metavar, multiple=True, help=text, **others)


def together(*options: Option) -> Option:
    """Make one decorator of several options, which `--help` lists in their order."""
    return lambda command: reduce(lambda inner, option: option(inner), reversed(options), command)


def place_for(out: Path | None, default: Path | None, *, overwrite: bool) -> tuple[Path | None, str]:
    """Choose where a report goes: `out`, or the default; nowhere, and why, where the default is there."""
    if out or overwrite or default is None or not default.exists():
        return out or default, ""
    return None, f"{default} is there already and was not written again: --overwrite replaces it"


#: How records are read.
READING = together(
    click.option("--stroke", help="Length of one stroke, where there is no position."),
    click.option("--speed", help="Sliding speed, where there is a time alone."),
    click.option("--load", help="Normal load, where it is not recorded."),
    click.option("--columns", metavar="NAMES", help="'DISTANCE,COF', 'TIME,FX,FZ' or 'TIME,FX,FZ,POSITION'."),
)
_TEXTS = {
    "volume_counter": "Worn volume of the ball, e.g. '0.0072 +- 0.0008 mm^3'.",
    "volume_disc": "Worn volume of the disc.",
    "section": "Mean cross-section of the groove, e.g. '812 +- 30 um^2'.",
    "scar": "Diameter of the scar, mean of two diagonals, e.g. '0.80 +- 0.02 mm'.",
    "sq_counter": "Sq in the scar of the ball, form removed, e.g. '0.55 +- 0.03 um'.",
    "sq_disc": "Sq in the scar of the disc.",
}
#: Key of a test -> the option of its measured value.
MEASURED = {k: repeated(f"--{k.replace('_', '-')}", "X+-U", text) for k, text in _TEXTS.items()}
MEASURED["friction"] = repeated(
    "--cof", "X+-U", "Coefficient of friction, e.g. '0.2 +- 0.02 at 30 mm'.", "friction", default="at the end"
)
#: The same for what is measured in tests beside their records, in the order of the tests.
IN_TESTS = {
    "profile": repeated("--profile", "FILE", "Profile across a test's track, or topography.", type=PATH),
    "ball": repeated("--ball", "FILE", "Topography of a test's worn ball.", type=PATH),
} | {key: MEASURED[key] for key in ("volume_counter", "volume_disc", "section", "scar")}
FOLDER = click.argument("folder", metavar="DIR", type=PATH)
DETAILS = click.option("--details", is_flag=True, help="Print all lines, not the ten that say most.")
AS_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
DEVICE = click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
FORMAT = click.option("--format", "file_format", default="png", show_default=True, help="png, pdf or svg.")
EXPERIMENTS = repeated(
    "--experiment",
    "FILE",
    "A tribometer's record of friction, or a folder of its files.",
    "experiments",
    type=PATH,
)
BAND_OVER = repeated(
    "--band-over", "KEY", "Key whose scatter a band shows: runs that differ in it alone are one line."
)
COLUMNS = click.option("--columns", metavar="NAMES", help="--experiment: which of its columns to take.")
THREADS = click.option(
    "--threads", type=int, help="Threads of the CPU; changes no result. [default: all cores]"
)
