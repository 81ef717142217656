"""One grid on the elastic–plastic half-space: a ball, and a disc that moves or lies still under it."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import Balance, checked_residual
from warpwear.contact.certificate import Certificate, columns_of
from warpwear.contact.half_space.search import NO_CAP
from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Mirror, Numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels import contact, fourier, wear_from_pressure
from warpwear.kernels.cells import MAXIMA, CellProperties, PressureSum, names_of
from warpwear.kernels.half_space import passes
from warpwear.kernels.sliding import Bodies, OfRows, Slide
from warpwear.kernels.sliding_steps import Steps
from warpwear.kernels.wear_from_pressure import Pressed
from warpwear.laws.archard import BODIES
from warpwear.laws.task import ContactTask
from warpwear.models.attachment import Place, give_columns
from warpwear.models.film import BareCells
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.fretting import CyclicSlip
from warpwear.models.track.part_length import PartLength
from warpwear.models.track.pieces import OF_BODY, SlidingPieces
from warpwear.models.unworn import layout_of

#: Real over nominal area from which the last pressure, where it is, is a better start than none.
KEEPS_PRESSURE = 0.7
#: Sums that are averaged over the parts of a step; the others accumulate: the last part's are the step's.
OF_A_PART = ("pressure", "deviation_squared", "contact", "capped")


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

    disc, periodic, track_fraction, moves: as for `local.SlidingContact`. Raises ValueError for the same
    discs.
    """

    STATE: ClassVar = {
        "state": SlidingBodies,
        "_of_rows": InFrame("disc"),
        "_half_space": WindowedHalfSpace,
        "pieces": SlidingPieces,
        "ledger": Ledger,
        "_steps_done": int,
        "_length": PartLength,
        "film": BareCells,
        "fretting": CyclicSlip,
    }
    #: Steps are made one by one, on a GPU too.
    in_blocks = False
    #: Whether to certify the pressure with which the next step ends.
    certified = False
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
    ) -> None:
        kernels = [passes.advance, contact.gap, wear_from_pressure.gaps, fourier.forward[np.float64]]
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
        #: What is bare of film; None without one.
        self.film = BareCells.of_bodies(task, executor, self.state.wear_counter, self.state.wear_disc)
        self._properties = arguments(CellProperties, **({} if self.film is None else self.film.properties))
        self._parts = self._properties.cap_ratio
        self._least_part = 1.0 if self._parts is None else task.least_hardness / task.hardness
        #: What slips in a cycle of fretting; None where nothing frets.
        self.fretting = None if task.fretting is None else CyclicSlip(task, executor)
        #: The gap, and a mean along x.
        has_means = moves or self.fretting is not None
        self._gap, self._means = executor.zeros(), executor.zeros(executor.grid.nx if has_means else 1)
        self._bodies = arguments(Bodies, **self.state.fields)
        self._layout = layout_of(executor)
        device, slots = executor.device, executor.slots_of(executor.grid.nx)
        self._sums, self._maxima = (
            wp.zeros((len(lines), slots), dtype=wp.float64, device=device) for lines in (PressureSum, MAXIMA)
        )
        #: Part of a step that each cell was in contact, and its means along x; only where wear goes by it.
        self._rubbed = executor.zeros(None if task.shears else 0)
        self._rubbed_means = executor.zeros((executor.grid.nx if moves else 1) if task.shears else 0)
        self._bare = wp.zeros((1, slots), dtype=wp.float64, device=device)
        #: Sums of the disc's fields over each of its rows, taken anew: sums of increments would drift.
        self._of_rows = {
            name: wp.zeros(disc.shape[0], dtype=wp.float64, device=device)
            for name in ("worn_disc", "pressed_disc")
        }
        of_film = [] if self.film is None else [self._bare]
        self._mirror = Mirror(self._sums, self._maxima, *self._of_rows.values(), *of_film)
        self._slides = Numbers(Slide, executor.device, written=False, rows=executor.grid.nx, window=1)
        self._programs: dict[str, Program] = {}
        self._of_pieces = wp.zeros((1, 2 * len(OF_BODY)), dtype=wp.float64, device=device)
        #: What the parts that a study adds to a step work on.
        self._place = Place(self._slides.array, arguments(Steps, device, history=self._of_pieces))
        margin = 1 if self.fretting is None else self.fretting.margin
        self.ledger = Ledger(task, executor.grid, margin=margin, track_fraction=track_fraction)
        self.pieces = SlidingPieces.of(task, executor, self.state, periodic=periodic)
        give_columns([] if self.pieces is None else [self.pieces], ())
        #: Whether bodies wear in pieces, alone or beside dust: where all is dust no piece leaves.
        self._sheds = self.pieces is not None and task.dust < 1.0
        self._length = PartLength(task, moves=moves, sheds=self._sheds)
        #: Solves contacts without the wear of the step. It is a second solver: the first goes on as it was.
        self._static = None
        if task.static_area_every:
            self._static = WindowedHalfSpace(executor, modulus=task.modulus, **law)
        self._steps_done = 0

    def forget(self) -> None:
        """Let the next contact begin as the first one does: the disc is another."""
        self._half_space.forget()
        self._length.forget()

    def step(self, shift: int, increment: float, *, with_pressure: bool = False) -> Step:
        """Solve the contact with the disc `shift` rows on, slide by the increment [mm], wear both bodies.

        Raises ConvergenceError when the contact cannot be solved, ValueError as `SlidingContact.step`.
        """
        return self.slide(lambda done, cells: shift, 1, increment, with_pressure=with_pressure)

    def slide(
        self, row: Callable[[int, int], int], cells: int, increment: float, *, with_pressure: bool = False
    ) -> Step:
        """Slide over cells of the disc by an increment [mm] as `step` does, in as many parts as it takes.

        row: returns the disc's row under the first one of the ball for a part, from the cells done before it
        and the cells in it. The history's row of the step has the means over the parts, weighted by their
        lengths, of approach, areas, cells and squares of pressures, and the largest pressure; the pressure
        field, if asked for, is that of the last part.
        """
        before = self.ledger.row
        approach = residual = error = 0.0
        transforms = parts = done = 0
        of_film, of_shear = ["bare"] * (self.film is not None), ["rubbed"] * self.task.shears
        pooled = dict.fromkeys((*OF_A_PART, *of_film, *of_shear), 0.0)
        highest, removal, columns = 0.0, (0.0, 0.0), self.state.columns
        shears = self.task.wear_per_contact(before["distance"], increment)
        ratios = self.task.shear_ratios
        static = math.nan
        certificates: list[Certificate | None] = []
        solves_static = self._static is not None and self._steps_done % self.task.static_area_every == 0
        while done < cells:
            of_part = self._length.cells(cells - done)
            weight = of_part / cells
            shift = self.state.row_of(row(done, of_part), periodic=self.periodic)
            start = before["distance"] + increment * (done / cells)
            removals = self.task.wear_per_pressure(start, increment * weight)
            self._slides.set(
                shift=shift,
                first_column=columns[0],
                end_column=columns[1],
                start=start,
                end=start + increment * weight,
                window=self.cells_passing(increment * weight),
                shear_counter=weight * shears[0],
                shear_disc=weight * self._track_fraction * shears[1],
                **ratios,
            )
            if self.fretting is not None:
                self._begin_cycles(self.fretting, increment, removals)
            last = done + of_part == cells
            contact = self._solve(
                increment * weight, removals, certified=True if self.certified and last else None
            )
            certificates.append(contact.certificate)
            if solves_static and not parts:
                static = self._static_area()
            done, parts, transforms = done + of_part, parts + 1, transforms + contact.transforms
            pressure = contact.pressure.copy() if with_pressure and last else None
            if self.fretting is not None:
                self.fretting.note(contact)
            total, most = self._wear(contact, removals)
            if self.film is not None:
                columns = int(-most["first_column"]), int(most["last_column"]) + 1  # of all touched so far
                self._slides.set(first_column=columns[0], end_column=columns[1])
                self._run("rub", partial(self.film.after_step, place=self._place))
            load, left = self.task.load, total["pressure"] * self._executor.grid.cell_area - self.task.load
            residual = max(residual, checked_residual(left, load, approach=contact.approach), key=abs)
            # Wear by shear lowers all cells in contact by one depth, which changes the approach alone; what
            # some cells lose beyond it was in their gap.
            lift = weight * (shears[0] + self._track_fraction * shears[1]) * ratios["least_shear_ratio"]
            approach += weight * (contact.approach + lift)
            fretted = {}
            if self.fretting is not None:
                area = self._executor.grid.cell_area
                fretted = self.fretting.row(increment, total["slip_work"] * area, total["stuck"] * area)
                removals = self.fretting.worn(removals, fretted["slip_mean"])
            removal = removal[0] + removals[0], removal[1] + removals[1]
            highest = max(highest, most["pressure"])
            for name in pooled:
                pooled[name] += weight * total[name]
            self._look(total, most)
            error = max(error, self._length.error(of_part))
        if self.pieces is not None:
            self._shed(total, most)
        cap = min(self.task.hardness, NO_CAP)
        balance = Balance(approach, 0.0, cap, residual, evaluations=transforms)
        step = self.ledger.enter(
            balance,
            increment,
            (*removal, *shears),
            before["pressure_mean"],
            total | pooled,
            most | {"pressure": highest},
            pressure=pressure,
        )
        step.row.update(parts=float(parts), area_error=error, **columns_of(*certificates), **fretted)
        if self._static is not None:
            step.row["area_static"] = static
        self._steps_done += 1
        self.state.columns = self.ledger.columns
        if self.pieces is not None:
            self.state.columns = self.pieces.beside(self.state.columns)
        return step

    def _look(self, total: Mapping[str, float], most: Mapping[str, float]) -> None:
        """Learn from sums and maxima of the last contact how to start the next, and how to divide steps."""
        if not self._moves:
            return
        # Extents in cells of all that was ever touched; first rows and columns come with a minus.
        along = most["last_row"] + most["first_row"] + 1.0
        across = most["last_column"] + most["first_column"] + 1.0
        bearing = total["contact"] / (0.25 * math.pi * along * across)
        if bearing < KEEPS_PRESSURE:
            # The last pressure is then no better a start than none, neither in place nor moved with the disc.
            self._half_space.forget()
        elastic = 1.0 - total["capped"] / total["contact"]
        self._length.learn(along=along, bearing=bearing, elastic=elastic)

    def _solve(
        self, increment: float, removals: tuple[float, float], *, certified: bool | None
    ) -> HalfSpaceContact:
        """Solve the contact at the end of an increment [mm] that wears counter and disc by K ΔL [mm³/N]."""
        of_mean, of_place = (self.task.dust * removal for removal in removals)
        window, yields = self.cells_passing(increment), None
        if self.fretting is None:
            self._run("gaps", self._add_gaps)
        else:
            of_place, of_mean = (self.fretting.shares(removals)[f"k_{body}"] for body in BODIES)
            yields = self.fretting.yields
        own = of_mean if window == 1 else 0.0  # a mean over one cell changes nothing
        return self._half_space.solve(
            self._gap,
            load=self.task.load,
            compliance=self._track_fraction * of_place + own,
            streak_compliance=of_mean - own,
            streak_window=window,
            parts=self._parts,
            yields=yields,
            least_part=self._least_part,
            certified=certified,
        )

    def _begin_cycles(self, fretting: CyclicSlip, increment: float, removals: tuple[float, float]) -> None:
        """Find what slips in a jump over cycles of fretting, and the compliance that its wear lends."""
        self._slides.set(window=fretting.window, counter_moves=1)
        self._run("gaps", self._add_gaps)
        if not fretting.knows_approach:
            fretting.note(self._half_space.solve(self._gap, load=self.task.load))
        fretting.look(self._gap, self._slides)
        self._slides.set(window=fretting.window, ahead=fretting.ahead(increment), **fretting.shares(removals))
        self._run("gaps", self._add_gaps)
        if fretting.yields is not None:
            self._run("yields", lambda program: fretting.add_yields(program, self._slides.array))

    def _static_area(self) -> float:
        """Return the area [mm²] of a contact on the last gap, without the compliance that wear lends it."""
        assert self._static is not None
        self._static.begin_like(self._half_space)
        contact = self._static.solve(
            self._gap, load=self.task.load, parts=self._parts, least_part=self._least_part
        )
        return contact.cells_in_contact * self._executor.grid.cell_area

    def _add_gaps(self, program: Program) -> None:
        """Add the beginning of a part: bare cells, pieces that are due, and the gap that the disc meets."""
        slides = self._slides.array
        for one in (self.film, self.pieces):
            if one is not None:
                one.before_search(program, self._place)
        worn = self.state.wear_counter if self.fretting is None else self.state.wear_disc
        program.launch(wear_from_pressure.means, slides, worn, self._means)
        program.launch(
            wear_from_pressure.gaps, slides, self._bodies, self._properties, self._means, self._gap
        )

    def _add_wear(self, program: Program, contact: HalfSpaceContact) -> None:
        """Add the wear of both bodies by the pressure of a contact."""
        slides, pressure = self._slides.array, contact.pressure_field
        pressed = arguments(Pressed, pressure=pressure, means=self._means, gradient=contact.gradient_field)
        pressed.cap, pressed.cells = min(self.task.hardness, NO_CAP), self._properties
        pressed.rubbed, pressed.rubbed_means = self._rubbed, self._rubbed_means
        if self.task.shears:
            program.launch(wear_from_pressure.part_of_step, slides, pressed)
            program.launch(wear_from_pressure.means, slides, self._rubbed, self._rubbed_means)
        if self.fretting is not None:
            pressed.slips, pressed.grown = self.fretting.slips, self.fretting.grown
        program.launch(wear_from_pressure.means, slides, pressure, self._means)
        tables = [arguments(OfRows, **self._of_rows), self._sums, self._maxima]
        program.launch(wear_from_pressure.wear, slides, self._layout, pressed, self._bodies, *tables)
        if self.film is not None:
            self.film.add_under(program, slides, pressure, self._bare)
        if self.pieces is not None:
            self.pieces.add_take(program, slides, pressure)

    def _run(self, name: str, add: Callable[[Program], None]) -> None:
        """Run the program of a name; `add` writes it at first."""
        if name not in self._programs:
            program = self._programs[name] = Program(self._executor)
            add(program)
        self._programs[name].run()

    def _wear(
        self, contact: HalfSpaceContact, removals: tuple[float, float]
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Wear both bodies by the pressure of a contact; return sums and maxima by name."""
        disc, dust = self._track_fraction * removals[1], self.task.dust
        worn = {"k_counter": dust * removals[0], "k_disc": dust * disc}
        self._slides.set(
            **(worn if self.fretting is None else self.fretting.shares(removals)),
            pending_counter=(1.0 - dust) * removals[0],
            pending_disc=(1.0 - dust) * disc,
            approach=contact.approach,
            reference=self.ledger.row["pressure_mean"],  # the scatter is summed about a value near the mean
        )
        self._run("wear", lambda program: self._add_wear(program, contact))
        sums, maxima, *single = self._mirror.read()
        most = dict(zip(MAXIMA, maxima.max(axis=1).tolist(), strict=True))
        total = dict(zip(names_of(PressureSum), sums.sum(axis=1).tolist(), strict=True))
        names = ("wear_disc", "pressed_disc", "bare")
        total.update(zip(names, (float(values.sum()) for values in single), strict=self.film is not None))
        return total, most

    def _shed(self, total: dict[str, float], most: dict[str, float]) -> None:
        """Let the pieces of a step leave; enter what is worn and pending then among sums and maxima."""
        pieces = self.pieces
        assert pieces is not None
        goes_on = True
        while goes_on:
            self._run("shed", partial(pieces.between, place=self._place))
            goes_on = pieces.drain()
        pieces.end_steps(1)
        for body, sums in zip(BODIES, self._of_pieces.numpy().reshape(2, -1).tolist(), strict=True):
            total[f"pieces_{body}"], total[f"wear_{body}"], total[f"pending_{body}"], deepest = sums
            most[f"wear_{body}"] = deepest

    def cells_passing(self, increment: float) -> int:
        """Return the cells of the disc that pass one of the ball in an increment [mm]; under a flat all."""
        grid = self._executor.grid
        if self.fretting is not None:
            return self.fretting.window
        if not self._moves or self._sheds:  # pieces cut what a mean would smear
            return 1
        if self.task.form.is_flat:
            return grid.nx
        return min(max(round(self._track_fraction * increment / (self.stands_for * grid.cell)), 1), grid.nx)
