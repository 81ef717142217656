"""Write the table of a comparison: for the terminal, as CSV and as JSON."""

import csv
import statistics
from collections.abc import Sequence
from pathlib import Path

from warpwear.comparison.gather import Comparison, shape_of
from warpwear.comparison.groups import RunData
from warpwear.comparison.scar import lines_of, record_of
from warpwear.history.end_values import ENDS, Value
from warpwear.measured.experiment import Experiment
from warpwear.results.report import aligned, quoted, shown, to_json, without_nan
from warpwear.version import __version__

SHAPES = (
    "m and λ are of the coefficient of friction: exponent of its growth over the second half of the "
    "distance, and its slope there over the early slope. For a run of constant shear strength without "
    "ploughing they are those of the area that shears (area_shape in summary.json)."
)
#: Said where a run is swept.
PASSES = (
    "Of swept runs area in contact, mean pressure and CoF at the end are means of the last cycle; m, λ and "
    "differences from an experiment (rms) are of the means of whole passes."
)

#: Said where groups have several runs.
BANDS = "Of several runs: mean ± standard deviation; figures show the mean and a band of 5 to 95 % of them."
#: Smaller numbers are shown as 0 in the terminal.
ROUND_OFF = 1.0e-12
#: Columns of values -> their units, without those of experiments.
UNITS = {name: quantity.units for name, quantity in ENDS.items()}


def columns(comparison: Comparison, *, scatter: bool = False) -> dict[str, dict[str, Value]]:
    """Find all values: name of a group or an experiment -> by the names of end values and 'rms_cof NAME'.

    Of several runs they are means over those that have a value, or with scatter standard deviations, None of
    fewer than two.
    """
    of_several = _scatter if scatter else _mean
    table: dict[str, dict[str, Value]] = {}
    for group in comparison.groups:
        each = [_of_run(run, comparison) for run in group.runs]
        values = {name: of_several([row[name] for row in each]) for name in each[0]}
        table[group.name] = {"kind": "run", "runs": len(group.runs), **values}
    for e in comparison.experiments:
        values = dict.fromkeys(ENDS) | ({} if scatter else _of_experiment(e))
        table[e.name] = {"kind": "experiment", "runs": None, **values}
    return table


def _of_run(run: RunData, comparison: Comparison) -> dict[str, Value]:
    """Find the end values of a run, and how it differs from each experiment."""
    values = {name: getattr(run.summary, name) for name in ENDS}
    return values | {f"rms_cof {e.name}": comparison.rms(run, e) for e in comparison.experiments}


def _of_experiment(experiment: Experiment) -> dict[str, Value]:
    """Find the end values that a measured course has."""
    distance, steps = float(experiment.distance[-1]), experiment.distance.size
    return {"distance": distance, "steps": steps, "cof": experiment.final_cof, **shape_of(experiment)}


def _mean(values: Sequence[Value]) -> Value:
    """Return the value of one run; of several the mean of numbers, and words as often as they differ."""
    known = list(dict.fromkeys(value for value in values if value is not None))
    if len(known) < 2:
        return known[0] if known else None
    numbers = [value for value in values if isinstance(value, int | float)]
    return statistics.fmean(numbers) if numbers else ", ".join(map(str, known))


def _scatter(values: Sequence[Value]) -> Value:
    """Return the standard deviation of two numbers or more."""
    numbers = [value for value in values if isinstance(value, int | float)]
    return statistics.stdev(numbers) if len(numbers) > 1 else None


def has_bands(comparison: Comparison) -> bool:
    """Tell whether any group has several runs."""
    return any(len(group.runs) > 1 for group in comparison.groups)


def to_text(comparison: Comparison) -> str:
    """Write table and notes for a terminal: a line a quantity, a column a group of runs or an experiment."""
    table, scatter = columns(comparison), columns(comparison, scatter=True)
    bands = has_bands(comparison)
    labels = {"runs": "runs"} if bands else {}
    labels |= {name: f"{q.label}, {q.unit}".removesuffix(", ") for name, q in ENDS.items()}
    labels |= {f"rms_cof {e.name}": f"CoF − {e.name} (rms)" for e in comparison.experiments}
    cells = [["", *table]]
    for key, label in labels.items():
        values = [table[name].get(key) for name in table]
        if any(value is not None for value in values):
            errors = [scatter[name].get(key) if key != "runs" else None for name in table]
            factor = ENDS[key].factor if key in ENDS else 1.0
            cells.append([label, *(with_scatter(*both, factor) for both in zip(values, errors, strict=True))])
    sentences = [BANDS] if bands else []
    if comparison.experiments:
        sentences.append("CoF at the end of an experiment: mean over the last tenth of its distance.")
    if any(run.study.is_swept for run in comparison.runs):
        sentences.append(PASSES)
    if comparison.scar is not None:
        sentences += lines_of(comparison.scar)
    notes = [f"note: {note}" for note in comparison.notes]
    return "\n".join([*aligned(cells), *sentences, SHAPES, *notes])


def write_csv(comparison: Comparison, path: Path) -> None:
    """Write a row a group of runs or an experiment, with units in the header.

    Where groups have several runs, also standard deviations, the number of runs and their folders.
    """
    names = UNITS | {f"rms_cof {e.name}": "1" for e in comparison.experiments}
    table, scatter = columns(comparison), columns(comparison, scatter=True)
    folders = {group.name: [str(run.folder) for run in group.runs] for group in comparison.groups}
    header = ["name", "kind", *(f"{name} [{units}]" for name, units in names.items())]
    if bands := has_bands(comparison):
        header += [*(f"{name}_std [{units}]" for name, units in names.items()), "runs", "folders"]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for name, values in table.items():
            cells = [values.get(key) for key in names]
            if bands:
                cells += [scatter[name].get(key) for key in names]
                cells += [values["runs"], "; ".join(folders.get(name, []))]
            cells = [without_nan(cell) for cell in cells]
            written = ["" if v is None else quoted(v) if isinstance(v, str) else f"{v:.12g}" for v in cells]
            writer.writerow([quoted(name), values["kind"], *written])


def write_json(comparison: Comparison, path: Path) -> None:
    """Write the table with units, notes and where the runs lie."""
    content = {
        "comparison": columns(comparison),
        "standard_deviation": columns(comparison, scatter=True) if has_bands(comparison) else {},
        "groups": {group.name: [run.name for run in group.runs] for group in comparison.groups},
        "folders": {run.name: str(run.folder) for run in comparison.runs},
        "units": UNITS,
        "shapes": SHAPES,
        "end_values": {run.name: run.summary.end_values for run in comparison.runs},
        "notes": comparison.notes,
        "scar": None if comparison.scar is None else record_of(comparison.scar),
        "version": __version__,
    }
    path.write_text(f"{to_json(content)}\n", encoding="utf-8")


def with_scatter(value: Value, scatter: Value, factor: float) -> str:
    """Write a value for people with its standard deviation; round-off is 0, and left out of the latter."""
    if not isinstance(value, float):
        return shown(value)
    text = "0" if abs(value) <= ROUND_OFF else shown(factor * value)
    if isinstance(scatter, float) and scatter > 1e-9 * abs(value):
        return f"{text} ± {factor * scatter:.2g}"
    return text
