"""Line contacts, free along sliding and repeated across, against closed forms and dense matrices."""

import math
from typing import Any

import numpy as np
import pytest
from cases_half_space import MODULUS, bounded, dense_line, rough
from numpy.testing import assert_allclose, assert_array_equal
from scipy.special import k0

from warpwear import solve_contact
from warpwear.contact.half_space.lines import line_coefficients
from warpwear.contact.half_space.window import WindowedHalfSpace
from warpwear.engine.executor import Executor
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


RADIUS, PER_LENGTH, E_STAR = 6.0, 18.5, 1.1e5
HALF_WIDTH = math.sqrt(4.0 * PER_LENGTH * RADIUS / (math.pi * E_STAR))
PEAK = math.sqrt(PER_LENGTH * E_STAR / (math.pi * RADIUS))


def cylinder(grid: Grid) -> FloatArray:
    """Heights of a cylinder that lies across."""
    return np.broadcast_to(-(grid.x[:, np.newaxis] ** 2) / (2.0 * RADIUS), grid.shape).copy()


@pytest.mark.parametrize("columns", [1, 2, 5, 24])
@pytest.mark.parametrize(("across", "error"), [(64, 2e-4), (128, 5e-5)])
def test_hertz_of_a_line(across: int, error: float, columns: int, device: str, threads: int) -> None:
    """Half-width to a cell, pressure and approach; the approach counts from the domain's length away."""
    cell = 2.0 * HALF_WIDTH / across
    grid = Grid(3 * across, columns, cell)
    heights = cylinder(grid)
    found = solve_contact(
        heights,
        cell=cell,
        load=PER_LENGTH * columns * cell,
        modulus=E_STAR,
        boundary="line",
        device=device,
        threads=threads,
    )
    assert found.area / (columns * cell) == pytest.approx(2.0 * HALF_WIDTH, abs=1.1 * cell)
    assert found.pressure.max() == pytest.approx(PEAK, rel=error)
    exact = PEAK * np.sqrt(np.maximum(1.0 - (grid.x / HALF_WIDTH) ** 2, 0.0))
    inside = np.abs(grid.x) < 0.95 * HALF_WIDTH
    assert_allclose(found.pressure[inside, 0], exact[inside], atol=30.0 * error * PEAK)
    length = grid.nx * cell
    sinks = PER_LENGTH / (math.pi * E_STAR) * (2.0 * math.log(2.0 * length / HALF_WIDTH) + 1.0)
    approach = found.approach - heights.mean() + heights.max()  # of the line that touches first
    assert approach == pytest.approx(sinks, rel=error)
    # to rounding the same in every row of cells
    assert_allclose(found.pressure, found.pressure[:, :1] + np.zeros((1, columns)), rtol=1e-6)


def test_a_uniform_line_is_the_same_on_one_row_of_cells_and_on_many(device: str) -> None:
    heights = 3.0 - rough(Grid(40, 1, 0.5), shortest=9)
    options: dict[str, Any] = {"modulus": MODULUS, "boundary": "line", "hardness": 1.0, "cell": 0.5}
    options |= {"mean_pressure": 0.3, "tolerance": 1e-12, "device": device}
    one, many = (solve_contact(np.tile(heights, (1, count)), **options) for count in (1, 32))
    assert (one.pressure >= 1.0).any()
    assert_allclose(many.pressure, np.tile(one.pressure, (1, 32)), atol=1e-10)
    assert many.approach == pytest.approx(one.approach, abs=1e-10)


