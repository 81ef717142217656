"""Runs a study: checks that can fail first, then the step loop, then what it leaves behind."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

import h5py

from warpwear.engine.device import find_device, report_out_of_memory
from warpwear.errors import InputError
from warpwear.result import Result
from warpwear.results.file import FILE_NAME
from warpwear.results.seal import HEADER
from warpwear.results.tables import write_tables
from warpwear.results.writer import ResultWriter
from warpwear.runs import folder as run_folder
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.runs.checkpoint import opened
from warpwear.runs.console import Progress
from warpwear.runs.loop import StepLoop
from warpwear.runs.make import executor_of
from warpwear.study.study import Study
from warpwear.version import __version__

LOG = logging.getLogger("warpwear")


def run(
    study: Study | str | Path,
    *,
    out: str | Path | None = None,
    device: str = "cpu",
    threads: int | None = None,
    plots: bool = True,
    overwrite: bool = False,
    resume: bool = False,
    progress: bool = False,
) -> Result:
    """Run a study (or the one in a file, or a preset) and return its result.

    out: run folder to write (study.toml, result.h5, history.csv, summary.json, figures, log.txt); without it
    the result lives in memory. device: "cpu" or "cuda:0". threads: of the CPU, by default every core; no
    result depends on it. overwrite: replace a run that is there already. resume: go on from the checkpoint
    that an unfinished run left in `out`, from the start where there is none; a finished run is returned as it
    is. progress: report on standard error.

    Raises InputError, and leaves no folder behind, for anything that cannot be computed. A step that is wrong
    raises InvariantError (the contact at the domain's edge, say) or ConvergenceError (an unbalanced contact)
    and leaves an unfinished run with the last checkpoint, as does KeyboardInterrupt, raised at the end of a
    step.
    """
    if not isinstance(study, Study):
        study = Study.load(study)
    folder = None if out is None else Path(out)
    if resume and (folder is None or overwrite):
        raise InputError(f"resume needs out, a run folder{', and excludes overwrite' if overwrite else ''}.")
    if folder is not None:
        run_folder.check(folder, overwrite=overwrite, resume=resume)
        if resume and run_folder.is_finished(folder, study):
            return Result.open(folder)
        if resume:
            with opened(folder / CHECKPOINT) as found:  # before anything is made that takes long
                if found is not None:
                    found.refuse_changes(study, device=str(find_device(device)))
    with report_out_of_memory(study.cells):
        executor = executor_of(study, device=device, threads=threads)
        with executor, run_folder.writing_to(folder, overwrite=overwrite, resume=resume) as work:
            with _log_to(work), _result_file(work) as file:
                LOG.info("warpwear %s on %s with %d threads", __version__, executor.device, executor.threads)
                writer = ResultWriter(
                    file, study, study.cells, device=str(executor.device), threads=executor.threads
                )
                loop = StepLoop(study, executor, writer, Progress(study, quiet=not progress))
                if folder and work:
                    loop.checkpoint_in(folder, work, resume=resume)
                loop.run()
                result = Result(file, None)
                if work:
                    write_tables(work, study, result)
            if work and folder:
                result.close()
                run_folder.move_into_place(work, folder)
                loop.end_checkpoints()
                result = Result.open(folder)
    if loop.failed is not None:
        raise loop.failed
    if loop.interrupted:
        raise KeyboardInterrupt
    if folder and plots:
        result.plot.save_all(folder / "figures")
    return result


@contextmanager
def _log_to(work: Path | None) -> Iterator[None]:
    handler = logging.FileHandler(work / run_folder.LOG, encoding="utf-8") if work else logging.NullHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
    LOG.addHandler(handler)
    LOG.setLevel(logging.INFO)
    try:
        yield
    finally:
        LOG.removeHandler(handler)
        handler.close()


@contextmanager
def _result_file(work: Path | None) -> Iterator[h5py.File]:
    """The HDF5 file of the run, in memory without a folder. Closed here only when something went wrong."""
    if work is None:
        file = h5py.File(f"memory-{uuid4()}", "w", driver="core", backing_store=False)
    else:
        file = h5py.File(work / FILE_NAME, "w", userblock_size=HEADER)
    try:
        yield file
    except BaseException:
        with suppress(Exception):  # a full disk fails to be flushed once more
            file.close()
        raise
