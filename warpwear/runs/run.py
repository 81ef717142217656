"""Run a study, whole or step by step: first what can fail at once, then the steps, then what they leave."""

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import h5py
from numpy.typing import ArrayLike

from warpwear import lazy
from warpwear.clock import Clock, phase
from warpwear.engine.device import check_threads, report_out_of_memory
from warpwear.engine.executor import Executor
from warpwear.errors import InputError
from warpwear.result import Result
from warpwear.results import manifest
from warpwear.results.file import FILE_NAME, MAGIC, OWN_SURFACE, SURFACE_FILE
from warpwear.results.seal import HEADER, sealing
from warpwear.results.tables import write_summary, write_tables
from warpwear.results.writer import ResultWriter
from warpwear.runs import folder as run_folder
from warpwear.runs.console import Enough, Foresight, Progress
from warpwear.runs.loop import StepLoop
from warpwear.runs.order import RunOrder, order_of
from warpwear.runs.step import RunStep
from warpwear.study.study import Study
from warpwear.surfaces.base import Surface
from warpwear.version import __version__

if TYPE_CHECKING:
    from warpwear.figures.process import Painter

process = lazy.module("warpwear.figures.process")
pages = lazy.module("warpwear.page.content")
stresses = lazy.module("warpwear.history.stresses")

LOG, USER_LOG = logging.getLogger("warpwear.run"), logging.getLogger("warpwear")

#: What may be drawn of a run.
PLOTS = ("essential", "all", "none")


class ForwardToUserLogger(logging.Handler):
    """Forwards what log.txt has in full to the logger "warpwear", at the level that its user has set."""

    def emit(self, record: logging.LogRecord) -> None:
        """Forward a record."""
        if USER_LOG.isEnabledFor(record.levelno):
            USER_LOG.handle(record)


