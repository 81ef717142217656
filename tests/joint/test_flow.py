"""What flows through a gap, against closed forms, a dense solve and the curve of Patir and Cheng."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import warpwear
from tests.cases_half_space import rough
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.found import FlowFactors
from warpwear.contact.joint.flow import SHORT_SLOPE, short_slope, through, ways
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid

STRIPES = 1.0 + 0.5 * np.sin(2.0 * math.pi * (np.arange(128) + 0.5) / 128)[:, np.newaxis] + np.zeros(6)


def pressed(mean_pressure: float, *, seed: int = 1, cells: int = 256) -> ArrayContact:
    """A self-affine surface of rms slope 0.1, of waves from 8 cells to a quarter of its side."""
    waves = np.hypot(np.fft.fftfreq(cells)[:, np.newaxis], np.fft.rfftfreq(cells))
    there = (waves >= 4 / cells) & (waves <= 1 / 8)
    heights = np.random.default_rng(seed).normal(size=(cells, cells))
    heights = np.fft.irfft2(np.fft.rfft2(heights) * np.where(there, waves + ~there, np.inf) ** -1.8)
    slope = math.sqrt(sum(float(np.mean(side**2)) for side in np.gradient(heights)))
    return warpwear.solve_contact(
        heights * (0.1 / slope), cell=1.0, modulus=1.0, mean_pressure=mean_pressure, tolerance=1e-5
    )


def dense(gap: FloatArray) -> tuple[float, float, float]:
    """What flows through all faces, cell by cell, with the smallest pressures that do it."""
    cells = list(np.ndindex(gap.shape))
    matrix, sources = np.zeros((gap.size, gap.size)), np.zeros((3, gap.size))
    faces = []
    for axis in (0, 1):
        for here, cell in enumerate(cells):
            beyond = tuple((n + (axis == side)) % gap.shape[side] for side, n in enumerate(cell))
            one, two = gap[cell] ** 3, gap[beyond] ** 3
            if one * two == 0.0:
                continue
            there, ease = cells.index(beyond), 2.0 / (1.0 / one + 1.0 / two)
            dragged = ease * 0.5 * (gap[cell] / one + gap[beyond] / two)
            matrix[[here, there], [there, here]] -= ease
            matrix[[here, there], [here, there]] += ease
            faces.append((axis, here, there, ease, dragged))
            for flow, source in ((axis, ease), *([(2, -dragged)] if axis == 0 else [])):
                sources[flow, here] += source
                sources[flow, there] -= source
    pressure = np.linalg.lstsq(matrix, sources.T, rcond=1e-12)[0].T
    flows = np.zeros(3)
    for axis, here, there, ease, dragged in faces:
        for flow, source in ((axis, ease), *([(2, -dragged)] if axis == 0 else [])):
            flows[flow] += source + ease * (pressure[flow, there] - pressure[flow, here])
    along, across, left = (flows / gap.size).tolist()
    return along, across, gap.mean() + left


def test_stripes() -> None:
    """Across them 1/⟨g⁻³⟩, along them ⟨g³⟩; a wave that slides carries 1 − ⟨g⁻²⟩/⟨g⁻³⟩."""
    across, along, carried, is_open = through(STRIPES)
    carries = 1.0 - np.mean(STRIPES**-2.0) / np.mean(STRIPES**-3.0)
    assert_allclose((across, along, carried), (0.4330127018922193, 1.375, carries), rtol=1e-11)
    assert is_open == (True, True)
    assert_allclose(through(STRIPES.T.copy())[:3], (1.375, 0.4330127018922193, 0.0), rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("lift", [1.5, 0.5])
def test_against_a_dense_solve(lift: float) -> None:
    """With cells that are closed, and such that no way leads away from."""
    gap = np.maximum(lift + rough(Grid(18, 14, 1.0), seed=3), 0.0)
    gap /= gap.mean()
    assert_allclose(through(gap)[:3], dense(gap), rtol=1e-8)


def test_a_turned_surface_swaps_along_and_across() -> None:
    gap = np.maximum(1.0 + rough(Grid(60, 45, 1.0), seed=2, shortest=6), 0.0)
    along, across, _, _ = through(gap)
    assert_allclose(through(np.rot90(gap).copy())[:2], (across, along), rtol=1e-9)


def test_low_waves() -> None:
    """1 − 3/2 (σ/h)² of waves of all directions: half of −6 (σ/h)² across them and of 3 (σ/h)² along them."""
    gaps = [1.0 + 0.01 * rough(Grid(96, 96, 1.0), seed=seed, shortest=16) for seed in range(8)]
    flows = np.array([through(gap / gap.mean())[:2] for gap in gaps]).mean(axis=1)
    spread = flows.std(ddof=1) / math.sqrt(len(flows))
    assert abs(flows.mean() - (1.0 - 1.5e-4)) < 3.0 * spread + 1e-6
    assert spread < 1e-5


@pytest.mark.parametrize("ratio", [6.0, 3.0, 2.0])
def test_isotropic_roughness(ratio: float) -> None:
    """Against 1 − 0.9 e^(−0.56 h/σ) within the scatter of surfaces, and 0.06 that the curve was drawn by."""
    factors = []
    for seed in range(6):
        gap = np.maximum(ratio + rough(Grid(128, 128, 1.0), seed=seed, shortest=8), 0.0)
        factors += [flow * (gap.mean() / ratio) ** 3 for flow in through(gap / gap.mean())[:2]]
    assert np.mean(factors) == pytest.approx(1.0 - 0.9 * math.exp(-0.56 * ratio), abs=0.06)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_leak_closes(seed: int) -> None:
    """Between 0.39 and 0.53 of the area in contact (Dapp and others 2012: 0.42)."""
    leaking, closed = pressed(0.02, seed=seed), pressed(0.031, seed=seed)
    assert 0.37 < leaking.area / leaking.nominal_area < 0.42
    assert 0.51 < closed.area / closed.nominal_area < 0.56
    assert leaking.flow_factors().along > 0.0
    assert leaking.leakage(1.0, viscosity=1.0, length=1.0) > 0.0
    factors = closed.flow_factors()
    assert (factors.along, factors.across, factors.shear) == (0.0, 0.0, pytest.approx(1.0))
    assert factors.is_open == (False, False)
    assert closed.leakage(1.0, viscosity=1.0, length=1.0) == 0.0


def test_ways_around() -> None:
    """A way may lead around more than once before it closes, or along one axis alone."""

    def of(*cells: tuple[slice | int, slice | int]) -> tuple[bool, bool]:
        is_open = np.zeros((12, 12), dtype=bool)
        for cell in cells:
            is_open[cell] = True
        return ways(is_open)[1]

    everywhere = slice(None)
    assert of((everywhere, everywhere)) == (True, True)
    assert of() == (False, False)
    assert of((slice(2, 11), slice(0, 12, 11))) == (False, False)
    assert of((3, everywhere)) == (False, True)
    assert of((everywhere, 3)) == (True, False)
    steps = np.arange(24)
    slope = ((steps % 12, steps // 2), (steps % 12, (steps + 1) // 2 % 12))
    assert of(*slope) == (True, True)


def test_a_strip_leaks() -> None:
    factors = FlowFactors(0.5, 0.25, 0.0, (True, True), mean_gap=2.0, nominal_gap=1.0)
    assert factors.nominal == (4.0, 2.0)
    assert factors.leakage(3.0, viscosity=2.0, length=5.0) == pytest.approx(0.5 * 8.0 * 3.0 / 120.0)
    assert factors.leakage(3.0, viscosity=2.0, length=5.0, axis=1) == pytest.approx(0.1 / 1.0 * 0.5)
    with pytest.raises(InputError, match="viscosity = 0 is not possible"):
        factors.leakage(3.0, viscosity=0.0, length=5.0)
    for axis in (2, -1, "x", np.arange(2)):
        with pytest.raises(InputError, match="is not possible; it must be 0 or 1"):
            factors.leakage(3.0, viscosity=2.0, length=5.0, axis=axis)  # type: ignore[arg-type]


def test_what_is_refused_and_told() -> None:
    heights = rough(Grid(32, 32, 1.0), shortest=2)
    free = warpwear.solve_contact(heights, cell=1.0, load=1.0, modulus=1.0, boundary="free")
    with pytest.raises(InputError, match="boundary = free is not possible for flow"):
        free.flow_factors()
    bearing = {"cell": 1.0, "hardness": 1.0, "mean_pressure": 0.2}
    heights = np.random.default_rng(1).normal(size=(32, 32))
    with pytest.warns(UserWarning, match="waves of fewer than 4 cells"):
        warpwear.solve_contact(heights, **bearing).flow_factors()
    under = warpwear.solve_contact(heights, **(bearing | {"mean_pressure": 0.01}), counter_radius=10.0)
    with pytest.raises(InputError, match="under a counter-body neither"):
        under.flow_factors()


def test_a_seam_is_no_short_wave() -> None:
    """Nor is the tilt that makes it; of waves of two cells along an axis the whole slope is."""
    x = np.arange(64.0)[:, np.newaxis]
    long = np.sin(2.0 * np.pi * x / 40.0) + 0.0 * x.T
    assert short_slope(long) < SHORT_SLOPE
    assert short_slope(long + 0.1 * x) < SHORT_SLOPE
    assert short_slope((-1.0) ** x + 0.0 * x.T) > 0.99
