"""The steps of one run, what is checked of each, and what is kept."""

import logging
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from warpwear.clock import phase
from warpwear.engine import state
from warpwear.engine.executor import Executor
from warpwear.errors import RESUME_IT, ConvergenceError, InputError, InvariantError
from warpwear.grid import FloatArray
from warpwear.history.quantities import columns_of
from warpwear.history.rows import Rows
from warpwear.history.snapshot import Snapshot
from warpwear.results.check import check_snapshots
from warpwear.results.seal import versions
from warpwear.results.track import doubt_of_directions
from warpwear.results.writer import ResultWriter
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.runs.checkpoint import Checkpoint, Checkpoints, StoredCheckpoint, checksum, opened
from warpwear.runs.console import Interrupts, Progress
from warpwear.runs.invariants import Invariants, Violation
from warpwear.runs.make import model_of
from warpwear.runs.plan import plan_of
from warpwear.runs.step import RunStep
from warpwear.study.rules import too_small
from warpwear.study.study import Study
from warpwear.study.surface import surface_in
from warpwear.surfaces.base import Surface

LOG = logging.getLogger("warpwear.run")

#: A coefficient of friction beyond this is a mistake, not a result.
ABSURD_COEFFICIENT = 3.0
#: A step on the half-space whose length changes the area by more, relatively, is told of.
AREA_ERROR = 0.05
#: H/(E*·rms slope) above which load over hardness is low by more than some 5 %.
ELASTIC = 0.2
#: E* of two bodies of steel [MPa], of 210 GPa and Poisson's ratio 0.3, to judge by where it is not known.
OF_STEEL = 210.0e3 / (2.0 * (1.0 - 0.3**2))
#: A contact of fewer cells is not resolved.
FEW_CELLS = 20
#: Fewer cells do not even tell by how much.
COUNTED_CELLS = 4


