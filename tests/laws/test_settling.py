"""Roughness that settles: a synthetic exponential course, and courses that tell nothing."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from warpwear.laws.courses import Settling, fit_settling

PLACES = np.array([0.0, 30.0, 90.0, 150.0, 240.0, 480.0, 900.0])


@pytest.mark.parametrize(("equilibrium", "initial", "length"), [(0.53, 0.0, 30.0), (1.6, 3.6, 150.0)])
def test_constants_of_a_course_are_found(equilibrium: float, initial: float, length: float) -> None:
    course = equilibrium + (initial - equilibrium) * np.exp(-PLACES / length)
    fit = fit_settling(PLACES, course)
    assert isinstance(fit, Settling)
    assert (fit.equilibrium, fit.length) == pytest.approx((equilibrium, length), rel=1e-5)
    assert fit.initial == pytest.approx(initial, abs=1e-5)
    assert fit.rms < 1e-6
    assert_allclose(fit.at(PLACES), course, atol=1e-6)
    # Those that are not known are left out.
    holes = fit_settling(np.append(PLACES, 1200.0), np.append(course, np.nan))
    assert isinstance(holes, Settling)
    assert holes.length == pytest.approx(length, rel=1e-5)


def test_errors_cover_the_scatter() -> None:
    """Of 200 noisy courses two thirds of the constants lie within one standard error, nearly all in three."""
    draw, off = np.random.default_rng(1), []
    places = np.linspace(0.0, 600.0, 25)
    for _ in range(200):
        noisy = 1.6 + 2.0 * np.exp(-places / 120.0) + 0.05 * draw.normal(size=places.size)
        fit = fit_settling(places, noisy)
        assert isinstance(fit, Settling)
        off.append(((fit.equilibrium - 1.6) / fit.equilibrium_error, (fit.length - 120.0) / fit.length_error))
    within = [(np.abs(off) < errors).mean() for errors in (1.0, 3.0)]
    assert 0.55 < within[0] < 0.8
    assert within[1] > 0.97


@pytest.mark.parametrize(
    ("places", "course", "why"),
    [
        (PLACES[:5], np.exp(-PLACES[:5]), "5 places, where 6 are needed"),
        (PLACES, np.full(7, 0.3), "hardly changes"),
        (PLACES, np.zeros(7), "hardly changes"),
        (PLACES, 1.0 + PLACES, "too short to level off"),
        (PLACES, np.array([1.0, 2.0, 0.5, 2.5, 0.7, 2.2, 1.1]), "too s"),
        (PLACES, np.full(7, np.nan), "0 places"),
        (PLACES, np.array([3.0, 1.0, 1.02, 1.0, 1.02, 1.01, 1.02]), "before its second place"),
    ],
)
def test_a_course_that_tells_nothing_says_why(places: np.ndarray, course: np.ndarray, why: str) -> None:
    fit = fit_settling(places, course)
    assert isinstance(fit, str)
    assert why in fit
