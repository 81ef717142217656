"""Errors of worn volumes are what they say: 68 % of true volumes lie within one, 95 % within two."""

import numpy as np
import pytest
from cases_worn import PIXEL, flattened, grooved

from warpwear.errors import InputError
from warpwear.measured.surface_report import track_rows
from warpwear.results.report import lines
from warpwear.surfaces.worn.ball import find_worn_ball
from warpwear.surfaces.worn.track import find_track


def off_by_errors(kind, cases, *, given=True, shape=(80, 200), depth=(2.0, 8.0), seed=1):
    """Return by how many errors volumes of grooves are off, and how their widths compare to the true ones."""
    rng, off, widths = np.random.default_rng(seed), [], []
    for _ in range(cases):
        heights, width, volume = grooved(rng, kind, shape=shape, depth=depth)
        try:
            found = find_track(heights, pixel=(PIXEL, PIXEL), width=1.2 * width if given else None)
        except InputError:
            continue
        measured, error = found.volume()
        off.append((measured - volume) / error)
        widths.append(found.width / width)
    return np.array(off), np.array(widths)


def said(kind, off, *more):
    """Print a line of the table of coverage."""
    inside = [float(np.mean(np.abs(off) < k)) for k in (1, 2, 3)]
    print(f"{kind:12} {off.size:4} cases: " + ", ".join(f"{100 * v:.0f} %" for v in inside), *more)
    return inside


@pytest.mark.slow
def test_a_volume_is_off_by_its_error_where_the_surface_is_wavy():
    # the scatter of sections along the track knows nothing of waves that run along it
    off, widths = zip(
        *(off_by_errors(kind, 14, shape=(60, 160)) for kind in ("turned", "self-affine", "rolled-off")),
        strict=True,
    )
    off, widths = np.concatenate(off), np.concatenate(widths)
    one, two, three = said("together", off)
    assert 0.55 < one < 0.9
    assert two > 0.88
    assert three > 0.95
    # not the width of the window, which is 1.2 times that of the groove
    assert np.median(widths) == pytest.approx(1.0, abs=0.03)
    assert np.std(widths) < 0.12


def test_a_groove_that_waviness_hides_is_doubted():
    rng = np.random.default_rng(1)
    for kind, doubted in (("self-affine", True), ("rolled-off", False)):
        heights, width, _ = grooved(rng, kind, depth=(0.5, 0.6) if doubted else (8.0, 9.0))
        found = find_track(heights, pixel=(PIXEL, PIXEL), width=1.2 * width)
        text = "\n".join(lines(track_rows(found, length=None)))
        assert ("neither volume nor width is told from the surface's own waviness" in text) == doubted


def test_a_groove_in_a_flat_has_no_error():
    y = np.linspace(-0.595, 0.595, 120)
    groove = np.broadcast_to(0.01 * np.maximum(1.0 - np.square(y / 0.2), 0.0), (40, 120))
    found = find_track(-groove, pixel=(0.01, 0.01))
    assert found.net_error < 1e-9 * found.net.mean()
    assert found.net.mean() == pytest.approx(groove[0].sum() * 0.01, rel=1e-6)


def test_missing_points_are_left_out():
    rng = np.random.default_rng(3)
    heights, _, volume = grooved(rng, "rolled-off", depth=(8.0, 9.0))
    holes = rng.random(heights.shape) < 0.2
    holes[:, 40:42] = True
    pierced = np.where(holes, np.nan, heights)
    found = find_track(pierced, pixel=(PIXEL, PIXEL))
    assert found.volume()[0] == pytest.approx(find_track(heights, pixel=(PIXEL, PIXEL)).volume()[0], rel=0.02)
    assert abs(found.volume()[0] - volume) < 3 * found.volume()[1]
    assert (found.missing == holes).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["turned", "self-affine", "rolled-off", "real"])
@pytest.mark.parametrize("given", [True, False])
def test_coverage_of_tracks(kind, given):
    off, widths = off_by_errors(
        kind, 200, given=given, shape=(200, 400), depth=(2.0, 8.0) if given else (4.0, 10.0)
    )
    one, two, three = said(
        kind, off, f"width {np.median(widths):.3f} ± {np.std(widths):.3f}, mean {off.mean():+.2f}"
    )
    assert 0.5 < one < 0.92
    assert two > 0.85
    assert three > 0.93


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["self-affine", "rolled-off"])
def test_coverage_of_balls(kind):
    rng, off = np.random.default_rng(4), []
    for _ in range(200):
        heights, pixel, volume = flattened(rng, kind)
        try:
            found = find_worn_ball(heights, pixel=(pixel, pixel), radius=3.0)
        except InputError:
            continue
        off.append((found.volume - volume) / found.volume_error)
    one, two, three = said(f"ball {kind}", np.array(off), f"mean {np.mean(off):+.2f}")
    assert 0.5 < one < 0.92
    assert two > 0.85
    assert three > 0.93
