"""Films and growing junctions: caps, shear strengths, and the fitted course of a bare fraction."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from warpwear.laws.courses import Breaking, fit_breaking
from warpwear.laws.film import grown_cap
from warpwear.study.sections.friction import Friction

FILM = {"thickness": "10 nm", "shear_strength": "40 MPa"}


def test_a_sheared_cap_meets_tabors_ellipse() -> None:
    for tau in (0.0, 40.0, 172.0):
        assert grown_cap(590.0, tau, 9.0) ** 2 + 9.0 * tau**2 == pytest.approx(590.0**2)
    assert grown_cap(590.0, 172.0, 0.0) == 590.0
    assert grown_cap(590.0, 590.0 / 3.0, 9.0) == pytest.approx(0.0, abs=1e-4)
    assert grown_cap(590.0, 500.0, 9.0) == 0.0
    assert grown_cap(math.inf, 172.0, 9.0) == math.inf


def test_friction_of_a_contact_that_is_bare_in_part() -> None:
    law = Friction(shear_strength="172 MPa", ploughing=0.02, film=FILM)
    history = {"distance": np.array([1.0, 2.0]), "area_contact": np.array([0.014, 0.02])}
    history["bare_fraction"] = np.array([0.0, 0.25])
    filmed, bare = history["area_contact"] * (1.0 - history["bare_fraction"]), np.array([0.0, 0.005])
    found = law.law_with().coefficient(history, load=8.0, finished=False)
    assert_allclose(found, 0.02 + (40.0 * filmed + 172.0 * bare) / 8.0, rtol=1e-14)


@pytest.mark.parametrize(("plateau", "start", "length"), [(0.85, 36.0, 89.0), (0.97, 1.0, 40.0)])
def test_a_course_is_fitted(plateau: float, start: float, length: float) -> None:
    distance = np.arange(15.0, 900.0, 30.0)
    exact = plateau * (1.0 - np.exp(-np.maximum(distance - start, 0.0) / length))
    noise = np.random.default_rng(1).normal(0.0, 0.005, distance.size)
    found = fit_breaking(distance, exact + noise)
    assert isinstance(found, Breaking)
    assert found.plateau == pytest.approx(plateau, rel=0.01)
    assert found.length == pytest.approx(length, rel=0.05)
    assert found.start == pytest.approx(start, abs=3.0)
    assert abs(found.length - length) < 4.0 * found.length_error
    assert found.rms == pytest.approx(0.005, rel=0.3)
    assert_allclose(found.at(distance), exact, atol=0.01)


@pytest.mark.parametrize("end", [300.0, 900.0, 2400.0])
def test_errors_of_a_fit_hold_a_plateau_that_creeps(end: float) -> None:
    """The length then depends on where the course ends, which its scatter does not show."""
    distance = np.arange(15.0, end, 30.0)
    rises = 0.81 * (1.0 - np.exp(-np.maximum(distance - 36.0, 0.0) / 85.0))
    fit = fit_breaking(distance, rises + 4e-5 * distance)
    assert isinstance(fit, Breaking)
    assert abs(fit.length - 85.0) < 3.0 * fit.length_error


def test_where_no_course_can_be_fitted_it_is_said_why() -> None:
    distance = np.arange(15.0, 900.0, 30.0)
    assert fit_breaking(distance[:5], 0.1 * distance[:5]) == "the course has 5 places, where 6 are needed"
    assert fit_breaking(distance, np.zeros(distance.size)) == "no cell is bare"
    assert "first of the course" in str(fit_breaking(distance, np.full(distance.size, 0.9)))
    assert "plateau" in str(fit_breaking(distance, 1e-4 * distance))  # it goes on as it began
    noise = np.random.default_rng(1).uniform(0.0, 1.0, distance.size)
    assert "plateau" in str(fit_breaking(distance, noise))
