"""What was measured: courses of friction, single values of it, volumes, the scar, with uncertainties."""

import itertools
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from warpwear.calibration.measurements import (
    KINDS,
    OFF,
    MeasuredTest,
    Tests,
    check_conditions,
    checked_tests,
    conditions_of,
    in_file,
    size_and_error,
)
from warpwear.calibration.scatter import Scatter
from warpwear.calibration.worn import SOURCES, sources_of, worn_volume
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.quantities import printed
from warpwear.measured.course import check_cof, experiment_of
from warpwear.measured.experiment import Experiment
from warpwear.measured.motion import Motion
from warpwear.measured.rows import RecordRows, read_rows
from warpwear.study.study import Study

#: Points that a course is thinned to, by means of neighbours.
POINTS = 100
#: Fewest points of a course.
FEWEST = 5
#: Least and largest standard uncertainty as a part of a measured value: squares of others leave the range of
#: numbers.
PARTS = (1e-9, 1e9)


def unit_of(kind: str) -> str:
    """Return the unit of a measured value as people write it; empty for a coefficient."""
    return printed(KINDS[kind][0])


@dataclass(frozen=True)
class MeasuredValue:
    """Hold a value with its standard uncertainty; at: sliding distance [mm] of a coefficient, else None."""

    kind: str
    value: float
    error: float
    at: float | None = None

    @property
    def unit(self) -> str:
        """The unit as people write it; empty for a coefficient."""
        return unit_of(self.kind)

    @property
    def text(self) -> str:
        """Write the value for people."""
        where = "" if self.at is None else f" at {self.at:.4g} mm"
        return f"{KINDS[self.kind][1]}{where}: {self.value:.4g} ± {self.error:.2g} {self.unit}".rstrip()


@dataclass(frozen=True, eq=False)
class MeasuredCourse(Experiment):
    """Hold a measured coefficient of friction over the distance slid [mm], both (points,), thinned."""

    @property
    def thirds(self) -> list[slice]:
        """Rows of its first, middle and last third of distance; none where one holds too few points."""
        ends = np.searchsorted(self.distance, self.distance[-1] * np.array([0.0, 1.0, 2.0]) / 3.0).tolist()
        thirds = [slice(*pair) for pair in itertools.pairwise([*ends, self.distance.size])]
        return thirds if all(third.stop - third.start >= FEWEST for third in thirds) else []

    @cached_property
    def scatter(self) -> float:
        """Standard deviation of points about straight lines through its thirds, infinite without these.

        It is the median, for friction that runs in is no line at first.
        """
        square = []
        for third in self.thirds:
            x = self.distance[third] - self.distance[third].mean()
            residual = self.cof[third] - np.polyval(np.polyfit(x, self.cof[third], 1), x)
            square.append(float(np.sum(residual**2)) / (x.size - 2))
        return float(np.sqrt(np.median(square or [np.inf])))


