"""A contact solved on a part of its grid is that of the whole grid."""

import math
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cases_half_space import area_fraction_of, separation_of
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft

from warpwear.contact.half_space import window as half_space_window
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.contact.half_space.window import Window, WindowedHalfSpace
from warpwear.engine.executor import Executor
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

GRID = Grid(93, 101, 0.01)
MODULUS, LOAD = 1.0e5, 4.0


def ball(x: float = 0.0, y: float = 0.0, *, rough: float = 0.0, seed: int = 1) -> FloatArray:
    """Gap under a ball of 3 mm with its apex at a place [mm], on a disc of so much roughness [mm]."""
    squared = np.add.outer((GRID.x - x) ** 2, (GRID.y - y) ** 2)
    heights = np.random.default_rng(seed).normal(0.0, rough, GRID.shape)
    return np.asarray(squared / 6.0 + heights)


CASES: dict[str, tuple[FloatArray, dict[str, Any]]] = {
    "smooth": (ball(), {}),
    "rough": (ball(rough=1e-3), {}),
    "capped": (ball(rough=1e-3), {"hardness": 600.0}),
    "at a corner": (ball(0.3, -0.45, rough=3e-4), {"hardness": 2000.0}),
    "one cell far out": (np.where(np.indices(GRID.shape).sum(axis=0) == 20, -2e-3, ball()), {}),
    "all of it": (ball(rough=1e-3) * 1e-3, {}),
}

IMPLICIT = {"compliance": 3e-7, "streak_compliance": 3e-7, "streak_window": 17}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("implicit", [{}, IMPLICIT, {"streak_compliance": 3e-7}])
def test_a_window_changes_nothing(case: str, implicit: dict[str, Any], device: str) -> None:
    gap, law = CASES[case]
    with Executor(GRID, device=device) as executor:
        whole = HalfSpace(executor, modulus=MODULUS, boundary="free", tolerance=1e-10, **law)
        expected = whole.solve(executor.field(gap), mean_pressure=LOAD / GRID.area, **implicit)
        solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary="free", tolerance=1e-10, **law)
        for _ in range(3):  # the second and the third from the one before
            found = solver.solve(executor.field(gap), load=LOAD, **implicit)
            assert found.approach == pytest.approx(expected.approach, rel=1e-8)
            assert_allclose(found.pressure, expected.pressure, atol=1e-6 * expected.pressure.max())
            assert found.cells_in_contact == expected.cells_in_contact
            assert found.mean_pressure == pytest.approx(LOAD / GRID.area, rel=1e-12)
            assert area_fraction_of(found) == area_fraction_of(expected)
            there = np.isfinite(separation_of(found))
            assert_allclose(separation_of(found)[there], separation_of(expected)[there], atol=1e-9)
            assert not found.pressure[~there].any()
        assert (solver._window == Window(0, 93, 0, 13)) == (case == "all of it")


def test_a_contact_that_moves_is_followed(device: str) -> None:
    """From a window where it no longer is; the carried pressure lies beside it, in part."""
    with Executor(GRID, device=device) as executor:
        solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary="free", hardness=2000.0)
        whole = HalfSpace(executor, modulus=MODULUS, boundary="free", hardness=2000.0)
        windows = []
        for place in (-0.33, -0.3, 0.1, 0.4):
            gap = executor.field(ball(place, 0.5 * place, rough=2e-4))
            found = solver.solve(gap, load=LOAD)
            whole.forget()
            expected = whole.solve(gap, mean_pressure=LOAD / GRID.area)
            assert found.approach == pytest.approx(expected.approach, rel=1e-4)
            assert_allclose(found.pressure, expected.pressure, atol=2e-3 * expected.pressure.max())
            windows.append(solver._window)
        assert len({str(window) for window in windows}) == len(windows) - 1  # one served twice


