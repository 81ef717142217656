"""Operators of half-spaces against dense matrices: response, inverse, displacement of all cells by some."""

import numpy as np
import pytest
from cases_half_space import MODULUS, dense_free, dense_of, dense_periodic
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.contact.half_space.influence import Influence, apart_shape, displacing
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid
from warpwear.laws.patches import Patches
from warpwear.models.patches.half_space import PatchInfluence

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


def pressed(grid: Grid, box: tuple[int, int, int, int]) -> FloatArray:
    """A pressure in a box of first and last row, first and last column."""
    pressure = np.zeros(grid.shape)
    inside = pressure[box[0] : box[1] + 1, box[2] : box[3] + 1]
    inside[:] = np.random.default_rng(4).random(inside.shape)
    return pressure


BOXES = [(0, 0, 0, 0), (8, 8, 10, 10), (3, 5, 0, 4), (0, 8, 0, 10), (2, 8, 6, 9), (4, 4, 5, 5)]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("shape", [(9, 11), (9, 48)])
def test_a_displacement_is_that_of_the_dense_matrix(
    box: tuple[int, int, int, int], shape: tuple[int, int], device: str, threads: int
) -> None:
    """Wherever the pressure lies: at an edge, in a corner, in the middle, on one cell, on all."""
    grid = Grid(*shape, 0.5)
    pressure = pressed(grid, box)
    expected = (dense_free(grid) @ pressure.ravel()).reshape(shape)
    with Executor(grid, device=device, threads=threads) as executor:
        found = executor.zeros()
        pressed_field, shape = executor.field(pressure), apart_shape(grid, box)
        displacing(executor, pressed_field, found, modulus=MODULUS, shape=shape).run()
        assert_allclose(executor.to_numpy(found), expected, rtol=0.0, atol=1e-13 * expected.max())


def test_a_displacement_is_that_of_all_cells_together() -> None:
    """To rounding, on a grid of many blocks, with less padding than as many cells again."""
    grid, box = Grid(220, 300, 0.5), (60, 150, 40, 201)
    with Executor(grid) as executor:
        pressure = executor.field(pressed(grid, box))
        expected, found = executor.zeros(), executor.zeros()
        Influence(executor, modulus=MODULUS, boundary="free").respond(pressure, expected)
        displacing(executor, pressure, found, modulus=MODULUS, shape=apart_shape(grid, box)).run()
        expected, found = executor.to_numpy(expected), executor.to_numpy(found)
        assert_allclose(found, expected, rtol=0.0, atol=1e-14 * expected.max())
        assert apart_shape(grid, box) == (320, 540)


def mean_along(rows: int, window: int | None, *, wraps: bool) -> FloatArray:
    """The matrix S S of a column of cells."""
    if window is None or window >= rows:
        return np.full((rows, rows), 1.0 / rows)
    # As long as nothing comes round the other side.
    size = rows if wraps else 4 * rows
    away = np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
    away = np.minimum(away, size - away)
    mean = np.where(2 * away < window, 1.0, np.where(2 * away == window, 0.5, 0.0)) / window
    return np.asarray((mean @ mean)[:rows, :rows])


GRIDS = [(12, 16), (9, 10), (9, 11), (14, 12), (16, 3), (17, 2), (12, 1)]


@pytest.mark.parametrize(("own", "streak", "window"), [(0.3, 0.0, None), (0.2, 0.7, None), (0.0, 0.7, 4)])
@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("shape", GRIDS)
def test_a_response_is_that_of_the_dense_matrix(
    shape: tuple[int, int], boundary: str, own: float, streak: float, window: int | None, device: str
) -> None:
    """With compliances as they are set when a program runs, in double and single precision; and in place."""
    grid, wraps = Grid(*shape, 0.5), boundary == "periodic"
    tolerance = 1e-12 if boundary == "line" else 1e-13  # rounding of a sum over thousands of images
    elastic = dense_of(grid, boundary)
    along = mean_along(grid.nx, window, wraps=wraps)
    matrix = elastic + own * np.eye(grid.cells) + streak * np.kron(along, np.eye(grid.ny))
    pressure = np.random.default_rng(4).random(shape)
    with Executor(grid, device=device) as executor:
        operator = Influence(executor, modulus=MODULUS, boundary=boundary)
        field, out, rough = executor.field(pressure.copy()), executor.zeros(), executor.zeros()
        program = Program(executor)
        operator.add_response(program, field, rough, single=True)
        operator.add_response(program, field, out)
        operator.add_response(program, field, field)
        for compliance in ((0.0, 0.0, None), (own, streak, window)):
            executor.fill(field, pressure)
            operator.set_compliance(*compliance)
            program.run()
            used = matrix if compliance[0] or compliance[1] else elastic
            expected = (used @ pressure.ravel()).reshape(shape)
            scale = np.abs(expected).max()
            assert_allclose(executor.to_numpy(out), expected, rtol=0.0, atol=tolerance * scale)
            assert_allclose(executor.to_numpy(rough), expected, rtol=0.0, atol=1e-6 * scale)
            assert_array_equal(executor.to_numpy(field), executor.to_numpy(out))
        operator.respond(out, field)
        expected = (matrix @ executor.to_numpy(out).ravel()).reshape(shape)
        assert_allclose(executor.to_numpy(field), expected, rtol=0.0, atol=tolerance * np.abs(expected).max())
        # Of each cell on each, by their distance, the other way round where the surface repeats.
        places = np.indices(shape).reshape(2, -1)
        away = [np.abs(np.subtract.outer(place, place)) for place in places]
        away_x, away_y = (np.minimum(d, size - d) for d, size in zip(away, operator.far_shape, strict=True))
        table, of_column = (array.numpy() for array in operator.coefficients())
        coefficients = table[away_x, away_y] + np.where(away_y == 0, of_column[away_x], 0.0)
        assert_allclose(coefficients, matrix, rtol=0.0, atol=tolerance * matrix.max())


