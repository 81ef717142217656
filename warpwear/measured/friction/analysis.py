"""Analyse a record: the course of each of its steps, what happens in it, its energy and friction loops."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.measured.course import experiment_of
from warpwear.measured.experiment import Experiment
from warpwear.measured.friction.events import Events, LapMeans, events_of, laps_of
from warpwear.measured.friction.states import SPAN, StatesFit, fit_states, part_of
from warpwear.measured.motion import Motion, moving, sliding_distance, spans
from warpwear.measured.rows import UNLOADED, RecordRows
from warpwear.measured.tribometer import alternates, turning_points

#: A step with less than this part of the rows, or of an equal share of them, is told, and not analysed.
SHORT, SHORT_OF_EQUAL = 0.02, 0.5


@dataclass(frozen=True, eq=False)
class RecordStep:
    """A step of a record, or a record of one step, has a course of friction.

    load: median normal force [N], energy: load × coefficient over the distance slid [J], None where the load
    is not known. before: distance slid in the steps before [mm]. states: constants of a course that jumps.
    others: name and unit of a further column -> its means, (groups,), NaN where there are none. speed: of
    sliding [mm/s]; track: length of the circle or stroke [mm]; None where neither file nor person says them.
    is_circle: whether the track is a circle, by a radius or a count of laps.
    """

    name: str
    course: Experiment
    laps: LapMeans
    events: Events
    load: float | None
    energy: float | None
    before: float
    states: StatesFit | None = None
    others: Mapping[str, FloatArray] = field(default_factory=dict)
    speed: float | None = None
    track: float | None = None
    is_circle: bool = False

    @property
    def slid(self) -> float:
        """Return the distance slid [mm]: to the end of the last cycle, of which a course has the middle."""
        half = 0.0 if self.course.cycles is None else 0.5 * self.laps.length
        return float(self.course.distance[-1]) + half


@dataclass(frozen=True, eq=False)
class Loop:
    """A friction loop is force [N] over position [mm], both (points,), of one cycle."""

    cycle: int
    position: FloatArray
    force: FloatArray

    @property
    def energy(self) -> float:
        """Return the energy that the loop encloses [mJ]."""
        x, f = self.position, self.force
        return abs(float(np.sum(0.5 * (f + np.roll(f, -1)) * (np.roll(x, -1) - x))))


@dataclass(frozen=True, eq=False)
class Analysis:
    """A record holds steps and loops. left_out: names of steps that are too short, or have no course."""

    rows: RecordRows
    steps: tuple[RecordStep, ...]
    loops: tuple[Loop, ...]
    left_out: tuple[str, ...]


def analyse(rows: RecordRows, motion: Motion) -> Analysis:
    """Analyse the rows of a record. Raises InputError where no step of it has a course."""
    if len(rows.steps) == 1 or alternates(rows):
        return Analysis(rows, (_step("", rows, motion, 0.0),), tuple(_loops(rows)), ())
    steps: list[RecordStep] = []
    left_out, failed, least = [], None, min(SHORT, SHORT_OF_EQUAL / len(rows.steps)) * rows.step.size
    for number, name in enumerate(rows.steps):
        part, radius = rows.of_step(number), motion.radius
        if part.step.size < least:
            left_out.append(f"'{name}', {part.step.size} rows")
            continue
        if isinstance(radius, Sequence) and len(radius) == len(rows.steps):
            radius = radius[number]
        try:
            before = sum(float(step.course.distance[-1]) for step in steps)
            steps.append(_step(name, part, replace(motion, radius=radius), before))
        except InputError as error:
            failed = failed or error
            left_out.append(f"'{name}', {str(error).partition(': ')[2] or error}")
    if not steps:
        experiment_of(rows, motion)  # what is wrong with all of them is said of the whole
        raise failed or InputError(f"{rows.path} has no step of {least:.0f} rows: longer ones are expected")
    return Analysis(rows, tuple(steps), tuple(_loops(rows)), tuple(left_out))


def _step(name: str, rows: RecordRows, motion: Motion, before: float) -> RecordStep:
    course = experiment_of(rows, motion)
    lap = lap_of(rows, motion)
    laps = laps_of(course, lap)
    normal = rows.table.get("normal force")
    load = motion.load
    if normal is not None and np.isfinite(normal).any():
        pressing = np.abs(normal)
        load = float(np.nanmedian(pressing[pressing >= UNLOADED * np.nanmax(pressing)]))
    by_cycles = course.cycles is not None  # each stands for itself, those without load for nothing
    work = laps.cof.sum() * laps.length if by_cycles else np.trapezoid(course.cof, course.distance)
    energy = None if load is None else 1e-3 * load * float(work)
    events, states = events_of(laps), None
    if events.jump is not None:
        with suppress(InputError):  # a jump of another kind
            (states,) = fit_states([part_of(course, lap, SPAN * events.jump.end)])
    slid = float(np.ptp(course.distance)) + (laps.length if by_cycles else 0.0)  # a course has the middles
    others, speed, stroke = _others(rows, motion, laps), _speed(rows, motion, slid), stroke_of(rows, motion)
    turns = motion.radius is not None or {"radius", "laps"} & rows.table.keys()  # a cycle may be to and fro
    circle = lap if turns and not by_cycles and stroke is None else None
    track = 0.5 * laps.length if by_cycles else stroke or circle
    told = (load, energy, before, states, others, speed, track)
    return RecordStep(name, course, laps, events, *told, is_circle=circle is not None)


def _speed(rows: RecordRows, motion: Motion, slid: float) -> float | None:
    """Return the speed of sliding [mm/s]: the median of what moves, or what is slid [mm] over time."""
    table = moving(rows)[0].table
    speeds = np.abs(table.get("speed", np.zeros(0)))
    if motion.speed is not None or np.isfinite(speeds).any():
        return motion.speed or float(np.nanmedian(speeds))
    seconds = spans(table["time"])[0] if "time" in table else 0.0
    return slid / seconds if seconds > 0.0 else None


def stroke_of(rows: RecordRows, motion: Motion) -> float | None:
    """Return the length of a stroke [mm], given or measured; None where neither says it."""
    measured = rows.table.get("stroke", np.zeros(0))
    return motion.stroke or (float(np.nanmedian(measured)) if np.isfinite(measured).any() else None)


def _others(rows: RecordRows, motion: Motion, laps: LapMeans) -> dict[str, FloatArray]:
    """Return the means of further columns over the laps of a course; of what has no distance none."""
    names = [name for name in rows.table if name.endswith("]")]
    if not names or alternates(rows):
        return {}
    try:
        distance = sliding_distance(rows, motion, what="column")[0]
    except InputError:  # of a position alone
        return {}
    starts = laps.distance - 0.5 * laps.length
    group = np.searchsorted(starts, distance, side="right") - 1
    inside = np.isfinite(distance) & (group >= 0) & (distance - starts[group] <= laps.length)
    means = {}
    for name in names:
        known = inside & np.isfinite(rows.table[name])
        count = np.bincount(group[known], minlength=starts.size)
        total = np.bincount(group[known], weights=rows.table[name][known], minlength=starts.size)
        means[name] = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return means


def lap_of(rows: RecordRows, motion: Motion) -> float | None:
    """Return the distance of one lap, or of two strokes [mm], None where the record does not say it."""
    table = rows.table
    if (stroke := stroke_of(rows, motion)) is not None:
        return 2.0 * stroke
    radius = motion.radius if motion.radius is not None else table.get("radius")
    if radius is not None and np.isfinite(radius).any():
        return 2.0 * np.pi * float(np.nanmedian(radius))
    for turns in ("laps", "cycle"):
        if {"distance", turns} <= table.keys():
            length, number = spans(table["distance"], table[turns])
            if number > 0.0:
                return length / number
    return None


def _loops(rows: RecordRows) -> list[Loop]:
    """Return the first whole cycle of a record with positions and forces, the middle and the last one."""
    if not {"position", "friction force"} <= rows.table.keys():
        return []
    position, force = rows.table["position"], rows.table["friction force"]
    good = np.isfinite(position) & np.isfinite(force)
    turns = turning_points(position[good])[0][::2]
    last = turns.size - 2
    return [
        Loop(k + 1, position[good][turns[k] : turns[k + 1]], force[good][turns[k] : turns[k + 1]])
        for k in sorted({0, last // 2, last})
        if last >= 0
    ]
