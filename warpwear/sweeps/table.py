"""What a sweep came to: a row a run, courses on one grid of distances, bands over groups of runs."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.batches.batch import RUNS
from warpwear.batches.plan import Plan, Point
from warpwear.batches.run_one import RunRow
from warpwear.ensembles.ensemble import Ensemble, EnsembleRow, Group
from warpwear.ensembles.table import write_csv
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES
from warpwear.measured.experiment import Experiment
from warpwear.result import Result
from warpwear.results.ensemble import at, band, is_label
from warpwear.results.formats.netcdf import require_free_space
from warpwear.results.frames import COLUMNS, described, package
from warpwear.study.keys import value_of
from warpwear.study.units import parse
from warpwear.sweeps.indices import Indices, sobol

pandas, xarray = lazy.module("pandas"), lazy.module("xarray")
stats = lazy.module("scipy.stats")

#: Tables of a sweep; every one that has ended has the first.
TABLES = ("table.csv", "table.parquet", "sweep.nc")


@dataclass(frozen=True, eq=False)
class SweepRow(EnsembleRow):
    """Hold what a point of a sweep came to; its end values include those of columns of the history."""

    point: Point
    status: str


@dataclass(eq=False, repr=False)
class SweepResult:
    """The runs of a sweep, in the order of its plan: their table, their courses, bands over groups of them.

    Attributes
    ----------
    plan : Plan
        What was varied; ``plan.groups`` gives label -> numbers of the runs that differ only in the keys of
        band_over.
    rows : list of RunRow
        How each run ended.
    folder : Path or None
        That of the sweep; None where nothing was kept.
    cost : str
        What it would take, of a dry run, whose runs were not made.
    written : list of Path
        Tables, figures and page in the folder.
    """

    plan: Plan
    rows: list[RunRow]
    folder: Path | None = None
    cost: str = ""
    written: list[Path] = field(default_factory=list)

    def __repr__(self) -> str:
        done = sum(row.status == "done" for row in self.rows)
        said = self.cost or f"{done} of {len(self.rows)} runs done"
        return f"<sweep over {', '.join(self.plan.keys)}: {said}>"

    @property
    def table(self) -> dict[str, list[Any]]:
        """Column -> a value a run: `run`, `status`, `seconds` [s], keys by dotted names, end values.

        A key varied is as it was given, text with its unit; `numbers` has it as numbers. The unit of an end
        value stands in its name: "area_contact [mm^2]".
        """
        points = self.plan.points
        table: dict[str, list[Any]] = {
            "run": [point.run for point in points],
            "status": [row.status for row in self.rows],
            "seconds": [round(row.seconds, 3) for row in self.rows],
        }
        table |= {key: [_written(point.values[key]) for point in points] for key in self.plan.keys}
        names = dict.fromkeys(name for row in self.rows for name in row.ends)
        table |= {name: [row.ends.get(name, np.nan) for row in self.rows] for name in names}
        return table

    def open(self, number: int) -> Result:
        """Open the run of a row, with fields and figures.

        Parameters
        ----------
        number : int
            Of the row, counted from 0.

        Returns
        -------
        Result
            The run.

        Raises
        ------
        InputError
            Where there is none: a number beyond the rows, a run that failed, or runs that were not kept.
        """
        names = self.table["run"]
        if not -len(names) <= number < len(names):
            raise InputError(f"the sweep has no run {number}: it has {len(names)}, counted from 0")
        if self.folder is None:
            raise InputError("the runs of this sweep were not kept: give sweep() a folder, out")
        if self.rows[number].status != "done":
            raise InputError(f"run {number} of the sweep {self.rows[number].status}")
        return Result.open(self.folder / RUNS / names[number])

    def to_dataframe(self) -> Any:
        """Return the table.

        Returns
        -------
        pandas.DataFrame
            A row a run.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").DataFrame(self.table)

    def to_xarray(self) -> Any:
        """Return courses and end values.

        Returns
        -------
        xarray.Dataset
            Dimensions run and distance. The keys varied are coordinates of the runs: numbers with their unit
            where they are numbers.

        Raises
        ------
        InputError
            Where xarray is not installed.
        """
        package("xarray", "to_xarray")
        return self._dataset()

    @property
    def distance(self) -> FloatArray:
        """Distances at which all courses are given [mm]: those of the longest run, at most 500."""
        known = [row.courses["distance"] for row in self.rows if row.courses]
        return max(known, key=lambda d: (d[-1], d.size)) if known else np.zeros(0)

    @cached_property
    def runs(self) -> list[SweepRow]:
        """What each run came to, in the order of the plan."""
        rows = []
        for point, row in zip(self.plan.points, self.rows, strict=False):
            ends = {name.partition(" [")[0]: None if math.isnan(v) else v for name, v in row.ends.items()}
            ends |= {f"volume_{body}": ends.get(f"wear_volume_{body}") for body in BODIES}
            distance = row.courses.get("distance", np.zeros(0))
            courses = {name: (distance, values) for name, values in row.courses.items() if name != "distance"}
            rows.append(SweepRow(point.run or f"run {point.number}", ends, courses, point, row.status))
        return rows

    def ensemble(self, experiments: Sequence[Experiment] = ()) -> Ensemble[SweepRow]:
        """Put the runs into the groups of the plan, beside measured courses of friction."""
        groups = self.plan.groups.items()
        members = {label or "all runs": tuple(self.runs[n] for n in numbers) for label, numbers in groups}
        return Ensemble(tuple(Group(label, rows) for label, rows in members.items()), tuple(experiments))

    def courses(self, name: str) -> FloatArray:
        """Return the courses of all runs of a column of the history.

        Parameters
        ----------
        name : str
            Of the column.

        Returns
        -------
        array
            Values over `distance`, shape (runs, distances); NaN where a run has none.
        """
        nowhere = self.distance, np.full(self.distance.size, np.nan)
        return np.array([at(self.distance, *run.courses.get(name, nowhere)) for run in self.runs])

    def ends(self, name: str) -> FloatArray:
        """Return the end values of all runs.

        Parameters
        ----------
        name : str
            Of a column of the history, with or without its unit.

        Returns
        -------
        array
            Of shape (runs,); NaN where a run has none.

        Raises
        ------
        InputError
            For what is no end value.
        """
        names, plain = dict.fromkeys(key for run in self.runs for key in run.ends), name.partition(" [")[0]
        if plain not in names:
            raise InputError(f"'{name}' is no end value; there are {', '.join(names)}.")
        return np.array([run.ends.get(plain) for run in self.runs], np.float64)

    def band(self, name: str, runs: Sequence[int]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return mean and band of a column over some runs.

        Parameters
        ----------
        name : str
            Of a column of the history.
        runs : list of int
            Numbers of rows, such as those of ``plan.groups``.

        Returns
        -------
        tuple of array
            Mean, 5th and 95th percentile, each of shape (distances,).
        """
        return band(self.courses(name)[list(runs)])

    def numbers(self, key: str) -> tuple[FloatArray, str] | None:
        """Return the values of a varied key as numbers.

        Parameters
        ----------
        key : str
            With dots.

        Returns
        -------
        tuple of array and str, or None
            Values in the unit of the key's declaration, and that unit; None where they are words. NaN is what
            no number can be made of, in a point of which no study could be made.
        """
        numbers, unit = np.full(len(self.plan.points), np.nan), ""
        for place, study in ((point.number, point.study) for point in self.plan.points if point.study):
            value = value_of(study.model_dump(), key)
            if isinstance(value, str):
                number, _, unit = value.partition(" ")
                try:
                    value = float(number)
                except ValueError:
                    return None
            if isinstance(value, bool) or not isinstance(value, int | float):
                return None
            numbers[place] = value
        for point in self.plan.points:
            if point.study is None:
                with suppress(ValueError, TypeError, OverflowError):
                    value = point.values[key]
                    numbers[point.number] = parse(value, unit) if unit else float(value)
        return numbers, unit

    def sobol(self, name: str = "cof") -> Indices | None:
        """Return Sobol's indices of an end value.

        Parameters
        ----------
        name : str
            Of the end value.

        Returns
        -------
        Indices or None
            None for a design that does not allow them.

        Raises
        ------
        InputError
            For what is no end value.
        """
        if self.plan.design.kind != "saltelli":
            return None
        return sobol(self.ends(name), len(self.plan.keys))

    def influence_in_words(self, name: str = "cof") -> dict[str, str]:
        """Write `influence` for people: Sobol's total indices with their intervals, cut off at 0 and 1."""
        indices, influence = self.sobol(name), self.influence(name)
        if indices is None:
            return {key: f"{value:.2f}".replace("-", "−") for key, value in influence.items()}
        return {key: indices.total_in_words(self.plan.keys.index(key)) for key in influence}

    def influence(self, name: str = "cof") -> dict[str, float]:
        """Return how strongly each varied key decides an end value.

        Parameters
        ----------
        name : str
            Of the end value.

        Returns
        -------
        dict
            Key -> 0 to 1, largest first: Sobol's total index where the design allows it; else Spearman's rank
            correlation with its sign for keys that are numbers, and for words and seeds the part of the
            variance between their means (η²).

        Raises
        ------
        InputError
            For what is no end value.
        """
        values = self.ends(name)
        indices = self.sobol(name)
        influence = {}
        for place, key in enumerate(self.plan.keys):
            number = self.numbers(key)
            if indices is not None:
                influence[key] = float(indices.total[place])
            elif number is not None and not is_label(key):
                known = np.isfinite(values) & np.isfinite(number[0])
                varies = known.sum() > 2 and np.ptp(values[known]) > 0.0 and np.ptp(number[0][known]) > 0.0
                influence[key] = float(stats.spearmanr(number[0][known], values[known])[0]) if varies else 0.0
            else:
                influence[key] = _between(values, [str(point.values[key]) for point in self.plan.points])
        return dict(sorted(influence.items(), key=lambda item: -abs(item[1])))

    def write_tables(self, folder: Path) -> None:
        """Write `TABLES`, the last two where their packages are installed. Raises OSError."""
        write_csv(self.table, folder / "table.csv")
        try:
            pandas.DataFrame(self.table).to_parquet(folder / "table.parquet", index=False)
            courses = self._dataset()
            require_free_space(folder / "sweep.nc", courses.nbytes)
            courses.to_netcdf(folder / "sweep.nc", engine="h5netcdf")
        except ImportError:  # of what pip install 'warpwear[io]' brings
            return

    def _dataset(self) -> Any:
        names = dict.fromkeys(name for row in self.rows for name in row.courses if name != "distance")
        coordinates: dict[str, Any] = {"distance": ("distance", self.distance, {"units": "mm"})}
        coordinates["run"] = ("run", [run.name for run in self.runs])
        coordinates["status"] = ("run", [row.status for row in self.rows])
        for key in self.plan.keys:
            number = self.numbers(key)
            words = [str(_written(point.values[key])) for point in self.plan.points]
            coordinates[key] = ("run", words) if number is None else ("run", number[0], {"units": number[1]})
        data: dict[str, Any] = {
            name: described(COLUMNS, name, ("run", "distance"), self.courses(name)) for name in names
        }
        for name in dict.fromkeys(name for row in self.rows for name in row.ends):
            plain = name.partition(" [")[0]
            data[f"end_{plain}"] = ("run", self.ends(name), {"units": name.partition("[")[2].rstrip("]")})
        about = {"title": self.plan.study.study.name, "study": self.plan.study.to_toml()}
        return xarray.Dataset(data, coordinates, about)


def _between(values: FloatArray, words: Sequence[str]) -> float:
    """Return the part of the variance of values that lies between the means of groups, η²."""
    known = np.isfinite(values)
    if not known.any() or np.ptp(values[known]) == 0.0:
        return 0.0
    labels = np.array(words)[known]
    values = values[known]
    means = {label: values[labels == label].mean() for label in set(labels)}
    return float(np.var([means[label] for label in labels]) / np.var(values))


def _written(value: Any) -> Any:
    """Write a value for a cell of a table."""
    return value if isinstance(value, int | float | str) else " ".join(map(str, value))
