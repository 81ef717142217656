"""One grid in motion: a disc displaced by whole cells under a wearing sphere, step by step."""

import math
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, ClassVar, cast

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance, stiffness_of
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import SMALL, Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.tiles import NO_LIMIT, Tiles
from warpwear.grid import FloatArray
from warpwear.history.quantities import BODIES
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels import balance, bearing, sliding, sliding_steps
from warpwear.kernels.cells import NO_INDEX, PADDING, TrackMost, TrackSum, names_of
from warpwear.kernels.running_in import recession
from warpwear.kernels.slide import Slide
from warpwear.kernels.sliding import Bodies, OfCells, OfRows, OfTiles, StepTables
from warpwear.kernels.wear import BALANCE
from warpwear.laws.archard import distance_factor, wear_in_steps
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.task import ContactTask
from warpwear.models.booking import Found, booked
from warpwear.models.film import BareCells
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.pieces import OF_BODY, SlidingPieces
from warpwear.models.track.recession import Recession
from warpwear.models.track.tiles import PerTile, SlidingTiles

#: Cells listed at least, over those that carry the load at the hardness.
SPARE = 1.25
#: Steps of a replay at most, and cells of all its steps: those of a large grid are to be seen, too.
LONGEST, CELLS_OF_REPLAY = 500, 1.0e8
#: Sums over tiles and rows, and what is found of them, as the history has them.
RENAMED = {"worn_sphere": "wear_sphere", "worn_disc": "wear_disc"}
#: Names of the sums and maxima of a step.
SUMS, MAXIMA = names_of(TrackSum), names_of(TrackMost)
#: Columns of the history on the device.
COLUMNS = (*BALANCE, *SUMS, *(f"most_{name}" for name in MAXIMA), *sliding_steps.KEPT, *sliding_steps.LAST)


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
        "_course": Numbers,
        "_changes": Field,
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
        executor.foresee([sliding.wear_step, bearing.counted_below if task.rigid else balance.carried])
        self.state = SlidingBodies.of(task, executor, disc, sphere=sphere)
        self.task, self.periodic, self._moves = task, periodic, moves
        self._executor, self._track_fraction = executor, track_fraction
        self.keeps_dents = task.keeps_dents
        grid, device = executor.grid, executor.device
        #: What is bare of film; None without one.
        self.film = BareCells.of_bodies(task.film, executor, self.state.wear_sphere, self.state.wear_disc)
        self._slides = Numbers(Slide, device)
        self._bodies = arguments(Bodies, **self.state.fields, gap=executor.zeros())
        fully = task.load / (task.least_hardness * grid.cell_area)
        # Pieces and a disc that recedes change heights after the pass that wears.
        self._wears_alone = task.pieces is None and bearing_curve is None
        stays = self._wears_alone and not moves
        self.tiles = SlidingTiles(
            executor, self._bodies, self._slides.array, least=SPARE * fully, stays=stays
        )
        # Of every tile and of every row: cells of the sphere ever touched, wear of the sphere, of the disc,
        # what is displaced of the disc.
        rows = (grid.nx, grid.nx, disc.shape[0], self.state.plastic_disc.shape[0])
        columns, names = executor.tiles_per_row, sliding_steps.KEPT
        self._kept = {name: PerTile(n, columns, device) for name, n in zip(names, rows, strict=True)}
        self._totals = {
            name: wp.zeros(n, dtype=wp.float64, device=device) for name, n in zip(names, rows, strict=True)
        }
        self._ledger = Ledger(task, grid, track_fraction=track_fraction)
        self.pieces = SlidingPieces.of(task, executor, self.state, periodic=periodic)
        self._recession = None
        if bearing_curve is not None:
            self._recession = Recession(bearing_curve, executor, self._bodies)
        self._factor = distance_factor(
            grid, "none" if moves else task.distance_factor, curvature=task.curvature
        )
        #: Whether 1/c differs from cell to cell.
        self._differs = task.implicit and (self._recession is not None or self._factored)
        self._gather()
        #: Searches by whether the cells are rigid, and programs by that and whether threads share them.
        self._searches: dict[bool, LoadSearch] = {}
        self._said: dict[tuple[bool, bool], tuple[Program, ...]] = {}

    @property
    def _factored(self) -> bool:
        return not self._moves and self.task.distance_factor != "none"

    def _gather(self) -> None:
        """Make the arguments of the kernels, which change in place."""
        executor, tiles, device = self._executor, self.tiles, self._executor.device
        self._of_cells = arguments(OfCells, factored=int(self._factored))
        self._of_cells.factor = executor.field(
            np.broadcast_to(self._factor, (self._factor.shape[0], executor.grid.ny))
        )
        alike = self._factor.shape[0] == 1 and self._recession is None
        none = executor.zeros(0)
        self._stiffness = executor.zeros(1 if alike else None) if self._differs else none
        self._of_cells.stiffness = self._stiffness
        self._of_cells.bare = none if self.film is None else self.film.bare
        self._of_cells.parts = none if self.film is None or self.film.parts is None else self.film.parts
        numbers = {name: kept.numbers for name, kept in self._kept.items()}
        bounds = {"lowest": tiles.lowest.numbers, "highest": tiles.highest.numbers}
        if self._wears_alone:
            bounds["gap"] = tiles.gap.numbers
        self._of_rows = arguments(OfRows, **self._totals)
        self._of_tiles = arguments(OfTiles, rows=self._of_rows, **bounds, **numbers)
        slots = executor.slots_of(executor.grid.nx)
        lines = {"sums": len(SUMS), "maxima": len(MAXIMA), "bearing": 1}
        tables = {name: wp.zeros((n, slots), dtype=wp.float64, device=device) for name, n in lines.items()}
        self._tables = arguments(StepTables, **tables)
        #: Steps of a replay at most.
        self.longest = int(min(max(CELLS_OF_REPLAY / executor.grid.cells, 1), LONGEST))
        extents = {f"{end}_{line}": NO_INDEX for end in ("first", "last") for line in ("row", "column")}
        #: What the steps on the device remember.
        self._course = Numbers(sliding_steps.Course, device, **extents)
        self._changes: Field = wp.full(int(sliding_steps.CHANGES), -1.0, dtype=wp.float64, device=device)
        columns = len(COLUMNS) + (0 if self.pieces is None else 2 * len(OF_BODY))
        self._steps = arguments(
            sliding_steps.Steps,
            plan=wp.zeros((self.longest, len(sliding_steps.PLAN)), dtype=wp.float64, device=device),
            history=wp.zeros((self.longest, columns), dtype=wp.float64, device=device),
            within=wp.array(self._ledger.within, dtype=wp.float64, device=device),
            changes=self._changes,
            course=self._course.array,
            slides=self._slides.array,
            stepping=wp.zeros(1, dtype=wp.int32, device=device),
            solved=wp.zeros(1, dtype=wp.int32, device=device),
            moves=int(self._moves),
            stays=int(self._wears_alone and not self._moves),
            hardness=self.task.hardness if self.keeps_dents else NO_LIMIT,
            rows=executor.grid.nx,
            columns=executor.grid.ny,
            margin=0 if self.pieces is None else self.pieces.margin,
        )

    def _search(self, *, rigid: bool) -> LoadSearch:
        """The search of steps whose cells are rigid or not."""
        if rigid not in self._searches:
            task, tiles = self.task, cast(Tiles, self.tiles)
            if rigid and not math.isfinite(task.hardness):
                raise ValueError("a contact without compliance needs a hardness")
            search = LoadSearch(
                self._executor,
                self._bodies.gap,
                tiles,
                load=task.load,
                hardness=task.hardness,
                stiffness=None if rigid else self._stiffness,
                parts=self._of_cells.parts,
                tolerance=task.load_tolerance if rigid else None,
            )
            search.springs.highest = self._highest if rigid and not self._moves else NO_LIMIT
            self._searches[rigid] = search
        return self._searches[rigid]

    def _programs(self, *, rigid: bool) -> tuple[LoadSearch, tuple[Program, ...]]:
        """The search, and programs: of many steps; of one as far as its balance, and of its wear."""
        search, executor = self._search(rigid=rigid), self._executor
        shares = executor.is_shared and self.tiles.cells > SMALL
        self._steps.is_rigid = int(rigid)  # each time: a program is recorded when first run
        if (rigid, shares) not in self._said:
            many, to_search, to_wear = (Program(executor, shares=shares) for _ in range(3))
            many.decide(sliding_steps.begin, self._steps)
            with many.loop(self._steps.stepping):
                self._say_search(many, search)
                self._say_wear(many, search)
            self._say_search(to_search, search)
            self._say_wear(to_wear, search)
            self._said[rigid, shares] = many, to_search, to_wear
        return search, self._said[rigid, shares]

    def _say_search(self, program: Program, search: LoadSearch) -> None:
        """Say how a step begins: what its cells are like, which can touch, and the balance."""
        with self._before_pieces(program):
            program.decide(sliding_steps.begin_search, search.springs, self._steps)
            if self.film is not None:
                self.film.say_look(program, self._slides.array)
            if self.pieces is not None:
                self.pieces.say_begin(program)
            if self._differs:
                self._say_stiffness(program)
            search.add_to(program)
            self.tiles.add_to(program)
            program.decide(sliding_steps.end_search, search.springs, self._steps)

    def _say_stiffness(self, program: Program) -> None:
        """Say how 1/c of every cell follows from what wears it in a step."""
        curve = arguments(recession.Curve) if self._recession is None else self._recession.curve
        program.launch(
            recession.stiffness,
            *(self._slides.array, curve, self._of_cells.factor, self._bodies.wear_disc, self._stiffness),
            slots=self._executor.slots_of(self._stiffness.shape[0]),
        )

    def _say_wear(self, program: Program, search: LoadSearch) -> None:
        """Say how a step ends: the wear of both bodies, the pieces that leave, and its row."""
        tiles, slides, springs, of_cells = self.tiles, self._slides.array, search.springs, self._of_cells
        listed = tiles.list, tiles.count
        with self._before_pieces(program), program.branch(self._steps.solved):
            if self.pieces is not None:
                self.pieces.say_take_tiles(program, slides, springs, *listed, of_cells, self._bodies.gap)
            if self._recession is not None:
                self._recession.say_bearing(program, search.law, self._tables.bearing)
            both = self._bodies, self._of_tiles
            program.launch(
                sliding.wear_step,
                *(*listed, slides, springs, of_cells, *both, self._tables),
                chunks=lambda: tiles.chunks,
            )
            if self._recession is not None:
                self._recession.say_recede(program)
        steps = self._steps
        if self.pieces is not None:
            self.pieces.say_shed(program, slides, steps.stepping, steps.history, len(COLUMNS))
        with nullcontext() if self.pieces is None else program.branch(self.pieces.ends):
            program.decide(sliding_steps.record, springs, steps, self._tables, self._of_rows)
            if self.film is not None:
                self.film.say_rub(program, slides)

    def _before_pieces(self, program: Program) -> AbstractContextManager[None]:
        """What is done once in a step, where the table of pieces may stop it on its way."""
        return nullcontext() if self.pieces is None else program.branch(self.pieces.begins)

    @property
    def _highest(self) -> float:
        """Largest gap of a disc that lies still [mm], before any wear."""
        state, to_numpy = self.state, self._executor.to_numpy
        unworn = to_numpy(state.sphere) - to_numpy(state.wear_sphere)
        gap = unworn - (to_numpy(state.disc) + to_numpy(state.wear_disc))
        return float(gap[gap < 0.5 * PADDING].max())

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        The row of the step has one column more, `plastic_volume_disc`.

        Raises ConvergenceError when the load cannot be balanced, ValueError when a disc that is not periodic
        would leave a part of the sphere without one.
        """
        removals, rigid = self._plan([shift], [increment])
        search, (many, to_search, to_wear) = self._programs(rigid=rigid)
        pressure = None
        if with_pressure:
            to_search.run()
            search.check()
            pressure = search.pressures()
        self._run(to_wear if with_pressure else many)
        search.check()
        return next(self._booked([increment], removals))._replace(pressure=pressure)

    @property
    def in_blocks(self) -> bool:
        """Whether `steps` can be made in a row: not where 1/c of one follows from the one before."""
        return self.longest > 1 and not self.task.bulk_updated

    def steps(self, shifts: Sequence[int], increments: Sequence[float]) -> Iterator[tuple[int, Step]]:
        """Steps as `step` makes them, in few replays; each with how many are made beyond it."""
        done = 0
        while done < len(increments):
            end = done + self.longest
            removals, rigid = self._plan(shifts[done:end], increments[done:end])
            search, (many, *_) = self._programs(rigid=rigid)
            self._run(many)
            made = self._course["step"]
            for number, step in enumerate(self._booked(increments[done:end], removals)):
                yield made - number - 1, step
            search.check()
            done += made

    def _run(self, program: Program) -> None:
        """Make steps, as often as the table of pieces gets full before they are done."""
        program.run()
        if self.pieces is not None:
            while self.pieces.drain():
                program.run()
            self.pieces.book.end_steps(self._course["step"])

    def _plan(
        self, shifts: Sequence[int], increments: Sequence[float]
    ) -> tuple[list[tuple[float, float]], bool]:
        """Tell the device of the next steps; return K ΔL of both bodies, and whether all are rigid."""
        task, row = self.task, self._ledger.row
        removals = wear_in_steps(task.wear, row["distance"], increments)
        own, dust, track = task.compliance_at(row["area_contact"]), task.dust, self._track_fraction
        rows = [self.state.row_of(shift, periodic=self.periodic) for shift in shifts[: len(removals)]]
        sphere, disc = np.array(removals).T
        of_sphere, of_disc = dust * sphere, dust * track * disc
        pending = (1.0 - dust) * sphere, (1.0 - dust) * (track * disc)
        compliance = own + (of_sphere + of_disc) * task.implicit
        alike = [0.0 if self._differs else stiffness_of(one) for one in compliance.tolist()]
        ends = np.add.accumulate([row["distance"], *increments[: len(removals)]])
        owns = np.full(len(rows), own)
        each = rows, ends[:-1], ends[1:], of_sphere, of_disc, *pending, owns, compliance, alike
        plan = np.stack(each, axis=1)
        compliances = plan[:, sliding_steps.PLAN.index("compliance")]
        rigid = bool(compliances[0] == 0.0)
        count = int(np.argmax((compliances == 0.0) != rigid)) or len(plan)  # a replay has steps of one kind
        host: Field = wp.array(plan[:count], dtype=wp.float64, device="cpu")
        wp.copy(self._steps.plan, host, count=count * len(sliding_steps.PLAN))
        self._course.set(step=0, steps=count)
        if not self._course["is_begun"]:
            self._begin_at(*plan[0])
        return removals[:count], rigid

    def _begin_at(self, *first: float) -> None:
        """Tell the device where the search of the first step begins."""
        step = dict(zip(sliding_steps.PLAN, first, strict=True))
        smallest, limit = self.tiles.begin_at(int(step["shift"]))
        softest = step["stiffness"]
        if self._differs and step["compliance"] > 0.0:
            self._slides.set(**{name: step[name] for name in ("own", "of_sphere", "of_disc")})
            program = Program(self._executor, records=False)
            self._say_stiffness(program)
            program.run()
            values = self._stiffness.numpy()
            softest = float(values[values > 0.0].min())
        self._course.set(smallest=smallest, first_limit=limit, softest=softest)

    def _booked(self, increments: Sequence[float], removals: Sequence[tuple[float, float]]) -> Iterator[Step]:
        """The steps that the device has made, as the ledger enters them."""
        made = self._course["step"]
        table = np.ascontiguousarray(self._steps.history[: max(made, 1)].numpy()[:made].T)
        columns = dict(zip(COLUMNS, table, strict=False))
        total = {name: columns[name] for name in SUMS}
        total |= {RENAMED.get(name, name): columns[name] for name in sliding_steps.KEPT}
        most = {name: columns[f"most_{name}"] for name in MAXIMA}
        most |= {name: columns[name] for name in ("first_row", "last_row")}
        if self.film is None:
            del total["bare"]
        if self._recession is not None:
            total["bearing"] = columns["bearing"]
        if self.pieces is not None:
            for body, of_body in zip(BODIES, table[len(COLUMNS) :].reshape(2, len(OF_BODY), -1), strict=True):
                left, worn, pending, deepest = of_body
                total |= {f"pieces_{body}": left, f"wear_{body}": worn, f"pending_{body}": pending}
                most[f"wear_{body}"] = deepest
        numbers: list[Any] = [columns[name] for name in BALANCE]
        found = Found(made, Balance(*numbers[:-1]), numbers[-1], total, most)
        return booked(found, self._ledger, np.array(increments), removals, self._enter)

    def _enter(self, *found: Any) -> Step:
        """Book a step as `Ledger.enter` does."""
        step = self._ledger.enter(*found)
        self.state.columns = self._ledger.columns
        if self.pieces is not None:
            self.state.columns = self.pieces.beside(self.state.columns)
        return step
