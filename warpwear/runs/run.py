"""Run a study, whole or step by step: first what can fail at once, then the steps, then what they leave."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

import h5py
from numpy.typing import ArrayLike

from warpwear.engine.device import check_threads, find_device, report_out_of_memory
from warpwear.errors import InputError
from warpwear.figures.process import LATE, Painter
from warpwear.figures.table import PLOTS
from warpwear.result import Result
from warpwear.results.file import FILE_NAME, OWN_SURFACE, SURFACE_FILE
from warpwear.results.seal import HEADER
from warpwear.results.tables import write_tables
from warpwear.results.writer import ResultWriter
from warpwear.runs import folder as run_folder
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.runs.checkpoint import opened
from warpwear.runs.console import Progress
from warpwear.runs.given import GivenSurface, take_surface
from warpwear.runs.loop import StepLoop
from warpwear.runs.make import executor_of
from warpwear.runs.step import RunStep
from warpwear.study.study import Study
from warpwear.surfaces.base import Surface
from warpwear.version import __version__

LOG = logging.getLogger("warpwear")


def run(
    study: Study | str | Path,
    *,
    surface: ArrayLike | Surface | None = None,
    out: str | Path | None = None,
    device: str = "cpu",
    threads: int | None = None,
    plots: bool | str = True,
    overwrite: bool = False,
    resume: bool = False,
    progress: bool = False,
    callback: Callable[[RunStep], object] | None = None,
) -> Result:
    """Run a study (or the one in a file, or a preset) and return its result.

    surface: heights [mm] instead of the study's disc, positive out of the material, axis 0 along the sliding
    direction: an array of a height a cell of the domain, shape (nx, ny), or of the track of a swept run,
    shape (rows, ny); or an object with the methods of `warpwear.surfaces.base.Surface`, which is sampled
    there. Their mean is taken off: approaches count from it. With `out` they are saved as surface.npy, which
    the resolved study names, so that it runs again by itself.
    out: run folder to write (study.toml, result.h5, history.csv, summary.json, figures, log.txt); without it
    the result lives in memory. device: "cpu" or "cuda:0". threads: of the CPU, by default every core; no
    result depends on it. plots: figures to draw into `out`, "essential" (True), "all" or "none" (False); with
    two cores another process draws the essential ones. overwrite: replace a run that is there already.
    resume: go on from the checkpoint that an unfinished run left in `out`, from the start where there is
    none; a finished run is returned as it is. progress: report on standard error. callback: is called with
    every step, see `steps`, so that each is made alone: slower on a GPU, there with other rounding, and on
    small grids; an exception of it stops the run as an interrupt does: what there is so far is kept, with a
    checkpoint, and it is raised.

    What misleads (keys that are not used, a contact of few cells) is a warning of Python (StudyWarning), in
    `result.summary["warnings"]` too; with progress it is a note on standard error instead.

    Raises InputError, and leaves no folder behind, for anything that cannot be computed. A step that is wrong
    raises InvariantError (the contact at the domain's edge, say) or ConvergenceError (an unbalanced contact)
    and leaves an unfinished run with the last checkpoint, as does KeyboardInterrupt, raised at the end of a
    step. What a surface's own `heights` raises is raised.
    """
    folder = None if out is None else Path(out)
    if callback is not None and not callable(callback):
        raise InputError(f"callback = {callback!r}: a function is expected, which is called with every step.")
    if resume and (folder is None or overwrite):
        raise InputError(f"resume needs out, a run folder{', and excludes overwrite' if overwrite else ''}.")
    drawn = plots if isinstance(plots, str) else "essential" if plots else "none"
    if drawn not in PLOTS:
        raise InputError(f"plots = {plots!r} is not known; allowed: {', '.join(PLOTS)}, true and false.")
    study, given = _prepare(study, surface, folder)
    if folder is not None:
        run_folder.check(folder, overwrite=overwrite, resume=resume)
        if resume and run_folder.is_finished(folder, study):
            if given:
                given.refuse_others(folder)
            return Result.open(folder)
        if resume:
            with opened(folder / CHECKPOINT) as found:  # before anything is made that takes long
                if found is not None:
                    found.refuse_changes(study, device=str(find_device(device)))
    cores = check_threads(threads)
    with Painter(cores if folder and drawn != "none" else 1) as painter:
        with report_out_of_memory(study.cells):
            executor = executor_of(study, device=device, threads=cores)
            with executor, run_folder.writing_to(folder, overwrite=overwrite, resume=resume) as work:
                with _log_to(work), _result_file(work) as file:
                    LOG.info("warpwear %s on %s with %d threads", __version__, executor.device, cores)
                    if work and given:
                        given.save(work)
                    writer = ResultWriter(
                        file, study, study.cells, device=str(executor.device), threads=executor.threads
                    )
                    if folder and study.disc.surface == str(folder.resolve() / SURFACE_FILE):
                        file.attrs[OWN_SURFACE] = True
                    loop = StepLoop(
                        study,
                        executor,
                        writer,
                        Progress(study, quiet=not progress),
                        surface=given.surface if given else None,
                        resume=folder if resume else None,
                    )
                    if folder and work:
                        loop.checkpoint_in(folder, work)
                    loop.run(callback)
                    result = Result(file)
                    result.at_hand = writer.at_hand
                    if loop.finished:
                        painter.order(result.plot, but=LATE)
                    if work:
                        write_tables(work, study, result)
                    if loop.finished:
                        painter.order(result.plot)
                if work and folder:
                    result.close()
                    run_folder.move_into_place(work, folder)
                    loop.end_checkpoints()
                    result = Result.open(folder)
        if loop.failed is not None:
            raise loop.failed
        if loop.interrupted is not None:
            raise loop.interrupted
        if folder and drawn != "none":
            result.at_hand = writer.at_hand
            result.plot.save_all(folder / "figures", plots=drawn, drawn=painter.pictures())
            result.at_hand = {}
    return result


def steps(
    study: Study | str | Path,
    *,
    surface: ArrayLike | Surface | None = None,
    device: str = "cpu",
    threads: int | None = None,
) -> Iterator[RunStep]:
    """Make the steps of a study one by one: `for step in warpwear.steps(study): step.row["cof"]`.

    Each step has `row`, a dictionary of the history's columns, `units` of them, and `snapshot()` or `fields`:
    pressure, wear_sphere, wear_disc and gap after it, while no later one is made. Nothing is kept or written;
    stop whenever you like. study, surface, device, threads: as of `run`, and so are the numbers. That every
    step can be asked for its fields costs up to as much again on a CPU. On a GPU, and on a grid of fewer
    than 200,000 cells, `run` makes blocks of steps ahead; here each is made alone, so that it is slower, on a
    small grid up to twenty times, and on a GPU rounds differently.

    Raises what `run` raises, when the first step is asked for or the step that is wrong.
    """
    study, given = _prepare(study, surface, None)
    with (
        report_out_of_memory(study.cells),
        executor_of(study, device=device, threads=threads) as executor,
        _log_to(None),
    ):
        progress = Progress(study, quiet=True)
        loop = StepLoop(study, executor, None, progress, surface=given.surface if given else None)
        yield from loop.steps()


def _prepare(
    study: Study | str | Path, surface: ArrayLike | Surface | None, folder: Path | None
) -> tuple[Study, GivenSurface | None]:
    """The study, and the heights given for its disc if there are any."""
    if not isinstance(study, Study):
        study = Study.load(study)
    if surface is None:
        return study, None
    given = take_surface(study, surface, folder)
    return given.study, given


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
