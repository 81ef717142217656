"""The half-space solver against a dense bound-constrained least-squares solve, and what it refuses."""

import math
import re
import sys
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cases_half_space import MODULUS, area_fraction_of, bounded, dense_of, dense_streak, rough, separation_of

from warpwear.contact.half_space import solver as half_space_solver
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.contact.half_space.transforms import load_cupy, stream_of
from warpwear.engine import executor as execution
from warpwear.engine.executor import Executor
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.kernels.half_space.solve import SearchRules

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

GRID = Grid(10, 7, 0.5)  # a width that is no multiple of the lanes of a vector


@cache
def by_active_sets(
    boundary: str, hardness: float, compliance: float, streak: float, window: int | None
) -> tuple[FloatArray, FloatArray, float]:
    """The dense matrix, and pressure and approach by active sets."""
    matrix = dense_of(GRID, boundary)
    matrix += compliance * np.eye(GRID.cells) + streak * dense_streak(GRID, boundary, window)
    # A uniform term makes the periodic matrix definite; it only adds to the approach.
    uniform = 1.0 / GRID.cells
    pressure = bounded(matrix + uniform, rough(GRID), 0.5, hardness)
    return matrix, pressure, 0.5 - uniform * pressure.sum()


@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("hardness", [math.inf, 1.5, 0.2])
@pytest.mark.parametrize(
    ("compliance", "streak", "window"),
    [(0.0, 0.0, None), (0.3, 0.0, None), (0.1, 0.4, None), (0.1, 0.4, 3), (0.1, 0.4, 4), (0.1, 0.4, 99)],
)
def test_against_active_sets_on_the_dense_matrix(
    boundary: str,
    hardness: float,
    compliance: float,
    streak: float,
    window: int | None,
    device: str,
) -> None:
    gap = rough(GRID)
    matrix, expected, approach = by_active_sets(boundary, hardness, compliance, streak, window)
    assert 0.1 < (expected > 0.0).mean() < 0.9
    with Executor(GRID, device=device) as executor:
        options: dict[str, Any] = {"boundary": boundary, "hardness": hardness}
        solver = HalfSpace(executor, modulus=MODULUS, tolerance=1e-11, **options)
        compliances: dict[str, Any] = {"compliance": compliance, "streak_compliance": streak}
        compliances["streak_window"] = window
        loaded = solver.solve(executor.field(gap), mean_pressure=expected.mean(), **compliances)
        np.testing.assert_allclose(loaded.pressure, expected, atol=1e-8 * expected.max())
        assert loaded.mean_pressure == pytest.approx(expected.mean(), rel=1e-12)
        if ((loaded.pressure > 0.0) & (loaded.pressure < hardness)).any():
            assert loaded.approach == pytest.approx(approach, abs=1e-9)
            separation = (matrix @ expected.ravel()).reshape(gap.shape) + gap - approach
            np.testing.assert_allclose(separation_of(loaded), separation, atol=1e-8)
        solver.forget()
        moved = solver.solve(executor.field(gap), approach=approach, **compliances)
        np.testing.assert_allclose(moved.pressure, expected, atol=1e-8 * expected.max())
        assert moved.mean_pressure == pytest.approx(expected.mean(), rel=1e-8)


def test_threads_change_nothing(two_threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    grid = Grid(64, 60, 1.0 / 64)
    gap = rough(grid, rms=0.01, shortest=16)
    pressures = []
    for count in (1, two_threads):
        with Executor(grid, threads=count) as executor:
            solver = HalfSpace(executor, modulus=1.0, hardness=0.1)
            pressures.append(solver.solve(executor.field(gap), mean_pressure=0.01).pressure.copy())
    assert execution.CELLS_PER_THREAD == 1
    np.testing.assert_array_equal(*pressures)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.95])
@pytest.mark.parametrize("hardness", [0.0005, 0.005, 0.05, 0.2, 1.0, math.inf])
def test_every_ratio_of_hardness_to_modulus_converges(hardness: float, share: float) -> None:
    grid = Grid(128, 128, 1.0 / 128)
    gap = rough(grid, rms=0.004, shortest=64)  # rms slope about 0.15
    asked = share * min(hardness, 0.1)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=hardness)
        contact = solver.solve(executor.field(gap), mean_pressure=asked)
        assert contact.pressure.mean() == pytest.approx(asked, rel=1e-12)
        assert contact.pressure.max() <= hardness
        violation = _violation(contact.pressure, separation_of(contact), hardness)
        assert violation <= 1e-6 * gap.std() * (1 + 1e-6)
        assert contact.transforms < 250


