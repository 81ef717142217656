"""The table of a comparison: for the terminal, as CSV and as JSON."""

import csv
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.comparison.gather import Comparison, shape_of, shape_of_run
from warpwear.comparison.groups import RunData
from warpwear.comparison.scar import record_of
from warpwear.comparison.scar import told as told_of_scar
from warpwear.measured.course import Experiment
from warpwear.results.report import aligned, shown, to_json, without_nan
from warpwear.version import __version__

Value = str | int | float | None
SHAPES = (
    "m and λ are of the coefficient of friction: exponent of its growth over the second half of the "
    "distance, and its slope there over the early slope. For a run of constant shear strength without "
    "ploughing they are those of the area that shears (area_shape in summary.json)."
)
#: Said where a run is swept.
PASSES = (
    "Of swept runs area in contact, mean pressure and CoF at the end are means of the last pass; m, λ and "
    "differences from an experiment (rms) are of the means of whole passes."
)


#: Said where groups have several runs.
BANDS = "Of several runs: mean ± standard deviation; figures show the mean and a band of 5 to 95 % of them."


@dataclass(frozen=True)
class Quantity:
    """A line of the terminal's table and a column of the CSV file.

    name, units: in CSV and JSON; label: in the terminal. of_run, of_experiment: find its value, None where
    there is none.
    """

    name: str
    units: str
    label: str
    of_run: Callable[[RunData], Value]
    of_experiment: Callable[[Experiment], Value] = lambda experiment: None


def _entry(*keys: str) -> Callable[[RunData], Value]:
    """Make what finds an entry of a run's summary by its keys; None where it has none."""

    def of(run: RunData) -> Value:
        found: Any = run.summary
        for key in keys:
            found = (found or {}).get(key)
        return found if isinstance(found, str | int | float) else None

    return of


def _of_shape(key: str) -> tuple[Callable[[RunData], Value], Callable[[Experiment], Value]]:
    """Make what finds m or λ of a run and of an experiment; None for a course that is too short."""
    return lambda run: shape_of_run(run).get(key), lambda experiment: shape_of(experiment).get(key)


QUANTITIES = (
    Quantity("distance", "mm", "sliding distance", _entry("distance_mm"), lambda e: float(e.distance[-1])),
    Quantity("load", "N", "load", _entry("load_N")),
    Quantity("cell", "um", "cell", _entry("cell_um")),
    Quantity("macro_cell", "um", "patches.macro_cell", _entry("patches", "macro_cell_um")),
    Quantity("macro_patch", "um", "patches.width", _entry("patches", "width_um")),
    Quantity("steps", "1", "steps", _entry("steps"), lambda e: e.distance.size),
    Quantity("patch_along", "mm", "patch along", _entry("scar_mm", "along")),
    Quantity("patch_across", "mm", "patch across", _entry("scar_mm", "across")),
    Quantity("depth_sphere", "um", "deepest, sphere", _entry("depth_um", "sphere")),
    Quantity("depth_disc", "um", "deepest, disc", _entry("depth_um", "disc")),
    Quantity("volume_sphere", "mm^3", "worn, sphere", _entry("volume_mm3", "sphere")),
    Quantity("volume_disc", "mm^3", "worn, disc", _entry("volume_mm3", "disc")),
    Quantity("area_contact", "mm^2", "area in contact", _entry("area_mm2", "contact")),
    Quantity("pressure_mean", "MPa", "mean pressure", _entry("pressure_MPa", "mean")),
    Quantity("cof", "1", "CoF at the end", _entry("cof", "end"), lambda e: e.final_cof),
    Quantity("cof_input", "1", "CoF that is an input", _entry("cof_input")),
    Quantity("shear_strength", "MPa", "shear strength τ0", _entry("shear_strength_MPa")),
    Quantity("exponent_m", "1", "m", *_of_shape("exponent_m")),
    Quantity("levelling_lambda", "1", "λ", *_of_shape("levelling_lambda")),
)
#: Smaller numbers are shown as 0 in the terminal.
ROUND_OFF = 1.0e-12
SHOWN_UNITS = {"um": "µm", "mm^2": "mm²", "mm^3": "mm³", "1": ""}


