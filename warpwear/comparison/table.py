"""The table of a comparison: for the terminal, as CSV and as JSON."""

import csv
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.comparison.gather import Comparison, RunData, shape_of
from warpwear.measured.course import Experiment
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
class Row:
    """One line of the terminal's table, one column of the CSV file."""

    name: str  # in CSV and JSON
    units: str
    label: str  # in the terminal
    of_run: Callable[[RunData], Value]
    of_experiment: Callable[[Experiment], Value] = lambda experiment: None


def _entry(*keys: str) -> Callable[[RunData], Value]:
    """A number of the run's summary; None where it has none."""

    def of(run: RunData) -> Value:
        found: Any = run.summary
        for key in keys:
            found = (found or {}).get(key)
        return found if isinstance(found, str | int | float) else None

    return of


ROWS = (
    Row("distance", "mm", "sliding distance", _entry("distance_mm"), lambda e: float(e.distance[-1])),
    Row("load", "N", "load", _entry("load_N")),
    Row("cell", "um", "cell", _entry("cell_um")),
    Row("macro_cell", "um", "patches.macro_cell", _entry("patches", "macro_cell_um")),
    Row("macro_patch", "um", "patches.width", _entry("patches", "width_um")),
    Row("steps", "1", "steps", _entry("steps"), lambda e: e.distance.size),
    Row("patch_along", "mm", "patch along", _entry("scar_mm", "along")),
    Row("patch_across", "mm", "patch across", _entry("scar_mm", "across")),
    Row("depth_sphere", "um", "deepest, sphere", _entry("depth_um", "sphere")),
    Row("depth_disc", "um", "deepest, disc", _entry("depth_um", "disc")),
    Row("volume_sphere", "mm^3", "worn, sphere", _entry("volume_mm3", "sphere")),
    Row("volume_disc", "mm^3", "worn, disc", _entry("volume_mm3", "disc")),
    Row("area_contact", "mm^2", "area in contact", _entry("area_mm2", "contact")),
    Row("pressure_mean", "MPa", "mean pressure", _entry("pressure_MPa", "mean")),
    Row("cof", "1", "CoF at the end", _entry("cof", "end"), lambda e: e.final_cof),
    Row("exponent_m", "1", "m", lambda r: r.shape.get("exponent_m"), lambda e: shape_of(e).get("exponent_m")),
    Row(
        "levelling_lambda",
        "1",
        "λ",
        lambda r: r.shape.get("levelling_lambda"),
        lambda e: shape_of(e).get("levelling_lambda"),
    ),
)
#: Smaller numbers are shown as 0 in the terminal.
ROUND_OFF = 1.0e-12
SHOWN_UNITS = {"um": "µm", "mm^2": "mm²", "mm^3": "mm³", "1": ""}


def columns(comparison: Comparison) -> dict[str, dict[str, Value]]:
    """Name of a run or an experiment -> its values by the names of `ROWS` and 'rms_cof NAME'."""
    found: dict[str, dict[str, Value]] = {}
    for run in comparison.runs:
        values: dict[str, Value] = {row.name: row.of_run(run) for row in ROWS}
        values |= {f"rms_cof {e.name}": comparison.rms(run, e) for e in comparison.experiments}
        found[run.name] = {"kind": "run", **values}
    for experiment in comparison.experiments:
        values = {row.name: row.of_experiment(experiment) for row in ROWS}
        found[experiment.name] = {"kind": "experiment", **values}
    return found


def to_text(comparison: Comparison) -> str:
    """The table and the notes for a terminal: a line a quantity, a column a run or an experiment."""
    table = columns(comparison)
    lines: list[list[str]] = [["", *table]]
    for row in ROWS:
        values = [values[row.name] for values in table.values()]
        if any(value is not None for value in values):
            unit = SHOWN_UNITS.get(row.units, row.units)
            lines.append([f"{row.label}, {unit}" if unit else row.label, *map(_shown, values)])
    for experiment in comparison.experiments:
        values = [values.get(f"rms_cof {experiment.name}") for values in table.values()]
        lines.append([f"CoF − {experiment.name} (rms)", *map(_shown, values)])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    told = [
        "  ".join(
            field.ljust(width) if i == 0 else field.rjust(width)
            for i, (field, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    told += ["CoF at the end of an experiment: mean over the last tenth of its distance."] * bool(
        comparison.experiments
    )
    told += [PASSES] * any(run.study.is_swept for run in comparison.runs)
    return "\n".join([*told, SHAPES, *(f"note: {note}" for note in comparison.notes)])


def write_csv(comparison: Comparison, path: Path) -> None:
    """A row a run or an experiment, units in the header."""
    table = columns(comparison)
    measured = [f"rms_cof {e.name}" for e in comparison.experiments]
    names = [*(row.name for row in ROWS), *measured]
    units = {row.name: row.units for row in ROWS}
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["name", "kind", *(f"{name} [{units.get(name, '1')}]" for name in names)])
        for name, values in table.items():
            numbers = (_finite(values.get(key)) for key in names)
            writer.writerow([name, values["kind"], *("" if v is None else f"{v:.12g}" for v in numbers)])


def write_json(comparison: Comparison, path: Path) -> None:
    """The same with units, notes and where the runs lie."""
    table = {
        name: {key: value if isinstance(value, str) else _finite(value) for key, value in values.items()}
        for name, values in columns(comparison).items()
    }
    content = {
        "comparison": table,
        "folders": {run.name: str(run.folder) for run in comparison.runs},
        "units": {row.name: row.units for row in ROWS},
        "shapes": SHAPES,
        "end_values": {run.name: run.summary["end_values"] for run in comparison.runs},
        "notes": comparison.notes,
        "version": __version__,
    }
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def _shown(value: Value) -> str:
    if value is None or isinstance(value, str):
        return value or "–"
    if isinstance(value, int):
        return f"{value:d}"
    return f"{value:.4g}" if abs(value) > ROUND_OFF else "0"


def _finite(value: Value) -> int | float | None:
    """JSON has no infinity and no NaN."""
    return value if isinstance(value, int | float) and math.isfinite(value) else None
