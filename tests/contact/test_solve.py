"""warpwear.solve_contact against closed forms, dense matrices and NumPy; any units."""

import dataclasses
import math
import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest
from cases_half_space import MODULUS, bounded, dense_free, dense_periodic, rough
from cases_solve import GRID, HEIGHTS
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import solve_contact
from warpwear.grid import FloatArray, Grid

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


AREA = GRID.area
LAWS: dict[str, dict[str, Any]] = {
    "periodic": {"modulus": 5.0},
    "periodic, capped": {"modulus": 5.0, "hardness": 0.9},
    "free": {"modulus": 5.0, "boundary": "free"},
    "free, capped": {"modulus": 5.0, "hardness": 0.9, "boundary": "free"},
    "springs": {"stiffness": 2.0},
    "springs, capped": {"stiffness": 2.0, "hardness": 0.7},
    "bearing area": {"hardness": 0.7},
    "counter": {"modulus": 5.0, "counter_radius": 40.0},
    "counter-body, capped": {"modulus": 5.0, "hardness": 0.9, "counter_radius": 40.0},
    "counter-body on springs": {"stiffness": 2.0, "counter_radius": 40.0},
    "counter-body, bearing area": {"hardness": 0.7, "counter_radius": 40.0},
}


def winkler(gap: FloatArray, stiffness: float, hardness: float, mean: float) -> tuple[FloatArray, float]:
    """Pressure and approach of springs by plain bisection."""
    low, high = gap.min(), gap.max() + hardness / stiffness
    for _ in range(200):
        approach = 0.5 * (low + high)
        pressure = np.clip((approach - gap) * stiffness, 0.0, hardness)
        low, high = (approach, high) if pressure.mean() < mean else (low, approach)
    return pressure, approach


def test_hertz(device: str, threads: int) -> None:
    modulus, radius, load = 100.0, 10.0, 1.0
    a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
    cell = a / 40.0
    found = solve_contact(
        np.full((121, 110), 7.0),
        cell=cell,
        load=load,
        modulus=modulus,
        counter_radius=radius,
        device=device,
        threads=threads,
    )
    assert math.sqrt(found.area / math.pi) == pytest.approx(a, rel=0.01)
    assert found.pressure.max() == pytest.approx(1.5 * load / (math.pi * a**2), rel=0.01)
    assert found.approach == pytest.approx(a**2 / radius, rel=0.01)
    assert found.load == pytest.approx(load, rel=1e-10)
    # Johnson's eq. 3.42a for the gap beside the contact
    grid = Grid(121, 110, cell)
    r = np.hypot(grid.x[:, np.newaxis], grid.y)
    outside = r > 1.1 * a
    inside = (2.0 - (r / a) ** 2) * np.arcsin(np.minimum(a / r, 1.0)) + np.sqrt(
        np.maximum((r / a) ** 2 - 1.0, 0.0)
    )
    gap = r**2 / (2.0 * radius) + a**2 / (math.pi * radius) * inside - a**2 / radius
    assert_allclose(found.gap[outside], gap[outside], atol=0.01 * a**2 / radius)


