"""Worn tracks and worn balls of known volume."""

import math

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.sphere_fit import Sphere, places
from warpwear.surfaces.synthetic import SelfAffine
from warpwear.surfaces.track import find_track
from warpwear.surfaces.worn_ball import cap_of_diagonals, find_worn_ball

CELL = 0.003
PLACES = (np.arange(800) - 399.5) * CELL


def track(*, ra=0.0003, width=0.7, depth=0.01, pile=0.002, offset=0.0, scatter=0.1):
    """Heights with a track along axis 0 and its net sections [mm²]."""
    y = np.abs(PLACES - offset)
    trough = -depth * np.maximum(1 - np.square(2 * y / width), 0.0)
    foot = 0.12 * width
    ridge = pile * np.exp(-np.square((y - width / 2 - foot) / foot * 2))
    scale = 1 + scatter * np.sin(2 * np.pi * PLACES / 0.4)
    form = np.multiply.outer(scale, trough + ridge)
    rough = SelfAffine(ra=ra, seed=1, period=2.5).heights(PLACES, PLACES)
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
    assert found.edges[0] < offset - 0.35
    assert found.edges[1] > offset + 0.35


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
    rough = SelfAffine(ra=0.003, period=2.5).heights(PLACES, PLACES)
    with pytest.raises(InputError, match=r"no track stands out|too little surface"):
        find_track(rough, pixel=(CELL, CELL))
    heights, _ = track(width=2.3, pile=0.0)
    with pytest.raises(InputError, match=r"too little surface|no track"):
        find_track(heights, pixel=(CELL, CELL))
    with pytest.raises(InputError, match=r"--track-width is 3 mm: allowed is less"):
        find_track(heights, pixel=(CELL, CELL), width=3.0)


def ball(flat, ra):
    x, y = places((400, 380), (0.005, 0.005))
    sphere = Sphere((0.02, -0.05, 0.2), 3.0).heights(x, y)
    worn = np.minimum(sphere, 0.2 - flat)
    rough = SelfAffine(ra=ra, seed=2, period=2.5).heights(x, y)
    return worn + rough, float((sphere - worn).sum()) * 0.005**2


@pytest.mark.parametrize("radius", [3.0, None])
@pytest.mark.parametrize(("flat", "ra"), [(0.0272, 1e-5), (0.0272, 3e-4), (0.01, 1e-4)])
def test_volume_of_a_worn_ball(flat, ra, radius):
    heights, volume = ball(flat, ra)
    found = find_worn_ball(heights, pixel=(0.005, 0.005), radius=radius)
    assert found.volume == pytest.approx(volume, rel=0.01)
    assert found.depth == pytest.approx(flat, rel=0.05 if ra > 1e-5 else 0.005)
    assert found.sphere.radius == pytest.approx(3.0, rel=1e-3)
    diameter = 2 * math.sqrt(2 * 3.0 * flat - flat**2)
    assert found.along == pytest.approx(diameter, rel=0.05)
    assert found.across == pytest.approx(diameter, rel=0.05)
    assert volume == pytest.approx(math.pi * flat**2 * (9.0 - flat) / 3.0, rel=0.005)


def test_balls_that_are_none():
    heights, _ = ball(0.02, 1e-4)
    with pytest.raises(InputError, match="hollow, not a ball"):
        find_worn_ball(-heights, pixel=(0.005, 0.005))
    with pytest.raises(InputError, match=r"no sphere fits|beyond the ball|nothing on the ball"):
        find_worn_ball(heights, pixel=(0.005, 0.005), radius=0.5)


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
        with pytest.raises(InputError, match=r"--diagonals has .* allowed is"):
            cap_of_diagonals(*bad, radius=3.0)
    with pytest.raises(InputError, match=r"--radius is 0 mm"):
        cap_of_diagonals(1.0, 1.0, radius=0.0)
