"""warpwear.solve_contact against closed forms, dense matrices and NumPy; every misuse; any units."""

import dataclasses
import math
import pickle
import tracemalloc
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from cases_half_space import MODULUS, bounded, dense_free, dense_periodic, rough
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import solve_contact
from warpwear.contact.array import elastic, memory
from warpwear.contact.array import solve as solve_module
from warpwear.contact.half_space.search import Search
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine import staging
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid

GRID = Grid(64, 48, 0.25)
HEIGHTS = rough(GRID, shortest=12)
AREA = GRID.area
LAWS: dict[str, dict[str, Any]] = {
    "periodic": {"modulus": 5.0},
    "periodic, capped": {"modulus": 5.0, "hardness": 0.9},
    "free": {"modulus": 5.0, "boundary": "free"},
    "free, capped": {"modulus": 5.0, "hardness": 0.9, "boundary": "free"},
    "springs": {"stiffness": 2.0},
    "springs, capped": {"stiffness": 2.0, "hardness": 0.7},
    "bearing area": {"hardness": 0.7},
    "sphere": {"modulus": 5.0, "sphere_radius": 40.0},
    "sphere, capped": {"modulus": 5.0, "hardness": 0.9, "sphere_radius": 40.0},
    "sphere on springs": {"stiffness": 2.0, "sphere_radius": 40.0},
    "sphere, bearing area": {"hardness": 0.7, "sphere_radius": 40.0},
}


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


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
        sphere_radius=radius,
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
        sphere_radius=radius,
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
        "sphere_radius": length,
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
        sphere = solve_contact(**flat, load=unit**2, modulus=100.0, sphere_radius=10.0 * unit)
        punch = solve_contact(**flat, load=unit**2, modulus=100.0, boundary="free")
        plane = solve_contact(**flat, load=unit**2, modulus=100.0)
        springs = solve_contact(**flat, load=unit**2, stiffness=100.0 / unit)
        bearing = solve_contact(**flat, load=unit**2, hardness=5.0)
        results.append([sphere, punch, plane, springs, bearing])
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


def test_threads_change_nothing(threads: int) -> None:
    for law in LAWS.values():
        options = {"cell": GRID.cell, "mean_pressure": 0.05, **law}
        one, other = (solve_contact(HEIGHTS, threads=count, **options) for count in (1, threads))
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


