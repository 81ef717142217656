"""What an inference found: samples of the unknowns, what they mean and predict, and the folder it leaves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from warpwear.calibration.bayes import figures
from warpwear.calibration.bayes.identify import ALL_APART, CONFLICT, DRAWS, Identified, computed
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.next_test import MOST_REPEATS, REACHED, Candidate
from warpwear.calibration.bayes.runs import other_surfaces
from warpwear.calibration.bayes.sampler import Samples, split_of, spread_of
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.ensembles.table import write_csv
from warpwear.errors import InputError
from warpwear.figures.describe import Figure
from warpwear.figures.paint import paint
from warpwear.figures.wording import counted, short
from warpwear.grid import FloatArray
from warpwear.history.quantities import printed
from warpwear.page.folder import Content
from warpwear.page.folder import write_report as write_folder
from warpwear.page.html import embedded, render
from warpwear.results import manifest
from warpwear.results.ensemble import band
from warpwear.results.formats.forms import filled
from warpwear.results.frames import package
from warpwear.results.report import aligned, to_json
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
#: File of the study with what was inferred, and of one that misses the data.
CALIBRATED, FITTED = "calibrated.toml", "fitted.toml"
#: File of the samples.
SAMPLES_FILE = "posterior.csv"
#: Correlation of two unknowns from which a sweep takes joint draws: distributions would be independent.
JOINT = 0.5
#: Runs of the sweep in the calibrated study.
SAMPLES = 64


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
        said: dict[str, Any] = {"pulled": [(unknown, off) for unknown, off in pulled if off > PULLED]}
        said["known"] = {key: 100.0 * half / middle for key, (middle, half, _) in spreads.items()}
        said |= {"groups": self._in_two_groups, "reached": f"{100 * REACHED:.0f}", "most": MOST_REPEATS}
        text = filled("inference.txt", escape=False, inference=self, wider=_wider, **said)
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

    def plot(self, name: str) -> Any:
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

    def declared(self, name: str) -> Figure:
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


def write_report(inference: Inference, folder: Path) -> list[Path]:
    """Write posterior.csv, posterior.json, calibrated.toml, figures/ and inference.html; return the files.

    The study is fitted.toml instead where it misses the data.
    """
    studies, text = (CALIBRATED, FITTED), calibrated(inference)
    study, other = reversed(studies) if inference.misses else studies
    names = ["course", "corner"] if inference.posterior.data.distance.size else ["corner"]
    figures = {name: inference.declared(name) for name in names}
    files: dict[str, Content] = {
        SAMPLES_FILE: partial(write_samples, inference.posterior.unknowns, inference.values),
        "posterior.json": to_json(content_of(inference)) + "\n",
        study: text,
        "inference.html": _page(inference, figures, study=study, text=text),
    }
    (folder / other).unlink(missing_ok=True)  # of an inference before, in the same folder
    return write_folder(folder, figures, files=files, within=manifest.FIGURES)


def _page(inference: Inference, figures: Mapping[str, Figure], *, study: str, text: str) -> str:
    """Fill the page. study, text: name and content of the file of the study."""
    data = inference.posterior.data
    content: dict[str, Any] = {"inference": inference, "written": study, "calibrated": text}
    content["notes"] = [(c.name, c.notes) for c in data.courses] + [("data", data.notes)] * bool(data.notes)
    content["pictures"] = {name: embedded(figure) for name, figure in figures.items()}
    return render("inference.html", {"number": lambda value: short(float(f"{value:.3g}"))}, **content)


def write_samples(unknowns: Sequence[Unknown], values: Mapping[str, FloatArray], path: Path) -> None:
    """Write samples of the posterior as CSV. values: key -> (samples,)."""
    units = {unknown.key: f" [{unknown.unit}]" if unknown.unit else "" for unknown in unknowns}
    write_csv({f"{key}{units[key]}": column.tolist() for key, column in values.items()}, path)


def content_of(inference: Inference) -> dict[str, Any]:
    """Return all numbers of an inference, ready for JSON."""
    names = {"test": "label", "tests": "repeats", "relative_now": "now", "relative_expected": "expected"}
    tests = [{key: getattr(test, name) for key, name in names.items()} for test in inference.tests]
    return {
        "study": inference.study.study.name,
        "unknowns": inference.table,
        "correlations": inference.correlations.tolist(),
        "measured": inference.computed(),
        "sentences": inference.sentences,
        "indistinct": [list(group.keys) for group in inference.identified.indistinct],
        "untouched": list(inference.identified.untouched),
        "hardly_told": list(inference.identified.hardly),
        "target": inference.target,
        "next_tests": tests,
        "more_tests_to_10_percent": inference.more_tests,
        "samples": {name: getattr(inference.samples, name) for name in ("effective", "r_hat", "steps")},
        "runs": len(inference.posterior.model.runs.rows),
        "emulator_error": inference.posterior.model.error,
    }


def calibrated(inference: Inference) -> str:
    """Return the study with the medians of its unknowns, and a [sweep] over their uncertainty, as TOML.

    Unknowns that go together are drawn together: a list of joint draws instead of distributions.
    """
    unknowns = inference.posterior.model.unknowns
    medians = {u.key: u.text(float(np.median(inference.values[u.key]))) for u in unknowns}
    try:
        study = inference.study.replace(medians)
        if inference.misses:  # every run of it says so
            name, text = inference.study.study.name, inference.study.study.description
            misses = f"FITTED TO DATA THAT IT MISSES, not calibrated. {inference.conflicts[0]} {text}".strip()
            named = {"study.name": f"{name[:70]} - misses its data", "study.description": misses}
            study = study.replace(named)
    except InputError as error:
        return f"# No study can have the medians of the unknowns: {error}\n"
    count = len(unknowns)
    apart = np.abs(inference.correlations[:count, :count] - np.eye(count)).max() < JOINT
    surfaces = other_surfaces(study, SAMPLES) if inference.posterior.model.runs.inputs else {}
    if apart:
        vary: dict[str, Any] = {u.key: _distribution(u, inference) for u in unknowns}
        section: dict[str, Any] = {"design": "sobol", "samples": SAMPLES}
    else:
        vary = {u.key: [u.text(float(v)) for v in inference.values[u.key][:SAMPLES]] for u in unknowns}
        section = {"design": "zip", "band_over": [*(u.key for u in unknowns), *surfaces]}
    tables = tomli_w.dumps({"sweep": section | {"vary": vary | surfaces}})
    said: dict[str, Any] = {"apart": apart, "samples": SAMPLES, "inference": inference, "tables": tables}
    return filled("calibrated.txt", escape=False, study=study.to_toml(), **said)


def _distribution(unknown: Unknown, inference: Inference) -> str:
    """Write a posterior as a distribution of a sweep."""
    column = inference.values[unknown.key]
    mean, deviation, _ = spread_of(column)
    kind, cut = "normal", ""
    if unknown.least >= 0.0 and mean > 0.0 and (unknown.prior.is_logarithmic or mean < 4.0 * deviation):
        kind = "log-normal"
    elif mean <= 5.0 * deviation:
        cut = f" within {max(unknown.least, float(column.min())):.6g} .. {float(column.max()):.6g}"
    return f"{kind} {mean:.6g} +- {deviation:.3g}{cut} {unknown.unit}".rstrip()
