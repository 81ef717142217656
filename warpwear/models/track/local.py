"""One grid in motion: a disc displaced by whole cells under a wearing sphere, step by step."""

import math
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import RIGID, Balance, Balancer, Foundation, stiffness_of
from warpwear.contact.bearing_area import TIE, BearingArea
from warpwear.engine.executor import Executor, Field, arguments, set_numbers
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels import contact, sliding
from warpwear.kernels.blocks.steps import PLAN
from warpwear.kernels.blocks.two_bodies import Lying, wear_bodies
from warpwear.kernels.cells import LANES, PADDING, TrackMost, TrackSum, names_of
from warpwear.kernels.contact import Law
from warpwear.kernels.sliding import Bodies, OfCells, OfEightTiles, OfRows, OfTiles, Slide, StepTables
from warpwear.laws.archard import distance_factor, removals_of
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.task import ContactTask
from warpwear.models.booking import booked
from warpwear.models.film import BareCells
from warpwear.models.on_cpu import Block, in_launches
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.pieces import SlidingPieces
from warpwear.models.track.recession import Recession
from warpwear.models.track.tiles import DEEPER, DEEPEST, FIRST_DEPTH, PerTile, SlidingTiles

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 1.25
#: Changes of the approach from which the next is expected, and how many times the largest it may be.
CHANGES, TIMES = 8, 2.0
#: Sums over tiles and rows, and their names where they differ in the history.
KEPT = ("touched", "worn_sphere", "worn_disc", "pressed_disc")
RENAMED = {"worn_sphere": "wear_sphere", "worn_disc": "wear_disc"}
#: Names of the sums and maxima of a step.
SUMS, MAXIMA = names_of(TrackSum), names_of(TrackMost)
#: Of a step before which nothing was touched.
NO_ROWS = {"first_row": -math.inf, "last_row": -math.inf}
#: What the approach may change by when nothing is known of it, and at least [mm].
FIRST_SCATTER, LEAST_SCATTER = 1.0e-4, 1.0e-6


