"""The commands `warpwear studies`, `show` and `materials`, and how a command reads its study."""

import tomllib
from collections.abc import Callable
from typing import Any

import click

from warpwear.cli.places import heavy
from warpwear.errors import InputError

STUDY = "STUDY is a TOML file, a run folder or the name of a preset (see 'warpwear studies')."


def with_changes(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --set to a command."""
    return click.option(
        "--set",
        "changes",
        metavar="KEY=VALUE",
        multiple=True,
        help="Change a key of the study by its dotted name, e.g. --set grid.cell='2 um'. Repeatable.",
    )(command)


@click.command()
def studies() -> None:
    """List the presets, studies with a name."""
    presets = heavy("presets")
    Study = heavy("Study")

    for name in presets():
        click.echo(f"{name:<10} {Study.load(name).study.description}")


@click.command(epilog=STUDY)
@click.argument("study")
@with_changes
def show(study: str, changes: tuple[str, ...]) -> None:
    """Print the whole STUDY after defaults.

    Each assumed value is marked. What is printed is itself a study; notes on keys that do not apply go to
    standard error.
    """
    to_marked_toml = heavy("to_marked_toml")

    loaded = load_study(study, changes)
    click.echo(to_marked_toml(loaded))
    for notice in loaded.notices():
        click.echo(f"note: {notice}", err=True)


@click.command("materials")
def list_materials() -> None:
    """List the known materials.

    Each has elastic constants and a hardness, and each value its source.
    """
    material = heavy("material")
    names = heavy("names")

    for name in names():
        known = material(name)
        click.echo(
            f"{known.name}, {known.condition}: E {1e-3 * known.young:g} GPa, ν {known.poisson:g}, "
            f"hardness {1e-3 * known.hardness:.3g} GPa"
        )
        for value, source in known.sources.items():
            click.echo(f"    {value}: {source}")


def load_study(study: str, changes: tuple[str, ...]) -> Any:
    """Return the Study of a file, folder or preset, changed by texts KEY=VALUE. InputError for bad ones."""
    Study = heavy("Study")

    parsed = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals:
            raise InputError(f"--set {change!r}: KEY=VALUE is expected, such as grid.cell='2 um'.")
        parsed[key.strip()] = _value(value.strip())
    return Study.load(study).replace(parsed)


def _value(text: str) -> Any:
    """Read a value as TOML does; anything else is text, so that quotes may be left to the shell."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML, a number of thousands of digits, endless nesting
        return text
