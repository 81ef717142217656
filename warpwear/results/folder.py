"""A folder of results is held by one process while it is written, and written whole or not at all."""

import os
import platform
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any

from warpwear import lazy
from warpwear.errors import OTHER_FOLDER, InputError, explained

filelock = lazy.module("filelock")

#: File on whose lock of the operating system a process holds a folder; it is free when that process is gone.
LOCK = ".warpwear.lock"
#: How long a lock is waited for [s]: another process may look whether the folder is free.
PATIENCE = 0.3


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder for this process alone. Raises InputError where another one does, OSError."""
    lock, path = _locked(folder), folder / LOCK
    try:
        with suppress(OSError):  # some systems keep a locked file from being written
            path.write_text(f"process {os.getpid()} on {platform.node()}", encoding="utf-8")
        yield
    finally:
        with suppress(OSError):
            path.unlink()  # while it is held: who has opened it meanwhile sees that it is gone
        lock.release()


def refuse_if_held(folder: Path) -> None:
    """Raise InputError where another process holds the folder."""
    with suppress(OSError):  # that it cannot be written is told elsewhere
        if (folder / LOCK).exists():
            _locked(folder).release()


def _locked(folder: Path) -> Any:
    """Take the lock of a folder. Raises InputError where another process has it, OSError."""
    path = folder / LOCK
    lock = filelock.FileLock(path, timeout=PATIENCE)
    try:
        return lock.acquire().lock
    except filelock.Timeout:
        owner = "another process"
        with suppress(OSError):
            owner = path.read_text(encoding="utf-8", errors="replace")[:80] or owner
        raise InputError(
            f"out = {folder} is in use by another run ({owner}); give another folder (out), or wait for it."
        ) from None


def check_writable(folder: Path) -> None:
    """Raise InputError unless files can be written into a folder of this name; leave nothing behind."""
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected")
    with explained(f"out = {folder} cannot be written"), tempfile.TemporaryFile(dir=_inside(folder)):
        pass


def check_folder(folder: Path, marks: Sequence[str], *, what: str, overwrite: bool) -> None:
    """Raise InputError unless files may be written into the folder; leave nothing behind.

    marks: names of files that every one of its kind has. what: 'a report', for the sentence. overwrite:
    whether one that is there may be replaced.
    """
    check_writable(folder)
    if folder.is_dir() and any(folder.iterdir()):
        if not all((folder / mark).is_file() for mark in marks):
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected")
        if not overwrite:
            raise InputError(f"out = {folder} already holds {what}; {OTHER_FOLDER}")


@contextmanager
def whole_folder(folder: Path, marks: Sequence[str], *, stale: Iterable[str] = ()) -> Iterator[Path]:
    """Give an empty work folder, whose files are moved into the folder once all are written.

    marks: names of files to move last. stale: names of files of an older one, which go. What else the folder
    holds stays. Raises InputError where files cannot be written; the folder is then as it was.
    """
    with (
        explained(f"out = {folder} could not be written"),
        held(folder) if folder.is_dir() else nullcontext(),
    ):
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


def _inside(folder: Path) -> Path:
    """Find the folder itself, or the nearest parent that exists."""
    folder = folder.absolute()
    return folder if folder.is_dir() else next(parent for parent in folder.parents if parent.is_dir())
