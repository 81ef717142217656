"""A file that says which process works in a run folder, and in which work folders inside it."""

import json
import os
import platform
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import psutil

from warpwear.errors import InputError

NAME = ".lock"
#: What names of work folders begin with.
WORK = ".work-"


@contextmanager
def held(folder: Path, work: Sequence[str] = ()) -> Iterator[None]:
    """The folder for this process alone. Raises InputError where another works in it, OSError.

    work: names of work folders inside it that are gone at the end, or may be deleted by who comes next.
    """
    path = folder / NAME
    process = psutil.Process()
    owner = {"pid": process.pid, "started": process.create_time(), "host": platform.node()}
    owner["work"] = list(work)
    for again in (True, False):
        try:
            descriptor = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
            break
        except FileExistsError:
            refuse_if_held(folder)
            if not again:  # another was quicker
                raise InputError(_in_use(folder, "another process")) from None
            path.unlink(missing_ok=True)  # of a process that is gone
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as file:
            json.dump(owner, file)
        yield
    finally:
        path.unlink(missing_ok=True)


def work_folders(folder: Path) -> list[str]:
    """Names of the work folders that the run has, or left, whose lock is in the folder."""
    try:
        names = json.loads((folder / NAME).read_text(encoding="utf-8"))["work"]
        return [name for name in names if name.startswith(WORK) and Path(name).name == name]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []


def forget_other_computers(folder: Path) -> None:
    """Remove the lock of a run on another computer, and what it left, for who knows that it is gone."""
    path = folder / NAME
    try:
        host = json.loads(path.read_text(encoding="utf-8"))["host"]
    except (OSError, ValueError, KeyError, TypeError):
        return
    if host != platform.node():
        for name in work_folders(folder):
            shutil.rmtree(folder / name, ignore_errors=True)
        path.unlink(missing_ok=True)


def refuse_if_held(folder: Path) -> None:
    """Raises InputError where another run works in the folder, or may do so on another computer."""
    path = folder / NAME
    try:
        owner = json.loads(path.read_text(encoding="utf-8"))
        pid, started, host = int(owner["pid"]), float(owner["started"]), str(owner["host"])
    except FileNotFoundError:
        return
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f"out = {folder} is in use by another run, or {path} is left of one that is gone and may be "
            "deleted."
        ) from None
    if host != platform.node():
        raise InputError(f"{_in_use(folder, f'process {pid} on {host}')} If that is gone, delete {path}.")
    if _alive(pid, started):
        raise InputError(_in_use(folder, f"process {pid}"))


def _in_use(folder: Path, who: str) -> str:
    return f"out = {folder} is in use by another run ({who}); give another folder (out), or wait for it."


def _alive(pid: int, started: float) -> bool:
    """Whether that very process runs: numbers of processes are used again."""
    try:
        process = psutil.Process(pid)
        return process.status() != psutil.STATUS_ZOMBIE and abs(process.create_time() - started) < 1.0
    except psutil.NoSuchProcess:
        return False
    except psutil.AccessDenied:
        return True
