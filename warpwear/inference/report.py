"""What an inference leaves in its folder: samples, table, figures, a calibrated study, and a page with all of
it.
"""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from warpwear.errors import InputError
from warpwear.figures import style as fs
from warpwear.inference.result import Inference
from warpwear.inference.unknowns import Unknown
from warpwear.page.html import embedded, render
from warpwear.results.report import to_json

#: Correlation of two unknowns from which a sweep takes joint draws: distributions would be independent.
JOINT = 0.5
#: Runs of the sweep in the calibrated study.
SAMPLES = 64
CAPTIONS = {
    "course": "The computed coefficient of friction after the test, with its band of 90 %, and what was "
    "measured.",
    "corner": "The unknowns by pairs: lines enclose 50 and 90 % of the samples. On the diagonal each "
    "alone; dashed its prior.",
}


def write_report(found: Inference, folder: Path) -> list[Path]:
    """Write posterior.csv, posterior.json, calibrated.toml, figures/ and inference.html; return what was
    written.
    """
    keys, data = list(found.values), found.posterior.data
    with (folder / "posterior.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        units = {unknown.key: unknown.unit for unknown in found.posterior.unknowns}
        writer.writerow([f"{key} [{units[key]}]" if units[key] else key for key in keys])
        writer.writerows(
            [[repr(float(v)) for v in row] for row in np.array([found.values[key] for key in keys]).T]
        )
    (folder / "posterior.json").write_text(to_json(content_of(found)) + "\n", encoding="utf-8")
    (folder / "calibrated.toml").write_text(calibrated(found), encoding="utf-8")
    names = ["course", "corner"] if data.distance.size else ["corner"]
    drawn = {name: found.plot(name) for name in names}
    (folder / "figures").mkdir(exist_ok=True)
    pictures = {name: folder / "figures" / f"{name}.png" for name in drawn}
    for name, figure in drawn.items():
        fs.write_figure(figure, pictures[name])
    page = render(
        "inference.html",
        {"number": _shown},
        title=found.study.study.name,
        rows=found.table,
        computed=found.computed(),
        sentences=found.sentences,
        tests=found.tests,
        target=found.target,
        how=found.how,
        notes=[(course.name, course.notes) for course in data.courses]
        + [("data", data.notes)] * bool(data.notes),
        keys=[row["key"] for row in found.table],
        correlations=[[float(value) for value in row] for row in found.correlations],
        pictures=[(embedded(figure), CAPTIONS[name]) for name, figure in drawn.items()],
        calibrated=calibrated(found),
    )
    (folder / "inference.html").write_text(page, encoding="utf-8")
    texts = ("posterior.csv", "posterior.json", "calibrated.toml", "inference.html")
    return [*(folder / name for name in texts), *pictures.values()]


def content_of(found: Inference) -> dict[str, Any]:
    """Return all numbers of an inference, ready for JSON."""
    return {
        "study": found.study.study.name,
        "unknowns": found.table,
        "correlations": found.correlations.tolist(),
        "measured": found.computed(),
        "sentences": found.sentences,
        "indistinct": [list(group.keys) for group in found.identified.indistinct],
        "untouched": list(found.identified.untouched),
        "target": found.target,
        "next_tests": [
            {"test": t.label, "relative_now": t.now, "relative_expected": t.expected} for t in found.tests
        ],
        "more_tests_to_10_percent": dict(found.repeats),
        "samples": {
            "effective": found.samples.effective,
            "r_hat": found.samples.r_hat,
            "steps": found.samples.steps,
        },
        "runs": len(found.posterior.model.runs.rows),
        "emulator_error": found.posterior.model.error,
    }


def calibrated(found: Inference) -> str:
    """Return the study with the medians of its unknowns, and a section [sweep] over their uncertainty, as
    TOML.

    Unknowns that go together are drawn together: a list of joint draws instead of distributions.
    """
    unknowns = found.posterior.model.unknowns
    medians = {u.key: u.text(float(np.median(found.values[u.key]))) for u in unknowns}
    try:
        study = found.study.replace(medians)
    except InputError as error:
        return f"# No study can have the medians of the unknowns: {error}\n"
    count = len(unknowns)
    apart = np.abs(found.correlations[:count, :count] - np.eye(count)).max() < JOINT
    if apart:
        vary: dict[str, Any] = {u.key: _distribution(u, found) for u in unknowns}
        section: dict[str, Any] = {"design": "sobol", "samples": SAMPLES}
        told = "# The unknowns hardly go together: each has a distribution of its own.\n"
    else:
        vary = {u.key: [u.text(float(v)) for v in found.values[u.key][:SAMPLES]] for u in unknowns}
        section = {"design": "zip", "band_over": [u.key for u in unknowns]}
        told = f"# The unknowns go together: {SAMPLES} joint draws of the posterior.\n"
    head = "# Calibrated by `warpwear calibrate bayes`: medians, and below their uncertainty for a sweep.\n"
    return head + study.to_toml() + "\n" + told + tomli_w.dumps({"sweep": section | {"vary": vary}})


def _shown(value: float) -> str:
    """Write a number of the page in three digits, a small or large one with its power of ten."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:.3g}"
    first, power = f"{value:.2e}".split("e")
    return f"{first}·10{str(int(power)).translate(fs.RAISED)}"


def _distribution(unknown: Unknown, found: Inference) -> str:
    """Write a posterior as a distribution of a sweep."""
    column = found.values[unknown.key]
    mean, deviation = float(column.mean()), float(column.std())
    if unknown.least >= 0.0 and mean > 0.0 and (unknown.is_logarithmic or mean < 4.0 * deviation):
        kind, cut = "log-normal", ""
    else:
        kind = "normal"
        cut = (
            ""
            if mean > 5.0 * deviation
            else f" within {max(unknown.least, float(column.min())):.6g} .. {float(column.max()):.6g}"
        )
    return f"{kind} {mean:.6g} +- {deviation:.3g}{cut} {unknown.unit}".rstrip()
