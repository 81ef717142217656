"""What an inference leaves in its folder: samples, figures, a calibrated study, and a page with all of it."""

import csv
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from warpwear.calibration.bayes.result import Inference
from warpwear.calibration.bayes.runs import other_surfaces
from warpwear.calibration.bayes.sampler import spread_of
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.errors import InputError
from warpwear.figures.describe import Figure
from warpwear.figures.wording import short
from warpwear.grid import FloatArray
from warpwear.page.folder import Content
from warpwear.page.folder import write_report as write_folder
from warpwear.page.html import embedded, render
from warpwear.results import manifest
from warpwear.results.report import to_json

#: File of the study with what was inferred, and of one that misses the data.
CALIBRATED, FITTED = "calibrated.toml", "fitted.toml"
#: File of the samples.
SAMPLES_FILE = "posterior.csv"
#: Correlation of two unknowns from which a sweep takes joint draws: distributions would be independent.
JOINT = 0.5
#: Runs of the sweep in the calibrated study.
SAMPLES = 64


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
    units = {unknown.key: unknown.unit for unknown in unknowns}
    with path.open("w", newline="", encoding="utf-8", errors="backslashreplace") as file:
        writer = csv.writer(file)
        writer.writerow([f"{key} [{units[key]}]" if units[key] else key for key in values])
        writer.writerows([map(repr, row) for row in np.array([*values.values()]).T.tolist()])


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
        note = "# The unknowns hardly go together: each has a distribution of its own.\n"
    else:
        vary = {u.key: [u.text(float(v)) for v in inference.values[u.key][:SAMPLES]] for u in unknowns}
        section = {"design": "zip", "band_over": [*(u.key for u in unknowns), *surfaces]}
        note = f"# The unknowns go together: {SAMPLES} joint draws of the posterior.\n"
    how = "by `warpwear calibrate bayes`: medians, and below their uncertainty for a sweep."
    head = f"# Calibrated {how}\n"
    if inference.misses:
        why = "".join(f"# {line}\n" for line in inference.conflicts)
        head = f"# FITTED, NOT CALIBRATED: this study misses the data.\n{why}# Fitted {how}\n"
    tables = tomli_w.dumps({"sweep": section | {"vary": vary | surfaces}})
    return head + study.to_toml() + "\n" + note + tables


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