def columns(comparison: Comparison, *, scatter: bool = False) -> dict[str, dict[str, Value]]:
    """Find all values: name of a group or an experiment -> by the names of `QUANTITIES` and 'rms_cof NAME'.

    Of several runs they are means over those that have a value, or with scatter standard deviations, None of
    fewer than two.
    """
    taken = _scatter if scatter else _mean
    found: dict[str, dict[str, Value]] = {}
    for group in comparison.groups:
        values: dict[str, Value] = {q.name: taken([q.of_run(run) for run in group.runs]) for q in QUANTITIES}
        for e in comparison.experiments:
            values[f"rms_cof {e.name}"] = taken([comparison.rms(run, e) for run in group.runs])
        found[group.name] = {"kind": "run", "runs": len(group.runs), **values}
    for experiment in comparison.experiments:
        values = {q.name: None if scatter else q.of_experiment(experiment) for q in QUANTITIES}
        found[experiment.name] = {"kind": "experiment", "runs": None, **values}
    return found


def _mean(values: Sequence[Value]) -> Value:
    """The value of one run; of several the mean of numbers, and words as often as they differ."""
    known = list(dict.fromkeys(value for value in values if value is not None))
    if len(known) < 2:
        return known[0] if known else None
    numbers = [value for value in values if isinstance(value, int | float)]
    return statistics.fmean(numbers) if numbers else ", ".join(map(str, known))


def _scatter(values: Sequence[Value]) -> Value:
    """The standard deviation of two numbers or more."""
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
    labels |= {quantity.name: _label(quantity) for quantity in QUANTITIES}
    labels |= {f"rms_cof {e.name}": f"CoF − {e.name} (rms)" for e in comparison.experiments}
    cells = [["", *table]]
    for key, label in labels.items():
        values = [table[name].get(key) for name in table]
        if any(value is not None for value in values):
            errors = [scatter[name].get(key) if key != "runs" else None for name in table]
            cells.append([label, *map(_with_scatter, values, errors)])
    told = [BANDS] if bands else []
    if comparison.experiments:
        told.append("CoF at the end of an experiment: mean over the last tenth of its distance.")
    if any(run.study.is_swept for run in comparison.runs):
        told.append(PASSES)
    if comparison.scar is not None:
        told += told_of_scar(comparison.scar)
    return "\n".join([*aligned(cells), *told, SHAPES, *(f"note: {note}" for note in comparison.notes)])


def write_csv(comparison: Comparison, path: Path) -> None:
    """Write a row a group of runs or an experiment, with units in the header.

    Where groups have several runs, also standard deviations, the number of runs and their folders.
    """
    names = {quantity.name: quantity.units for quantity in QUANTITIES}
    names |= {f"rms_cof {e.name}": "1" for e in comparison.experiments}
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
            shown = ["" if v is None else _quoted(v) if isinstance(v, str) else f"{v:.12g}" for v in cells]
            writer.writerow([_quoted(name), values["kind"], *shown])


def _quoted(text: str) -> str:
    """Put an apostrophe before what a spreadsheet would compute as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def write_json(comparison: Comparison, path: Path) -> None:
    """Write the table with units, notes and where the runs lie."""
    content = {
        "comparison": columns(comparison),
        "standard_deviation": columns(comparison, scatter=True) if has_bands(comparison) else {},
        "groups": {group.name: [run.name for run in group.runs] for group in comparison.groups},
        "folders": {run.name: str(run.folder) for run in comparison.runs},
        "units": {quantity.name: quantity.units for quantity in QUANTITIES},
        "shapes": SHAPES,
        "end_values": {run.name: run.summary["end_values"] for run in comparison.runs},
        "notes": comparison.notes,
        "scar": None if comparison.scar is None else record_of(comparison.scar),
        "version": __version__,
    }
    path.write_text(f"{to_json(content)}\n", encoding="utf-8")


def _label(quantity: Quantity) -> str:
    """Name a quantity with its unit for people."""
    unit = SHOWN_UNITS.get(quantity.units, quantity.units)
    return f"{quantity.label}, {unit}" if unit else quantity.label


def _shown(value: Value) -> str:
    """Write a value for people, round-off as 0."""
    return "0" if isinstance(value, float) and abs(value) <= ROUND_OFF else shown(value)


def _with_scatter(value: Value, scatter: Value) -> str:
    """Write a value with its standard deviation, left out where that is round-off."""
    told = isinstance(scatter, float) and isinstance(value, float) and scatter > 1e-9 * abs(value)
    return f"{_shown(value)} ± {scatter:.2g}" if told else _shown(value)