NAN = HEIGHTS.copy()
NAN[3, 5] = math.nan
MISUSES: dict[str, tuple[Any, dict[str, Any], str]] = {
    "nan": (NAN, {}, r"heights\[3, 5\] = nan is not possible \(1 of 3072 are not finite\)"),
    "masked": (
        np.ma.masked_greater(HEIGHTS, 1.0),
        {},
        r"heights of type MaskedArray are not possible \(masked or complex\)",
    ),
    "complex": (HEIGHTS * 1j, {}, r"heights of type ndarray are not possible \(masked or complex\)"),
    "text": ("rough", {}, "heights of type str"),
    "ragged": ([[1.0, 2.0], [3.0]], {}, "heights of type list"),
    "a line": (HEIGHTS[0], {}, r"heights of shape \(48,\) are not possible"),
    "a stack": (HEIGHTS[np.newaxis], {}, r"heights of shape \(1, 64, 48\)"),
    "no cell at all": (HEIGHTS[:0], {}, r"heights of shape \(0, 48\)"),
    "zero cell": (HEIGHTS, {"cell": 0.0}, "cell = 0 is not possible; it must be a positive, finite number"),
    "two cells": (HEIGHTS, {"cell": (1.0, 2.0)}, r"cell = \(1.0, 2.0\) is not possible"),
    "units": (HEIGHTS, {"load": "8 N"}, "load = '8 N' is not possible"),
    "an array": (HEIGHTS, {"load": np.ones(2)}, r"load = array\(\[1., 1.\]\) is not possible"),
    "negative load": (HEIGHTS, {"load": -1.0}, "load = -1 is not possible; it must be a positive"),
    "no load": (HEIGHTS, {"load": None}, "nothing is given; exactly one of load, mean_pressure and approach"),
    "two loads": (
        HEIGHTS,
        {"mean_pressure": 2.0},
        "load = 1 and mean_pressure = 2 is given; exactly one of load, mean_pressure and approach must be",
    ),
    "load and approach": (HEIGHTS, {"approach": 2.0}, "load = 1 and approach = 2 is given"),
    "approach without end": (HEIGHTS, {"load": None, "approach": math.inf}, "approach = inf is not possible"),
    "two laws": (
        HEIGHTS,
        {"stiffness": 2.0},
        "modulus = 1 and stiffness = 2 is given; at most one of modulus and stiffness must be",
    ),
    "no law": (HEIGHTS, {"modulus": None}, "hardness = None is not possible without modulus or stiffness"),
    "modulus": (HEIGHTS, {"modulus": 0}, "modulus = 0 is not possible"),
    "stiffness": (HEIGHTS, {"modulus": None, "stiffness": -3.0}, "stiffness = -3 is not possible"),
    "hardness": (HEIGHTS, {"hardness": math.nan}, "hardness = nan is not possible"),
    "true": (HEIGHTS, {"hardness": True}, "hardness = True is not possible"),
    "tolerance": (HEIGHTS, {"tolerance": 0.0}, "tolerance = 0 is not possible"),
    "boundary": (HEIGHTS, {"boundary": "mirror"}, "boundary = 'mirror' is unknown; allowed are"),
    "boundary of springs": (
        HEIGHTS,
        {"modulus": None, "stiffness": 1.0, "boundary": "free"},
        "boundary = 'free' is only for a half-space",
    ),
    "boundary of the bearing area": (
        HEIGHTS,
        {"modulus": None, "hardness": 1.0, "boundary": "periodic"},
        "boundary = 'periodic' is only for a half-space",
    ),
    "periodic sphere": (
        HEIGHTS,
        {"sphere_radius": 3.0, "boundary": "periodic"},
        'boundary = "periodic" is not possible with sphere_radius = 3',
    ),
    "sphere": (HEIGHTS, {"sphere_radius": -3.0}, "sphere_radius = -3 is not possible"),
    "tiny sphere": (HEIGHTS, {"sphere_radius": 0.01}, "sphere_radius = 0.01 is not possible; it must reach"),
    "too much": (
        HEIGHTS,
        {"hardness": 0.005},
        "load = 1 is not possible; with all cells at the hardness it is 0.96",
    ),
    "too high a mean": (
        HEIGHTS,
        {"load": None, "mean_pressure": 0.6, "hardness": 0.5},
        "mean_pressure = 0.6 is not possible; with all cells at the hardness it is 0.5",
    ),
    "too much for a small sphere": (
        HEIGHTS,
        {"load": 40.0, "hardness": 1.0, "sphere_radius": 3.0},
        "load = 40 is not possible; with all cells at the hardness it is 28",
    ),
    "beyond the mean plane": (
        HEIGHTS,
        {"load": None, "approach": 0.5},
        "approach = 0.5 is not possible; a periodic half-space without a hardness",
    ),
    "device": (HEIGHTS, {"device": "tpu"}, "device = 'tpu' is not there"),
    "threads": (HEIGHTS, {"threads": 0}, "threads = 0 is not possible"),
    "half a thread": (HEIGHTS, {"threads": 1.5}, "threads = 1.5 is not possible"),
}


@pytest.mark.parametrize("case", MISUSES)
def test_misuse_is_told_in_a_sentence(case: str) -> None:
    heights, options, words = MISUSES[case]
    with pytest.raises(InputError, match=words) as refused:
        solve_contact(heights, **{"cell": GRID.cell, "load": 1.0, "modulus": 1.0, **options})
    sentence = str(refused.value)
    assert sentence.endswith(".")
    assert "\n" not in sentence
    assert "mm" not in sentence
    assert "MPa" not in sentence


def test_what_memory_cannot_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda device: {"the host": 1000})
    with pytest.raises(InputError, match=r"heights of shape \(64, 48\) need 0.0 GiB of memory; the host has"):
        solve_contact(HEIGHTS, cell=1.0, load=1.0, modulus=1.0)


