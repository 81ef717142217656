"""What breaks out and when: passes over cells against a plain serial reference of the same rules."""

from functools import cache

import numpy as np
import pytest
import warp as wp
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid, IntArray
from warpwear.kernels.cells import PADDING
from warpwear.kernels.sliding import Slide
from warpwear.kernels.sliding_steps import SlidingSteps
from warpwear.kernels.wear_from_pressure import Pressed
from warpwear.laws.archard import WearLaw
from warpwear.laws.form import Ball
from warpwear.laws.pieces import Pieces
from warpwear.laws.task import ContactTask
from warpwear.models.features import particles
from warpwear.models.features.feature import Place, Site
from warpwear.models.features.particles import OF_BODY, SlidingParticles
from warpwear.models.track.bodies import SlidingBodies

CELL = 0.005


GRID = Grid(40, 37, CELL)


PIECES = {
    "20 um": Pieces(0.020, 0.0006),
    "33 um": Pieces(0.033, 0.001),
    "one cell": Pieces(CELL, 0.0002),
    "dusty": Pieces(0.020, 0.0006, dust=0.3),
}


class Reference:
    """One body as the algorithm is written down, cell by cell: depth z, pending π [mm], both of this body."""

    def __init__(self, z: FloatArray, pieces: Pieces, *, periodic: bool) -> None:
        self.z, self.pending, self.periodic = z.copy(), np.zeros_like(z), periodic
        self.d, self.t = pieces.diameter, pieces.thickness
        half = 0.5 * self.d / CELL
        reach = int(np.ceil(half))
        self.footprint = {
            (i, j): self.bowl(i, j)
            for i in range(-reach, reach + 1)
            for j in range(-reach, reach + 1)
            if np.hypot(i, j) < half * (1.0 - 1e-9)
        }
        self.piece = CELL**2 * sum(self.footprint.values())  # V*
        self.beside, self.apart = int(half + 1 + 1e-9), int(2.0 * self.d / CELL + 2 + 1e-9)
        self.left: list[tuple[int, int, float]] = []  # row, column, volume of each piece

    def bowl(self, i: int, j: int) -> float:
        return self.t * (1.0 - (2.0 * np.hypot(i, j) * CELL / self.d) ** 2)

    def inside(self, row: int, column: int) -> tuple[int, int] | None:
        rows, columns = self.z.shape
        if self.periodic:
            row %= rows
        return (row, column) if 0 <= row < rows and 0 <= column < columns else None

    def around(self, row: int, column: int) -> list[tuple[tuple[int, int], float]]:
        """Cells of the footprint that there are, each with the depth of the bowl."""
        cells = ((self.inside(row + i, column + j), bowl) for (i, j), bowl in self.footprint.items())
        return [(cell, bowl) for cell, bowl in cells if cell is not None]

    def square(self, row: int, column: int, half: int) -> list[tuple[int, int]]:
        span = range(-half, half + 1)
        cells = (self.inside(row + i, column + j) for i in span for j in span)
        return [cell for cell in cells if cell is not None]

    def shed(self) -> None:
        """In rounds until no piece is due, 60 at most."""
        for _ in range(60):
            sums = CELL**2 * self.sums()
            due = np.argwhere(sums >= self.piece)
            peaks = [cell for number, cell in enumerate(due) if self.is_peak(number, due, sums[tuple(due.T)])]
            for i, j in peaks:
                self.cut(*max(self.square(i, j, self.beside), key=lambda c: (self.pending[c], c)))
            if not peaks:
                return

    def is_peak(self, number: int, due: IntArray, sums: FloatArray) -> bool:
        """Whether no cell that is due in the square about one has a larger sum, nor as large a one later."""
        away = np.abs(due - due[number])
        if self.periodic:
            away[:, 0] = np.minimum(away[:, 0], len(self.z) - away[:, 0])
        later = np.arange(len(due)) > number
        larger = (sums > sums[number]) | ((sums == sums[number]) & later)
        return not ((away <= self.apart).all(axis=1) & larger).any()

    def sums(self) -> FloatArray:
        reach, (rows, columns) = max(i for i, _ in self.footprint), self.z.shape
        along = {"mode": "wrap"} if self.periodic else {"mode": "constant"}
        wide = np.pad(np.pad(self.pending, ((reach, reach), (0, 0)), **along), ((0, 0), (reach, reach)))
        found = np.zeros_like(self.z)
        for i, j in self.footprint:
            found += wide[reach + i : reach + i + rows, reach + j : reach + j + columns]
        return found

    def cut(self, row: int, column: int) -> None:
        cells = self.around(row, column)
        held = CELL**2 * sum(self.pending[c] for c, _ in cells)
        volume = min(self.piece, held)
        lowest = sorted(self.z[c] - bowl for c, bowl in cells)
        for n in range(1, len(lowest) + 1):
            level = (volume / CELL**2 + sum(lowest[:n])) / n
            if n == len(lowest) or level <= lowest[n]:
                break
        for c, bowl in cells:
            self.z[c] = max(self.z[c], level + bowl)
            self.pending[c] *= 1.0 - volume / held
        self.left.append((row, column, volume))


