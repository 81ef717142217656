"""Two measurements of one place, laid over each other."""

import math

import numpy as np
import pytest
from cases_worn import KINDS, PIXEL
from scipy import ndimage

from warpwear.errors import InputError
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.registration import difference
from warpwear.surfaces.worn.track import find_track


def sampled(field, shape, *, pixel=PIXEL, shift=(0.0, 0.0), angle=0.0):
    """Return the heights of a field seen by an instrument that is shifted [mm] and turned [rad]."""
    x, y = np.meshgrid(*places(shape, (pixel, pixel)), indexing="ij")
    seen = (
        math.cos(angle) * x - math.sin(angle) * y + shift[0],
        math.sin(angle) * x + math.cos(angle) * y + shift[1],
    )
    at = [p / PIXEL + 0.5 * (n - 1) for p, n in zip(seen, field.shape, strict=True)]
    return ndimage.map_coordinates(field, at, order=3)


def before_and_after(kind, *, seed=3, depth=1e-3, width=0.3, pixel=PIXEL):
    """Return heights after and before [mm], shift [mm] and angle [rad], and the section lost [mm²]."""
    rng = np.random.default_rng(seed)
    field = 1.5e-3 * KINDS[kind](rng, (240, 360))
    shape, earlier = (150, 230), (round(150 * PIXEL / pixel), round(230 * PIXEL / pixel))
    shift, angle = (0.031, -0.047), math.radians(2.3)
    y = places(shape, (PIXEL, PIXEL))[1]
    groove = depth * np.maximum(1.0 - np.square(2.0 * y / width), 0.0)
    noise = [5e-5 * rng.normal(size=s) for s in (shape, earlier)]
    after = sampled(field, shape) - groove + 0.004 * y + noise[0]
    before = sampled(field, earlier, pixel=pixel, shift=shift, angle=angle) + noise[1]
    before += 0.003 * places(earlier, (pixel, pixel))[0][:, None]
    return after, before, shift, angle, float(groove.sum()) * PIXEL


@pytest.mark.parametrize(("kind", "pixel"), [("turned", PIXEL), ("self-affine", 1.13 * PIXEL)])
def test_a_groove_shallower_than_the_roughness(kind, pixel):
    after, before, shift, angle, section = before_and_after(kind, pixel=pixel)
    found = difference(after, before, pixel=(PIXEL, PIXEL), earlier_pixel=(pixel, pixel))
    assert found.rotation == pytest.approx(-angle, abs=2e-3)
    # a point of the later field lies at R(−angle) (x − shift) of the earlier one
    cosine, sine = math.cos(angle), math.sin(angle)
    moved = (-cosine * shift[0] - sine * shift[1], sine * shift[0] - cosine * shift[1])
    assert found.shift == pytest.approx(moved, abs=0.5 * PIXEL)
    assert found.correlation > 0.95
    track = find_track(found.heights, pixel=(PIXEL, PIXEL))
    assert track.net.mean() == pytest.approx(section, rel=0.03)
    assert abs(track.net.mean() - section) < 3 * track.net_error
    assert track.net_error < 0.03 * section
    assert track.width == pytest.approx(0.3, rel=0.03)


def test_another_place_is_refused():
    after, *_ = before_and_after("self-affine", seed=3)
    _, other, *_ = before_and_after("self-affine", seed=4)
    with pytest.raises(InputError, match=r"--before does not show the place of FILE"):
        difference(after, other, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))


@pytest.mark.slow
def test_two_places_of_one_lay_are_refused_and_one_place_of_a_lay_alone_is_not():
    """Grooves that repeat were laid over other grooves, and their correlation was enough."""
    rng = np.random.default_rng(5)
    lay = np.multiply.outer(
        np.ones(240), np.interp(np.arange(360), np.arange(0, 368, 8), rng.normal(size=46))
    )
    rough = [0.5 * KINDS["rolled-off"](np.random.default_rng(seed), (240, 360)) for seed in (6, 7)]
    noise = [0.05 * rng.normal(size=(150, 230)) for _ in "ab"]

    def laid_over(*fields):
        after, before = (1e-3 * (sampled(f, (150, 230)) + n) for f, n in zip(fields, noise, strict=True))
        return difference(after, before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))

    with pytest.raises(
        InputError, match=r"does not show the place of FILE: .* across them .* % of the long waves agree"
    ):
        laid_over(lay + rough[0], lay + rough[1])
    assert laid_over(lay + rough[0], lay + rough[0]).correlation > 0.9
    assert laid_over(lay, lay).correlation > 0.9
    noise = [6.0 * ndimage.gaussian_filter(z, 1.5) for z in noise]  # that instruments have smoothed
    assert laid_over(lay + rough[0], lay + rough[0]).correlation > 0.9


def test_missing_points_of_both_stay_missing():
    after, before, *_, section = before_and_after("self-affine")
    rng = np.random.default_rng(0)
    for heights in (after, before):
        heights[rng.random(heights.shape) < 0.01] = np.nan
    found = difference(after, before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))
    assert 0.01 < np.isnan(found.heights).mean() < 0.5
    track = find_track(found.heights, pixel=(PIXEL, PIXEL))
    assert abs(track.net.mean() - section) < 3 * track.net_error
    assert track.net_error < 0.05 * section