def give_up(*_: Any, **__: Any) -> None:
    return None


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_no_convergence_is_an_error_with_its_residual(boundary: str, monkeypatch: pytest.MonkeyPatch) -> None:
    stop: Callable[..., None] = give_up
    monkeypatch.setattr(Search, "move", stop)
    with pytest.raises(ConvergenceError, match=r"solve_contact failed: .* of the rms height"):
        solve_contact(HEIGHTS, cell=GRID.cell, load=1.0, modulus=1.0, boundary=boundary)


def test_a_load_that_is_missed_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solve_module, "LOAD_TOLERANCE", -1.0)
    with pytest.raises(ConvergenceError, match=r"found a mean pressure of 0\.5 instead of 0\.5"):
        solve_contact(HEIGHTS, cell=GRID.cell, mean_pressure=0.5, stiffness=1.0)


def test_a_contact_at_the_edge_is_told() -> None:
    """Beyond the array there is nothing to carry: the area would be cut off without a word."""
    radius, modulus, load = 3.0, 1.0e5, 8.0
    a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
    with pytest.warns(UserWarning, match=r"the edge of heights, of the shape \(16, 16\)"):
        solve_contact(np.zeros((16, 16)), cell=a / 20, load=load, modulus=modulus, sphere_radius=radius)


def test_a_large_contact_says_what_memory_it_needs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda device: {"the host": 100 * 2**30})
    memory.check_memory((1024, 1024), "cpu", "periodic")
    assert not capsys.readouterr().err
    memory.check_memory((8192, 8192), "cpu", "periodic")
    assert "8192 × 8192 cells need up to 5.5 GiB of the host (100.0 GiB free)" in capsys.readouterr().err
    with pytest.raises(InputError, match=r"112\.0 GiB of memory; the host has 100\.0 GiB free"):
        memory.check_memory((32768, 32768), "cpu", "free")


