"""The folder of a run: what may be written where, and how it gets there whole."""

import os
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from warpwear import lazy
from warpwear.errors import OTHER_FOLDER, OVERWRITE_IT, RESUME_IT, InputError
from warpwear.result import Result
from warpwear.results import file as results
from warpwear.results import manifest
from warpwear.results.ensemble import digests_in
from warpwear.results.file import FILE_NAME, SURFACE_FILE
from warpwear.results.folder import LOCK, check_writable, held, refuse_if_held
from warpwear.results.formats.metadata import NAME as METADATA
from warpwear.runs import checkpoint
from warpwear.runs.order import RunOrder
from warpwear.surfaces.reading import digest_of

table = lazy.module("warpwear.figures.of_run.table")

LOG = "log.txt"
#: Name of a folder in a run folder in which a run makes its files.
WORK = re.compile(r"\.work-[0-9a-f]{12}")
#: What every run writes, beside figures; its result and checkpoint say themselves what they are.
TABLES = ("study.toml", "history.csv", "surface.csv", "summary.json")
NAMES = (*TABLES, METADATA, LOG, manifest.NAME, manifest.PAGE)


def check(folder: Path, *, overwrite: bool, resume: bool) -> None:
    """Raise InputError for a folder that a run must not, or cannot, be written into."""
    check_writable(folder)
    if folder.is_dir():
        refuse_if_held(folder)
        _check_content(folder, overwrite=overwrite, resume=resume)


def _check_content(folder: Path, *, overwrite: bool, resume: bool) -> None:
    stored = folder / checkpoint.FILE_NAME
    if checkpoint.is_one(stored):
        if not (overwrite or resume):
            raise InputError(
                f"out = {folder} holds the checkpoint of an unfinished run; {RESUME_IT}, or {OVERWRITE_IT}."
            )
    elif resume and stored.exists():
        raise InputError(f"{stored} is no checkpoint of warpwear or is damaged; delete or {OVERWRITE_IT}.")
    elif overwrite and results.is_one(folder / FILE_NAME):  # whole or damaged, it is replaced
        pass
    elif _holds_a_run(folder):
        if not resume:
            raise InputError(f"out = {folder} already holds a run; {OTHER_FOLDER}.")
    elif results.is_one(folder / FILE_NAME):  # and is damaged
        Result.open(folder)
    else:
        ours = {LOCK, *manifest.written(folder), *_work_folders(folder)}
        if any(path.name not in ours for path in folder.iterdir()):
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected.")
    _refuse_to_replace(folder)


def _refuse_to_replace(folder: Path) -> None:
    """Raise InputError for a file that the run would replace and no run wrote."""
    figures, ours = folder / manifest.FIGURES, manifest.written(folder)
    if figures.is_symlink():
        raise InputError(f"{figures} is a link; a run draws its figures into its own folder: move it away.")
    foreign = [name for name in NAMES if os.path.lexists(folder / name) and name not in ours]
    drawn = [path for path in figures.glob("*.png") if f"{manifest.FIGURES}/{path.name}" not in ours]
    foreign += [f"{manifest.FIGURES}/{path.name}" for path in drawn if path.stem in table.FIGURES]
    for name, is_one in ((FILE_NAME, results.is_one), (checkpoint.FILE_NAME, checkpoint.is_one)):
        if os.path.lexists(folder / name) and not is_one(folder / name) and name not in ours:
            foreign.append(name)
    if foreign:
        raise InputError(
            f"out = {folder} holds {', '.join(foreign)}, which no run wrote and this one would replace: "
            "move what you want to keep, or give another folder (out)."
        )


def is_finished(folder: Path, order: RunOrder) -> bool:
    """Whether the folder holds the finished run of this order, so that there is nothing to resume.

    Raises InputError for a run of another study, and while another run works there.
    """
    refuse_if_held(folder)
    if checkpoint.is_one(folder / checkpoint.FILE_NAME) or not _holds_a_run(folder):
        return False
    with Result.open(folder) as result:
        finished = result.finished
        free = checkpoint.LABELS if finished else checkpoint.FREE  # of a finished run nothing is made anew
        changed = checkpoint.changed_keys(RunOrder(result.study).keys, order.keys, free=free)
        if changed:
            raise InputError(
                f"out = {folder} holds a run of another study ({', '.join(changed)}); {OTHER_FOLDER}."
            )
        digests = digests_in(result)
    for key, path in order.study.files.items():
        if key in digests and Path(path).is_file() and digest_of(path) != digests[key]:
            raise InputError(f"out = {folder} holds a run on what {path} was before; {OTHER_FOLDER}.")
    if finished and order.heights:
        order.heights.refuse_others(folder)
    if finished:
        tidy(folder)
    return finished


