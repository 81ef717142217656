"""The steps of one run, what is checked of each, and what is kept."""

import logging
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from warpwear.clock import phase
from warpwear.engine import state
from warpwear.engine.executor import Executor
from warpwear.errors import RESUME_IT, ConvergenceError, InvariantError
from warpwear.history.recorder import Step, StepColumns
from warpwear.history.rows import Rows
from warpwear.history.snapshot import Snapshot
from warpwear.laws.form import Given
from warpwear.laws.passes import Block
from warpwear.laws.track import Track
from warpwear.results.seal import versions
from warpwear.results.writer import ResultWriter
from warpwear.runs import doubts
from warpwear.runs.checkpoint import FILE_NAME as CHECKPOINT
from warpwear.runs.checkpoint import Checkpoint, Checkpoints, StoredCheckpoint, opened
from warpwear.runs.console import Interrupts, Progress
from warpwear.runs.invariants import Violation
from warpwear.runs.jump import CycleJumps
from warpwear.runs.order import RunOrder
from warpwear.runs.plan import Planned, contacts_of
from warpwear.runs.probe import change_by_step
from warpwear.runs.step import RunStep

LOG = logging.getLogger("warpwear.run")


class StepLoop:
    """The steps of one run and what is kept of them.

    writer: of the result; None where nobody asks for one. folder: of the run, which holds
    its checkpoint. work: a folder of the same disk, where checkpoints are made. resume: whether to go on from
    the checkpoint that is there.

    Raises InputError for a checkpoint that is damaged or another run's.
    """

    def __init__(
        self,
        order: RunOrder,
        executor: Executor,
        writer: ResultWriter | None,
        progress: Progress,
        *,
        folder: Path | None = None,
        work: Path | None = None,
        resume: bool = False,
    ) -> None:
        self._order = order
        self.finished = False
        #: Why the run stopped early: a wrong step, a KeyboardInterrupt, or an exception of the callback.
        self.stopped: BaseException | None = None
        self._checkpoints: Checkpoints | None = None
        self._checkpoint_failed = False
        self._elapsed_before = 0.0
        self._reported: list[str] = []
        #: Binary digits of the number of steps after which bounds were looked at last.
        self._looked = 0
        self._writer = writer
        self._progress = progress
        self.warnings: list[str] = []
        self._rows = Rows()
        with opened(folder / CHECKPOINT if folder and resume else None) as stored:
            if stored is not None:
                stored.refuse_changes(order, device=str(executor.device))
            self._warn(*order.notes, kind="note")
            self._block = stored.block_of(order.study.blocks) if stored else order.study.blocks[0]
            original = stored.heights_for if stored else np.asarray
            prepared = order.model(executor, block=self._block, original=original)
            self._executor, self._heights = executor, prepared.heights
            self._surface_record, self._filled = prepared.record, prepared.filled
            self._model = prepared.model
            #: What plans the cycles where one may stand for many.
            self._jumps = CycleJumps(order, self._model, self._begin) if order.study.jumps else None
            #: The state of those circles of the disc that the counter-body has left.
            self._circles = Circles() if order.study.circles else None
            self._warn(*doubts.of_slope(order.study, prepared.record["on_the_grid"]["rms_slope"]))
            if order.study.is_swept and writer is not None:
                writer.add_track(order.study.track.x, prepared.heights)
            if writer is not None and isinstance(order.form, Given):
                writer.add_counter(order.form.values)
            if stored is not None:
                self._restore(stored)
        if folder and work:
            path, device = folder / CHECKPOINT, str(executor.device)
            self._checkpoints = Checkpoints(path, work, order, prepared.heights, device=device)
            if order.study.run.checkpoint == 0.0:  # after every step, so a block has one step
                self._model.longest_block = 1
            if not self._rows:
                self._checkpoints.remove()  # of the run that is overwritten

    def end_checkpoints(self) -> None:
        """Remove the checkpoint of a finished run, whose result is in its place."""
        if self._checkpoints is not None and self.finished:
            self._checkpoints.remove()

    def _restore(self, stored: StoredCheckpoint) -> None:
        assert self._writer is not None
        stored.refuse_other_files(self._order.files)
        with stored.reading():
            then = stored.read()
            state.restore(self._jumps or self._model, then.arrays, then.numbers)
            if self._circles is not None:
                state.restore(self._circles, then.arrays, then.numbers)
            self._writer.take_snapshots_from(stored.file)
        self._rows = then.rows
        self.warnings, self._reported = then.warnings, then.reported_violations
        self._elapsed_before = then.elapsed
        LOG.info("goes on after step %d, from a checkpoint by warpwear %s", len(self._rows), stored.version)
        if stored.heights_differ:
            self._warn(
                "The disc's heights differ by rounding from those the run began with, as another "
                "processor or other software made them: it goes on with the stored ones."
            )

    def run(self, callback: Callable[[RunStep], object] | None = None) -> None:
        """Make the steps, and write what they leave into the result. callback: is given every step."""
        assert self._writer is not None
        self._started = time.perf_counter()
        done = int(self._rows.column("cycles").sum()) if self._jumps and self._rows else len(self._rows)
        contacts = self._computed, self._foreseen
        self._progress.start(self._count, contacts, done=done, by_cycles=self._jumps is not None)
        try:
            with phase("steps"):
                self._make_steps(callback)
        except KeyboardInterrupt as error:
            if not self._rows:
                raise
            self.stopped = error
        except (InvariantError, ConvergenceError) as error:
            if not self._rows or self._checkpoints is None:
                raise
            self._fail(error)
        finally:
            self._progress.end()
        self.finished = bool(self._rows) and self._rows.last["distance"] == self._order.study.sliding.total
        history = self._order.history_of(self._rows, finished=self.finished)
        self._warn(*doubts.of_history(self._order.study, history, finished=self.finished))
        how = "finished:" if self.finished else "stopped after"
        LOG.info("%s %d steps in %.1f s", how, len(self._rows), self._elapsed)
        record = {
            "surface": self._surface_record,
            "files": self._order.files,
            "warnings": self.warnings,
            "notes": self._order.notes,
            "elapsed_s": self._elapsed,
            "made_with": versions(self._executor.device),
        }
        if self._jumps is not None:
            record["cycle_jump"] = self._jumps.told()
        if self.finished:
            with phase("steps"):
                record["change_by_step"] = change_by_step(self._order.study, self._model, len(self._rows))
        with phase("write"):
            self._writer.finish(
                history, record, finished=self.finished, book=self._model.book, pieces=self._model.pieces
            )

    def steps(self) -> Iterator[RunStep]:
        """Yield every step of the study, with its fields; nothing is written."""
        for row, wrong in self._steps(with_fields=True):
            yield self._shown(row)
            if wrong is not None:
                raise wrong

    def _steps(self, *, with_fields: bool) -> Iterator[tuple[dict[str, float], InvariantError | None]]:
        """Yield the rows of the steps that are left, each checked and recorded, with the error it stops with.

        with_fields: whether every step can be asked for its fields, not only those that are kept.
        """
        parts = [self._order.plan[len(self._rows) :]] if self._jumps is None else self._jumps.parts()
        for part in parts:
            blocks, first = self._order.blocks_of(part), 0
            for _, group in groupby(self._tasks[block.number] for block in blocks):
                steps = slice(first, first + len([*group]))
                self._begin(part[first])
                yield from self._steps_of(part[steps], blocks[steps], with_fields=with_fields)
                first = steps.stop

    @cached_property
    def _count(self) -> int:
        """Return the number of steps of the whole run, those of cycles that are jumped over included."""
        return contacts_of(self._order.study) if self._jumps else len(self._order.plan)

    def _computed(self) -> int:
        """Return how many steps were computed."""
        return len(self._rows) if self._jumps is None else self._jumps.contacts

    def _foreseen(self) -> tuple[float, float]:
        """Return how many steps like the last are left, at least and at most: its parts may become one."""
        left = self._count - len(self._rows)
        least, most = (left, left) if self._jumps is None else self._jumps.foreseen()
        return least / (self._rows.last.get("parts", 1.0) if self._rows else 1.0), most

    def _steps_of(
        self, left: Sequence[Planned], blocks: Sequence[Block], *, with_fields: bool
    ) -> Iterator[tuple[dict[str, float], InvariantError | None]]:
        """Yield the rows of a part of the plan, whose steps lie in these blocks, as `_steps` does."""
        # where points were filled, steps 1, 2, 4, 8, … are looked at too: a load on those stops a run early
        done, doubtful = len(self._rows), self._filled is not None
        keeps = [step[2] for step in left]
        looks = [keep or (doubtful and n & (n - 1) == 0) for n, keep in enumerate(keeps, done + 1)]
        asked = [look or with_fields for look in looks]
        groups = self._model.groups([step[0] for step in left], asked, keeps)
        invariants, first = self._order.invariants, done
        for step in self._unless_entered(groups, left, blocks):
            done = len(self._rows)
            place = done - first
            (_, distance, keep), block, look = left[place], blocks[place], looks[place]
            row = step.row
            row["distance"], row["time"], row["block"] = distance, block.time(distance), block.number
            if self._jumps is not None:
                row["cycles"] = float(self._jumps.stands_for)
            stop = self._check(
                invariants.of_row(row, touches_edge=step.touches_edge, touches_rim=step.touches_rim)
            )
            if not self._model.steps_in_flight and (done + 1).bit_length() > self._looked:
                self._looked = (done + 1).bit_length()  # at steps 1, 2, 4, 8, …, or where their block ends
                self._check(invariants.of_bounds(self._model.below_bounds(), row))
            wanted = look and (self._filled is not None or self._writer is not None)
            snapshot = self._model.snapshot(step, distance) if wanted else None
            if snapshot is not None and self._filled is not None:
                snapshot = replace(snapshot, load_on_filled=snapshot.share_on(self._filled))
                stop = stop or self._check(invariants.of_filled(snapshot, row))
            if snapshot is not None and keep and self._writer is not None:
                self._check(invariants.of_fields(snapshot.fields, row))
                self._check(invariants.of_heights(self._model.off_heights(snapshot, self._heights), row))
                with phase("snapshots"):
                    self._writer.add_snapshot(snapshot)
            if done == 0:
                self._check(invariants.of_columns(row))
            self._rows.append(row)
            if self._jumps is not None:
                self._jumps.count(row)
            self._progress.step(row, in_flight=self._model.steps_in_flight)
            done += 1
            if done == 1:
                self._warn(*doubts.of_count(self._order.study, row["cells_in_contact"], "To begin with"))
            self._last = step
            yield row, stop

    def _unless_entered(
        self, groups: Iterable[Step | StepColumns], left: Sequence[Planned], blocks: Sequence[Block]
    ) -> Iterator[Step]:
        """Yield the steps of a part of the plan, but enter those at once of which nothing is to be told."""
        begin = len(self._rows)
        for group in groups:
            if isinstance(group, StepColumns):
                first = len(self._rows) - begin
                planned = slice(first, first + len(group))
                if not self._entered(group, left[planned], blocks[planned]):
                    yield from group
            else:
                yield group

    def _entered(self, steps: StepColumns, plan: Sequence[Planned], blocks: Sequence[Block]) -> bool:
        """Enter steps at once; return False where each of them is to be looked at."""
        block, begins = blocks[0], not self._rows
        distance = np.array([step[1] for step in plan])
        more = {"distance": distance, "time": block.time(distance), "block": np.full(len(plan), block.number)}
        steps = replace(steps, columns=steps.columns | more)
        if self._jumps is not None or block is not blocks[-1] or not self._order.invariants.hold(steps):
            return False
        row = {name: float(values[0]) for name, values in steps.columns.items()}
        if begins:
            self._check(self._order.invariants.of_columns(row))
        self._rows.extend(steps.columns)
        self._progress.step(self._rows.last, count=len(steps))
        if begins:
            self._warn(*doubts.of_count(self._order.study, row["cells_in_contact"], "To begin with"))
        return True

    def _shown(self, row: dict[str, float]) -> RunStep:
        """Return the step of the last row, as those see it who watch the run."""
        index = len(self._rows) - 1
        return RunStep(index, self._count, self._order, row, partial(self._snapshot_of, index))

    def _begin(self, step: Planned) -> None:
        """Make the model ready for a step: under another load a new one takes over the bodies as they are."""
        before, (self._block,) = self._block, self._order.blocks_of([step])
        was, now = self._tasks[before.number], self._tasks[self._block.number]
        if was == now:
            return
        model = self._order.model_in(self._block, self._heights, self._executor, {})
        unworn = state.save(model, whole=True)[0] if self._circles is not None else {}
        state.restore(model, *state.save(self._model))
        model.longest_block = min(self._model.longest_block, model.longest_block)
        self._model = model
        study = self._order.study
        circles = study.circle_of(before), study.circle_of(self._block)
        if self._jumps is not None:
            self._jumps.model = model
            self._jumps.switch_block(*circles)
        if self._circles is not None and circles[0] != circles[1]:
            self._circles.change(self._model, *circles, unworn)
        elif was[1] is not None and was[1] != now[1]:
            self._model.switch_track(was[1])

    @cached_property
    def _tasks(self) -> dict[int, tuple[float, Track | None]]:
        """Map the number of a block to what its model is made for: its load [N], and its track."""
        study, blocks = self._order.study, self._order.study.blocks
        tracks = study.tracks if study.is_swept else [None] * len(blocks)
        return {block.number: (block.load, track) for block, track in zip(blocks, tracks, strict=True)}

    def _snapshot_of(self, index: int) -> Snapshot | None:
        """Return the fields after a row's step, views of the model's on a CPU; None once another is made."""
        if index != len(self._rows) - 1:
            return None
        return self._model.snapshot(self._last, self._rows.last["distance"])

    def _make_steps(self, callback: Callable[[RunStep], object] | None) -> None:
        """Make the steps that are left, and checkpoints between them."""
        with Interrupts() as interrupts:
            for row, stop in self._steps(with_fields=callback is not None):
                try:
                    if callback is not None:
                        callback(self._shown(row))
                except BaseException as error:  # stops the run as an interrupt does
                    self.stopped = error
                if self._model.steps_in_flight:  # its block is computed whole, so the state is a later one
                    if stop is not None:
                        raise stop
                    continue
                if interrupts.requested and self.stopped is None:
                    self.stopped = KeyboardInterrupt()
                ends = self.stopped is not None or stop is not None
                if self._checkpoints is not None and (ends or self._checkpoints.due):
                    self._checkpoint(self._checkpoints)
                if stop is not None:
                    raise stop
                if self.stopped is not None:
                    break

    def _checkpoint(self, checkpoints: Checkpoints) -> None:
        arrays, numbers = state.save(self._jumps or self._model)
        for more, also in [state.save(self._circles)] if self._circles is not None else []:
            arrays, numbers = arrays | more, numbers | also
        self._check(self._order.invariants.of_fields(arrays, self._rows.last))
        now = Checkpoint(arrays, numbers, self._rows, self.warnings, self._reported, self._elapsed)
        assert self._writer is not None
        try:
            with phase("snapshots"):
                checkpoints.write(now, self._writer)
        except OSError as error:
            if not self._checkpoint_failed:
                self._checkpoint_failed = True
                why = error.strerror or str(error)
                self._warn(f"No checkpoint could be written: {why}. The run goes on without.")

    @property
    def _elapsed(self) -> float:
        """Time that the steps took, those before the checkpoint included [s]."""
        return self._elapsed_before + time.perf_counter() - self._started

    def _check(self, violations: Iterator[Violation]) -> InvariantError | None:
        """Record each violation once; with checks.strict, raise or return the error that stops the run.

        It is raised where the state is not sound, and returned where a checkpoint is to keep the state.
        """
        for violation in violations:
            if self._order.study.checks.strict:
                self._reported.append(violation.quantity)
                self.warnings.append(f"{violation.sentence}.")
                error = InvariantError(f"{violation.sentence}; {violation.remedy}.")
                if not violation.sound:
                    raise error
                return error
            if violation.quantity not in self._reported:
                self._reported.append(violation.quantity)
                self._warn(f"{violation.sentence}.")
        return None

    def _fail(self, error: InvariantError | ConvergenceError) -> None:
        """Stop the run, and say that its folder holds the steps before."""
        LOG.warning(str(error))  # the screen gets it when the run is closed
        if isinstance(error, ConvergenceError):
            self.warnings.append(str(error))
        assert self._checkpoints is not None  # or there is nothing to keep the run in
        advice = f"The run folder {self._checkpoints.path.parent} holds the steps so far."
        go_on = f" To continue anyway, set checks.strict=false and {RESUME_IT}."
        advice += go_on if isinstance(error, InvariantError) else doubts.smaller_steps(self._order.study)
        self.stopped = type(error)(f"{str(error).removesuffix('.')}. {advice}")

    def _warn(self, *sentences: str, kind: str = "warning") -> None:
        for sentence in sentences:
            self.warnings.append(sentence)
            LOG.warning(sentence)
            self._progress.note(sentence, kind=kind)


class Circles:
    """Holds what models have of the disc on the circles of it that were left.

    All circles of a programme are parts of one length of the same surface, so that a model has room for one
    of them: unworn where a programme first slides on one, then found as it was left.
    """

    STATE: ClassVar = {"left": dict[str, dict[str, Any]], "booked": dict[str, dict[str, Any]]}

    def __init__(self) -> None:
        #: Arrays, and what the ledger had returned, by the number of the circle.
        self.left: dict[str, dict[str, Any]] = {}
        self.booked: dict[str, dict[str, float]] = {}

    def change(self, model: Any, before: int, after: int, unworn: dict[str, Any]) -> None:
        """Let a model leave one circle of the disc for another, by their numbers.

        unworn: arrays of a model on unworn bodies.
        """
        arrays, numbers = state.save(model, whole=True)
        names = [name for name, frame in state.frames(model).items() if frame == "disc"]
        other = self.left.pop(str(after), None) or {name: unworn[name] for name in names}
        self.left[str(before)] = {name: arrays[name] for name in names}
        state.restore(model, arrays | other, numbers)
        self.booked[str(before)] = model.switch_circle(self.booked.get(str(after), {}))
