"""The few open cells of a contact at its hardness, moved at once."""

import math

import numpy as np
import pytest
from cases_half_space import MODULUS, rough
from numpy.testing import assert_allclose

from warpwear.contact.half_space import few as half_space_few
from warpwear.contact.half_space.few import best_of_few
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import Grid

GRID = Grid(60, 53, 0.5)


def test_what_is_best_for_few_cells_meets_the_conditions_of_an_optimum() -> None:
    """At a bound a cell would go beyond it; between the bounds all are drawn alike; the sum stays."""
    rng = np.random.default_rng(5)
    for size in (2, 5, 40):
        root = rng.normal(size=(size, size))
        matrix, slope = root @ root.T + 0.1 * np.eye(size), 3.0 * rng.normal(size=size)
        low, high = -rng.random(size), rng.random(size)
        x = best_of_few(matrix, slope, low, high)
        assert x is not None
        assert x.sum() == pytest.approx(0.0, abs=1e-13)
        assert ((x >= low) & (x <= high)).all()
        pull = matrix @ x + slope
        inside = (x > low) & (x < high)
        level = pull[inside].mean()
        assert_allclose(pull[inside], level, atol=1e-10)
        assert (pull[x == low] >= level - 1e-10).all()
        assert (pull[x == high] <= level + 1e-10).all()
    assert best_of_few(np.eye(2), np.array([1.0, -1.0]), np.full(2, -0.1), np.full(2, 0.1)) is None


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("streak", [0.0, 0.02])
@pytest.mark.parametrize("parted", [False, True])
def test_few_moves_reach_the_pressure_of_many_steps(
    boundary: str, streak: float, parted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    with Executor(GRID) as executor:
        gap = executor.field(rough(GRID))
        parts = np.where(np.random.default_rng(1).random(GRID.shape) < 0.5, 0.8, 1.0)
        for most in (half_space_few.FEW, 0):
            monkeypatch.setattr(half_space_few, "FEW", most)
            solver = HalfSpace(
                executor, modulus=MODULUS, boundary=boundary, hardness=0.1, tolerance=1e-10, on_device=False
            )
            contact = solver.solve(
                gap,
                mean_pressure=0.025,
                compliance=0.01,
                streak_compliance=streak,
                streak_window=4,
                parts=executor.field(parts) if parted else None,
            )
            found.append((contact, contact.pressure.copy()))
    (few, pressure), (many, of_many) = found
    assert few.violation <= 1e-10 >= many.violation
    assert math.isclose(few.approach, many.approach, rel_tol=1e-9)
    assert_allclose(pressure, of_many, atol=1e-9)
    assert few.cells_in_contact == many.cells_in_contact
    assert few.transforms <= 3 < 9 < many.transforms
