"""Roughness parameters against closed forms."""

import math

import numpy as np
import pytest

from warpwear.surfaces.roughness import rms_slope, roughness


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