def test_the_largest_contact_of_a_gpu_needs_little_of_its_host(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beside the heights, 8 GiB here, the pressure and the gap: measured were 26 GiB in all."""
    there = {"the host": 26 * 2**30, "cuda:0": 130 * 2**30}
    monkeypatch.setattr(memory, "free_memory", lambda device: there)
    monkeypatch.setattr(memory, "find_device", lambda device: None)
    monkeypatch.setattr(memory, "release", lambda device: None)
    memory.check_memory((32768, 32768), "cuda:0", "periodic")
    assert "24.0 GiB of the host (26.0 GiB free) and 124.0 GiB of cuda:0" in capsys.readouterr().err
    there["the host"] = 18 * 2**30
    with pytest.raises(InputError, match=r"24\.0 GiB of memory; the host has 18\.0 GiB free"):
        memory.check_memory((32768, 32768), "cuda:0", "periodic")


@pytest.mark.parametrize("sphere_radius", [None, 30.0])
def test_blocks_of_rows_change_nothing(
    monkeypatch: pytest.MonkeyPatch, device: str, sphere_radius: float | None
) -> None:
    options: dict[str, Any] = {"cell": 0.5, "mean_pressure": 0.02, "modulus": 2.0, "hardness": 0.5}
    options |= {"sphere_radius": sphere_radius, "tolerance": 1e-9, "device": device}
    whole = solve_contact(HEIGHTS, **options)
    monkeypatch.setattr(staging, "TOGETHER", 500)
    blocks = solve_contact(HEIGHTS, **options)
    largest = whole.pressure.max()
    assert_allclose(blocks.pressure, whole.pressure, rtol=0.0, atol=1e-9 * largest)
    assert_allclose(blocks.gap, whole.gap, rtol=0.0, atol=1e-9 * np.ptp(HEIGHTS))
    assert blocks.load == pytest.approx(whole.load, rel=1e-12)


#: Heights of a rough free surface whose contact lies in a part of it, loads and approaches.
TOP = rough(Grid(160, 152, 0.25), shortest=30, rms=0.02)
TOP -= 0.004 * np.add.outer((Grid(160, 1, 0.25).x - 3.0) ** 2, (Grid(1, 152, 0.25).y + 4.0) ** 2)
GUESSES: dict[str, Any] = {
    "as it is": None,
    "one cell": lambda *_: (80, 80, 76, 76),
    "elsewhere": lambda *_: (0, 20, 120, 151),
    "unknown": lambda *_: None,
}


OF_PARTS: dict[str, Any] = {"modulus": 1.0, "boundary": "free", "tolerance": 1e-9, "cell": 0.25}


@cache
def wholly_solved(width: int, hardness: float | None, device: str) -> Any:
    """The contact where all cells are looked at from the start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(elastic, "_guess", lambda *_: (0, 159, 0, width - 1))
        options = OF_PARTS | {"hardness": hardness, "device": device}
        return solve_contact(TOP[:, :width], mean_pressure=0.002, **options)


@pytest.mark.parametrize("guess", GUESSES)
@pytest.mark.parametrize("hardness", [None, 0.05])
@pytest.mark.parametrize("width", [152, 149])
def test_a_contact_of_a_part_is_that_of_all_cells(
    guess: str, hardness: float | None, width: int, device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever it is looked for first."""
    heights = TOP[:, :width]
    options = OF_PARTS | {"hardness": hardness, "device": device}
    whole = wholly_solved(width, hardness, device)
    assert 0 < np.count_nonzero(whole.pressure) < 0.3 * heights.size
    if GUESSES[guess] is not None:
        monkeypatch.setattr(elastic, "_guess", GUESSES[guess])
    for asked in ({"mean_pressure": 0.002}, {"approach": whole.approach}):
        found = solve_contact(heights, **asked, **options)
        assert found.approach == pytest.approx(whole.approach, rel=1e-8)
        assert_allclose(found.pressure, whole.pressure, atol=2e-6 * whole.pressure.max())
        assert_allclose(found.gap, whole.gap, atol=1e-8 * np.ptp(heights))
        assert found.residual <= 1e-9


def test_a_contact_is_looked_for_where_it_is() -> None:
    """Small windows are what memory and time go by: the first one does, and is not much larger."""
    solved: list[tuple[int, int]] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(elastic, "HalfSpace", watched(solved))
        asked = {"load": 0.5}
        for _ in range(2):
            found = solve_contact(TOP, cell=0.25, modulus=1.0, boundary="free", **asked)
            asked = {"approach": found.approach}
            rows, columns = (np.flatnonzero(found.pressure.any(axis=axis)) for axis in (1, 0))
            wide, window = solved
            assert max(wide) <= elastic.WIDE_CELLS
            assert window[0] * window[1] < 0.5 * TOP.size
            assert np.ptp(rows) < window[0] <= 1.5 * np.ptp(rows) + 32
            assert np.ptp(columns) < window[1] <= 1.5 * np.ptp(columns) + 32
            solved.clear()


def watched(solved: list[tuple[int, int]]) -> type[HalfSpace]:
    """A solver that notes the shapes of its grids."""

    class Watched(HalfSpace):
        def __init__(self, executor: Any, **options: Any) -> None:
            solved.append(executor.grid.shape)
            super().__init__(executor, **options)

    return Watched


def test_a_small_contact_takes_little_memory() -> None:
    """The fields that it works on are as large as its window, and all cells are displaced in few."""
    heights = -np.add.outer(Grid(512, 1, 1.0).x ** 2, Grid(1, 512, 1.0).y ** 2) / 1e4
    options: dict[str, Any] = {"cell": 1.0, "modulus": 1.0, "boundary": "free", "tolerance": 1e-4}
    solve_contact(heights[:64, :64], load=10.0, **options)  # what is made once
    asked = {"load": 136.0}
    for _ in range(2):
        tracemalloc.start()
        found = solve_contact(heights, **asked, **options)
        asked = {"approach": found.approach}
        peak = tracemalloc.get_traced_memory()[1] / heights.nbytes
        tracemalloc.stop()
        assert 0.01 < found.area / found.nominal_area < 0.2
        assert peak < 7.0
