"""The sphere's sag against closed forms."""

import math
from fractions import Fraction

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.laws.form import sag
from warpwear.surfaces.sphere import Sphere, fit_sphere, places


def test_is_the_closed_form_where_that_is_well_conditioned():
    x, y = np.array([0.0, 1.0, 1.8]), np.array([-2.0, 0.0, 2.4])
    expected = [[3.0 - math.sqrt(9.0 - a * a - b * b) for b in y] for a in x]
    np.testing.assert_allclose(sag(x, y, radius=3.0), expected, rtol=1e-14, atol=1e-15)


def test_keeps_its_digits_near_the_apex():
    # series r²/2R + r⁴/8R³ in exact fractions; R − √(R² − r²) in floats has lost every digit at r = 1e-9
    for r in (1e-9, 1e-6, 1e-4):
        squared = Fraction(r) ** 2
        exact = squared / 6 + squared**2 / (8 * 27)
        assert sag(np.array([r]), np.array([0.0]), radius=3.0)[0, 0] == pytest.approx(float(exact), rel=1e-14)


def test_depth_of_a_patch_is_equation_3_1():
    depth = sag(np.array([0.4]), np.array([0.0]), radius=3.0)[0, 0]
    assert depth == pytest.approx(3.0 - math.sqrt(9.0 - 0.16), rel=1e-13)


def test_beyond_the_edge_is_infinite_and_the_edge_is_the_radius():
    field = sag(np.array([0.0, 3.0, 3.1]), np.array([0.0, 0.5]), radius=3.0)
    assert field[1, 0] == 3.0
    assert np.isinf(field[[1, 2, 2], [1, 0, 1]]).all()
    assert not np.isnan(field).any()


def test_an_infinite_radius_is_flat():
    assert np.array_equal(sag(np.array([-5.0, 9.0]), np.array([1.0]), radius=math.inf), np.zeros((2, 1)))


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan])
def test_refuses_a_radius_that_is_not_positive(radius):
    with pytest.raises(InputError, match=r"counter\.radius"):
        sag(np.zeros(1), np.zeros(1), radius=radius)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("reach", [0.7, 0.875, 0.95, 0.99])
def test_a_sphere_is_fitted_nearly_to_its_equator(reach, side):
    """A parabola, from which the search begins, bends too much beyond 0.84 of the radius."""
    pixel = (0.8 * reach / 60,) * 2
    x, y = places((60, 60), pixel)
    heights = side * Sphere((0.01, -0.02, 0.1), 0.4).heights(x, y)
    heights[np.hypot.outer(x - 0.01, y + 0.02) > 0.4 * reach] = np.nan
    heights += 1e-4 * np.random.default_rng(0).normal(size=heights.shape)
    for given in (None, 0.4 * side):
        found = fit_sphere(heights, pixel=pixel, radius=given)
        assert found.radius == pytest.approx(0.4 * side, rel=3e-4)
        assert found.apex == pytest.approx((0.01, -0.02, 0.1 * side), abs=1e-4)
