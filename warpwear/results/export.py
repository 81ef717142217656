"""Results as files that other software opens: one table of formats, one way to write them all."""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any

from warpwear.errors import InputError, explained
from warpwear.laws.archard import BODIES
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import TRACK, WRITABLE, ExportedBody, Files, Job
from warpwear.results.formats.crate import crate_files
from warpwear.results.formats.metrology import write_sdf, write_x3p
from warpwear.results.formats.netcdf import netcdf_files
from warpwear.results.formats.stl import write_stl
from warpwear.results.formats.text import csv_files, write_npy, write_xyz
from warpwear.results.formats.vtk import vti_files
from warpwear.results.tables import write_tables
from warpwear.study.units import several

#: Points of a solid along a side, unless others are asked for.
STL_POINTS = 250
#: Fewest points along a side that make a surface.
FEWEST_POINTS = 2
#: Every snapshot, as a word.
EVERY = "all"


@dataclass(frozen=True)
class Format:
    """Describe a format that results are written in.

    files: names the files of a job and what writes them; holds: what stands in them, for people; takes: which
    options change them; packages: what must be installed; every: whether it has all snapshots by default.
    """

    files: Callable[[Job], Files]
    holds: str
    takes: frozenset[str]
    packages: tuple[str, ...] = ()
    every: bool = False


def _bodies(ending: str, write: Callable[[Path, ExportedBody], None], job: Job) -> Files:
    """Name a file for each body and snapshot."""

    def write_body(name: str, number: int, path: Path) -> None:
        write(path, job.body(name, number))

    for number, name in product(job.numbers, job.bodies):
        yield f"{name}_worn{job.suffix(number)}.{ending}", partial(write_body, name, number)


_BODY, _FIELDS = frozenset({"bodies", "points"}), frozenset({"fields"})
#: Name of a format -> the format, in the order in which they are told.
FORMATS: dict[str, Format] = {
    "sdf": Format(partial(_bodies, "sdf", write_sdf), "heights, ISO 25178-71, metres", _BODY, ("sdfio",)),
    "xyz": Format(partial(_bodies, "xyz", write_xyz), "points x y z, mm", _BODY),
    "npy": Format(partial(_bodies, "npy", write_npy), "an array of heights, mm", _BODY),
    "x3p": Format(partial(_bodies, "x3p", write_x3p), "heights, ISO 5436-2, metres", _BODY),
    "stl": Format(partial(_bodies, "stl", write_stl), "closed solids, mm", _BODY),
    "csv": Format(csv_files, "fields, a row a cell, and profiles", _BODY | _FIELDS),
    "vti": Format(vti_files, "fields, bodies and films for ParaView", _BODY | _FIELDS, every=True),
    "netcdf": Format(
        netcdf_files, "history and fields, labelled", _FIELDS, ("xarray", "h5netcdf"), every=True
    ),
    "crate": Format(
        partial(crate_files, write_tables), "the run and its inputs, an RO-Crate in a zip", frozenset({"add"})
    ),
}
#: Formats that are written where none is asked for.
USUAL = ("sdf", "xyz", "npy")


