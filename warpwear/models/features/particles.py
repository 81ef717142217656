"""Wear in particles: what is pending of the bodies of a contact, and the pieces that have left."""

import math
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments, as_numbers
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.kernels.cells import LANES, PieceCount
from warpwear.kernels.running_in import pieces as kernels
from warpwear.kernels.running_in import shedding
from warpwear.kernels.sliding import Slide
from warpwear.laws.archard import BODIES
from warpwear.laws.pieces import ROUNDS
from warpwear.laws.pieces import Pieces as PieceLaw
from warpwear.models.features.feature import Feature, Place, Site

#: What a row of the history says of each body.
OF_BODY = ("pieces", "wear", "pending", "deepest")
#: Columns of a row of the history.
COLUMNS = tuple(f"{name}_{body}" for body in BODIES for name in OF_BODY)
#: Pieces that the table holds at least.
ROOM = 4096


class Pending:
    """Depths pending of one body, where a piece is due, and the sums over its rows.

    fields: height and wear of the body. number: 0 the ball, whose heights grow as it is worn, 1 the disc.
    """

    STATE: ClassVar = {"pending": Field, "overflow": np.ndarray, "_of_rows": Field}
    SCRATCH: ClassVar = ("body",)

    def __init__(
        self,
        executor: Executor,
        law: PieceLaw,
        footprint: Arguments,
        fields: tuple[Field, Field],
        *,
        number: int,
        periodic: bool,
    ) -> None:
        (height, self._wear), grid, device = fields, executor.grid, executor.device
        rows, cell = height.shape[0], grid.cell
        self._executor, self._footprint = executor, footprint
        self.pending: Field = executor.field(law.start((rows, grid.ny), cell, body=number))
        shape = rows, executor.vectors * LANES
        #: Pieces of a round at most: no two within `apart` cells along both axes.
        self.most = (rows // (law.apart(cell) + 1) + 2) * (grid.ny // (law.apart(cell) + 1) + 2)
        self.body = arguments(
            kernels.SheddingBody,
            device,
            height=as_numbers(height, shape),
            wear=as_numbers(self._wear, shape),
            pending=as_numbers(self.pending, shape),
            **dict.fromkeys(("sums", "candidates", "due", "waiting"), math.prod(shape)),
            peaks=self.most,
            counts=len(PieceCount),
            of_rows=(3, rows),
            down=1.0 if number == 0 else -1.0,
            number=number,
            columns=grid.ny,
            periodic=int(periodic),
        )
        self._of_rows: Field = self.body.of_rows
        every = Program(executor, records=False)
        whole = Numbers(Slide, executor.device, rows=rows + executor.grid.nx)
        self._count(PieceCount.WAITED, 1)
        every.launch(
            shedding.total_rows,
            *(whole.array, footprint, self.body, self._wear, self.pending),
            slots=executor.slots_of(rows),
        )
        every.run()
        self._count(PieceCount.WAITED, 0)
        self.body.start = float(self._of_rows.numpy()[1].sum())

    @property
    def overflow(self) -> "np.ndarray[Any, Any]":
        """Cells that are due since the rounds of a step were not enough, by index; may be set."""
        count = int(self.body.counts.numpy()[PieceCount.WAITING])
        cells: np.ndarray[Any, Any] = np.sort(self.body.waiting.numpy()[:count])
        return cells

    @overflow.setter
    def overflow(self, cells: "np.ndarray[Any, Any]") -> None:
        host = self.body.waiting.numpy()
        host[: cells.size] = cells
        self.body.waiting.assign(host)
        self._count(PieceCount.WAITING, cells.size)

    def add_shed(self, program: Program, slides: Field, release: Arguments, line: tuple[Field, int]) -> None:
        """Add to a program that pieces leave which are due, and what the body has lost then.

        line: the rows of the history, and the column of the first of `OF_BODY`.
        """
        # On a CPU one thread does it all: the others would write the same lists.
        few = self._executor.slots_of(self.pending.shape[0]) if self._executor.device.is_cuda else 1
        alone: dict[str, Any] = {"slots": few, "chunks": [(0, few)]}
        footprint, body = self._footprint, self.body
        program.decide(shedding.begin_rounds, body, release)
        with program.loop(release.sheds):
            program.launch(shedding.sum_up, footprint, body, **alone)
            program.launch(shedding.find_peaks, footprint, body, **alone)
            program.decide(shedding.begin_cut, footprint, body, release)
            program.launch(shedding.cut, slides, footprint, body, release, **alone)
        program.decide(shedding.end_rounds, body, release)
        with program.branch(release.closes):
            program.launch(shedding.close, footprint, body, **alone)
            program.launch(shedding.total_rows, slides, footprint, body, self._wear, self.pending)
            rows, column = line
            program.decide(shedding.note, slides, body, column, rows)

    def _count(self, which: int, value: int) -> None:
        host = self.body.counts.numpy()
        host[which] = value
        self.body.counts.assign(host)


class SlidingParticles(Feature, name="particles"):
    """Particles of both bodies of a contact that slides or lies still.

    The table of pieces may get full while they leave: `drain` empties it after each replay, and tells whether
    the program is to be run again before its step is done.
    """

    STATE: ClassVar = {"counter": InFrame("counter"), "disc": InFrame("disc"), "book": PieceBook}
    SCRATCH: ClassVar = ("_both", "_release", "_footprint")
    columns = COLUMNS
    book: PieceBook
    changes_heights = True

    def __init__(self, law: PieceLaw, site: Site) -> None:
        executor, bodies, periodic = site.executor, site.bodies, site.periodic
        cell, device = executor.grid.cell, executor.device
        if law.dust < 1.0:
            self.window = 1  # particles cut what a mean would smear; where all is dust none leaves
        places, bowl = law.footprint(cell)
        self.law, self._executor, self.margin = law, executor, law.margin(cell)
        self._track_fraction = site.track_fraction
        self._footprint = arguments(
            kernels.Footprint,
            along=wp.array(places[:, 0], dtype=wp.int32, device=device),
            across=wp.array(places[:, 1], dtype=wp.int32, device=device),
            bowl=wp.array(bowl, dtype=wp.float64, device=device),
            needed=float(bowl.sum()),
            reach=law.reach(cell),
            apart=law.apart(cell),
            margin=self.margin,
            rounds=ROUNDS,
        )
        counter, disc = ((bodies[body], bodies[f"wear_{body}"]) for body in BODIES)
        self.counter = Pending(executor, law, self._footprint, counter, number=0, periodic=False)
        self.disc = Pending(executor, law, self._footprint, disc, number=1, periodic=periodic)
        self.both = self.counter, self.disc
        both = {"counter": self.counter.body, "disc": self.disc.body}
        self._both = arguments(kernels.Both, footprint=self._footprint, **both)
        self.book = PieceBook()
        room = max(self.counter.most, self.disc.most, ROOM)
        self._release = arguments(
            shedding.Release,
            device,
            pieces=(room, shedding.COLUMNS),
            begins=wp.array([1], dtype=wp.int32, device=device),
        )

    def beside(self, columns: tuple[int, int]) -> tuple[int, int]:
        """First column of those given, and the one after the last, where pieces of them may lie too."""
        first, end = columns
        return max(first - self.margin, 0), min(end + self.margin, self._executor.grid.ny)

    def at_beginning(self, program: Program) -> AbstractContextManager[None]:
        """Enclose what is done once in a step: a program may go on in the midst of its pieces."""
        return program.branch(self._release.begins)

    def at_end(self, program: Program) -> AbstractContextManager[None]:
        """Enclose what follows when all pieces of a step have left."""
        return program.branch(self._release.ends)

    def before_search(self, program: Program, place: Place) -> None:
        """Add the beginning of a step: what waits since the last one is looked at."""
        for body in self.both:
            program.launch(kernels.list_waiting, body.body, **self._alone)

    def before_wear(self, program: Program, place: Place) -> None:
        """Add that the wear by a stored pressure, or by that of the tiles listed, becomes pending."""
        if place.pressed is not None:
            pressure = place.pressed.pressure
            program.launch(kernels.take_field, place.slides, self._both, pressure, **self._alone)
            return
        contact = *place.listed, place.slides, place.springs, self._both, place.cells, place.bodies.gap
        program.launch(kernels.take_tiles, *contact, **self._alone)

    def between(self, program: Program, place: Place) -> None:
        """Add that the pieces of a step leave; the loop over steps ends where their table is full."""
        for number, body in enumerate(self.both):
            line = place.steps.history, self.first_column + number * len(OF_BODY)
            body.add_shed(program, place.slides, self._release, line)
        goes = place.steps.stepping
        program.decide(shedding.end_step, self.counter.body, self.disc.body, self._release, goes)

    def end_steps(self, count: int) -> None:
        """Enter into the book that a program has made so many steps."""
        self.book.end_steps(count)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter what has left each body, what is worn of it and pending."""
        for body in BODIES:
            pieces, wear, pending, most[f"wear_{body}"] = (columns[f"{name}_{body}"] for name in OF_BODY)
            whole = self._track_fraction if body == "disc" else 1.0
            total |= {f"pieces_{body}": pieces / whole, f"wear_{body}": wear}
            total[f"pending_volume_{body}"] = pending

    def drain(self) -> bool:
        """Enter the pieces that have left into the book; tell whether the program is to go on in its step."""
        count = self._release.count.numpy()
        if count[0]:
            rows_of_pieces = self._release.pieces.numpy()[: count[0]]
            step, body, turn, peak, middle, volume, cells = rows_of_pieces.T
            order = np.lexsort((peak, turn, body, step))  # the order of a list is no matter
            area = self._executor.grid.cell_area
            row, column = np.divmod(middle[order].astype(np.int64), self._executor.vectors * LANES)
            diameter = 2.0 * np.sqrt(cells[order] * (area / math.pi))
            self.book.enter(step[order], body[order], (row, column), volume[order] * area, diameter)
            self._release.count.zero_()
        goes_on = bool(self._release.full.numpy()[0])
        if goes_on:
            self._release.full.zero_()
        return goes_on

    @property
    def _alone(self) -> dict[str, Any]:
        """Slots of passes that write lists: on a CPU one thread does them."""
        slots = self._executor.slots_of(self._executor.grid.nx)
        return {"slots": slots, "chunks": [(0, slots)]}
