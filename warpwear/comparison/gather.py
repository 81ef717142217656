"""Runs and measured courses of friction side by side: what is read of them and how they differ."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.comparison.groups import Group, RunData, folders_of, grouped, is_sweep, unlike
from warpwear.comparison.notes import notes_of
from warpwear.comparison.scar import ScarComparison, ScarFiles, compare_scar
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.end_values import Summary
from warpwear.laws.archard import BODIES
from warpwear.measured.course import read_experiment
from warpwear.measured.experiment import Experiment
from warpwear.measured.options import optional
from warpwear.result import Result
from warpwear.results.track import course, groove, shape_of_growth, whole_steps

#: Length along sliding over which profiles are averaged, as a part of the scar's.
STRIP = 0.125
#: Parts that a measured course of many more points is averaged in.
PARTS = 200


@dataclass(frozen=True, eq=False)
class Comparison:
    """Hold runs in groups, experiments and what is to be said about them."""

    groups: tuple[Group, ...]
    experiments: tuple[Experiment, ...]
    notes: tuple[str, ...]
    scar: ScarComparison | None = None

    @property
    def runs(self) -> tuple[RunData, ...]:
        """Return the runs of all groups."""
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
    speed: float | str | None = None,
    stroke: float | str | None = None,
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
    run_folders, left_out = folders_of(folders)
    check_number(run_folders, experiments, scar)
    for path, count in Counter(Path(p).resolve() for p in (*run_folders, *experiments)).items():
        if count > 1:
            raise InputError(f"{path} is given {count} times; each run and experiment is expected once")
    groups = grouped([_read_run(folder) for folder in run_folders], band_over)
    runs = [run for group in groups for run in group.runs]
    measured = _read_experiments(
        [Path(path) for path in experiments],
        [group.name for group in groups],
        load=_common(run.study.same_load for run in runs),
        speed=optional("--speed", speed, "mm/s") or _common(run.study.sliding.mean_speed for run in runs),
        stroke=optional("--stroke", stroke, "mm") or _common(run.study.sliding.stroke for run in runs),
        radius=_common(run.study.same_radius for run in runs),
        columns=columns,
    )
    scars = None if scar is None else compare_scar(scar, runs)
    return Comparison(tuple(groups), measured, (*left_out, *notes_of(groups, runs, measured)), scars)


def _read_experiments(paths: list[Path], taken: Sequence[str], **options: Any) -> tuple[Experiment, ...]:
    """Read measured courses of friction, each named by its file, unlike the names that groups have taken."""
    courses, stems = (
        [read_experiment(path, **options) for path in paths],
        Counter(path.stem for path in paths),
    )
    names = [path.name if stems[path.stem] > 1 else path.stem for path in paths]
    labels = unlike(names, taken, suffix=" (experiment)")
    return tuple(replace(course, name=name) for name, course in zip(labels, courses, strict=True))


def check_number(
    folders: Sequence[str | Path], experiments: Sequence[str | Path], scar: object = None
) -> None:
    """Raise InputError for less than two together; a sweep stands for several runs."""
    sweeps = sum(is_sweep(Path(folder)) for folder in folders)
    if scar is not None and not folders:
        raise InputError("--scar needs the folder of a run to compare with")
    if len(folders) + sweeps + len(experiments) + (scar is not None) < 2:
        first = str([*folders, *experiments][0]) if folders or experiments else "nothing"
        raise InputError(
            f"compare needs two runs or more, or a run and an --experiment or a --scar; given: {first}"
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


def shape_of(experiment: Experiment) -> dict[str, float]:
    """Find m and λ of a measured course, see `track.shape_of_growth`.

    A course of many points is averaged in 200 equal parts of its distance first: both are slopes, which noise
    would decide.
    """
    distance, cof = experiment.distance, experiment.cof
    if distance.size > 2 * PARTS:
        distance, cof = means_of_parts(PARTS, distance, cof)
    return shape_of_growth(distance, cof)


def means_of_parts(parts: int, distance: FloatArray, *columns: FloatArray) -> list[FloatArray]:
    """Average distances and columns over them, (n,) each, in equal parts of the whole; empty ones go.

    Between rows a course is a line: each counts by the distance it stands for, however many there are.
    """
    edges = np.linspace(0.0, distance[-1], parts + 1)
    places = np.union1d(distance, edges[edges > distance[0]])
    gaps, part = np.diff(places), np.searchsorted(edges, places[:-1], side="right") - 1
    lengths = np.bincount(part, gaps, parts)
    inside = np.minimum(np.searchsorted(edges, distance, side="right") - 1, parts - 1)
    filled = (np.bincount(inside, minlength=parts) > 0) & (lengths > 0.0)
    ends = (np.interp(places, distance, values) for values in (distance, *columns))
    return [np.bincount(part, 0.5 * (e[1:] + e[:-1]) * gaps, parts)[filled] / lengths[filled] for e in ends]


def _read_run(folder: Path) -> RunData:
    """Read what is compared of a run. Raises InputError."""
    with Result.open(folder) as result:
        whole = whole_steps(result)
        history = {name: values[whole] for name, values in result.history.items()}
        study, summary = result.study, Summary.of(result.summary)
        wear: dict[str, FloatArray] = {}
        if result.snapshot_distances.size and not study.samples_area:
            last = result.snapshot(-1)
            along = 0.5 * STRIP * summary.patch_along / study.grid.cell
            for body in BODIES:
                if body == "disc" and study.is_swept:  # its middle was in contact at times only
                    wear[body] = groove(result, len(result.snapshots) - 1).worn
                    continue
                depth: FloatArray = getattr(last, f"wear_{body}")
                rows = np.abs(np.arange(depth.shape[0]) - 0.5 * (depth.shape[0] - 1)) <= max(along, 0.5)
                wear[body] = depth[rows].mean(axis=0)
        cof = course(result, "cof")
        return RunData(study.study.name, folder, study, history, summary, cof, result.y, wear)


def _common(values: Iterable[float | None]) -> float | None:
    """Find the value that all of them have; None where they differ."""
    first, *others = dict.fromkeys(values) or [None]
    return None if others else first
