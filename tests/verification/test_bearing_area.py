"""Bearing area, c = 0: the lowest cells carry H each (thesis eqs 4.8–4.11)."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from thesis import F, H, K, R, cap, smooth

from warpwear import run
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.models.rest.local import OneScaleModel


@pytest.mark.parametrize(("cell", "below", "touching"), [(10, 124, 140), (5, 540, 548), (2, 3388, 3396)])
def test_smooth_counter_shares_the_tied_orbit(cell: int, below: int, touching: int, device: str) -> None:
    """δ ≈ F/(2πRH) = 0.719 µm within one orbit; F/H is never a whole number of orbits, so one is shared."""
    result = run(
        smooth(
            contact__hardness=f"{H} MPa",
            grid__cell=f"{cell} um",
            grid__extent="0.3 mm",
            sliding__distance="0 mm",
        ),
        device=device,
        plots=False,
    )
    h2 = (1.0e-3 * cell) ** 2
    # Squared distances from the apex in units of (h/2)²: whole numbers, so these ties are exact.
    odd = 2 * np.arange(-result.x.size // 2, result.x.size // 2) + 1
    squared = odd[:, None] ** 2 + odd[None, :] ** 2
    orbit = np.sort(squared, axis=None)[int(F / H / h2)]
    assert np.count_nonzero(squared < orbit) == below
    assert np.count_nonzero(squared <= orbit) == touching

    pressure = result.snapshot(0).pressure
    share = (F / H / h2 - below) / (touching - below)
    assert_allclose(pressure, H * ((squared < orbit) + share * (squared == orbit)), rtol=1e-12)
    row = {name: values[0] for name, values in result.history.items()}
    assert row["cells_in_contact"] == touching
    assert row["area_contact"] == pytest.approx(touching * h2, rel=1e-12)
    assert row["area_plastic"] == pytest.approx(below * h2, rel=1e-12)
    assert abs(row["load_residual"]) <= 1e-12 * F
    radius2 = orbit * h2 / 4.0
    assert row["approach"] == pytest.approx(radius2 / (R + math.sqrt(R**2 - radius2)), abs=1e-12)
    assert abs(2.0 * math.pi * R * row["approach"] - F / H) <= (touching - below) * h2


def test_symmetry_survives_wear(device: str) -> None:
    """300 mm of explicit wear leave gaps that should be equal 1e-17 mm apart: orbits must stay whole.

    With `==` for ties the touched area ends at 0.067 mm², not at the worn cap's 0.44 mm².
    """
    study = smooth(
        contact__hardness=f"{H} MPa",
        grid__extent="1 mm",
        sliding__distance="300 mm",
        stepping__scheme="explicit",
        stepping__increment="0.3 mm",
    )
    grid = study.cells
    needed = F / H / grid.cell_area
    with Executor(grid, device=device) as executor:
        model = OneScaleModel(study.contact_task, np.zeros(grid.shape), executor)
        for _ in range(1000):
            step = model.advance(0.3, with_pressure=True)
            pressure = step.pressure
            assert pressure is not None
            for mirrored in (pressure[::-1], pressure[:, ::-1], pressure.T):
                assert (np.abs(mirrored - pressure) <= 1e-9 * pressure).all()
            assert np.count_nonzero(pressure >= H) <= needed <= np.count_nonzero(pressure)
            assert_allclose(pressure.sum() * grid.cell_area, F, rtol=1e-12)
    worn = model.worn_depths()[1]
    assert_allclose(worn, worn.T, atol=1e-12)
    radius = cap(K * F * 300.0)[1]
    assert step.row["area_touched"] == pytest.approx(
        math.pi * radius**2, abs=2 * math.pi * radius * grid.cell
    )
    assert step.row["wear_volume_disc"] + step.row["wear_volume_counter"] == pytest.approx(K * F * 300.0)


def test_orbits_are_worn_in_turns(device: str) -> None:
    """What lies lowest is worn beyond what is listed of the last step; the next orbit lies outside of it."""
    study = smooth(
        contact__hardness=f"{H} MPa",
        contact__load="0.5 N",
        wear__disc="0 mm^3/N/m",
        grid__cell="5 um",
        grid__extent="0.24 mm",
        sliding__distance="6 mm",
        stepping={"scheme": "explicit", "increment": "0.1 mm"},
    )
    history = run(study, device=device).history
    assert np.abs(history["load_residual"]).max() < study.load_tolerance
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 0.5 * 6.0, rel=1e-10)


def rigid_flat(heights: FloatArray, fraction: float, device: str) -> Step:
    """A rigid flat pressed on the heights until it bears on this fraction of the area."""
    grid = Grid(*heights.shape, 0.01)
    study = smooth(
        counter__radius="inf mm",
        contact__hardness=f"{H} MPa",
        contact__load=f"{fraction * H * grid.area} N",
        grid__extent=f"{0.01 * math.isqrt(grid.cells)} mm",
        sliding__distance="0 mm",
    )
    with Executor(grid, device=device) as executor:
        return OneScaleModel(study.contact_task, heights, executor).advance(0.0, with_pressure=True)


@pytest.mark.parametrize("level", [2.0, 1.0, 0.0, -1.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_gaussian_heights(level: float, seed: int, device: str) -> None:
    """A/A0 = ½ erfc(d/σ√2), 0.1587 at d = σ, within four standard deviations of the sample; p = H."""
    sigma = 3.0e-3
    heights = sigma * np.random.default_rng(seed).standard_normal((400, 400))
    fraction = 0.5 * math.erfc(level / math.sqrt(2.0))
    step = rigid_flat(heights, fraction, device)
    area = step.row["area_contact"] / (heights.size * 0.01**2)
    d = -step.row["approach"]
    expected = 0.5 * math.erfc(d / (sigma * math.sqrt(2.0)))
    assert area == pytest.approx(fraction, abs=1.0 / heights.size)
    assert area == pytest.approx(expected, abs=4.0 * math.sqrt(fraction * (1.0 - fraction) / heights.size))
    assert_array_equal(step.pressure > 0.0, heights > d)
    assert step.row["pressure_mean"] == pytest.approx(H, rel=1e-3)


@pytest.mark.parametrize("fraction", [0.1, 0.3, 0.5, 0.8])
def test_sine(fraction: float, device: str) -> None:
    """A/A0 = arccos(d/Δ)/π, 0.5 at d = 0, within one cell of the wavelength."""
    amplitude, cells = 2.0e-3, 400
    x = (np.arange(cells) + 0.3) / cells
    heights = np.repeat(amplitude * np.cos(2.0 * math.pi * x)[:, None], 25, axis=1)
    step = rigid_flat(heights, fraction, device)
    area = step.row["area_contact"] / (heights.size * 0.01**2)
    d = -step.row["approach"]
    assert area == pytest.approx(math.acos(d / amplitude) / math.pi, abs=1.0 / cells)
    assert area == pytest.approx(fraction, abs=1.0 / cells)
    assert step.row["pressure_max"] == pytest.approx(H, rel=2.0 / cells)
    assert step.row["pressure_mean"] * step.row["area_contact"] == pytest.approx(
        fraction * H * heights.size * 0.01**2, rel=1e-12
    )
