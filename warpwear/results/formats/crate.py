"""Pack a run as an RO-Crate in one .zip, with what it was made of: whoever has it makes the run again."""

import tempfile
import tomllib
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from warpwear.errors import InputError
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import Files, Job
from warpwear.results.formats.metadata import FILES, NAME, metadata
from warpwear.study.loading import FILES as KEYS
from warpwear.study.loading import insert, value_of
from warpwear.surfaces.reading import digest_of

#: Name of the file; folders in it: of what the study names, of what was added.
CRATE_NAME, INPUTS, ADDED = "crate.zip", "inputs", "added"
#: What is said of a file that was added.
EXTRA = "Added: a record, a surface or another file beside the run"

#: Writes the tables of a run into a folder.
WriteTables = Callable[[Path, ResultFile], Any]


def crate_files(write_tables: WriteTables, job: Job) -> Files:
    """Name the one file of a result."""
    yield CRATE_NAME, partial(write_crate, write_tables, job)


def write_crate(write_tables: WriteTables, job: Job, path: Path) -> None:
    """Write the run, the surfaces and profiles that its study names, and added files, under relative names.

    Raises InputError for a surface that is gone or has changed since the run, and for added files of a name.
    """
    result = job.result
    sections = tomllib.loads(result.study.to_toml())
    files, notes = dict[str, Path](), dict[str, str]()
    for key in KEYS:
        if isinstance(name := value_of(sections, key), str):
            place = _input(files, Path(name))
            _check_unchanged(result, key, Path(name))
            files[place], notes[place] = Path(name), f"{key} of the study"
            insert(sections, key, place)
    for extra in job.added:
        place = f"{ADDED}/{extra.name}"
        if place in files:
            raise InputError(f"add = {extra}: another added file is called {extra.name}; rename one")
        files[place], notes[place] = extra, EXTRA
    with tempfile.TemporaryDirectory(dir=path.parent) as work:
        folder = result.folder
        if folder is None or not (folder / "summary.json").is_file():
            folder = Path(work)
            write_tables(folder, result)
        run = {name: folder / name for name in FILES if (folder / name).is_file()}
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            texts = {NAME: metadata(result, sections, dict.fromkeys(run, "") | notes)}
            texts["study.toml"] = tomli_w.dumps(sections)
            for name, text in texts.items():
                archive.writestr(name, text)
            for name, source in (run | files).items():
                if name not in texts:
                    archive.write(source, name)


def _input(files: dict[str, Path], source: Path) -> str:
    """Give a file that the study names its place; two of one name have one each."""
    place, number = f"{INPUTS}/{source.name}", 1
    while files.get(place, source) != source:
        number += 1
        place = f"{INPUTS}/{source.stem}-{number}{source.suffix}"
    return place


def _check_unchanged(result: ResultFile, key: str, source: Path) -> None:
    if not source.is_file():
        raise InputError(f"{key} = {source}: the file is gone, and a crate holds it; put it back")
    record = result.record.get("surface", {})
    digest = (record.get("counter", {}) if key.startswith("counter") else record).get("sha256")
    if digest and digest_of(source) != digest:
        raise InputError(f"{key} = {source} is not what the run was made on; put that file back")
