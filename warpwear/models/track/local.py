"""One grid in motion: a disc displaced by whole cells under a wearing sphere, step by step."""

import math
from collections import deque
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import RIGID, Balance, Balancer
from warpwear.contact.bearing_area import BearingArea
from warpwear.engine.executor import Executor, Field
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step, TrackLedger
from warpwear.kernels import contact, sliding
from warpwear.kernels.cells import LANES, STEP, STEP_MAXIMA
from warpwear.laws.archard import removals_of
from warpwear.laws.task import ContactTask
from warpwear.models.track.bodies import State
from warpwear.models.track.on_gpu import DeviceSliding
from warpwear.models.track.tiles import PerTile, SlidingTiles

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 1.25
#: Changes of the approach from which the next is expected, and how many times the largest it may be.
CHANGES, TIMES = 8, 2.0
#: Of a step before which nothing was touched.
NO_ROWS = {"first_row": -math.inf, "last_row": -math.inf}
#: What the approach may change by when nothing is known of it, and at least [mm].
FIRST_SCATTER, LEAST_SCATTER = 1.0e-4, 1.0e-6


class SlidingContact:
    """Contact and wear of one study while its disc moves under the sphere.

    A step visits what can touch at that displacement, and finds what visiting every cell would find. Every
    cell of either body slides by the increment of the step while it is in contact: a distance factor of the
    study is a matter of a disc that lies still, and is not applied.

    disc: heights over the mean plane [mm], shape (rows ≥ nx, ny); row i of the sphere lies on row i + shift.
    periodic: after the disc's last row comes its first. sphere: heights over the unworn apex [mm], shape
    (nx, ny), instead of those of the study's sphere. share: what this disc slides of the increment of the
    test: its volumes count 1/share times, as those of the whole stroke that it stands for.

    Raises ValueError for a disc that is shorter than the grid or of another width.
    """

    STATE: ClassVar = {
        "state": State,
        "tiles": SlidingTiles,
        "_kept": list,
        "_totals": list,
        "_approach": float,
        "_changes": deque,
        "_ledger": TrackLedger,
    }

    def __init__(
        self,
        task: ContactTask,
        disc: FloatArray,
        executor: Executor,
        *,
        periodic: bool = False,
        sphere: FloatArray | None = None,
        share: float = 1.0,
    ) -> None:
        grid = executor.grid
        self.state = State.of(task, executor, disc, sphere=sphere)
        self.task = task
        self.periodic = periodic
        self._executor = executor
        self._rows = disc.shape[0]
        self._share = share
        self._elastic = task.compliance
        self._implicit = task.implicit
        self.keeps_dents = task.keeps_dents
        self._balancer, self._bearing_area = Balancer(executor), BearingArea(executor)
        fully = task.load / (task.hardness * grid.cell_area)
        self.tiles = SlidingTiles(executor, self.state.sphere, self.state.disc, least=SPARE * fully)
        columns, device = executor.tiles_per_row, executor.device
        # Of every tile and of every row: cells of the sphere ever touched, wear of the sphere, of the disc,
        # what is displaced of the disc.
        rows = (grid.nx, grid.nx, self._rows, self.state.plastic_disc.shape[0])
        self._kept = [PerTile(n, columns, device) for n in rows]
        self._totals = [wp.zeros(n, dtype=wp.float64, device=device) for n in rows]
        self._sums = executor.partials(len(STEP))
        self._maxima = executor.partials(len(STEP_MAXIMA))
        self._stiffness: tuple[float, Field] | None = None  # with the compliance that it was made for
        self._approach: float | None = None
        self._changes: deque[float] = deque(maxlen=CHANGES)
        self._ledger = TrackLedger(task, executor.grid, share=share)
        self._loop: DeviceSliding | None = None
        #: Whether the device can make steps by itself: those of a contact with compliance.
        self.blocks_allowed = executor.device.is_cuda and not task.rigid

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        The row of the step has one column more, `plastic_volume_disc`.

        Raises ConvergenceError when the load cannot be balanced, ValueError when a disc that is not periodic
        would leave a part of the sphere without one.
        """
        shift = self.state.row_of(shift, periodic=self.periodic)
        self.tiles.displace(shift)
        distance = self._ledger.row["distance"]
        of_sphere, of_disc = self.task.removals(distance, increment)
        removal_sphere, removal_disc = of_sphere, self._share * of_disc
        compliance = self._compliance(removal_sphere + removal_disc)
        stiffness = self._stiffness_of(compliance)
        balance = self._balance(stiffness, compliance)
        near_mean = balance.cap if compliance == 0.0 else self._ledger.row["pressure_mean"] or balance.cap
        reference = near_mean if math.isfinite(near_mean) else 0.0
        pressure = self._pressures(balance, stiffness) if with_pressure else None
        state, tiles = self.state, self.tiles
        first, end = self._ledger.columns
        known = (first, end - 1) if end else (self._executor.grid.ny, -1)
        self._executor.launch(
            sliding.remove,
            inputs=[
                *balance.law,
                removal_sphere,
                removal_disc,
                reference,
                shift,
                *known,
                compliance * self.task.hardness if self.keeps_dents else math.inf,
                stiffness,
            ],
            outputs=[
                tiles.gap,
                state.sphere,
                state.disc,
                state.wear_sphere,
                state.wear_disc,
                tiles.lowest.numbers,
                tiles.highest.numbers,
                *(kept.numbers for kept in self._kept[:3]),
                state.plastic_disc,
                self._kept[3].numbers,
                state.reached,
                self._sums,
                self._maxima,
            ],
            over=tiles,
            often=True,
        )
        self._executor.launch(
            sliding.totals,
            inputs=[shift, *(kept.vectors for kept in self._kept)],
            outputs=self._totals,
            over=tiles,
            often=True,
        )
        if self._approach is not None:
            self._changes.append(abs(balance.approach - self._approach))
        self._approach = balance.approach
        return self._entered(balance, increment, (of_sphere, of_disc), reference, pressure)

    @property
    def in_blocks(self) -> bool:
        """Whether `steps` can be made on the device in one go from here on."""
        return self.blocks_allowed and self._approach is not None

    def steps(self, shifts: Sequence[int], increments: Sequence[float]) -> Iterator[Step]:
        """Steps as `step` makes them, on the device in one go before the first of them is seen."""
        if self._loop is None:
            self._loop = DeviceSliding(
                self._executor,
                [*self.state.fields.values()],
                [self.tiles.lowest.numbers, self.tiles.highest.numbers],
                [kept.numbers for kept in self._kept],
                self._totals,
                load=self.task.load,
                hardness=self.task.hardness,
                compliance=self._elastic,
                implicit=self._implicit,
                keeps=self.keeps_dents,
            )
        assert self._approach is not None
        removals = removals_of(self.task.wear, self._ledger.row["distance"], increments)
        made = self._loop.run(
            [shift % self._rows for shift in shifts],
            [(sphere, self._share * disc) for sphere, disc in removals],
            approach=self._approach,
            wander=max(self._changes, default=FIRST_SCATTER),
            mean_pressure=self._ledger.row["pressure_mean"],
        )
        for increment, removal, step in zip(increments, removals, made, strict=True):
            self._changes.append(abs(step.balance.approach - self._approach))
            self._approach = step.balance.approach
            reference = self._ledger.row["pressure_mean"]
            entered = self._ledger.enter(step.balance, increment, removal, reference, step.totals, step.most)
            self.state.columns = self._ledger.columns
            yield entered

    def _pressures(self, balance: Balance, stiffness: Field) -> FloatArray:
        """The pressure field of a solved contact [MPa]."""
        field = self._executor.zeros()
        self._executor.launch(
            contact.pressures,
            inputs=[*balance.law, stiffness, self.tiles.gap],
            outputs=[field],
            over=self.tiles,
        )
        return self._executor.to_numpy(field)

    def _compliance(self, removal: float) -> float:
        """c of a step that removes so much [mm³/N]."""
        return self._elastic + (removal if self._implicit else 0.0)

    def _stiffness_of(self, compliance: float) -> Field:
        if self._stiffness is None or self._stiffness[0] != compliance:
            stiffness = min(1.0 / compliance, RIGID) if compliance else RIGID
            # A stiffness of 0 beyond the last column would look like cells at the point of touching.
            row = np.full((1, self._executor.vectors * LANES), stiffness)
            self._stiffness = compliance, self._executor.field(row)
        return self._stiffness[1]

    def _balance(self, stiffness: Field, compliance: float) -> Balance:
        scatter = max(TIMES * max(self._changes, default=0.5 * FIRST_SCATTER), LEAST_SCATTER)
        load, hardness = self.task.load, self.task.hardness
        if compliance > 0.0:
            return self._balancer.foundation(
                self.tiles.gap,
                stiffness,
                self.tiles,
                load=load,
                hardness=hardness,
                start=self._approach,
                scatter=0.0 if self._approach is None else scatter,
                stiffest=min(1.0 / compliance, RIGID),
            )
        if not math.isfinite(hardness):
            raise ValueError("a contact without compliance needs a hardness")
        # Without an approach the search starts at the lowest cell, which is not far from the level sought.
        return self._bearing_area.solve_near(
            self.tiles.gap,
            self.tiles,
            start=self.tiles.smallest if self._approach is None else self._approach,
            scatter=scatter,
            load=load,
            hardness=hardness,
            tolerance=self.task.load_tolerance,
        )

    def _entered(
        self,
        balance: Balance,
        increment: float,
        removal: tuple[float, float],
        reference: float,
        pressure: FloatArray | None,
    ) -> Step:
        total = dict(zip(STEP, self._sums.numpy().sum(axis=1).tolist(), strict=True))
        most = dict(zip(STEP_MAXIMA, self._maxima.numpy().max(axis=1).tolist(), strict=True))
        touched, worn_sphere, worn_disc, pressed = (totals.numpy() for totals in self._totals)
        total |= {
            "pressure_times_factor": total["pressure"],
            "touched": float(touched.sum()),
            "wear_sphere": float(worn_sphere.sum()),
            "wear_disc": float(worn_disc.sum()),
            "pressed_disc": float(pressed.sum()),
        }
        rows = np.flatnonzero(touched)
        most |= {"first_row": -float(rows[0]), "last_row": float(rows[-1])} if rows.size else NO_ROWS
        step = self._ledger.enter(balance, increment, removal, reference, total, most, pressure=pressure)
        self.state.columns = self._ledger.columns
        return step
