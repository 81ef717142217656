"""The command line. Exit status 0, 2 for bad input with one plain sentence, 130 when interrupted."""

import os
import sys

import click

from warpwear.cli.calibrate import calibrate
from warpwear.cli.compare import compare
from warpwear.cli.report import report
from warpwear.cli.result import animate, export_command, plot
from warpwear.cli.run import run
from warpwear.cli.study import list_materials, show, studies
from warpwear.cli.surface import surface
from warpwear.errors import ConvergenceError, InputError
from warpwear.version import __version__


def main(arguments: list[str] | None = None) -> None:
    """Entry point: turns errors for people into one sentence and an exit status."""
    try:
        status = commands.main(arguments, prog_name="warpwear", standalone_mode=False)
    except (InputError, ConvergenceError) as error:
        _fail(str(error), at_once=isinstance(error.__cause__, MemoryError))
    except MemoryError:
        _fail(
            "the memory ran out; larger cells (grid.cell) or a smaller grid.extent are needed.", at_once=True
        )
    except click.ClickException as error:
        _fail(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        click.echo("warpwear: interrupted.", err=True)
        sys.exit(130)
    except BrokenPipeError:  # the reader of a pipe has left
        sys.exit(0)
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: str, *, at_once: bool = False) -> None:
    """at_once: without the interpreter's own end, in which HDF5 may crash after the memory ran out."""
    click.echo(f"warpwear: {message}", err=True)
    if at_once:
        sys.stdout.flush()
        os._exit(2)
    sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="%(prog)s %(version)s")
def commands() -> None:
    """Contact, wear and friction of rough surfaces on fine meshes.

    \b
    warpwear run v3-fine            the main job: 1 µm cells, well under half a minute
    warpwear run my-disc.toml       the same for your own disc
    """


for command in (
    run,
    studies,
    show,
    plot,
    animate,
    export_command,
    list_materials,
    surface,
    compare,
    calibrate,
    report,
):
    commands.add_command(command)
