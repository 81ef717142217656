"""One run of a sweep, in whatever process a worker is: found finished, resumed or computed, then read."""

import os
import time
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import ConvergenceError, InputError, InvariantError, StudyWarning
from warpwear.grid import FloatArray
from warpwear.history.quantities import columns_of
from warpwear.result import Result
from warpwear.results.file import FILE_NAME
from warpwear.results.track import course
from warpwear.runs.checkpoint import holds_checkpoint
from warpwear.runs.run import RunOptions, run_study
from warpwear.study.study import Study

filelock = lazy.module("filelock")

#: Ending of a file beside a run's folder on which who makes the run holds a lock of the operating system.
LOCK = ".lock"
#: Points of a course that a row keeps.
POINTS = 500


@dataclass(frozen=True)
class Task:
    """What a worker is asked for: the study as text, its folder, where to compute it, and on which surface.

    surface: SHA-256 of the file of the surface.
    """

    study: str
    folder: str
    device: str = "cpu"
    threads: int | None = None
    surface: str | None = None


@dataclass(frozen=True)
class Row:
    """What one run came to: end values by the names of the history, with units, and courses of them."""

    status: str
    seconds: float = 0.0
    ends: dict[str, float] = field(default_factory=dict)
    courses: dict[str, FloatArray] = field(default_factory=dict)
    was_there: bool = False  # the run was finished before it was asked for


def run_one(task: Task) -> Row:
    """Compute a run, or go on with it, unless its folder holds it finished; a run that fails is a row too."""
    start, folder = time.perf_counter(), Path(task.folder)
    try:
        study = Study.stored(task.study)
        folder.mkdir(parents=True, exist_ok=True)
        with filelock.FileLock(f"{folder}{LOCK}"):  # waits for another sweep that makes the same run
            was_there = is_there(folder) and not holds_checkpoint(folder)
            try:
                row = _row_of_run(task, study, resume=True)
            except InputError:
                row = None
                if not was_there:
                    raise
            if row is None and was_there:  # damaged, or of another surface under this name
                was_there, row = False, _row_of_run(task, study, resume=False)
            if row is None:
                (folder / FILE_NAME).unlink()
                raise InputError(
                    f"disc.surface '{study.disc.file}' is not the file any more that the sweep was "
                    "planned with; start the sweep again"
                )
        return replace(
            row, was_there=was_there, seconds=row.seconds if was_there else time.perf_counter() - start
        )
    except (InputError, ConvergenceError, InvariantError, MemoryError, OSError) as error:
        why = " ".join(str(error).split()) or "the memory ran out"
        return Row(f"failed: {why}", time.perf_counter() - start)


def _row_of_run(task: Task, study: Study, *, resume: bool) -> Row | None:
    """Make a run, or find it; None where its surface is not that of the task."""
    where: Any = {"out": Path(task.folder), "device": task.device, "threads": task.threads}
    options = RunOptions(resume=resume, overwrite=not resume, whole=False, **where)
    # What misleads stands in the summary of each run: a thousand of them need not say it on the screen.
    quiet = warnings.catch_warnings(action="ignore", category=StudyWarning)
    with quiet, run_study(study, options) as result:
        is_read = study.study.model != "macro" and task.surface is not None
        if is_read and result.record["surface"].get("sha256") != task.surface:
            return None
        return row_of(result)


def row_of(result: Result) -> Row:
    """What a run came to; its seconds are those of its steps."""
    summary, history = result.summary, result.history
    columns = [column for column in columns_of(result.study) if column.name != "distance"]
    ends = {"distance [mm]": summary["distance_mm"]}
    ends |= {f"{column.name} [{column.units}]": float(history[column.name][-1]) for column in columns}
    of_summary = {
        "cof [1]": summary["cof"]["end"],
        "approach [mm]": 1.0e-3 * summary["approach_um"],
        **{f"area_{name} [mm^2]": value for name, value in summary["area_mm2"].items()},
        **{f"pressure_{name} [MPa]": value for name, value in summary["pressure_MPa"].items()},
        "shear_strength [MPa]": summary["shear_strength_MPa"],
    }
    ends |= {name: np.nan if value is None else float(value) for name, value in of_summary.items()}
    courses = {"distance": course(result, "distance")[0]}
    courses |= {column.name: course(result, column.name)[1] for column in columns}
    keep = np.unique(np.linspace(0, courses["distance"].size - 1, POINTS).astype(np.intp))
    thinned = {name: np.asarray(values[keep], dtype=np.float64) for name, values in courses.items()}
    status = "done" if result.finished else "unfinished"
    return Row(status, float(result.record["elapsed_s"]), ends, thinned)


def is_there(folder: Path) -> bool:
    """Whether a folder seems to hold a finished run; `run_one` makes sure."""
    return os.path.isfile(folder / FILE_NAME)  # an unreadable folder holds none, and fails alone
