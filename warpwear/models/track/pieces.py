"""Wear in pieces of a contact that slides: what is pending of its bodies, and the pieces that have left."""

import math
from collections.abc import Iterable
from typing import Any, ClassVar, Self

import numpy as np
import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments, set_numbers
from warpwear.engine.tiles import TileList
from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.kernels.cells import LANES
from warpwear.kernels.running_in import pieces as kernels
from warpwear.laws.pieces import ROUNDS
from warpwear.laws.pieces import Pieces as PieceLaw
from warpwear.laws.task import ContactTask
from warpwear.models.track.bodies import SlidingBodies

BODIES = ("sphere", "disc")


class Pending:
    """Depths pending of one body, where a piece is due, and the sums over its rows.

    fields: height and wear of the body. down: 1 where heights grow as it is worn, else −1.
    """

    STATE: ClassVar = {"pending": Field, "waiting": np.ndarray, "_rows": np.ndarray}

    def __init__(
        self,
        executor: Executor,
        law: PieceLaw,
        footprint: Arguments,
        fields: tuple[Field, Field],
        *,
        body: int,
        down: float,
        periodic: bool,
    ) -> None:
        (height, self._wear), grid, device = fields, executor.grid, executor.device
        rows, cell = height.shape[0], grid.cell
        self._executor, self._footprint = executor, footprint
        self.pending: Field = executor.field(law.start((rows, grid.ny), cell, body=body))
        #: Cells that are due since the rounds of a step were not enough, by index.
        self.waiting = np.zeros(0, dtype=np.int32)
        self._had_waited = False
        size = rows * executor.vectors * LANES
        #: Pieces of a round at most: no two within `apart` cells along both axes.
        self._most = (rows // (law.apart(cell) + 1) + 2) * (grid.ny // (law.apart(cell) + 1) + 2)
        self.body = arguments(
            kernels.Body,
            height=_numbers(height),
            wear=_numbers(self._wear),
            pending=_numbers(self.pending),
            sums=wp.zeros(size, dtype=wp.float64, device=device),
            listed=wp.zeros(size, dtype=wp.int32, device=device),
            peaks=wp.zeros(self._most, dtype=wp.int32, device=device),
            counts=wp.zeros(3, dtype=wp.int32, device=device),
            down=down,
            columns=grid.ny,
            periodic=int(periodic),
        )
        self._left = wp.zeros((2 * self._most, 4), dtype=wp.float64, device=device)
        #: Whether one thread makes all rounds, as a CPU does best.
        self.in_one_launch = bool(device.is_cpu)
        self._margin = law.margin(cell)
        self._table = wp.zeros((3, rows), dtype=wp.float64, device=device)
        #: Sums of wear and pending, and deepest wear, of each row [mm].
        self._rows = np.zeros((3, rows))
        self._sum_up(0, rows)
        self._start = float(self._rows[1].sum())

    def begin(self) -> None:
        """List what waits since the last step."""
        self.body.counts.zero_()
        self._had_waited = self.waiting.size > 0
        if self._had_waited:
            cells: Field = wp.array(self.waiting, dtype=wp.int32, device=self._executor.device)
            self._launch(kernels.take_cells, self.waiting.size, [cells])

    def shed(self) -> list[FloatArray]:
        """Let all pieces leave that are due; tables of peak, middle, volume and cells cut, by round."""
        listed = int(self.body.counts.numpy()[0])
        if not listed:
            return []
        rounds, found = self._in_one_launch() if self.in_one_launch else self._round_by_round(listed)
        self.waiting = self._due(listed) if rounds == ROUNDS else self.waiting[:0]
        self._launch(kernels.forget, listed, [])
        return found

    def _in_one_launch(self) -> tuple[int, list[FloatArray]]:
        """Make the rounds, in a launch as many as the table has room for; how many, and the pieces."""
        rounds, found = 0, list[FloatArray]()
        while rounds < ROUNDS:
            self._launch(kernels.shed, 1, [ROUNDS - rounds, int(not rounds), self._footprint], [self._left])
            _, pieces, made = self.body.counts.numpy().tolist()
            rounds += made
            if pieces:
                found.append(self._left.numpy()[:pieces].copy())
            if pieces + self._most <= self._left.shape[0]:  # there was room for more
                break
        self.body.counts[1:].zero_()
        return rounds, found

    def _round_by_round(self, listed: int) -> tuple[int, list[FloatArray]]:
        """Make the rounds with a thread a cell, and a peak; how many, and the pieces of each."""
        anew, found = 1, list[FloatArray]()
        for _ in range(ROUNDS):
            self._launch(kernels.sum_up, listed, [anew, self._footprint])
            self._launch(kernels.find_peaks, listed, [self._footprint])
            peaks, anew = int(self.body.counts.numpy()[1]), 0
            if not peaks:
                break
            self._launch(kernels.cut, peaks, [self._footprint], [self._left])
            self.body.counts[1:].zero_()
            left = self._left[:peaks].numpy()
            found.append(left[np.argsort(left[:, 0])])  # the order of the list is no matter
        return len(found), found

    def totals(self, first_row: int, rows: int) -> tuple[float, float, float]:
        """Sums of wear and of what is pending beyond the start, and the deepest wear [mm].

        first_row, rows: under the contact; in others nothing has changed, but where pieces had waited.
        """
        every = self.pending.shape[0]
        first, count = first_row - self._margin, rows + 2 * self._margin
        if self._had_waited:
            first, count = 0, every
        elif self.body.periodic == 0:
            count = min(first + count, every) - max(first, 0)
            first = max(first, 0)
        self._sum_up(first % every, min(count, every))
        worn, pending = self._rows[:2].sum(axis=1).tolist()
        return worn, pending - self._start, float(self._rows[2].max())

    def _sum_up(self, first: int, count: int) -> None:
        self._launch(kernels.total_rows, count, [first, self._wear, self.pending], [self._table], body=False)
        rows = (first + np.arange(count)) % self._rows.shape[1]
        self._rows[:, rows] = self._table.numpy()[:, rows]

    def _due(self, listed: int) -> "np.ndarray[Any, Any]":
        """Cells listed where pieces are still due."""
        self._launch(kernels.sum_up, listed, [0, self._footprint])
        cells = np.sort(self.body.listed.numpy()[:listed])
        return np.asarray(cells[self.body.sums.numpy()[cells] >= self._footprint.needed])

    def _launch(
        self, kernel: Any, count: int, inputs: list[Any], outputs: Iterable[Any] = (), *, body: bool = True
    ) -> None:
        """Launch a kernel, which is told of the body last of its inputs."""
        bodies = [self.body] if body else []
        # On a CPU by one thread: the others would write the same list.
        self._executor.launch(kernel, inputs=[*inputs, *bodies], outputs=list(outputs), chunks=[(0, count)])


class SlidingPieces:
    """Pieces of both bodies of a contact that slides or lies still.

    track_fraction: of the stroke, that the disc covers.
    """

    STATE: ClassVar = {"sphere": Pending, "disc": Pending, "book": PieceBook}

    def __init__(
        self,
        law: PieceLaw,
        executor: Executor,
        bodies: SlidingBodies,
        *,
        periodic: bool,
        track_fraction: float,
    ) -> None:
        cell, device = executor.grid.cell, executor.device
        executor.load(kernels.take_field)
        places, bowl = law.footprint(cell)
        self.law, self._executor, self._track_fraction = law, executor, track_fraction
        footprint = arguments(
            kernels.Footprint,
            along=wp.array(places[:, 0], dtype=wp.int32, device=device),
            across=wp.array(places[:, 1], dtype=wp.int32, device=device),
            bowl=wp.array(bowl, dtype=wp.float64, device=device),
            needed=float(bowl.sum()),
            reach=law.reach(cell),
            apart=law.apart(cell),
        )
        self._share = arguments(kernels.Share, footprint=footprint)
        #: Cells beside one in contact that a piece may reach.
        self._margin = law.margin(cell)
        of_sphere, of_disc = (bodies.sphere, bodies.wear_sphere), (bodies.disc, bodies.wear_disc)
        self.sphere = Pending(executor, law, footprint, of_sphere, body=0, down=1.0, periodic=False)
        self.disc = Pending(executor, law, footprint, of_disc, body=1, down=-1.0, periodic=periodic)
        self.book = PieceBook()

    @classmethod
    def of(
        cls,
        task: ContactTask,
        executor: Executor,
        bodies: SlidingBodies,
        *,
        periodic: bool,
        track_fraction: float,
    ) -> Self | None:
        """Those of a task; None where all wear leaves at once."""
        if task.pieces is None:
            return None
        return cls(task.pieces, executor, bodies, periodic=periodic, track_fraction=track_fraction)

    @property
    def both(self) -> tuple[Pending, Pending]:
        """What is pending of sphere and disc."""
        return self.sphere, self.disc

    def beside(self, columns: tuple[int, int]) -> tuple[int, int]:
        """First column of those given, and the one after the last, where pieces of them may lie too."""
        first, end = columns
        return max(first - self._margin, 0), min(end + self._margin, self._executor.grid.ny)

    def begin(self) -> None:
        """Begin a step."""
        for body in self.both:
            body.begin()

    def take(self, pressure: Field, shift: int, removals: tuple[float, float]) -> None:
        """Make the wear by a pressure field [MPa] pending. Others as of `take_tiles`."""
        inputs = [self._share_of(shift, removals), pressure]
        every = [(0, self._executor.slots)]
        self._executor.launch(
            kernels.take_field, inputs=inputs, outputs=[self.sphere.body, self.disc.body], chunks=every
        )

    def take_tiles(
        self,
        law: Arguments,
        stiffness: Field,
        gap: Field,
        tiles: TileList,
        shift: int,
        removals: tuple[float, float],
        parts: Field | None = None,
    ) -> None:
        """Make the wear of the tiles listed pending, at the approach and cap of a law.

        shift: the disc's row under the sphere's first. removals: K ΔL of sphere and disc [mm³/N].
        parts: of the cap, that cells bear; None: all of it.
        """
        if parts is not None:
            self._share.parts = parts
        inputs = [law, self._share_of(shift, removals), stiffness, gap]
        every = [(0, self._executor.slots)]
        outputs = [self.sphere.body, self.disc.body]
        self._executor.launch(kernels.take_tiles, inputs=inputs, outputs=outputs, over=tiles, chunks=every)

    def shed(
        self, shift: int, total: dict[str, float], most: dict[str, float]
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Let the pieces of a step leave; return its sums and maxima with what is worn and pending then.

        shift: the disc's row under the sphere's first.
        """
        grid = self._executor.grid
        area = grid.cell_area
        for number, (name, body, row) in enumerate(zip(BODIES, self.both, (0, shift), strict=True)):
            left = body.shed()
            worn, pending, deepest = body.totals(row, grid.nx)
            total |= {f"wear_{name}": worn, f"pending_{name}": pending}
            total[f"pieces_{name}"] = float(sum(map(len, left)))
            most[f"wear_{name}"] = deepest
            if left:
                _, middle, volume, cells = np.concatenate(left).T
                row_of, column = np.divmod(middle.astype(np.int64), self._executor.vectors * LANES)
                self.book.enter(
                    number, row_of, column, volume * area, 2.0 * np.sqrt(cells * (area / math.pi))
                )
        self.book.end_step()
        return total, most

    def _share_of(self, shift: int, removals: tuple[float, float]) -> Arguments:
        pending = 1.0 - self.law.dust
        sphere, disc = (pending * removals[0], pending * self._track_fraction * removals[1])
        set_numbers(self._share, sphere=sphere, disc=disc, shift=shift)
        return self._share


def _numbers(field: Field) -> Field:
    """A field as numbers, shape (rows, columns and padding), in the same memory."""
    shape = field.shape[0], field.shape[1] * LANES
    made: Field = wp.array(ptr=field.ptr, dtype=wp.float64, shape=shape, device=field.device, copy=False)
    made._owner = field  # which keeps the memory
    return made
