"""A folder of results is held by one process while it is written, and written whole or not at all."""

import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path

from warpwear import lazy
from warpwear.errors import OTHER_FOLDER, InputError, explained

if sys.platform != "win32":
    import fcntl

filelock = lazy.module("filelock")

#: File on whose lock of the operating system a process holds a folder; it is free when that process is gone.
LOCK = ".warpwear.lock"
#: It may be deleted meanwhile, so the folder itself is locked, too, where that can be.
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
        lock.close()


def refuse_if_held(folder: Path) -> None:
    """Raise InputError where another process holds the folder."""
    with suppress(OSError):  # that it cannot be written is told elsewhere
        if (folder / LOCK).exists():
            _locked(folder).close()
        elif folder.is_dir():
            with ExitStack() as lock:
                _lock_itself(folder, lock)


def _locked(folder: Path) -> ExitStack:
    """Take the lock of a folder. Raises InputError where another process has it, OSError."""
    with ExitStack() as lock:
        try:
            lock.enter_context(filelock.FileLock(folder / LOCK, timeout=PATIENCE))
        except filelock.Timeout:
            raise _in_use(folder) from None
        _lock_itself(folder, lock)
        return lock.pop_all()


def _lock_itself(folder: Path, lock: ExitStack) -> None:
    """Lock a folder, not a file in it, with a lock. Raises InputError where another process has it."""
    if sys.platform != "win32":
        place = os.open(folder, os.O_RDONLY)
        lock.callback(os.close, place)
        try:
            fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise _in_use(folder) from None
        except OSError:  # there are file systems without
            return


def _in_use(folder: Path) -> InputError:
    owner = "another process"
    with suppress(OSError):
        owner = (folder / LOCK).read_text(encoding="utf-8", errors="replace")[:80] or owner
    return InputError(
        f"out = {folder} is in use by another run ({owner}); give another folder (out), or wait for it."
    )


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