def _violation(pressure: FloatArray, separation: FloatArray, hardness: float) -> float:
    held = np.where(pressure >= hardness, np.maximum(separation, 0.0), np.abs(separation))
    return float(np.where(pressure <= 0.0, np.maximum(-separation, 0.0), held).max())


def test_large_compliance_leaves_the_capped_foundation() -> None:
    grid = Grid(64, 64, 0.01)
    gap = rough(grid, rms=1e-3, shortest=16)
    compliance = 1e3 * grid.cell
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1e3, hardness=1.2e-4)
        contact = solver.solve(executor.field(gap), mean_pressure=5e-5, compliance=compliance)
        foundation = np.clip((contact.approach - gap) / compliance, 0.0, 1.2e-4)
        np.testing.assert_allclose(contact.pressure, foundation, atol=1e-3 * 1.2e-4)


def test_a_solve_starts_from_the_last_pressure(device: str) -> None:
    grid = Grid(64, 64, 1.0 / 64)
    gap = rough(grid, rms=0.004, shortest=16)
    with Executor(grid, device=device) as executor:
        solver = HalfSpace(executor, modulus=1.0)
        cold = solver.solve(executor.field(gap), mean_pressure=0.01)
        again = solver.solve(executor.field(gap), mean_pressure=0.01)
        assert again.iterations == 0
        more = solver.solve(executor.field(gap), mean_pressure=0.0101)
        assert 0 < more.iterations < cold.iterations
        assert more.mean_pressure == pytest.approx(0.0101, rel=1e-12)


@pytest.mark.parametrize(("hardness", "cells", "seed"), [(0.2, 46, 3), (0.1, 16, 1), (0.05, 46, 2)])
def test_a_load_that_whole_cells_carry_at_the_hardness(hardness: float, cells: int, seed: int) -> None:
    """No cell is between the bounds then, also where loads and pressures are off in their last digits."""
    with Executor(GRID) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, hardness=hardness, tolerance=1e-9)
        asked = {"mean_pressure": hardness * cells / GRID.cells, "compliance": 0.3}
        contact = solver.solve(executor.field(rough(GRID, seed=seed)), **asked)
        assert _violation(contact.pressure, separation_of(contact), hardness) <= 1e-9 * (1 + 1e-6)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("beyond_the_rim", [0, 2])
def test_where_every_cell_carries_the_hardness_the_last_one_sets_the_approach(
    boundary: str, beyond_the_rim: int
) -> None:
    gap, hardness = rough(GRID), 0.05
    gap[:beyond_the_rim] = PADDING
    approaches = []
    with Executor(GRID) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, boundary=boundary, hardness=hardness, tolerance=1e-9)
        for share in (1.0 - 1e-9, 1.0):
            carried = share * hardness * (1.0 - beyond_the_rim / GRID.nx)
            found = solver.solve(executor.field(gap), mean_pressure=carried, compliance=0.3)
            approaches.append(found.approach)
    assert approaches[1] == pytest.approx(approaches[0], rel=1e-6)


@pytest.mark.parametrize("lower", [1e-6, 1e-5, 1e-4])
def test_a_pressure_that_rounding_left_on_the_wrong_cell_gives_way(lower: float) -> None:
    """Four cells carry the load at the hardness; of two more, the lower one shall have the rest."""
    grid, hardness = Grid(8, 8, 0.01), 590.0
    gap, pressure = np.full(grid.shape, 1e-2), np.zeros(grid.shape)
    gap[3:5, 3:5], pressure[3:5, 3:5] = -1e-2, hardness
    gap[0, 0], gap[7, 0] = 0.0, -lower
    for rest in 10.0 ** np.arange(-17.0, -9.0):
        pressure[0, 0] = rest
        with Executor(grid) as executor:
            solver = HalfSpace(executor, modulus=1e5, boundary="free", hardness=hardness)
            executor.fill(solver.pressure_field, pressure)
            solver.started = True
            found = solver.solve(executor.field(gap), mean_pressure=4.0 / 64.0 * hardness)
        assert found.pressure[0, 0] == 0.0
        assert (found.pressure[3:5, 3:5] > hardness * (1.0 - 1e-12)).all()


