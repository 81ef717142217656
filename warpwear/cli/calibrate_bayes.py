"""The command `warpwear calibrate bayes`: unknowns of a study from a test, with their uncertainty."""

from typing import Any

import click

from warpwear.cli.options import AS_JSON, COLUMNS, DEVICE, EXPERIMENTS, PATH, repeated, together
from warpwear.cli.places import inference_command
from warpwear.cli.study import CHANGES, STUDY, parsed_changes

#: Option of a measured value -> its name in the inference, and its help.
MEASURED = {
    "--volume-counter": ("volume_counter", "Worn volume of the ball, e.g. '0.0072 +- 0.0008 mm^3'."),
    "--volume-disc": ("volume_disc", "Worn volume of the disc."),
    "--section": ("section", "Mean cross-section of the groove, e.g. '812 +- 30 um^2'."),
    "--diameter": ("diameter", "Diameter of the scar, mean of two diagonals, e.g. '0.80 +- 0.02 mm'."),
    "--sq-counter": ("sq_counter", "Sq in the scar of the ball, form removed, e.g. '0.55 +- 0.03 um'."),
    "--sq-disc": ("sq_disc", "Sq in the scar of the disc."),
    "--cof": ("cof", "Coefficient of friction, e.g. '0.2 +- 0.02 at 30 mm'. [default: at the end]"),
}

#: Old names of such options.
FORMER = ("--volume-sphere", "--sq-sphere")


@click.command(epilog=STUDY)
@click.argument("study")
@CHANGES
@repeated("--unknown", "KEY[=PRIOR]", "Key, prior as in a sweep.", default="a factor of 5 about its value")
@EXPERIMENTS
@COLUMNS
@together(*(repeated(option, "X+-U", text, name) for option, (name, text) in MEASURED.items()))
@together(*(click.option(name, multiple=True, hidden=True) for name in FORMER))
@click.option("--target", metavar="KEY", help="Unknown that the next test shall tell; ranks tests.")
@repeated("--next", "TEST", "A test to rank, e.g. 'contact.load=16 N, repeats=3'.", "candidates")
@click.option("--out", type=PATH, help="Folder of report, calibrated study and runs.")
@click.option("--runs", type=int, help="Runs of the design. [default: 8 an unknown, 16 at least]")
@click.option("--seed", type=int, default=0, show_default=True, help="Of all draws.")
@DEVICE
@AS_JSON
def bayes(study: str, changes: tuple[str, ...], **options: Any) -> None:
    """Unknowns of STUDY from a test, with uncertainty, and which test to make next.

    \b
    warpwear calibrate bayes v1 --set stepping.scheme=implicit --unknown wear.counter --unknown wear.disc \\
        --unknown friction.shear_strength --experiment test.csv \\
        --diameter "1.28 +- 0.03 mm" --volume-disc "0.0244 +- 0.002 mm^3" --target wear.counter --out found

    \b
    inference.html    the unknowns, what cannot be told apart, figures, the next test
    calibrated.toml   the study with the values found, ready for 'warpwear sweep'; fitted.toml
                      where it misses the data
    posterior.csv     samples of the unknowns

    A value measured in repeated tests is given repeatedly. Unknowns, measurements and tests may stand in the
    study's own section [infer] too.
    """
    measured = {name: options.pop(name) for name, _ in MEASURED.values()}
    for former in FORMER:
        if values := options.pop(former[2:].replace("-", "_")):
            measured[former[2:].replace("-", "_")] = values
            now = former.replace("sphere", "counter")
            click.echo(f"{former} has a new name, and the next release refuses the old one: {now}.", err=True)
    changed = parsed_changes(changes)
    click.echo(inference_command.calibrate_bayes(study, changed, measured=measured, **options))
