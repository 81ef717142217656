"""Runs a study: checks that can fail first, then the step loop, then what it leaves behind."""

import json
import logging
import math
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any
from uuid import uuid4

import h5py
import numpy as np

from warpwear import __version__, friction
from warpwear.consistency import too_small
from warpwear.errors import InputError
from warpwear.evolution import COLUMNS as EVOLUTION
from warpwear.execution import FIELDS_NEEDED, Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history import COLUMNS, Column
from warpwear.one_scale import OneScaleModel, Step
from warpwear.progress import Progress
from warpwear.results import FILE_NAME, Result, ResultWriter, Snapshot
from warpwear.stepping import increments
from warpwear.study import Study
from warpwear.surface_of import bearing_curve_of, surface_in
from warpwear.surfaces.parameters import roughness

LOG = logging.getLogger("warpwear")
#: A coefficient of friction beyond this is a mistake, not a result.
ABSURD_COEFFICIENT = 3.0
#: A contact of fewer cells is not resolved.
FEW_CELLS = 20


def run(
    study: Study | str | Path,
    *,
    out: str | Path | None = None,
    device: str = "cpu",
    threads: int | None = None,
    plots: bool = True,
    overwrite: bool = False,
    progress: bool = False,
) -> Result:
    """Run a study (or the one in a file, or a preset) and return its result.

    out: run folder to write (study.toml, result.h5, history.csv, summary.json, figures, log.txt); without it
    the result lives in memory. device: "cpu" or "cuda:0". threads: of the CPU, by default every core; no
    result depends on it. overwrite: replace a run that is there already. progress: report on standard error.

    Raises InputError for anything that cannot be computed or would be wrong (a contact at the domain's edge,
    say) and ConvergenceError for an unbalanced contact; neither leaves a folder behind. KeyboardInterrupt
    leaves an unfinished run.
    """
    if not isinstance(study, Study):
        study = Study.load(study)
    folder = None if out is None else _check_folder(Path(out), overwrite=overwrite)
    # A radial factor is a field of its own, and so is the stiffness that it makes differ from cell to cell.
    fields = FIELDS_NEEDED + 2.0 * (study.wear.distance_factor == "radial")
    executor = Executor(study.cells, device=device, threads=threads, fields_needed=fields)
    with executor, _writing_to(folder) as work:
        with _log_to(work), _result_file(work) as file:
            LOG.info("warpwear %s on %s with %d threads", __version__, executor.device, executor.threads)
            writer = ResultWriter(
                file, study, executor.grid, device=str(executor.device), threads=executor.threads
            )
            loop = _Loop(study, executor, writer, Progress(study, quiet=not progress))
            loop.run()
            result = Result(file, None)
            if work:
                _write_tables(work, study, result)
        if work and folder:
            result.close()
            _move_into_place(work, folder)
            result = Result.open(folder)
    if loop.interrupted:
        raise KeyboardInterrupt
    if folder and plots:
        result.plot.save_all(folder / "figures")
    return result


class _Loop:
    """The steps of one run and what is kept of them."""

    def __init__(self, study: Study, executor: Executor, writer: ResultWriter, progress: Progress) -> None:
        self.study = study
        self.interrupted = False
        self._edge_told = False
        self._writer = writer
        self._progress = progress
        grid = executor.grid
        problem = too_small(study)
        if problem is not None and study.checks.strict:
            raise InputError(f"{problem}.")
        surface = surface_in(study)
        self.warnings = [*study.notices(), *surface.notices(grid.x, grid.y)]
        for warning in self.warnings:
            self._warn(warning)
        heights = surface.heights(grid.x, grid.y)
        self._surface_record = surface.record() | {"on_the_grid": _roughness_on(grid, heights)}
        curve = None
        if study.wear.law == "bearing-curve":
            curve = bearing_curve_of(study)
            self._surface_record["bearing_curve"] = asdict(curve)
        self._model = OneScaleModel(study, heights, executor, bearing_curve=curve)
        self._executor = executor
        self._rows: list[dict[str, float]] = []

    def run(self) -> None:
        study = self.study
        stops = set(study.output.snapshots)
        total, speed = study.sliding.total, study.sliding.speed
        plan = [
            (increment, distance, distance in stops or distance == total)
            for increment, distance in increments(study.stepping.plan, total, stops)
        ]
        started = time.perf_counter()
        self._progress.start(len(plan))
        try:
            steps = self._model.steps((increment, keep) for increment, _, keep in plan)
            for (_, distance, keep), step in zip(plan, steps, strict=True):
                self._check_edge(step)
                time_slid = distance / speed if speed else math.nan
                self._rows.append(step.row | {"distance": distance, "time": time_slid})
                if keep:
                    self._keep(step, distance)
                self._progress.step(step.row)
        except KeyboardInterrupt:
            if not self._rows:
                raise
            self.interrupted = True
        finally:
            self._progress.end()
        history = self._history(finished=not self.interrupted)
        self._check_results(history)
        elapsed = time.perf_counter() - started
        how = "interrupted after" if self.interrupted else "finished:"
        LOG.info("%s %d steps in %.1f s", how, len(self._rows), elapsed)
        record = {"surface": self._surface_record, "warnings": self.warnings, "elapsed_s": elapsed}
        self._writer.finish(history, record, finished=not self.interrupted)

    def _history(self, *, finished: bool) -> dict[str, FloatArray]:
        history = {
            column.name: np.array([row.get(column.name, math.nan) for row in self._rows])
            for column in COLUMNS
        }
        study = self.study
        history["cof"] = friction.coefficient(
            study.friction, history, load=study.contact.load, finished=finished
        )
        return history

    def _keep(self, step: Step, distance: float) -> None:
        assert step.pressure is not None
        state, to_numpy = self._model.state, self._executor.to_numpy
        self._writer.add_snapshot(
            Snapshot(
                distance,
                pressure=step.pressure,
                wear_sphere=to_numpy(state.wear_sphere),
                wear_disc=to_numpy(state.wear_disc),
                gap=to_numpy(state.gap),
            )
        )

    def _check_edge(self, step: Step) -> None:
        curvature = self.study.sphere.curvature
        if curvature == 0.0 or not (step.touches_edge or step.touches_rim):
            return
        after = f"after {step.row['distance']:g} mm of sliding"
        if step.touches_rim:
            sentence = (
                f"sphere.radius = {1.0 / curvature:g} mm is too small: the contact reached the sphere's rim "
                f"{after}, so the sphere is worn away"
            )
            remedy = "a larger radius, or less load, wear or distance is needed"
        else:
            sentence = (
                f"grid.extent = {self.study.grid.extent:g} mm is too small: the contact reached the domain's "
                f"edge {after}, so what lies beyond it would be missing"
            )
            remedy = "a larger extent is needed"
        if self.study.checks.strict:
            raise InputError(f"{sentence}; {remedy}.")
        if not self._edge_told:
            self._edge_told = True
            self._add_warning(f"{sentence}.")

    def _check_results(self, history: dict[str, FloatArray]) -> None:
        highest = history["cof"].max()
        if highest > ABSURD_COEFFICIENT:
            self._add_warning(
                f"The coefficient of friction reaches {highest:.3g}, which no contact has: the shear "
                f"strength belongs to another area than friction.area = '{self.study.friction.area}'."
            )
        fewest = history["cells_in_contact"].min()
        if fewest < FEW_CELLS:
            self._add_warning(
                f"At times only {fewest:.0f} cells are in contact: smaller cells are needed to trust "
                "the result."
            )

    def _add_warning(self, sentence: str) -> None:
        self.warnings.append(sentence)
        self._warn(sentence)

    def _warn(self, sentence: str) -> None:
        LOG.warning(sentence)
        self._progress.say(f"note: {sentence}")


