"""One number of several tests, its mean and scatter; and what calibrates a test, for those of a list."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from warpwear.calibration.measurements import Tests, Value, check_conditions, checked_tests
from warpwear.calibration.scatter import PairTest, RepeatedNumber, Scatter
from warpwear.ensembles.datum import headline
from warpwear.errors import InputError, reworded
from warpwear.figures.wording import counted
from warpwear.measured.report import Report
from warpwear.result import opened
from warpwear.results.report import Row

#: Keys of a test that say what was done in it, beside what was measured.
CONDITIONS = ("load", "distance", "area")


class Repeated(Report):
    """Hold one number of each of several tests."""

    @property
    def values(self) -> tuple[float, ...]:
        """Give the number of every test."""
        raise NotImplementedError

    @property
    def errors(self) -> tuple[float | None, ...]:
        """Give its standard uncertainty of every test, None where that is unknown."""
        raise NotImplementedError

    @property
    def scatter(self) -> Scatter:
        """Return what they come to."""
        return Scatter(self.values, self.errors)

    @property
    def mean(self) -> float:
        """Give the mean over the tests."""
        return self.scatter.mean

    @property
    def deviation(self) -> float | None:
        """Return the standard deviation of the tests, divided by n − 1; None of a single one."""
        return self.scatter.deviation

    @property
    def uncertainty(self) -> float | None:
        """Standard uncertainty of `mean`: the larger of those by the scatter and by the tests' own."""
        return self.scatter.error

    @property
    def weighted(self) -> tuple[float, float, float] | None:
        """Return the mean by 1/u² of the tests, its standard uncertainty, and Birge's ratio.

        None where an uncertainty is not known, and of a single test.
        """
        return self.scatter.weighted

    def _worst(self, unit: str, factor: float = 1.0) -> list[Row]:
        """Declare every test beside what the others say of it, and the worst of several."""
        tests = [
            PairTest(f"test.{k}", {}, {"": Value(factor * value, error and factor * error)})
            for k, (value, error) in enumerate(zip(self.values, self.errors, strict=True), 1)
        ]
        data = [datum for datum, _ in RepeatedNumber("", tuple(tests), (), {}, unit=unit).data]
        rows = [Row("each by others", "headline", headline(data)), Row("", "data", [d.entry for d in data])]
        return rows if data else []

    def _weighted(self, unit: str, *, factor: float = 1.0, scientific: bool = False) -> list[Row]:
        """Declare the mean by the uncertainties of several tests themselves. unit: end of its key."""
        if self.weighted is None:
            return []
        mean, error, ratio = self.weighted
        note = f"by 1/u² of each; the tests scatter {ratio:.2g} times as much as their uncertainties say"
        how: Any = {"error": (f"weighted_uncertainty{unit}", factor * error), "scientific": scientific}
        row = Row("weighted", f"weighted_mean{unit}", factor * mean, note=note, **how)
        return [row, Row("", "birge_ratio", ratio)]


@dataclass(frozen=True, kw_only=True, repr=False)
class CalibratedTests(Repeated):
    """Hold what each of several tests came to, and the mean of the number that they were made for.

    Attributes
    ----------
    tests : dict
        ``test.1`` and so on -> what the same function makes of it alone.
    headlines : tuple of Row
        The number of each, with its standard uncertainty.
    """

    tests: Mapping[str, Report]
    headlines: tuple[Row, ...]

    @property
    def values(self) -> tuple[float, ...]:
        """Give the number of every test, in the unit that its key in `numbers` ends in."""
        return tuple(row.value for row in self.headlines)

    @property
    def errors(self) -> tuple[float | None, ...]:
        """Give its standard uncertainty of every test, from those of what was measured."""
        return tuple(row.uncertainty[1] for row in self.headlines)

    def _title(self) -> str:
        return f"{self.headlines[0].label} of {counted(len(self.tests), 'test')}"

    def __repr__(self) -> str:
        return f"<{self._title()}: {self._rows()[0].text}>"

    def _rows(self) -> list[Row]:
        row, unit = self.headlines[0], self.headlines[0].ending
        note = "" if self.uncertainty is None else f"(standard uncertainty{self.scatter.source})"
        scatter = Row("scatter", f"standard_deviation{unit}", self.deviation, digits=2)
        mean = replace(row, value=self.mean, error=self.uncertainty, note=note)
        more = *self._weighted(unit), *self._worst(row.units)
        return [mean, scatter, *more, Row("", "tests", self._table())]

    def _table(self) -> list[list[Row]]:
        named = zip(self.tests, self.headlines, strict=True)
        return [[Row("", "name", name), replace(row, label=name)] for name, row in named]


def each_test(
    one: Callable[..., Any], tests: Tests, keys: Mapping[str, str], options: Mapping[str, Any]
) -> CalibratedTests:
    """Calibrate each of the tests in which was measured what is needed.

    one: calibrates a test by its options. keys: of a test -> option. options: of all tests; the conditions of
    a study or a result among them hold. Raises InputError.
    """
    given = {name: value for name, value in options.items() if value is not None}
    study = given.get("study")
    if "result" in given:
        with opened(given["result"]) as result:
            study = result.study
    names = {key: name for key, name in keys.items() if study is None or key not in CONDITIONS}
    alike = {key: given.pop(name) for key, name in names.items() if name in given}
    measured = names.keys() - {*CONDITIONS}
    for key in measured & alike.keys():
        raise InputError(f"--{names[key]} and a list of tests exclude each other: the list has it")
    offset = given.get("ploughing", study.friction.ploughing if study else 0.0)
    found: dict[str, Any] = {}
    headlines = []
    for named, test in checked_tests(tests, **alike).items():
        if study is not None:
            check_conditions(test, named, study)
        values = {key: value for key in names if (value := getattr(test, key)) is not None}
        if not measured & values.keys():
            continue
        if test.friction and test.friction.at:
            raise InputError(f"{named}.friction is at a distance: allowed is that of the whole test")
        numbers = {key: value for key, value in values.items() if isinstance(value, Value)}
        values |= {key: number.value for key, number in numbers.items()}
        with reworded({f"--{name}": f"{named}.{key}" for key, name in names.items()}):
            found[named] = one(**given, **{names[key]: value for key, value in values.items()})
            row = found[named].headline
        of = {key: n.value - offset * (key == "friction") for key, n in numbers.items()}
        shares = [row.value * n.error / of[key] for key, n in numbers.items() if n.error]
        headlines.append(replace(row, error=math.hypot(row.uncertainty[1] or 0.0, *shares) or None))
    if not found:
        raise InputError(f"what was measured is missing: one of {', '.join(sorted(measured))}")
    return CalibratedTests(tests=found, headlines=tuple(headlines))
