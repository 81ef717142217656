"""The bearing area curve against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.roughness import bearing_parameters, material_ratio_curve, roughness


def gaussian():
    """Sk, Spk and Smr1 of Gaussian heights of Sq 1: the line of least squares through 30 to 70 %."""
    moment = quad(lambda m: (m - 0.5) * norm.isf(m), 0.3, 0.7)[0]
    sk = -moment / (0.4**3 / 12.0)
    smr1 = norm.sf(sk / 2.0)
    area = quad(lambda z: norm.sf(z), sk / 2.0, np.inf)[0]
    return sk, 2.0 * area / smr1, 100.0 * smr1


def test_gaussian_heights():
    sk, spk, smr1 = gaussian()
    assert sk == pytest.approx(2.574, abs=0.001)
    found = bearing_parameters(norm.isf((np.arange(400_000) + 0.5) / 400_000))
    assert found.sk == pytest.approx(sk, rel=1e-4)
    assert found.spk == pytest.approx(spk, rel=1e-3)
    assert found.svk == pytest.approx(spk, rel=1e-3)
    assert found.smr1 == pytest.approx(smr1, rel=1e-3)
    assert found.smr2 == pytest.approx(100 - smr1, rel=1e-3)


def test_a_gaussian_surface_within_its_sampling_error():
    sk, spk, smr1 = gaussian()
    points = np.arange(500) * 0.004
    heights = SelfAffine(sq=0.003).heights(points, points)
    found, sq = bearing_parameters(heights), roughness(heights, pixel=(0.004, 0.004))["sq"]
    # some 2000 independent waves: 2 % of scatter
    assert found.sk / sq == pytest.approx(sk, rel=0.03)
    assert found.spk / sq == pytest.approx(spk, rel=0.06)
    assert found.smr1 == pytest.approx(smr1, rel=0.06)


def test_a_triangle_is_all_core():
    triangle = np.abs((np.arange(20_000) / 1000 + 0.0005) % 2 - 1)
    found = bearing_parameters(triangle)
    assert found.sk == pytest.approx(1.0, rel=1e-3)
    assert found.spk == pytest.approx(0.0, abs=1e-3)
    assert found.svk == pytest.approx(0.0, abs=1e-3)
    assert found.smr1 == pytest.approx(0.0, abs=0.1)
    assert found.smr2 == pytest.approx(100.0, abs=0.1)


def test_plateau_with_valleys_and_the_same_turned_over():
    # 70 % at heights 0 to 1 evenly, 30 % down to −10 evenly
    heights = np.concatenate([np.linspace(0, 1, 70_000), np.linspace(-10, 0, 30_000)])
    found = bearing_parameters(heights)
    assert found.sk == pytest.approx(1 / 0.7, rel=1e-3)
    assert found.spk == pytest.approx(0.0, abs=1e-3)
    # the line ends at 1 − 1/0.7; the valley below it is a triangle already
    assert found.svk == pytest.approx(10 + (1 - 1 / 0.7), rel=2e-3)
    turned = bearing_parameters(-heights)
    assert turned.sk == pytest.approx(found.sk, rel=1e-6)
    assert turned.spk == pytest.approx(found.svk, rel=1e-6)
    assert turned.smr1 == pytest.approx(100 - found.smr2, rel=1e-6)


def test_the_curve_of_a_sine():
    sine = np.cos(np.pi * (np.arange(100_000) + 0.5) / 100_000)
    ratio, height = material_ratio_curve(sine[:, None])
    np.testing.assert_allclose(height, np.cos(np.pi * ratio / 100), atol=1e-4)


def test_flat_heights():
    found = bearing_parameters(np.zeros((10, 10)))
    assert (found.sk, found.spk, found.svk) == (0.0, 0.0, 0.0)


def test_against_surfalize():
    surfalize = pytest.importorskip("surfalize")
    points = np.arange(400) * 0.004
    heights = SelfAffine(sq=0.003).heights(points, points)
    other = surfalize.Surface(1e3 * heights, 4.0, 4.0)
    found = bearing_parameters(heights)
    for name in ("Sk", "Spk", "Svk", "Smr1", "Smr2"):
        scale = 1.0 if name.startswith("Smr") else 1e3
        assert scale * getattr(found, name.lower()) == pytest.approx(getattr(other, name)(), rel=0.005)
    ours = roughness(heights, pixel=(0.004, 0.004))
    for name in ("Sa", "Sq", "Sz", "Ssk", "Sku"):
        scale = 1e3 if name in ("Sa", "Sq", "Sz") else 1.0
        assert scale * ours[name.lower()] == pytest.approx(getattr(other, name)(), rel=0.005, abs=1e-3)
