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
from warpwear.results.ensemble import digests_in
from warpwear.results.file import FILE_NAME, ResultFile
from warpwear.results.formats.bodies import Files, Job
from warpwear.results.formats.metadata import FILES, NAME, metadata
from warpwear.study.loading import insert
from warpwear.surfaces.reading import copied

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

    Who made the result may be a stranger, who names what he likes: a file goes in whose bytes have the digest
    that the result carries, and what the user adds by its name. Raises InputError for any other, for a
    surface that is gone or has changed since the run, and for added files of a name.
    """
    result = job.result
    sections, digests = tomllib.loads(result.study.to_toml()), digests_in(result)
    files, notes = dict[str, Path](), dict[str, str]()
    added = {extra.resolve() for extra in job.added}
    keys = dict[str, str]()
    for key, name in result.study.files.items():
        source = Path(name).absolute()
        if not source.is_file():
            raise InputError(f"{key} = {source}: the file is gone, and a crate holds it; put it back")
        if key not in digests and source.resolve() not in added:
            raise InputError(
                f"{key} = {source}: the result does not carry what was in that file, so that it may be any "
                "of yours; add it (--add) if it is what the run was made on"
            )
        place = _input(files, source)
        files[place], notes[place], keys[place] = source, f"{key} of the study", key
        insert(sections, key, place)
    for extra in job.added:
        place = f"{ADDED}/{extra.name}"
        if place in files:
            raise InputError(f"add = {extra}: another added file is called {extra.name}; rename one")
        files[place], notes[place] = extra, EXTRA
    with tempfile.TemporaryDirectory(dir=path.parent) as work:
        folder = result.folder
        if folder is None or result.path != folder / FILE_NAME or not (folder / "summary.json").is_file():
            folder = Path(work)
            write_tables(folder, result)
        run = {name: folder / name for name in FILES if (folder / name).is_file()}
        run |= {FILE_NAME: result.path} if result.path else {}
        if links := [source for source in run.values() if source.is_symlink()]:
            raise InputError(
                f"{links[0]} is a link, which may lead to any file of yours: put the run's own file there"
            )
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            texts = {NAME: metadata(result, sections, dict.fromkeys(run, "") | notes)}
            texts["study.toml"] = tomli_w.dumps(sections)
            for name, text in texts.items():
                archive.writestr(name, text)
            for place, source in files.items():
                key = keys.get(place, "add")
                with copied(source, key=key) as (copy, digest):
                    if digest != digests.get(key, digest):
                        changed = "is not what the run was made on; put that file back"
                        raise InputError(f"{key} = {source} {changed}")
                    archive.write(copy, place)
            for name, source in run.items():
                if name not in texts:
                    archive.write(source, name)


def _input(files: dict[str, Path], source: Path) -> str:
    """Give a file that the study names its place; two of one name have one each."""
    place, number = f"{INPUTS}/{source.name}", 1
    while files.get(place, source) != source:
        number += 1
        place = f"{INPUTS}/{source.stem}-{number}{source.suffix}"
    return place