def tidy(folder: Path) -> None:
    """Remove what a run leaves in its folder that was killed when its result was in place."""
    if (left := _work_folders(folder)) or checkpoint.holds_checkpoint(folder):
        with held(folder):
            _clean(folder, left)
            (folder / checkpoint.FILE_NAME).unlink(missing_ok=True)


@contextmanager
def owned(folder: Path | None) -> Iterator[None]:
    """Hold a run folder for this process; one that is new goes again where it stays empty.

    Raises InputError if it cannot be made, or another run works there.
    """
    if folder is None:
        yield
        return
    new = [path for path in (folder.absolute(), *folder.absolute().parents) if not path.exists()]
    try:
        with _errors_in_words(folder):
            folder.mkdir(parents=True, exist_ok=True)
            lock = ExitStack()
            lock.enter_context(held(folder))
        with lock:
            yield
    finally:
        for path in new:
            with suppress(OSError):  # not empty
                path.rmdir()


@contextmanager
def working_in(folder: Path | None, *, overwrite: bool, resume: bool) -> Iterator[Path | None]:
    """Give a work folder inside a run folder that is held; it is gone at the end.

    Raises InputError for a folder that cannot be written, or holds what must not be replaced.
    """
    if folder is None:
        yield None
        return
    with _errors_in_words(folder):
        _check_content(folder, overwrite=overwrite, resume=resume)
        left = _work_folders(folder)
        log = _log_so_far(folder, left) if resume else b""
        _clean(folder, left)
        work = folder / f".work-{uuid4().hex[:12]}"
        work.mkdir()
        try:
            (work / LOG).write_bytes(log)
            yield work
        finally:
            shutil.rmtree(work, ignore_errors=True)


@contextmanager
def _errors_in_words(folder: Path) -> Iterator[None]:
    """Turn an error of the file system into an InputError that says what the folder holds."""
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error)
        if "memory allocation failed" in why:  # HDF5 says it so
            raise MemoryError from error
        unfinished = checkpoint.is_one(folder / checkpoint.FILE_NAME)
        what = f"a checkpoint; {RESUME_IT}" if unfinished else "no run"
        raise InputError(f"out = {folder} could not be written and holds {what}: {why}.") from error


def move_into_place(work: Path, folder: Path) -> None:
    """Move all files of the run, one by one, the sealed result last; others are left alone.

    What the run that is replaced wrote goes, and so does its manifest. A file that came while the run went on
    is kept under another name.
    """
    before, now = manifest.written(folder), {item.name for item in work.iterdir()}
    for name in now - before:
        if not (name == FILE_NAME and results.is_one(folder / name)):
            manifest.set_aside(folder / name)
    manifest.write(folder, before | now, work=work)
    manifest.remove(folder, {name for name in before if "/" in name or name == manifest.PAGE})
    for item in sorted(work.iterdir(), key=lambda item: item.name == FILE_NAME):
        item.replace(folder / item.name)
    if SURFACE_FILE in before - now and not _owns_surface(folder):
        manifest.remove(folder, [SURFACE_FILE])
    manifest.write(folder, {name for name in before | now if os.path.lexists(folder / name)}, work=work)


def _log_so_far(folder: Path, left: Iterable[str]) -> bytes:
    """Return the log of the sessions before, killed ones too: each began with that of those before it."""
    logs = []
    for path in (folder / LOG, *(folder / name / LOG for name in left)):
        with suppress(OSError):
            logs.append(path.read_bytes())
    return max(logs, key=len, default=b"")


def _work_folders(folder: Path) -> list[str]:
    """Name the work folders that runs have in a run folder, or left there when they were killed."""
    paths = (path for path in folder.glob(".work-*") if WORK.fullmatch(path.name) and path.is_dir())
    return [path.name for path in paths if (path / LOG).is_file() or not any(path.iterdir())]


def _clean(folder: Path, left: Iterable[str]) -> None:
    """Remove the work folders that runs which were killed left."""
    for name in left:
        shutil.rmtree(folder / name, ignore_errors=True)


def _holds_a_run(folder: Path) -> bool:
    try:
        Result.open(folder).close()
    except InputError:
        return False
    return True


def _owns_surface(folder: Path) -> bool:
    with suppress(InputError), Result.open(folder) as result:
        return result.owns_surface
    return False