@pytest.mark.parametrize("along", [0, 1])
@pytest.mark.parametrize("share", [0.05, 0.3, 0.7])
def test_westergaard(along: int, share: float, device: str) -> None:
    """A sinusoid carries p̄ = p* sin²(πa/λ) on strips of half-width a; p* = πE*Δ/λ (Johnson eq. 13.7)."""
    cells, modulus, amplitude = 255, 3.0, 0.02
    x = Grid(cells, 1, 1.0 / cells).x
    heights = np.tile(amplitude * np.cos(2.0 * math.pi * x), (6, 1))
    full = math.pi * modulus * amplitude
    found = solve_contact(
        heights.T if along == 0 else heights,
        cell=1.0 / cells,
        mean_pressure=share * full,
        modulus=modulus,
        device=device,
    )
    width = found.area / (6.0 / cells)
    assert width == pytest.approx(2.0 * math.asin(math.sqrt(share)) / math.pi, abs=1.0 / cells)
    half = math.asin(math.sqrt(share))
    at = math.pi * x
    peak = np.sqrt(np.maximum(math.sin(half) ** 2 - np.sin(at) ** 2, 0.0))
    pressure = 2.0 * full * np.cos(at) * peak
    along_the_wave = found.pressure[:, 0] if along == 0 else found.pressure[0]
    assert_allclose(along_the_wave, pressure, atol=0.03 * pressure.max())


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("hardness", [None, 1.5, 0.2])
def test_against_active_sets_on_the_dense_matrix(boundary: str, hardness: float | None, device: str) -> None:
    grid = Grid(10, 7, 0.5)
    heights = 3.0 - rough(grid)
    gap = heights.mean() - heights
    matrix = dense_free(grid) if boundary == "free" else dense_periodic(grid)
    uniform = 1.0 / grid.cells  # makes the periodic matrix definite and only adds to the approach
    expected = bounded(matrix + uniform, gap, 0.5, hardness or math.inf)
    approach = 0.5 - uniform * expected.sum()
    options: dict[str, Any] = {"modulus": MODULUS, "boundary": boundary, "hardness": hardness}
    options |= {"cell": grid.cell, "tolerance": 1e-11, "device": device}
    for asked in ({"mean_pressure": expected.mean()}, {"approach": approach}):
        found = solve_contact(heights, **asked, **options)
        assert_allclose(found.pressure, expected, atol=1e-8 * expected.max())
        assert found.approach == pytest.approx(approach, abs=1e-9)
        left = (matrix @ expected.ravel()).reshape(gap.shape) + gap - approach
        assert_allclose(found.gap, left, atol=1e-8)
        assert found.residual <= 1e-11


@pytest.mark.parametrize("stiffness", [0.5, 20.0])
@pytest.mark.parametrize("hardness", [None, 0.4])
@pytest.mark.parametrize("radius", [None, 30.0, 5.0])
def test_springs_against_a_bisection(
    stiffness: float, hardness: float | None, radius: float | None, device: str, threads: int
) -> None:
    gap = HEIGHTS.mean() - HEIGHTS
    if radius is not None:
        squared = np.add.outer(GRID.x**2, GRID.y**2)
        with np.errstate(invalid="ignore"):
            gap = gap + np.nan_to_num(radius - np.sqrt(radius**2 - squared), nan=math.inf)
    there = np.isfinite(gap)
    mean = 0.03
    expected, approach = winkler(gap[there], stiffness, hardness or 1e9, mean * gap.size / there.sum())
    found = solve_contact(
        HEIGHTS,
        cell=GRID.cell,
        mean_pressure=mean,
        stiffness=stiffness,
        hardness=hardness,
        counter_radius=radius,
        device=device,
        threads=threads,
    )
    assert_allclose(found.pressure[there], expected, atol=1e-12)
    assert not found.pressure[~there].any()
    assert found.approach == pytest.approx(approach, abs=1e-12)
    assert_allclose(found.gap[there], gap[there] + expected / stiffness - approach, atol=1e-12)
    assert np.isinf(found.gap[~there]).all()
    assert found.load == pytest.approx(mean * AREA, rel=1e-11)


@pytest.mark.parametrize("share", [1e-4, 0.1234, 0.5, 1.0])
def test_the_bearing_area_is_that_of_the_sorted_heights(share: float, device: str, threads: int) -> None:
    hardness = 3.0
    found = solve_contact(
        HEIGHTS,
        cell=GRID.cell,
        load=share * hardness * AREA,
        hardness=hardness,
        device=device,
        threads=threads,
    )
    needed = share * GRID.cells
    order = np.argsort(-HEIGHTS, axis=None)
    whole = math.floor(needed + 1e-9)
    expected = np.zeros(GRID.cells)
    expected[order[:whole]] = hardness
    if whole < needed - 1e-9:
        expected[order[whole]] = hardness * (needed - whole)
    assert_allclose(found.pressure.ravel(), expected, atol=1e-9)
    lowest = HEIGHTS.flat[order[math.ceil(needed - 1e-9) - 1]]
    assert found.approach == pytest.approx(HEIGHTS.mean() - lowest, abs=1e-14)
    assert found.area_at_hardness == pytest.approx(whole * GRID.cell_area)
    assert found.area == pytest.approx(math.ceil(needed - 1e-9) * GRID.cell_area)
    assert_allclose(found.gap, HEIGHTS.mean() - HEIGHTS - found.approach, atol=1e-14)


