"""Roughness parameters against closed forms."""

import math

import numpy as np
import pytest

from warpwear.surfaces.roughness import (
    developed_area,
    height_parameters,
    profile_roughness,
    rms_slope,
    roughness,
)


def test_of_a_sine():
    n, amplitude = 4000, 0.002
    x = np.arange(n) / n
    found = roughness(
        np.repeat(amplitude * np.sin(2 * np.pi * x)[:, None], 3, axis=1) + 7.0, pixel=(1 / n, 1.0)
    )
    assert found["sa"] == pytest.approx(amplitude * 2 / math.pi, rel=1e-6)
    assert found["sq"] == pytest.approx(amplitude / math.sqrt(2), rel=1e-9)
    assert found["sz"] == pytest.approx(2 * amplitude, rel=1e-6)
    assert found["ssk"] == pytest.approx(0.0, abs=1e-6)
    assert found["sku"] == pytest.approx(1.5, rel=1e-6)
    assert found["rms_slope"] == pytest.approx(2 * math.pi * amplitude / math.sqrt(2), rel=1e-3)


def test_the_developed_area_of_a_tilt():
    """√(1 + a² + b²) − 1, for small slopes too, and where a point is missing."""
    x, y = np.meshgrid(np.arange(30) * 0.5, np.arange(20) * 0.25, indexing="ij")
    for a, b in ((0.75, 1.0), (3e-5, 4e-5)):
        tilted = a * x + b * y
        tilted[4, 5] = np.nan
        exact = (a**2 + b**2) / (math.sqrt(1.0 + a**2 + b**2) + 1.0)
        assert developed_area(tilted, pixel=(0.5, 0.25)) == pytest.approx(exact, rel=1e-6)
    assert developed_area(np.zeros((1, 5)), pixel=(1.0, 1.0)) == 0.0


def test_of_exponential_heights_has_the_sign_of_the_skewness():
    heights = np.random.default_rng(0).exponential(size=(1000, 1000))
    found = roughness(heights, pixel=(1.0, 1.0))
    assert found["ssk"] == pytest.approx(2.0, rel=0.02)
    assert found["sku"] == pytest.approx(9.0, rel=0.05)


def test_slope_of_a_tilt_uses_each_axis_own_pixel():
    tilt = np.add.outer(0.3 * 2.0 * np.arange(5), 0.4 * 0.5 * np.arange(7))
    assert rms_slope(tilt, pixel=(2.0, 0.5)) == pytest.approx(0.5, rel=1e-12)
    assert rms_slope(tilt[:, :1], pixel=(2.0, 0.5)) == pytest.approx(0.3, rel=1e-12)


def test_a_flat_has_no_nan():
    assert set(roughness(np.full((4, 4), 2.0), pixel=(1.0, 1.0)).values()) == {0.0}


@pytest.mark.parametrize("factor", [1e-90, 1e90])
def test_heights_of_any_size_have_a_kurtosis(factor):
    """Its fourth powers, of a damaged file, were beyond what a number holds."""
    heights = np.random.default_rng(0).normal(size=(40, 40))
    one, other = height_parameters(heights), height_parameters(factor * heights)
    assert [other[name] for name in ("ssk", "sku")] == pytest.approx([one["ssk"], one["sku"]])


def test_a_field_shorter_than_the_filters_has_no_ra():
    """Of an AFM's field a wave of λs is longer than the field: what it left, 0.003 nm, was no roughness."""
    heights = 4e-6 * np.random.default_rng(0).normal(size=(64, 64))
    for pixel in (1e-6, 3e-5, 1.9e-4):  # mm: fields of 0.064, 2 and 12 µm
        found = profile_roughness(heights, pixel=(pixel, pixel), axis=0, cut_off=2.5, short=0.008)
        assert found.ra is None
        assert "no Ra: profiles of" in found.notes[0]
        assert not any("reduced" in note for note in found.notes)
    found = profile_roughness(heights, pixel=(3e-5, 3e-5), axis=0, cut_off=2.5, short=1e-4)
    assert found.short == 1e-4
    assert found.ra is not None
