"""What a run leaves beside its HDF5 file: the study, the history and the summary as text."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import tomli_w

from warpwear.clock import phase
from warpwear.grid import FloatArray
from warpwear.history.quantities import EVOLUTION, Quantity, columns_of
from warpwear.results.evolution import surface_evolution
from warpwear.results.file import SURFACE_FILE, ResultFile
from warpwear.results.formats.metadata import write_metadata
from warpwear.results.manifest import replacing
from warpwear.results.report import Row, record, to_json
from warpwear.results.summary import summarise


def _write_table(path: Path, columns: Sequence[Quantity], table: Mapping[str, FloatArray]) -> None:
    """Write columns of a table as CSV with units in its header. table: name -> values, (steps,)."""
    header = ",".join(f"{column.name} [{column.units}]" for column in columns)
    rows = np.column_stack([table[column.name] for column in columns])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.12g")


def write_tables(folder: Path, result: ResultFile) -> list[Row]:
    """Write study.toml, history.csv, surface.csv, summary.json, metadata; return the summary's rows."""
    sections = result.study.to_toml()
    if result.owns_surface:  # beside it, wherever the folder is moved
        content = tomllib.loads(sections)
        content["disc"]["surface"] = SURFACE_FILE
        sections = tomli_w.dumps(content)
    (folder / "study.toml").write_text(sections, encoding="utf-8")
    _write_table(folder / "history.csv", columns_of(result.study), result.history)
    with phase("evolution"):
        evolution = surface_evolution(result)
    _write_table(folder / "surface.csv", EVOLUTION, evolution.table)
    rows = summarise(result)
    write_summary(folder, rows)
    write_metadata(folder, result)
    return rows


def write_summary(folder: Path, rows: Sequence[Row], seconds: Mapping[str, float] | None = None) -> None:
    """Write summary.json into a folder, at once in place of an older one.

    rows: as of `summarise`. seconds: that the run took by the phase's name, where they are not among these.
    """
    if seconds is not None:
        rows = [*rows[:-1], Row("", "seconds", seconds), rows[-1]]
    with replacing(folder / "summary.json") as new:
        new.write_text(f"{to_json(record(rows))}\n", encoding="utf-8")