def export(
    result: ResultFile,
    folder: str | Path,
    *,
    formats: Sequence[str] = USUAL,
    snapshot: int | str | Sequence[int | str] | None = None,
    bodies: Sequence[str] | None = None,
    fields: Sequence[str] | None = None,
    points: int | None = None,
    add: Sequence[str | Path] | None = None,
    overwrite: bool = False,
) -> list[Path]:
    """Write a result into a folder, in formats of `FORMATS`; returns the paths, all of them or none written.

    snapshot: a number (-1 is the end), a distance with its unit, "all", or several of these; by default all
    for netcdf and vti, and the end for others. bodies: counter and disc, or of a swept run track. fields:
    of netcdf, vti and csv, by default all. points: most along a side (250 for stl, else every cell), each
    the mean of a block. add: files beside the run in a crate, such as a record. Raises InputError for what
    is unknown, for an option that no format takes, for a package that is missing and for files that are
    there.
    """
    formats, bodies, fields = several(formats), bodies and several(bodies), fields and several(fields)
    options = {"bodies": bodies, "fields": fields, "points": points, "add": add}
    _check_known("format", formats, FORMATS)
    known_bodies = (*BODIES, TRACK) if result.study.is_swept else BODIES
    known_fields = [name for name, quantity in WRITABLE.items() if quantity.applies_to(result.study)]
    _check_known("body", bodies or (), known_bodies)
    _check_known("field", fields or (), known_fields)
    _check_taken({name for name, value in options.items() if value is not None}, formats)
    if points is not None and points < FEWEST_POINTS:
        raise InputError(f"points = {points} make no surface; allowed: {FEWEST_POINTS} or more")
    added = tuple(Path(path) for path in several(add or ()))
    for path in added:
        if not path.is_file():
            raise InputError(f"add = {path} is no file; a record or a surface is expected")
    numbers, folder = numbers_of(result, snapshot), Path(folder)
    which = tuple(bodies or BODIES), tuple(fields or known_fields)
    writers: dict[str, Callable[[Path], None]] = {}
    for name in dict.fromkeys(formats):
        usual = EVERY if FORMATS[name].every else -1
        chosen = numbers if numbers is not None else numbers_of(result, usual) or ()
        job = Job(result, chosen, *which, points or (STL_POINTS if name == "stl" else None), added)
        writers |= dict(FORMATS[name].files(job))
    taken = [name for name in writers if (folder / name).exists()]
    if taken and not overwrite:
        raise InputError(f"out = {folder} already holds {taken[0]}; give another folder, or overwrite it")
    return _write_all(folder, writers)


def _write_all(folder: Path, writers: dict[str, Callable[[Path], None]]) -> list[Path]:
    """Write files beside their places and move them there when all are whole. writers: by name."""
    is_new = not folder.exists()
    try:
        with explained(f"out = {folder} cannot be written"):
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(prefix=".export-", dir=folder) as work:
                for name, write in writers.items():
                    write(Path(work) / name)
                return [(Path(work) / name).replace(folder / name) for name in writers]
    finally:
        if is_new:
            with suppress(OSError):  # unless there is something in it
                folder.rmdir()


def numbers_of(
    result: ResultFile, snapshot: int | str | Sequence[int | str] | None
) -> tuple[int, ...] | None:
    """Find the numbers of the snapshots that are asked for, each once and in their order; None for None.

    Raises InputError for those that are not there.
    """
    if snapshot is None:
        return None
    count, numbers = result.snapshot_distances.size, set[int]()
    for which in [snapshot] if isinstance(snapshot, int | str) else snapshot:
        text = str(which).strip()
        if text == EVERY:
            numbers |= {*range(count)}
        elif not text.lstrip("-").isdecimal():
            numbers.add(result.number_at(text))
        elif -count <= int(text) < count:
            numbers.add(int(text) % count)
        else:
            raise InputError(
                f"snapshot = {which} is not in this result; allowed: 0 to {count - 1}, -1 is the last, a "
                "distance such as '30 mm', or all"
            )
    return tuple(sorted(numbers))


def _check_known(what: str, names: Sequence[str], known: Sequence[str] | dict[str, Any]) -> None:
    for name in names:
        if name not in known:
            raise InputError(f"{what} = '{name}' is not known; allowed: {', '.join(known)}")


def _check_taken(options: set[str], formats: Sequence[str]) -> None:
    """Raise InputError for an option that changes none of the formats, and for a package that is missing."""
    for option in sorted(options):
        if not any(option in FORMATS[name].takes for name in formats):
            takers = ", ".join(name for name, known in FORMATS.items() if option in known.takes)
            raise InputError(f"{option} changes nothing in {', '.join(formats)}; it is for {takers}")
    for name in formats:
        for package in FORMATS[name].packages:
            if find_spec(package) is None:
                raise InputError(f"format = '{name}' needs the package {package}: pip install 'warpwear[io]'")