@pytest.mark.parametrize("compliance", [(0.0, 0.0, None), (0.3, 0.0, None), (0.2, 0.7, 5)])
@pytest.mark.parametrize("shape", GRIDS)
def test_the_inverse_undoes_the_response(
    shape: tuple[int, int], compliance: tuple[float, float, int | None], threads: int, device: str
) -> None:
    """Of all waves of a surface that repeats; without compliances the mean is lost."""
    grid, pressure = Grid(*shape, 0.5), np.random.default_rng(4).random(shape)
    with Executor(grid, device=device, threads=threads) as executor:
        operator = Influence(executor, modulus=MODULUS, boundary="periodic")
        operator.set_compliance(*compliance)
        field, program = executor.field(pressure.copy()), Program(executor)
        operator.add_response(program, field, field)
        operator.add_inverse(program, field, field)
        program.run()
        expected = pressure if any(compliance[:2]) else pressure - pressure.mean()
        assert_allclose(executor.to_numpy(field), expected, rtol=0.0, atol=3e-6)


@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("shape", [(48, 40), (21, 33), (40, 2), (40, 1)])
def test_threads_change_no_operator(shape: tuple[int, int], boundary: str, two_threads: int) -> None:
    """To the last bit."""
    grid, results = Grid(*shape, 0.5), []
    for count in (1, two_threads):
        with Executor(grid, threads=count) as executor:
            operator = Influence(executor, modulus=MODULUS, boundary=boundary)
            operator.set_compliance(0.1, 0.2, 6)
            field = executor.field(np.random.default_rng(4).random(shape))
            outs = [executor.zeros() for _ in range(3)]
            program = Program(executor)
            operator.add_response(program, field, outs[0])
            operator.add_response(program, field, outs[1], single=True)
            operator.add_inverse(program, field, outs[2])
            program.run()
            results.append([np.array(executor.to_numpy(out)) for out in outs])
    for one, other in zip(*results, strict=True):
        assert_array_equal(one, other)


def test_neighbours_are_weighted_by_the_compliance() -> None:
    """In the array that programs read, in place."""
    with Executor(Grid(64, 48, 0.5)) as executor:
        operator = Influence(executor, modulus=MODULUS, boundary="periodic")
        array, before = operator.neighbours, operator.neighbours.numpy().copy()
        operator.set_compliance(0.5, 0.3, 4)
        other = Influence(executor, modulus=MODULUS, boundary="periodic")
        other.set_compliance(0.5, 0.3, 4)
        assert operator.neighbours is array
        assert_array_equal(array.numpy(), other.neighbours.numpy())
        assert (np.abs(array.numpy() - before) > 1e-3).all()


@pytest.mark.parametrize("visited", [1, 3, 4])
@pytest.mark.parametrize(
    ("boundary", "own", "bulk"),
    [("periodic", 0.2, 0.7), ("periodic", 0.0, 0.7), ("periodic", 0.0, 0.0), ("free", 0.2, 0.0)],
)
@pytest.mark.parametrize("side", [5, 10])
def test_patches_are_grids_of_their_own(
    side: int, boundary: str, own: float, bulk: float, visited: int, threads: int, device: str
) -> None:
    """A bulk behind each adds to its mean; those that are not visited stay as they are."""
    one, count = Grid(side, side, 0.5), 4
    corners = [side * c.ravel().astype(np.int32) for c in np.indices((2, 2))]
    patches = Patches(Grid(2 * side, 2 * side, 0.5), side, side, *corners)
    matrix = dense_periodic(one) if boundary == "periodic" else dense_free(one)
    matrix = matrix + own * np.eye(one.cells) + bulk / one.cells
    pressure = np.random.default_rng(4).random((count, side, side))
    stride = patches.grid.ny // side
    rows = np.zeros((count, side, stride))
    rows[:, :, :side] = pressure
    with Executor(patches.grid, device=device, threads=threads) as executor:
        operator = PatchInfluence(executor, patches, modulus=MODULUS, boundary=boundary)
        field, response = executor.field(rows.reshape(count, -1)), executor.zeros()
        inverse, program = executor.zeros(), Program(executor)
        operator.add_response(program, field, response)
        operator.add_inverse(program, response, inverse)
        program.run()
        for place in (response, inverse):
            executor.fill(place, np.full(patches.grid.shape, 9.0))
        operator.visit(visited)
        for trial in (0.5 if boundary == "periodic" else 0.0, bulk):
            operator.set_bulk(trial)
            operator.set_compliance(own, 0.0)
            program.run()
        made, back = (
            executor.to_numpy(place).reshape(count, side, stride)[:, :, :side]
            for place in (response, inverse)
        )
        expected = (pressure.reshape(count, -1) @ matrix).reshape(pressure.shape)
        assert_allclose(made[:visited], expected[:visited], rtol=0.0, atol=1e-14 * expected.max())
        assert (made[visited:] == 9.0).all()
        assert (back[visited:] == 9.0).all()
        if bulk:  # so that the mean is not lost
            assert_allclose(back[:visited], pressure[:visited], rtol=0.0, atol=3e-6)
