"""Measured surfaces: interpolation, what lies beyond, the filter against aliasing, what is recorded."""

import json
import tracemalloc

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.measured import Measured, read_measured
from warpwear.surfaces.preparation import Preparation, degree_of

PIXEL = 0.001


def measured(heights, *, pixel=(PIXEL, PIXEL), extend="refuse"):
    return Measured(levelled=heights, pixel=pixel, extend=extend, details={})


def centres(count, pixel=PIXEL):
    return (np.arange(count) - (count - 1) / 2) * pixel


def wave(count, length, pixel=PIXEL):
    """A cosine of the wavelength [mm] over the index, its phase such that a mirror continues it."""
    return np.cos(2 * np.pi * (np.arange(count) + 0.5) * pixel / length)


@pytest.fixture
def rough():
    return np.random.default_rng(0).normal(size=(60, 40)) * 1e-3


@pytest.fixture
def saved(tmp_path, rough):
    path = tmp_path / "disc.npy"
    np.save(path, rough * 1e3)
    return path


@pytest.mark.parametrize("extend", ["refuse", "mirror", "periodic"])
def test_goes_through_its_points(rough, extend):
    found = measured(rough, extend=extend).heights(centres(60), centres(40))
    np.testing.assert_allclose(found, rough, rtol=0, atol=1e-15)


@pytest.mark.parametrize("extend", ["refuse", "mirror", "periodic"])
def test_is_smooth_and_right_between_its_points(extend):
    heights = np.multiply.outer(wave(64, 0.032), wave(48, 0.024))
    x = np.linspace(-0.025, 0.025, 301)
    y = np.linspace(-0.02, 0.02, 201)
    exact = np.multiply.outer(np.cos(2 * np.pi * (x / 0.032 + 1.0)), np.cos(2 * np.pi * (y / 0.024 + 1.0)))
    found = measured(heights, extend=extend).heights(x, y)
    np.testing.assert_allclose(found, exact, rtol=0, atol=2e-4)


def test_pixels_need_not_be_square():
    heights = np.multiply.outer(np.arange(20.0), np.ones(30)) + np.arange(30.0)
    surface = measured(heights, pixel=(0.002, 0.005))
    assert surface.size == pytest.approx((0.04, 0.15))
    found = surface.heights(np.array([-0.001, 0.001]), np.array([-0.0025, 0.0025]))
    np.testing.assert_allclose(found, [[9 + 14, 9 + 15], [10 + 14, 10 + 15]], atol=1e-9)


def test_refuses_to_leave_the_measurement(rough):
    surface = measured(rough)
    assert surface.heights(np.array([-0.03, 0.03]), np.array([0.02])).shape == (2, 1)
    for x, y in ((0.031, 0.0), (-0.031, 0.0), (0.0, 0.021)):
        with pytest.raises(
            InputError, match=r'disc\.extend is "refuse".*0\.06 × 0\.04 mm.*allowed is "mirror"'
        ):
            surface.heights(np.array([x]), np.array([y]))


def test_mirror_is_a_mirror_without_a_seam(rough):
    rough = np.cumsum(rough, axis=0)  # ends at other heights than it starts with
    surface = measured(rough, extend="mirror")
    inward = 0.0003 * np.arange(1, 120)
    y = centres(40)
    inside, outside = surface.heights(0.03 - inward[::-1], y)[::-1], surface.heights(0.03 + inward, y)
    np.testing.assert_allclose(outside, inside, rtol=0, atol=1e-14)
    far = surface.heights(0.03 + inward + 3 * 0.12, y)
    np.testing.assert_allclose(far, outside, rtol=0, atol=1e-14)
    across = surface.heights(0.03 + 1e-6 * np.arange(-2, 3), y)
    assert np.abs(np.diff(across, axis=0)).max() < 0.01 * np.abs(np.diff(rough, axis=0)).max()


def test_periodic_repeats(rough):
    surface = measured(rough, extend="periodic")
    x, y = np.linspace(-0.03, 0.03, 77), np.linspace(-0.02, 0.02, 51)
    np.testing.assert_allclose(surface.heights(x + 0.06, y - 0.08), surface.heights(x, y), rtol=0, atol=1e-14)
    # the first point follows the last, one pixel on
    np.testing.assert_allclose(
        surface.heights(centres(60) + PIXEL, centres(40)), np.roll(rough, -1, axis=0), atol=1e-15
    )


