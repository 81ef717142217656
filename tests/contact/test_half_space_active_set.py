"""The few open cells of a contact at its hardness, moved at once."""

import math

import numpy as np
import pytest
import warp as wp
from cases_half_space import MODULUS, rough
from numpy.testing import assert_allclose

from warpwear.contact.half_space.search import room_for_few
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid, IntArray
from warpwear.kernels.half_space.solve import ActiveSet, SearchRules
from warpwear.kernels.native_code import options

GRID = Grid(60, 53, 0.5)


wp.set_module_options(options("half_space/active_set.h"))


@wp.func_native("return best_of_few(few, count);")
def _best_of_few(few: ActiveSet, count: wp.int32) -> wp.bool: ...


@wp.kernel
def solve_few(few: ActiveSet, count: wp.int32, solved_out: wp.array(dtype=wp.int32)):  # type: ignore[valid-type]
    """Find the best changes of some cells' pressures alone; tell whether there are such."""
    solved_out[0] = wp.where(_best_of_few(few, count), 1, 0)


def best_of_few(
    elastic: FloatArray,
    along: FloatArray,
    rows: IntArray,
    columns: IntArray,
    slope: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray | None:
    """Changes of the pressures of cells, as the kernel makes them; distances do not wrap."""
    tables = (wp.array(values, dtype=wp.float64, device="cpu") for values in (elastic, along))
    room = room_for_few(len(rows), "cpu", (10**6, 10**6), *tables)
    count = wp.zeros(1, dtype=wp.int32, device="cpu")
    for name, values in {"row": rows, "column": columns, "slope": slope, "low": low, "high": high}.items():
        getattr(room, name).numpy()[:] = values
    wp.launch(solve_few, dim=1, inputs=[room, len(rows), count], device="cpu")
    return room.change.numpy() if count.numpy()[0] else None


def test_what_is_best_for_few_cells_meets_the_conditions_of_an_optimum() -> None:
    """At a bound a cell would go beyond it; between the bounds all are drawn alike; the sum stays."""
    rng = np.random.default_rng(5)
    for size in (3, 5, 40):
        distance = np.hypot(*np.meshgrid(np.arange(40), np.arange(40), indexing="ij"))
        elastic, along = 1.0 / (1.0 + distance), np.where(np.arange(40) == 0, 0.3, 0.0)
        rows, columns = np.divmod(rng.choice(400, size, replace=False), 20)
        apart = np.abs(rows[:, None] - rows), np.abs(columns[:, None] - columns)
        matrix = elastic[apart] + 0.3 * np.eye(size)
        slope = 0.6 * rng.normal(size=size)
        low, high = -rng.random(size), rng.random(size)
        x = best_of_few(elastic, along, rows, columns, slope, low, high)
        assert x is not None
        assert x.sum() == pytest.approx(0.0, abs=1e-13)
        x = np.clip(x, low, high)  # at the bounds but for rounding
        pull = matrix @ x + slope
        inside = (x > low) & (x < high)
        level = pull[inside].mean()
        assert_allclose(pull[inside], level, atol=1e-10)
        assert (pull[x == low] >= level - 1e-10).all()
        assert (pull[x == high] <= level + 1e-10).all()
    elastic, along, two = np.eye(2), np.zeros(2), np.arange(2)
    assert (
        best_of_few(elastic, along, two, 0 * two, np.array([1.0, -1.0]), np.full(2, -0.1), np.full(2, 0.1))
        is None
    )


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("streak", [0.0, 0.02])
@pytest.mark.parametrize("parted", [False, True])
def test_few_moves_reach_the_pressure_of_many_steps(boundary: str, streak: float, parted: bool) -> None:
    found = []
    with Executor(GRID) as executor:
        gap = executor.field(rough(GRID))
        parts = np.where(np.random.default_rng(1).random(GRID.shape) < 0.5, 0.8, 1.0)
        for most in (256, 0):
            solver = HalfSpace(
                executor,
                modulus=MODULUS,
                boundary=boundary,
                hardness=0.1,
                tolerance=1e-10,
                rules=SearchRules(few=most),
            )
            contact = solver.solve(
                gap,
                mean_pressure=0.025,
                compliance=0.01,
                streak_compliance=streak,
                streak_window=4,
                cap_ratio=executor.field(parts) if parted else None,
            )
            found.append((contact, contact.pressure.copy()))
    (few, pressure), (many, of_many) = found
    assert few.violation <= 1e-10 >= many.violation
    assert math.isclose(few.approach, many.approach, rel_tol=1e-9)
    assert_allclose(pressure, of_many, atol=1e-9)
    assert few.cells_in_contact == many.cells_in_contact
    assert few.transforms <= 3 < 9 < many.transforms
