"""Power spectrum, slopes, roll-off and profile roughness against closed forms."""

import math

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.roughness import profile_roughness, roughness
from warpwear.surfaces.spectrum import (
    autocorrelation_length,
    power_spectrum,
    slope_against_cut_off,
    suggested_roll_off,
)

CELL = 0.002


@pytest.fixture(scope="module")
def rough():
    points = np.arange(1000) * CELL
    return SelfAffine(sq=0.003).heights(points, points)


def test_parameters_of_a_sine_and_a_triangle():
    x = (np.arange(20000) + 0.5) / 1000
    for wave, expected in (
        (np.sin(2 * np.pi * x), {"sa": 2 / math.pi, "sq": math.sqrt(0.5), "sz": 2.0, "sku": 1.5}),
        (2 * np.abs(2 * (x % 1) - 1) - 1, {"sa": 0.5, "sq": math.sqrt(1 / 3), "sz": 2.0, "sku": 1.8}),
    ):
        found = roughness(wave[:, None] * np.ones(5), pixel=(0.01, 0.01))
        assert {k: found[k] for k in expected} == pytest.approx(expected, rel=0.005)
        assert found["ssk"] == pytest.approx(0.0, abs=1e-9)


def test_the_spectrum_holds_the_variance(rough):
    # white noise has the density Sq² times the area of a pixel at every wave
    white = np.random.default_rng(0).normal(size=(300, 400))
    found = power_spectrum(white, pixel=(0.002, 0.003))
    level = found.density @ found.modes / found.modes.sum()
    assert level == pytest.approx(white.var() * 0.002 * 0.003, rel=0.01)
    spectrum = power_spectrum(rough, pixel=(CELL, CELL))
    # ∫ C d²q/(2π)², a mode standing for 1/(area of the field)
    held = spectrum.density @ spectrum.modes / (1000 * CELL) ** 2
    assert held == pytest.approx(rough.var(), rel=0.05)


def test_the_spectrum_falls_as_the_surface_was_made(rough):
    found = power_spectrum(rough, pixel=(CELL, CELL))
    middle = (found.wavelength > 0.012) & (found.wavelength < 0.06)
    slope = np.polyfit(np.log(found.wavelength[middle]), np.log(found.density[middle]), 1)[0]
    assert slope == pytest.approx(2 + 2 * 0.8, abs=0.1)


@pytest.mark.parametrize("length", [0.05, 0.025])
def test_slope_of_a_sine_behind_the_filter(length):
    x = (np.arange(1000) + 0.5) * 0.001
    wave = np.cos(2 * np.pi * x / length)[:, None] * np.ones(30)
    found = slope_against_cut_off(wave, pixel=(0.001, 0.001), cut_offs=np.array([0.0, length, 0.5 * length]))
    exact = 2 * math.pi / length / math.sqrt(2)
    np.testing.assert_allclose(found / exact, [1.0, 0.5, 2**-0.25], rtol=1e-3)


def test_slope_of_a_surface_is_its_own(rough):
    found = slope_against_cut_off(rough, pixel=(CELL, CELL), cut_offs=np.array([0.0]))[0]
    assert found == pytest.approx(SelfAffine(sq=0.003).rms_slope, rel=0.01)
    assert slope_against_cut_off(np.zeros((8, 8)), pixel=(1, 1), cut_offs=np.array([0.0, 2.0])).tolist() == [
        0,
        0,
    ]


def test_correlation_length_of_a_wave():
    x = np.arange(600) * 0.001
    wave = np.cos(2 * np.pi * x / 0.05)[:, None] + np.cos(2 * np.pi * x / 0.05)[None, :]
    # the autocorrelation (cos + cos)/2 reaches 0.2 first on the diagonal, where it is cos(2π d/√2/0.05)
    expected = math.sqrt(2) * math.acos(0.2) / (2 * math.pi) * 0.05
    assert autocorrelation_length(wave, pixel=(0.001, 0.001)) == pytest.approx(expected, abs=0.0015)
    assert autocorrelation_length(np.zeros((40, 40)), pixel=(1.0, 1.0)) is None


