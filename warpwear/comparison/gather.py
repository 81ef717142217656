"""Runs and measured courses of friction side by side: what is read of them and how they differ."""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from warpwear.comparison.groups import (
    MOST_NAMES,
    Group,
    RunData,
    folders_of,
    grouped,
    is_sweep,
    listed,
    unlike,
)
from warpwear.comparison.scar import ScarComparison, ScarFiles, compare_scar
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.course import Experiment, check_coverage, read_experiment
from warpwear.measured.options import optional
from warpwear.result import Result
from warpwear.results.summary import course, shape_of_growth
from warpwear.results.track import groove, whole_steps
from warpwear.study.keys import declarations, inapplicable, value_of
from warpwear.study.study import Study

BODIES = ("sphere", "disc")
INTERRUPTED = "interrupted before the end."
NO_COF = "no coefficient of friction: its end calibrates it."
NO_SNAPSHOT = "no snapshot, so no profile."
NO_FIELD = "no whole field, so no profile."
#: Length along sliding over which profiles are averaged, as a part of the scar's.
STRIP = 0.125
#: Fewest points for the shape of a course.
FEWEST = 20
#: Parts that a measured course of many more points is averaged in.
PARTS = 200
#: A course that starts later than this part of its distance has no early slope.
LATEST_START = 1.0 / 60.0


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs in groups, experiments and what is to be said about them."""

    groups: tuple[Group, ...]
    experiments: tuple[Experiment, ...]
    notes: tuple[str, ...]
    scar: ScarComparison | None = None

    @property
    def runs(self) -> tuple[RunData, ...]:
        """The runs of all groups."""
        return tuple(run for group in self.groups for run in group.runs)

    def rms(self, run: RunData, experiment: Experiment) -> float | None:
        """Find how the coefficients of friction differ: root mean square over the distance that both have.

        A swept run has the means of its passes: within a pass it goes up and down with the place.
        """
        if run.cof is None:
            return None
        return rms_difference(*run.course, experiment.distance, experiment.cof)


def gather(
    folders: Sequence[str | Path],
    experiments: Sequence[str | Path] = (),
    *,
    band_over: Sequence[str] = (),
    speed: str | None = None,
    stroke: str | None = None,
    columns: str | None = None,
    scar: ScarFiles | None = None,
) -> Comparison:
    """Read what is to be compared: run folders and files of experiments, two or more together.

    folders: of runs, or of sweeps for all their runs. band_over: dotted keys; runs that differ in them alone
    are one group, with a mean and a band.
    speed, stroke: text with a unit, for experiments that give times or cycles; by default those of the runs,
    if they agree. columns: see `warpwear.measured.columns.choose`. scar:
    a measured one to lay over those of the runs. Raises InputError.
    """
    check_number(folders, experiments, scar)
    found, left_out = folders_of(folders)
    check_number(found, experiments, scar)
    for path, count in Counter(Path(p).resolve() for p in (*found, *experiments)).items():
        if count > 1:
            raise InputError(f"{path} is given {count} times; each run and experiment is expected once")
    runs = [_read_run(folder) for folder in found]
    read = [
        read_experiment(
            path,
            speed=optional("--speed", speed, "mm/s") or _common([r.study.sliding.mean_speed for r in runs]),
            stroke=optional("--stroke", stroke, "mm") or _common([r.study.sliding.stroke for r in runs]),
            load=_common([r.study.contact.load for r in runs]),
            columns=columns,
        )
        for path in experiments
    ]
    groups = grouped(runs, band_over)
    runs = [run for group in groups for run in group.runs]
    files = [Path(path) for path in experiments]
    stems = Counter(path.stem for path in files)
    labels = [path.name if stems[path.stem] > 1 else path.stem for path in files]
    named = unlike(labels, [group.name for group in groups], of=" (experiment)")
    measured = [replace(e, name=name) for name, e in zip(named, read, strict=True)]
    notes = left_out + [f"{e.name}: {warning}" for e in measured for warning in e.warnings]
    notes += _differences(groups)
    told = [(r.name, warning) for r in runs for warning in r.summary["warnings"]]
    notes += _together([(r.name, INTERRUPTED) for r in runs if not r.summary["finished"]], runs)
    notes += _together(told, runs)
    if inputs := [r.name for r in runs if r.study.friction.fitted == "end" and r.cof is not None]:
        notes.append(
            f"The CoF at the end of {listed(inputs, len(runs))} is an input (friction.calibrate = 'end'), "
            "not a result: compare the shear strengths, or run all with one friction.shear_strength."
        )
    notes += _together([(r.name, NO_COF) for r in runs if r.cof is None], runs)
    notes += _together(
        [(r.name, NO_FIELD if r.study.samples_area else NO_SNAPSHOT) for r in runs if not r.wear], runs
    )
    for e in measured:
        notes += [f"{e.name}: {note}" for note in (*e.notes, *_lengths(e, runs), *_gaps(e, runs))]
    beside = None if scar is None else compare_scar(scar, runs)
    return Comparison(tuple(groups), tuple(measured), tuple(notes), beside)


def _together(told: Sequence[tuple[str, str]], runs: Sequence[RunData]) -> list[str]:
    """Make one note of the runs of which the same is told. told: name of a run and what is told of it."""
    names: dict[str, list[str]] = {}
    for name, sentence in told:
        names.setdefault(sentence, []).append(name)
    return [f"{listed(of, len(runs))}: {sentence}" for sentence, of in names.items()]


def check_number(
    folders: Sequence[str | Path], experiments: Sequence[str | Path], scar: ScarFiles | None = None
) -> None:
    """Raise InputError for less than two together; a sweep stands for several runs."""
    sweeps = sum(is_sweep(Path(folder)) for folder in folders)
    if scar is not None and not folders:
        raise InputError("--scar needs the folder of a run to compare with")
    if len(folders) + sweeps + len(experiments) + (scar is not None) < 2:
        given = str([*folders, *experiments][0]) if folders or experiments else "nothing"
        raise InputError(
            f"compare needs two runs or more, or a run and an --experiment or a --scar; given: {given}"
        )


def rms_difference(
    distance: FloatArray, values: FloatArray, other_distance: FloatArray, other_values: FloatArray
) -> float | None:
    """Find how two courses differ: root mean square over the distances that both have, lines between points.

    None if they share no distance.
    """
    start = max(float(distance[0]), float(other_distance[0]))
    end = min(float(distance[-1]), float(other_distance[-1]))
    if end <= start:
        return None
    places = np.unique(np.concatenate([distance, other_distance, [start, end]]))
    places = places[(places >= start) & (places <= end)]
    gap = np.interp(places, distance, values) - np.interp(places, other_distance, other_values)
    # The integral of a squared straight line, exactly.
    parts = np.diff(places) * (gap[:-1] ** 2 + gap[:-1] * gap[1:] + gap[1:] ** 2) / 3.0
    return math.sqrt(float(parts.sum()) / (end - start))


def shape_of_run(run: RunData) -> dict[str, float]:
    """Find m and λ of the coefficient of friction of a run, see `summary.shape_of_growth`."""
    return {} if run.cof is None else _shape(*run.course)


def shape_of(experiment: Experiment) -> dict[str, float]:
    """Find m and λ of a measured course, see `summary.shape_of_growth`; without what it is too short for.

    A course of many points is averaged in 200 equal parts of its distance first: both are slopes, which noise
    would decide.
    """
    distance, cof = experiment.distance, experiment.cof
    if distance.size > 2 * PARTS:
        part = np.minimum((PARTS * distance / distance[-1]).astype(np.intp), PARTS - 1)
        filled = np.flatnonzero(number := np.bincount(part))
        distance, cof = ((np.bincount(part, weights=v)[filled] / number[filled]) for v in (distance, cof))
    return _shape(distance, cof)


def _shape(distance: FloatArray, cof: FloatArray) -> dict[str, float]:
    """Find m and λ of a course, (n,), as far as it has points for them."""
    late = distance >= 0.5 * distance[-1]
    if distance.size < FEWEST or late.sum() < 3 or np.any(cof[late] <= 0.0):
        return {}
    found = shape_of_growth(distance, cof)
    if distance[0] > LATEST_START * distance[-1]:
        del found["levelling_lambda"]
    return {k: v for k, v in found.items() if math.isfinite(v)}


def _read_run(folder: Path) -> RunData:
    """Read what is compared of a run. Raises InputError."""
    with Result.open(folder) as result:
        whole = whole_steps(result)
        history = {name: values[whole] for name, values in result.history.items()}
        study, summary = result.study, result.summary
        wear: dict[str, FloatArray] = {}
        if result.snapshot_distances.size and not study.samples_area:
            last = result.snapshot(-1)
            along = 0.5 * STRIP * summary["scar_mm"]["along"] / study.grid.cell
            for body in BODIES:
                if body == "disc" and study.is_swept:  # its middle was in contact at times only
                    wear[body] = groove(result, len(result.snapshots) - 1).worn
                    continue
                depth: FloatArray = getattr(last, f"wear_{body}")
                rows = np.abs(np.arange(depth.shape[0]) - 0.5 * (depth.shape[0] - 1)) <= max(along, 0.5)
                wear[body] = depth[rows].mean(axis=0)
        cof = course(result, "cof")
        return RunData(study.study.name, folder, study, history, summary, cof, result.y, wear)


def _common(values: Sequence[float | None]) -> float | None:
    """Find the value that all of them have; None where they differ."""
    return values[0] if len(set(values)) == 1 else None


def _of_patches(value_of: Callable[[Study], float | str]) -> Callable[[Study], float | str | None]:
    """Make what finds a value of a study, or None where it has no patches."""
    return lambda study: value_of(study) if study.study.model == "two-scale" else None


#: What makes two runs unlike tests -> unit and value; None where a run has no such thing.
CONDITIONS: dict[str, tuple[str, Callable[[Study], float | str | None]]] = {
    "model": ("", lambda s: s.study.model),
    "kinematics": ("", lambda s: s.sliding.kinematics),
    "contact.law": ("", lambda s: s.contact.law),
    "patches.macro_cell": ("µm", _of_patches(lambda s: 1.0e3 * s.patches.macro_cell)),
    "patches.width": ("µm", _of_patches(lambda s: 1.0e3 * s.patches.patch_width)),
    "patches.coupling": ("", _of_patches(lambda s: s.patches.coupling)),
    "patches.bulk": ("", _of_patches(lambda s: s.patches.bulk)),
    "contact.boundary": ("", lambda s: s.boundary if s.contact.law == "half-space" else None),
    "sliding.plastic": ("", lambda s: s.sliding.plastic if s.is_swept else None),
    "length of the track": ("mm", lambda s: s.lap if s.is_swept else None),
    "load": ("N", lambda s: s.contact.load),
    "sliding distance": ("mm", lambda s: s.sliding.total),
    "wear coefficient of the sphere": ("mm³/(N·m)", lambda s: 1.0e3 * s.wear_coefficients[0]),
    "wear coefficient of the disc": ("mm³/(N·m)", lambda s: 1.0e3 * s.wear_coefficients[1]),
    "sphere's curvature": ("1/mm", lambda s: s.sphere.curvature),
}
#: Sections whose keys make runs unlike too, and those of them that stand above.
LAWS, ABOVE = ("wear.", "friction."), ("wear.sphere", "wear.disc")


def _conditions_of(study: Study) -> dict[str, str]:
    """Return what makes runs unlike tests -> its value, for all that this one has."""
    above = {what: (condition(study), unit) for what, (unit, condition) in CONDITIONS.items()}
    written, unused = study.model_dump(), inapplicable(study)
    keys = [key for key, declared in declarations(Study).items() if key.startswith(LAWS) and key not in ABOVE]
    laws = {key: value_of(written, key) for key in keys if key not in unused}
    texts = {what: f"{v:.6g} {unit}" if isinstance(v, float) else v for what, (v, unit) in above.items()}
    texts |= {key: "none" if v is None else str(v) for key, v in laws.items() if not isinstance(v, dict)}
    return {what: text.rstrip() for what, text in texts.items() if text is not None}


def _lengths(experiment: Experiment, runs: list[RunData]) -> list[str]:
    """Say whether it is far shorter or longer than every run, as in a wrong unit."""
    whole, totals = float(experiment.distance[-1]), [float(run.summary["distance_mm"]) for run in runs]
    if not totals or any(0.5 * total <= whole <= 2.0 * total for total in totals):
        return []
    lengths = list(dict.fromkeys(f"{total:.4g}" for total in totals))
    told = f"the {'run' if len(runs) == 1 else 'runs'} {', '.join(lengths)} mm"
    if experiment.cycles is not None:  # the whole is not known: a point stands for a cycle
        return [f"The middle of its last cycle is at {whole:.4g} mm, {told} long."]
    return [f"It is {whole:.4g} mm long, {told}."]


def _gaps(experiment: Experiment, runs: list[RunData]) -> list[str]:
    """Say what is to be said of its gaps, over the distance that it shares with any run."""
    known = [run.history["distance"] for run in runs if run.cof is not None]
    start = max(min((float(d[0]) for d in known), default=0.0), float(experiment.distance[0]))
    end = min(max((float(d[-1]) for d in known), default=0.0), float(experiment.distance[-1]))
    return check_coverage(experiment, start, end) if end > start else []


def _differences(groups: Sequence[Group]) -> list[str]:
    """List conditions in which groups differ: they are then unlike tests."""
    found = []
    conditions = {group.name: [_conditions_of(run.study) for run in group.runs] for group in groups}
    for what in dict.fromkeys(what for runs in conditions.values() for run in runs for what in run):
        shown: dict[str, str] = {}
        for name, runs in conditions.items():
            if texts := dict.fromkeys(run[what] for run in runs if what in run):
                shown[name] = ", ".join(texts)
        if len(set(shown.values())) > 1:
            told_of = [f"{name} {text}".rstrip() for name, text in shown.items()]
            if len(told_of) > MOST_NAMES:
                told_of = list(dict.fromkeys(shown.values()))
            found.append(f"Unlike tests: the runs differ in {what} ({', '.join(told_of)}).")
    return found