def test_tied_heights_share_what_is_missing() -> None:
    heights = np.repeat([[3.0, 2.0, 2.0, 2.0, 1.0]], 4, axis=0)
    found = solve_contact(heights, cell=1.0, load=10.0, hardness=1.0)
    assert_allclose(found.pressure, np.repeat([[1.0, 0.5, 0.5, 0.5, 0.0]], 4, axis=0))
    assert found.approach == 0.0


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_the_hardness_cuts_the_pressure(boundary: str, device: str) -> None:
    """Pressures do not exceed H; of ever stiffer bodies area × H becomes the load."""
    load, hardness = 0.123 * 0.5 * AREA, 0.5
    areas = []
    for modulus in (0.5, 50.0, 1e9):
        found = solve_contact(
            HEIGHTS,
            cell=GRID.cell,
            load=load,
            hardness=hardness,
            modulus=modulus,
            boundary=boundary,
            device=device,
        )
        assert found.pressure.max() == hardness
        assert found.pressure.min() == 0.0
        assert float(found.pressure.sum()) * GRID.cell_area == pytest.approx(load, rel=1e-10)
        assert found.load == pytest.approx(load, rel=1e-10)
        assert found.area_at_hardness <= load / hardness * (1.0 + 1e-12)
        assert found.residual <= 1e-6
        areas.append(found.area)
    assert areas[0] > areas[1] > load / hardness
    assert areas[2] * hardness == pytest.approx(load, rel=2.0 / (0.123 * GRID.cells))
    bearing = solve_contact(HEIGHTS, cell=GRID.cell, load=load, hardness=hardness)
    assert_array_equal(bearing.pressure > 0.0, found.pressure > 0.0)
    assert found.approach == pytest.approx(bearing.approach, abs=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_an_approach_gives_back_the_load(name: str, device: str) -> None:
    options: dict[str, Any] = {"cell": GRID.cell, "device": device, "tolerance": 1e-9} | LAWS[name]
    # Of the bearing area a load of whole cells: an approach knows no other.
    loaded = solve_contact(HEIGHTS, load=100 * 0.7 * GRID.cell_area, **options)
    moved = solve_contact(HEIGHTS, approach=loaded.approach, **options)
    assert moved.approach == loaded.approach
    assert moved.load == pytest.approx(loaded.load, rel=1e-6)
    assert moved.area == loaded.area
    assert_allclose(moved.pressure, loaded.pressure, atol=1e-6 * loaded.pressure.max())
    assert_allclose(moved.gap, loaded.gap, atol=1e-7)
    assert loaded.residual <= 1e-9
    assert moved.residual <= 1e-9


@pytest.mark.parametrize("name", LAWS)
def test_above_the_highest_point_nothing_is_carried(name: str, device: str) -> None:
    found = solve_contact(HEIGHTS, cell=GRID.cell, approach=-10.0, device=device, **LAWS[name])
    assert found.load == found.area == found.residual == 0.0
    assert found.gap.min() > 0.0


@cache
def loaded(name: str) -> Any:
    """The contact by a law under a load."""
    return solve_contact(HEIGHTS, cell=GRID.cell, load=0.031 * AREA, **LAWS[name])


@pytest.mark.parametrize("length", [1e-9, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("pressure", [1e-9, 1e6])
@pytest.mark.parametrize("name", LAWS)
def test_units_change_nothing(name: str, length: float, pressure: float) -> None:
    units = {
        "hardness": pressure,
        "modulus": pressure,
        "stiffness": pressure / length,
        "counter_radius": length,
    }
    law = LAWS[name]
    scaled = {key: value * units.get(key, 1.0) if key in units else value for key, value in law.items()}
    load, one = 0.031 * AREA, loaded(name)
    other = solve_contact(
        HEIGHTS * length, cell=GRID.cell * length, load=load * pressure * length**2, **scaled
    )
    assert_allclose(other.pressure / pressure, one.pressure, atol=1e-9 * one.pressure.max())
    there = np.isfinite(one.gap)
    assert_allclose(other.gap[there] / length, one.gap[there], atol=1e-9)
    assert other.approach / length == pytest.approx(one.approach, rel=1e-9)
    assert other.area / length**2 == pytest.approx(one.area, rel=1e-12)
    assert other.area_at_hardness / length**2 == pytest.approx(one.area_at_hardness, rel=1e-12)
    assert other.residual == pytest.approx(one.residual, rel=1e-3, abs=1e-12)
    assert other.evaluations == one.evaluations


@pytest.mark.parametrize("length", [1e-9, 1e9])
def test_units_change_nothing_of_a_flat(length: float) -> None:
    """There is no roughness to measure lengths by: the displacement has to do."""
    cells = (80, 70)
    results = []
    for unit in (1.0, length):
        flat = {"heights": np.full(cells, 0.1 * unit), "cell": 0.01 * unit}
        counter = solve_contact(**flat, load=unit**2, modulus=100.0, counter_radius=10.0 * unit)
        punch = solve_contact(**flat, load=unit**2, modulus=100.0, boundary="free")
        plane = solve_contact(**flat, load=unit**2, modulus=100.0)
        springs = solve_contact(**flat, load=unit**2, stiffness=100.0 / unit)
        bearing = solve_contact(**flat, load=unit**2, hardness=5.0)
        results.append([counter, punch, plane, springs, bearing])
    for one, other in zip(*results, strict=True):
        assert_allclose(other.pressure, one.pressure, atol=1e-9 * one.pressure.max())
        assert other.approach / length == pytest.approx(one.approach, rel=1e-9, abs=1e-15)
        assert one.residual <= 1e-5
    assert_allclose(results[0][2].pressure, 1.0 / (0.8 * 0.7))
    assert results[0][3].approach == pytest.approx(1.0 / (0.8 * 0.7) / 100.0)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("shape", [(64, 48), (9, 31), (1, 40), (40, 1)])
def test_grids_of_any_shape(name: str, shape: tuple[int, int], device: str) -> None:
    """Turned by 90° the same contact is turned; a mean plane changes nothing."""
    heights = np.random.default_rng(3).normal(0.0, 1.0, shape)
    options: dict[str, Any] = {"cell": 0.25, "mean_pressure": 0.02, "device": device, "tolerance": 1e-10}
    found = solve_contact(heights, **options, **LAWS[name])
    turned = solve_contact(heights.T.astype(np.float32).astype(float) + 5.0, **options, **LAWS[name])
    assert found.pressure.shape == found.gap.shape == shape
    assert_allclose(turned.pressure.T, found.pressure, atol=1e-3 * found.pressure.max())
    assert turned.approach == pytest.approx(found.approach, abs=1e-5)


def test_threads_change_nothing(two_threads: int) -> None:
    for law in LAWS.values():
        options = {"cell": GRID.cell, "mean_pressure": 0.05, **law}
        one, other = (solve_contact(HEIGHTS, threads=count, **options) for count in (1, two_threads))
        assert_array_equal(one.pressure, other.pressure)
        assert_array_equal(one.gap, other.gap)


def test_what_comes_back() -> None:
    heights = HEIGHTS.astype(np.float32)
    found = solve_contact(heights.tolist(), cell=np.float32(0.25), load=np.int64(6), modulus=5, hardness=2)
    assert found.load == pytest.approx(6.0, rel=1e-12)
    assert found.mean_pressure == pytest.approx(6.0 / AREA, rel=1e-12)
    assert found.nominal_area == AREA
    assert found.pressure.dtype == found.gap.dtype == np.float64
    assert found.area == np.count_nonzero(found.pressure) * GRID.cell_area
    assert repr(found) == (
        f"<contact: area {found.area:.4g} of 192, mean pressure 0.03125, approach {found.approach:.4g}, "
        f"{found.evaluations} evaluations>"
    )
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.approach = 0.0  # type: ignore[misc]
    again = pickle.loads(pickle.dumps(found))
    assert_array_equal(again.pressure, found.pressure)
    assert again.area == found.area
    assert "solve_contact" in dir(warpwear)


def test_the_heights_stay_as_they_are() -> None:
    heights = HEIGHTS.copy()
    heights.setflags(write=False)
    solve_contact(heights, cell=1.0, mean_pressure=0.1, stiffness=1.0)
    assert_array_equal(heights, HEIGHTS)
