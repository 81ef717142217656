"""A ball wears with a disc on one grid, smooth on a foundation (macro) or with every asperity (micro).

Every cell has the same stiffness, and both bodies wear in one proportion: it is taken where a study has no
feature, see `models.features`. Other laws, of cell by cell, are those of a track on which the disc does not
move, which would do here as well, in 1.5 to 3.2 times the time: it keeps the fields of two bodies, not a gap.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance, checked_residual, stiffness_of
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray
from warpwear.history.recorder import Entry, Ledger, Step, StepColumns, each_step, split_wear
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import balance, bearing, contact, wear
from warpwear.kernels.cells import NO_INDEX, WearMost, WearSum, names_of
from warpwear.laws.archard import wear_in_steps
from warpwear.laws.task import ContactTask
from warpwear.models.booking import booked
from warpwear.models.model import Model
from warpwear.models.unworn import gap_over

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 2.0
#: Steps of a replay at most, and cells of all its steps on a CPU: those of a large grid are to be seen, too.
LONGEST, CELLS_OF_REPLAY = 2000, 2.0e8
#: Steps that a GPU makes between two looks at its flags, where the second needs no search: such a look takes
#: as long as a small pass. A pass that waits for a search does nothing.
AT_A_LOOK = 2
#: Slots of the pass that wears, on a GPU at most: its sums leave room for two blocks a multiprocessor.
MOST_SLOTS = 264
SUMS, MAXIMA = names_of(WearSum), names_of(WearMost)


def foresee(task: ContactTask, executor: Executor) -> None:
    """Begin to compile the kernels of a model, which may be made later, of the same task."""
    of_law = (bearing.counted_below, wear.judge_area) if task.rigid else (balance.carried, wear.judge)
    listing = contact.gap, balance.select, balance.check_list
    steps = *of_law, wear.wear_step, wear.record, balance.pressures
    executor.foresee([*listing, *steps], together=True)


class OneScaleModel(Model):
    """Contact and wear of one task, with the same law for every cell, on one executor.

    heights: of the disc over its mean plane [mm], shape (nx, ny). The caller may let go of the array.
    """

    #: Interrupts and checkpoints wait for the end of a block.
    longest_block = LONGEST
    STATE: ClassVar = {"gap": InFrame("contact"), "tiles": Tiles, "_course": Numbers, "_ledger": Ledger}
    SCRATCH: ClassVar = ("_search", "_steps", "_tables")

    def __init__(self, task: ContactTask, heights: FloatArray, executor: Executor) -> None:
        assert task.is_uniform  # others are those of a track
        foresee(task, executor)
        self.task = task
        self._executor = executor
        if executor.device.is_cpu:
            self.longest_block = min(self.longest_block, max(int(CELLS_OF_REPLAY / executor.grid.cells), 1))
        self._ledger = Ledger(task, executor.grid)
        #: Gap from the mean planes as worn, and as it was without wear [mm]: what is worn lies between. Steps
        #: near a late contact move three fields, not six; their rounding is that of the gap, 1e-17 mm a step.
        self.gap, self._unworn = gap_over(task.form, heights, executor), executor.zeros()
        wp.copy(self._unworn, self.gap)
        fully = task.load / (task.hardness * executor.grid.cell_area)
        self.tiles = Tiles(executor, self.gap, self._unworn, least=SPARE * fully)
        self._search = LoadSearch(
            executor,
            self.gap,
            self.tiles,
            load=task.load,
            hardness=task.hardness,
            tolerance=task.load_tolerance if task.rigid else None,
        )
        device = executor.device
        #: What the steps on the device remember.
        self._course = Numbers(wear.RestMemory, device, extents=[NO_INDEX] * 4)
        columns = len(wear.BALANCE) + len(SUMS) + len(MAXIMA)
        self._steps = arguments(
            wear.RestSteps,
            device,
            plan=(LONGEST + 1, len(wear.PLAN)),
            history=(LONGEST, columns),
            within=wp.array(self._ledger.within, dtype=wp.float64, device=device),
            memory=self._course.array,
            is_rigid=int(task.rigid),
            smallest=self.tiles.smallest,
        )
        self._slots = slots = executor.slots_of(executor.grid.nx, most=MOST_SLOTS)
        tables = {"sums": (len(SUMS), slots), "maxima": (len(MAXIMA), slots), "ahead": (3, slots)}
        self._tables = arguments(wear.Tables, device, **tables)
        # Many steps; and one, between whose search and wear its pressures can be seen.
        self._many = Program(executor)
        self._to_search, self._to_wear = (Program(executor, records=2) for _ in range(2))
        self._begin(self._many)
        with self._many.loop(self._steps.stepping):
            self._add_search(self._many)
            for _ in range(1 if device.is_cpu else AT_A_LOOK):
                self._add_wear(self._many)
        self._begin(self._to_search)
        self._add_search(self._to_search)
        self._add_wear(self._to_wear)

    def below_bounds(self) -> float:
        """Ask its tiles, see `Model.below_bounds`."""
        return self.tiles.below_bounds()

    def _begin(self, program: Program) -> None:
        program.decide(wear.record, self._search.springs, self._steps, self._tables)

    def _add_search(self, program: Program) -> None:
        """Return the search of a step, and the list of tiles that its wear needs."""
        self._search.add_to(program, wear.judge_area if self.task.rigid else wear.judge, self._steps)
        self.tiles.add_to(program)

    def _add_wear(self, program: Program) -> None:
        """Return the wear of a step, and its row."""
        listed, steps = self.tiles, self._steps
        program.launch(
            wear.wear_step,
            *(listed.list, listed.count, self._search.law, steps.increment),
            *(self._unworn, listed.rest, self.gap, self._tables),
            slots=self._slots,
            chunks=lambda: listed.chunks,
        )
        program.decide(wear.record, self._search.springs, steps, self._tables)

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """Return the fields after the last step, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        gap = self._executor.to_numpy(self.gap)
        counter, disc = self.worn_depths(gap)
        snapshot = Snapshot(distance, pressure=step.pressure, wear_counter=counter, wear_disc=disc, gap=gap)
        # A GPU's fields are copied to be seen, and the others are made for this step.
        return replace(
            snapshot, fresh=frozenset(snapshot.fields) - ({"gap"} if self._executor.device.is_cpu else set())
        )

    def worn_depths(self, gap: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Depths worn off ball and disc so far [mm], shape (nx, ny). gap: as it is, where it is at hand."""
        first, end = self._ledger.columns  # nothing is worn beyond them
        gap = self._executor.to_numpy(self.gap) if gap is None else gap
        unworn = self._executor.to_numpy(self._unworn)
        both = np.zeros(gap.shape)
        np.subtract(gap[:, first:end], unworn[:, first:end], out=both[:, first:end])
        of_counter, of_disc = self.task.wear_fractions
        counter = np.zeros(gap.shape)
        np.multiply(of_counter, both[:, first:end], out=counter[:, first:end])
        both[:, first:end] *= of_disc
        return counter, both

    @property
    def in_blocks(self) -> bool:
        """Whether steps can be made in a row: not where 1/c of one follows from the area of the last."""
        return not self.task.bulk_updated

    def replay(
        self, increments: Sequence[float], then: float | None
    ) -> tuple[int, Iterator[Step | StepColumns]]:
        """Make steps on the device, before the first of them is seen."""
        removals = self._write_plan(increments, then)
        self._many.run()
        return self._course["step"], self._booked(increments, removals)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact, then slide by the increment [mm] and wear both bodies.

        then: the next increment, where it is known [mm]; the pass that wears evaluates for it as well.

        Raises ConvergenceError when the load cannot be balanced.
        """
        removals = self._write_plan([increment], None if self.task.bulk_updated else then)
        if not with_pressure:
            self._many.run()
            self.check()
            return next(each_step(self._booked([increment], removals)))
        self._to_search.run()
        self.check()
        pressure = self._search.pressures()
        self._to_wear.run()
        return next(each_step(self._booked([increment], removals)))._replace(pressure=pressure)

    def check(self) -> None:
        """Raise ConvergenceError for a step that was not made."""
        if self._course["failed"]:
            self._search.check()

    def _write_plan(self, increments: Sequence[float], then: float | None) -> FloatArray:
        """Write the plan of the next steps, and of the one after them; return K ΔL of counter and disc.

        A row is a step [mm³/N].
        """
        known = [*increments, *([] if then is None else [then])]
        removals = wear_in_steps(self.task.wear, self._ledger.row["distance"], known)
        counter, disc = removals.T
        compliance = np.full(len(known), self.task.compliance_at(self._ledger.row["area_contact"]))
        if self.task.implicit:
            compliance = (compliance + counter) + disc
        plan = np.stack([counter + disc, stiffness_of(compliance)], axis=1)
        self._executor.put(self._steps.plan[: len(plan)], plan)
        self._course.set(step=0, steps=len(increments), known=len(known))
        return removals

    def _booked(self, increments: Sequence[float], removals: FloatArray) -> Iterator[Step | StepColumns]:
        """Return the steps that the device has made, as the ledger enters them."""
        count = self._course["step"]
        table = np.ascontiguousarray(self._steps.history[: max(count, 1)].numpy()[:count].T)
        base, offset, cap, residual, *others = table[: len(wear.BALANCE)]
        sums, maxima = table[len(wear.BALANCE) :][: len(SUMS)], table[len(wear.BALANCE) + len(SUMS) :]
        total, most = dict(zip(SUMS, sums, strict=True)), dict(zip(MAXIMA, maxima, strict=True))
        if not self.task.rigid:
            residual = total["pressure"] * self._executor.grid.cell_area - self.task.load
        total, most = (split_wear(part, self.task.wear_fractions) for part in (total, most))
        removed, balance = removals[:count].T, Balance(base, offset, cap, residual, *others[:-1])
        steps = Entry(balance, np.array(increments[:count]), tuple(removed), others[-1], total, most)
        return booked(self._ledger, steps, self._enter)

    def _enter(self, balance: Balance, *columns: Any) -> Step:
        """Book a step. Raises ConvergenceError where its pressures do not carry the load."""
        if not self.task.rigid:
            checked_residual(balance.load_residual, self.task.load, approach=balance.approach)
        return self._ledger.enter(balance, *columns)