@pytest.mark.parametrize("roll_off", [0.05, 0.1, 0.2])
def test_the_roll_off_is_found(roll_off):
    points = np.arange(1000) * CELL
    heights = SelfAffine(sq=0.003, roll_off=roll_off, hurst=0.7).heights(points, points)
    spectrum = power_spectrum(heights, pixel=(CELL, CELL))
    found = suggested_roll_off(spectrum, correlation=None, resolved=2 * CELL)
    assert "knee" in found.source
    assert found.wavelength == pytest.approx(roll_off, rel=0.25)
    assert found.hurst == pytest.approx(0.7, abs=0.12)


def test_without_a_knee_the_correlation_length_is_said(rough):
    part = rough[:8, :8] - rough[:8, :8].mean()
    spectrum = power_spectrum(part, pixel=(CELL, CELL))
    found = suggested_roll_off(spectrum, correlation=0.001, resolved=2 * CELL)
    assert found.wavelength == pytest.approx(0.004)
    assert "autocorrelation" in found.source
    # The field of 16 µm is too short to tell a roll-off of 40 µm.
    too_long = suggested_roll_off(spectrum, correlation=0.01, resolved=2 * CELL)
    assert too_long.wavelength is None
    none = suggested_roll_off(spectrum, correlation=None, resolved=2 * CELL)
    assert none.wavelength is None
    assert "not in the field" in none.source


def sine(length, count, pixel, phase=0.0):
    return np.sin(2 * np.pi * (np.arange(count) + 0.5) * pixel / length + phase)[:, None] * np.ones(4)


def ra(field, pixel, cut_off=2.5, short=0.008):
    return profile_roughness(field, pixel=(pixel, 1.0), axis=0, cut_off=cut_off, short=short)


def left(length, cut_off, short):
    """Ra of a sine of amplitude 1 behind both Gaussian filters, each of which passes half at its cut-off."""
    return 2 / math.pi * 2 ** -((short / length) ** 2) * (1 - 2 ** -((cut_off / length) ** 2))


@pytest.mark.parametrize("phase", [0.0, math.pi / 2], ids=["sine", "cosine"])
@pytest.mark.parametrize(
    ("profile", "cut_off", "lengths"),
    [
        (15.0, 2.5, (0.25, 0.5, 1.25, 2.5)),
        (4.8, 0.8, (0.1, 0.2, 1 / 3, 0.4, 0.5, 0.8)),  # 5 sampling lengths
        (4.0, 0.8, (0.2, 0.32, 0.4, 0.64)),  # 4
        (1.6, 0.8, (0.1, 0.2, 0.4, 0.8)),  # 1
    ],
)
def test_ra_of_a_sine(profile, cut_off, lengths, phase):
    for length in lengths:
        found = ra(sine(length, round(profile / 0.002), 0.002, phase), 0.002, cut_off)
        assert found.ra == pytest.approx(left(length, cut_off, 0.008), rel=0.005), length
        assert found.scatter == pytest.approx(0.0, abs=1e-9)
        assert (found.profiles, found.cut_off, found.short) == (4, cut_off, 0.008)


def test_the_short_waves_are_taken_off():
    for length, phase in ((0.008, 0.0), (0.008, math.pi / 2), (0.016, 0.0)):
        found = ra(sine(length, 28800, 0.00025, phase), 0.00025)
        assert found.ra == pytest.approx(left(length, 2.5, 0.008), rel=0.005)


def test_ra_along_the_other_axis():
    field = sine(0.25, 7500, 0.002).T
    found = profile_roughness(field, pixel=(0.01, 0.002), axis=1, cut_off=2.5, short=0.008)
    assert found.ra == pytest.approx(left(0.25, 2.5, 0.008), rel=0.005)
    assert (found.profiles, found.notes) == (4, ())


