"""A surface like a profile: its Rq, its spectrum by decades, its skewness."""

import numpy as np
import pytest
from cases_instruments import profile, rough
from scipy import fft

from warpwear.errors import InputError
from warpwear.surfaces.made.like import LikeProfile
from warpwear.surfaces.roughness import height_parameters

STEP, COUNT = 0.001, 4000
DECADES = np.array([0.25, 4.75, 49.75, 125.25])  # 1/mm, between the waves of a period of 2 mm
SHARE = {"period": 2.0, "cut_off": 0.016}


def with_valleys(seed: int) -> np.ndarray:
    """Return a profile with skewness, as of a honed surface."""
    plain = rough(np.random.default_rng(seed), COUNT, STEP, hurst=0.7, roll_off=0.15, rq=1.0)
    return -0.5e-3 * np.exp(-0.5 * plain)


def by_decades(power: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    return np.histogram(frequency, DECADES, weights=power)[0]


def of_profile(heights: np.ndarray) -> np.ndarray:
    """Return the mean square of a levelled profile in each decade, from its mirror's Fourier series."""
    rest = heights - np.polyval(np.polyfit(np.arange(COUNT), heights, 1), np.arange(COUNT))
    power = np.square(fft.dct(rest, norm="ortho"))[1:] / COUNT
    return by_decades(power, np.arange(1, COUNT) / (2 * COUNT * STEP))


def along(surface: LikeProfile) -> np.ndarray:
    """Return the mean square of lines of a surface along x in each decade."""
    points = np.arange(500) * 0.004
    waves = 2 * np.square(np.abs(np.fft.rfft(surface.heights(points, points), axis=0) / 500)).mean(axis=1)
    return by_decades(waves[1:], np.arange(1, 251) / 2.0)


@pytest.mark.parametrize("lay_length", [None, 0.5])
def test_rq_spectrum_and_skewness_come_back(lay_length: float | None) -> None:
    heights = with_valleys(3)
    surface = LikeProfile(profile=profile(heights, STEP), like="p.csv", lay_length=lay_length, **SHARE)
    record = surface.record()
    points = np.arange(400) * 0.005
    own, given = (height_parameters(h) for h in (surface.heights(points, points), heights))
    left = (1.0 - 0.01 * sum(record["left_out_percent"].values())) ** 0.5
    assert own["sq"] == pytest.approx(left * record["profile"]["rq_um"] * 1e-3, rel=2e-3)
    assert own["sq"] == pytest.approx(given["sq"], rel=0.03)
    assert own["ssk"] == pytest.approx(record["profile"]["rsk"], rel=0.1)
    apart = along(surface) / of_profile(heights) - 1.0
    assert np.sqrt(np.mean(np.square(apart[:2]))) < 0.1  # the third ends at the cut-off
    assert any("one of many" in notice for notice in surface.notices(points, points))


def test_a_lay_lies_across_or_along_sliding() -> None:
    made = {"profile": profile(with_valleys(5), STEP), "lay_length": 0.4, **SHARE}
    points = np.arange(200) * 0.01
    across, lengthwise = (LikeProfile(lay=lay, **made).heights(points, points) for lay in (90.0, 0.0))
    assert np.square(np.diff(across, axis=0)).mean() > 20 * np.square(np.diff(across, axis=1)).mean()
    assert np.square(np.diff(lengthwise, axis=1)).mean() > 20 * np.square(np.diff(lengthwise, axis=0)).mean()
    # autocorrelation exp(−(y/ℓ)²) along the lay
    near = float(np.mean(across * np.roll(across, 40, axis=1)) / np.square(across).mean())
    assert near == pytest.approx(np.exp(-1.0), abs=0.1)


def test_a_regular_wave_is_lost_without_a_lay_and_that_is_told() -> None:
    marks = 1e-3 * np.sin(2 * np.pi * STEP * np.arange(COUNT) / 0.25)
    turned = marks + rough(np.random.default_rng(0), COUNT, STEP, hurst=0.8, roll_off=0.1, rq=3e-5)
    points = np.arange(100) * 0.008
    for lay_length, told in ((None, True), (0.5, False)):
        surface = LikeProfile(profile=profile(turned, STEP), lay_length=lay_length, **SHARE)
        assert any("no isotropic surface" in text for text in surface.notices(points, points)) is told


def test_a_surface_is_one_function_of_place_and_seed() -> None:
    made = {"profile": profile(with_valleys(3), STEP), "digest": "a", "period": 1.0, "cut_off": 0.02}
    first, again, other = LikeProfile(**made), LikeProfile(**made), LikeProfile(seed=1, **made)
    assert first == again
    assert first != other
    points = np.arange(50) * 0.01
    np.testing.assert_array_equal(first.heights(points, points), again.heights(points, points))
    np.testing.assert_allclose(
        first.heights(points[::5], points), first.heights(points, points)[::5], atol=1e-12
    )
    np.testing.assert_allclose(first.heights(points + 1.0, points), first.heights(points, points), atol=1e-12)
    assert np.abs(other.heights(points, points) - first.heights(points, points)).max() > 1e-4


@pytest.mark.parametrize(
    ("wrong", "what"),
    [
        ({"period": 5.0}, r"disc\.synthetic\.period is 5 mm: allowed is at most the length of the profile"),
        ({"cut_off": 0.0015}, r"disc\.synthetic\.cut_off is 0\.0015 mm: allowed is from two points"),
        ({"lay_length": 0.5, "lay": 45.0}, r"disc\.synthetic\.lay is 45 deg: allowed is 0 or 90"),
    ],
)
def test_bad_values(wrong: dict[str, float], what: str) -> None:
    with pytest.raises(InputError, match=what):
        LikeProfile(profile=profile(with_valleys(3), STEP), **(SHARE | wrong))
