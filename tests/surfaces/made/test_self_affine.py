"""The self-affine surface: one surface for every mesh, with the spectrum and the roughness asked for."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.made.fourier import half_plane_draws
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.made.synthetic import Flat
from warpwear.surfaces.roughness import rms_slope, roughness

PERIOD = 2.0  # mm
CUT_OFF = 0.008  # mm
PINNED = [0.00865286921888097, 0.005101489513130521]  # mm


def over_the_period(surface, count):
    points = np.arange(count) * (surface.period / count)
    return surface.heights(points, points)


def spectrum(surface, count=600):
    """Amplitude of every mode and its radius in whole waves a period."""
    waves = np.fft.fft2(over_the_period(surface, count)) / count**2
    mode = np.fft.fftfreq(count, 1 / count)
    return waves, np.hypot(*np.meshgrid(mode, mode, indexing="ij"))


@pytest.fixture(scope="module")
def surface():
    return SelfAffine(ra=0.003)


def test_is_the_same_at_any_cell_size(surface):
    start, width = -0.5, 1.0
    coarse = start + 0.01 * np.arange(100)
    expected = surface.heights(coarse, coarse)
    assert np.ptp(expected) > 0.01
    for cell in (0.005, 0.002, 0.001):
        fine = start + cell * np.arange(round(width / cell))
        every = round(0.01 / cell)
        found = surface.heights(fine, fine)[::every, ::every]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_is_the_same_in_any_window_and_block(surface):
    x, y = np.linspace(-0.3, 0.4, 701), np.linspace(0.1, 0.2, 11)
    whole = surface.heights(x, y)
    np.testing.assert_allclose(surface.heights(x[333:334], y[4:6]), whole[333:334, 4:6], rtol=0, atol=1e-14)


def test_is_the_plain_sum_of_its_waves():
    surface = SelfAffine(sq=0.001, roll_off=0.5, cut_off=0.3, period=2.0, seed=4)
    x, y = 0.37, -0.61
    waves, _ = spectrum(surface, 32)
    mode = np.fft.fftfreq(32, 1 / 32)
    phase = 2 * np.pi / surface.period * np.add.outer(mode * x, mode * y)
    expected = np.sum(waves * np.exp(1j * phase)).real
    assert surface.heights(np.array([x]), np.array([y]))[0, 0] == pytest.approx(expected, rel=1e-11)


def test_has_nothing_beyond_the_cut_off_nor_a_mean(surface):
    waves, radius = spectrum(surface)
    largest = np.abs(waves).max()
    assert np.abs(waves[radius > PERIOD / CUT_OFF]).max() < 1e-12 * largest
    assert abs(waves[0, 0]) < 1e-12 * largest
    inside = (radius > 0) & (radius <= PERIOD / CUT_OFF)
    assert np.count_nonzero(np.abs(waves[inside]) > 1e-9 * largest) > 0.999 * np.count_nonzero(inside)


def test_has_exactly_the_sq_asked():
    surface = SelfAffine(sq=0.0025, seed=3)
    assert math.sqrt(np.mean(over_the_period(surface, 640) ** 2)) == pytest.approx(0.0025, rel=1e-12)
    assert surface.record()["sq_um"] == pytest.approx(2.5, rel=1e-12)


def test_has_exactly_the_ra_asked(surface):
    assert np.mean(np.abs(over_the_period(surface, 1000))) == pytest.approx(0.003, rel=1e-12)
    # another grid sees the same mean, to quadrature
    assert np.mean(np.abs(over_the_period(surface, 770))) == pytest.approx(0.003, rel=1e-3)


@pytest.mark.parametrize("hurst", [0.8, 0.5])
def test_spectrum_has_the_slope_and_the_plateau(hurst):
    surface = SelfAffine(sq=0.003, hurst=hurst, seed=1)
    waves, radius = spectrum(surface)
    roll_off = PERIOD / surface.roll_off
    rings = np.geomspace(1.5 * roll_off, 0.98 * PERIOD / CUT_OFF, 12)
    band = [(radius >= low) & (radius < high) for low, high in pairwise(rings)]
    power = [np.mean(np.abs(waves[ring]) ** 2) for ring in band]
    middle = [np.exp(np.mean(np.log(radius[ring]))) for ring in band]
    fitted = np.polyfit(np.log(middle), np.log(power), 1)[0]
    assert fitted == pytest.approx(-2 - 2 * hurst, abs=0.05)
    inner = np.mean(np.abs(waves[(radius > 0) & (radius < 0.6 * roll_off)]) ** 2)
    outer = np.mean(np.abs(waves[(radius > 0.6 * roll_off) & (radius < roll_off)]) ** 2)
    assert inner / outer == pytest.approx(1.0, abs=0.2)


def test_rms_slope_is_that_of_the_heights(surface):
    waves, radius = spectrum(surface)
    sampled = math.sqrt(np.sum(np.abs(waves) ** 2 * (2 * np.pi / PERIOD * radius) ** 2))
    assert surface.rms_slope == pytest.approx(sampled, rel=1e-11)


def test_rms_slope_of_the_reference_surface(surface):
    """Ra 3 µm, roll-off 100 µm, cut-off 8 µm: 0.48, seen as 0.36 by differences over 10 µm."""
    assert surface.rms_slope == pytest.approx(0.48, abs=0.01)
    found = {}
    for cell in (0.01, 0.0025, 0.001):
        points = np.arange(round(1.0 / cell)) * cell
        found[cell] = rms_slope(surface.heights(points, points), pixel=(cell, cell))
    assert found[0.01] == pytest.approx(0.36, abs=0.01)
    assert found[0.0025] == pytest.approx(surface.rms_slope, rel=0.05)
    assert found[0.001] == pytest.approx(surface.rms_slope, rel=0.02)


def test_seeds_reproduce_and_differ(surface):
    points = np.linspace(-0.1, 0.1, 21)
    again = SelfAffine(ra=0.003).heights(points, points)
    assert np.array_equal(again, surface.heights(points, points))
    other = SelfAffine(ra=0.003, seed=1).heights(points, points)
    assert abs(np.corrcoef(again.ravel(), other.ravel())[0, 1]) < 0.5


def test_a_seed_means_the_same_surface_for_ever(surface):
    # pinned when written: published results name a seed
    found = surface.heights(np.array([0.0, 0.1]), np.array([0.05]))[:, 0]
    np.testing.assert_allclose(found, PINNED, rtol=0, atol=1e-12)


def test_halving_the_cut_off_keeps_the_long_waves():
    long, radius = spectrum(SelfAffine(sq=0.003, cut_off=0.016))
    both, _ = spectrum(SelfAffine(sq=0.003, cut_off=0.008))
    kept = (radius > 0) & (radius <= PERIOD / 0.016)
    ratio = both[kept] / long[kept]
    np.testing.assert_allclose(ratio, ratio[0].real, rtol=0, atol=1e-7)
    assert 0.9 < ratio[0].real < 1.0
    added = (radius > PERIOD / 0.016) & (radius < PERIOD / 0.0081)
    assert np.abs(both[added]).min() > 0


def test_a_draw_depends_on_its_mode_only():
    small, large = half_plane_draws(7, seed=5), half_plane_draws(12, seed=5)
    assert np.array_equal(large[5:-5, :8], small)
    assert np.array_equal(small[:8, 0], np.zeros(8))
    used = small[small != 0]
    assert used.size == np.unique(used).size == 2 * 7 * 8


def test_draws_are_complex_gaussian():
    draws = half_plane_draws(150, seed=0)
    draws = draws[draws != 0]
    assert draws.real.var() == pytest.approx(1.0, abs=0.03)
    assert draws.imag.var() == pytest.approx(1.0, abs=0.03)
    assert np.mean(draws.real * draws.imag) == pytest.approx(0.0, abs=0.03)
    assert np.mean(draws.real**4) == pytest.approx(3.0, abs=0.15)


def test_the_ensemble_of_heights_is_gaussian():
    found = [
        roughness(over_the_period(SelfAffine(sq=1.0, cut_off=0.02, seed=s), 250), pixel=(1.0, 1.0))
        for s in range(12)
    ]
    assert np.mean([f["ssk"] for f in found]) == pytest.approx(0.0, abs=0.05)
    assert np.mean([f["sku"] for f in found]) == pytest.approx(3.0, abs=0.08)
    assert np.mean([f["sa"] for f in found]) == pytest.approx(math.sqrt(2 / math.pi), abs=0.01)


def test_repeats_after_its_period_and_says_so(surface):
    x, y = np.linspace(-0.2, 0.3, 41), np.linspace(0.0, 0.1, 7)
    np.testing.assert_allclose(
        surface.heights(x + PERIOD, y - PERIOD), surface.heights(x, y), rtol=0, atol=1e-12
    )
    wide, exact = np.arange(1024) * 0.002, np.arange(1000) * 0.002
    assert any("repeats" in notice and "2 mm" in notice for notice in surface.notices(wide, y))
    assert surface.notices(exact, exact) == []


def test_warns_of_cells_that_miss_the_cut_off(surface):
    coarse, fine = np.arange(50) * 0.01, np.arange(50) * 0.004
    assert ["8 µm" in notice for notice in surface.notices(coarse, coarse)] == [True]
    assert surface.notices(fine, fine) == []


def test_record_is_json_ready(surface):
    record = json.loads(json.dumps(surface.record()))
    assert record["kind"] == "self-affine"
    assert record["asked"] == {"ra_um": pytest.approx(3.0)}
    assert record["ra_um"] == pytest.approx(3.0)
    assert record["sq_um"] == pytest.approx(3.0 * math.sqrt(math.pi / 2), rel=0.01)
    assert record["rms_slope"] == surface.rms_slope


def test_flat_is_flat():
    assert np.array_equal(Flat().heights(np.arange(3.0), np.arange(2.0)), np.zeros((3, 2)))
    assert Flat().record()["kind"] == "flat"
    assert Flat().notices(np.arange(3.0), np.arange(2.0)) == []


@pytest.mark.parametrize(
    ("bad", "field"),
    [
        ({"cut_off": 1e-5}, "cut_off"),
        ({"cut_off": 0.2}, "roll_off"),
        ({"roll_off": 3.0}, "roll_off"),
    ],
)
def test_refuses_bad_parameters_by_name(bad, field):
    with pytest.raises(InputError, match=rf"disc\.synthetic\.{field}\b.*allowed is"):
        SelfAffine(**{"ra": 0.003, **bad})