def test_what_lies_at_the_ends_is_not_evaluated():
    field = np.zeros((7500, 2))
    field[[0, -1]] = 1.0  # 7500 × 2 µm: λc/2 = 1.25 mm is discarded at each end
    assert ra(field, 0.002).ra < 1e-5


@pytest.mark.parametrize(
    ("profile", "notes"),
    [
        (15.0, ()),
        (14.998, ()),  # a pixel less
        (12.4, ("3 sampling lengths instead of 5",)),
        (12.5, ("4 sampling lengths instead of 5",)),
        (5.0, ("1 sampling length instead of 5",)),
        (100.0, ()),
    ],
)
def test_sampling_lengths_are_whole(profile, notes):
    assert ra(sine(0.25, round(profile / 0.002), 0.002), 0.002).notes == notes


def test_a_short_profile_reduces_the_cut_off_and_says_so():
    found = ra(sine(0.05, 1000, 0.001), 0.001)
    assert (found.cut_off, found.short) == (0.25, 0.008)
    assert found.ra == pytest.approx(left(0.05, 0.25, 0.008), rel=0.005)
    assert found.notes == (
        "λc reduced from 2.5 to 0.25 mm: profiles are 1 mm long",
        "3 sampling lengths instead of 5",
    )
    tiny = ra(sine(0.01, 100, 0.001), 0.001)
    assert (tiny.cut_off, tiny.short) == (None, 0.008)
    assert tiny.notes == ("no λc: profiles of 0.1 mm are too short for any of ISO 3274",)
    one = ra(np.zeros((1, 3)), 0.5)  # a profile of one pixel
    assert (one.ra, one.scatter, one.cut_off) == (None, None, 0.25)


def test_what_the_filters_leave_of_nothing_is_no_ra():
    micrometre = 1e-3 * sine(0.01, 1000, 0.001, math.pi / 2)  # whole waves, which a mirror continues
    found = ra(micrometre, 0.001, short=0.05)  # passes 2^-25 of it, 2e-8 µm
    assert (found.ra, found.scatter) == (None, None)
    assert found.notes[-1] == "no Ra: the filters leave no height of 1 pm"
    assert ra(micrometre, 0.001, short=0.03).ra == pytest.approx(1e-3 * left(0.01, 0.25, 0.03), rel=0.1)


def test_the_short_cut_off_stays_the_one_asked_for():
    assert ra(sine(0.05, 1000, 0.001), 0.001, short=0.1).short == 0.1
    assert ra(sine(0.05, 250, 0.004), 0.004).short == 0.008  # two pixels are enough
    coarse = ra(sine(0.05, 200, 0.005), 0.005)
    assert coarse.short is None
    assert coarse.notes[-1] == "no λs: 8 µm is shorter than two pixels"
    long = ra(sine(0.05, 1000, 0.001), 0.001, short=0.3)
    assert (long.cut_off, long.short) == (0.25, 0.0025)
    assert long.notes[-1] == "λs reduced from 300 to 2.5 µm: it must be shorter than λc"
    both = ra(sine(0.05, 500, 0.002), 0.002, short=0.3)
    assert both.short is None
    assert both.notes[-1] == "no λs: 2.5 µm (instead of 300 µm) is shorter than two pixels"
    tiny = ra(sine(0.01, 100, 0.001), 0.001, short=0.1)
    assert (tiny.cut_off, tiny.short) == (None, 0.0025)
    assert tiny.notes[-1] == "λs reduced from 100 to 2.5 µm: it must be shorter than the profiles"


@pytest.mark.parametrize("short", [0.8, 2.5])
def test_cut_offs_the_wrong_way_round_are_refused(short):
    with pytest.raises(InputError, match=r"--lambda-s is \d+ µm: allowed is less than λc, 800"):
        ra(sine(0.05, 1000, 0.001), 0.001, cut_off=0.8, short=short)
