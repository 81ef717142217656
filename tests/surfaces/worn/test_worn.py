"""Worn tracks and worn balls of known volume."""

import math
from contextlib import suppress
from functools import cache

import numpy as np
import pytest
from scipy import ndimage

from warpwear.errors import InputError
from warpwear.measured.surface_report import patch_rows, track_rows
from warpwear.results.report import lines
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.sphere import Sphere, places
from warpwear.surfaces.worn.ball import cap_of_diagonals, find_worn_ball
from warpwear.surfaces.worn.track import find_track

CELL = 0.003
PLACES = (np.arange(800) - 399.5) * CELL


@cache
def rough_track():
    """Return a rough track of Ra 1 mm: heights are proportional to it, and making them takes long."""
    return SelfAffine(ra=1.0, seed=1, period=2.5).heights(PLACES, PLACES)


def track(*, ra=0.0003, width=0.7, depth=0.01, pile=0.002, offset=0.0, scatter=0.1):
    """Heights with a track along axis 0 and its net sections [mm²]."""
    y = np.abs(PLACES - offset)
    trough = -depth * np.maximum(1 - np.square(2 * y / width), 0.0)
    foot = 0.12 * width
    ridge = pile * np.exp(-np.square((y - width / 2 - foot) / foot * 2))
    scale = 1 + scatter * np.sin(2 * np.pi * PLACES / 0.4)
    form = np.multiply.outer(scale, trough + ridge)
    rough = ra * rough_track()
    tilt = np.add.outer(0.003 * PLACES, 0.002 * PLACES) + 0.1
    return form + rough + tilt, -form.sum(axis=1) * CELL


@pytest.mark.parametrize("offset", [0.0, 0.3])
@pytest.mark.parametrize("pile", [0.0, 0.002])
def test_volume_of_a_track_within_one_percent(offset, pile):
    heights, net = track(offset=offset, pile=pile)
    found = find_track(heights, pixel=(CELL, CELL))
    assert found.net.mean() == pytest.approx(net.mean(), rel=0.01)
    assert found.net.std() == pytest.approx(net.std(), rel=0.1)
    volume, error = found.volume()
    assert volume == pytest.approx(net.mean() * 2.4, rel=0.01)
    assert abs(volume - net.mean() * 2.4) < 3 * error
    assert found.volume(30.0)[0] == pytest.approx(volume * 30.0 / 2.4)
    assert found.depth == pytest.approx(0.01, rel=0.03)
    assert found.window[0] < offset - 0.35
    assert found.window[1] > offset + 0.35
    assert found.width == pytest.approx(0.7, rel=0.02)


def test_below_and_above_are_told_apart():
    heights, _ = track(ra=1e-5, pile=0.002, scatter=0.0)
    found = find_track(heights, pixel=(CELL, CELL))
    assert found.below.mean() == pytest.approx(2 / 3 * 0.7 * 0.01, rel=0.01)
    # two ridges, each of √π σ with 2σ = 0.12 of the width, less what the trough's edge would cut
    assert found.above.mean() == pytest.approx(2 * math.sqrt(math.pi) * 0.042 * 0.002, rel=0.03)


def test_scatter_of_a_rough_surface_covers_the_truth():
    heights, net = track(ra=0.003, pile=0.0, depth=0.02)
    found = find_track(heights, pixel=(CELL, CELL))
    assert abs(found.net.mean() - net.mean()) < 3 * found.net_error
    assert found.net_error < 0.1 * net.mean()


def test_a_given_width_and_a_curved_surface():
    heights, net = track()
    assert find_track(heights, pixel=(CELL, CELL), width=1.1).net.mean() == pytest.approx(
        net.mean(), rel=0.01
    )
    bent = heights + 0.004 * np.square(PLACES)[None, :]
    found = find_track(bent, pixel=(CELL, CELL), degree=2)
    assert found.net.mean() == pytest.approx(net.mean(), rel=0.015)


def test_no_track_and_no_room():
    rough = 0.003 * rough_track()
    with pytest.raises(InputError, match=r"no track stands out|too little surface"):
        find_track(rough, pixel=(CELL, CELL))
    heights, _ = track(width=2.3, pile=0.0)
    with pytest.raises(InputError, match=r"too little surface|no track"):
        find_track(heights, pixel=(CELL, CELL))
    with pytest.raises(InputError, match=r"--track-width is 3 mm: allowed is less"):
        find_track(heights, pixel=(CELL, CELL), width=3.0)


FIELD = (np.arange(400) - 199.5) * 0.005