class StepLoop:
    """The steps of one run and what is kept of them.

    writer: of the result; None where nobody asks for one. surface: instead of the study's. resume: the folder
    whose checkpoint to go on from, if there is one.

    Raises InputError for a checkpoint that is damaged or another run's.
    """

    def __init__(
        self,
        study: Study,
        executor: Executor,
        writer: ResultWriter | None,
        progress: Progress,
        *,
        surface: Surface | None = None,
        resume: Path | None = None,
    ) -> None:
        self.study = study
        self.finished = False
        #: What stopped the run from outside: a KeyboardInterrupt, or an exception of who watches it.
        self.interrupted: BaseException | None = None
        self._checkpoints: Checkpoints | None = None
        self._checkpoint_failed = False
        self._elapsed_before = 0.0
        #: Why the run stopped early, if a step was wrong.
        self.failed: InvariantError | ConvergenceError | None = None
        self._invariants = Invariants(study)
        self._reported: list[str] = []
        self._writer = writer
        self._progress = progress
        grid = study.cells
        problem = too_small(study)
        if problem is not None and study.checks.strict:
            raise InputError(f"{problem}.")
        surface = surface or surface_in(study)
        along = study.track.x if study.is_swept else grid.x
        self._notes = [*study.notices(), *surface.notices(along, grid.y)]
        self.warnings = [*self._notes]
        for warning in self.warnings:
            self._warn(warning)
        self._processor, self._device = executor.device, str(executor.device)
        self._rows = Rows()
        with opened(resume / CHECKPOINT if resume else None) as stored:
            if stored is not None:
                stored.refuse_changes(study, device=self._device)
            prepared = model_of(study, surface, executor, kept=stored.heights_for if stored else np.asarray)
            self._model, self._surface_record = prepared.model, prepared.record
            self._book, self._pieces, self._filled = prepared.book, prepared.pieces, prepared.filled
            self._surface_sum = checksum(prepared.heights)
            self._look_at_elasticity(prepared.record["on_the_grid"]["rms_slope"])
            self._heights = None if study.is_swept else prepared.heights
            if study.is_swept and writer is not None:
                writer.add_track(study.track.x, prepared.heights)
            if stored is not None:
                self._restore(stored)

    def checkpoint_in(self, folder: Path, work: Path) -> None:
        """Keep checkpoints in a run folder, and make them in a work folder."""
        self._checkpoints = Checkpoints(
            folder / CHECKPOINT,
            work,
            self.study,
            device=self._device,
            surface=self._surface_sum,
            heights=self._heights,
        )
        if self.study.run.checkpoint == 0.0:  # after every step, so a block is one
            self._model.longest_block = 1
        if not self._rows:
            self._checkpoints.remove()  # of the run that is overwritten

    def end_checkpoints(self) -> None:
        """Remove the checkpoint of a finished run, whose result is in its place."""
        if self._checkpoints is not None and self.finished:
            self._checkpoints.remove()

    def _restore(self, stored: StoredCheckpoint) -> None:
        assert self._writer is not None
        with stored.reading():
            then = stored.read()
            check_snapshots(stored.file, self.study)
            state.restore(self._model, then.arrays, then.numbers)
            self._writer.take_snapshots_from(stored.file)
        self._rows = then.rows
        self.warnings, self._reported = then.warnings, then.reported_violations
        self._elapsed_before = then.elapsed
        LOG.info("goes on after step %d, from a checkpoint by warpwear %s", len(self._rows), stored.version)
        if stored.heights_differ:
            self._add_warning(
                "The disc's heights differ by rounding from those the run began with, as another "
                "processor or other software made them: it goes on with the stored ones."
            )

    def run(self, callback: Callable[[RunStep], object] | None = None) -> None:
        """Make the steps, and write what they leave into the result. callback: is given every step."""
        plan = plan_of(self.study)
        assert self._writer is not None
        self._started = time.perf_counter()
        self._progress.start(len(plan), done=len(self._rows))
        try:
            with phase("steps"):
                self._make_steps(plan, callback)
        except KeyboardInterrupt as error:
            if not self._rows:
                raise
            self.interrupted = error
        except (InvariantError, ConvergenceError) as error:
            if not self._rows or self._checkpoints is None:
                raise
            self._fail(error)
        finally:
            self._progress.end()
        self.finished = len(self._rows) == len(plan)
        history = self._history(finished=self.finished)
        self._check_results(history)
        how = "finished:" if self.finished else "stopped after"
        LOG.info("%s %d steps in %.1f s", how, len(self._rows), self._elapsed)
        record = {
            "surface": self._surface_record,
            "warnings": self.warnings,
            "notes": self._notes,
            "elapsed_s": self._elapsed,
            "made_with": versions(self._processor),
        }
        with phase("write"):
            self._writer.finish(history, record, finished=self.finished, book=self._book, pieces=self._pieces)

    def steps(self) -> Iterator[RunStep]:
        """Every step of the study, with its fields; nothing is written."""
        plan = plan_of(self.study)
        self._progress.start(len(plan))
        for step, wrong in self._steps(plan, with_fields=True):
            yield step
            if wrong is not None:
                raise wrong

    def _steps(
        self, plan: Sequence[tuple[float, float, bool]], *, with_fields: bool
    ) -> Iterator[tuple[RunStep, InvariantError | None]]:
        """Steps that are still to be made of a plan, each checked and booked, and what is wrong with it.

        plan: of every step the increment, the distance at its end [mm], and whether to keep a snapshot.
        with_fields: whether every step can be asked for its fields, not only those that are kept.
        """
        speed, left = self.study.sliding.mean_speed, plan[len(self._rows) :]
        # where points were filled, steps 1, 2, 4, 8, … are looked at too: a run on them stops early
        numbers, doubtful = range(len(self._rows) + 1, len(plan) + 1), self._filled is not None
        looks = [keep or (doubtful and n & (n - 1) == 0) for n, (*_, keep) in zip(numbers, left, strict=True)]
        requests = ((step[0], look or with_fields, step[2]) for step, look in zip(left, looks, strict=True))
        steps = self._model.steps(requests)
        for (_, distance, keep), look, step in zip(left, looks, steps, strict=True):
            row = step.row | {"distance": distance}
            stop = self._check(
                self._invariants.of_row(row, touches_edge=step.touches_edge, touches_rim=step.touches_rim)
            )
            wanted = look and (self._filled is not None or self._writer is not None)
            snapshot = self._model.snapshot(step, distance) if wanted else None
            if snapshot is not None and self._filled is not None:
                snapshot = replace(snapshot, load_on_filled=snapshot.share_on(self._filled))
                stop = stop or self._check(self._invariants.of_filled(snapshot, row))
            if snapshot is not None and keep and self._writer is not None:
                self._check(self._invariants.of_fields(vars(snapshot), row))
                with phase("snapshots"):
                    self._writer.add_snapshot(snapshot)
            row |= {"time": distance / speed if speed else math.nan}
            self._rows.append(row)
            self._progress.step(row)
            if len(self._rows) == 1 and row["cells_in_contact"] < FEW_CELLS:
                self._report_few_cells(row["cells_in_contact"], "To begin with")
            self._last = step
            index = len(self._rows) - 1
            yield RunStep(index, len(plan), self.study, row, partial(self._snapshot_of, index)), stop

    def _snapshot_of(self, index: int) -> Snapshot | None:
        """The fields after the step of a row, views of the model's on a CPU; None after a later one."""
        if index != len(self._rows) - 1:
            return None
        return self._model.snapshot(self._last, self._rows.last["distance"])

    def _make_steps(
        self, plan: Sequence[tuple[float, float, bool]], callback: Callable[[RunStep], object] | None
    ) -> None:
        """Make the steps of a plan that are left, and checkpoints between them."""
        with Interrupts() as interrupts:
            for step, stop in self._steps(plan, with_fields=callback is not None):
                try:
                    if callback is not None:
                        callback(step)
                except BaseException as error:  # stops the run as an interrupt does
                    self.interrupted = error
                if self._model.steps_in_flight:  # of a block that is made, so the state is not this step's
                    if stop is not None:
                        raise stop
                    continue
                if interrupts.requested and self.interrupted is None:
                    self.interrupted = KeyboardInterrupt()
                ends = self.interrupted is not None or stop is not None
                if self._checkpoints is not None and (ends or self._checkpoints.due):
                    self._checkpoint(self._checkpoints)
                if stop is not None:
                    raise stop
                if self.interrupted is not None:
                    break

    def _checkpoint(self, checkpoints: Checkpoints) -> None:
        arrays, numbers = state.save(self._model)
        self._check(self._invariants.of_fields(arrays, self._rows.last))
        now = Checkpoint(arrays, numbers, self._rows, self.warnings, self._reported, self._elapsed)
        assert self._writer is not None
        try:
            with phase("snapshots"):
                checkpoints.write(now, self._writer)
        except OSError as error:
            if not self._checkpoint_failed:
                self._checkpoint_failed = True
                why = error.strerror or str(error)
                self._add_warning(f"No checkpoint could be written: {why}. The run goes on without.")

    @property
    def _elapsed(self) -> float:
        """Time that the steps took, those before the checkpoint included [s]."""
        return self._elapsed_before + time.perf_counter() - self._started

    def _history(self, *, finished: bool) -> dict[str, FloatArray]:
        history = {column.name: self._rows.column(column.name) for column in columns_of(self.study)}
        study = self.study
        history["cof"] = study.friction.law.coefficient(
            history, load=study.contact.load, finished=finished, laps=study.laps
        )
        return history

    def _check(self, violations: Iterator[Violation]) -> InvariantError | None:
        """Record what is violated, once each; with checks.strict the error that stops the run.

        Raised at once where the state is not to be kept; returned where it is, in a checkpoint that tells it.
        """
        for violation in violations:
            if self.study.checks.strict:
                self._reported.append(violation.quantity)
                self.warnings.append(f"{violation.sentence}.")
                error = InvariantError(f"{violation.sentence}; {violation.remedy}.")
                if not violation.sound:
                    raise error
                return error
            if violation.quantity not in self._reported:
                self._reported.append(violation.quantity)
                self._add_warning(f"{violation.sentence}.")
        return None

    def _fail(self, error: InvariantError | ConvergenceError) -> None:
        """Stop with what came before in the folder."""
        LOG.warning(str(error))  # the screen gets it when the run is closed
        if isinstance(error, ConvergenceError):
            self.warnings.append(str(error))
        assert self._checkpoints is not None  # or there is nothing to keep the run in
        advice = f"The run folder {self._checkpoints.path.parent} holds the steps so far."
        plan = self.study.stepping
        if isinstance(error, InvariantError):
            to_do = "continue anyway" if self._checkpoints.path.exists() else "begin again and go on anyway"
            advice += f" To {to_do}, set checks.strict=false and {RESUME_IT}."
        elif not self.study.is_swept and self.study.sliding.total:  # the same step would end the same way
            names = ("first", "largest") if plan.increment is None else ("increment",)
            halves = (f"stepping.{name}='{getattr(plan, name) / 2.0:g} mm'" for name in names)
            advice += f" A new run may get further with smaller increments: {', '.join(halves)}."
        self.failed = type(error)(f"{str(error).removesuffix('.')}. {advice}")

    def _check_results(self, history: dict[str, FloatArray]) -> None:
        highest = history["cof"].max()
        if highest > ABSURD_COEFFICIENT:
            self._add_warning(
                f"The coefficient of friction reaches {highest:.3g}, which no contact has: the shear "
                f"strength belongs to another area than friction.area = '{self.study.friction.area}'."
            )
        long = int(np.count_nonzero(history.get("area_error", np.zeros(1)) > AREA_ERROR))
        if long:
            self._add_warning(
                f"sliding.shift = {self.study.sliding.shift} cells is too long for {long} of the steps, "
                f"whose area it changes by more than {100.0 * AREA_ERROR:g} % by estimate: a smaller one is "
                "needed."
            )
        if doubt := doubt_of_directions(self.study, history):
            self._add_warning(doubt)
        friction = self.study.friction
        tau = friction.law.final_strength(
            history, load=self.study.contact.load, finished=self.finished, laps=self.study.laps
        )
        strengths = {
            "shear strength τ0": tau,
            "film's": friction.film.shear_strength if friction.film else 0.0,
        }
        limit = self.study.shear_limit
        for name, strength in strengths.items():
            if strength > limit:
                self._add_warning(
                    f"The {name} = {strength:.3g} MPa is beyond {friction.limit} = {limit:.3g} MPa, which "
                    "the softer body bears: it would shear instead of the interface."
                )
        cells = history["cells_in_contact"]
        if cells.min() < FEW_CELLS <= cells[0]:
            self._report_few_cells(cells.min(), "At times")

    def _look_at_elasticity(self, slope: float) -> None:
        """Warn of a disc of this rms slope whose asperities yield before they flow, by the local law."""
        study, modulus = self.study, self.study.effective_modulus
        local = study.study.model == "micro" and study.contact.law == "local" and study.is_rough
        if not local or study.hardness is None or study.contact_task.compliance > 0.0:
            return
        ratio = study.hardness / ((modulus or OF_STEEL) * slope) if slope > 0.0 else math.inf
        if ratio <= ELASTIC:
            return
        sentence = f"H/(E*·rms slope) is {ratio:.2g}"
        if modulus is None:
            bodies = {"sphere": study.sphere, "disc": study.disc}
            constants = [(body, name) for body in bodies for name in ("young", "poisson")]
            missing = [f"{b}.{name}" for b, name in constants if getattr(bodies[b], name) is None]
            sentence = f"{sentence} for two bodies of steel (not given: {', '.join(missing)})"
        self._add_warning(
            f"Asperities yield elastically before they flow: {sentence}, and above {ELASTIC:g} the local law "
            'makes the contact too small until wear decides it. contact.law = "half-space" couples them.'
        )

    def _report_few_cells(self, count: float, when: str) -> None:
        """Warn of a contact of too few cells, with the size that would do. when: opens the sentence."""
        study, area = self.study, max(count, 1.0) * self.study.cells.cell_area
        if count < COUNTED_CELLS:  # which say little of an area, that the load and the hardness bound
            area = min(area, study.contact.load / study.hardness or area)
        enough = 1.0e3 * math.sqrt(area / FEW_CELLS)
        digit = 10.0 ** (math.floor(math.log10(enough)) - 1)
        self._add_warning(
            f"{when} only {count:.0f} {'cell is' if count == 1.0 else 'cells are'} in contact, so its area, "
            f"pressure and friction mean nothing: grid.cell = {1.0e3 * study.grid.cell:g} µm is too large, "
            f"{math.floor(enough / digit) * digit:.2g} µm would do ({FEW_CELLS} cells)."
        )

    def _add_warning(self, sentence: str) -> None:
        self.warnings.append(sentence)
        self._warn(sentence, kind="warning")

    def _warn(self, sentence: str, *, kind: str = "note") -> None:
        LOG.warning(sentence)
        self._progress.note(sentence, kind=kind)