def test_a_window_gives_way_to_a_smaller_one() -> None:
    with Executor(GRID) as executor:
        solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary="free")
        solver._look_at(Window(0, 93, 0, 13))
        gap = executor.field(ball())
        solver.solve(gap, load=LOAD)
        window = solver._window
        assert window is not None
        assert window.area < 0.25 * 93 * 13
        assert solver.solve(gap, load=LOAD).iterations <= 1


def test_a_window_goes_before_the_next_takes_its_memory(
    watch: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[weakref.ref[HalfSpace]] = []

    def note(solver: HalfSpace, *_: Any, **__: Any) -> None:
        assert all(other() is None for other in made)
        made.append(weakref.ref(solver))

    watch(HalfSpace, "__init__", note)
    monkeypatch.setattr(half_space_window, "MOST_CELLS_STORED", 0)
    with Executor(GRID) as executor:
        solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary="free")
        solver.solve(executor.field(ball()), load=LOAD)
        solver.solve(executor.field(CASES["all of it"][0]), load=LOAD)
        assert solver._window == Window(0, 93, 0, 13)
    assert len(made) >= 2


def pin(radius: float) -> FloatArray:
    """Gap under a pin of a radius [mm], beyond which there is no body; its first cell lies at its rim."""
    inside = np.hypot.outer(GRID.x, GRID.y) < radius
    return np.where(inside, np.random.default_rng(2).normal(0.0, 1e-4, GRID.shape), PADDING)


#: Gap; loads one after another, over what all cells that have a body carry at the hardness.
LOADS: dict[str, tuple[FloatArray, list[float]]] = {
    "ball": (ball(), [1e-9, 0.4, 1e-3, 0.2]),
    "rough": (ball(rough=1e-3), [1e-3, 0.3, 0.95]),
    "pin": (pin(0.2), [0.3, 0.9, 0.01, 0.9999]),
    "small pin": (pin(0.04), [0.5, 1.0]),
    "all of it": (ball() * 1e-3, [1e-6, 1.0]),
}


@pytest.mark.parametrize("boundary", ["free", "line", "periodic"])
@pytest.mark.parametrize("case", LOADS)
def test_a_window_carries_loads_that_grow(case: str, boundary: str, device: str) -> None:
    gap, parts = LOADS[case]
    most = 600.0 * np.count_nonzero(gap < PADDING) * GRID.cell_area
    law = {"modulus": MODULUS, "boundary": boundary, "hardness": 600.0, "tolerance": 1e-8}
    with Executor(GRID, device=device) as executor:
        field, solver, whole = (
            executor.field(gap),
            WindowedHalfSpace(executor, **law),
            HalfSpace(executor, **law),
        )
        for load in (part * most for part in parts):
            whole.forget()
            expected = whole.solve(field, mean_pressure=load / GRID.area)
            found = solver.solve(field, load=load)
            assert found.approach == pytest.approx(expected.approach, rel=1e-6)
            assert_allclose(found.pressure, expected.pressure, atol=1e-4 * expected.pressure.max())
            assert found.mean_pressure == pytest.approx(load / GRID.area, rel=2e-12)


@pytest.mark.parametrize("boundary", ["free", "line", "periodic"])
def test_a_pressure_far_below_the_load_is_a_start(boundary: str, device: str) -> None:
    """No shift of what it leads to reaches the load: the search then begins anew, and is certified."""
    grid, law = Grid(64, 60, 0.01), {"modulus": MODULUS, "boundary": boundary, "hardness": 600.0}
    gap = np.add.outer(grid.x**2, grid.y**2) / 6.0 + np.random.default_rng(1).normal(0.0, 5e-3, grid.shape)
    with Executor(grid, device=device) as executor:
        field, solver = executor.field(gap), HalfSpace(executor, **law)
        expected = HalfSpace(executor, **law).solve(field, mean_pressure=0.99 * 600.0)
        solver.solve(field, mean_pressure=1e-6 * 600.0)
        contact = solver.solve(field, mean_pressure=0.99 * 600.0)
        assert contact.approach == pytest.approx(expected.approach, rel=1e-9)
        assert contact.certificate is not None
        assert contact.transforms > expected.transforms  # those of the search before count


