"""Wear in pieces: against a plain serial reference, Archard's law and itself resumed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.laws.archard import WearLaw
from warpwear.laws.pieces import Pieces
from warpwear.laws.task import ContactTask
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.pieces import SlidingPieces

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
        self.footprint = [
            (i, j)
            for i in range(-reach, reach + 1)
            for j in range(-reach, reach + 1)
            if np.hypot(i, j) < half * (1.0 - 1e-9)
        ]
        self.piece = CELL**2 * sum(self.bowl(i, j) for i, j in self.footprint)  # V*
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
        cells = ((self.inside(row + i, column + j), self.bowl(i, j)) for i, j in self.footprint)
        return [(cell, bowl) for cell, bowl in cells if cell is not None]

    def square(self, row: int, column: int, half: int) -> list[tuple[int, int]]:
        span = range(-half, half + 1)
        cells = (self.inside(row + i, column + j) for i in span for j in span)
        return [cell for cell in cells if cell is not None]

    def shed(self) -> None:
        """In rounds until no piece is due, 60 at most."""
        columns = self.z.shape[1]
        for _ in range(60):
            sums = CELL**2 * self.sums()
            peaks = [
                (i, j)
                for i, j in np.argwhere(sums >= self.piece)
                if (sums[i, j], i * columns + j)
                == max((sums[c], c[0] * columns + c[1]) for c in self.square(i, j, self.apart))
            ]
            for i, j in peaks:
                self.cut(*max(self.square(i, j, self.beside), key=lambda c: (self.pending[c], c)))
            if not peaks:
                return

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


def bodies_of(executor: Executor, disc: FloatArray, pieces: Pieces) -> SlidingBodies:
    wears = WearLaw(9.4e-7), WearLaw(12.7e-7)
    task = ContactTask(load=1.0, hardness=600.0, curvature=1 / 3.0, wear=wears, compliance=0.0, pieces=pieces)
    return SlidingBodies.of(task, executor, disc)


def pressure_of(step: int) -> FloatArray:
    """Spots at the hardness, other ones each step, in the middle and over the edges of rows and columns."""
    rng = np.random.default_rng(step)
    smooth = rng.normal(size=GRID.shape)
    for axis in (0, 1):
        smooth = sum(np.roll(smooth, n, axis) for n in (-1, 0, 1))
    return np.where(smooth > 2.0, 600.0, 0.0) * (0.5 + 0.5 * rng.random(GRID.shape))


@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "with ends"])
@pytest.mark.parametrize("pieces", PIECES.values(), ids=PIECES)
def test_the_same_pieces_as_by_a_serial_reference(
    device: str, threads: int, pieces: Pieces, periodic: bool
) -> None:
    rows = 53
    disc = np.random.default_rng(1).normal(0.0, 2e-4, (rows, GRID.ny))
    removals, fraction = (9.4e-7 * 0.8, 12.7e-7 * 1.1), 0.5
    with Executor(GRID, device=device, threads=threads) as executor:
        bodies = bodies_of(executor, disc, pieces)
        shed = SlidingPieces(pieces, executor, bodies, periodic=periodic, track_fraction=fraction)
        z = executor.to_numpy(bodies.sphere)
        references = (
            Reference(z, pieces, periodic=False),
            Reference(-disc, pieces, periodic=periodic),
        )
        begun = [reference.z.copy() for reference in references]
        for step in range(6):
            shift, p = (7 * step) % rows if periodic else 2 * step, pressure_of(step)
            shed.begin()
            shed.take(executor.field(p), shift, removals)
            share = 1.0 - pieces.dust
            references[0].pending += share * removals[0] * p
            under = (np.arange(GRID.nx) + shift) % rows
            references[1].pending[under] += share * fraction * removals[1] * p
            for reference in references:
                reference.shed()
            total, most = shed.shed(shift, {}, {})
            for name, reference, before in zip(("sphere", "disc"), references, begun, strict=True):
                worn = (reference.z - before).sum()
                assert_allclose(total[f"wear_{name}"], worn, rtol=1e-12)
                assert_allclose(total[f"pending_{name}"], reference.pending.sum(), rtol=1e-12)
                assert_allclose(most[f"wear_{name}"], (reference.z - before).max(), rtol=1e-12)
        depth, height = executor.to_numpy(bodies.sphere), executor.to_numpy(bodies.disc)
        pending = [executor.to_numpy(body.pending) for body in shed.both]
    table = shed.book.table
    for number, (reference, values) in enumerate(zip(references, (depth, -height), strict=True)):
        there = reference.z < 0.5 * PADDING
        assert_allclose(values[there], reference.z[there], rtol=0.0, atol=1e-15)
        assert_allclose(pending[number], reference.pending, rtol=0.0, atol=1e-15)
        mine = table[table[:, 1] == number]
        assert len(mine) == len(reference.left) > 10
        assert_array_equal(mine[:, 2:4], [piece[:2] for piece in reference.left])
        assert_allclose(mine[:, 4], [piece[2] for piece in reference.left], rtol=1e-9)
