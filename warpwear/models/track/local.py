"""A disc moves by whole cells under a wearing counter-body, step by step, on one grid."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance, stiffness_of
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.numbers import Numbers, members_of
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.engine.tiles import NO_LIMIT
from warpwear.grid import FloatArray
from warpwear.history.recorder import Entry, Ledger, Step, each_step
from warpwear.kernels import balance, bearing, sliding, sliding_steps
from warpwear.kernels.cells import NO_INDEX, OF_FEATURES, PADDING, TrackMost, TrackSum, names_of
from warpwear.kernels.sliding import Bodies, RowSums, Slide, StepTables, TileBounds
from warpwear.kernels.wear import BALANCE
from warpwear.laws.archard import distance_factor, wear_in_steps
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.task import ContactTask
from warpwear.models.booking import booked
from warpwear.models.features.feature import Place
from warpwear.models.features.features import Features
from warpwear.models.features.materials import steps_above
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.programs import StepPrograms
from warpwear.models.track.tiles import PerTile, SlidingTiles

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 1.25
#: Steps of a replay at most, and cells of all its steps: those of a large grid are to be seen, too.
LONGEST, CELLS_OF_REPLAY = 500, 1.0e8
#: Sums over tiles and rows, and what is found of them, as the history has them.
RENAMED = {"worn_counter": "wear_counter", "worn_disc": "wear_disc", "pressed_disc": "plastic_volume_disc"}
#: Names of the sums and maxima of a step.
SUMS, MAXIMA = names_of(TrackSum), names_of(TrackMost)
#: Sums that are kept of every tile and row of a body.
KEPT = {
    **dict.fromkeys(("touched", "worn_counter"), InFrame("counter")),
    **dict.fromkeys(("worn_disc", "pressed_disc"), InFrame("disc")),
}
#: Columns of the history on the device.
COLUMNS = (*BALANCE, *SUMS, *(f"most_{n}" for n in MAXIMA), *sliding_steps.ROW_SUMS, *sliding_steps.LAST)


class SlidingContact:
    """Contact and wear of one task while its disc moves under the counter-body, or lies still.

    A step visits what can touch at that displacement, and finds what visiting every cell would find.

    disc: heights over the mean plane [mm], shape (rows ≥ nx, ny); row i of the ball lies on row i + shift.
    periodic: after the disc's last row comes its first. track_fraction: what this disc slides of the
    increment of the test: its volumes count 1/track_fraction times, as those of the whole stroke that it
    stands for. moves: whether the disc does. Where it lies still, a distance factor of the task is applied;
    else every cell slides by the increment while it is in contact. bearing_curve: of a roughness that the
    grid does not resolve, by which a disc that lies still runs in.

    Raises ValueError for a disc that is shorter than the grid or of another width.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "tiles": SlidingTiles,
        "_kept": KEPT,
        "_totals": KEPT,
        "_course": Numbers,
        "_changes": Field,
        "features": Features,
        "ledger": Ledger,
    }
    SCRATCH: ClassVar = ("_slides", "_steps", "_host_plan", "_planned", "_programs", "_of_steps", "_search")

    def __init__(
        self,
        task: ContactTask,
        disc: FloatArray,
        executor: Executor,
        *,
        periodic: bool = False,
        track_fraction: float = 1.0,
        moves: bool = True,
        bearing_curve: Logistic | None = None,
    ) -> None:
        executor.foresee([sliding.wear_step, bearing.counted_below if task.rigid else balance.carried])
        self.state = SlidingBodies.of(task, executor, disc)
        self.task, self.periodic, self._moves = task, periodic, moves
        self._executor, self._track_fraction = executor, track_fraction
        self._slides = Numbers(Slide, executor.device)
        #: What the study adds to a step.
        self.features = Features.of(
            task,
            executor,
            self.state.fields,
            periodic=periodic,
            track_fraction=track_fraction,
            distances=self._distances(),
            curve=bearing_curve,
            own=COLUMNS,
        )
        # What shear wears may lie higher than what a list that serves several steps reaches.
        wears_alone = not self.features.changes_heights and not task.shears
        bodies = arguments(Bodies, **self.state.fields, gap=executor.zeros())
        fully = task.load / (task.least_hardness * executor.grid.cell_area)
        self.tiles = SlidingTiles(
            executor,
            bodies,
            self._slides.array,
            self.features,
            least=SPARE * fully,
            keeps_gap=wears_alone and not moves,
        )
        self.features.refresh = self.tiles.refresh
        self.ledger = Ledger(task, executor.grid, track_fraction=track_fraction)
        #: Steps of a replay at most.
        self.longest = int(min(max(CELLS_OF_REPLAY / executor.grid.cells, 1), LONGEST))
        self._make_steps(reuses_list=wears_alone and not moves)
        self._make_programs(bodies, self._make_sums(with_gaps=wears_alone))

    def _make_steps(self, *, reuses_list: bool) -> None:
        """Make plan, history and memory of steps. reuses_list: whether a list may serve several of them."""
        executor, device = self._executor, self._executor.device
        #: What the steps on the device remember.
        self._course = Numbers(sliding_steps.SlidingMemory, device, extents=[NO_INDEX] * 4)
        self._changes: Field = wp.full(int(sliding_steps.CHANGES), -1.0, dtype=wp.float64, device=device)
        self._steps = arguments(
            sliding_steps.SlidingSteps,
            device,
            plan=self.longest,
            history=(self.longest, len(self.features.columns)),
            within=wp.array(self.ledger.within, dtype=wp.float64, device=device),
            changes=self._changes,
            memory=self._course.array,
            slides=self._slides.array,
            moves=int(self._moves),
            reuses_list=int(reuses_list),
            columns=executor.grid.ny,
            margin=sum(one.margin for one in self.features),
        )
        #: The plan as the host writes it, which on a CPU is the device's, and its numbers by name.
        self._host_plan = self._steps.plan.numpy()
        self._planned = members_of(self._host_plan)

    def _make_sums(self, *, with_gaps: bool) -> Arguments:
        """Make what is kept of every tile and row, and return it with the bounds of tiles.

        with_gaps: whether the lowest gaps of tiles are known.
        """
        executor, tiles, nx = self._executor, self.tiles, self._executor.grid.nx
        # Cells of the ball ever touched, wear of the ball, of the disc, what is displaced of the disc.
        rows = nx, nx, self.state.disc.shape[0], self.state.plastic_disc.shape[0]
        sizes = dict(zip(sliding_steps.ROW_SUMS, rows, strict=True))
        self._kept = {n: PerTile(size, executor.tiles_per_row, executor.device) for n, size in sizes.items()}
        row_sums = arguments(RowSums, executor.device, **sizes)
        self._totals = {name: getattr(row_sums, name) for name in sizes}
        known = ["lowest", "highest", *(["gap"] if with_gaps else [])]
        bounds = {name: getattr(tiles, name) for name in known} | self._kept
        numbers = {name: one.numbers for name, one in bounds.items()}
        return arguments(TileBounds, rows=row_sums, **numbers)

    def _make_programs(self, bodies: Arguments, tile_bounds: Arguments) -> None:
        """Make the programs of steps with all features, and of those that reach no other material."""
        executor, slots = self._executor, self._executor.slots_of(self._executor.grid.nx)
        tables = {"sums": (len(SUMS), slots), "maxima": (len(MAXIMA), slots), "bearing": (1, slots)}
        place = Place(
            self._slides.array,
            self._steps,
            listed=(self.tiles.list, self.tiles.count),
            bodies=bodies,
            tables=arguments(StepTables, executor.device, **tables),
        )
        # Until a cell can reach another material, steps are those of bodies without any.
        unreached = [] if self.task.profiles is None else [self.features.without("materials", "stiffness")]
        self._of_steps = [
            StepPrograms(
                executor,
                self.task,
                self.tiles,
                place,
                tile_bounds,
                features,
                highest=lambda: NO_LIMIT if self._moves else self._highest,
            )
            for features in (self.features, *unreached)
        ]
        self._programs = self._of_steps[-1]

    def _distances(self) -> Field | None:
        """Make the factor of the distance that the disc's cells slide, one row for all or one a row."""
        grid, task = self._executor.grid, self.task
        if self._moves or task.distance_factor == "none":
            return None
        factor = distance_factor(grid, task.distance_factor, curvature=task.form.curvature)
        return self._executor.field(np.broadcast_to(factor, (factor.shape[0], grid.ny)))

    @property
    def _highest(self) -> float:
        """Largest gap of a disc that lies still [mm], before any wear."""
        state, to_numpy = self.state, self._executor.to_numpy
        unworn = to_numpy(state.counter) - to_numpy(state.wear_counter)
        gap = unworn - (to_numpy(state.disc) + to_numpy(state.wear_disc))
        return float(gap[gap < 0.5 * PADDING].max())

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        The row of the step has one column more, `plastic_volume_disc`.

        Raises ConvergenceError when the load cannot be balanced, ValueError when a disc that is not periodic
        would leave a part of the counter-body without one.
        """
        removals, rigid = self._plan([shift], [increment])
        search, pressure = self._programs.search(rigid=rigid), None
        if with_pressure:
            self._programs.program("search", rigid=rigid).run()
            search.check()
            pressure = search.pressures()
        self._run(self._programs.program("wear" if with_pressure else "steps", rigid=rigid))
        search.check()
        return next(self._booked([increment], removals))._replace(pressure=pressure)

    @property
    def in_blocks(self) -> bool:
        """Whether `steps` can be made in a row: not where 1/c of one follows from the one before."""
        return self.longest > 1 and not self.task.bulk_updated

    def replay(self, shifts: Sequence[int], increments: Sequence[float]) -> tuple[int, Iterator[Step]]:
        """Make steps as `step` makes them, as many as a replay has; return their number, and them."""
        end = self.longest
        removals, rigid = self._plan(shifts[:end], increments[:end])
        self._search = self._programs.search(rigid=rigid)
        self._run(self._programs.program("steps", rigid=rigid))
        return self._course["step"], self._booked(increments[:end], removals)

    def check(self) -> None:
        """Raise ConvergenceError where the last replay ended at a step without a balance."""
        self._search.check()

    def forget(self) -> None:
        """Let the next search begin as the first one does: the disc is another."""
        self._course.set(is_begun=0)

    def _run(self, program: Program) -> None:
        """Make steps, as often as something stops them before they are done."""
        program.run()
        while self.features.drain():
            program.run()
        self.features.end_steps(self._course["step"])

    def _plan(self, shifts: Sequence[int], increments: Sequence[float]) -> tuple[FloatArray, bool]:
        """Tell the device of the next steps; return K ΔL of both bodies, and whether all are rigid.

        Behind K ΔL is what shear wears off a cell in contact. A row is a step.
        """
        task, row = self.task, self.ledger.row
        removals = wear_in_steps(task.wear, row["distance"], increments)
        own, dust, track = task.compliance_at(row["area_contact"]), task.dust, self._track_fraction
        moved = np.array(shifts)
        for shift in (moved.min(), moved.max()):
            self.state.row_of(int(shift), periodic=self.periodic)
        rows = moved % self.state.disc.shape[0]
        counter, disc = removals.T
        k_counter, k_disc = dust * counter, dust * track * disc
        most = self._begin_materials(counter=k_counter, disc=k_disc)
        compliance = own + (k_counter + k_disc) * task.implicit
        own_stiffness = self._programs.features.cells.stiffness is not None
        alike = np.zeros(len(rows)) if own_stiffness else stiffness_of(compliance)
        ends = np.add.accumulate([row["distance"], *increments])
        depths = np.zeros((2, len(rows)))
        if task.shears:
            pairs = zip(ends[:-1].tolist(), increments, strict=True)
            depths = np.array([task.wear_per_contact(*pair) for pair in pairs]).T
        steps = {
            "number": np.arange(len(rows)),
            "rows": self._executor.grid.nx,
            "shift": rows,
            "start": ends[:-1],
            "end": ends[1:],
            "k_counter": k_counter,
            "k_disc": k_disc,
            "pending_counter": (1.0 - dust) * counter,
            "pending_disc": (1.0 - dust) * (track * disc),
            "own": own,
            "compliance": compliance,
            "stiffness": alike,
            "shear_counter": depths[0],
            "shear_disc": track * depths[1],
            **task.shear_ratios,
            "yield_depth": self._yield_depth(own, k_counter, k_disc) if task.keeps_dents else NO_LIMIT,
        }
        for name, values in steps.items():
            self._planned[name][: len(rows)] = values
        if not self._executor.device.is_cpu:
            self._steps.plan.assign(self._host_plan)
        rigid = bool(compliance[0] == 0.0)
        count = int(np.argmax((compliance == 0.0) != rigid)) or len(rows)  # a replay has steps of one kind
        count = min(count, most)
        self._course.set(step=0, steps=count)
        if not self._course["is_begun"]:
            self._begin_at({name: values[0] for name, values in self._planned.items()})
        return np.stack([counter, disc, *depths], axis=1)[:count], rigid

    def _yield_depth(self, own: float, counter: FloatArray, disc: FloatArray) -> FloatArray:
        """Return the overlap of a cell at the hardness [mm]. own, counter, disc: what lends it compliance."""
        task = self.task
        knots = task.knots if len(task.knots) else np.ones((1, 3))
        at_hardness = [np.interp(task.hardness, knots[:, 0], column) for column in knots.T[1:]]
        worn = counter * at_hardness[0] + disc * at_hardness[1]
        return (own + worn * task.implicit) * task.hardness

    def _begin_materials(self, **removals: FloatArray) -> int:
        """Choose by K ΔL [mm³/N] the programs of the next steps, and return how many may be made by them."""
        most = steps_above(self.task, self._executor.grid.cell_area, self.ledger.most, removals)
        self._programs = self._of_steps[-1 if most else 0]
        return most or len(removals["disc"])

    def _begin_at(self, step: Mapping[str, Any]) -> None:
        """Tell the device where the search of the first step begins."""
        smallest, limit = self.tiles.begin_at(int(step["shift"]))
        softest = step["stiffness"]
        if step["compliance"] > 0.0:
            self._slides.set(**{name: step[name] for name in ("own", "k_counter", "k_disc")})
            softest = self._programs.features.softest(self._executor, self._slides.array) or softest
        self._course.set(smallest=smallest, first_limit=limit, softest=softest)

    def _booked(self, increments: Sequence[float], removals: FloatArray) -> Iterator[Step]:
        """Return the steps that the device has made, as the ledger enters them."""
        count = self._course["step"]
        table = np.ascontiguousarray(self._steps.history[: max(count, 1)].numpy()[:count].T)
        columns = dict(zip(self.features.columns, table, strict=True))
        there = {"rubbed": self.task.shears, "wearing_counter": len(self.task.knots) > 0}
        absent = OF_FEATURES.union(name for name, is_there in there.items() if not is_there)
        total = {name: columns[name] for name in SUMS if name not in absent}
        total |= {RENAMED.get(name, name): columns[name] for name in sliding_steps.ROW_SUMS}
        most = {name: columns[f"most_{name}"] for name in MAXIMA}
        most |= {name: columns[name] for name in ("first_row", "last_row")}
        self._programs.features.enter(columns, total, most)
        *numbers, reference = (columns[name] for name in BALANCE)
        slid, removed = np.array(increments[:count]), tuple(removals[:count].T)
        steps = Entry(Balance(*numbers), slid, removed, reference, total, most)
        return each_step(booked(self.ledger, steps, self._enter))

    def _enter(self, *columns: Any) -> Step:
        """Book a step as `Ledger.enter` does."""
        step = self.ledger.enter(*columns)
        self.state.columns = self.features.beside(self.ledger.columns)
        return step
