"""A smooth ball that wears into a smooth disc, stationary (the thesis's V1 and V2)."""

import math
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from thesis import K_COUNTER, K_DISC, F, K, L, R, cap, patch_radius, smooth

from warpwear import Result, run
from warpwear.results.track import shape_of_growth

CELL = 0.01


@cache
def worn(device: str, factor: str = "none", disc: str = "12.7e-4 mm^3/N/m") -> Result:
    """2400 mm on 10 µm cells."""
    study = smooth(wear__distance_factor=factor, wear__disc=disc)
    return run(study, device=device, plots=False)


def test_closed_forms_are_the_published_numbers() -> None:
    """2a = 1.269 mm and 1.025 mm; depths 28.5 and 38.6 µm."""
    a = patch_radius(K, L)
    assert 2.0 * a == pytest.approx(1.269, abs=5e-4)
    assert 2.0 * patch_radius(K_COUNTER, L) == pytest.approx(1.025, abs=5e-4)
    assert K_COUNTER / K * a**2 / (2.0 * R) == pytest.approx(28.5e-3, rel=5e-3)
    assert K_DISC / K * a**2 / (2.0 * R) == pytest.approx(38.6e-3, rel=5e-3)
    assert math.isclose(K_COUNTER * F * L, 0.018048)
    assert math.isclose(K_DISC * F * L, 0.024384)


@pytest.mark.parametrize(
    ("disc", "coefficient", "diameter"), [("12.7e-4 mm^3/N/m", K, 1.269), ("0 mm^3/N/m", K_COUNTER, 1.025)]
)
def test_patch(disc: str, coefficient: float, diameter: float, device: str) -> None:
    """2a = 2 (4RKFL/π)^¼ within one cell; the area within one ring of cells; a uniform pressure F/A."""
    result = worn(device, disc=disc)
    history = result.history
    assert history["patch_along"][-1] == pytest.approx(diameter, abs=CELL)
    assert history["patch_across"][-1] == pytest.approx(diameter, abs=CELL)
    radius = cap(coefficient * F * L)[1]
    # A closed form of the counter-body itself: a paraboloid is 0.7 % off in the area.
    assert history["area_contact"][-1] == pytest.approx(math.pi * radius**2, rel=2e-3)
    assert history["pressure_mean"][-1] == pytest.approx(F / (math.pi * radius**2), rel=2e-3)
    pressure = result.snapshot(-1).pressure
    r = np.hypot(result.x[:, None], result.y[None, :])
    inside = pressure[r < radius - 2.0 * CELL]
    assert np.ptp(inside) <= 1e-9 * inside.mean()
    assert inside.mean() == pytest.approx(F / (math.pi * radius**2), rel=0.01)
    assert not pressure[r > radius + CELL].any()


def test_depths_and_volumes(device: str) -> None:
    """28.5 and 38.6 µm within 1 %; K F L to 1e-10 at every step."""
    history = worn(device).history
    assert history["wear_depth_counter"][-1] == pytest.approx(28.5e-3, rel=0.01)
    assert history["wear_depth_disc"][-1] == pytest.approx(38.6e-3, rel=0.01)
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], K_DISC * F * history["distance"], rtol=1e-10)


def test_area_grows_with_the_root_of_the_distance(device: str) -> None:
    """A = π a² ∝ √L: an exponent of 0.5 and a levelling of (√1 − √½)/½ over (√0.1 − √0.0125)/0.0875."""
    history = worn(device).history
    shape = shape_of_growth(history["distance"], history["area_contact"])
    late = (1.0 - math.sqrt(0.5)) / 0.5
    early = (math.sqrt(0.1) - math.sqrt(0.0125)) / 0.0875
    assert shape["exponent_m"] == pytest.approx(0.5, abs=0.01)
    assert shape["levelling_lambda"] == pytest.approx(late / early, rel=0.03)


@pytest.mark.parametrize(("factor", "points"), [("across", -0.37), ("radial", -0.75)])
def test_disc_volume_with_the_distance_factor(factor: str, points: float, device: str) -> None:
    """1 − (2/3) a²/8R² across, twice that radially (eq 4.22), to 0.05 points; the counter-body loses K F L.

    All cells of the patch recede alike, (K_counter + K_disc cos θ) p = const, so the pressure rises outwards.
    """
    result = worn(device, factor=factor)
    history = result.history
    loss = 100.0 * (history["wear_volume_disc"][-1] / (K_DISC * F * L) - 1.0)
    assert loss == pytest.approx(points, abs=0.05)
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], history["archard_volume_disc"], rtol=1e-10)
    radius = cap(K * F * L)[1]
    assert history["area_contact"][-1] == pytest.approx(math.pi * radius**2, rel=5e-3)
    d2 = result.y[None, :] ** 2 + (result.x[:, None] ** 2 if factor == "radial" else 0.0)
    pressure = result.snapshot(-1).pressure
    recession = (K_COUNTER + K_DISC * np.sqrt(1.0 - d2 / R**2)) * pressure
    inside = recession[np.hypot(result.x[:, None], result.y[None, :]) < radius - 3.0 * CELL]
    assert np.ptp(inside) <= 1e-9 * inside.mean()
