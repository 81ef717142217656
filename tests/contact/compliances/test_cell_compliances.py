"""Compliances of each cell in the half-space solver, against a dense solve and as a whole grid has them."""

import math
from typing import Any

import numpy as np
import pytest
from cases_half_space import MODULUS, bounded, dense_of, dense_streak, rough, separation_of

from warpwear.contact.half_space.solver import HalfSpace
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid

GRID = Grid(10, 7, 0.5)  # a width that is no multiple of the lanes of a vector


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("hardness", [math.inf, 1.5])
@pytest.mark.parametrize("scale", [0.1, 10.0])
def test_against_active_sets_on_the_dense_matrix(
    boundary: str, hardness: float, scale: float, device: str
) -> None:
    """Beside a mean along x; of half of the cells the compliance is none, of others up to `scale`."""
    gap = rough(GRID)
    own = np.maximum(np.random.default_rng(3).uniform(-scale, scale, GRID.shape), 0.0)
    matrix = dense_of(GRID, boundary) + np.diag(own.ravel()) + 0.2 * dense_streak(GRID, boundary, 3)
    uniform = 1.0 / GRID.cells
    expected = bounded(matrix + uniform, gap, 0.5, hardness)
    assert 0.1 < (expected > 0.0).mean() < 0.9
    with Executor(GRID, device=device) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, tolerance=1e-11, boundary=boundary, hardness=hardness)
        field, yields = executor.field(gap), executor.field(own)
        streak: dict[str, Any] = {"streak_compliance": 0.2, "streak_window": 3}
        contact = solver.solve(field, mean_pressure=expected.mean(), yields=yields, **streak)
        np.testing.assert_allclose(contact.pressure, expected, atol=1e-8 * expected.max())
        assert contact.certificate is not None
        separation = (matrix @ expected.ravel()).reshape(gap.shape) + gap
        np.testing.assert_allclose(
            separation_of(contact) + contact.approach, separation, atol=1e-8 * np.abs(separation).max()
        )
        solver.forget()
        plain = solver.solve(field, mean_pressure=expected.mean(), **streak)
        assert np.abs(plain.pressure - expected).max() > 0.01 * expected.max()  # without it another contact


BALL = Grid(256, 256, 0.0015)


def ring(grid: Grid, scale: float) -> tuple[FloatArray, FloatArray]:
    """Gap under a ball of 5 mm, and a compliance that is none in its middle and grows outwards [mm/MPa]."""
    squared = np.add.outer(grid.x**2, grid.y**2)
    return squared / 10.0, scale * np.maximum(squared - 0.05**2, 0.0)


@pytest.mark.parametrize(("scale", "most"), [(1e-5, 16), (1e-4, 30), (1e-3, 50)])
def test_a_window_and_wide_cells_change_nothing_and_few_iterations_do(
    scale: float, most: int, device: str
) -> None:
    gap, own = ring(BALL, scale)
    law: dict[str, Any] = {"modulus": 1.15e5, "boundary": "free"}
    with Executor(BALL, device=device) as executor:
        field, yields = executor.field(gap), executor.field(own)
        whole = HalfSpace(executor, tolerance=1e-9, **law)
        expected = whole.solve(field, mean_pressure=20.0 / BALL.area, yields=yields)
        quick = HalfSpace(executor, **law).solve(field, mean_pressure=20.0 / BALL.area, yields=yields)
        assert quick.iterations <= most
        windowed = WindowedHalfSpace(executor, tolerance=1e-9, **law)
        for _ in range(2):
            contact = windowed.solve(field, load=20.0, yields=yields)
            np.testing.assert_allclose(
                contact.pressure, expected.pressure, atol=1e-6 * expected.pressure.max()
            )
        assert contact.iterations <= 1
