"""What an inference found: samples of the unknowns, what they mean, and what they predict."""

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from warpwear.errors import InputError
from warpwear.figures.paint import paint
from warpwear.grid import FloatArray
from warpwear.inference import figures
from warpwear.inference.data import KINDS, SHOWN
from warpwear.inference.identify import Identified
from warpwear.inference.likelihood import Posterior
from warpwear.inference.next_test import MOST_REPEATS, REACHED, NextTest
from warpwear.inference.sampler import Samples
from warpwear.results.ensemble import band
from warpwear.results.report import aligned
from warpwear.study.study import Study

#: Standard uncertainties from which a computed value and a measured one contradict each other.
CONTRADICTION = 3.0
#: Part of the test over which residuals go together from where on the computed course has another shape.
OTHER_SHAPE = 0.5
#: Place near the end of a uniform prior, 2 % of it, and the part of samples beyond, from which it presses.
EDGE, PRESSED = 2.05, 0.2
#: Draws of the posterior predictive.
DRAWS = 400
#: Points of a predicted course.
POINTS = 150
#: Parts of the posterior that a table and a band show [%].
BAND = (5.0, 95.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Inference:
    """The unknowns of a study after a test.

    values: key -> samples (samples,), those of the scatter too; z: the same as numbers that the priors have
    standard normal, (samples, unknowns). conflicts: sentences on what the study cannot bring together.
    target, tests: the unknown that the next test is sought for, and tests ranked. repeats: wear coefficient
    -> how many more tests like this bring it to ± 10 %, None where none do. seed: of the draws.
    """

    posterior: Posterior
    samples: Samples
    values: Mapping[str, FloatArray]
    z: FloatArray
    identified: Identified
    conflicts: tuple[str, ...]
    target: str | None
    tests: tuple[NextTest, ...]
    repeats: Mapping[str, int | None]
    seed: int

    @property
    def study(self) -> Study:
        """The study of the test, as it was given."""
        return self.posterior.model.study

    @property
    def table(self) -> list[dict[str, Any]]:
        """A row an unknown: key, unit, prior, mean, deviation, median, 5th and 95th percentile, learnt.

        learnt: the part of the prior's variance that is gone.
        """
        rows = []
        for place, unknown in enumerate(self.posterior.unknowns):
            column = self.values[unknown.key]
            low, median, high = map(float, np.percentile(column, (BAND[0], 50.0, BAND[1])))
            unit = SHOWN.get(unknown.unit, unknown.unit)
            row: dict[str, Any] = {
                "key": unknown.key,
                "unit": unit,
                "prior": unknown.written.replace(unknown.unit, unit),
            }
            row |= {"assumed": unknown.assumed, "mean": float(column.mean()), "sd": float(column.std(ddof=1))}
            row |= {"median": median, "low": low, "high": high}
            rows.append(row | {"learnt": float(np.clip(1.0 - self.z[:, place].var(), 0.0, 1.0))})
        return rows

    @property
    def correlations(self) -> FloatArray:
        """Correlations of the unknowns in the order of `table`, (unknowns, unknowns)."""
        return np.atleast_2d(np.corrcoef(np.array([self.values[row["key"]] for row in self.table])))

    @property
    def sentences(self) -> list[str]:
        """What a reader has to know beside the table."""
        runs = self.posterior.model.runs
        lines = [*self.conflicts, *self.identified.sentences]
        lines += [runs.cut] if runs.cut else []
        lines += [f"Of the study: {notice}" for notice in self.study.notices()]
        lines += self._at_the_edge
        data, count = self.posterior.data, len(self.posterior.model.unknowns)
        if not data.courses and len(data.values) + len(data.points) <= count:
            lines.append(
                f"There are {count} unknowns for {len(data.values) + len(data.points)} measured values: that "
                "the study agrees with them does not prove it; a course of friction or another value would."
            )
        if len(data.courses) == 1:
            lines.append(
                "One course of friction: scatter between tests is not in these uncertainties; repeated "
                "tests would show it."
            )
        for key, repeats in self.repeats.items():
            now = f"{key} is known to ± {100.0 * self.values[key].std() / self.values[key].mean():.2g} %"
            goal, more = f"± {100 * REACHED:.0f} %", "more test like this brings"
            if repeats == 0:
                lines.append(f"{now}, within {goal}.")
            elif repeats is None:
                lines.append(f"{now}; {MOST_REPEATS} more like it do not bring it to {goal}.")
            else:
                more = more if repeats == 1 else "more tests like this bring"
                lines.append(f"{now}; {repeats} {more} it to {goal}.")
        if self.tests:
            best = self.tests[0]
            lines.append(
                f"For {self.target} the best next test of those listed is {best.label}: ± "
                f"{100 * best.now:.2g} % would become ± {100 * best.expected:.2g} %."
            )
        return lines

    @property
    def _at_the_edge(self) -> list[str]:
        """Say which unknowns press against the end of their prior."""
        lines = []
        for unknown, z in zip(self.posterior.unknowns, self.z.T, strict=True):
            prior = unknown.prior
            for end, side, at in (("lower", -1.0, prior.first), ("upper", 1.0, prior.second)):
                if prior.kind.endswith("uniform") and np.mean(side * z > EDGE) >= PRESSED:
                    allowed = at not in (unknown.least, unknown.most)
                    wider = "a wider one is needed" if allowed else "less is not allowed"
                    lines.append(
                        f"{unknown.key} presses against the {end} end of its prior, {at:.4g}: {wider}."
                    )
        return lines

    @property
    def how(self) -> str:
        """Where the numbers come from, in two sentences."""
        runs, samples = self.posterior.model.runs, self.samples
        count = f"{len(runs.rows)} run{'s' * (len(runs.rows) > 1)}"
        source = f"{count} of the study."
        if runs.scaled:
            source = f"{count}, scaled: area and scar follow from (K_s + K_d) L."
        if runs.inputs:
            source += (
                " What lies between them is interpolated (Gaussian processes), off by "
                f"{100.0 * self.posterior.model.error:.1f} % (each run predicted from the others), which the "
                "uncertainties include."
            )
        if not samples.steps:
            return f"{source} All in closed form."
        agree = f"two ensembles agree, split-R̂ {samples.r_hat:.4f}."
        return f"{source} {samples.effective:.0f} independent samples; {agree}"

    def predictive(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Distances [mm], (points,), and mean, 5th and 95th percentile of friction there, (3, points).

        The third is the band of another test's points, with the scatter of this one, (2, points).
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
        """A row a measured value: what it is, what the study computes, and how far apart they are."""
        return _computed(self.posterior, self._some)

    def plot(self, name: str) -> Figure:
        """Draw "corner" or "course". Raises InputError for another name."""
        if name == "corner":
            return paint(figures.corner(self.posterior.unknowns, self.values))
        if name == "course":
            return paint(figures.course(self.predictive(), self.posterior.data))
        raise InputError(f"'{name}' is no figure of an inference; there are corner and course")

    @property
    def _cells(self) -> list[list[str]]:
        """The table for people, its head first."""
        cells = [["unknown", "mean ± sd", "5 %", "95 %", "unit", "prior", "learnt"]]
        for row in self.table:
            numbers = [f"{row['mean']:.4g} ± {row['sd']:.2g}", f"{row['low']:.4g}", f"{row['high']:.4g}"]
            prior = row["prior"] + " (assumed)" * row["assumed"]
            cells.append([row["key"], *numbers, row["unit"], prior, f"{100 * row['learnt']:.0f} %"])
        return cells

    def __str__(self) -> str:
        """Write table and sentences for the screen."""
        parts = {f"{self.study.study.name}: unknowns after the test": self._cells}
        parts["measured and computed"] = [
            [
                row["what"],
                f"{row['mean']:.4g} ± {row['sd']:.2g} {row['unit']}".rstrip(),
                f"{row['off']:.1f} standard uncertainties apart",
            ]
            for row in self.computed()
        ]
        tests = [
            [test.label, _count_tests(test.repeats), f"± {100 * test.expected:.2g} %"] for test in self.tests
        ]
        now = f"{100 * self.tests[0].now:.2g}" if tests else ""
        last = {f"next tests for {self.target}, now ± {now} %": tests}
        return "\n".join(
            [
                *(line for title, cells in parts.items() for line in _titled(title, cells)),
                *(f"  {sentence}" for sentence in self.sentences),
                *(line for title, cells in last.items() for line in _titled(title, cells)),
                f"  {self.how}",
            ]
        )

    def _repr_html_(self) -> str:
        """Write table and sentences for a notebook."""
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self._cells
        )
        lines = "".join(f"<li>{escape(sentence)}</li>" for sentence in self.sentences)
        return f"<table>{rows}</table><ul>{lines}</ul><p>{escape(self.how)}</p>"

    @property
    def _some(self) -> dict[str, FloatArray]:
        return {key: column[:DRAWS] for key, column in self.values.items()}

    @property
    def _places(self) -> FloatArray:
        """Distances of predictions: from the first that is known to the end."""
        runs, total = self.posterior.model.runs, self.study.sliding.total
        first = max(float(row.courses["distance"][0]) for row in runs.rows)
        return np.linspace(min(first, 0.002 * total) if runs.scaled else first, total, POINTS)


def _titled(title: str, cells: list[list[str]]) -> list[str]:
    """Return the lines of a table under its title; none of an empty one."""
    return [title, *("  " + line for line in aligned(cells))] if cells else []


def _computed(posterior: Posterior, values: Mapping[str, FloatArray]) -> list[dict[str, Any]]:
    """Return a row a measured value; see `Inference.computed`."""
    rows = []
    for measured in (*posterior.data.values, *posterior.data.points):
        if measured.kind == "cof":
            mean = posterior.model.cof(values, np.array([measured.at]))[:, 0]
            variance = np.zeros(len(mean))
        else:
            mean, variance = posterior.model.value(values, measured.kind)
        off = abs(float(mean.mean()) - measured.value) / float(np.sqrt(measured.error**2 + variance.mean()))
        numbers = {"mean": float(mean.mean()), "sd": float(np.sqrt(mean.var() + variance.mean())), "off": off}
        rows.append({"what": measured.text, **numbers, "unit": measured.unit})
    return rows


def conflicts_of(posterior: Posterior, values: Mapping[str, FloatArray]) -> list[str]:
    """Say what the study cannot bring together, in sentences."""
    some = {key: column[:DRAWS] for key, column in values.items()}
    lines = []
    measured = (*posterior.data.values, *posterior.data.points)
    for row, value in zip(_computed(posterior, some), measured, strict=True):
        if row["off"] > CONTRADICTION:
            lines.append(
                f"The study cannot bring all data together: measured is {row['what']}; computed is "
                f"{row['mean']:.3g}, {row['off']:.0f} standard uncertainties apart."
            )
            lines += _scar_by_volume(posterior) if value.kind != "cof" else []
    if lines:
        lines = list(dict.fromkeys(lines))
        lines.append(
            "So either a measurement or the study is wrong, and no value of the unknowns mends it: do not "
            "use the unknowns found before the cause is known. Their uncertainties are too small."
        )
    if posterior.data.courses:
        length = float(np.median(some["noise.length"]))
        longest = max(float(c.distance[-1]) for c in posterior.data.courses)
        if length > OTHER_SHAPE * longest:
            lines.append(
                f"Residuals of friction go together over {length:.3g} mm of {longest:.4g}: the measured "
                "course has another shape than the computed one."
            )
    return lines


def _scar_by_volume(posterior: Posterior) -> list[str]:
    """Say which scar the measured volumes make at rest, where a scar was measured, too."""
    values, model = posterior.data.values, posterior.model
    scars = [value for value in values if value.kind == "diameter"]
    bodies = {value.kind: value for value in values if value.kind.startswith("volume")}
    if not (scars and bodies and model.runs.scaled) or model.runs.inputs:
        return []
    volume = sum(value.value for value in bodies.values())
    size = model.scar_of(volume)
    which = " and ".join(KINDS[kind][1] for kind in bodies)
    return [
        f"The reason: at rest all that wears lies in the scar. The {which}, {volume:.3g} mm³, makes one of "
        f"{size:.2f} mm or more, and measured is {scars[0].value:.2f} mm."
    ]


def _count_tests(number: int) -> str:
    return "1 test" if number == 1 else f"{number} tests"