def task_of(pieces: Pieces) -> ContactTask:
    wears = WearLaw(9.4e-7), WearLaw(12.7e-7)
    return ContactTask(
        load=1.0, hardness=600.0, form=Ball(1 / 3.0, 1 / 3.0), wear=wears, compliance=0.0, pieces=pieces
    )


def bodies_of(executor: Executor, disc: FloatArray, pieces: Pieces) -> SlidingBodies:
    return SlidingBodies.of(task_of(pieces), executor, disc)


def pressure_of(step: int) -> FloatArray:
    """Spots at the hardness, other ones each step, in the middle and over the edges of rows and columns."""
    rng = np.random.default_rng(step)
    smooth = rng.normal(size=GRID.shape)
    for axis in (0, 1):
        smooth = sum(np.roll(smooth, n, axis) for n in (-1, 0, 1))
    return np.where(smooth > 2.0, 600.0, 0.0) * (0.5 + 0.5 * rng.random(GRID.shape))


ROWS, FRACTION, REMOVALS = 53, 0.5, (9.4e-7 * 0.8, 12.7e-7 * 1.1)


DISC = np.random.default_rng(1).normal(0.0, 2e-4, (ROWS, GRID.ny))


def shifts_of(pieces: Pieces, *, periodic: bool) -> list[int]:
    """Rows of the track under the counter-body's first, step by step."""
    steps = range(2 if pieces.diameter == CELL else 6)
    return [(7 * step) % ROWS if periodic else 2 * step for step in steps]


@cache
def expected_of(
    name: str, counter: bytes, *, periodic: bool
) -> tuple[tuple[Reference, Reference], list[tuple[float, float, float]]]:
    """Both references after the last step; worn, pending and deepest of each after every step. It is slow."""
    pieces, z = PIECES[name], np.frombuffer(counter).reshape(GRID.shape)
    references = Reference(z, pieces, periodic=False), Reference(-DISC, pieces, periodic=periodic)
    begun, sums = [reference.z.copy() for reference in references], []
    for step, shift in enumerate(shifts_of(pieces, periodic=periodic)):
        p, share = pressure_of(step), 1.0 - pieces.dust
        references[0].pending += share * REMOVALS[0] * p
        references[1].pending[(np.arange(GRID.nx) + shift) % ROWS] += share * FRACTION * REMOVALS[1] * p
        for reference, before in zip(references, begun, strict=True):
            reference.shed()
            worn = reference.z - before
            sums.append((worn.sum(), reference.pending.sum(), worn.max()))
    return references, sums