def test_full_contact_is_rigid_in_the_mean() -> None:
    grid = Grid(32, 32, 1.0 / 32)
    gap = rough(grid, rms=1e-3)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=1.0)
        for mean_pressure in (0.5, 0.6):
            contact = solver.solve(executor.field(gap), mean_pressure=mean_pressure)
            assert area_fraction_of(contact) == 1.0
            assert contact.approach == pytest.approx(gap.mean(), abs=1e-9)


@pytest.mark.parametrize(
    ("mean", "words"), [(2.0, "mean pressure of 2 MPa"), (0.0, "mean pressure of 0 MPa")]
)
def test_a_load_that_cannot_be_carried_is_refused(mean: float, words: str) -> None:
    with Executor(GRID) as executor:
        solver = HalfSpace(executor, modulus=1.0, hardness=1.0)
        with pytest.raises(InputError, match=words):
            solver.solve(executor.field(rough(GRID)), mean_pressure=mean)


def test_no_convergence_is_an_error_with_its_residual() -> None:
    with Executor(GRID) as executor:
        solver = HalfSpace(executor, modulus=1.0, max_iterations=2)
        with pytest.raises(ConvergenceError, match=r"in 2 iterations.*of the rms height"):
            solver.solve(executor.field(rough(GRID)), mean_pressure=0.1)


@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("hardness", [math.inf, 1.5, 0.3])
def test_a_recorded_search_makes_the_iterations_of_one_whose_passes_are_shared(
    boundary: str, hardness: float, two_threads: int
) -> None:
    """From nothing, from the last pressure, with values extended, and where plain steps take over."""
    grid = Grid(40, 37, 0.5)
    gap = rough(grid, shortest=9)
    asked: dict[str, Any] = {"mean_pressure": 0.12, "streak_window": 5}
    for elastic_fraction, scattered in ((0.3, 1.0), (0.9, 1.0), (0.1, 0.0)):
        rules = SearchRules(elastic_fraction=elastic_fraction, scattered=scattered, few=0)
        contacts = []
        for count in (1, two_threads):
            with Executor(grid, threads=count) as executor:
                options: dict[str, Any] = {"boundary": boundary, "hardness": hardness, "rules": rules}
                solver = HalfSpace(executor, modulus=MODULUS, tolerance=1e-8, **options)
                for scale, streak in ((1.0, 0.0), (1.03, 0.2), (0.9, 0.2)):
                    contact = solver.solve(executor.field(scale * gap), streak_compliance=streak, **asked)
                    contacts.append((contact, contact.pressure.copy()))
        for (one, pressure), (other, of_other) in zip(contacts[:3], contacts[3:], strict=True):
            assert one.iterations > 3
            assert (other.iterations, other.transforms) == (one.iterations, one.transforms)
            assert other.approach == one.approach
            np.testing.assert_array_equal(of_other, pressure)


@pytest.mark.parametrize("compliance", [0.0, 0.3])
@pytest.mark.parametrize("height", [0.0, 1e-15, 1.0])
def test_a_surface_that_is_flat_but_for_rounding(height: float, compliance: float) -> None:
    """The rms height is then no measure of what can be reached."""
    gap = height + 1e-16 * rough(GRID)
    with Executor(GRID) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, hardness=2.0)
        for _ in range(2):
            contact = solver.solve(executor.field(gap), mean_pressure=0.3, compliance=compliance)
            np.testing.assert_allclose(contact.pressure, 0.3, rtol=1e-9)


def test_a_gpu_without_its_library_is_told_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cupy", None)
    with Executor(GRID) as executor, pytest.raises(InputError, match=r"needs CuPy .*pip install") as refused:
        load_cupy(executor.device)
    assert "\n" not in str(refused.value)
    # What it names are the extras of the package.
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    extras = project["project"]["optional-dependencies"]
    for package, extra in re.findall(r"(cupy-cuda\d+x) \((?:the extra )?(\w+)\)", str(refused.value)):
        assert [name.partition(">")[0] for name in extras.pop(extra)] == [package]
    assert not [name for name in extras if name.startswith("gpu")]


