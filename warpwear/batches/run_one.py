"""One run of a sweep, in whatever process a worker is: found finished, resumed or computed, then read."""

import os
import time
import warnings
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import ConvergenceError, InputError, InvariantError, StudyWarning
from warpwear.grid import FloatArray
from warpwear.history.quantities import columns_of
from warpwear.result import Result
from warpwear.results.ensemble import digests_in, name_of
from warpwear.results.file import FILE_NAME, check_seal, is_one
from warpwear.results.summary import last_values
from warpwear.results.track import course
from warpwear.runs import folder as run_folder
from warpwear.runs.checkpoint import holds_checkpoint
from warpwear.runs.run import RunOptions, run_study
from warpwear.study.study import Study

filelock = lazy.module("filelock")

#: Ending of a file beside a run's folder on which who makes the run holds a lock of the operating system.
LOCK = ".lock"
#: Points of a course that a row keeps.
POINTS = 500


@dataclass(frozen=True)
class RunTask:
    """What a worker is asked for: the study as text, its folder, where to compute it, and on which files.

    files: SHA-256 of each file that the study uses, by the key that names it.
    """

    study: str
    folder: str
    device: str = "cpu"
    threads: int | None = None
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class RunRow:
    """What one run came to: end values by the names of the history, with units, and courses of them."""

    status: str
    seconds: float = 0.0
    ends: dict[str, float] = field(default_factory=dict)
    courses: dict[str, FloatArray] = field(default_factory=dict)
    was_there: bool = False  # the run was finished before it was asked for


def run_one(task: RunTask) -> RunRow:
    """Compute a run, or go on with it, unless its folder holds it finished; a run that fails is a row too."""
    start, folder = time.perf_counter(), Path(task.folder)
    try:
        study = Study.stored(task.study)
        folder.mkdir(parents=True, exist_ok=True)
        with filelock.FileLock(f"{folder}{LOCK}"):  # waits for another sweep that makes the same run
            row = _found(task, study)
            was_there = row is not None
            row = row or _made(task, study)
        return replace(
            row, was_there=was_there, seconds=row.seconds if was_there else time.perf_counter() - start
        )
    except (InputError, ConvergenceError, InvariantError, MemoryError, OSError) as error:
        why = " ".join(str(error).split()) or "the memory ran out"
        return RunRow(f"failed: {why}", time.perf_counter() - start)


def _found(task: RunTask, study: Study) -> RunRow | None:
    """Read the finished run that is asked for by what it carries itself; None where the folder holds none.

    Raises OSError or InputError for a whole one that cannot be read here and now: others may.
    """
    folder = Path(task.folder)
    if not is_there(folder):
        return None
    (folder / FILE_NAME).open("rb").close()
    try:
        stored = Result.open(folder)
    except InputError:
        if _is_whole(folder / FILE_NAME):
            raise
        return None
    with stored as result:
        own = name_of(result.study, device=result.attributes["device"], files=digests_in(result))
        if not result.finished or own != name_of(study, device=task.device, files=task.files):
            return None
        row = row_of(result)
    with suppress(InputError):  # another run is at work there
        run_folder.tidy(folder)
    return row


def _is_whole(path: Path) -> bool:
    """Whether a result is what was written, though it may not be understood."""
    with suppress(InputError):
        check_seal(path)
        return is_one(path)
    return False


def _made(task: RunTask, study: Study) -> RunRow:
    """Make a run or go on with it, in the place of one that is damaged or not what its folder is called."""
    folder = Path(task.folder)
    resume = holds_checkpoint(folder) or not is_there(folder)
    where: Any = {"out": folder, "device": task.device, "threads": task.threads, "files": task.files}
    options = RunOptions(resume=resume, overwrite=not resume, whole=False, **where)
    # What misleads stands in the summary of each run: a thousand of them need not say it on the screen.
    with warnings.catch_warnings(action="ignore", category=StudyWarning), run_study(study, options) as result:
        return row_of(result)


def row_of(result: Result) -> RunRow:
    """Return what a run came to; its seconds are those of its steps."""
    end, columns = last_values(result), columns_of(result.study)
    ends = {f"{column.name} [{column.units}]": end[column.name] for column in columns}
    ends["shear_strength [MPa]"] = end["shear_strength"]
    courses = {column.name: course(result, column.name)[1] for column in columns}
    courses["distance"] = course(result, "distance")[0]
    keep = np.unique(np.linspace(0, courses["distance"].size - 1, POINTS).astype(np.intp))
    thinned = {name: np.asarray(values[keep], dtype=np.float64) for name, values in courses.items()}
    status = "done" if result.finished else "unfinished"
    return RunRow(status, float(result.record["elapsed_s"]), ends, thinned)


def is_there(folder: Path) -> bool:
    """Whether a folder seems to hold a finished run; `run_one` makes sure."""
    return os.path.isfile(folder / FILE_NAME)  # an unreadable folder holds none, and fails alone