def test_roughness_without_a_track_is_none():
    # waves of half the field: two have a valley along their whole length, which nothing tells from a track
    found, refused = [], []
    for seed in range(40):
        rough = SelfAffine(sq=0.001, seed=seed, period=2.5, roll_off=1.0, cut_off=0.02).heights(FIELD, FIELD)
        try:
            find_track(rough, pixel=(0.005, 0.005))
            said = ""
        except InputError as error:
            said = str(error)
        if not said:
            found.append(seed)
        elif "no track was found" in said:
            refused.append(seed)
            assert "--track-width measures it anyway" in said
            assert find_track(rough, pixel=(0.005, 0.005), width=0.3).below.mean() > 0
    assert found == [16, 32]
    assert len(refused) >= 2


def test_the_mean_section_has_no_roughness_in_it():
    rough = SelfAffine(sq=0.001, seed=0, period=2.5, cut_off=0.02).heights(FIELD, FIELD)
    found = find_track(rough - 0.003 * np.maximum(1 - (2 * FIELD / 0.7) ** 2, 0.0), pixel=(0.005, 0.005))
    section = 2 / 3 * 0.7 * 0.003
    assert found.above.mean() > 0.05 * section
    below, above = found.mean_section
    assert above < 0.015 * section
    assert below == pytest.approx(section, rel=0.05)
    assert below - above == pytest.approx(found.net.mean())
    text = "\n".join(lines(track_rows(found, length=None)))
    assert "mean section" in text
    assert "averaged along the track first" in text
    assert "above, with the roughness in it" in text


#: A field of 2 × 1.9 mm.
COARSE, PIXEL = (250, 238), (0.008, 0.008)


@cache
def rough_ball(seed):
    """Return a rough ball of Ra 1 mm, of longer waves than a ball has: no test asks for shorter ones."""
    return SelfAffine(ra=1.0, seed=seed, period=2.5, cut_off=0.032).heights(*places(COARSE, PIXEL))


def ball(flat, ra, *, middle=(0.02, -0.05), seed=2):
    x, y = places(COARSE, PIXEL)
    sphere = Sphere((*middle, 0.2), 3.0).heights(x, y)
    worn = np.minimum(sphere, 0.2 - flat)
    return worn + ra * rough_ball(seed), float((sphere - worn).sum()) * PIXEL[0] ** 2


@pytest.mark.parametrize(
    ("flat", "ra", "radius"),
    [
        pytest.param(0.0272, 1e-5, 3.0, marks=pytest.mark.slow),
        (0.0272, 1e-5, None),
        (0.0272, 3e-4, 3.0),
        pytest.param(0.0272, 3e-4, None, marks=pytest.mark.slow),
        (0.01, 1e-4, 3.0),
        pytest.param(0.01, 1e-4, None, marks=pytest.mark.slow),
    ],
)
def test_volume_of_a_worn_ball(flat, ra, radius):
    heights, volume = ball(flat, ra)
    found = find_worn_ball(heights, pixel=PIXEL, radius=radius)
    assert found.volume == pytest.approx(volume, rel=0.01)
    assert found.depth == pytest.approx(flat, rel=0.05 if ra > 1e-5 else 0.005)
    assert found.sphere.radius == pytest.approx(3.0, rel=1e-3)
    diameter = 2 * math.sqrt(2 * 3.0 * flat - flat**2)
    assert found.along == pytest.approx(diameter, rel=0.05)
    assert found.across == pytest.approx(diameter, rel=0.05)
    assert volume == pytest.approx(math.pi * flat**2 * (9.0 - flat) / 3.0, rel=0.005)


def test_a_radius_that_cannot_be_told_is_refused():
    rim = 0.91 * 0.95
    heights, volume = ball(3.0 - math.sqrt(9.0 - rim**2), 1e-4, middle=(0.0, 0.0))
    given = find_worn_ball(heights, pixel=PIXEL, radius=3.0)
    assert given.volume == pytest.approx(volume, rel=0.002)
    with pytest.raises(InputError, match=r"to tell its radius from: --radius gives it, or a wider"):
        find_worn_ball(heights, pixel=PIXEL)
    # a flat that reaches the edges must not pass for the sphere itself
    heights, _ = ball(3.0 - math.sqrt(9.0 - 0.98**2), 1e-4, middle=(0.09, 0.27))
    with pytest.raises(InputError, match=r"to tell its radius from|no sphere fits|hollow"):
        find_worn_ball(heights, pixel=PIXEL)


@pytest.mark.parametrize(
    ("flat", "count"),
    [
        (0.0006, 4),
        pytest.param(0.0006, 8, marks=pytest.mark.slow),
        pytest.param(0.001, 8, marks=pytest.mark.slow),
    ],
)
def test_shallow_scars_are_not_cut_short(flat, count):
    off, errors = [], []
    for seed in range(count):
        heights, volume = ball(flat, 1.6e-4, seed=seed)
        found = find_worn_ball(heights, pixel=PIXEL, radius=3.0)
        off.append(found.volume / volume - 1.0)
        errors.append(found.volume_error / volume)
    assert abs(np.mean(off)) < 2.5 * np.mean(errors) / math.sqrt(count)
    assert (np.abs(off) < 3 * np.array(errors)).all()
    if count == 8:  # fewer say little of a spread
        assert np.mean(errors) == pytest.approx(np.sqrt(np.mean(np.square(off))), rel=0.6)