class SlidingContact:
    """Contact and wear of one task while its disc moves under the sphere, or lies still.

    A step visits what can touch at that displacement, and finds what visiting every cell would find.

    disc: heights over the mean plane [mm], shape (rows ≥ nx, ny); row i of the sphere lies on row i + shift.
    periodic: after the disc's last row comes its first. sphere: heights over the unworn apex [mm], shape
    (nx, ny), instead of those of the task's sphere. track_fraction: what this disc slides of the increment of
    the test: its volumes count 1/track_fraction times, as those of the whole stroke that it stands for.
    moves: whether the disc does. Where it lies still, a distance factor of the task is applied; else every
    cell slides by the increment while it is in contact. bearing_curve: of a roughness that the grid does not
    resolve, by which a disc that lies still runs in.

    Raises ValueError for a disc that is shorter than the grid or of another width.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "tiles": SlidingTiles,
        "_kept": dict,
        "_totals": dict,
        "_approach": float,
        "_changes": deque,
        "_recession": Recession,
        "pieces": SlidingPieces,
        "_ledger": Ledger,
        "film": BareCells,
    }

    def __init__(
        self,
        task: ContactTask,
        disc: FloatArray,
        executor: Executor,
        *,
        periodic: bool = False,
        sphere: FloatArray | None = None,
        track_fraction: float = 1.0,
        moves: bool = True,
        bearing_curve: Logistic | None = None,
    ) -> None:
        grid = executor.grid
        executor.foresee([contact.gap, sliding.wear_step])
        self.state = SlidingBodies.of(task, executor, disc, sphere=sphere)
        self.task = task
        self.periodic = periodic
        self._executor = executor
        self._rows = disc.shape[0]
        self._track_fraction = track_fraction
        self.keeps_dents = task.keeps_dents
        self._balancer, self._bearing_area = Balancer(executor), BearingArea(executor)
        fully = task.load / (task.least_hardness * grid.cell_area)
        #: What is bare of film; None without one.
        self.film = BareCells.of_bodies(task.film, executor, self.state.wear_sphere, self.state.wear_disc)
        self._parts = self._bearing_area.parts = None if self.film is None else self.film.parts
        self.tiles = SlidingTiles(executor, self.state.sphere, self.state.disc, least=SPARE * fully)
        columns, device = executor.tiles_per_row, executor.device
        # Of every tile and of every row: cells of the sphere ever touched, wear of the sphere, of the disc,
        # what is displaced of the disc.
        rows = (grid.nx, grid.nx, self._rows, self.state.plastic_disc.shape[0])
        self._kept = {name: PerTile(n, columns, device) for name, n in zip(KEPT, rows, strict=True)}
        self._totals = {
            name: wp.zeros(n, dtype=wp.float64, device=device) for name, n in zip(KEPT, rows, strict=True)
        }
        self._stiffness: tuple[tuple[float, ...], Field] | None = None  # with what it was made for
        self._approach: float | None = None
        self._changes: deque[float] = deque(maxlen=CHANGES)
        self._ledger = Ledger(task, executor.grid, track_fraction=track_fraction)
        self._moves, self._highest = moves, math.inf
        if not moves and task.rigid:
            gap = executor.to_numpy(self.state.sphere) - executor.to_numpy(self.state.disc)
            self._highest = float(gap[gap < 0.5 * PADDING].max())
        kind = "none" if moves else task.distance_factor
        self._factor = distance_factor(grid, kind, curvature=task.curvature)
        self._gather(kind != "none")
        self._recession = None
        if bearing_curve is not None:
            self._recession = Recession(bearing_curve, executor, self._bodies, self._of_cells.factor)
        self.pieces = SlidingPieces.of(
            task, executor, self.state, periodic=periodic, track_fraction=track_fraction
        )
        self._block = self._made_block()

    def _gather(self, factored: bool) -> None:
        """Make the arguments of the kernels, which change in place."""
        executor, tiles = self._executor, self.tiles
        factors = np.broadcast_to(self._factor, (self._factor.shape[0], executor.grid.ny))
        sums, maxima = executor.partials(len(SUMS)), executor.partials(len(MAXIMA))
        numbers = {name: kept.numbers for name, kept in self._kept.items()}
        bounds = {"lowest": tiles.lowest.numbers, "highest": tiles.highest.numbers}
        self._law = arguments(Law)
        self._slide = arguments(Slide, factored=int(factored))
        self._of_cells = arguments(OfCells, factor=executor.field(factors))
        if self._parts is not None:
            self._of_cells.parts = self._parts
        self._tables = arguments(StepTables, sums=sums, maxima=maxima)
        self._bodies = arguments(Bodies, **self.state.fields, gap=tiles.gap)
        self._of_tiles = arguments(OfTiles, **bounds, **numbers)
        self._of_eight = arguments(OfEightTiles, **{name: kept.vectors for name, kept in self._kept.items()})
        self._of_rows = arguments(OfRows, **self._totals)

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        The row of the step has one column more, `plastic_volume_disc`.

        Raises ConvergenceError when the load cannot be balanced, ValueError when a disc that is not periodic
        would leave a part of the sphere without one.
        """
        task, now, row = self.task, self._slide, self._ledger.row
        shift = self.state.row_of(shift, periodic=self.periodic)
        self.tiles.displace(shift)
        removal = task.removals(row["distance"], increment)
        of_sphere, of_disc = task.dust * removal[0], task.dust * self._track_fraction * removal[1]
        set_numbers(now, wear_per_pressure_sphere=of_sphere, wear_per_pressure_disc=of_disc)
        own = task.compliance_at(row["area_contact"])
        compliance = own + (of_sphere + of_disc) * task.implicit
        stiffness = self._stiffness_of(compliance, own)
        if self._of_cells.stiffness is not stiffness:
            self._of_cells.stiffness = stiffness
        if self.film is not None:
            self.film.look(row["distance"], shift=shift, columns=self.state.columns)
        balance = self._balance(stiffness, compliance)
        balance.fill(self._law)
        near_mean = balance.cap if compliance == 0.0 else row["pressure_mean"] or balance.cap
        reference = near_mean if math.isfinite(near_mean) else 0.0
        pressure = None
        if with_pressure:
            pressure = self._balancer.pressures(self._law, stiffness, self.tiles.gap, self.tiles, self._parts)
        bare = None
        if self.film is not None:
            bare = self.film.in_contact(self._law, stiffness, self.tiles.gap, self.tiles)
        if self.pieces is not None:
            self.pieces.begin()
            self.pieces.take_tiles(
                self._law, stiffness, self.tiles.gap, self.tiles, shift, removal, self._parts
            )
        bearing = None if self._recession is None else self._recession.cells_bearing(self._law)
        first, end = self.state.columns
        set_numbers(
            now,
            shift=shift,
            reference=reference,
            full_depth=compliance * task.hardness if self.keeps_dents else math.inf,
            first_column=first if end else self._executor.grid.ny,
            last_column=end - 1,
        )
        self._executor.launch(
            sliding.wear_step,
            inputs=[self._law, now, self._of_cells],
            outputs=[self._bodies, self._of_tiles, self._tables],
            over=self.tiles,
            often=True,
        )
        self._executor.launch(
            sliding.totals,
            inputs=[shift, self._of_eight],
            outputs=[self._of_rows],
            over=self.tiles,
            often=True,
        )
        if self._recession is not None:
            self._recession.recede()
        self._note(balance.approach)
        total, most = self._found()
        if self.pieces is not None:
            total, most = self.pieces.shed(shift, total, most)
        if bare is not None:
            total["bare"] = bare
        step = self._enter(
            balance, increment, removal, reference, total, most, pressure=pressure, bearing=bearing
        )
        if self.film is not None:
            self.film.rub(step.row["distance"], shift=shift, columns=self.state.columns)
        return step

    @property
    def in_blocks(self) -> bool:
        """Whether `steps` can be made on the device in one go from here on."""
        return self._block is not None and self._approach is not None

    def in_one_launch(self, increments: Sequence[float]) -> Iterator[tuple[int, Step]]:
        """Steps of a disc that lies still as `step` makes them, as many in a launch as it can.

        With each it is told how many are made beyond it.
        """
        block, task, track = self._block, self.task, self._track_fraction
        assert block is not None
        removals = removals_of(task.wear, self._ledger.row["distance"], increments)
        slid, plan = np.array(increments), np.empty((len(removals), len(PLAN)))
        for number, (of_sphere, removal_disc) in enumerate(removals):
            compliance = task.compliance + (of_sphere + track * removal_disc) * task.implicit
            plan[number] = of_sphere, track * removal_disc, compliance, stiffness_of(compliance)

        def launch(done: int) -> tuple[int, Iterator[Step]]:
            assert self._approach is not None
            found, _ = block.run(
                plan[done:],
                len(plan) - done,
                self.tiles,
                self._ledger,
                {"approach": self._approach, "mean": self._ledger.row["pressure_mean"]},
                changes=self._changes,
            )
            for approach in found.balance.approach.tolist():
                self._note(approach)
            found.total["pressed_disc"] = np.zeros(found.made)  # the disc springs back
            return found.made, booked(found, self._ledger, slid[done:], removals[done:], self._enter)

        return in_launches(len(plan), launch, lambda number: self.step(0, increments[number]))

    def _enter(self, *found: Any, **more: Any) -> Step:
        """Book a step as `Ledger.enter` does."""
        step = self._ledger.enter(*found, **more)
        self.state.columns = self._ledger.columns
        if self.pieces is not None:
            self.state.columns = self.pieces.beside(self.state.columns)
        return step

    def _made_block(self) -> Block | None:
        """What makes many steps in a launch; None where none can: of rare laws, and of large fields."""
        executor, task, tiles, grid = self._executor, self.task, self.tiles, self._executor.grid
        factored = bool(self._slide.factored)
        needed = task.load / (task.hardness * grid.cell_area)
        rare = self.keeps_dents or task.bulk_updated or task.film is not None or task.pieces is not None
        if not executor.in_one_launch or self._moves or rare:
            return None
        if self._recession is not None or (factored and task.implicit and self._factor.shape[0] > 1):
            return None
        stiffness = executor.zeros(1)
        lying = arguments(
            Lying,
            of_cells=arguments(OfCells, stiffness=stiffness, factor=self._of_cells.factor),
            bodies=self._bodies,
            of_tiles=self._of_tiles,
            of_eight=self._of_eight,
            of_rows=self._of_rows,
            lowest=wp.zeros((grid.nx, executor.tiles_per_row), dtype=wp.float64, device=executor.device),
            cells=wp.zeros(grid.nx * executor.vectors * LANES, dtype=wp.float64, device=executor.device),
            factored=int(factored),
            own=task.compliance if factored and task.implicit else -1.0,
            least=tiles.least,
            first_depth=FIRST_DEPTH,
            deeper=DEEPER,
            deepest=DEEPEST,
            scatter=FIRST_SCATTER,
            least_scatter=LEAST_SCATTER,
            times=TIMES,
            needed=needed,
            allowed=task.load_tolerance / (task.hardness * grid.cell_area),
            highest=self._highest if task.rigid else -math.inf,
            tie=TIE,
        )
        names = (SUMS, MAXIMA, ("touched", "wear_sphere", "wear_disc"), ("first_row", "last_row"))
        inputs = [lying, self._tables]
        return Block(executor, task, wear_bodies, inputs, names, stiffness=stiffness, changes=CHANGES)

    def _note(self, approach: float) -> None:
        """Learn from a step how much the approach [mm] changes."""
        if self._approach is not None:
            self._changes.append(abs(approach - self._approach))
        self._approach = approach

    def _stiffness_of(self, compliance: float, own: float) -> Field:
        """1/c of the cells in the step at hand [N/mm³], one row where they are alike.

        compliance: of a cell that slides as far as the middle [mm³/N]; own: the part that is no wear.
        """
        task, now = self.task, self._slide
        if self._recession is not None and task.implicit:
            return self._recession.stiffness(own + now.wear_per_pressure_sphere, now.wear_per_pressure_disc)
        made_for = (compliance, now.wear_per_pressure_disc * now.factored)
        if self._stiffness is None or self._stiffness[0] != made_for:
            values = np.full((1, 1), compliance)
            if now.factored and task.implicit:
                values = self._factor * now.wear_per_pressure_disc + (own + now.wear_per_pressure_sphere)
            with np.errstate(divide="ignore", over="ignore"):
                values = np.minimum(1.0 / values, RIGID)
            # A stiffness of 0 beyond the last column would look like cells at the point of touching.
            padding = self._executor.vectors * LANES - values.shape[1]
            self._stiffness = (
                made_for,
                self._executor.field(np.pad(values, ((0, 0), (0, padding)), mode="edge")),
            )
        return self._stiffness[1]

    def _balance(self, stiffness: Field, compliance: float) -> Balance:
        scatter = max(TIMES * max(self._changes, default=0.5 * FIRST_SCATTER), LEAST_SCATTER)
        load, hardness = self.task.load, self.task.hardness
        if compliance > 0.0:
            alike = not self._slide.factored and self._recession is None
            stiffest = stiffness_of(compliance) if alike else math.inf
            return self._balancer.solve(
                Foundation(self.tiles.gap, stiffness, self.tiles, load, hardness, stiffest, self._parts),
                start=self._approach,
                scatter=0.0 if self._approach is None else scatter,
            )
        if not math.isfinite(hardness):
            raise ValueError("a contact without compliance needs a hardness")
        # Without an approach the search starts at the lowest cell, which is not far from the level sought.
        start = self.tiles.smallest if self._approach is None else self._approach
        return self._bearing_area.solve(
            self.tiles.gap,
            self.tiles,
            start=start if self._moves else None,
            highest=self._highest,
            scatter=scatter,
            load=load,
            hardness=hardness,
            tolerance=self.task.load_tolerance,
        )

    def _found(self) -> tuple[dict[str, float], dict[str, float]]:
        """What the kernels found in a step: sums and maxima by name."""
        sums, maxima = self._tables.sums.numpy().sum(axis=1), self._tables.maxima.numpy().max(axis=1)
        total = dict(zip(SUMS, sums.tolist(), strict=True))
        most = dict(zip(MAXIMA, maxima.tolist(), strict=True))
        of_rows = {name: totals.numpy() for name, totals in self._totals.items()}
        total |= {RENAMED.get(name, name): float(values.sum()) for name, values in of_rows.items()}
        rows = np.flatnonzero(of_rows["touched"])
        most |= {"first_row": -float(rows[0]), "last_row": float(rows[-1])} if rows.size else NO_ROWS
        return total, most
