"""Levelling and filling."""

import numpy as np
import pytest

from warpwear.surfaces.filling import filled
from warpwear.surfaces.levelling import without_polynomial


@pytest.fixture
def rough():
    return np.random.default_rng(0).normal(size=(130, 90))


def test_a_plane_on_a_large_offset_is_taken_off_exactly():
    tilt = 76.0 + np.add.outer(0.01 * np.arange(200), -0.03 * np.arange(150))
    assert np.abs(without_polynomial(tilt, degree=1)).max() < 1e-13


def test_plane_is_that_of_least_squares_on_valid_points(rough):
    rough = rough + np.add.outer(0.1 * np.arange(130), 0.2 * np.arange(90))
    rough[20:60, 10:70] = np.nan
    valid = ~np.isnan(rough)
    i, j = np.nonzero(valid)
    design = np.stack([np.ones(i.size), i, j], axis=1)
    expected = rough[valid] - design @ np.linalg.lstsq(design, rough[valid], rcond=None)[0]
    levelled = without_polynomial(rough, degree=1)
    np.testing.assert_allclose(levelled[valid], expected, rtol=0, atol=1e-10)
    assert np.array_equal(np.isnan(levelled), ~valid)


def test_a_high_degree_stays_accurate_with_much_missing():
    # without the second round of the fit this leaves 6e-10
    tilt = 76.0 + np.add.outer(0.01 * np.arange(400), 0.02 * np.arange(320))
    tilt[:160, :120] = np.nan
    assert np.nanmax(np.abs(without_polynomial(tilt, degree=12))) < 5e-13


@pytest.mark.parametrize("degree", [2, 5, 12])
def test_polynomials_up_to_the_degree_go_and_higher_ones_stay(degree):
    x, y = np.linspace(-1, 1, 80), np.linspace(-1, 1, 70)
    inside = np.multiply.outer(x ** (degree - 1), y)
    assert np.abs(without_polynomial(inside, degree=degree)).max() < 1e-12
    beyond = np.multiply.outer(x ** (degree + 1), np.ones(70))
    assert np.abs(without_polynomial(beyond, degree=degree)).max() > 1e-5


def test_degree_zero_takes_off_the_mean_only(rough):
    np.testing.assert_allclose(without_polynomial(rough, degree=0), rough - rough.mean(), atol=1e-14)


def test_filling_leaves_the_valid_points_and_stays_within_them(rough):
    missing = np.random.default_rng(1).random(rough.shape) < 0.3
    missing[40:90, 30:80] = True
    complete = filled(np.where(missing, np.nan, rough))
    assert np.array_equal(complete[~missing], rough[~missing])
    assert not np.isnan(complete).any()
    assert complete[missing].max() <= rough[~missing].max()
    assert complete[missing].min() >= rough[~missing].min()


def test_filling_continues_a_smooth_surface():
    x = np.linspace(0, 1, 200)
    smooth = np.add.outer(np.sin(2 * x), 0.5 * x)
    missing = np.random.default_rng(2).random(smooth.shape) < 0.3
    missing[60:100, 80:120] = True
    complete = filled(np.where(missing, np.nan, smooth))
    assert np.abs(complete - smooth).max() < 0.02 * np.ptp(smooth)


@pytest.mark.parametrize("shape", [(2, 2), (3, 5), (7, 2), (1, 9)])
def test_one_valid_point_fills_everything(shape):
    heights = np.full(shape, np.nan)
    heights[-1, -1] = 4.0
    np.testing.assert_allclose(filled(heights), 4.0, rtol=1e-15)


def test_nothing_missing_nothing_done(rough):
    assert filled(rough) is rough
