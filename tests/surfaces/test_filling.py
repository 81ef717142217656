"""Points that were not measured: no number is made of them, and everyone is told where they are."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from warpwear.cli.surface import describe
from warpwear.errors import InputError
from warpwear.figures.paint import paint
from warpwear.figures.paint_map import paint_map
from warpwear.laws.form import sag
from warpwear.measured.surface_figure import _map_of_heights, patch_figure, track_figure
from warpwear.measured.surface_report import examine
from warpwear.surfaces.filling import completed
from warpwear.surfaces.levelling import areal_low_pass, without_polynomial
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.measured import Measured, read_measured
from warpwear.surfaces.preparation import Preparation
from warpwear.surfaces.roughness import bearing_parameters, height_parameters, profile_roughness
from warpwear.surfaces.spectrum import slope_against_cut_off
from warpwear.surfaces.sphere import places
from warpwear.surfaces.worn.ball import find_worn_ball
from warpwear.surfaces.worn.track import find_track

PIXEL = (0.002, 0.002)
POINTS = places((300, 300), PIXEL)
TWICE = (0.004, 0.004)
SECOND = places((150, 150), TWICE)
ROUND = np.hypot.outer(*POINTS) > 0.28  # beyond a round field of view: 32 % of the points


@pytest.fixture(scope="module")
def rough() -> np.ndarray:
    return SelfAffine(sq=0.0044, period=0.6).heights(*POINTS)


def read(folder: Path, heights: np.ndarray, **preparation) -> Measured:
    np.save(folder / "disc.npy", heights)
    return read_measured(
        folder / "disc.npy", Preparation(**preparation), pixel=PIXEL, height_unit="mm", extend="periodic"
    )


def test_parameters_are_of_measured_points_alone(tmp_path: Path, rough: np.ndarray) -> None:
    spiked = (
        rough.copy()
    )  # a rim as instruments leave it, which a continuation would carry on into the corners
    spiked[ROUND & (np.hypot.outer(*POINTS) < 0.282)] = 0.15
    rim = spiked == 0.15
    holed = np.where(ROUND & ~rim, np.nan, spiked)
    found = read(tmp_path, holed + 0.3 * POINTS[0][:, None])
    there = ~np.isnan(holed)
    levelled = found.levelled[there]
    expected = height_parameters(levelled) | vars(bearing_parameters(levelled))
    record = found.record()
    assert record["sq_um"] == pytest.approx(1e3 * expected["sq"], rel=1e-12)
    assert record["sz_um"] == pytest.approx(1e3 * expected["sz"], rel=1e-12)
    report = examine(found)
    assert report.bearing.sk == pytest.approx(expected["sk"], rel=1e-12)
    assert np.array_equal(np.isnan(found.measured), ~there)
    # far from the rim there is nothing but the mean plane
    assert np.abs(found.levelled[:10, :10]).max() < 1e-6
    assert np.abs(found.levelled[~there]).max() <= 0.16


def test_a_round_field_of_view_shows_the_surface_that_is_in_it(tmp_path: Path, rough: np.ndarray) -> None:
    found, whole = read(tmp_path, np.where(ROUND, np.nan, rough)), read(tmp_path, rough)
    one, other = examine(found), examine(whole)
    inside = without_polynomial(np.where(ROUND, np.nan, rough), degree=1)
    assert found.record()["sq_um"] == pytest.approx(1e3 * np.nanstd(inside), rel=1e-9)
    assert found.record()["rms_slope"] == pytest.approx(whole.record()["rms_slope"], rel=0.03)
    np.testing.assert_allclose(one.slopes[:15], other.slopes[:15], rtol=0.06)
    waves = slice(-12, -3)  # of which there are many, up to the shortest that the surface has
    np.testing.assert_allclose(one.spectrum.density[waves], other.spectrum.density[waves], rtol=0.03)
    for axis in (0, 1):
        how = {"pixel": PIXEL, "axis": axis, "cut_off": 0.08, "short": 0.0025}
        some, every = (profile_roughness(surface.measured, **how) for surface in (found, whole))
        assert some.ra == pytest.approx(every.ra, rel=0.03)
        assert 0 < some.profiles < 300
        assert any("profiles left out" in note for note in some.notes)


def test_holes_are_bridged_and_what_lies_beyond_is_the_mean_plane(rough: np.ndarray) -> None:
    plane = np.add.outer(0.5 * POINTS[0], -0.2 * POINTS[1])
    holed = without_polynomial(np.where(ROUND, np.nan, rough), degree=1) + plane
    holed[140:150, 120:160] = np.nan
    whole = completed(holed, pixel=PIXEL)
    there = ~np.isnan(holed)
    assert np.array_equal(whole[there], holed[there])
    assert np.isfinite(whole).all()
    rim = (holed - plane)[138:152, 118:162]
    inside = (whole - plane)[140:150, 120:160]
    assert np.nanmin(rim) - 0.002 < inside.min() < inside.max() < np.nanmax(rim) + 0.002
    assert np.abs((whole - plane)[[0, 0, -1, -1], [0, -1, 0, -1]]).max() < 3e-4
    # and the rim is no step
    steps = np.abs(np.diff(whole - plane, axis=0))
    assert steps[(there[1:] != there[:-1])].max() < 1.5 * steps[there[1:] & there[:-1]].max()


def test_missing_points_have_no_weight_in_filters(rough: np.ndarray) -> None:
    heights = np.where(ROUND, np.nan, rough)
    smooth = areal_low_pass(heights, pixel=PIXEL, cut_off=0.03)
    assert np.array_equal(np.isnan(smooth), ROUND)
    np.testing.assert_allclose(
        areal_low_pass(np.where(ROUND, np.nan, 7.0), pixel=PIXEL, cut_off=0.03)[~ROUND], 7.0, rtol=1e-12
    )
    inside = np.hypot.outer(*POINTS) < 0.22
    whole = areal_low_pass(rough, pixel=PIXEL, cut_off=0.03)
    np.testing.assert_allclose(smooth[inside], whole[inside], atol=1e-6)


def test_slopes_do_not_count_what_is_smooth(rough: np.ndarray) -> None:
    measured = ~ROUND
    whole = completed(np.where(measured, rough, np.nan), pixel=PIXEL)
    cut_offs = np.array([0.01])
    found = slope_against_cut_off(whole, pixel=PIXEL, cut_offs=cut_offs, measured=measured)
    assert found[0] == pytest.approx(
        slope_against_cut_off(rough, pixel=PIXEL, cut_offs=cut_offs)[0], rel=0.05
    )


@pytest.mark.parametrize(("rows", "warns"), [(5, False), (6, True)])
def test_two_percent_missing_is_a_warning(tmp_path: Path, rough: np.ndarray, rows: int, warns: bool) -> None:
    x = POINTS[0][100:200]
    for place, words in (
        (np.s_[:rows], f"{100 * rows / 300:.3g} % of the measurement is missing"),
        (np.s_[140:150, 139 : 138 + 4 * rows], f"{0.1 * (4 * rows - 1):.3g} % of the points used"),
    ):
        holed = rough.copy()
        holed[place] = np.nan
        told = [text for text in read(tmp_path, holed).notices(x, x) if "was filled in" in text]
        assert len(told) == warns
        assert all(words in text for text in told)


def test_where_points_were_filled_is_known_on_every_grid(tmp_path: Path, rough: np.ndarray) -> None:
    holed = rough.copy()
    holed[10:20, 250:] = np.nan
    found = read(tmp_path, holed, sliding_axis="y")
    assert np.array_equal(found.filled_at(*POINTS), np.isnan(holed).T)
    # periodic: one width further is the same place
    x, y = POINTS[0] + 0.6, POINTS[1] - 1.2
    assert np.array_equal(found.filled_at(x, y), np.isnan(holed).T)
    assert read(tmp_path, rough).filled_at(*POINTS) is None


def test_every_picture_hatches_them(tmp_path: Path, rough: np.ndarray) -> None:
    filled = np.zeros((150, 150), dtype=np.bool_)
    filled[0, 0] = filled[20:30, 100:130] = True
    trough = -0.02 * np.maximum(1.0 - np.square(SECOND[1] / 0.1), 0.0)
    some = rough[::2, ::2]
    ball = find_worn_ball(np.minimum(-sag(*SECOND, radius=1.0), -0.01) + 0.01 * some, pixel=TWICE, radius=1.0)
    track = find_track(0.1 * some + trough, pixel=TWICE)
    np.save(tmp_path / "disc.npy", np.where(filled, np.nan, some))
    how = {"pixel": "4 um", "height_unit": "mm"}
    describe(tmp_path / "disc.npy", how, figure=tmp_path / "a.svg")
    assert "<pattern" in (tmp_path / "a.svg").read_text()
    for draw in (
        lambda where: track_figure(track, filled=where),
        lambda where: patch_figure(ball, filled=where),
    ):
        told = [paint(draw(where)).axes[0].get_title() for where in (filled, None)]
        assert told == ["hatched: not measured, filled in", ""]


@pytest.mark.parametrize("seen", [0.6, pytest.param(0.28, marks=pytest.mark.slow), 0.24])
def test_a_ball_without_its_steep_corners_has_lost_the_same(rough: np.ndarray, seen: float) -> None:
    worn = np.minimum(-sag(*SECOND, radius=1.0), -0.01) + 0.01 * rough[::2, ::2]
    holed = np.where(np.hypot.outer(*SECOND) > seen, np.nan, worn)
    holed[75:77, 70:80] = np.nan
    ball = find_worn_ball(holed, pixel=TWICE, radius=1.0)
    lost = np.pi * 0.01**2 * (3.0 - 0.01) / 3.0
    assert ball.volume == pytest.approx(lost, rel=0.01)
    if seen > 0.25:  # less of it is too little to tell the radius from, too
        fitted = find_worn_ball(holed, pixel=TWICE)
        assert fitted.sphere.radius == pytest.approx(1.0, rel=0.01)
        assert fitted.volume == pytest.approx(lost, rel=0.03)
    else:
        with pytest.raises(InputError, match="to tell its radius from: --radius gives it"):
            find_worn_ball(holed, pixel=TWICE)


def test_hatching_lies_where_points_were_filled() -> None:
    filled = np.zeros((30, 20), dtype=np.bool_)
    filled[25:, :4] = True
    axes = mpl.figure.Figure().add_subplot()
    paint_map(axes, _map_of_heights(np.zeros((30, 20)), (3.0, 2.0), filled))
    (hatched,) = axes.collections
    corners = np.concatenate([path.vertices for path in hatched.get_paths()])
    np.testing.assert_allclose(corners.min(axis=0)[0], 1.0, atol=0.051)
    np.testing.assert_allclose(corners.max(axis=0)[1], -0.6, atol=0.051)
    assert hatched.hatches == ["//////"]


def test_spikes_that_were_filled_do_not_set_the_colours(rough: np.ndarray) -> None:
    filled = np.zeros(rough.shape, dtype=np.bool_)
    filled[:30] = True
    ranges = []
    for heights, where in ((np.where(filled, 1.0, rough), filled), (rough[30:], None)):
        scale = _map_of_heights(heights, (0.6, 0.6), where).scale
        ranges.append((scale.low, scale.high))
    assert ranges[0] == pytest.approx(ranges[1])