def test_a_window_without_a_contact_grows(watch: Callable[..., None]) -> None:
    looked: list[Grid] = []

    def note(solver: HalfSpace, *_: Any, **__: Any) -> None:
        looked.append(solver._executor.grid)
        if solver._executor.grid.cells < 0.5 * GRID.cells:
            raise ConvergenceError("it does not converge on few cells")

    watch(HalfSpace, "solve", note)
    with Executor(GRID) as executor:
        solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary="free")
        found = solver.solve(executor.field(ball()), load=LOAD)
        cells = [grid.cells for grid in looked]
        whole = HalfSpace(executor, modulus=MODULUS, boundary="free")
        assert found.approach == pytest.approx(
            whole.solve(executor.field(ball()), mean_pressure=LOAD / GRID.area).approach, rel=1e-5
        )
    assert cells == sorted(set(cells))
    assert len(cells) > 1


@pytest.mark.parametrize("gap", [ball(), pin(0.2), pin(0.04)], ids=["all cells", "pin", "small pin"])
def test_a_load_that_no_window_carries_is_refused(gap: FloatArray) -> None:
    cells = np.count_nonzero(gap < PADDING)
    most = 1.5 * cells * GRID.cell_area
    with Executor(GRID) as executor:
        for boundary in ("free", "line", "periodic"):
            solver = WindowedHalfSpace(executor, modulus=MODULUS, boundary=boundary, hardness=1.5)
            solver.solve(executor.field(gap), load=most)
            sentence = rf"a load of \S+ N is not possible: .* carry {most:.6g} N at the hardness, 1\.5 MPa\."
            with pytest.raises(InputError, match=sentence):
                solver.solve(executor.field(gap), load=1.00001 * most)


def test_windows_lie_on_whole_vectors_and_hold_what_they_are_made_for() -> None:
    dice = np.random.default_rng(5)
    for _ in range(2000):
        grid = Grid(*dice.integers(1, 90, 2).tolist(), 1.0)
        rows, columns = (sorted(dice.integers(0, n, 2).tolist()) for n in grid.shape)
        box = (*rows, *columns)
        window = Window.around(box, grid, pieces=int(dice.integers(1, 9)))
        assert window.holds(box)
        assert 0 <= window.first_row < window.end_row <= grid.nx
        assert 0 <= window.first < window.end <= math.ceil(grid.ny / 8)
        part = window.grid(grid)
        assert part.nx == window.end_row - window.first_row
        assert 8 * (window.end - window.first - 1) < part.ny <= 8 * (window.end - window.first)
        assert window.first * 8 + part.ny <= grid.ny


def test_close_windows_hold_their_box_and_little_more() -> None:
    """Of lengths without large factors, unless they end where the grid does; on whole vectors."""
    dice = np.random.default_rng(6)
    for _ in range(2000):
        grid = Grid(*dice.integers(1, 700, 2).tolist(), 1.0)
        rows, columns = (sorted(dice.integers(0, n, 2).tolist()) for n in grid.shape)
        window = Window.close_to((*rows, *columns), grid)
        assert window.holds((*rows, *columns))
        assert 0 <= window.first_row < window.end_row <= grid.nx
        assert 0 <= window.first < window.end <= math.ceil(grid.ny / 8)
        part = window.grid(grid)
        for length, (first, last), size in zip(part.shape, (rows, columns), grid.shape, strict=True):
            assert length <= 1.25 * (last - first + 22) + 8
            assert length in (size, fft.next_fast_len(length)) or size % 8
    assert Window.close_to((300, 700, 310, 690), Grid(1024, 1024, 1.0)).grid(Grid(1024, 1024, 1.0)).shape == (
        432,
        400,
    )


def test_what_lies_in_a_window_is_seen() -> None:
    with Executor(GRID) as executor:
        gap = executor.field(ball())
        window = Window.close_to((10, 40, 17, 60), GRID)
        assert_array_equal(
            window.of(gap).numpy().reshape(window.end_row - window.first_row, -1), ball()[window.cells]
        )