def _roughness_on(grid: Grid, heights: FloatArray) -> dict[str, float]:
    """What the cells see of the surface: after filling, filtering, mirroring and sampling."""
    found = roughness(heights, pixel=(grid.cell, grid.cell))
    lengths = {f"{key}_um": 1.0e3 * found.pop(key) for key in ("sa", "sq", "sz")}
    return lengths | found


def _check_folder(folder: Path, *, overwrite: bool) -> Path:
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected.")
    if folder.is_dir() and any(folder.iterdir()):
        if not _holds_a_run(folder):
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected.")
        if not overwrite:
            raise InputError(f"out = {folder} already holds a run; give another --out, or --overwrite it.")
    try:
        with tempfile.TemporaryFile(dir=folder if folder.is_dir() else _nearest_folder(folder)):
            pass
    except OSError as error:
        raise InputError(f"out = {folder} cannot be written: {error.strerror}.") from error
    return folder


@contextmanager
def _writing_to(folder: Path | None) -> Iterator[Path | None]:
    """A work folder inside or beside the run folder, gone again at the end. InputError if it cannot write."""
    if folder is None:
        yield None
        return
    inside = folder if folder.is_dir() else _nearest_folder(folder)
    try:
        work = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=inside))
        work.chmod(0o755)
        try:
            yield work
        finally:
            shutil.rmtree(work, ignore_errors=True)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"out = {folder} could not be written and holds no run: {why}.") from error


@contextmanager
def _log_to(work: Path | None) -> Iterator[None]:
    handler = logging.FileHandler(work / "log.txt", encoding="utf-8") if work else logging.NullHandler()
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
        file = h5py.File(work / FILE_NAME, "w")
    try:
        yield file
    except BaseException:
        with suppress(Exception):  # a full disk fails to be flushed once more
            file.close()
        raise


def _holds_a_run(folder: Path) -> bool:
    try:
        Result.open(folder).close()
    except InputError:
        return False
    return True


def _nearest_folder(path: Path) -> Path:
    """The nearest parent that exists: a run that fails leaves no new parents behind."""
    return next(parent for parent in path.absolute().parents if parent.is_dir())


def _move_into_place(work: Path, folder: Path) -> None:
    """All files of the run at once; into a folder that is there, file by file, leaving others alone."""
    from warpwear.figures import Plotter

    folder.parent.mkdir(parents=True, exist_ok=True)
    if not folder.is_dir():
        work.rename(folder)
        return
    for figure in (folder / "figures").glob("*"):
        if figure.stem in Plotter.NAMES:  # of the run that is replaced
            figure.unlink()
    for item in sorted(work.iterdir(), key=lambda item: item.name == FILE_NAME):  # the result last
        item.replace(folder / item.name)


def _write_table(path: Path, columns: Sequence[Column], table: Mapping[str, FloatArray]) -> None:
    header = ",".join(f"{column.name} [{column.units}]" for column in columns)
    rows = np.column_stack([table[column.name] for column in columns])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.12g")


def _write_tables(folder: Path, study: Study, result: Result) -> None:
    (folder / "study.toml").write_text(study.to_toml(), encoding="utf-8")
    _write_table(folder / "history.csv", COLUMNS, result.history)
    _write_table(folder / "surface.csv", EVOLUTION, result.surface_evolution.table)
    summary: dict[str, Any] = result.summary
    (folder / "summary.json").write_text(
        json.dumps(summary, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8"
    )