@pytest.mark.parametrize("extend", ["mirror", "periodic"])
@pytest.mark.parametrize(("length", "passed"), [(0.016, 0.5), (0.032, 2**-0.25), (0.008, 2**-4.0)])
def test_filter_against_aliasing_transmits_half_at_two_cells(extend, length, passed):
    cell = 0.008
    heights = np.multiply.outer(wave(512, length), np.ones(16))
    surface = measured(heights, extend=extend)
    # points at crests and troughs of the wave; the other axis keeps its pixel and must stay as it is
    x = -0.256 + cell * np.arange(60)
    found = surface.heights(x, centres(16))
    np.testing.assert_allclose(
        found, passed * np.outer(np.cos(2 * np.pi * (x + 0.256) / length), np.ones(16)), atol=2e-4
    )
    assert np.abs(found).max() == pytest.approx(passed, abs=1e-3)


def test_filter_works_on_both_axes_each_with_its_own_cell():
    heights = np.multiply.outer(wave(512, 0.016), wave(512, 0.032))
    surface = measured(heights, extend="mirror")
    x, y = -0.256 + 0.008 * np.arange(40), -0.256 + 0.016 * np.arange(30)
    assert np.abs(surface.heights(x, y)).max() == pytest.approx(0.25, abs=1e-3)


def test_says_what_sampling_did():
    smooth = np.multiply.outer(wave(60, 0.04), wave(40, 0.04))
    surface = measured(smooth, extend="mirror")
    same, coarse, fine = (centres(20, cell) for cell in (PIXEL, 0.0015, 0.00025))
    assert surface.notices(same, same) == []
    (notice,) = surface.notices(coarse, coarse)
    assert "low-pass" in notice
    assert "cut-off 3 µm" in notice
    (notice,) = surface.notices(fine, fine)
    assert "coarser than the cell 0.25 µm: nothing shorter than 2 µm" in notice
    assert [n.startswith("along x") for n in surface.notices(coarse, same)] == [True]
    assert [n.startswith("along y") for n in surface.notices(same, fine)] == [True]
    assert "mirrored" in surface.notices(centres(70), same)[0]
    assert "repeated" in measured(smooth, extend="periodic").notices(centres(70), same)[0]


def test_says_how_high_the_seam_is(rough):
    """A tilt of 10 µm that nobody took off is a step where the measurement is repeated."""
    tilted = rough + np.linspace(0.0, 0.01, 60)[:, None]
    for length in (60, 90):  # a lap of the whole measurement has the seam as well
        notices = measured(tilted, extend="periodic").notices(centres(length), centres(20))
        (seam,) = [notice for notice in notices if "do not fit" in notice]
        step = 1e3 * np.sqrt(np.mean((tilted[0] - tilted[-1]) ** 2))
        assert f"a step of {step:.4g} µm rms along x, " in seam
    for surface in (measured(tilted, extend="mirror"), measured(rough, extend="periodic")):
        assert not any("do not fit" in notice for notice in surface.notices(centres(90), centres(20)))
    inside = measured(tilted, extend="periodic").notices(centres(20), centres(20))
    assert not any("do not fit" in notice for notice in inside)


def test_says_how_high_the_step_is_where_a_lap_closes(rough):
    """A mirrored map repeats after twice its length; half a millimetre of a slope of 10 µm does not."""
    tilted = np.cumsum(rough, axis=0) + np.linspace(0.0, 0.01, 60)[:, None]
    mirrored = measured(tilted, extend="mirror")
    assert mirrored.lap_seam(centres(120), centres(20)) == []
    assert measured(rough).lap_seam(centres(50), centres(20)) == []  # as between other rows
    (seam,) = measured(tilted).lap_seam(centres(60), centres(40))
    step = 1e3 * np.sqrt(np.mean((tilted[0] - tilted[-1]) ** 2))
    assert f"sliding.track = 0.06 mm: it has a seam of {step:.4g} µm rms" in seam


def test_says_when_slopes_depend_on_the_shortest_wave(rough):
    same = centres(20)
    (notice,) = measured(rough).notices(same, same)
    assert "rms slope still depends on the shortest wavelength" in notice
    assert "from 2 µm on" in notice
    assert "from 4 µm on" in notice


