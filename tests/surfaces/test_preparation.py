"""The chain of operations: each one alone, their order, and what is told of them."""

import json

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.levelling import areal_low_pass
from warpwear.surfaces.made.milled import Milled
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.outliers import outliers
from warpwear.surfaces.preparation import Preparation
from warpwear.surfaces.sphere import Sphere, fit_sphere, places

PIXEL = 0.002
POINTS = (np.arange(200) - 99.5) * PIXEL


@pytest.fixture(scope="module")
def rough():
    return SelfAffine(ra=0.003).heights(POINTS, POINTS[:150])


@pytest.fixture
def measure(tmp_path):
    def read(heights, **options):
        np.save(tmp_path / "disc.npy", heights)
        return read_measured(tmp_path / "disc.npy", Preparation(**options), pixel=PIXEL, height_unit="mm")

    return read


def test_height_sign(measure, rough):
    down = measure(rough, height_sign="down")
    np.testing.assert_allclose(down.levelled, -measure(rough).levelled, atol=1e-15)
    assert "turned over" in down.record()["operations"][0]


def test_crop_by_places_and_by_size(measure, rough):
    cropped = measure(rough, crop=(0.1, 0.3, 0.0, 0.1), level="none")
    expected = rough[50:150, 0:50]
    np.testing.assert_allclose(cropped.levelled, expected - expected.mean(), atol=1e-15)
    assert "100 × 50 points" in cropped.record()["operations"][0]
    middle = measure(rough, crop=(0.2, 0.1), level="none")
    expected = rough[50:150, 50:100]
    np.testing.assert_allclose(middle.levelled, expected - expected.mean(), atol=1e-15)
    # the file's frame: before its axes are exchanged
    turned = measure(rough, crop=(0.1, 0.3, 0.0, 0.1), level="none", sliding_axis="y")
    np.testing.assert_allclose(turned.levelled, cropped.levelled.T, atol=1e-15)


def test_a_sphere_is_taken_off_and_its_radius_told(measure, rough):
    x, y = places(rough.shape, (PIXEL, PIXEL))
    ball = Sphere((0.03, -0.02, 1.0), 3.0).heights(x, y)
    levelled = measure(ball + 1e-3 * rough, level="sphere")
    assert np.abs(levelled.levelled).max() < 2.0 * np.abs(1e-3 * rough).max()
    assert any("sphere of radius 3" in o and "bulging" in o for o in levelled.record()["operations"])
    hollow = measure(-ball, level="sphere")
    assert any("hollow" in o for o in hollow.record()["operations"])
    assert np.abs(hollow.levelled).max() < 1e-9


@pytest.mark.parametrize("form", ["sphere", "cylinder"])
def test_what_has_no_such_form_is_told(measure, form):
    with pytest.raises(InputError, match=rf'"{form}" and no {form} fits .*\(no curvature\): allowed'):
        measure(np.zeros((50, 60)), level=form)


def test_fit_of_a_sphere_is_exact():
    x, y = places((120, 90), (0.004, 0.006))
    for radius in (3.0, -0.8, 250.0):
        true = Sphere((0.05, 0.11, -2.0), radius)
        found = fit_sphere(true.heights(x, y), pixel=(0.004, 0.006))
        assert found.radius == pytest.approx(radius, rel=1e-6)
        np.testing.assert_allclose(found.apex, true.apex, atol=1e-5)


def test_a_spike_goes_and_peaks_stay(measure, rough):
    spiked = rough.copy()
    spiked[70, 60] += 0.05
    spiked[120:122, 30] -= 0.03
    surface = measure(spiked, outliers=6.0)
    told = surface.record()["operations"][0]
    assert "3 points in 2 groups farther than 6 robust standard deviations" in told
    assert surface.record()["outliers_removed"] == 3
    clean = measure(rough)
    changed = np.abs(surface.levelled - clean.levelled) > 1e-5
    assert changed.sum() <= 3
    assert np.abs(surface.levelled - clean.levelled).max() < 0.002
    assert measure(rough, outliers=6.0).record()["outliers_removed"] == 0


@pytest.mark.parametrize("cell", [0.0005, 0.00133, 0.003, 0.006])
def test_a_gaussian_surface_has_no_outliers(cell):
    points = np.arange(600) * cell
    heights = SelfAffine(ra=0.003, seed=3).heights(points, points)
    assert outliers(heights, deviations=6.0).points == 0


def test_edges_and_tilt_are_no_outliers():
    points = np.arange(300) * 0.001
    heights = Milled(ra=0.003, lay=90.0).heights(points, points) + 0.3 * points[:, None]
    assert outliers(heights, deviations=6.0).points == 0
    heights[0, 0] += 0.05
    heights[150, -1] -= 0.05
    found = outliers(heights, deviations=6.0).where
    assert found[0, 0]
    assert found[150, -1]
    assert found.sum() == 2


