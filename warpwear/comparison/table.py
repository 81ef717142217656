"""The table of a comparison: for the terminal, as CSV and as JSON."""

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.comparison.gather import Comparison, RunData, shape_of
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
    return lambda run: run.shape.get(key), lambda experiment: shape_of(experiment).get(key)


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


def columns(comparison: Comparison) -> dict[str, dict[str, Value]]:
    """Find all values: name of a run or an experiment -> by the names of `QUANTITIES` and 'rms_cof NAME'."""
    found: dict[str, dict[str, Value]] = {}
    for run in comparison.runs:
        values: dict[str, Value] = {quantity.name: quantity.of_run(run) for quantity in QUANTITIES}
        values |= {f"rms_cof {e.name}": comparison.rms(run, e) for e in comparison.experiments}
        found[run.name] = {"kind": "run", **values}
    for experiment in comparison.experiments:
        values = {quantity.name: quantity.of_experiment(experiment) for quantity in QUANTITIES}
        found[experiment.name] = {"kind": "experiment", **values}
    return found


def to_text(comparison: Comparison) -> str:
    """Write table and notes for a terminal: a line a quantity, a column a run or an experiment."""
    table = columns(comparison)
    labels = {quantity.name: _label(quantity) for quantity in QUANTITIES}
    labels |= {f"rms_cof {e.name}": f"CoF − {e.name} (rms)" for e in comparison.experiments}
    cells = [["", *table]]
    for key, label in labels.items():
        values = [values.get(key) for values in table.values()]
        if any(value is not None for value in values):
            cells.append([label, *map(_shown, values)])
    told = []
    if comparison.experiments:
        told.append("CoF at the end of an experiment: mean over the last tenth of its distance.")
    if any(run.study.is_swept for run in comparison.runs):
        told.append(PASSES)
    return "\n".join([*aligned(cells), *told, SHAPES, *(f"note: {note}" for note in comparison.notes)])


def write_csv(comparison: Comparison, path: Path) -> None:
    """Write a row a run or an experiment, with units in the header."""
    names = {quantity.name: quantity.units for quantity in QUANTITIES}
    names |= {f"rms_cof {e.name}": "1" for e in comparison.experiments}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["name", "kind", *(f"{name} [{units}]" for name, units in names.items())])
        for name, values in columns(comparison).items():
            cells = [without_nan(values.get(key)) for key in names]
            shown = ["" if v is None else _quoted(v) if isinstance(v, str) else f"{v:.12g}" for v in cells]
            writer.writerow([_quoted(name), values["kind"], *shown])


def _quoted(text: str) -> str:
    """Put an apostrophe before what a spreadsheet would compute as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def write_json(comparison: Comparison, path: Path) -> None:
    """Write the table with units, notes and where the runs lie."""
    content = {
        "comparison": columns(comparison),
        "folders": {run.name: str(run.folder) for run in comparison.runs},
        "units": {quantity.name: quantity.units for quantity in QUANTITIES},
        "shapes": SHAPES,
        "end_values": {run.name: run.summary["end_values"] for run in comparison.runs},
        "notes": comparison.notes,
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
