"""Run the command line. Exit status 0, 2 for bad input with one plain sentence, 130 when interrupted."""

import codecs
import gc
import io
import os
import sys
import time
from contextlib import suppress
from typing import TextIO

import click

from warpwear.cli.calibrate import calibrate
from warpwear.cli.compare import compare
from warpwear.cli.joint import contact, joint
from warpwear.cli.new import new
from warpwear.cli.record import record
from warpwear.cli.repeats import repeats
from warpwear.cli.result import animate, export_command, plot, report
from warpwear.cli.run import run
from warpwear.cli.study import list_materials, show, studies
from warpwear.cli.surface import surface
from warpwear.cli.sweep import sweep
from warpwear.errors import ConvergenceError, InputError
from warpwear.version import __version__

#: Objects made before unreachable ones are looked for: a run makes many, and nearly all of them last.
GARBAGE = 50_000
#: How long a thread keeps Python's lock from another [s]: steps wait for those that pack snapshots.
SWITCH = 2.0e-4


def main(arguments: list[str] | None = None) -> None:
    """Run a command, of the command line where no arguments are given; errors end as sentence and status."""
    # Of a command line the time since its process began, which no clock tells so simply as what it has used.
    started = time.perf_counter() - (time.process_time() if arguments is None else 0.0)
    os.environ["MPLBACKEND"] = "agg"  # nothing is shown, and a backend that is not there would stop it
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # that no installed package is asked for one
    _replace_closed_streams()
    if arguments is None:  # a process of its own
        gc.set_threshold(GARBAGE)
        sys.setswitchinterval(SWITCH)
    codecs.register_error("warpwear", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="warpwear")
    try:
        status = commands.main(arguments, prog_name="warpwear", standalone_mode=False, obj=started)
        sys.stdout.flush()
    except (InputError, ConvergenceError) as error:
        _fail(getattr(error, "sentence", str(error)), at_once=isinstance(error.__cause__, MemoryError))
    except MemoryError:
        hint = "larger cells (grid.cell) or a smaller grid.extent are needed."
        _fail(f"the memory ran out; {hint}", at_once=True)
    except click.ClickException as error:
        _fail(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        click.echo("warpwear: interrupted.", err=True)
        sys.exit(130)
    except BrokenPipeError:  # the reader of a pipe has left
        _silence(sys.stdout)
        sys.exit(0)
    except OSError as error:
        if error.filename is None:  # what was printed so far could not be
            _silence(sys.stdout)
        what = "standard output" if error.filename is None else str(error.filename)
        _fail(str(InputError(f"{what} cannot be read or written: {error.strerror or error}")))
    finally:
        if arguments is None:  # what is left goes with the process, and need not be looked through
            gc.freeze()
    sys.exit(status if isinstance(status, int) else 0)


def _replace_closed_streams() -> None:
    """Lead standard streams that are closed nowhere: a file would get their number, and what is printed."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


def _fail(message: str, *, at_once: bool = False) -> None:
    """Say what is wrong and end with status 2.

    at_once: without the interpreter's own end, in which HDF5 may crash after the memory ran out.
    """
    try:
        click.echo(f"warpwear: {message}", err=True)
    except OSError:  # nor can this be told
        _silence(sys.stderr)
    if at_once:
        with suppress(OSError):
            sys.stdout.flush()
        os._exit(2)
    sys.exit(2)


def _silence(stream: TextIO) -> None:
    """Lead what a stream still holds nowhere: at the interpreter's end it would fail once more."""
    with suppress(OSError, ValueError), open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


def _spelled(error: UnicodeError) -> tuple[str, int]:
    """Write signs that the terminal's encoding lacks as JSON and Python do: \\u03bd."""
    assert isinstance(error, UnicodeEncodeError)
    units = error.object[error.start : error.end].encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[i : i + 4]}" for i in range(0, len(units), 4)), error.end


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="%(prog)s %(version)s")
def commands() -> None:
    """Compute contact, wear and friction of rough surfaces on fine meshes.

    \b
    warpwear studies             which studies are there to begin with
    warpwear run track           a ball that slides over a rough track, in half a minute
    warpwear new my-test.toml    a study of your own rig, to be filled in
    warpwear run my-test.toml    run it

    A run is written into a folder, which plot, animate, export and compare take. Bad input ends with one
    sentence and exit status 2; an interrupted run leaves a checkpoint and ends with 130; a sweep of which
    runs failed ends with 1.
    """


_OF_RUNS = (run, new, studies, show, plot, animate, export_command, list_materials)
for command in (*_OF_RUNS, surface, contact, joint, record, repeats, compare, sweep, calibrate, report):
    commands.add_command(command)
