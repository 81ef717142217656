"""What is to be said about runs and measured courses that are laid over each other."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from warpwear.comparison.groups import MOST_NAMES, RunData, differences, listed, told
from warpwear.ensembles.ensemble import Group
from warpwear.measured.course import check_coverage
from warpwear.measured.experiment import Experiment
from warpwear.measured.motion import UNITS, Motion
from warpwear.measured.tribometer import OTHER_STROKE

INTERRUPTED = "interrupted before the end."
NO_COF = "no coefficient of friction: its end calibrates it."
NO_SNAPSHOT = "no snapshot, so no profile."
NO_FIELD = "no whole field, so no profile."

#: Keys of what makes runs unlike tests begin so: not those of a disc's place and seed, nor of numerics.
CONDITIONS = (
    *("study.model", "contact.", "patches.", "sliding.", "fretting.", "block", "wear.", "friction."),
    *("counter.", "disc.layers", "disc.gradient"),
)


def notes_of(groups: Sequence[Group[RunData]], experiments: Sequence[Experiment]) -> Iterator[str]:
    """Say in which way runs are unlike, what misleads of each, what is an input, and what is missing."""
    runs = [run for group in groups for run in group.rows]
    for experiment in experiments:
        yield from (f"{experiment.name}: {warning}" for warning in experiment.warnings)
    yield from _differences(groups)
    yield from told([(run, INTERRUPTED) for run in runs if not run.summary.finished], len(runs))
    yield from told([(run, text) for run in runs for text in run.summary.warnings], len(runs))
    ways = {"end": "calibrate = 'end'", "coulomb": "law = 'coulomb'", "states": "law = 'states'"}
    for way, key in ways.items():
        if inputs := [r.name for r in runs if r.study.friction.fitted == way and "cof" in r.courses]:
            yield (
                f"The coefficient of friction {'at the end ' * (way == 'end')}of "
                f"{listed(inputs, len(runs))} is an input (friction.{key}): compare the shear strengths, or "
                "run all with one friction.shear_strength."
            )
    yield from told([(run, NO_COF) for run in runs if "cof" not in run.courses], len(runs))
    bare = (run for run in runs if "profile_disc" not in run.courses)
    missing = [(run, NO_FIELD if run.study.samples_area else NO_SNAPSHOT) for run in bare]
    yield from told(missing, len(runs))
    for e in experiments:
        yield from (f"{e.name}: {note}" for note in (*e.notes, *_lengths(e, runs), *_gaps(e, runs)))


def other_motion(given: Motion, of_runs: Motion) -> Iterator[str]:
    """Say in what the motion that is given of an experiment differs from the runs'."""
    for what, runs in vars(replace(of_runs, speed=of_runs.run_speed, run_speed=None)).items():
        mine, unit = getattr(given, what), UNITS.get(what)
        if mine and runs and np.size(mine) == 1 and not np.allclose(mine, runs, rtol=OTHER_STROKE):
            yield f"Warning: {what} {np.mean(mine):g} {unit} is given, the run has {runs:g} {unit}."


def _lengths(experiment: Experiment, runs: Sequence[RunData]) -> list[str]:
    """Say whether it is far shorter or longer than every run, as in a wrong unit."""
    whole, totals = float(experiment.distance[-1]), [run.summary.distance for run in runs]
    if not totals or any(0.5 * total <= whole <= 2.0 * total for total in totals):
        return []
    lengths = ", ".join(dict.fromkeys(f"{total:.4g}" for total in totals))
    text = f"the {'run' if len(runs) == 1 else 'runs'} {lengths} mm"
    if experiment.cycles is not None:  # the whole is not known: a point stands for a cycle
        return [f"The middle of its last cycle is at {whole:.4g} mm, {text} long."]
    return [f"It is {whole:.4g} mm long, {text}."]


def _gaps(experiment: Experiment, runs: Sequence[RunData]) -> list[str]:
    """Say what is to be said of its gaps, over the distance that it shares with any run."""
    known = [run.courses["cof"][0] for run in runs if "cof" in run.courses]
    start = max(min((float(d[0]) for d in known), default=0.0), float(experiment.distance[0]))
    end = min(max((float(d[-1]) for d in known), default=0.0), float(experiment.distance[-1]))
    return check_coverage(experiment, start, end) if end > start else []


def _differences(groups: Sequence[Group[RunData]]) -> Iterator[str]:
    """Say in which conditions groups differ: they are then unlike tests."""
    unlike = []
    for key, every in differences(groups).items():
        used = [", ".join(value for value in values if value != "–") for values in every]
        texts = {group.name: text for group, text in zip(groups, used, strict=True) if text}
        if key.startswith(CONDITIONS) and len(set(texts.values())) > 1:
            named = [f"{name} {text}" for name, text in texts.items()]
            each_once = named if len(named) <= MOST_NAMES else list(dict.fromkeys(texts.values()))
            unlike.append(f"{key} ({', '.join(each_once)})")
    if unlike:
        yield f"Unlike tests: the runs differ in {', '.join(unlike)}."
