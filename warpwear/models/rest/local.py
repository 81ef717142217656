"""One grid: a sphere wearing with a disc, smooth on a foundation (macro) or with every asperity (micro).

Every cell has the same stiffness, and both bodies wear in one proportion. Other laws, of cell by cell, are
those of a track on which the disc does not move.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from warpwear import lazy
from warpwear.contact.balance import (
    STEPS_AHEAD,
    Balance,
    Balancer,
    Carried,
    Foundation,
    Lookahead,
    residual_of,
    stiffness_of,
)
from warpwear.contact.bearing_area import BearingArea
from warpwear.contact.foresight import Foresight
from warpwear.engine.executor import Executor, Field, arguments, set_numbers
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step, divided
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import contact, wear
from warpwear.kernels.cells import WearMost, WearSum, names_of
from warpwear.kernels.contact import Law
from warpwear.kernels.wear_loops import Increment, Tables
from warpwear.laws.archard import removals_of
from warpwear.laws.task import ContactTask
from warpwear.models.booking import Found, booked
from warpwear.models.model import Model
from warpwear.models.rest.bodies import RestingBodies

if TYPE_CHECKING:
    from warpwear.models.on_cpu import Block
    from warpwear.models.on_gpu import DeviceSteps

one_gap = lazy.module("warpwear.kernels.blocks.one_gap")
on_cpu = lazy.module("warpwear.models.on_cpu")
on_gpu = lazy.module("warpwear.models.on_gpu")

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 2.0
SUMS, MAXIMA = names_of(WearSum), names_of(WearMost)


class OneScaleModel(Model):
    """Contact and wear of one task, with the same law for every cell, on one executor.

    heights: of the disc over its mean plane [mm], shape (nx, ny). The caller may let go of the array.
    """

    #: Interrupts and checkpoints wait for the end of a block.
    longest_block = 500
    STATE: ClassVar = {
        "state": RestingBodies,
        "tiles": Tiles,
        "_last": Balance,
        "_foresight": Foresight,
        "_lookahead": Lookahead,
        "_ledger": Ledger,
    }

    def __init__(self, task: ContactTask, heights: FloatArray, executor: Executor) -> None:
        assert task.is_uniform  # others are those of a track
        in_blocks = [one_gap.wear_gap] if executor.in_one_launch else []
        executor.foresee([contact.gap, wear.wear_step, *in_blocks])
        self.task = task
        self._executor = executor
        self._balancer, self._bearing_area = Balancer(executor), BearingArea(executor)
        self._stiffnesses: dict[float, Field] = {}
        self._last: Balance | None = None
        self._foresight = Foresight()
        self._lookahead: Lookahead | None = None
        self._ledger = Ledger(task, executor.grid)
        self.state = RestingBodies.of(task, executor, heights)
        fully = task.load / (task.hardness * executor.grid.cell_area)
        self.tiles = Tiles(executor, self.state.gap, self.state.unworn, least=SPARE * fully)
        self._highest = self._bearing_area.bounds(self.state.gap, self.tiles)[1]
        #: Whether 1/c of a step is known before it.
        self._foreseen = not task.rigid and not task.bulk_updated
        #: Whether steps are made in blocks on the device: all but those of laws that the device loop lacks.
        self.blocks_allowed = executor.device.is_cuda and self._foreseen
        self._loop: DeviceSteps | None = None
        if self.blocks_allowed:
            self.longest_block = on_gpu.LONGEST_BLOCK
        self._law, self._increment = arguments(Law), arguments(Increment)
        sums, maxima = executor.partials(len(SUMS)), executor.partials(len(MAXIMA))
        self._tables = arguments(Tables, sums=sums, maxima=maxima, ahead=self._balancer.lookahead)
        self._block: Block | None = None
        if executor.in_one_launch and self._foreseen:
            parts = [self.state.unworn, self.tiles.rest, self.state.gap, self._tables]
            self._block = on_cpu.Block(executor, task, one_gap.wear_gap, parts, (SUMS, MAXIMA))

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        gap = self._executor.to_numpy(self.state.gap)
        sphere, disc = self.worn(gap)
        made = Snapshot(distance, pressure=step.pressure, wear_sphere=sphere, wear_disc=disc, gap=gap)
        # A GPU's fields are copied to be seen, and the others are made for this step.
        return replace(
            made, fresh=frozenset(made.fields) - ({"gap"} if self._executor.device.is_cpu else set())
        )

    def worn(self, gap: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Depths worn off sphere and disc so far [mm], shape (nx, ny). gap: as it is, where it is at hand."""
        first, end = self._ledger.columns  # nothing is worn beyond them
        gap = self._executor.to_numpy(self.state.gap) if gap is None else gap
        unworn = self._executor.to_numpy(self.state.unworn)
        both = np.zeros(gap.shape)
        np.subtract(gap[:, first:end], unworn[:, first:end], out=both[:, first:end])
        of_sphere, of_disc = self.state.fractions
        sphere = np.zeros(gap.shape)
        np.multiply(of_sphere, both[:, first:end], out=sphere[:, first:end])
        both[:, first:end] *= of_disc
        return sphere, both

    @property
    def in_blocks(self) -> bool:
        """Whether the device makes the next steps by itself."""
        return (self.blocks_allowed or self._block is not None) and self._last is not None

    def block(self, increments: Sequence[float], then: float | None = None) -> Iterator[Step]:
        """Steps made on the device in one go, before the first of them is seen."""
        assert self._last is not None
        if not self.blocks_allowed:
            assert self._block is not None
            for beyond, booked_step in self._in_one_launch(self._block, increments, then):
                self.steps_in_flight = beyond
                yield booked_step
            return
        if self._loop is None:
            self._loop = on_gpu.at_rest(self._executor, self.task, self.state.gap, self.state.unworn)
        removals = removals_of(self.task.wear, self._ledger.row["distance"], increments)
        mean, slid, done = self._ledger.row["pressure_mean"], np.array(increments), 0
        for found in self._loop.run(
            removals, approach=self._last.approach, mean_pressure=mean, foresight=self._foresight
        ):
            approaches = (found.balance.base + found.balance.offset).tolist()
            for approach, removed in zip(approaches, removals[done:], strict=False):
                self._foresight.note(approach, sum(removed))
            self._last = found.balance._make(float(part[-1]) for part in found.balance)
            self._lookahead = None
            yield from booked(self._of_both(found), self._ledger, slid[done:], removals[done:], self._enter)
            done += found.made

    def _in_one_launch(
        self, block: "Block", increments: Sequence[float], then: float | None
    ) -> Iterator[tuple[int, Step]]:
        """Steps as `advance` makes them, as many in a launch as it can, and how many are made beyond each."""
        known = [*increments, *([] if then is None else [then])]
        removals = removals_of(self.task.wear, self._ledger.row["distance"], known)
        slid = np.array(increments)
        plan = np.array([(sum(removed), 0.0, 0.0, self._stiffness_of(*removed)) for removed in removals])

        def launch(done: int) -> tuple[int, Iterator[Step]]:
            ahead = self._lookahead
            assert self._last is not None
            foreseen = {}
            if ahead is not None and ahead.stiffness == plan[done, 3]:
                foreseen = {"known": 1.0, "ahead": ahead.offset} | ahead.carried._asdict()
            found, left = block.run(
                plan[done:],
                len(increments) - done,
                self.tiles,
                self._ledger,
                {"approach": self._last.approach, "mean": self._ledger.row["pressure_mean"]}
                | self._foresight.numbers
                | foreseen,
            )
            if found.made:
                self._foresight.numbers, self._lookahead = left, None
                self._last = found.balance._make(float(part[-1]) for part in found.balance)
            if found.made and left["known"]:
                carried = Carried(left["force"], left["slope"], left["straight"])
                self._lookahead = Lookahead(float(plan[done + found.made, 3]), left["ahead"], carried)
            residual = found.total["pressure"] * self._executor.grid.cell_area - self.task.load
            found = self._of_both(found._replace(balance=found.balance._replace(load_residual=residual)))
            return found.made, booked(found, self._ledger, slid[done:], removals[done:], self._enter)

        def alone(number: int) -> Step:
            return self.advance(
                increments[number], then=known[number + 1] if number + 1 < len(known) else None
            )

        return on_cpu.in_launches(len(increments), launch, alone)

    def _of_both(self, found: Found) -> Found:
        """What was worn of both bodies together, as that of sphere and disc."""
        total, most = (divided(part, self.state.fractions) for part in (found.total, found.most))
        return found._replace(total=total, most=most)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact, then slide by the increment [mm] and wear both bodies.

        then: the next increment, where it is known [mm]; the pass that wears evaluates for it as well.

        Raises ConvergenceError when the load cannot be balanced.
        """
        task, now, row = self.task, self._increment, self._ledger.row
        removal = task.removals(row["distance"], increment)
        stiffness = self._stiffness_of(*removal)
        balance = self._balance(stiffness, sum(removal))
        self._foresight.note(balance.approach, sum(removal))
        balance.fill(self._law)
        pressure = None
        if with_pressure:
            row_of_cells = self._row_of(stiffness)
            pressure = self._balancer.pressures(self._law, row_of_cells, self.state.gap, self.tiles)
        # The scatter is summed about a value near the mean: of a bearing area the mean itself.
        near_mean = balance.cap if task.rigid else row["pressure_mean"] or balance.cap
        reference = near_mean if math.isfinite(near_mean) else 0.0
        step_next, stiffness_next = 0.0, stiffness
        if then is not None and self._foreseen and not self.blocks_allowed:
            removal_next = task.removals(row["distance"] + increment, then)
            stiffness_next = self._stiffness_of(*removal_next)
            step_next = self._foresight.expected(sum(removal_next)) or 0.0
            furthest = balance.approach + max(step_next, 0.0)
            self.tiles.reach(furthest, margin=STEPS_AHEAD * abs(step_next))
        first, end = self._ledger.columns
        set_numbers(
            now,
            wear_per_pressure=sum(removal),
            first_column=first if end else self._executor.grid.ny,
            last_column=end - 1,
            stiffness=stiffness,
            reference=reference,
            base_next=balance.approach,
            offset_next=step_next,
            stiffness_next=stiffness_next,
        )
        self._executor.launch(
            wear.wear_step,
            inputs=[self._law, now, self.state.unworn, self.tiles.rest],
            outputs=[self.state.gap, self._tables],
            over=self.tiles,
            often=True,
        )
        self._lookahead = None
        if step_next:
            carried = self._balancer.evaluated(self._balancer.lookahead)
            self._lookahead = Lookahead(stiffness_next, step_next, carried)
        total = dict(zip(SUMS, self._tables.sums.numpy().sum(axis=1).tolist(), strict=True))
        most = dict(zip(MAXIMA, self._tables.maxima.numpy().max(axis=1).tolist(), strict=True))
        total, most = (divided(found, self.state.fractions) for found in (total, most))
        self._last = balance
        return self._enter(balance, increment, removal, reference, total, most, pressure)

    def _enter(
        self,
        balance: Balance,
        increment: float,
        removal: tuple[float, float],
        reference: float,
        total: dict[str, float],
        most: dict[str, float],
        pressure: FloatArray | None = None,
    ) -> Step:
        """Book a step. Raises ConvergenceError where its pressures do not carry the load."""
        if not self.task.rigid:
            force = total["pressure"] * self._executor.grid.cell_area
            residual = residual_of(force, self.task.load, approach=balance.approach)
            balance = balance._replace(load_residual=residual)
        return self._ledger.enter(balance, increment, removal, reference, total, most, pressure=pressure)

    def _balance(self, stiffness: float, removal: float) -> Balance:
        task, last = self.task, self._last
        if task.rigid:
            return self._bearing_area.solve(
                self.state.gap,
                self.tiles,
                load=task.load,
                hardness=task.hardness,
                tolerance=task.load_tolerance,
                scatter=STEPS_AHEAD * removal * task.hardness,
                highest=self._highest,
            )
        # A worn contact recedes by K p ΔL: where the last mean pressure puts it is a close first guess.
        step, known = removal * self._ledger.row["pressure_mean"], None
        if self._lookahead is not None and self._lookahead.stiffness == stiffness:
            step, known = self._lookahead.offset, self._lookahead.carried
        row = self._row_of(stiffness)
        return self._balancer.solve(
            Foundation(self.state.gap, row, self.tiles, task.load, task.hardness, stiffness),
            start=last.approach if last else None,
            step=step,
            known=known,
        )

    def _stiffness_of(self, removal_sphere: float, removal_disc: float) -> float:
        """1/c [N/mm³] of a step that wears sphere and disc by K ΔL [mm³/N]."""
        compliance = self.task.compliance_at(self._ledger.row["area_contact"])
        if self.task.implicit:
            compliance = (compliance + removal_sphere) + removal_disc
        return stiffness_of(compliance)

    def _row_of(self, stiffness: float) -> Field:
        """One row for all cells; those of the last two steps are kept."""
        if stiffness not in self._stiffnesses:
            while len(self._stiffnesses) > 1:
                del self._stiffnesses[next(iter(self._stiffnesses))]
            row = self._executor.field(np.full((1, 1), stiffness), padding=stiffness)
            self._stiffnesses[stiffness] = row
        return self._stiffnesses[stiffness]