@dataclass(frozen=True, eq=False)
class Data:
    """All that was measured: courses, coefficients at single distances, other values; and what was done."""

    courses: tuple[MeasuredCourse, ...] = ()
    points: tuple[MeasuredValue, ...] = ()
    values: tuple[MeasuredValue, ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def distance(self) -> FloatArray:
        """Distances [mm] at which a coefficient is asked for: of the courses, then of the points."""
        points = [point.at or 0.0 for point in self.points]
        return np.concatenate([*(course.distance for course in self.courses), points])

    @cached_property
    def cof(self) -> FloatArray:
        """Return the coefficients measured there."""
        points = [point.value for point in self.points]
        return np.concatenate([*(course.cof for course in self.courses), points])

    @cached_property
    def rows(self) -> list[slice]:
        """Return the rows of each course in `distance`."""
        ends = np.cumsum([0, *(course.distance.size for course in self.courses)]).tolist()
        return [slice(*pair) for pair in itertools.pairwise(ends)]

    @property
    def between(self) -> float:
        """Return the standard deviation of levels of repeated courses over their last thirds; 0 of one."""
        levels = [float(course.cof[course.thirds[-1]].mean()) for course in self.courses if course.thirds]
        return (Scatter(levels, ()).deviation or 0.0) if levels else 0.0

    @property
    def repeated(self) -> bool:
        """Whether anything was measured in more than one test."""
        return len(self.courses) > 1 or len(self.values) > len(self.kinds)

    @property
    def kinds(self) -> set[str]:
        """Name the values beside friction."""
        return {value.kind for value in self.values}


def data_of(study: Study, tests: Tests, *, columns: str | None = None) -> Data:
    """Read what was measured in tests that the study describes: tables as of [[test]], or a file of them.

    columns: of records. Raises InputError for what does not go with the study.
    """
    courses, both = [], []
    tables, own = in_file(tests)[1] if isinstance(tests, str | Path) else tests, conditions_of(study)
    for named, test in checked_tests(tables, **own).items():
        check_conditions(test, named, study)
        if test.record is not None:
            courses.append(_course(study, test.record, columns))
        sources = [name for name in sources_of(test) if name not in KINDS]
        sources += [kind for kind in KINDS if getattr(test, kind) is not None]
        both += [_measured(study, test, source, f"{named}.{source}") for source in sources]
    if not courses and not both:
        raise InputError("nothing was measured: give a course of friction, a volume or a scar")
    points = tuple(value for value in both if value.kind == "friction")
    values, notes = _repeated([value for value in both if value.kind != "friction"])
    return Data(tuple(courses), points, tuple(values), tuple(notes))


def _repeated(values: list[MeasuredValue]) -> tuple[list[MeasuredValue], list[str]]:
    """Widen the uncertainties of repeats that scatter more than they say (Birge's ratio), and say so."""
    notes = []
    for kind in dict.fromkeys(value.kind for value in values):
        same = [value for value in values if value.kind == kind]
        mean = Scatter([v.value for v in same], [v.error for v in same]).weighted
        if mean and (ratio := mean[2]) > 1.0:
            values = [replace(v, error=ratio * v.error) if v.kind == kind else v for v in values]
            notes.append(
                f"{KINDS[kind][1]}: {len(same)} tests scatter {ratio:.2g} times as much as their "
                "uncertainties say, which were widened by that."
            )
    return values, notes


def _measured(study: Study, test: MeasuredTest, kind: str, label: str) -> MeasuredValue:
    """Check a value of `KINDS` against the study, or make one of a body's worn volume. Raises InputError."""
    at, total = None, study.sliding.total
    if kind not in KINDS:
        if (body := SOURCES[kind].worn) is None:
            raise InputError(f"{label} is of a body that is not known: give volume_counter or volume_disc")
        worn = worn_volume(test, kind, label.rpartition(".")[0], preparation={})
        kind, value, error = f"volume_{body}", worn.volume, worn.error
    else:
        value, error = size_and_error(getattr(test, kind))
    if kind == "friction":
        at = getattr(test, kind).at or total
        check_cof(label, np.array([at]), np.array([value]))
        if not 0.0 < at <= total * (1.0 + 1e-9):
            raise InputError(f"{label}: the study slides {total:g} mm, and not to {at:g} mm")
    if kind == "scar" and value > min(*study.grid.sides, 2.0 * (study.counter.radius or np.inf)):
        larger = "the scar is larger than the field of the study"
        raise InputError(f"{label}: {larger}, {study.grid.size} (grid.extent)")
    if kind == "section" and study.sliding.lap is None:
        keys = "sliding.stroke or sliding.track_radius"
        raise InputError(f"{label} needs {keys} in the study: section × that length is the disc's volume")
    if not PARTS[0] <= (part := (error or 0.0) / value) <= PARTS[1]:
        raise InputError(
            f"{label}: the standard uncertainty is {part:.3g} of the value, and allowed is {PARTS[0]:g} to "
            f"{PARTS[1]:g}; write it behind the value, such as '0.80 +- 0.02 mm'"
        )
    return MeasuredValue(kind, value, error or 0.0, at)


def _course(study: Study, experiment: Experiment | str | Path, columns: str | None) -> MeasuredCourse:
    """Read a course, check it against the study and thin it. Raises InputError."""
    if not isinstance(experiment, Experiment):
        sliding, load, rows = study.sliding, study.contact.load, read_rows(experiment, columns)
        _check_load(rows, load)
        motion = Motion(
            stroke=sliding.stroke, load=load, run_speed=sliding.mean_speed, radius=sliding.track_radius
        )
        experiment = experiment_of(rows, motion)
    name, distance, cof = experiment.name, np.asarray(experiment.distance), np.asarray(experiment.cof)
    check_cof(name, distance, cof)
    inside = (distance > 0.0) & (distance <= study.sliding.total * (1.0 + 1e-9))
    if inside.sum() < FEWEST:
        raise InputError(
            f"{name} has {inside.sum()} points from 0 to {study.sliding.total:g} mm, which the study slides: "
            f"at least {FEWEST} are needed"
        )
    notes = [*experiment.warnings, *experiment.notes]
    if not inside.all():
        total = study.sliding.total
        notes.append(f"Points beyond the {total:g} mm of the study, left out: {(~inside).sum()}.")
    distance, cof = distance[inside], cof[inside]
    if distance.size > POINTS:
        notes.append(f"Means of neighbours, {POINTS} for {distance.size} points.")
        blocks = np.array_split(np.arange(distance.size), POINTS)
        distance, cof = (np.array([column[block].mean() for block in blocks]) for column in (distance, cof))
    return MeasuredCourse(name, distance, cof, tuple(notes))


def _check_load(rows: RecordRows, load: float) -> None:
    """Raise InputError for a normal force that is not that of the study [N]."""
    force = rows.table.get("normal force")
    if force is None or not (force := np.abs(force[np.isfinite(force)])).size:
        return
    typical = float(np.median(force))
    if abs(typical - load) > OFF * load:
        raise InputError(
            f"{rows.path}: the normal force is {typical:.3g} N in the middle, the study has contact.load = "
            f"{load:g} N: they have to agree"
        )
