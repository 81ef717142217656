"""What a run leaves beside its HDF5 file: the study, the history and the summary as text."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import tomli_w

from warpwear.clock import phase
from warpwear.grid import FloatArray
from warpwear.history.quantities import Quantity, columns_of, evolution_columns
from warpwear.results.evolution import surface_evolution
from warpwear.results.file import SURFACE_FILE, ResultFile
from warpwear.results.formats.metadata import write_metadata
from warpwear.results.manifest import replacing
from warpwear.results.report import to_json
from warpwear.results.summary import summarise


def _write_table(path: Path, columns: Sequence[Quantity], table: Mapping[str, FloatArray]) -> None:
    """Write columns of a table as CSV with units in its header. table: name -> values, (steps,)."""
    header = ",".join(f"{column.name} [{column.units}]" for column in columns)
    rows = np.column_stack([table[column.name] for column in columns])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.12g")


def write_tables(folder: Path, result: ResultFile) -> None:
    """Write study.toml, history.csv, surface.csv, summary.json and metadata into a folder."""
    sections = result.study.to_toml()
    if result.owns_surface:  # beside it, wherever the folder is moved
        content = tomllib.loads(sections)
        content["disc"]["surface"] = SURFACE_FILE
        sections = tomli_w.dumps(content)
    (folder / "study.toml").write_text(sections, encoding="utf-8", errors="backslashreplace")
    _write_table(folder / "history.csv", columns_of(result.study), result.history)
    with phase("evolution"):
        evolution = surface_evolution(result)
    _write_table(folder / "surface.csv", evolution_columns(result.study), evolution.table)
    write_summary(folder, result)
    write_metadata(folder, result)


def write_summary(folder: Path, result: ResultFile) -> None:
    """Write summary.json into a folder, at once in place of an older one."""
    with replacing(folder / "summary.json") as new:
        new.write_text(f"{to_json(summarise(result))}\n", encoding="utf-8", errors="backslashreplace")