def test_a_spike_on_a_flat_is_an_outlier():
    flat = np.zeros((40, 40))
    flat[10, 10] = 1.0
    found = outliers(flat, deviations=6.0)
    assert found.points <= 1
    assert outliers(np.zeros((40, 40)), deviations=6.0).points == 0


@pytest.mark.parametrize(("cut_off", "length", "passed"), [(0.05, 0.05, 0.5), (0.05, 0.1, 2**-0.25)])
@pytest.mark.parametrize("axis", [0, 1])
def test_s_and_l_filter_transmit_half_at_the_cut_off(measure, cut_off, length, passed, axis):
    wave = np.cos(2 * np.pi * (np.arange(200) + 0.5) * PIXEL / length)
    field = np.broadcast_to(wave[:, None] if axis == 0 else wave[None, :], (200, 200)) * 1e-3
    kept = measure(field, s_filter=cut_off, level="none").levelled
    np.testing.assert_allclose(kept, passed * (field - field.mean()), atol=1e-12)
    rest = measure(field, l_filter=cut_off, level="none").levelled
    np.testing.assert_allclose(rest, (1 - passed) * (field - field.mean()), atol=1e-12)


def test_s_and_l_filter_share_the_surface(rough):
    smooth = areal_low_pass(rough, pixel=(PIXEL, PIXEL), cut_off=0.05)
    assert smooth.mean() == pytest.approx(rough.mean(), abs=1e-15)
    assert smooth.std() < rough.std()


def test_everything_is_told_in_its_order(measure, rough):
    holed = rough.copy()
    holed[3:9, 5:9] = np.nan
    holed[100, 100] += 0.05
    surface = measure(
        holed,
        height_sign="down",
        crop=(0.38, 0.28),
        sliding_axis="y",
        outliers=6,
        level=2,
        s_filter=0.008,
        l_filter=0.2,
    )
    told = surface.record()["operations"]
    expected = [
        "turned over",
        "cropped",
        "transposed",
        "outliers: 1",
        "degree 2",
        "S-filter",
        "L-filter",
        "filled",
    ]
    assert len(told) == len(expected)
    assert all(word in text for word, text in zip(expected, told, strict=True))
    assert "8 µm" in told[-3]
    assert "200 µm" in told[-2]
    json.dumps(surface.record())


def test_much_missing_is_a_notice(measure, rough):
    holed = rough.copy()
    holed[:40] = np.nan
    surface = measure(holed)
    points = POINTS[50:100]
    assert any("20 % of the measurement is missing" in notice for notice in surface.notices(points, points))


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"crop": (0.0, 0.5, 0.0, 0.1)}, "crop"),
        ({"crop": (0.2, 0.1, 0.0, 0.1)}, "crop"),
        ({"crop": (0.1, 0.101, 0.0, 0.1)}, "crop"),
        ({"crop": (1.0, 0.1)}, "crop"),
        ({"s_filter": 0.001}, "s_filter"),
        ({"s_filter": 1.0}, "s_filter"),
        ({"l_filter": 0.5}, "l_filter"),
        ({"s_filter": 0.1, "l_filter": 0.1}, "s_filter"),
    ],
)
def test_refusals_name_the_key(measure, rough, options, field):
    with pytest.raises(InputError, match=rf"disc\.{field} is .*allowed is"):
        measure(rough, **options)


def test_a_crop_of_nothing(measure, rough):
    holed = rough.copy()
    holed[:50] = np.nan
    with pytest.raises(InputError, match=r"disc\.crop leaves no valid point"):
        measure(holed, crop=(0.0, 0.1, 0.0, 0.1))


def test_millimetres_that_mean_micrometres(tmp_path, rough):
    # Sq of 3.8 "mm", and the slopes of a surface of less Sq
    for factor, what in ((1e3, "Sq = "), (100.0, "slopes of ")):
        np.save(tmp_path / "disc.npy", factor * rough)
        with pytest.raises(InputError, match=rf'{what}.*allowed is at most.*disc\.height_unit, such as "um"'):
            read_measured(tmp_path / "disc.npy", pixel=PIXEL, height_unit="mm")


def test_a_tilt_is_told_and_doubted_where_heights_over_it_are_larger(measure, rough):
    x, y = POINTS[:, None], POINTS[None, :150]
    for degrees, doubted in ((2.0, False), (45.0, True)):
        slope = np.tan(np.radians(degrees))
        found = measure(rough + slope * (0.6 * x + 0.8 * y))
        assert found.details["tilt_degrees"] == pytest.approx(degrees, abs=0.6)
        assert f"tilted by {found.details['tilt_degrees']:.3g}°" in found.details["operations"][-1]
        text = " ".join(found.notices(POINTS, POINTS[:150]))
        assert ("heights over the mean plane are vertical, 4" in text) == doubted
    assert measure(rough, level="none").details["tilt_degrees"] < 1e-9
