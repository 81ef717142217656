"""Wear of a ball that slides against closed forms; a representative track against the whole one."""

import itertools
from typing import Any

import numpy as np
import pytest
from cases_track import small
from numpy.testing import assert_allclose

import warpwear
from warpwear import Result, Study
from warpwear.grid import FloatArray


@pytest.mark.parametrize("shift", [1, 3, 8, 16, 33, 64])
def test_volumes_are_exact_under_reversal(shift: int, device: str) -> None:
    """K F L of both bodies over seven and a third passes, also where the shift does not divide the stroke."""
    changes = {"sliding.stroke": "1.5 mm", "sliding.distance": "11 mm", "sliding.shift": shift}
    changes |= {"grid.extent": "0.8 mm", "counter.radius": "3 mm", "wear.disc": "3e-3 mm^3/N/m"}
    result = warpwear.run(
        small("full", **{k.replace(".", "__"): v for k, v in changes.items()}), device=device
    )
    history = result.history
    assert history["distance"][-1] == pytest.approx(11.0, rel=1e-14)
    assert history["increment"].sum() == pytest.approx(11.0, rel=1e-12)
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 8.0 * 11.0, rel=1e-9)
    assert history["wear_volume_disc"][-1] == pytest.approx(3e-6 * 8.0 * 11.0, rel=1e-9)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(history["position"]))))
    assert 6 <= turns.size <= 14  # into and out of the step that is made twice at each end
    assert np.abs(history["position"]).max() < 0.75 + 1e-9


def test_a_static_contact_and_a_measured_time() -> None:
    static = warpwear.run(small("full", sliding__distance="0 mm", contact__stiffness="2e5 N/mm^3"))
    assert static.history["distance"].tolist() == [0.0]
    spun = small("rotating").replace({"sliding.revolutions": 3, "sliding.speed": "1 mm/s"})
    assert spun.sliding.distance is None
    assert spun.sliding.total == pytest.approx(6.0 * np.pi * 0.161)
    assert warpwear.run(spun).history["time"][-1] == pytest.approx(6.0 * np.pi * 0.161)


def smooth(**changes: Any) -> Study:
    swept: dict[str, Any] = {"sliding.kinematics": "swept", "disc.synthetic.kind": "flat"}
    swept["grid.cell"] = "10 um"
    swept["output.snapshots"] = [f"{1200 + 30 * i / 8} mm" for i in range(9)]
    return Study.load("v3-fine").replace(swept | {k.replace("__", "."): v for k, v in changes.items()})


def middle_areas(result: Result) -> FloatArray:
    """Mean area in contact of each pass over the middle half of the stroke or lap, shape (passes,)."""
    history, track = result.history, result.study.track
    half = 0.25 * track.cells * track.cell
    number = np.ceil(history["distance"] / track.stroke - 1e-9).astype(int) - 1
    inside = np.abs(history["position"]) < half
    areas = np.bincount(number[inside], history["area_contact"][inside]) / np.bincount(number[inside])
    return np.asarray(areas)


@pytest.mark.slow
def test_a_smooth_disc_wears_as_known() -> None:
    """Patch √√ of counter-body only, groove K_d F L/(stroke·width), volumes, section K_d ∫p dx per pass."""
    result = warpwear.run(smooth(sliding__track="3.2 mm"))
    history, last = result.history, result.snapshot(-1)
    for name in ("patch_along", "patch_across"):  # (4 R K_s F L/π)^¼ = 1.025 mm, to a cell a side
        assert history[name][-1] == pytest.approx(1.025, abs=0.02)
    assert history["wear_volume_counter"][-1] == pytest.approx(9.4e-7 * 8.0 * 2400.0, rel=1e-9)
    assert history["wear_volume_disc"][-1] == pytest.approx(12.7e-7 * 8.0 * 2400.0, rel=1e-9)
    section = last.wear_disc.mean(axis=0)
    width = (section > 0.0).sum() * 0.01
    assert section.sum() * 0.01 == pytest.approx(12.7e-7 * 8.0 * 2400.0 / 30.0, rel=1e-9)
    assert 0.78e-3 * 0.99 < section[section > 0.0].mean() < 0.8e-3 * 1.01
    assert width == pytest.approx(1.025, abs=0.02)
    during = [result.snapshot(i) for i in range(9)]  # of one pass
    a_pass = (during[-1].wear_disc - during[0].wear_disc).mean(axis=0)
    line = np.mean([snapshot.pressure for snapshot in during], axis=0).sum(axis=0) * 0.01
    assert_allclose(a_pass, 12.7e-7 * line, atol=0.02 * a_pass.max())


@pytest.mark.slow
def test_a_representative_track_stands_for_the_whole_one() -> None:
    """On a smooth disc: volumes, patch and groove to 2 %, and the area of each pass in mid-stroke.

    On a rotating disc that too agrees. A stroke has ends, beyond which the disc is less worn: they round the
    patch's leading edges, which late costs it some of its area, and which no periodic track has.
    """
    rotating = f"{30.0 / (2.0 * np.pi)!r} mm"
    ways = [{"sliding.track": track} for track in ("full", "3.2 mm")]
    whole, part = (warpwear.run(smooth().replace(way)) for way in ways)
    round_whole, round_part = (
        warpwear.run(smooth().replace(way | {"sliding.track_radius": rotating})) for way in ways
    )
    for name in ("wear_volume_counter", "wear_volume_disc", "patch_across", "patch_along"):
        for one, other in ((part, whole), (round_part, round_whole)):
            assert one.history[name][-1] == pytest.approx(other.history[name][-1], rel=0.02)
    inside = np.abs(whole.track_x) < 14.0
    grooves = whole.snapshot(-1).wear_disc[inside].mean(axis=0), part.snapshot(-1).wear_disc.mean(axis=0)
    assert grooves[1].mean() == pytest.approx(grooves[0].mean(), rel=0.02)
    assert_allclose(middle_areas(round_part)[1:], middle_areas(round_whole)[1:], rtol=0.01)
    assert_allclose(middle_areas(part)[1:40], middle_areas(whole)[1:40], rtol=0.02)
    assert_allclose(middle_areas(part)[40:], middle_areas(whole)[40:], rtol=0.06)
    assert_allclose(middle_areas(part), middle_areas(round_part), rtol=0.01)


@pytest.mark.slow
def test_a_representative_track_on_a_rough_disc() -> None:
    """Within the scatter of five seeds and 2 %: the area of five passes, the patch.

    Steps are short: near F/H an implicit step spreads the load over cells that it has not worn down yet, by
    an area that goes with its length; on a representative track the counter-body's steps are S/P as long.
    """
    found: dict[str, list[list[float]]] = {"full": [], "3.2 mm": []}
    for (track, shift), seed in itertools.product((("full", 2), ("3.2 mm", 1)), range(5)):
        rough_one = smooth(sliding__track=track, sliding__shift=shift).replace(
            {"disc.synthetic.kind": "self-affine", "disc.synthetic.seed": seed, "output.snapshots": []}
            | {"disc.synthetic.period": "3.2 mm", "sliding.distance": "150 mm"}
        )
        result = warpwear.run(rough_one)
        patch = float(result.history["patch_across"][-1])
        found[track].append([*middle_areas(result).tolist(), patch])
    whole, part = (np.array(found[track]) for track in found)
    scatter = np.sqrt(whole.std(axis=0, ddof=1) ** 2 + part.std(axis=0, ddof=1) ** 2)
    off = np.abs(whole.mean(axis=0) - part.mean(axis=0))
    assert (off <= scatter + 0.02 * whole.mean(axis=0)).all(), (whole, part)
