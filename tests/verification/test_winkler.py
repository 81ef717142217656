"""A ball on a Winkler foundation (thesis eqs 4.1–4.7): π K_N δ² (R − δ/3) = F."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from thesis import F, R, observed_order, smooth

from warpwear import run

K_N = 1.856e6  # [N/mm³]


def approach_of_paraboloid() -> float:
    """π K_N R δ² = F."""
    return math.sqrt(F / (math.pi * K_N * R))


def approach_of_counter() -> float:
    """π K_N δ² (R − δ/3) = F."""
    approach = approach_of_paraboloid()
    for _ in range(50):
        approach = math.sqrt(F / (math.pi * K_N * (R - approach / 3.0)))
    return approach


def relative_errors(cell: float, device: str) -> tuple[float, float, float]:
    """Of the approach, the area π a² and the peak pressure K_N δ, in a static contact. cell: [µm]."""
    study = smooth(
        contact__stiffness=f"{K_N} N/mm^3",
        grid__cell=f"{cell} um",
        grid__extent="0.16 mm",
        sliding__distance="0 mm",
    )
    history = run(study, device=device, plots=False).history
    delta = approach_of_counter()
    area = math.pi * (2.0 * R * delta - delta**2)
    assert_allclose(history["pressure_mean"] * history["area_contact"], F, rtol=1e-12)
    return (
        float(history["approach"][0] / delta - 1.0),
        float(history["area_contact"][0] / area - 1.0),
        float(history["pressure_max"][0] / (K_N * delta) - 1.0),
    )


def test_closed_forms_are_the_published_numbers() -> None:
    """δ = 0.67627 µm (paraboloid) and 0.67630 µm (counter-body)."""
    assert approach_of_paraboloid() == pytest.approx(0.67627e-3, abs=5e-9)
    assert approach_of_counter() == pytest.approx(0.67630e-3, abs=5e-9)


def test_approach_area_and_peak_pressure(device: str) -> None:
    """1 µm cells: all three within 1e-3 of the counter-body's closed form."""
    assert_allclose(relative_errors(1.0, device), 0.0, atol=1e-3)


def test_fine_cells_tell_a_counter_from_a_paraboloid(device: str) -> None:
    """The two differ by 4e-5 in δ, which 0.5 µm cells resolve."""
    of_paraboloid = approach_of_paraboloid() / approach_of_counter() - 1.0
    assert abs(relative_errors(0.5, device)[0]) < 0.1 * abs(of_paraboloid)


def test_observed_order_of_convergence(device: str) -> None:
    """Second order in the peak pressure, at least 1.5 in δ, at least 1 in the area (cells are counted)."""
    cells = [8.0, 4.0, 2.0, 1.0, 0.5]
    approach, area, peak = np.transpose([relative_errors(cell, device) for cell in cells]).tolist()
    assert observed_order(cells, peak) == pytest.approx(2.0, abs=0.1)
    assert observed_order(cells, approach) > 1.5
    assert observed_order(cells, area) > 1.0


def test_pressure_field(device: str) -> None:
    """p(r) = K_N (δ − r²/2R) cell by cell, within 1e-3 of the peak."""
    study = smooth(
        contact__stiffness=f"{K_N} N/mm^3",
        grid__cell="1 um",
        grid__extent="0.16 mm",
        sliding__distance="0 mm",
    )
    result = run(study, device=device, plots=False)
    r2 = result.x[:, None] ** 2 + result.y[None, :] ** 2
    expected = K_N * np.maximum(approach_of_counter() - r2 / (2.0 * R), 0.0)
    assert_allclose(result.snapshot(0).pressure, expected, atol=1e-3 * expected.max())
