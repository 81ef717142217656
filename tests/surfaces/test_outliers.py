"""The outlier step: spikes go whole, wherever they are, and a surface without spikes is not touched."""

from functools import cache

import numpy as np
import pytest

from warpwear.surfaces.made.milled import Milled
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.outliers import outliers
from warpwear.surfaces.preparation import Preparation

PIXEL = 0.002
SPIKE = 0.05


@pytest.fixture(scope="module")
def rough():
    points = np.arange(200) * PIXEL
    return SelfAffine(ra=0.003).heights(points, points[:150])


def spiked(heights, *places):
    where = np.zeros(heights.shape, dtype=bool)
    for place in places:
        where[place] = True
    return heights + SPIKE * where, where


@pytest.mark.parametrize("nx", [1, 2, 4, 5])
@pytest.mark.parametrize("ny", [1, 3, 4, 5])
@pytest.mark.parametrize("corner", [(0, 0), (0, 60), (1, 2), (2, 0), (3, 1), (60, 70)])
def test_a_block_goes_whole(rough, nx, ny, corner):
    rough = rough[:100, :90]
    i, j = corner
    for sign in (1.0, -1.0):
        heights, where = spiked(sign * rough, np.s_[i : i + nx, j : j + ny])
        found = outliers(sign * heights, deviations=6.0).where
        assert found[where].all()
        # at the rim a few neighbours of a large block may go along: the surface is continued from beside it
        assert (found & ~where).sum() <= (8 if nx * ny > 12 and min(corner) < 3 else 0)


@pytest.mark.parametrize("place", [np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1], np.s_[:2, :]])
def test_a_row_along_an_edge_goes(rough, place):
    heights, where = spiked(rough, place)
    found = outliers(heights, deviations=6.0).where
    assert found[where].all()
    assert (found & ~where).sum() <= 2


def test_many_spikes_at_once_beside_holes(rough):
    heights, where = spiked(rough, np.s_[10:12, 10:13], np.s_[60:65, 40:45], np.s_[-2:, -2:], np.s_[120, :])
    heights[100:110, 80:95] = np.nan
    where[100:110, 80:95] = False
    np.testing.assert_array_equal(outliers(heights, deviations=6.0).where, where)


@pytest.mark.parametrize("cell", [0.0002, 0.0005, 0.00133, 0.003, 0.006, 0.02])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_gaussian_surface_is_untouched(cell, seed):
    points = np.arange(400) * cell
    heights = SelfAffine(ra=0.003, seed=seed).heights(points, points)
    assert outliers(heights, deviations=6.0).points == 0


@cache
def milled(lay):
    """One for all cells: it takes longer to scale than to sample."""
    return Milled(ra=0.003, lay=lay)


@pytest.mark.parametrize("cell", [0.0005, 0.001, 0.002])
@pytest.mark.parametrize(
    "lay", [pytest.param(0.0, marks=pytest.mark.slow), 30.0, pytest.param(90.0, marks=pytest.mark.slow)]
)
def test_a_milled_surface_is_untouched(cell, lay):
    points = np.arange(600) * cell
    heights = milled(lay).heights(points, points) + 0.3 * points[:, None]
    assert outliers(heights, deviations=6.0).points == 0


def test_a_sphere_is_untouched():
    points = (np.arange(300) - 149.5) * 0.003
    ball = np.sqrt(3.0**2 - points[:, None] ** 2 - points**2)
    assert outliers(ball, deviations=6.0).points == 0


@pytest.mark.parametrize("shape", [(2, 2), (1, 9), (3, 40), (5, 5), (6, 7)])
def test_small_fields(shape):
    heights = np.random.default_rng(0).normal(size=shape)
    assert outliers(heights, deviations=30.0).where.shape == shape
    assert outliers(np.zeros(shape), deviations=6.0).points == 0


def test_many_removed_is_a_notice(tmp_path, rough):
    points = (np.arange(100) - 49.5) * PIXEL
    # a smooth majority with rough valleys
    plateau = np.where(rough < -0.001, rough, 1e-4 * rough)
    for name, height, told in (("plateau", plateau, True), ("rough", rough, False)):
        np.save(tmp_path / f"{name}.npy", height)
        surface = read_measured(
            tmp_path / f"{name}.npy", Preparation(outliers=6.0), pixel=PIXEL, height_unit="mm"
        )
        notices = [text for text in surface.notices(points, points) if text.startswith("outliers: ")]
        assert len(notices) == told
        removed = surface.record()["outliers_removed"]
        if told:
            share = 100.0 * removed / rough.size
            assert f"{removed} points, {share:.3g} % of the measurement" in notices[0]


def test_a_spike_that_was_left_is_told_of(rough, tmp_path):
    """Not the same surface without it, nor with it removed, nor a hole as deep."""

    def told(heights, **preparation):
        np.save(tmp_path / "disc.npy", heights)
        surface = read_measured(
            tmp_path / "disc.npy", Preparation(**preparation), pixel=PIXEL, height_unit="mm"
        )
        middle = np.linspace(-0.1, 0.1, 100)
        return [notice for notice in surface.notices(middle, middle) if "spikes of an instrument" in notice]

    heights, _ = spiked(rough, (60, 70))
    (notice,) = told(heights)
    assert "stands 1" in notice
    assert "disc.outliers, such as 6" in notice
    assert not told(heights, outliers=6.0)
    assert not told(rough)
    assert not told(2.0 * rough - heights)