class Shedding:
    """Steps of two bodies, each by a pressure of its own, as a program."""

    def __init__(self, executor: Executor, pieces: Pieces, *, periodic: bool) -> None:
        self.bodies = bodies_of(executor, DISC, pieces)
        self.pieces = SlidingParticles(
            pieces, Site(task_of(pieces), executor, self.bodies.fields, periodic=periodic)
        )
        self.share, self._executor, self._pressure = 1.0 - pieces.dust, executor, executor.zeros()
        self._slides = Numbers(Slide, executor.device, rows=GRID.nx)
        goes = wp.zeros(1, dtype=wp.int32, device=executor.device)
        self._rows = wp.zeros((1, 2 * len(OF_BODY)), dtype=wp.float64, device=executor.device)
        self._program = Program(executor)
        with self.pieces.at_beginning(self._program):
            self.pieces.before_search(self._program, Place(self._slides.array))
            self.pieces.before_wear(
                self._program, Place(self._slides.array, pressed=arguments(Pressed, pressure=self._pressure))
            )
        steps = arguments(SlidingSteps, stepping=goes, history=self._rows)
        self.pieces.between(self._program, Place(self._slides.array, steps))

    def step(self, number: int, shift: int) -> list[list[float]]:
        """Numbers of `OF_BODY` of both bodies after a step."""
        counter, disc = self.share * REMOVALS[0], self.share * FRACTION * REMOVALS[1]
        self._slides.set(shift=shift, pending_counter=counter, pending_disc=disc)
        self._executor.fill(self._pressure, pressure_of(number))
        self._program.run()
        while self.pieces.drain():
            self._program.run()
        self.pieces.book.end_steps()
        return self._rows.numpy().reshape(2, -1).tolist()  # type: ignore[no-any-return]


@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "with ends"])
@pytest.mark.parametrize("name", PIECES)
def test_the_same_pieces_as_by_a_serial_reference(
    device: str, threads: int, name: str, periodic: bool
) -> None:
    pieces = PIECES[name]
    with Executor(GRID, device=device, threads=threads) as executor:
        shed = Shedding(executor, pieces, periodic=periodic)
        bodies = shed.bodies
        counter = executor.to_numpy(bodies.counter).tobytes()
        references, sums = expected_of(name, counter, periodic=periodic)
        expected = iter(sums)
        for step, shift in enumerate(shifts_of(pieces, periodic=periodic)):
            for _, *found in shed.step(step, shift):
                assert_allclose(found, next(expected), rtol=1e-12)
        depth, height = executor.to_numpy(bodies.counter), executor.to_numpy(bodies.disc)
        pending = [executor.to_numpy(body.pending) for body in shed.pieces.both]
    table = shed.pieces.book.table
    for number, (reference, values) in enumerate(zip(references, (depth, -height), strict=True)):
        there = reference.z < 0.5 * PADDING
        assert_allclose(values[there], reference.z[there], rtol=0.0, atol=1e-15)
        assert_allclose(pending[number], reference.pending, rtol=0.0, atol=1e-15)
        mine = table[table[:, 1] == number]
        assert len(mine) == len(reference.left) > 10
        assert_array_equal(mine[:, 2:4], [piece[:2] for piece in reference.left])
        assert_allclose(mine[:, 4], [piece[2] for piece in reference.left], rtol=1e-9)


def test_pieces_do_not_depend_on_how_many_a_table_holds(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is full in the midst of a step, the host empties it and the program goes on."""
    tables = []
    for room in (particles.ROOM, 0):  # of a round at least
        monkeypatch.setattr(particles, "ROOM", room)
        with Executor(GRID, device=device) as executor:
            shed = Shedding(executor, PIECES["20 um"], periodic=True)
            rows = [shed.step(step, 7 * step) for step in range(4)]
        tables.append((shed.pieces.book.table, rows))
    assert len(tables[0][0]) > 10
    assert_array_equal(tables[1][0], tables[0][0])
    assert tables[1][1] == tables[0][1]
