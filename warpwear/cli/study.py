"""The commands `warpwear studies`, `show` and `materials`, and how a command reads its study."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli.options import repeated
from warpwear.cli.places import known, results, study_files, study_types
from warpwear.errors import InputError

STUDY = "STUDY is a TOML file, a run folder or the name of a preset (see 'warpwear studies')."


CHANGES = repeated(
    "--set", "KEY=VALUE", "Change a key of the study, by its name with dots: grid.cell='2 um'.", "changes"
)


@click.command()
def studies() -> None:
    """List the presets, studies with a name."""
    click.echo(known.studies())


@click.command(epilog=STUDY)
@click.argument("study")
@CHANGES
def show(study: str, changes: tuple[str, ...]) -> None:
    """Print the whole STUDY after defaults.

    Each assumed value is marked. What is printed is itself a study; notes on keys that do not apply go to
    standard error.
    """
    loaded = load_study(study, changes)
    click.echo(loaded.to_toml(marked=True))
    for notice in loaded.notices():
        click.echo(f"note: {notice}", err=True)


@click.command("materials")
def list_materials() -> None:
    """List the known materials.

    Each has elastic constants, a hardness and what it conducts, and each value its unit and source.
    """
    click.echo(known.materials())


def load_study(study: str, changes: tuple[str, ...]) -> Any:
    """Return the Study of a file, folder or preset, changed by texts KEY=VALUE. InputError for bad ones."""
    return study_types.Study.load(study).replace(parsed_changes(changes))


def parsed_changes(changes: tuple[str, ...]) -> dict[str, Any]:
    """Return changes of a study from texts KEY=VALUE. Raises InputError for bad ones.

    For a shear strength may stand the folder of a run, which found one.
    """
    parsed = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals:
            raise InputError(f"--set {change!r}: KEY=VALUE is expected, such as grid.cell='2 um'.")
        key, value = key.strip(), value.strip()
        if key == "friction.shear_strength" and Path(value).is_dir():
            with results.Result.open(Path(value)) as run:
                value = f"{run.summary['shear_strength_MPa']} MPa"
        parsed[key] = study_files.value_of_text(value)
    return parsed
