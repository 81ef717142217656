"""One grid: a sphere wearing with a disc, smooth on a foundation (macro) or with every asperity (micro)."""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from warpwear.balance import RIGID, Balance, Balancer
from warpwear.device_loop import DeviceLoop
from warpwear.execution import Executor, Field
from warpwear.grid import FloatArray
from warpwear.kernels import contact, gap, removal
from warpwear.kernels.types import MAXIMA, SUMS
from warpwear.kinematics import distance_factor
from warpwear.ledger import Ledger, Step
from warpwear.results import Snapshot
from warpwear.running_in import Logistic, Recession
from warpwear.study import Study
from warpwear.tiles import Tiles

#: Steps made on a device before their history is read.
LONGEST_BLOCK = 500
#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 2.0


@dataclass
class State:
    """Fields of nx × ny cells [mm], on the executor's device."""

    gap: Field  # from the mean planes, as worn
    wear_sphere: Field
    wear_disc: Field


class OneScaleModel:
    """Contact and wear of one study on one executor.

    heights: of the disc over its mean plane [mm], shape (nx, ny). The caller may let go of the array.
    bearing_curve: of a roughness that the grid does not resolve, by which the disc runs in.
    """

    def __init__(
        self, study: Study, heights: FloatArray, executor: Executor, *, bearing_curve: Logistic | None = None
    ) -> None:
        self.study = study
        self._executor = executor
        self._wear = study.wear_laws
        self._balancer = Balancer(executor)
        self._sums = executor.partials(len(SUMS))
        self._maxima = executor.partials(len(MAXIMA))
        curvature = study.sphere.curvature
        self._factor = distance_factor(executor.grid, study.wear.distance_factor, curvature=curvature)
        self._factor_field = executor.field(self._factor)
        self._stiffness: tuple[tuple[float, float, float], Field] | None = None  # with what it was made for
        self._recession = (
            None if bearing_curve is None else Recession(bearing_curve, executor, self._factor_field)
        )
        self._last: Balance | None = None
        self._ledger = Ledger(study, executor.grid)
        self.state = State(executor.zeros(), executor.zeros(), executor.zeros())
        grid = executor.grid
        executor.launch(
            gap.gap,
            inputs=[
                grid.ny,
                grid.cell,
                float(grid.x[0]),
                float(grid.y[0]),
                curvature,
                executor.field(heights),
                self.state.wear_sphere,
                self.state.wear_disc,
            ],
            outputs=[self.state.gap],
        )
        fully = study.contact.load / (study.hardness * grid.cell_area)
        self.tiles = Tiles(
            executor, self.state.gap, self.state.wear_sphere, self.state.wear_disc, least=SPARE * fully
        )
        self._highest = self._balancer.bounds(self.state.gap, self.tiles)[1]
        #: Whether steps are made in blocks on the device: all but those of laws that the device loop lacks.
        self.in_blocks = (
            executor.device.is_cuda
            and not study.uses_bearing_area
            and self._recession is None
            and (study.study.model == "micro" or study.contact.foundation_update == "initial")
        )
        self._loop: DeviceLoop | None = None
        #: Steps that the state is ahead of the last one given, in a block.
        self.ahead = 0

    def saved_state(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and numbers that the steps so far have changed: all that `restore` needs.

        On a CPU fields are views of their memory. Not to be asked while steps are ahead.
        """
        arrays = {name: self._executor.to_numpy(field) for name, field in self._changing().items()}
        of_tiles, numbers = self.tiles.saved_state()
        last = None if self._last is None else asdict(self._last)
        return arrays | of_tiles, {
            "tiles": numbers,
            "last": last,
            "most": self._ledger.most,
            "row": self._ledger.row,
        }

    def restore(self, arrays: Mapping[str, Any], numbers: Mapping[str, Any]) -> None:
        """Go on from the state that another model of the same study, surface and device saved."""
        for name, field in self._changing().items():
            self._executor.fill(field, arrays[name])
        self.tiles.restore(arrays, numbers["tiles"])
        self._last = None if numbers["last"] is None else Balance(**numbers["last"])
        self._ledger.most, self._ledger.row = dict(numbers["most"]), dict(numbers["row"])

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """The fields after the last step given, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        state, to_numpy = self.state, self._executor.to_numpy
        return Snapshot(
            distance,
            pressure=step.pressure,
            wear_sphere=to_numpy(state.wear_sphere),
            wear_disc=to_numpy(state.wear_disc),
            gap=to_numpy(state.gap),
        )

    def _changing(self) -> dict[str, Field]:
        """The fields that steps change."""
        fields = dict(vars(self.state))
        return fields if self._recession is None else fields | {"beyond": self._recession.beyond}

    def steps(self, plan: Iterable[tuple[float, bool]]) -> Iterator[Step]:
        """One step for each increment [mm] of the plan, with its pressure where that is asked for.

        On a GPU steps whose pressure nobody asks for are made in blocks, before the first of them is seen.
        """
        block: list[float] = []
        for increment, with_pressure in plan:
            if self.in_blocks and self._last is not None and not with_pressure:
                block.append(increment)
                if len(block) < LONGEST_BLOCK:
                    continue
            yield from self._block(block)
            block = []
            if not self.in_blocks or with_pressure or self._last is None:
                yield self.advance(increment, with_pressure=with_pressure)
        yield from self._block(block)

    def _block(self, increments: list[float]) -> Iterator[Step]:
        """Steps made on the device in one go."""
        if not increments:
            return
        if self._loop is None:
            self._loop = DeviceLoop(
                self._executor,
                self.state.gap,
                self.state.wear_sphere,
                self.state.wear_disc,
                self._factor_field,
                load=self.study.contact.load,
                hardness=self.study.hardness,
                compliance=self.study.law().compliance,
                implicit=self.study.stepping.scheme == "implicit",
            )
        assert self._last is not None
        ends = itertools.accumulate(increments, initial=self._ledger.row["distance"])
        removals = [
            (sphere, disc)
            for start, increment in zip(ends, increments, strict=False)
            for sphere, disc in [[law.removal(start, increment) for law in self._wear]]
        ]
        mean = self._ledger.row["pressure_mean"]
        made = self._loop.run(removals, approach=self._last.approach, mean_pressure=mean)
        self.ahead = len(made)
        for increment, removed, step in zip(increments, removals, made, strict=True):
            self.ahead -= 1
            self._last = step.balance
            reference = self._ledger.row["pressure_mean"]
            yield self._ledger.enter(step.balance, increment, removed, reference, step.totals, step.most)

    def advance(self, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact, then slide by the increment [mm] and wear both bodies.

        Raises ConvergenceError when the load cannot be balanced.
        """
        removal_sphere, removal_disc = (
            law.removal(self._ledger.row["distance"], increment) for law in self._wear
        )
        stiffness = self._stiffness_of(removal_sphere, removal_disc)
        balance = self._balance(stiffness, removal_sphere + removal_disc)
        law = [*balance.law]
        pressure = None
        if with_pressure:
            field = self._executor.zeros()
            self._executor.launch(
                contact.pressures,
                inputs=[*law, stiffness, self.state.gap],
                outputs=[field],
                over=self.tiles,
            )
            pressure = self._executor.to_numpy(field)
        bearing = None
        if self._recession is not None:
            bearing = self._recession.cells_bearing(balance, self.state.gap, self.state.wear_disc)
        # The scatter is summed about a value near the mean: of a bearing area the mean itself.
        rigid = self.study.uses_bearing_area
        near_mean = balance.cap if rigid else self._ledger.row["pressure_mean"] or balance.cap
        reference = near_mean if math.isfinite(near_mean) else 0.0
        self._executor.launch(
            removal.remove,
            inputs=[
                *law,
                removal_sphere,
                removal_disc,
                reference,
                stiffness,
                self._factor_field,
                self.tiles.rest,
            ],
            outputs=[
                self.state.gap,
                self.state.wear_sphere,
                self.state.wear_disc,
                self._sums,
                self._maxima,
            ],
            over=self.tiles,
            often=True,
        )
        if self._recession is not None:
            self._recession.recede(self.state.wear_disc, self.state.gap)
        self._last = balance
        total = dict(zip(SUMS, self._sums.numpy().sum(axis=1).tolist(), strict=True))
        most = dict(zip(MAXIMA, self._maxima.numpy().max(axis=1).tolist(), strict=True))
        removal_of = removal_sphere, removal_disc
        return self._ledger.enter(
            balance, increment, removal_of, reference, total, most, pressure=pressure, bearing=bearing
        )

    def _balance(self, stiffness: Field, removal: float) -> Balance:
        load = self.study.contact.load
        if self.study.uses_bearing_area:
            return self._balancer.bearing(
                self.state.gap,
                self.tiles,
                highest=self._highest,
                load=load,
                hardness=self.study.hardness,
                tolerance=self.study.load_tolerance,
                step=removal * self.study.hardness,
            )
        # A worn contact recedes by K p ΔL: where the last mean pressure puts it is a close first guess.
        return self._balancer.foundation(
            self.state.gap,
            stiffness,
            self.tiles,
            load=load,
            hardness=self.study.hardness,
            start=self._last.approach if self._last else None,
            step=removal * self._ledger.row["pressure_mean"],
        )

    def _stiffness_of(self, removal_sphere: float, removal_disc: float) -> Field:
        """1/c of the cells of a step that removes so much [mm³/N]; one row where all are alike."""
        area = self._ledger.row["area_contact"]
        law = self.study.law(radius=math.sqrt(area / math.pi) if area else None)
        if self._recession is not None:
            compliance = law.compliance + removal_sphere
            return self._recession.stiffness(compliance, removal_disc, self.state.wear_disc)
        implicit = self.study.stepping.scheme == "implicit"
        made_for = (law.compliance, removal_sphere * implicit, removal_disc * implicit)
        if self._stiffness is None or self._stiffness[0] != made_for:
            values = self._factor * made_for[2]
            values += law.compliance + made_for[1]
            with np.errstate(divide="ignore"):
                np.reciprocal(values, out=values)
            np.minimum(values, RIGID, out=values)
            shape = (values.shape[0], self._executor.grid.ny)
            self._stiffness = made_for, self._executor.field(np.broadcast_to(values, shape))
        return self._stiffness[1]
