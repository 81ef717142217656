"""Write worn bodies and fields as columns of text and as arrays: .xyz, .npy, .csv."""

from functools import partial
from pathlib import Path

import numpy as np

from warpwear.grid import FloatArray
from warpwear.results.formats.bodies import WRITABLE, ExportedBody, FieldGrid, Files, Job

#: Significant digits of a number in a .csv file, as in the tables of a run folder.
DIGITS = "%.12g"


def write_xyz(path: Path, body: ExportedBody) -> None:
    """Write a line x, y, z for each point that a body has [mm], with tabs between them."""
    x, y = np.meshgrid(body.x, body.y, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), body.heights.ravel()])
    points = points[np.isfinite(points[:, 2])]
    np.savetxt(path, points, fmt="%.9g", delimiter="\t", header="x [mm]\ty [mm]\tz [mm]")


def write_npy(path: Path, body: ExportedBody) -> None:
    """Write the heights of a body alone [mm], shape (nx, ny)."""
    with path.open("wb") as file:
        np.save(file, body.heights)


def csv_files(job: Job) -> Files:
    """Name the tables of a snapshot: its fields, a row a cell, and their profiles through the middle."""
    for number in job.numbers:
        for name in job.sheets:
            yield f"{name}{job.suffix(number)}.csv", partial(_write_fields, job, name, number)
        for along in (True, False):
            name = f"profile_{'along' if along else 'across'}{job.suffix(number)}.csv"
            yield name, partial(_write_profile, job, number, along)


def _write_fields(job: Job, name: str, number: int, path: Path) -> None:
    sheet = job.sheet(name, number)
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as file:
        file.write(_header(sheet, "x", "y"))
        columns = np.empty((sheet.y.size, 2 + len(sheet.fields)))
        columns[:, 1] = sheet.y
        for row, x in enumerate(sheet.x):  # y varies fastest
            columns[:, 0] = x
            for column, values in enumerate(sheet.fields.values(), start=2):
                columns[:, column] = values[row]
            np.savetxt(file, columns, fmt=DIGITS, delimiter=",")


def _write_profile(job: Job, number: int, along: bool, path: Path) -> None:
    """Write the fields along the sliding direction, or across it, through the cells nearest to the middle."""
    sheet = job.sheet("fields", number)
    places, across = (sheet.x, sheet.y) if along else (sheet.y, sheet.x)
    middle = int(np.argmin(np.abs(across)))
    lines: list[FloatArray] = [v[:, middle] if along else v[middle] for v in sheet.fields.values()]
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as file:
        file.write(_header(sheet, "x" if along else "y"))
        np.savetxt(file, np.column_stack([places, *lines]), fmt=DIGITS, delimiter=",")


def _header(sheet: FieldGrid, *axes: str) -> str:
    names = [f"{axis} [mm]" for axis in axes] + [f"{n} [{WRITABLE[n].units}]" for n in sheet.fields]
    return ",".join(names) + "\n"