def test_memory_stays_near_the_output(rough):
    surface, points = measured(rough, extend="mirror"), centres(1500)
    tracemalloc.start()
    field = surface.heights(points, points)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2 * field.nbytes


def test_npy_round_trip(saved, rough):
    surface = read_measured(saved, Preparation(level="none"), pixel=PIXEL, height_unit="um")
    np.testing.assert_allclose(surface.levelled, rough - rough.mean(), rtol=0, atol=1e-17)
    assert surface.pixel == (PIXEL, PIXEL)
    record = json.loads(json.dumps(surface.record()))
    assert record["kind"] == "measured"
    assert record["file"] == "disc.npy"
    assert record["file_grid"] == [60, 40]
    assert record["file_pixel_um"] == pytest.approx([1.0, 1.0])
    assert record["file_extent_mm"] == pytest.approx([0.06, 0.04])
    assert record["unit"] == "um"
    assert record["missing"] == 0
    assert record["sq_um"] == pytest.approx(rough.std() * 1e3, rel=1e-12)
    assert record["height_max_um"] == pytest.approx(rough.max() * 1e3, rel=1e-12)


def test_a_tilt_goes_and_is_told(tmp_path, rough):
    tilted = rough + np.add.outer(0.01 * np.arange(60), 0.02 * np.arange(40)) + 5.0
    np.save(tmp_path / "tilted.npy", tilted)
    surface = read_measured(tmp_path / "tilted.npy", pixel=PIXEL, height_unit="mm")
    record = surface.record()
    assert record["sq_as_read_um"] == pytest.approx(tilted.std() * 1e3)
    assert record["sq_um"] == pytest.approx(rough.std() * 1e3, rel=0.01)
    assert "plane" in record["operations"][0]
    bent = read_measured(tmp_path / "tilted.npy", Preparation(level=4), pixel=PIXEL, height_unit="mm")
    assert bent.record()["sq_um"] < record["sq_um"]
    left = read_measured(tmp_path / "tilted.npy", Preparation(level="none"), pixel=PIXEL, height_unit="mm")
    assert left.record()["sq_um"] == pytest.approx(tilted.std() * 1e3)


def test_missing_points_are_filled_and_counted(tmp_path, rough):
    rough[5:9, 10:20] = np.nan
    rough[30, 30] = np.inf
    np.save(tmp_path / "holes.npy", rough)
    surface = read_measured(tmp_path / "holes.npy", pixel=PIXEL, height_unit="mm")
    assert np.isfinite(surface.levelled).all()
    record = surface.record()
    assert record["missing"] == 41
    assert record["missing_percent"] == pytest.approx(100 * 41 / 2400)
    assert any("filled" in operation for operation in record["operations"])


def test_sliding_axis_transposes(saved, rough):
    along_x = read_measured(saved, pixel=(0.001, 0.002), height_unit="um")
    turned = Preparation(sliding_axis="y")
    along_y = read_measured(saved, turned, pixel=(0.001, 0.002), height_unit="um")
    assert along_y.pixel == (0.002, 0.001)
    np.testing.assert_allclose(along_y.levelled, along_x.levelled.T, rtol=0, atol=1e-17)
    x, y = centres(20), centres(30)
    np.testing.assert_allclose(along_y.heights(x, y), along_x.heights(y, x).T, rtol=0, atol=1e-15)
    assert along_y.record()["file_grid"] == [60, 40]
    assert "transposed" in along_y.record()["operations"][0]


def test_heights_cannot_be_written_to(saved):
    with pytest.raises(ValueError, match="read-only"):
        read_measured(saved, pixel=PIXEL, height_unit="um").levelled[0, 0] = 1.0


def test_a_unit_of_metres_makes_sq_one_metre_which_is_absurd(saved):
    with pytest.raises(InputError, match=r"disc\.surface\b.*allowed is"):
        read_measured(saved, pixel=PIXEL, height_unit="m")


@pytest.mark.parametrize("level", ["cubic", -1, 13, True])
def test_refuses_a_level_that_is_none(level):
    with pytest.raises(InputError, match=r"disc\.level is .*allowed is"):
        degree_of(level)