@pytest.mark.parametrize("is_new", [True, False])
def test_the_stream_is_shared_as_the_library_wants_it(is_new: bool) -> None:
    """Without what newer ones deprecate."""
    stream = SimpleNamespace(cuda_stream=77)
    old = SimpleNamespace(Stream=object(), ExternalStream=lambda pointer, device: ("old", pointer, device))
    new = SimpleNamespace(Stream=SimpleNamespace(from_external=lambda shared: ("new", shared)))
    found = stream_of(new if is_new else old, SimpleNamespace(stream=stream, ordinal=3))
    assert found == (("new", stream) if is_new else ("old", 77, 3))


@pytest.fixture
def wide_from(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Let contacts of so many cells a side start on wider ones."""

    def begin(least: int) -> None:
        for name in ("LEAST_SIDE", "LEAST_SIDE_ON_GPU"):
            monkeypatch.setattr(half_space_solver, name, least)

    return begin


@pytest.mark.parametrize("shape", [(64, 64), (37, 50)])
@pytest.mark.parametrize("boundary", ["periodic", "free", "line"])
@pytest.mark.parametrize("hardness", [math.inf, 1.5])
def test_a_start_on_wider_cells_leads_to_the_same_contact_in_less(
    shape: tuple[int, int], boundary: str, hardness: float, device: str, wide_from: Callable[[int], None]
) -> None:
    """Where lines are left over, where cells have no surface, and where each bears a part of the hardness."""
    grid = Grid(*shape, 0.5)
    gap, draw = rough(grid, shortest=6), np.random.default_rng(2)
    gap[:3, :5] = PADDING
    options: dict[str, Any] = {"modulus": MODULUS, "boundary": boundary, "hardness": hardness}
    asked: dict[str, Any] = {"mean_pressure": 0.12, "compliance": 0.02, "streak_compliance": 0.05}
    found, work = [], []
    with Executor(grid, device=device) as executor:
        if math.isfinite(hardness):
            asked["cap_ratio"] = executor.field(draw.uniform(0.5, 1.0, shape), padding=1.0)
        for least in (10**6, 16):
            wide_from(least)
            contact = HalfSpace(executor, tolerance=1e-9, **options).solve(
                executor.field(gap, padding=PADDING), streak_window=6, **asked
            )
            assert contact.certificate is not None
            found.append(contact.pressure.copy())
            work.append(contact.iterations)
        # And at an approach.
        moved = HalfSpace(executor, tolerance=1e-9, **options).solve(
            executor.field(gap, padding=PADDING),
            approach=contact.approach,
            streak_window=6,
            **{name: value for name, value in asked.items() if name != "mean_pressure"},
        )
    np.testing.assert_allclose(found[1], found[0], atol=1e-5 * found[0].max())
    np.testing.assert_allclose(moved.pressure, found[0], atol=1e-5 * found[0].max())
    assert work[1] <= 1.2 * work[0]  # so few cells have no long waves to spare


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_a_start_on_wider_cells_saves_iterations(boundary: str, wide_from: Callable[[int], None]) -> None:
    grid = Grid(128, 128, 1.0 / 128)
    gap = rough(grid, rms=0.01, shortest=12)
    if boundary == "free":
        gap = 0.1 * gap + 0.5 * ((grid.x[:, np.newaxis] - grid.x.mean()) ** 2 + (grid.y - grid.y.mean()) ** 2)
    work = []
    with Executor(grid) as executor:
        for least in (10**6, 64):
            wide_from(least)
            solver = HalfSpace(executor, modulus=1.0, boundary=boundary, tolerance=1e-4)
            work.append(solver.solve(executor.field(gap), mean_pressure=0.05).transforms)
    assert work[1] < 0.9 * work[0]


def test_plain_steps_that_do_not_arrive_give_way() -> None:
    """Steps by the plain gradient alone took up to 66 here, and 100 on 512² cells."""
    grid = Grid(128, 128, 1.0 / 128)
    gap = rough(grid, rms=0.006, shortest=64)
    with Executor(grid) as executor:
        for hardness in (0.05, 0.1):
            for share in (0.5, 0.9, 0.99):
                solver = HalfSpace(executor, modulus=1.0, hardness=hardness, tolerance=1e-8)
                contact = solver.solve(executor.field(gap), mean_pressure=share * hardness)
                assert contact.iterations <= 60
