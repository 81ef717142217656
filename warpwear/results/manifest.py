"""What runs wrote into a folder, file by file: no other file in there is ever replaced or deleted."""

import json
import os
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePath
from uuid import uuid4

NAME = "manifest.json"
FIGURES = "figures"
#: The run's own page, which shows its figures and so goes with them.
PAGE = "report.html"
#: Key of the names; a file of that name by another program has none.
WRITTEN = "written_by_warpwear"


def written(folder: Path) -> set[str]:
    """Names, relative to the folder, of the files that runs wrote there: empty where no manifest says so."""
    try:
        names = json.loads((folder / NAME).read_text(encoding="utf-8"))[WRITTEN]
        return {NAME, *(name for name in names if _is_inside(folder, PurePath(name)))}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return set()


def write(folder: Path, names: Iterable[str], *, work: Path | None = None) -> None:
    """Replace the manifest as a whole. work: a folder of the same disk to write it in first."""
    with replacing(folder / NAME, work=work) as new:
        new.write_text(json.dumps({WRITTEN: sorted({*names} - {NAME})}, indent=2), encoding="utf-8")


@contextmanager
def replacing(path: Path, *, work: Path | None = None) -> Iterator[Path]:
    """Give a name to write a file under, which then replaces `path` at once, or goes where writing failed.

    work: a folder of the same disk to write it in; the file's own by default, under a hidden name.
    """
    new = (work or path.parent) / f".{path.stem}-{uuid4().hex[:8]}{path.suffix}"
    try:
        yield new
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


def set_aside(path: Path) -> None:
    """Give another name to a file that no run wrote and one is about to replace, and warn of it."""
    if os.path.lexists(path):
        other = path.with_name(f"{path.stem}-{uuid4().hex[:6]}{path.suffix}")
        path.rename(other)
        warnings.warn(f"{path} was not written by a run: it is {other.name} now.", stacklevel=3)


def add_figure(path: Path) -> None:
    """Note a figure that was drawn into a run's own folder of figures, and no other."""
    if path.parent.name == FIGURES and not path.parent.is_symlink():
        add(path.parent.parent, f"{FIGURES}/{path.name}")


def add(folder: Path, name: str) -> None:
    """Note a file that was written into a run's own folder beside what the run wrote, and no other."""
    names = written(folder)
    if names:
        with suppress(OSError):  # it stays when the run is replaced
            write(folder, {*names, name})


def remove(folder: Path, names: Iterable[str]) -> None:
    """Delete files that are in the manifest, as far as they are still there."""
    for name in names:
        if _is_inside(folder, PurePath(name)) and not (folder / name).is_dir():
            (folder / name).unlink(missing_ok=True)


def _is_inside(folder: Path, name: PurePath) -> bool:
    """Whether a name is of a file in the folder or its figures, and not by way of a link."""
    parts = name.parts
    if len(parts) == 2:
        return parts[0] == FIGURES and parts[1] != ".." and not (folder / FIGURES).is_symlink()
    return len(parts) == 1 and not name.is_absolute() and name.name not in ("", "..")
