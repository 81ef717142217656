"""One grid: a sphere wearing with a disc, smooth on a foundation (macro) or with every asperity (micro)."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import ClassVar

from warpwear.contact.balance import STEPS_AHEAD, Ahead, Balance, Balancer, residual_of
from warpwear.contact.bearing_area import BearingArea
from warpwear.contact.foresight import Foresight
from warpwear.engine.executor import Executor, Field
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import contact
from warpwear.kernels import wear as removal_kernels
from warpwear.kernels.cells import MAXIMA, SUMS
from warpwear.laws.archard import distance_factor, removals_of
from warpwear.laws.task import ContactTask
from warpwear.models.model import Model
from warpwear.models.rest.bodies import State
from warpwear.models.rest.on_gpu import DeviceLoop
from warpwear.models.rest.recession import Logistic, Recession
from warpwear.models.rest.stiffness import Stiffness, Stiffnesses

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 2.0


class OneScaleModel(Model):
    """Contact and wear of one study on one executor.

    heights: of the disc over its mean plane [mm], shape (nx, ny). The caller may let go of the array.
    bearing_curve: of a roughness that the grid does not resolve, by which the disc runs in.
    """

    #: Steps made on a device before their history is read.
    longest_block = 500
    STATE: ClassVar = {
        "state": State,
        "_recession": Recession,
        "tiles": Tiles,
        "_last": Balance,
        "_foresight": Foresight,
        "_ahead": Ahead,
        "_ledger": Ledger,
    }

    def __init__(
        self,
        task: ContactTask,
        heights: FloatArray,
        executor: Executor,
        *,
        bearing_curve: Logistic | None = None,
    ) -> None:
        self.task = task
        self._executor = executor
        self._rigid = task.rigid
        #: 1/k of the foundation [mm³/N], None where it follows the contact.
        self._compliance = None if task.foundation_updated else task.compliance
        self._balancer, self._bearing_area = Balancer(executor), BearingArea(executor)
        self._sums = executor.partials(len(SUMS))
        self._maxima = executor.partials(len(MAXIMA))
        curvature = task.curvature
        self._factor = distance_factor(executor.grid, task.distance_factor, curvature=curvature)
        self._factor_field = executor.field(self._factor)
        implicit = task.implicit
        self._stiffness = Stiffnesses(executor, self._factor, implicit=implicit)
        self._recession = (
            None if bearing_curve is None else Recession(bearing_curve, executor, self._factor_field)
        )
        self._last: Balance | None = None
        self._foresight = Foresight()
        self._ahead: Ahead | None = None
        self._ledger = Ledger(task, executor.grid)
        #: Whether the share of the sphere changes from step to step.
        self._share_changes = not task.in_proportion
        #: 1 where every cell has the same 1/c and share.
        self._alike = int(
            task.distance_factor == "none" and not self._share_changes and self._recession is None
        )
        self.state = State.of(executor, heights, task.wear, curvature=curvature, factor=self._factor)
        self.state.changing += ("share",) * self._share_changes + ("unworn",) * (bearing_curve is not None)
        grid = executor.grid
        fully = task.load / (task.hardness * grid.cell_area)
        self.tiles = Tiles(executor, self.state.gap, self.state.unworn, self.state.share, least=SPARE * fully)
        self._highest = self._bearing_area.bounds(self.state.gap, self.tiles)[1]
        #: Whether 1/c of a step is known before it.
        self._foreseen = not self._rigid and self._recession is None and self._compliance is not None
        #: Whether steps are made in blocks on the device: all but those of laws that the device loop lacks.
        self.blocks_allowed = executor.device.is_cuda and self._foreseen
        self._loop: DeviceLoop | None = None

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        sphere, disc = self.worn()
        gap = self._executor.to_numpy(self.state.gap)
        return Snapshot(distance, pressure=step.pressure, wear_sphere=sphere, wear_disc=disc, gap=gap)

    def worn(self) -> tuple[FloatArray, FloatArray]:
        """Depths worn off sphere and disc so far [mm], shape (nx, ny)."""
        return self.state.worn(self._executor)

    @property
    def in_blocks(self) -> bool:
        """Whether the device makes the next steps by itself."""
        return self.blocks_allowed and self._last is not None

    def block(self, increments: Sequence[float]) -> Iterator[Step]:
        """Steps made on the device in one go, before the first of them is seen."""
        assert self._last is not None
        assert self._compliance is not None
        if self._loop is None:
            self._loop = DeviceLoop(
                self._executor,
                self.state.gap,
                self.state.unworn,
                self.state.share,
                self._factor_field,
                load=self.task.load,
                hardness=self.task.hardness,
                compliance=self._compliance,
                implicit=self.task.implicit,
                share_changes=self._share_changes,
            )
        removals = removals_of(self.task.wear, self._ledger.row["distance"], increments)
        mean = self._ledger.row["pressure_mean"]
        made = self._loop.run(removals, approach=self._last.approach, mean_pressure=mean)
        for increment, removed, step in zip(increments, removals, made, strict=True):
            self._last, self._ahead = step.balance, None
            self._foresight.note(step.balance.approach, sum(removed))
            reference = self._ledger.row["pressure_mean"]
            total, most = self.state.divide(step.totals), self.state.divide(step.most)
            yield self._ledger.enter(step.balance, increment, removed, reference, total, most)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Solve the contact, then slide by the increment [mm] and wear both bodies.

        then: the next increment, where it is known [mm]; the pass that wears evaluates for it as well.

        Raises ConvergenceError when the load cannot be balanced.
        """
        removal = self._removal(0.0, increment)
        stiffness = self._stiffness_of(*removal)
        balance = self._balance(stiffness, sum(removal))
        self._foresight.note(balance.approach, sum(removal))
        law = [*balance.law]
        pressure = None
        if with_pressure:
            field = self._executor.zeros()
            self._executor.launch(
                contact.pressures,
                inputs=[*law, stiffness.field, self.state.gap],
                outputs=[field],
                over=self.tiles,
            )
            pressure = self._executor.to_numpy(field)
        bearing = None
        if self._recession is not None:
            bearing = self._recession.cells_bearing(balance, self.state.gap, self._wear_of_disc())
        # The scatter is summed about a value near the mean: of a bearing area the mean itself.
        near_mean = balance.cap if self._rigid else self._ledger.row["pressure_mean"] or balance.cap
        reference = near_mean if math.isfinite(near_mean) else 0.0
        step_next, stiffness_next = 0.0, stiffness
        if then is not None and self._foreseen and not self.blocks_allowed:
            removal_next = self._removal(increment, then)
            stiffness_next = self._stiffness_of(*removal_next)
            step_next = self._foresight.expected(sum(removal_next)) or 0.0
            furthest = balance.approach + max(step_next, 0.0)
            self.tiles.reach(furthest, ahead=STEPS_AHEAD * abs(step_next))
        most = self._ledger.most
        known = (self._executor.grid.ny, -1)  # first and last column that were touched
        if math.isfinite(most["first_column"]):
            known = int(-most["first_column"]), int(most["last_column"])
        listed = [self._factor_field, self.state.share, self.state.unworn, self.tiles.rest]
        if self._share_changes:
            self._executor.launch(
                removal_kernels.divide,
                inputs=[
                    *law,
                    *removal,
                    stiffness.field,
                    self._factor_field,
                    self.state.unworn,
                    self.state.gap,
                ],
                outputs=[self.state.share],
                over=self.tiles,
                often=True,
            )
        self._executor.launch(
            removal_kernels.remove,
            inputs=[
                *law,
                *removal,
                reference,
                balance.approach,
                step_next,
                self._alike,
                *known,
                stiffness.field,
                stiffness_next.field,
                *listed,
            ],
            outputs=[self.state.gap, self._sums, self._maxima, self._balancer.ahead],
            over=self.tiles,
            often=True,
        )
        self._ahead = None
        if step_next:
            carried = self._balancer.evaluated(self._balancer.ahead)
            self._ahead = Ahead(stiffness_next.made_for, step_next, carried)
        if self._recession is not None:
            self._recession.recede(self._wear_of_disc(), self.state.gap, self.state.unworn)
        total = self.state.divide(dict(zip(SUMS, self._sums.numpy().sum(axis=1).tolist(), strict=True)))
        most = self.state.divide(dict(zip(MAXIMA, self._maxima.numpy().max(axis=1).tolist(), strict=True)))
        if not self._rigid:
            force = total["pressure"] * self._executor.grid.cell_area
            residual = residual_of(force, self.task.load, approach=balance.approach)
            balance = replace(balance, load_residual=residual)
        self._last = balance
        return self._ledger.enter(
            balance, increment, removal, reference, total, most, pressure=pressure, bearing=bearing
        )

    def _removal(self, later: float, increment: float) -> tuple[float, float]:
        """Of sphere and disc [mm³/N], over an increment that begins so much later than now [mm]."""
        return self.task.removals(self._ledger.row["distance"] + later, increment)

    def _balance(self, stiffness: Stiffness, removal: float) -> Balance:
        load = self.task.load
        if self._rigid:
            return self._bearing_area.solve(
                self.state.gap,
                self.tiles,
                highest=self._highest,
                load=load,
                hardness=self.task.hardness,
                tolerance=self.task.load_tolerance,
                step=removal * self.task.hardness,
            )
        # A worn contact recedes by K p ΔL: where the last mean pressure puts it is a close first guess.
        step, known = removal * self._ledger.row["pressure_mean"], None
        if self._ahead is not None and self._ahead.made_for == stiffness.made_for:
            step, known = self._ahead.offset, self._ahead.carried
        return self._balancer.foundation(
            self.state.gap,
            stiffness.field,
            self.tiles,
            load=load,
            hardness=self.task.hardness,
            start=self._last.approach if self._last else None,
            step=step,
            stiffest=stiffness.stiffest,
            known=known,
        )

    def _stiffness_of(self, removal_sphere: float, removal_disc: float) -> Stiffness:
        """Of a step that removes so much [mm³/N]; one row where all are alike."""
        compliance = self._compliance
        if compliance is None:
            area = self._ledger.row["area_contact"]
            compliance = 1.0 / self.task.foundation_at(math.sqrt(area / math.pi) if area else None)
        if self._recession is not None:
            compliance += removal_sphere
            field = self._recession.stiffness(compliance, removal_disc, self._wear_of_disc())
            return Stiffness((compliance, removal_sphere, removal_disc), field, math.inf)
        return self._stiffness.of(compliance, removal_sphere, removal_disc)

    def _wear_of_disc(self) -> Field:
        """A field of its own [mm]: for laws that are evaluated cell by cell on few cells."""
        return self._executor.field(self.worn()[1])
