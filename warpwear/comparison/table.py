"""Write the table of a comparison: for the terminal, as CSV and as JSON."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from warpwear.comparison.courses import data_by_name, told_of
from warpwear.comparison.groups import RunData
from warpwear.comparison.scar import ScarComparison, lines_of, record_of
from warpwear.ensembles.datum import Datum
from warpwear.ensembles.ensemble import Ensemble
from warpwear.ensembles.page import titled, with_scatter
from warpwear.ensembles.table import write_csv
from warpwear.errors import prose
from warpwear.history.end_values import ENDS, Value
from warpwear.history.quantities import Quantity
from warpwear.results.report import aligned, shown, to_json, without_nan
from warpwear.version import __version__

#: How it is read.
TEXTS = prose("reports")["compare"]
#: Columns of values -> their units, without those of experiments.
UNITS = {name: quantity.units for name, quantity in ENDS.items()}


@dataclass(frozen=True, eq=False)
class Comparison(Ensemble[RunData]):
    """Hold runs in groups, experiments, what is to be said about them, and a measured scar beside theirs."""

    notes: tuple[str, ...] = ()
    scar: ScarComparison | None = None

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Return all end values, and the differences from each experiment, by the names of columns."""
        names = {f"rms_cof {e.name}": f"CoF − {e.name} (rms)" for e in self.experiments}
        names |= {f"rms_constant {e.name}": f"a constant − {e.name} (rms)" for e in self.experiments}
        rms = {name: replace(ENDS["cof"], name=name, label=label) for name, label in names.items()}
        return ENDS | rms

    @property
    def data(self) -> dict[str, list[Datum]]:
        """Set each measured course beside each group of runs, a row a datum, by the names of both."""
        return data_by_name(self.groups, self.experiments)

    @property
    def readings(self) -> list[str]:
        """Say how the table is read: of bands, and of swept runs."""
        is_swept = any(run.study.is_swept for run in self.rows)
        return [TEXTS["bands"]] * self.has_bands + [TEXTS["passes"]] * is_swept


def values_of(comparison: Comparison, *, scatter: bool = False) -> dict[str, dict[str, Value]]:
    """Find all values: name of a group or an experiment -> by the names of end values and 'rms_cof NAME'.

    Of several runs they are means over those that have a value, or with scatter standard deviations, None of
    fewer than two.
    """
    table: dict[str, dict[str, Value]] = {}
    for group in comparison.all_groups:
        of = group.deviation if scatter else group.mean
        table[group.name] = {"kind": group.kind, "runs": group.count}
        table[group.name] |= {name: of(name) for name in comparison.quantities}
    return table


def to_text(comparison: Comparison) -> str:
    """Write table and notes for a terminal: a line a quantity, a column a group of runs or an experiment."""
    groups = comparison.all_groups
    cells = [["", *(group.name for group in groups)]]
    if comparison.has_bands:
        cells.append(["runs", *(shown(group.count) for group in groups)])
    for name, quantity in comparison.quantities.items():
        if any(group.mean(name) is not None for group in groups):
            cells.append([titled(quantity), *(with_scatter(group, quantity) for group in groups)])
    sentences = comparison.readings
    if comparison.experiments:
        sentences.append("CoF at the end of an experiment: mean over the last tenth of its distance.")
    if comparison.scar is not None:
        sentences += lines_of(comparison.scar)
    notes = [f"note: {note}" for note in comparison.notes]
    return "\n".join([*told_of(comparison.data), *aligned(cells), *sentences, TEXTS["shapes"], *notes])


def write_table(comparison: Comparison, path: Path) -> None:
    """Write a row a group of runs or an experiment, with units in the header.

    Where groups have several runs, also standard deviations, the number of runs and their folders.
    """
    groups, units = comparison.all_groups, {n: q.units for n, q in comparison.quantities.items()}
    table: dict[str, list[Any]] = {"name": [g.name for g in groups], "kind": [g.kind for g in groups]}
    table |= {f"{name} [{unit}]": [g.mean(name) for g in groups] for name, unit in units.items()}
    if comparison.has_bands:
        table |= {f"{name}_std [{unit}]": [g.deviation(name) for g in groups] for name, unit in units.items()}
        folders = {group.name: [str(run.folder) for run in group.rows] for group in comparison.groups}
        table["runs"] = [group.count for group in groups]
        table["folders"] = ["; ".join(folders.get(group.name, ())) for group in groups]
    write_csv({name: without_nan(column) for name, column in table.items()}, path)


def write_json(comparison: Comparison, path: Path) -> None:
    """Write the table with units, notes and where the runs lie."""
    content = {
        "comparison": values_of(comparison),
        "standard_deviation": values_of(comparison, scatter=True) if comparison.has_bands else {},
        "groups": {group.name: [run.name for run in group.rows] for group in comparison.groups},
        "folders": {run.name: str(run.folder) for run in comparison.rows},
        "units": UNITS,
        "shapes": TEXTS["shapes"],
        "end_values": {run.name: run.summary.end_values for run in comparison.rows},
        "notes": comparison.notes,
        "data": {name: [datum.entry for datum in rows] for name, rows in comparison.data.items()},
        "scar": None if comparison.scar is None else record_of(comparison.scar),
        "version": __version__,
    }
    path.write_text(f"{to_json(content)}\n", encoding="utf-8", errors="backslashreplace")