@pytest.mark.parametrize("hardness", [math.inf, 1.5, 0.3])
def test_a_line_that_is_wavy_across_is_that_of_the_dense_matrix(hardness: float, device: str) -> None:
    grid = Grid(24, 11, 0.5)
    heights = -0.02 * grid.x[:, np.newaxis] ** 2 - 0.3 * rough(grid)
    gap, matrix = heights.mean() - heights, dense_line(grid)
    expected = bounded(matrix, gap, 0.4, hardness)
    assert 0.05 < (expected > 0.0).mean() < 0.9
    options: dict[str, Any] = {"modulus": MODULUS, "boundary": "line", "cell": grid.cell, "device": device}
    options |= {"tolerance": 1e-12, "hardness": None if hardness == math.inf else hardness}
    for asked in ({"mean_pressure": expected.mean()}, {"approach": 0.4}):
        found = solve_contact(heights, **asked, **options)
        assert_allclose(found.pressure, expected, atol=1e-10 * expected.max())
        assert found.approach == pytest.approx(0.4, abs=1e-10)
        left = (matrix @ expected.ravel()).reshape(gap.shape) + gap - 0.4
        assert_allclose(found.gap, left, atol=1e-10)
        assert not found.certificate.fault
        assert found.residual <= 1e-12


@pytest.mark.parametrize("period", [1, 2, 5, 16])
def test_waves_across_fade_and_the_mean_is_a_logarithm(period: int) -> None:
    """Of cells: an integral of 2/(π E*) ln(datum/x) along; waves across as Bessel's K₀ of their distance."""
    cell, modulus, datum, x = 0.5, 2.0, 30.0, 0.5 * np.arange(40)
    one_side = line_coefficients(cell, modulus, 40, period, datum)
    across = np.minimum(np.arange(period), period - np.arange(period))
    modes = np.fft.fft(one_side[:, across], axis=1).real
    ends = [s * (np.log(np.abs(s) / datum) - 1.0) for s in (x - 0.5 * cell, x + 0.5 * cell)]
    mean = 2.0 / (math.pi * modulus) * (ends[0] - ends[1])
    assert_allclose(modes[:, 0], mean, rtol=0.0, atol=1e-13 * mean.max())
    if period == 16:
        q = 2.0 * math.pi / (period * cell)
        of_wave = 2.0 * cell / (math.pi * modulus) * k0(q * x[8:])
        assert_allclose(modes[8:, 1], of_wave, rtol=0.01)


def test_a_window_of_a_long_line_finds_the_contact_of_all_cells(device: str) -> None:
    """With one approach, and its certificate; a load that grows needs a larger one."""
    cell = HALF_WIDTH / 16.0
    grid = Grid(512, 12, cell)
    gap = -cylinder(grid) + 2e-5 * rough(grid, shortest=30)
    whole, windowed = [], []
    with Executor(grid, device=device) as executor:
        field = executor.field(gap)
        solver = WindowedHalfSpace(executor, modulus=E_STAR, boundary="line", tolerance=1e-9)
        windows = []
        for times in (0.3, 1.0, 8.0, 0.3):
            load = times * PER_LENGTH * grid.ny * cell
            contact = solver.solve(field, load=load)
            assert contact.certificate is not None
            assert solver._window is not None
            windows.append(solver._window.end_row - solver._window.first_row)
            windowed.append((contact.pressure.copy(), contact.approach))
            options: dict[str, Any] = {"modulus": E_STAR, "boundary": "line", "tolerance": 1e-9}
            everything = solve_contact(-gap, cell=cell, load=load, device=device, **options)
            whole.append((everything.pressure, everything.approach + gap.mean()))
    assert windows[2] > windows[0]
    assert windows[0] < grid.nx
    for (one, approach), (other, expected) in zip(windowed, whole, strict=True):
        assert_allclose(one, other, atol=1e-5 * other.max())
        assert approach == pytest.approx(expected, rel=1e-7)


def test_threads_change_no_line(two_threads: int) -> None:
    """To the last bit."""
    for shape in ((64, 20), (200, 1)):
        heights = -rough(Grid(*shape, 1.0), shortest=9)
        options: dict[str, Any] = {"cell": 1.0, "mean_pressure": 0.01, "modulus": 1.0, "boundary": "line"}
        one, other = (solve_contact(heights, threads=count, **options) for count in (1, two_threads))
        assert_array_equal(one.pressure, other.pressure)
        assert one.approach == other.approach


def test_a_ball_is_no_line() -> None:
    with pytest.raises(InputError, match=r'boundary = "line" is not possible with counter_radius = 3'):
        solve_contact(np.zeros((9, 9)), cell=1.0, load=1.0, modulus=1.0, boundary="line", counter_radius=3.0)
