"""Several tests of one pair in one answer: means, their scatter, and where the next test will lie."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.calibration.measurements import OFF, MeasuredTest, Value, checked_tests
from warpwear.calibration.repeats_text import TEXTS, figure_of, text_of
from warpwear.calibration.scatter import CONDITIONS, HELD, PRIOR, PairTest, RepeatedNumber, Scatter
from warpwear.calibration.wear import wear_coefficient
from warpwear.calibration.worn import SOURCES, sources_of, worn_volume
from warpwear.ensembles.datum import COLUMNS, Datum, headline, lines_of_data
from warpwear.ensembles.ensemble import EnsembleRow, Group
from warpwear.ensembles.table import write_csv
from warpwear.errors import InputError, named_in_python
from warpwear.figures.describe import Figure
from warpwear.figures.wording import counted
from warpwear.measured.experiment import Experiment
from warpwear.measured.friction.analysis import RecordStep, analyse
from warpwear.measured.friction.events import events_of, laps_of
from warpwear.measured.friction.report import notes_of
from warpwear.measured.motion import Motion
from warpwear.measured.options import optional, quantity, with_unit
from warpwear.measured.report import FolderReport, Report, paged
from warpwear.measured.rows import read_rows
from warpwear.results.report import Row, times

#: How the numbers are found.
HOW = [sentence.format(prior=PRIOR, held=100 * HELD) for sentence in TEXTS["how"]]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RepeatedTests(Report, FolderReport):
    """Several tests of one pair have means, scatter, and an interval for the next test; `print` shows them.

    Attributes
    ----------
    tests : tuple of PairTest
        Conditions, numbers and course of each.
    found : dict
        Name of a number -> its mean, s, n, scatter, interval, trend.
    than : RepeatedTests or None
        Another pair, to which differences are told.
    wanted : float
        Standard error of a mean, as a part of it, for which tests are counted.
    """

    MARK = "repeats.json"
    WHAT = "repeats"
    tests: tuple[PairTest, ...]
    found: Mapping[str, RepeatedNumber]
    than: "RepeatedTests | None" = None
    wanted: float = 0.05

    @cached_property
    def data(self) -> list[Datum]:
        """Give a row for each datum: measured, what the other tests say, (difference)/error."""
        return [datum for number in self.found.values() for datum, _ in number.data]

    @cached_property
    def told(self) -> dict[str, dict[str, Any]]:
        """Give what is told of each number, by name."""
        return {name: number.numbers(self.wanted) for name, number in self.found.items()}

    @property
    def differences(self) -> dict[str, tuple[float, float]]:
        """Give the difference of the means of both pairs, and its standard error, by name."""
        other = self.than.told if self.than else {}
        both = [(name, a, other[name]) for name, a in self.told.items() if name in other]
        return {n: (a["pair"] - b["pair"], math.hypot(a["pair_error"], b["pair_error"])) for n, a, b in both}

    def _title(self) -> str:
        return f"{len(self.tests)} tests of one pair"

    def _rows(self) -> list[Row]:
        content = {
            "tests": [test.name for test in self.tests],
            "numbers": self.told,
            "differences": self.differences,
            "wanted_error": self.wanted,
            "data": [datum.entry for datum in self.data],
            "headline": headline(self.data),
            "sentence": str(self).split("\n")[1].strip(),
            "notes": [f"{test.name}: {note}" for test in self.tests for note in test.notes],
            "how": HOW,
        }
        return [Row("", key, value) for key, value in content.items()]

    def _table(self) -> list[list[Row]]:
        return [
            [Row("", key, value) for key, value in ({"name": name} | told).items()]
            for name, told in self.told.items()
        ]

    def _declared(self) -> Figure:
        return figure_of(self.tests)

    def __str__(self) -> str:
        lines = text_of(self.tests, self.told, self.differences)
        count = sum(len(test.notes) for test in self.tests)
        more = f"; {counted(count, 'warning')} of records, on the page and in JSON" * bool(count)
        return "\n".join([self._title(), *lines, f"  {headline(self.data)}{more}"])

    def _parts(self, folder: Path) -> dict[str, Any]:
        columns = {key: [datum.entry[key] for datum in self.data] for key in COLUMNS}
        figures = {"courses": self._declared()} if any(test.course for test in self.tests) else {}
        table = partial(write_csv, columns)
        lines = [str(self), "", *lines_of_data(self.data), *self.numbers["notes"]]
        return paged(
            self, figures, TEXTS["sections"], table, name=self._title().capitalize(), lines=lines, how=HOW
        )


@named_in_python()
def repeats(
    tests: Any,
    *,
    than: Any = (),
    at: Mapping[str, Any] | None = None,
    wanted: float = 0.05,
    load: Any = None,
    radius: Any = None,
    stroke: Any = None,
    speed: Any = None,
    columns: str | None = None,
    preparation: Mapping[str, Any] | None = None,
) -> RepeatedTests:
    """Bring several tests of one pair into one answer: mean, scatter, and where the next test will lie.

    Parameters
    ----------
    tests : list of path or dict, or path
        Records of friction, TOML files with a list ``[[test]]``, or tables as of that list, such as
        ``{"record": "test-1.csv", "profile": "track-1.txt", "track_length": "30 mm", "load": "5 N"}``: the
        keys are those that docs/reference/keys.md explains. Entries with one ``name`` are places of one test.
    than : list of path or dict, or path, optional
        Tests of another pair, to which differences are told.
    at : dict, optional
        Conditions of the next test, such as ``{"load": "10 N"}``; a trend is then taken over these. Over the
        load it is taken wherever that differs.
    wanted : float
        Standard error of a mean, as a part of it, for which tests are counted.
    load, radius, stroke, speed, columns : optional
        How records are read, as of `read_record`: the radius is the track's, the load where none is recorded.
    preparation : dict, optional
        Keys of ``[disc]``, as text, that say how measured surfaces are read, such as ``{"pixel": "3 um"}``.

    Returns
    -------
    RepeatedTests
        Of level, incubation, jump, overshoot and wear coefficients of both bodies the mean, the standard
        deviation, the scatter between tests, and the interval of the next test.

    Raises
    ------
    InputError
        For what cannot be read, and a trend that the tests do not tell.

    References
    ----------
    A. Gelman, Prior distributions for variance parameters in hierarchical models, Bayesian Analysis 1 (2006)
    515-534.

    Examples
    --------
    >>> levels = [{"friction": f"{level} +- 0.01"} for level in (0.60, 0.63, 0.57)]
    >>> warpwear.repeats(levels).told["level"]["s"]
    0.03...
    """
    if not 0.0 < wanted < 1.0:
        raise InputError(f"--wanted is {wanted:g}: allowed is a part of the mean, above 0 and below 1")
    if unknown := [name for name in at or {} if name not in CONDITIONS]:
        raise InputError(f"--at {unknown[0]} is not allowed; allowed: {', '.join(CONDITIONS)}")
    to_be = {name: quantity(f"--at {name}", value, CONDITIONS[name]) for name, value in (at or {}).items()}
    alike = {"track_radius": radius, "stroke": stroke, "speed": speed}
    units = {"speed": "mm/s"}
    given = {name: with_unit(v, units.get(name, "mm")) for name, v in alike.items() if v is not None}
    how = {"columns": columns, "preparation": preparation or {}, "load": optional("--load", load, "N")}
    read = partial(_read, given=given, how=how)
    taken = read(tests)
    found = _numbers_of(taken, to_be)
    for name in to_be:
        if not any(name in number.over for number in found.values()):
            raise InputError(f"--at {name}: the tests have to differ in it, or they tell no trend over it")
    other = None
    if than:
        others = read(than)
        meant = next((number.at for number in found.values() if number.over), {})
        other = RepeatedTests(tests=others, found=_numbers_of(others, meant), wanted=wanted)
    return RepeatedTests(tests=taken, found=found, than=other, wanted=wanted)


def in_order(alike: dict[str, Any], **measured: Sequence[Any]) -> list[dict[str, Any]]:
    """Make tests of what was measured in them, each kind in their order; the last may lack some.

    alike: what all have, None for nothing.
    """
    rows = itertools.zip_longest(*measured.values())
    tests = [alike | dict(zip(measured, row, strict=True)) for row in rows]
    return [{key: value for key, value in test.items() if value is not None} for test in tests]


def _numbers_of(tests: tuple[PairTest, ...], at: Mapping[str, float]) -> dict[str, RepeatedNumber]:
    """Gather what several tests have measured, by name. at: conditions of the next test."""
    found = {}
    for kind in _kinds(tests):
        asked, at_load, load = kind.partition(" at ")
        said = TEXTS["numbers"][asked]
        some = tuple(test for test in tests if kind in test.values)
        if not any(test.values[kind].value for test in some):
            continue
        varied = {*at} - {"load"} if at_load else {*at, "load"}
        alike = [name for name in CONDITIONS if name in varied]
        known = {name: [test.conditions.get(name, math.nan) for test in some] for name in alike}
        over = tuple(
            name
            for name, values in known.items()
            if np.max(values) > (1.0 + OFF) * np.min(values)  # of known ones
        )
        middle = {name: math.exp(float(np.mean(np.log(known[name])))) for name in over}
        label = f"{said['label']}{at_load}{load}"
        number = RepeatedNumber(kind, some, over, {**middle, **at}, label, said["unit"])
        if not number.pair.is_known:
            told = " and ".join(over)
            raise InputError(
                f"{len(some)} tests do not tell a trend over {told}: more, of other conditions, do"
            )
        found[kind] = number
    if not found:
        raise InputError("nothing was measured: give records of friction, or tests with a volume or a scar")
    return found


def _kinds(tests: Iterable[PairTest]) -> list[str]:
    """Name the numbers that tests have, in the order of reports.toml."""
    kinds = dict.fromkeys(kind for test in tests for kind in test.values)
    return sorted(kinds, key=lambda kind: [*TEXTS["numbers"]].index(kind.partition(" at ")[0]))


def _read(tests: Any, *, given: Mapping[str, Any], how: Mapping[str, Any]) -> tuple[PairTest, ...]:
    """Read tests; entries of one name are places of one. Raises InputError."""
    entries: dict[str, list[PairTest]] = {}
    for item in [tests] if isinstance(tests, str | Path | Mapping) else tests:
        is_list = isinstance(item, str | Path) and Path(item).suffix.lower() == ".toml"
        some: Any = item if is_list else [item if isinstance(item, Mapping) else {"record": item}]
        for named, test in checked_tests(some, **given).items():
            name = test.name or (Path(test.record).stem if isinstance(test.record, str | Path) else "")
            if not test.name and (not name or name in entries):
                name = f"{name} {len(entries) + 1}".strip() if name else f"test.{len(entries) + 1}"
            entries.setdefault(name, []).extend(_places(test, name, named, how))
    _name_loads(entries)
    return tuple(_together(name, places) for name, places in entries.items())


def _places(test: MeasuredTest, name: str, named: str, how: Mapping[str, Any]) -> list[PairTest]:
    """Read what was measured in one entry: the whole with what is worn, and a place for each step."""
    steps, notes = _steps(test, how)
    sizes = {key: getattr(test, key) for key in (*CONDITIONS, "distance", "track_length")}
    known = {key: size.value if isinstance(size, Value) else size for key, size in sizes.items() if size}
    places = [_of_step(step, name, known) for step in steps]
    whole = {"load": how["load"] or math.nan}
    if steps:
        slid = sum(step.slid for step in steps)
        work = sum((step.load or whole["load"]) * step.slid for step in steps)
        whole = {**places[0].conditions, "load": work / slid, "distance": slid}
        if len({step.track for step in steps}) > 1:
            whole.pop("track_length", None)  # of several tracks
    if test.track_radius:
        whole["track_length"] = 2.0 * math.pi * test.track_radius
    whole |= known
    test = test.model_copy(update={"track_length": whole.get("track_length")})
    values = {}
    if test.friction and test.friction.at:
        raise InputError(f"{named}.friction is at a distance: allowed is that of the whole test")
    if test.friction is not None and not any("level" in place.values for place in places):
        values["level"] = test.friction
    both = [getattr(test, key) or Value(whole.get(key, math.nan)) for key in ("load", "distance")]
    for source in sources_of(test):
        kind = "_".join(filter(None, ("k", SOURCES[source].worn)))
        if kind in values:
            raise InputError(f"{named}.{source} is of a body whose wear is given already: give one of both")
        if not all(each.value > 0.0 for each in both):
            raise InputError(f"{named}.{source} needs a load and a distance: K is V/(F L)")
        prepared = how["preparation"] if SOURCES[source].file else {}
        worn = worn_volume(test, source, named, preparation=prepared)
        k, error, _ = wear_coefficient(worn, *both)
        values[kind] = Value(1e3 * k, times(1e3, error))
        notes += (f"of {source} {worn.doubt}",) if worn.doubt else ()
    return [PairTest(name, whole, values, notes=notes, steps=steps), *places]


def _steps(test: MeasuredTest, how: Mapping[str, Any]) -> tuple[tuple[RecordStep, ...], tuple[str, ...]]:
    """Analyse the record of a test, and say what is doubtful in it. Raises InputError."""
    if isinstance(test.record, Experiment):
        laps = laps_of(test.record, None)
        return (RecordStep("", test.record, laps, events_of(laps), None, None, 0.0),), ()
    if test.record is None:
        return (), ()
    sizes = {name: size.value for name in ("stroke", "speed", "load") if (size := getattr(test, name))}
    motion = Motion(radius=test.track_radius, **({"load": how["load"]} | sizes))
    analysis = analyse(read_rows(test.record, how["columns"]), motion)
    return analysis.steps, tuple(notes_of(analysis)[0].value)


def _of_step(step: RecordStep, name: str, known: Mapping[str, float]) -> PairTest:
    """Return what happens in a step of a record. Places are known to half a lap, which is a mean."""
    values, events, laps, count = {}, step.events, step.laps, None
    if events.steady is not None:
        values["level"] = Value(events.steady.value, events.steady.error)
    if events.jump is not None:
        values["incubation"] = Value(events.jump.start, 0.5 * laps.length)
        values["jump"] = Value(events.jump.end - events.jump.start, 0.5 * laps.length)
        count = laps.count(events.jump.start)
        if events.steady is not None:
            values["overshoot"] = Value(events.overshoot or 0.0, events.steady.error)
    own = {"load": step.load, "speed": step.speed, "track_length": step.track}
    conditions = {key: size for key, size in own.items() if size} | dict(known)
    return PairTest(name, conditions, values, (1e-3 * (step.before + laps.distance), laps.cof), count)


def _name_loads(entries: dict[str, list[PairTest]]) -> None:
    """Name numbers of steps of a record under several loads by these, alike where they differ by little."""
    steps = {name: [one for one in places if one.course] for name, places in entries.items()}
    found = {name: [one.conditions.get("load", math.nan) for one in some] for name, some in steps.items()}
    several = {name for name, loads in found.items() if loads and np.max(loads) > (1.0 + OFF) * np.min(loads)}
    loads = np.sort(np.concatenate([np.zeros(0), *(found[name] for name in several)]))
    apart = np.flatnonzero(loads[1:] > (1.0 + OFF) * loads[:-1]) + 1
    named = {load: f"{group.mean():.3g} N" for group in np.split(loads, apart) for load in group.tolist()}
    for name in several:
        entries[name] = [
            replace(one, values={f"{kind} at {named[load]}": value for kind, value in one.values.items()})
            if one.course and (load := one.conditions["load"])
            else one
            for one in entries[name]
        ]


def _together(name: str, places: Sequence[PairTest]) -> PairTest:
    """Make one test of its places: means, with the larger of their scatter's and their own error."""
    values = {}
    for kind in _kinds(places):
        some = [place.values[kind] for place in places if kind in place.values]
        mean = Scatter(*zip(*((value, error) for value, error, _ in some), strict=True))
        values[kind] = Value(mean.mean, mean.error)
    rows = tuple(EnsembleRow(name, {}, {"cof": place.course}) for place in places if place.course)
    course, counts = Group(name, rows).courses("cof"), [place.laps for place in places if place.laps]
    mean_course = course and (course[0], np.nanmean(course[1], axis=0))
    laps = sum(counts) / len(counts) if counts else None
    notes = tuple(dict.fromkeys(itertools.chain(*(place.notes for place in places))))
    steps = tuple(itertools.chain(*(place.steps for place in places)))
    return PairTest(name, places[0].conditions, values, mean_course, laps, notes, steps)
