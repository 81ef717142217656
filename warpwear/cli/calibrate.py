"""The command group `warpwear calibrate`: wear, shear strength, energy, unknowns of a study from a test."""

from pathlib import Path
from typing import Any

import click

from warpwear.cli import places
from warpwear.cli.options import AS_JSON, COLUMNS, DEVICE, EXPERIMENTS, MEASURED, PATH, repeated, together
from warpwear.cli.study import CHANGES, STUDY, parsed_changes
from warpwear.cli.surface import prepared, with_preparation

LOAD = click.option("--load", metavar="F", help="Normal load, e.g. '8 N'.")
DISTANCE = click.option("--distance", metavar="L", help="Total sliding distance, e.g. '2400 mm'.")
TESTS = click.argument("tests", metavar="[FILE]", type=PATH, required=False)
RESULT = click.option("--result", metavar="DIR", type=PATH, help="Run folder of `warpwear run`.")

#: The form of a track is that of the unworn part.
LEVEL = "--track: none, plane or a degree, taken off beside it. [default: plane]"
UNCERTAINTY = "Standard uncertainty of diameter, width, section or volume. [default: of --diagonals]"
#: Test methods of ASTM, and which body was measured.
METHODS = ("g99-ball", "g99-disc", "g133-ball", "g133-flat")
#: Sources of a worn volume, one value a test.
SOURCES = together(
    repeated("--volume", "V", "A worn volume, e.g. '0.018 mm^3' or '0.018 +- 0.001 mm^3'."),
    repeated("--scar", "D", "Diameter of a flat scar on a ball. Needs --radius."),
    repeated("--width", "D", "Width of a circular track. Needs --radius and --track-radius."),
    repeated(
        "--section",
        "A",
        "Cross-section of a groove, '812.8 um^2'. Needs --track-length or --track-radius.",
    ),
    repeated(
        "--track",
        "FILE",
        "Topography of a worn track, or profile. Needs --track-length or --track-radius.",
        type=PATH,
    ),
    repeated("--after", "FILE", "Topography of a disc's scar. Needs --before.", type=PATH),
    repeated("--before", "FILE", "--track, --after: the same place before the test, one a test.", type=PATH),
    repeated("--ball", "FILE", "Topography of a worn ball, with or without --radius.", type=PATH),
    with_preparation(level=LEVEL),
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def calibrate() -> None:
    """Find wear coefficients, shear strengths and other numbers of a study from measurements."""


@calibrate.command()
@click.argument("file", type=PATH, required=False)
@SOURCES
@repeated(
    "--diagonals", "A B", "Two diameters of a ball's patch: '0.8 mm' '0.82 mm'. Needs --radius.", nargs=2
)
@click.option("--radius", metavar="R", help="Radius of the ball, e.g. '3 mm'.")
@click.option("--diameter", metavar="D", help="Diameter of the ball, e.g. '6 mm', instead of --radius.")
@click.option("--track-radius", metavar="R", help="Radius of the circle that the track runs on.")
@click.option("--track-width", metavar="W", help="--track: width with its pile-up, when it is not found.")
@click.option(
    "--track-length", metavar="L", help="Length of the whole track, e.g. '30 mm'. [default: --stroke]"
)
@click.option("--uncertainty", metavar="U", help=UNCERTAINTY)
@click.option(
    "--source", metavar="KEY", help="FILE: which of several measurements to take; 'coat' for two K."
)
@click.option("--figure", metavar="PNG", type=PATH, help="--source coat: draw the craters and both K.")
@click.option("--standard", type=click.Choice(METHODS), help="By this ASTM test method.")
@LOAD
@DISTANCE
@click.option("--passes", type=int, help="Number of single strokes, instead of --distance.")
@click.option("--stroke", metavar="L", help="Length of one stroke, e.g. '30 mm'.")
@click.option("--hardness", metavar="H", help="For the dimensionless coefficient, e.g. '590 MPa'.")
@AS_JSON
def wear(file: Path | None, **options: Any) -> None:
    """Find the wear coefficient K = V/(F L) of a worn body, from one kind of measurement.

    Repeat the measurement's option for repeated tests of one load and distance: mean, standard deviation and
    standard error are given. Or list the tests in FILE, a TOML file with tables [[test]], each with its own
    load and distance. With --source coat they are craters through a coat, and give its K and the
    substrate's.

    \b
    warpwear calibrate wear --diagonals "0.80 mm" "0.82 mm" --radius "3 mm" \\
        --load "8 N" --distance "2400 mm"
    """
    click.echo(places.calibrations.wear(file, prepared(options), **options))


@calibrate.command()
@TESTS
@RESULT
@click.option("--cof", type=float, help="Measured coefficient of friction that fixes τ0.")
@click.option("--ploughing", type=float, help="Part of it that does not shear, μ_p. [default: 0]")
@click.option("--area", metavar="A", help="With --load '1.254 mm^2'; with --result a name such as contact.")
@LOAD
@click.option(
    "--experiment",
    "experiments",
    metavar="FILE",
    type=PATH,
    multiple=True,
    help="A course: fits τ0 and μ_p with areas of --result. Repeatable.",
)
@COLUMNS
@click.option("--stroke", metavar="L", help="--experiment: length of one pass, where it counts cycles.")
@click.option("--speed", metavar="V", help="--experiment: sliding speed, where it has time and no distance.")
@click.option(
    "--law",
    type=click.Choice(("shear-strength", "states")),
    default="shear-strength",
    help="states: film, bare metal and cover of courses that jump, of all --experiment at once.",
)
@click.option("--radius", metavar="R", help="--law states: of the track, where no column counts laps.")
@click.option("--until", metavar="L", help="--law states: fit so far. [default: thrice the jump's end]")
@AS_JSON
def friction(**options: Any) -> None:
    """Find the shear strength τ0 of μ = μ_p + τ0 A/F, from a measured coefficient or curve.

    By --law states it is the constants of [friction.states] instead, which need no run.

    The areas of a run are contact, touched, cumulative and nominal; a fit uses the run's friction.area unless
    told otherwise. FILE is a TOML file with tables [[test]] instead: friction, or record, with load and area.
    """
    click.echo(places.calibrations.friction(**options))


@calibrate.command()
@TESTS
@RESULT
@LOAD
@DISTANCE
@click.option("--cof", type=float, help="Constant coefficient of friction, without --result.")
@click.option("--area", metavar="A", help="Area of the mean pressure of PV, without --result.")
@repeated("--speed", "V", "e.g. '20 mm/min'.", "speeds", default="10, 20, 50, 100 mm/min")
@AS_JSON
def energy(**options: Any) -> None:
    """Find the dissipated energy ∫ μ F dL, and time, frictional power and PV at several speeds.

    FILE is a TOML file with tables [[test]] instead: friction with load and distance.
    """
    click.echo(places.calibrations.printed(places.energy_of_test.calibrate_energy, **options))


@calibrate.command()
@click.argument("tests", metavar="FILE", type=PATH)
@click.option("--study", metavar="STUDY", help="Study with load and bodies, whose contact yields too.")
@LOAD
@AS_JSON
def loop(**options: Any) -> None:
    """Find μ, the slip and the rig's compliance from a cycle of fretting: FILE has two columns.

    They are called displacement and friction force, with their units.

    Or it is a TOML file with tables [[test]], each with such a file, loop, and its load.

    The slip is the width at no force, less what the contact yields, which a study tells. Rig and contact
    yield behind the tips.
    """
    click.echo(places.calibrations.printed(places.loop_of_test.calibrate_loop, **options))


@calibrate.command(epilog=STUDY)
@click.argument("study")
@CHANGES
@repeated("--unknown", "KEY[=PRIOR]", "Key, prior as in a sweep.", default="a factor of 5 about its value")
@EXPERIMENTS
@COLUMNS
@together(*MEASURED.values())
@click.option("--target", metavar="KEY", help="Unknown that the next test shall tell; ranks tests.")
@repeated("--next", "TEST", "A test to rank, e.g. 'contact.load=16 N, repeats=3'.", "candidates")
@click.option("--out", type=PATH, help="Folder of report, calibrated study and runs.")
@click.option(
    "--runs",
    type=int,
    help="Runs of the design. [default: 8 an unknown, 16 at least; double on made-up surfaces]",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of all draws.")
@click.option("--dry-run", is_flag=True, help="Say from the first run what all will cost, and stop.")
@DEVICE
@AS_JSON
def bayes(study: str, changes: tuple[str, ...], **options: Any) -> None:
    """Unknowns of STUDY from a test, with uncertainty, and which test to make next.

    \b
    warpwear calibrate bayes v1 --set stepping.scheme=implicit --unknown wear.counter --unknown wear.disc \\
        --unknown friction.shear_strength --experiment test.csv \\
        --scar "1.28 +- 0.03 mm" --volume-disc "0.0244 +- 0.002 mm^3" --target wear.counter --out found

    \b
    inference.html    the unknowns, what cannot be told apart, figures, the next test
    calibrated.toml   the study with the values found, ready for 'warpwear sweep'; fitted.toml
                      where it misses the data
    posterior.csv     samples of the unknowns

    A value measured in repeated tests is given repeatedly. What was measured may stand in STUDY too, in
    tables [[test]], and unknowns and tests to rank in its section [infer].
    """
    measured = {name: options.pop(name) for name in MEASURED}
    changed = parsed_changes(changes)
    click.echo(places.inference_command.calibrate_bayes(study, changed, measured=measured, **options))
