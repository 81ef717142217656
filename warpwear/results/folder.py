"""A folder of results that is written whole or not at all."""

import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from warpwear.errors import OTHER_FOLDER, InputError


def check_folder(folder: Path, marks: Sequence[str], *, what: str, overwrite: bool) -> None:
    """Raise InputError unless files may be written into the folder; leave nothing behind.

    marks: names of files that every one of its kind has. what: 'a report', for the sentence. overwrite:
    whether one that is there may be replaced.
    """
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected")
    if folder.is_dir() and any(folder.iterdir()):
        if not all((folder / mark).is_file() for mark in marks):
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected")
        if not overwrite:
            raise InputError(f"out = {folder} already holds {what}; {OTHER_FOLDER}")
    try:
        with tempfile.TemporaryFile(dir=_inside(folder)):
            pass
    except OSError as error:
        raise InputError(f"out = {folder} cannot be written: {error.strerror or error}") from error


@contextmanager
def whole_folder(folder: Path, marks: Sequence[str], *, stale: Iterable[str] = ()) -> Iterator[Path]:
    """Give an empty work folder, whose files are moved into the folder once all are written.

    marks: names of files to move last. stale: names of files of an older one, which go. What else the folder
    holds stays. Raises InputError where files cannot be written; the folder is then as it was.
    """
    try:
        work = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=_inside(folder)))
        try:
            work.chmod(0o755)
            yield work
            if folder.is_dir():
                for name in stale:
                    (folder / name).unlink(missing_ok=True)
                for path in sorted(work.iterdir(), key=lambda path: (path.name in marks, path.name)):
                    path.replace(folder / path.name)
            else:
                folder.parent.mkdir(parents=True, exist_ok=True)
                work.rename(folder)
        finally:
            shutil.rmtree(work, ignore_errors=True)
    except OSError as error:
        raise InputError(f"out = {folder} could not be written: {error.strerror or error}") from error


def _inside(folder: Path) -> Path:
    """Find the folder itself, or the nearest parent that exists."""
    folder = folder.absolute()
    return folder if folder.is_dir() else next(parent for parent in folder.parents if parent.is_dir())