LOG.setLevel(logging.INFO)
LOG.propagate = False
LOG.addHandler(ForwardToUserLogger())
USER_LOG.addHandler(logging.NullHandler())  # warnings are warned and errors raised: none is printed unasked


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

    What misleads (keys that are not used, a contact of few cells) is a warning of Python (StudyWarning), in
    `result.summary["warnings"]` too; with `progress` the three heaviest go to standard error instead.

    Parameters
    ----------
    study : Study, path or str
        A study, its file, or the name of a preset.
    surface : array or Surface, optional
        Heights [mm] instead of the study's disc, positive out of the material, axis 0 along the sliding
        direction: an array of a height a cell of the domain, shape (nx, ny), or of the track of a swept run,
        shape (rows, ny); or an object with the methods of `warpwear.surfaces.base.Surface`, such as the
        ``surface`` of `read_surface`, which is sampled there (read it with ``extend="mirror"`` where it is
        smaller than the domain). Their mean is taken off: approaches count from
        it. With `out` they are saved as surface.npy, which the resolved study names, so that it runs again by
        itself. Load on filled-in points is reported and limited, as for a file; surface.npy does not say
        which points these are.
    out : path, optional
        Run folder to write (study.toml, result.h5, history.csv, summary.json, figures, log.txt); without it
        the result lives in memory.
    device : str
        ``"cpu"`` or ``"cuda:0"``.
    threads : int, optional
        Of the CPU, by default every core; no result depends on it.
    plots : {"essential", "all", "none"} or bool
        Figures to draw into `out`, True for the essential ones, False for none; with two cores another
        process draws the essential ones.
    overwrite : bool
        Whether to replace a run that is there already.
    resume : bool
        Whether to go on from the checkpoint that an unfinished run left in `out`, from the start where there
        is none; a finished run is returned as it is.
    progress : bool
        Whether to report on standard error.
    callback : callable, optional
        Is called with every step, see `steps`; steps are then made one by one: slower on a GPU (where
        rounding differs) and on small grids. An exception of it stops the run as an interrupt does: what
        there is so far is kept, with a checkpoint, and it is raised.

    Returns
    -------
    Result
        History, snapshots, figures and summary.

    Raises
    ------
    InputError
        For a study that cannot be computed, such as a domain smaller than the scar or a load beyond what the
        hardness carries, a surface that does not fit it, or a folder that is there; none is left behind.
    InvariantError
        For a step that is wrong, such as a contact at the domain's edge.
    ConvergenceError
        For a contact that cannot be balanced. Both leave an unfinished run with the last checkpoint, as does
        KeyboardInterrupt, raised at the end of a step. What a surface's own `heights` raises is raised.

    Examples
    --------
    >>> coarse = {"grid.cell": "20 um", "sliding.distance": "3 mm", "output.snapshots": ["1 mm"]}
    >>> result = warpwear.run(warpwear.Study.load("v3-fine").replace(coarse))
    >>> result.finished, len(result.history["cof"]), result.units["area_contact"]
    (True, 154, 'mm^2')
    >>> bool(result.at("1 mm").pressure.max() <= result.study.contact.hardness)
    True
    """
    options = RunOptions(
        surface=surface,
        out=None if out is None else Path(out),
        device=device,
        threads=threads,
        plots=plots if isinstance(plots, str) else "essential" if plots else "none",
        overwrite=overwrite,
        resume=resume,
        progress=progress,
        callback=callback,
    )
    return run_study(study, options)


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """The options of `run`, and what only this package asks for."""

    surface: ArrayLike | Surface | None = None
    out: Path | None = None
    device: str = "cpu"
    threads: int | None = None
    plots: str = "none"
    overwrite: bool = False
    resume: bool = False
    progress: bool | Progress = False  # who gives one tells its notes
    callback: Callable[[RunStep], object] | None = None
    #: Whether the folder gets its tables and the end's fields: otherwise log and sealed result alone, with
    #: the snapshots for which the study names distances.
    whole: bool = True
    #: Digests of files by the keys that name them: a run on others is refused.
    files: Mapping[str, str] = field(default_factory=dict)
    #: What imports took before the run [s].
    import_seconds: float = 0.0

    def check(self) -> None:
        """Raise InputError for options that are not known or exclude each other."""
        if self.callback is not None and not callable(self.callback):
            raise InputError(
                f"callback = {self.callback!r}: a function is expected, which is called with every step."
            )
        if self.resume and (self.out is None or self.overwrite):
            more = ", and excludes overwrite" if self.overwrite else ""
            raise InputError(f"resume needs out, a run folder{more}.")
        if self.plots not in PLOTS:
            allowed = ", ".join(PLOTS)
            raise InputError(f"plots = {self.plots!r} is not known; allowed: {allowed}, true and false.")


def run_study(study: Study | str | Path, options: RunOptions) -> Result:
    """Run a study and return its result, which knows the seconds of its phases; raises what `run` does."""
    options.check()
    order = order_of(study, options.surface, options.out, planned=options.files)
    shared = options.progress if isinstance(options.progress, Progress) else None
    progress = shared or Progress(order.study.study.name, quiet=not options.progress)
    clock = Clock(import_seconds=options.import_seconds, entered=progress.phase)
    with clock.running(), report_out_of_memory(order.study.cells), nullcontext() if shared else progress:
        if options.out is not None:
            run_folder.check(options.out, overwrite=options.overwrite, resume=options.resume)
            if options.resume and run_folder.is_finished(options.out, order):
                return Result.open(options.out)
        draws = options.out is not None and options.plots != "none"
        cores = check_threads(options.threads)
        with run_folder.owned(options.out):
            with process.Painter(cores) if draws else nullcontext() as painter:
                result = _compute(order, options, progress, painter)
                if options.out is not None and painter is not None:
                    _draw(result, options, painter)
            result.seconds = clock.seconds
            if options.out is not None:
                result.at_hand = {}
                if options.whole:
                    write_summary(options.out, result)
    return result


def foresee(study: Study, options: RunOptions) -> str:
    """Say how long a run takes, from its first contacts, of which nothing is kept; raises what `run` does."""
    progress = Foresight(study.study.name, most_notes=0)
    with suppress(Enough):
        run_study(study, replace(options, progress=progress))
    return str(progress)


def _compute(order: RunOrder, options: RunOptions, progress: Progress, painter: "Painter | None") -> Result:
    """Make the steps and leave the run in its folder; returns its result.

    Raises at the end, when all is in its place, what stopped the run early.
    """
    study = order.study
    with (
        order.arrangement.executor(study, device=options.device, threads=options.threads) as executor,
        run_folder.working_in(options.out, overwrite=options.overwrite, resume=options.resume) as work,
    ):
        with _log_to(work), _result_file(work) as file:
            LOG.info("warpwear %s on %s with %d threads", __version__, executor.device, executor.threads)
            with phase("surface"):
                writer = _writer_of(file, order, options, executor, work)
                loop = StepLoop(
                    order, executor, writer, progress, folder=options.out, work=work, resume=options.resume
                )
            loop.run(options.callback)
            result = Result.of(file)
            result.study = study  # as it is in the file
            result.at_hand = writer.at_hand
            if study.has_stresses and len(result.snapshots):
                with phase("stresses"):
                    writer.flush()
                    writer.add_stresses(
                        stresses.of_run(study, result.snapshots, result.history, executor.threads)
                    )
            if painter is not None and loop.finished:
                painter.order(result.plot, but=process.LATE)
            with phase("write"):
                writer.flush()
        if work and options.out:
            with phase("write"):
                result.close()
                with sealing(work / FILE_NAME, MAGIC), Result.of(work / FILE_NAME) as before:
                    before.study, before.at_hand = study, writer.at_hand
                    before.take_over(result)
                    _leave(before, loop, work if options.whole else None, painter)
                run_folder.move_into_place(work, options.out)
                loop.end_checkpoints()
                result = Result.of(options.out / FILE_NAME)
                result.take_over(before)
                result.at_hand = writer.at_hand
                if not result.owns_surface:  # which lies elsewhere now
                    result.study = study
    if loop.stopped is not None:
        raise loop.stopped
    return result


def _writer_of(
    file: h5py.File, order: RunOrder, options: RunOptions, executor: Executor, work: Path | None
) -> ResultWriter:
    """Return the writer of the result's file, with the heights that were given beside it."""
    if work:
        order.save_heights(work)
    study = order.study
    snapshots = options.whole or study.output.snapshots not in ("auto", ())
    device, threads = str(executor.device), executor.threads
    writer = ResultWriter(file, study, order.toml, device=device, threads=threads, snapshots=snapshots)
    if options.out and study.disc.surface == str(options.out.resolve() / SURFACE_FILE):
        file.attrs[OWN_SURFACE] = True
    return writer