def test_pile_up_beside_the_patch_is_net():
    heights, volume = ball(0.01, 8e-5)
    x, y = places(COARSE, PIXEL)
    rim = math.sqrt(2 * 3.0 * 0.01 - 0.01**2)
    beyond = np.hypot.outer(x - 0.02, y + 0.05) - rim
    ridge = np.where(beyond > 0, 0.002 * np.exp(-np.square((beyond - 0.03) / 0.015)), 0.0)
    none = find_worn_ball(heights, pixel=PIXEL, radius=3.0)
    assert abs(none.piled_up) < 3 * none.piled_up_error
    assert none.piled_up_error < 0.01 * volume
    found = find_worn_ball(heights + ridge, pixel=PIXEL, radius=3.0)
    assert found.piled_up == pytest.approx(ridge.sum() * PIXEL[0] ** 2, rel=0.05)
    assert found.volume == pytest.approx(volume, rel=0.01)
    text = "\n".join(lines(patch_rows(found)))
    assert "net above the sphere in the rim beside the patch" in text
    assert f"± {found.volume_error:.2g} mm³ lost in the patch" in text


def test_balls_that_are_none():
    heights, _ = ball(0.02, 1e-4)
    with pytest.raises(InputError, match="hollow, not a ball"):
        find_worn_ball(-heights, pixel=PIXEL)
    with pytest.raises(InputError, match=r"no sphere fits|beyond the ball|nothing on the ball"):
        find_worn_ball(heights, pixel=PIXEL, radius=0.5)


def test_two_diagonals_are_equation_3_1():
    cap = cap_of_diagonals(0.80, 0.82, radius=3.0)
    assert cap.rim == pytest.approx(0.405)
    assert cap.height == pytest.approx(3.0 - math.sqrt(9.0 - 0.405**2), rel=1e-12)
    assert cap.volume == pytest.approx(math.pi * cap.height**2 * (9.0 - cap.height) / 3.0)
    # a thin cap keeps its digits: h = a²/2R
    assert cap_of_diagonals(2e-6, 2e-6, radius=3.0).height == pytest.approx(1e-12 / 6, rel=1e-9)
    half = cap_of_diagonals(6.0, 6.0, radius=3.0)
    assert half.volume == pytest.approx(2 / 3 * math.pi * 27)
    for bad in ((0.0, 1.0), (7.0, 1.0), (-1.0, 1.0)):
        with pytest.raises(InputError, match=r"a diameter is .* allowed is"):
            cap_of_diagonals(*bad, radius=3.0)
    with pytest.raises(InputError, match=r"--radius is 0 mm"):
        cap_of_diagonals(1.0, 1.0, radius=0.0)


def correlated(seed, depth, sq=1e-4):
    """Return heights [mm] of a ball of 3 mm, rough by Sq over 7 pixels, with a flat; the volume [mm³]."""
    rng, pixel = np.random.default_rng(seed), (0.002, 0.002)
    x, y = places((90, 90), pixel)
    field = ndimage.gaussian_filter(rng.normal(size=(130, 130)), 3.5)[20:110, 20:110]
    sphere = Sphere((0.0, 0.0, 0.2), 3.0).heights(x, y)
    worn = np.minimum(sphere, 0.2 - depth)
    return worn + sq * field / field.std(), float((sphere - worn).sum()) * pixel[0] ** 2


def test_the_deepest_of_many_places_of_an_unworn_ball_is_no_wear():
    """All were told as worn, with three standard errors; of 200 up to ten may be."""
    refused = 0
    for seed in range(6):
        try:
            find_worn_ball(correlated(seed, 0.0)[0], pixel=(0.002, 0.002), radius=3.0)
        except InputError as error:
            refused += "nothing on the ball stands out as worn" in str(error)
    assert refused >= 5
    for seed in range(3):
        heights, volume = correlated(seed, 5e-4, 5e-5)
        found = find_worn_ball(heights, pixel=(0.002, 0.002), radius=3.0)
        assert abs(found.volume - volume) < 2.5 * found.volume_error


@pytest.mark.slow
def test_false_alarms_of_unworn_balls():
    told = 0
    for seed in range(200):
        with suppress(InputError):
            told += bool(find_worn_ball(correlated(seed, 0.0)[0], pixel=(0.002, 0.002), radius=3.0))
    assert told <= 10
