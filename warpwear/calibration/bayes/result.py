"""What an inference found: samples of the unknowns, what they mean, and what they predict."""

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from warpwear.calibration.bayes import figures
from warpwear.calibration.bayes.identify import ALL_APART, CONFLICT, DRAWS, Identified, computed
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.next_test import MOST_REPEATS, REACHED, Candidate
from warpwear.calibration.bayes.sampler import Samples, split_of, spread_of
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.errors import InputError
from warpwear.figures import describe
from warpwear.figures.paint import paint
from warpwear.figures.wording import counted
from warpwear.grid import FloatArray
from warpwear.history.quantities import printed
from warpwear.results.ensemble import band
from warpwear.results.formats.forms import filled
from warpwear.results.frames import package
from warpwear.results.report import aligned
from warpwear.study.study import Study

#: Place near the end of a uniform prior, 10 % of it, and the part of samples beyond, from which it presses.
EDGE, PRESSED = 1.2816, 0.3
#: Standard deviations of a normal prior from its mean to that of the samples, from which it binds.
PULLED = 2.0
#: A wider prior of a logarithm reaches farther by this factor, another by its width.
FARTHER = 5.0
#: Points of a predicted course.
POINTS = 150
#: Parts of the posterior that a table and a band show [%].
BAND = (5.0, 95.0)


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Inference:
    """Hold the unknowns of a study after a test.

    Attributes
    ----------
    values : dict
        Key -> samples, shape (samples,), those of the scatter too.
    z : array
        The same as numbers that the priors have standard normal, shape (samples, unknowns).
    posterior, samples, identified : Posterior, Samples, Identified
        The density, what was drawn of it, and what can be told apart.
    conflicts : tuple of str
        Sentences on what the study cannot bring together.
    target : str or None
        The unknown that the next test is sought for.
    tests : tuple of Candidate
        Tests ranked for it.
    repeats : dict
        Wear coefficient -> how many more tests like this bring it to ± 10 %, None where none do.
    seed : int
        Of the draws.
    """

    posterior: Posterior
    samples: Samples
    values: Mapping[str, FloatArray]
    z: FloatArray
    identified: Identified
    conflicts: tuple[str, ...]
    target: str | None
    tests: tuple[Candidate, ...]
    repeats: Mapping[str, int | None]
    seed: int

    @property
    def study(self) -> Study:
        """The study of the test, as it was given."""
        return self.posterior.model.study

    @property
    def table(self) -> list[dict[str, Any]]:
        """A row an unknown: key, unit, prior, mean, deviation, median, 5th and 95th percentile, learnt.

        learnt: the part of the prior's variance that is gone; pressed: whether that is so because the prior
        ends there.
        """
        rows = []
        pressing = {unknown.key for unknown, _ in self.pressing}
        for place, unknown in enumerate(self.posterior.unknowns):
            column = self.values[unknown.key]
            low, median, high = map(float, np.percentile(column, (BAND[0], 50.0, BAND[1])))
            unit = printed(unknown.unit)
            prior = str(unknown.prior).replace(unknown.unit, unit)
            row: dict[str, Any] = {"key": unknown.key, "unit": unit, "prior": prior}
            row |= {"assumed": unknown.assumed, "mean": float(column.mean()), "sd": float(column.std(ddof=1))}
            row |= {"median": median, "low": low, "high": high}
            row["learnt"] = float(np.clip(1.0 - self.z[:, place].var(), 0.0, 1.0))
            rows.append(row | {"pressed": unknown.key in pressing})
        return rows

    def to_dataframe(self) -> Any:
        """Return the unknowns as a table.

        Returns
        -------
        pandas.DataFrame
            A row an unknown, as of `table`.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").DataFrame(self.table)

    @property
    def correlations(self) -> FloatArray:
        """Return correlations of the unknowns in the order of `table`, (unknowns, unknowns)."""
        return np.atleast_2d(np.corrcoef(np.array([self.values[row["key"]] for row in self.table])))

    @property
    def sentences(self) -> list[str]:
        """What a reader has to know beside the table."""
        apart = [line for line in self.identified.sentences if not (self.misses and line == ALL_APART)]
        z_of = zip(self.posterior.unknowns, self.z.T, strict=True)
        pulled = [(u, abs(z.mean())) for u, z in z_of if not u.prior.kind.endswith("uniform")]
        spreads = {key: spread_of(self.values[key]) for key in self.more_tests}
        text = filled(
            "inference.txt",
            escape=False,
            inference=self,
            pulled=[(unknown, off) for unknown, off in pulled if off > PULLED],
            groups=self._in_two_groups,
            known={key: 100.0 * half / middle for key, (middle, half, _) in spreads.items()},
            reached=f"{100 * REACHED:.0f}",
            most=MOST_REPEATS,
            wider=_wider,
        )
        return [*self.conflicts, *apart, *filter(None, text.splitlines())]

    @property
    def more_tests(self) -> dict[str, int | None]:
        """Keep of `repeats` what data tell: nothing of a study that misses them, or the prior decides."""
        told = self.identified
        apart = {key for group in told.indistinct for key in group.keys}
        by_prior = apart | {*told.untouched, *told.hardly, *(unknown.key for unknown, _ in self.pressing)}
        return {} if self.misses else {k: count for k, count in self.repeats.items() if k not in by_prior}

    @property
    def _in_two_groups(self) -> list[tuple[str, float, str]]:
        """Unknowns with two groups of values, the percentage of the smaller one, and where it lies."""
        groups = []
        for key, column in self.values.items():
            if lower := split_of(column, self.samples.effective):
                x, count = np.sort(column), column.size
                few, side = min(
                    (lower, f"up to {x[lower - 1]:.3g}"), (count - lower, f"from {x[lower]:.3g} on")
                )
                groups.append((key, 100 * few / count, side))
        return groups

    @property
    def misses(self) -> bool:
        """Whether the study contradicts what was measured, so that its values are fitted, not calibrated."""
        return bool(self.conflicts) and self.conflicts[0].startswith(CONFLICT)

    @property
    def pressing(self) -> list[tuple[Unknown, str]]:
        """Unknowns whose uniform prior ends where they would go on, each with the end."""
        ends = (("lower", -1.0), ("upper", 1.0))
        return [
            (unknown, end)
            for unknown, z in zip(self.posterior.unknowns, self.z.T, strict=True)
            for end, side in ends
            if unknown.prior.kind.endswith("uniform") and np.mean(side * z > EDGE) >= PRESSED
        ]

    @property
    def how(self) -> str:
        """Where the numbers come from, in two sentences."""
        return filled("inferred.txt", escape=False, inference=self)

    def predictive(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Predict the course of friction.

        Returns
        -------
        distance : array
            Distances [mm], shape (points,).
        course : array
            Mean, 5th and 95th percentile of friction there, shape (3, points).
        band : array
            That of another test's points, with the scatter of this one, shape (2, points).
        """
        distance = self._places
        some = self._some
        cof = self.posterior.model.cof(some, distance)
        with_scatter = cof
        if "noise.deviation" in some:
            random = np.random.default_rng(self.seed + 2)
            deviation = np.hypot(some["noise.deviation"], some.get("noise.repeat", np.zeros(len(cof))))
            with_scatter = cof + (deviation * random.standard_normal(len(cof)))[:, None]
        return distance, np.array(band(cof)), np.array(band(with_scatter))[1:]

    def computed(self) -> list[dict[str, Any]]:
        """Set what the study computes beside each measured value.

        Returns
        -------
        list of dict
            A row a measured value: what it is, what the study computes, and how far apart they are.
        """
        return computed(self.posterior, self._some)

    def plot(self, name: str) -> Figure:
        """Draw a figure.

        Parameters
        ----------
        name : {"corner", "course"}
            The unknowns against each other, or the course of friction.

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        InputError
            For another name.
        """
        return paint(self.declared(name))

    def declared(self, name: str) -> describe.Figure:
        """Declare a figure.

        Parameters
        ----------
        name : {"corner", "course"}
            As of `plot`.

        Returns
        -------
        Figure
            What the painters draw.

        Raises
        ------
        InputError
            For another name.
        """
        if name == "corner":
            return figures.corner(self.posterior.unknowns, self.values)
        if name == "course":
            return figures.course(self.predictive(), self.posterior.data)
        raise InputError(f"'{name}' is no figure of an inference; there are corner and course")

    @property
    def cells(self) -> list[list[str]]:
        """Return the table for people, its head first."""
        cells = [["unknown", "mean ± sd", "5 %", "95 %", "unit", "prior", "learnt"]]
        for row in self.table:
            numbers = [_spread(self.values[row["key"]]), f"{row['low']:.4g}", f"{row['high']:.4g}"]
            prior, part = row["prior"] + " (assumed)" * row["assumed"], 100 * row["learnt"]
            learnt = "at its end" if row["pressed"] else f"{part:.0f} %" if part < 99.5 else "over 99 %"
            cells.append([row["key"], *numbers, row["unit"], prior, learnt])
        return cells

    def __repr__(self) -> str:
        found = (f"{r['key']} = {_spread(self.values[r['key']])} {r['unit']}".rstrip() for r in self.table)
        return f"<inference of '{self.study.study.name}': {', '.join(found)}>"

    def __str__(self) -> str:
        """Write table and sentences for the screen."""
        what = "fitted unknowns of a study that misses its data" if self.misses else "unknowns after the test"
        lines = [*self.conflicts[: self.misses], *_titled(f"{self.study.study.name}: {what}", self.cells)]
        apart, worst = [], 0.0
        for row in self.computed():
            worst = max(worst, row["off"])
            value = f"{row['mean']:.4g} ± {row['sd']:.2g} {row['unit']}".rstrip()
            apart.append([row["what"], value, f"{row['off']:.1f} standard uncertainties apart"])
        lines += _titled(f"measured and computed, the worst {worst:.1f} apart; all were fitted", apart)
        lines += [f"  {sentence}" for sentence in self.sentences[self.misses :]]
        if self.tests and not self.misses:
            tests = [[t.label, counted(t.repeats, "test"), f"± {100 * t.expected:.2g} %"] for t in self.tests]
            lines += _titled(f"next tests for {self.target}, now ± {100 * self.tests[0].now:.2g} %", tests)
        return "\n".join([*lines, f"  {self.how}"])

    def _repr_html_(self) -> str:
        """Write tables and sentences for a notebook."""
        return f"<pre>{escape(str(self))}</pre>"

    @property
    def _some(self) -> dict[str, FloatArray]:
        return {key: column[:DRAWS] for key, column in self.values.items()}

    @property
    def _places(self) -> FloatArray:
        """Distances of predictions: from the first that is known to the end."""
        runs, total = self.posterior.model.runs, self.study.sliding.total
        first = max(float(row.courses["distance"][0]) for row in runs.rows)
        return np.linspace(min(first, 0.002 * total) if runs.scaled else first, total, POINTS)


def _spread(column: FloatArray) -> str:
    """Write samples as mean ± standard deviation, or as what says more of them."""
    middle, half, by_quantiles = spread_of(column)
    return f"{middle:.4g} ± {half:.2g}{' (median, 16 to 84 %)' * by_quantiles}"


def _titled(title: str, cells: list[list[str]]) -> list[str]:
    """Return the lines of a table under its title; none of an empty one."""
    return [title, *("  " + line for line in aligned(cells))] if cells else []


def _wider(unknown: Unknown, end: str) -> str:
    """Write a uniform prior that goes on beyond an end, as far as the key allows."""
    first, second = unknown.prior.first, unknown.prior.second
    if unknown.prior.is_logarithmic:
        low, high = first / FARTHER, second * FARTHER
    else:
        low, high = first - (second - first), second + (second - first)
    ends = (max(low, unknown.least), second) if end == "lower" else (first, min(high, unknown.most))
    return f"{unknown.prior.kind} {ends[0]:.4g} .. {ends[1]:.4g} {unknown.unit}".rstrip()