def _leave(result: Result, loop: StepLoop, work: Path | None, painter: "Painter | None") -> None:
    """Write tables into the work folder, if any, and order the figures that need them, and the page."""
    if work:
        write_tables(work, result)
    if loop.finished and painter is not None and painter.draws:
        painter.order(result.plot)
        if work:
            painter.order_page(manifest.PAGE, pages.content_of(result, result.plot), pages.MAKER)


def _draw(result: Result, options: RunOptions, painter: "Painter") -> None:
    """Write the figures and the page, those of the painter and those that it left."""
    assert options.out is not None
    with phase("draw"):
        drawn = painter.pictures()
        paths = result.plot.save_all(options.out / manifest.FIGURES, plots=options.plots, drawn=drawn)
        if options.whole:
            pages.write_page(options.out, drawn.get(manifest.PAGE) or _page_of(result, paths))


def _page_of(result: Result, paths: list[Path]) -> bytes:
    """Make the page of a run whose figures are drawn. paths: of these."""
    content = pages.content_of(result, result.plot)
    names = pages.statics(content)
    return pages.made_here(content, {p.stem: p.read_bytes() for p in paths if p.stem in names})


def steps(
    study: Study | str | Path,
    *,
    surface: ArrayLike | Surface | None = None,
    device: str = "cpu",
    threads: int | None = None,
) -> Iterator[RunStep]:
    """Make the steps of a study one by one: `for step in warpwear.steps(study): step.row["area_contact"]`.

    Nothing is kept or written; stop whenever you like. `run` makes many steps in a row; here each is made
    alone, as it can be asked for its fields, which takes longer: four to ten times where the contact is
    small.

    Parameters
    ----------
    study : Study, path or str
        A study, its file, or the name of a preset.
    surface : array or Surface, optional
        Heights [mm] instead of the study's disc, as of `run`.
    device : str
        ``"cpu"`` or ``"cuda:0"``.
    threads : int, optional
        Of the CPU, by default every core; no result depends on it.

    Returns
    -------
    iterator of RunStep
        Each with `row`, the history's columns by name, their `units`, and `snapshot()` or `fields`: pressure,
        wear_counter, wear_disc and gap after it until the next. "cof" is NaN where the study calibrates the
        shear strength, as by default: that takes the areas of the whole run.

    Raises
    ------
    InputError, InvariantError, ConvergenceError
        As `run`, when the first step is asked for or the step that is wrong.

    Examples
    --------
    >>> study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "0.01 mm"})
    >>> [round(step.row["distance"], 5) for step in warpwear.steps(study)]
    [0.003, 0.00606, 0.00918, 0.01]
    """
    order = order_of(study, surface)
    with (
        report_out_of_memory(order.study.cells),
        order.arrangement.executor(order.study, device=device, threads=threads) as executor,
        _log_to(None),
    ):
        progress = Progress(order.study.study.name, quiet=True)
        yield from StepLoop(order, executor, None, progress).steps()


@contextmanager
def _log_to(work: Path | None) -> Iterator[None]:
    coded: Any = {"encoding": "utf-8", "errors": "backslashreplace"}  # of names that no text can have
    handler = logging.FileHandler(work / run_folder.LOG, **coded) if work else logging.NullHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
    LOG.addHandler(handler)
    try:
        yield
    finally:
        LOG.removeHandler(handler)
        handler.close()


@contextmanager
def _result_file(work: Path | None) -> Iterator[h5py.File]:
    """Open the HDF5 file of the run, in memory without a folder. Closed here only after an error."""
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
