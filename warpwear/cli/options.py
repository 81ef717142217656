"""Arguments and options that several commands have."""

from pathlib import Path

import click

PATH = click.Path(path_type=Path)
FOLDER = click.argument("folder", metavar="DIR", type=PATH)
AS_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
DEVICE = click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
FORMAT = click.option("--format", "file_format", default="png", show_default=True, help="png, pdf or svg.")
THREADS = click.option(
    "--threads", type=int, help="Threads of the CPU; changes no result. [default: all cores]"
)
