"""Whether a run has the start, the rise and the level of a measured course of friction, a row for each."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from warpwear.comparison.groups import RunData
from warpwear.ensembles.datum import CONTRADICTION, Datum
from warpwear.ensembles.ensemble import Curve, Group, rms_difference
from warpwear.errors import InputError
from warpwear.measured.experiment import Experiment, mean_of_last_tenth, mean_over
from warpwear.measured.friction.events import Events, events_of, laps_of

#: Standard uncertainty of a measured coefficient of friction as a part of it, at least.
COF_ERROR = 0.02
#: Part of a course without a jump that is its start.
START = 0.1
#: Lines of runs that are said first, at most.
MOST = 6


def data_of(run: RunData, experiment: Experiment) -> list[Datum]:
    """Set a measured course beside that of a run: its start, its rise where it jumps, its level.

    A rise is known to the length that it takes. What is the run's input is marked as fitted.
    """
    course = run.courses.get("cof")
    if course is None or rms_difference(course, experiment.course) is None:
        return []
    laps = laps_of(experiment, None)
    try:
        events = events_of(laps)
    except InputError:  # levels need a package that may be missing
        events = Events()
    jump, steady, end = events.jump, events.steady, float(course[0][-1])
    first, whole = float(experiment.distance[0]), float(experiment.distance[-1])
    until = jump.start if jump else first + START * (whole - first)
    friction = run.study.friction
    inputs = {"level": friction.ends_as_given, "start": friction.fitted in ("initial", "coulomb", "states")}

    def of_cof(name: str, measured: float, computed: float, error: float = 0.0) -> Datum:
        return Datum(name, measured, computed, math.hypot(error, COF_ERROR * measured), "", inputs[name])

    rows = [of_cof("start", mean_over(*experiment.course, first, until), mean_over(*course, first, until))]
    if jump is not None and end >= jump.end:
        length = jump.end - jump.start
        levels = jump.low + np.array([0.1, 0.5, 0.9]) * (jump.high - jump.low)
        low, half, high = (_first(course, float(level)) for level in levels)
        error, is_input = max(length, laps.length), friction.fitted == "states"
        rows.append(Datum("place of the rise", 0.5 * (jump.start + jump.end), half, error, "mm", is_input))
        rows.append(Datum("length of the rise", length, high - low, error, "mm", is_input))
    if steady is not None and end > steady.start:
        level = steady.value - 0.5 * steady.drift  # the mean, and not the end, of its line
        rows.append(of_cof("level", level, mean_over(*course, steady.start, steady.end), steady.error))
    elif steady is None and end > 0.9 * whole:
        rows.append(of_cof("level", experiment.final_cof, mean_of_last_tenth(*course)))
    return rows


def data_by_name(
    groups: Iterable[Group[RunData]], experiments: Sequence[Experiment]
) -> dict[str, list[Datum]]:
    """Set measured courses beside the mean course of each group, by the names of both; none of no course."""
    found: dict[str, list[Datum]] = {}
    for group in groups:
        if (courses := group.courses("cof")) is not None:
            mean = courses[0], np.nanmean(courses[1], axis=0)
            run = replace(group.rows[0], courses={"cof": mean})
            found |= {f"{group.name} beside {e.name}": rows for e in experiments if (rows := data_of(run, e))}
    return found


def told_of(found: Mapping[str, Sequence[Datum]]) -> Iterator[str]:
    """Say in what each run agrees with each measured course, and in what not. found: of `data_by_name`."""
    for name, data in [*found.items()][:MOST]:
        good = [d.name + " (fitted)" * d.fitted for d in data if abs(d.off) <= CONTRADICTION]
        bad = [
            f"{d.name} (measured {_shown(d.measured, d)}, computed {_shown(d.computed, d)})"
            for d in data
            if not abs(d.off) <= CONTRADICTION
        ]
        text = f"{name}: agrees in {', '.join(good) or 'nothing'}"
        yield f"{text}; differs in {'; '.join(bad)}" if bad else text
    if len(found) > MOST:
        yield f"and {len(found) - MOST} more runs beside measured courses"


def rms_of_constant(course: Curve, other: Curve) -> float | None:
    """Find how a course differs from the best constant (rms), over the distances that both have."""
    start, end = max(c[0][0] for c in (course, other)), min(c[0][-1] for c in (course, other))
    if end <= start:
        return None
    mean = mean_over(*course, float(start), float(end))
    return rms_difference((np.array([start, end]), np.array([mean, mean])), course)


def _shown(value: float, datum: Datum) -> str:
    """Write one of its numbers, of a rise that is not there that it is not."""
    return f"{value:.3g} {datum.unit}".rstrip() if np.isfinite(value) else "none"


def _first(course: Curve, level: float) -> float:
    """Return where a course first reaches a level, infinity where it does not."""
    distance, values = course
    above = np.flatnonzero(values >= level)
    if not above.size:
        return np.inf
    k = int(above[0])
    return float(distance[k] if k == 0 else np.interp(level, values[k - 1 : k + 1], distance[k - 1 : k + 1]))
