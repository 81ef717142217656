"""One grid on the elastic–plastic half-space: a ball, and a disc that moves or lies still under it."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import takewhile
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance
from warpwear.contact.half_space.search import NO_CAP
from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Mirror, Numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels import fourier, wear_from_pressure
from warpwear.kernels.cells import LANES, MAXIMA, OF_FEATURES, PressureSum
from warpwear.kernels.half_space import passes
from warpwear.kernels.half_space.solve import CONVERGED, Request
from warpwear.kernels.sliding import Bodies, RowSums, Slide
from warpwear.kernels.sliding_steps import SlidingSteps
from warpwear.kernels.wear_from_pressure import Pressed
from warpwear.laws.archard import BODIES
from warpwear.laws.task import ContactTask
from warpwear.models.features.feature import Place
from warpwear.models.features.features import Features, asks
from warpwear.models.features.materials import steps_above
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.part_length import PartLength
from warpwear.models.track.starts import NEIGHBOUR, NO_LAP, NOTHING, WAY, Starts, Way
from warpwear.models.track.step_means import Made, StepMeans, Substep
from warpwear.models.track.step_program import MOST, SUMS, StepProgram
from warpwear.models.unworn import layout_of
from warpwear.models.wear_lines import WearLines


class SlidingHalfSpace:
    """Contact and wear of one study with contact.law = "half-space" on one executor.

    A step finds the pressure p with which it ends (implicit Archard). During it the asperities, and p with
    them, move on by w cells. A disc cell is worn by its own p, a ball cell by S p, the mean over w cells
    along x. On its way a disc cell meets S of what the ball has lost, before the step and in it: the gap is
    made with S of the ball's wear, and p adds (G + K_disc ΔL + K_counter ΔL S²) p to it. With the wear at
    the middle of the way instead, waves of the ball between w/2 and w, for which S is negative, would grow.
    Under a flat w is the whole line: its contact goes on beyond the domain, while under a ball a mean over
    the line would smear the contact's outline, which does not move with the disc. Where the disc lies
    still w is one cell, so that both bodies are worn by p, and a step starts from the last one's pressure.

    The outline of a ball's contact and its mean pressure do not move with the disc either: S of them makes
    the contact shorter. Asperities below the hardness yield by the wear of the step too, which makes them
    wider. So a step is solved in parts, so short that the error of both together is estimated at 2 % of the
    area at most, see `part_length`; over one cell S changes nothing.

    disc, periodic, track_fraction, moves: as for `local.SlidingContact`. places: of the contacts of a cycle,
    at most. Raises ValueError for the same
    discs.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "_of_rows": InFrame("disc"),
        "_half_space": WindowedHalfSpace,
        "features": Features,
        "ledger": Ledger,
        "_steps_done": int,
        "length": PartLength,
        "_starts": Starts,
    }
    SCRATCH: ClassVar = (
        *("gap", "slides", "_means", "_sums", "_maxima", "_mirror", "_sheared", "_sheared_means", "_row"),
        *("_place", "_programs", "_static", "_asked", "_unreached", "_step_program", "_requested"),
        "_grew",
    )
    #: Steps are made one by one, on a GPU too.
    in_blocks = False
    #: Whether to certify the pressure with which the next step ends.
    certified = False
    #: Whether later steps may start from the pressures of the next.
    learns = True
    #: Tolerance of contacts over a disc that moves, unless they are certified; None: the solver's.
    on_the_way: float | None = 1.0e-4
    #: Cycles that the next step stands for: its increment is as many times as long as its way over the disc.
    stands_for = 1

    def __init__(
        self,
        task: ContactTask,
        disc: FloatArray,
        executor: Executor,
        *,
        periodic: bool = False,
        track_fraction: float = 1.0,
        moves: bool = True,
        places: int = 0,
    ) -> None:
        kernels = [passes.advance, wear_from_pressure.gaps, fourier.forward[np.float64]]
        executor.foresee(kernels)  # what takes longest first
        self.state = SlidingBodies.of(task, executor, disc)
        self.task = task
        self.periodic = periodic
        self._executor = executor
        self._track_fraction, self._moves = track_fraction, moves
        assert task.modulus is not None  # checked with the study
        executor.load(wear_from_pressure.gaps)
        law: dict[str, Any] = {"boundary": task.boundary, "hardness": task.hardness}
        self._half_space = WindowedHalfSpace(executor, modulus=task.modulus, **law)
        #: What the study adds to a step.
        site: Any = {"periodic": periodic, "track_fraction": track_fraction}
        self.features = Features.of(task, executor, self.state.fields, **site)
        #: That which the next step asks: until a cell can reach another material, none of materials.
        self._asked, self._unreached = self.features, self.features.without("materials")
        if self._caps["cap_ratio"] is not None or self.features.value_of("yields") is not None:
            executor.foresee([passes.bound])
        #: The gap, and a mean along x.
        has_means = moves or self.features.moves_pressure
        self.gap, self._means = executor.zeros(), executor.zeros(executor.grid.nx if has_means else 1)
        self._bodies, self._layout = arguments(Bodies, **self.state.fields), layout_of(executor)
        self._tables(disc.shape[0])
        self.slides = Numbers(
            Slide,
            executor.device,
            written=False,
            rows=executor.grid.nx,
            window=1,
            counter_moves=int(self.features.moves_pressure),
            **task.shear_ratios,
        )
        self._programs: dict[tuple[str, bool], Program] = {}
        self._row = wp.zeros((1, len(self.features.columns)), dtype=wp.float64, device=executor.device)
        #: What features of a step work on.
        steps = arguments(SlidingSteps, executor.device, history=self._row)
        self._place = Place(self.slides.array, steps, bodies=self._bodies)
        edge = max((one.edge for one in self.features), default=1)
        self.ledger = Ledger(task, executor.grid, margin=edge, track_fraction=track_fraction)
        self.length = PartLength(task, is_free=moves and not task.form.is_flat)
        #: Finds what wears cells whose K goes with their pressure; None where none does.
        self._lines = WearLines(task.knots, executor, moves=moves) if len(task.knots) else None
        #: Solves contacts without the wear of the step. It is a second solver: the first goes on as it was.
        self._static, self._grew = None, False
        if task.static_area_every:
            self._static = WindowedHalfSpace(executor, modulus=task.modulus, **law)
        self._steps_done = 0
        #: What the last program was made for, and what it asked of its searches.
        self._requested: tuple[Any, FloatArray] = (), np.zeros(0)
        self._starts = Starts(executor, memory=task.lap_memory, places=places if moves else 0)
        tables = self._sums, self._maxima
        adds: dict[str, Any] = {
            "cap": min(task.hardness, NO_CAP),
            "add_gaps": self._add_gaps,
            "add_wear": self._add_wear,
            "add_after": self._add_after,
        }
        self._step_program = StepProgram(executor, self.slides, self._starts.laps, tables, **adds)

    def _tables(self, disc_rows: int) -> None:
        """Make the tables in which the pass that wears leaves its sums."""
        executor, shears = self._executor, self.task.shears
        device, slots = executor.device, executor.slots_of(executor.grid.nx)
        self._sums, self._maxima = (
            wp.zeros((len(lines), slots), dtype=wp.float64, device=device) for lines in (PressureSum, MAXIMA)
        )
        #: Part of a step that each cell was in contact, and its means along x; only where wear goes by it.
        self._sheared = executor.zeros(None if shears else 0)
        self._sheared_means = executor.zeros((executor.grid.nx if self._moves else 1) if shears else 0)
        #: Sums of the disc's fields over each of its rows, taken anew: sums of increments would drift.
        self._of_rows = {
            name: wp.zeros(disc_rows, dtype=wp.float64, device=device)
            for name in ("worn_disc", "pressed_disc")
        }
        self._mirror = Mirror(self._sums, self._maxima, *self._of_rows.values())

    def forget(self) -> None:
        """Let the next contact begin as the first one does: the disc is another."""
        self._half_space.forget()
        self.forget_way()

    def forget_way(self) -> None:
        """Learn anew how to start contacts, and how to divide steps: the track is another."""
        self.length.forget()
        self._starts.forget()

    def forget_laps(self) -> None:
        """Leave the pressures of laps: parts are of another length."""
        self._starts.forget()

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        Raises ConvergenceError when the contact cannot be solved, ValueError as `SlidingContact.step`.
        """
        return self.slide(lambda done, cells: shift, 1, increment, with_pressure=with_pressure)

    def slide(
        self,
        row: Callable[[int, int], int],
        cells: int,
        increment: float,
        *,
        way: Way = WAY,
        with_pressure: bool = False,
    ) -> Step:
        """Slide over cells of the disc by an increment [mm] as `step` does, in as many parts as it takes.

        row: returns the disc's row under the first one of the ball for a part, from the cells done before it
        and the cells in it. The history's row of the step has the means over the parts, weighted by their
        lengths, of approach, areas, cells and squares of pressures, and the largest pressure; the pressure
        field, if asked for, is that of the last part.
        """
        before, static = self.ledger.row, math.nan
        by_pressure = self._lines is not None
        about = self.task, self._track_fraction, before["distance"], increment
        means = StepMeans(*about, by_pressure=by_pressure)
        self._begin_materials(means.part(0.0, 1.0))
        parts = self._divide(means, row, cells)
        due = self._static is not None and self._steps_done % self.task.static_area_every == 0
        start, learns = NEIGHBOUR, self.learns and self.length.trial is None
        if self._moves:
            # Steps that are made again know no laps, and start as those did else: areas are compared.
            place = f"{parts[0].shift} {way.lane}" if self.length.trial is None else ""
            start = self._starts.choose(place, tries=learns)
        done, area, made, self._grew = 0, self._executor.grid.cell_area, None, False
        while done < len(parts):
            left = parts[done : 1 if due and not done else done + 1 if self._grew else None]
            # What has outgrown its window is found again from there, wherever the parts before it were made.
            begin, self._grew = NEIGHBOUR if self._grew else start, False
            count, made = self._in_one_go(left, begin, way)
            if made is None:
                count, made = 1, self._alone(left[0], begin)
            if due and self._static and not done:
                static = self._static_area(self._static)
            done, last = done + count, left[count - 1]
            row_of_part = self._asked.row(last.increment, {name: v[-1] for name, v in made.sums.items()})
            worn = self._asked.worn(last.removals, row_of_part)
            means.add(left[:count], made, cell_area=area, worn=worn, row=row_of_part)
        assert made is not None  # a step has a part
        sums, most = self._total(made)
        if learns and self._moves and not self.certified:
            self._starts.learn(start, means.transforms / len(parts))
        total, most = self._end_step(sums | means.total, most | {"pressure": means.highest})
        cap = min(self.task.hardness, NO_CAP)
        balance = Balance(means.approach, 0.0, cap, means.residual, evaluations=means.transforms)
        entry = balance, increment, means.removals, before["pressure_mean"], total, most
        step = self.ledger.enter(*entry, pressure=self._half_space.pressure if with_pressure else None)
        step.row.update(
            means.row | {"area_error": self.length.error}, **({"area_static": static} if self._static else {})
        )
        self._steps_done += 1
        self.state.columns = self._asked.beside(self.ledger.columns)
        return step

    def _divide(self, means: StepMeans, row: Callable[[int, int], int], cells: int) -> list[Substep]:
        """Divide a step over cells into parts."""
        parts, done = list[Substep](), 0
        # At rest a contact that is found from nothing is certified.
        on_the_way = (self.on_the_way, False) if self._moves else (None, None)
        while done < cells:
            count = self.length.cells(cells - done)
            shift = self.state.row_of(row(done, count), periodic=self.periodic)
            parts.append(means.part(done / cells, count / cells, shift, count, *on_the_way))
            done += count
        if self.certified or (self._moves and not self._steps_done):
            parts[-1] = parts[-1]._replace(tolerance=None, certified=True)
        return parts

    def _alone(self, part: Substep, start: str) -> Made:
        """Make a part of a step by itself."""
        if start == NOTHING:
            self._half_space.forget()
        self._set_part(part)
        self.make_gap()
        contact = self._solve(part)
        sums, most = self._wear(contact, part)
        tables = ({name: np.array([v]) for name, v in table.items()} for table in (sums, most))
        return Made(np.array([contact.approach]), contact.transforms, contact.certificate, *tables)

    def _in_one_go(self, parts: Sequence[Substep], start: str, way: Way) -> tuple[int, Made | None]:
        """Make the first of some parts of a step in one program; none where they must be made by themselves.

        They have one compliance, and their contacts stay in one window. Return how many were made.
        """
        alone = any(asks(one, hook) for one in self._asked for hook in ("prepare", "note", "row"))
        # On a GPU what features add within two loops is lost: pieces were seen to wear nothing there.
        alone = alone or (bool(self._asked) and not self._executor.device.is_cpu)
        if not self._moves or self._lines is not None or alone:
            return 0, None
        first, caps, anew = parts[0], self._caps, start == NOTHING
        rows = self.cells_passing(first.increment)
        about = {"load": self.task.load, "rows": rows, "least": caps["least_cap_ratio"]}
        own = {"cap_ratio": caps["cap_ratio"], "yields": self._asked.value_of("yields")}
        stay = self._half_space.stay(self.gap, self.state.counter, anew=anew, **about, **own)
        if stay is None:
            return 0, None
        group = list(takewhile(first.is_like, parts[:MOST]))
        asked = stay.search, self._asked, rows, first.increment, first.removals, first.shears
        if asked != self._requested[0]:  # mostly steps are alike
            self._set_part(first)
            compliances, tolerance = self._compliances(first), self._half_space.tolerance
            request = stay.here.solver.request(*compliances, rows, tolerance=tolerance)
            self._requested = asked, np.array([request.get(name, 0.0) for name in Request])
        self.slides.set(reference=self.ledger.row["pressure_mean"])
        starts, ahead, places = [], [], [f"{part.shift} {way.lane}" for part in group]
        keeps = self.learns and self.length.trial is None and self._starts.keeps
        for place in places:
            lap = NO_LAP
            if self.length.trial is None:
                lap = self._starts.lap_of(place, way.end, start, keeps=keeps)
            last, before = (row + stay.box[0] for row in (lap.row, lap.row_before))
            starts.append((before, stay.box[2] // LANES, last, lap.ahead is not None, lap.keeps))
            ahead.append(lap.ahead or 0.0)
        from_nothing = anew or not stay.here.solver.started, anew
        self._step_program.set(group, self._requested[1], starts, ahead, anew=from_nothing)
        count, made = self._step_program.run(len(group), stay, self._asked is self.features)
        if keeps:
            self._starts.note(places[:count], way.end)
        found = count < len(group) and stay.search.read() == CONVERGED
        self._grew = found and self._half_space.outgrows(rows=rows)
        if self._grew and made is None:
            return self._in_one_go(parts[:1], NEIGHBOUR, way)
        if made is not None:
            self._half_space.end_stay(whole=count == len(group), **about)
            if self._asked:
                self._show_touched({name: values[-1] for name, values in made.most.items()})
        return count, made

    def _begin_materials(self, whole: Substep) -> None:
        """Choose what a step asks, by all of it."""
        removals = dict(zip(BODIES, whole.removals, strict=True))
        removals["disc"] *= self._track_fraction
        above = steps_above(self.task, self._executor.grid.cell_area, self.ledger.most, removals)
        self._asked = self._unreached if above else self.features

    def _set_part(self, part: Substep) -> None:
        """Say in `slides` what a part of a step is."""
        self._requested = (), self._requested[1]
        shears = dict(zip(("shear_counter", "shear_disc"), part.shears, strict=True))
        self.slides.set(shift=part.shift, start=part.start, end=part.start + part.increment, **shears)
        for one in self._asked:
            one.prepare(self, part.increment, part.removals)
        self.slides.set(window=self.cells_passing(part.increment), **self._wears(part))
        self.slides.set(compliance=self._compliances(part)[0])

    def make_gap(self) -> None:
        """Make the gap that the disc's cells meet on their way, and what they have of their own."""
        self._run("gaps", self._add_gaps)

    def solve(self) -> HalfSpaceContact:
        """Solve the contact on the gap as it lies, without the wear of a step."""
        return self._half_space.solve(self.gap, load=self.task.load)

    def _solve(self, part: Substep) -> HalfSpaceContact:
        """Solve the contact at the end of a part of a step, and let features take note of it."""
        (own, along), certified = self._compliances(part), part.certified
        solve: Callable[..., HalfSpaceContact] = partial(
            self._half_space.solve, load=self.task.load, tolerance=part.tolerance, **self._caps
        )
        if self._lines is None:
            contact = solve(
                self.gap,
                compliance=own,
                streak_compliance=along,
                streak_window=self.cells_passing(part.increment),
                yields=self._asked.value_of("yields"),
                certified=certified,
            )
        else:
            wears, start = self._wears(part), self._half_space.start
            removals = wears["k_counter"], wears["k_disc"]
            window = self.cells_passing(part.increment)
            contact = self._lines.solve(solve, self.gap, start, removals, certified=certified, window=window)
        for one in self._asked:
            one.note(contact)
        return contact

    def _compliances(self, part: Substep) -> tuple[float, float]:
        """Return what the wear of a part lends all cells by their pressure, and by its mean [mm³/N]."""
        wears, window = self._wears(part), self.cells_passing(part.increment)
        of_mean, of_place = (
            wears[f"k_{b}"] * r for b, r in zip(BODIES, self._asked.ratios(window), strict=True)
        )
        if self._asked.moves_pressure:
            of_place, of_mean = of_mean, of_place
        own = of_mean if window == 1 else 0.0  # a mean over one cell changes nothing
        return of_place + own, of_mean - own

    @property
    def _caps(self) -> dict[str, Any]:
        """Parts of the hardness that cells bear, and the least of them."""
        task, ratio = self.task, self._asked.cells.cap_ratio
        least = 1.0 if ratio is None else task.least_hardness / task.hardness
        return {"cap_ratio": ratio, "least_cap_ratio": least}

    def _static_area(self, solver: WindowedHalfSpace) -> float:
        """Return the area [mm²] of a contact on the last gap, without the compliance that wear lends it."""
        solver.begin_like(self._half_space)
        contact = solver.solve(self.gap, load=self.task.load, **self._caps)
        return contact.cells_in_contact * self._executor.grid.cell_area

    def _add_gaps(self, program: Program) -> None:
        """Add the beginning of a part: what features have to do, and the gap that the disc meets."""
        slides, features = self.slides.array, self._asked
        features.ask("before_search", program, self._place)
        worn = self.state.wear_disc if features.moves_pressure else self.state.wear_counter
        program.launch(wear_from_pressure.means, slides, worn, self._means)
        cells = features.sources, features.cells
        program.launch(wear_from_pressure.gaps, slides, self._bodies, *cells, self._means, self.gap)

    def _add_wear(self, program: Program) -> None:
        """Add the wear of both bodies by the pressure of a contact."""
        slides, (pressure, gradient) = self.slides.array, self._half_space.fields
        pressed = arguments(
            Pressed,
            pressure=pressure,
            means=self._means,
            gradient=gradient,
            sheared=self._sheared,
            sheared_means=self._sheared_means,
            cells=self._asked.cells,
            cap=min(self.task.hardness, NO_CAP),
            **self._asked.pressed,
        )
        if self.task.shears:
            program.launch(wear_from_pressure.part_of_step, slides, pressed)
            program.launch(wear_from_pressure.means, slides, self._sheared, self._sheared_means)
        if self._lines is not None:
            pressed.on_counter, pressed.on_disc = self._lines.counter, self._lines.disc
        program.launch(wear_from_pressure.means, slides, pressure, self._means)
        place = self._place._replace(pressed=pressed)
        self._asked.ask("before_wear", program, place)
        tables = [arguments(RowSums, **self._of_rows), self._sums, self._maxima]
        program.launch(wear_from_pressure.wear, slides, self._layout, pressed, self._bodies, *tables)
        self._asked.ask("after_wear", program, place)

    def _run(self, name: str, add: Callable[[Program], None]) -> None:
        """Run the program of a name; `add` writes it at first."""
        said = name, self._asked is self.features
        if said not in self._programs:
            program = self._programs[said] = Program(self._executor)
            add(program)
        self._programs[said].run()

    def _wears(self, part: Substep) -> dict[str, float]:
        """Return K ΔL of a part of a step as a `Slide` has it."""
        counter, disc = part.removals[0], self._track_fraction * part.removals[1]
        dust = self.task.dust
        wears = {"k_counter": dust * counter, "k_disc": dust * disc}
        wears |= {"pending_counter": (1.0 - dust) * counter, "pending_disc": (1.0 - dust) * disc}
        for one in self._asked:
            wears |= one.wears(part.removals)
        return wears

    def _wear(self, contact: HalfSpaceContact, part: Substep) -> tuple[dict[str, float], dict[str, float]]:
        """Wear both bodies by the pressure of a contact; return sums and maxima by name."""
        self.slides.set(
            approach=contact.approach,
            reference=self.ledger.row["pressure_mean"],  # the scatter is summed about a value near the mean
            **self._wears(part),
        )
        wearing = self._lines.press(contact.pressure_field) if self._lines else {}
        self._run("wear", self._add_wear)
        sums, maxima, *_ = self._mirror.read()
        most = dict(zip(MAXIMA, maxima.max(axis=1).tolist(), strict=True))
        total = dict(zip(SUMS, sums.sum(axis=1).tolist(), strict=True)) | wearing
        if self._asked:
            self._show_touched(most)
            self._run("after", self._add_after)
        return total, most

    def _show_touched(self, most: Mapping[str, float]) -> None:
        """Say in `slides` which columns were touched so far."""
        self.slides.set(first_column=-most["first_column"], end_column=most["last_column"] + 1.0)

    def _add_after(self, program: Program) -> None:
        """Add what follows a part of a step."""
        self._asked.ask("after_part", program, self._place)

    def _total(self, last: Made) -> tuple[dict[str, float], dict[str, float]]:
        """Return sums and maxima of the last part, with those of the disc."""
        _, _, *of_rows = self._mirror.read()
        names = "wear_disc", "plastic_volume_disc"
        total = {name: float(rows.sum()) for name, rows in zip(names, of_rows, strict=True)}
        sums, most = ({name: float(v[-1]) for name, v in table.items()} for table in (last.sums, last.most))
        return sums | total, most

    def _end_step(
        self, sums: Mapping[str, float], most: dict[str, float]
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Let features end a step, and enter what they say among its sums and maxima."""
        goes_on = bool(self._asked)
        while goes_on:
            self._run("between", lambda program: self._asked.ask("between", program, self._place))
            goes_on = self._asked.drain()
        if self._asked:
            self._run("end", lambda program: self._asked.ask("end_step", program, self._place))
        self._asked.end_steps(1)
        columns = self.features.columns
        own = zip(columns, self._row.numpy()[0].tolist() if columns else (), strict=True)
        total = {name: value for name, value in sums.items() if name not in OF_FEATURES}
        self._asked.enter({**sums, **dict(own)}, total, most)
        return total, most

    def cells_passing(self, increment: float) -> int:
        """Return the cells of the disc that pass one of the ball in an increment [mm]; under a flat all."""
        grid = self._executor.grid
        if self._asked.value_of("window") is not None:
            return self._asked.value_of("window")
        if not self._moves:
            return 1
        if self.task.form.is_flat:
            return grid.nx
        return min(max(round(self._track_fraction * increment / (self.stands_for * grid.cell)), 1), grid.nx)
