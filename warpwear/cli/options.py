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


#: What was measured in tests beside their records, by the keys of [[test]].
IN_TESTS = {
    "profile": repeated("--profile", "FILE", "Profile across a test's track, or topography.", type=PATH),
    "ball": repeated("--ball", "FILE", "Topography of a test's worn ball.", type=PATH),
    "scar": repeated("--scar", "D", "Diameter of a test's scar on the ball, e.g. '0.80 +- 0.02 mm'."),
    "section": repeated("--section", "A", "Cross-section of a test's groove, e.g. '812 +- 30 um^2'."),
    "volume_counter": repeated("--volume-counter", "V", "Worn volume of a test's ball, e.g. '0.01 mm^3'."),
    "volume_disc": repeated("--volume-disc", "V", "Worn volume of a test's disc."),
}
WITH_TESTS = together(*IN_TESTS.values())
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
