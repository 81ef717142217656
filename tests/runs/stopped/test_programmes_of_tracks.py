"""Programmes whose blocks have strokes and circles of their own."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import HALF_SPACE, differences, run_stopped
from cases_track import CELL, small
from numpy.testing import assert_allclose

import warpwear
from warpwear import InputError, Study
from warpwear.page.content import words_of

STROKES: list[dict[str, Any]] = [{"stroke": "0.9 mm", "load": "4 N", "cycles": 1}]


STROKES += [
    {"stroke": "0.5 mm", "load": "4 N", "cycles": 2},
    {"stroke": "1.2 mm", "load": "9 N", "passes": 2},
]


SOFT = {"contact.stiffness": "2e5 N/mm^3"}


ON_STROKES = {
    "full": (small("full"), {}),
    "full, half-space": (small("full"), HALF_SPACE),
    "representative": (
        small("representative"),
        {"sliding.track": "0.8 mm", "sliding.plastic": "keep"} | SOFT,
    ),
    "representative, half-space": (small("representative"), HALF_SPACE),
}


def quick(cases: Iterable[str], *, slow: str) -> list[Any]:
    """All cases, of which one is slow."""
    return [pytest.param(case, marks=pytest.mark.slow if case == slow else []) for case in cases]


def of_strokes(case: str) -> Study:
    """A programme whose blocks differ in stroke, which on a representative track is three times as long."""
    study, changes = ON_STROKES[case]
    times = 1.0 if case.startswith("full") else 3.0
    blocks = [{**block, "stroke": f"{times * float(block['stroke'][:3]):g} mm"} for block in STROKES]
    return study.replace(changes).replace(block=blocks)


@pytest.mark.parametrize("case", quick(ON_STROKES, slow="representative, half-space"))
def test_blocks_of_other_strokes_wear_one_disc(case: str, tmp_path: Path, device: str) -> None:
    """Volumes are Σ K F L, places those of each stroke, and a run that was stopped goes on."""
    study = of_strokes(case)
    assert Study.stored(study.to_toml()) == study
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, number = result.history, result.history["block"]
        summary = result.summary
    for body, law in zip(("counter", "disc"), study.wear_laws, strict=True):
        for block in study.blocks:
            volume = sum(
                b.load * law.wear_per_pressure(b.start, b.length) for b in study.blocks[: block.number]
            )
            assert_allclose(history[f"wear_volume_{body}"][number == block.number][-1], volume, rtol=1e-12)
    for block, track in zip(study.blocks, study.tracks, strict=True):
        places = history["position"][number == block.number]
        assert np.abs(places).max() <= 0.5 * track.cells * CELL
        assert_allclose(history["distance"][number == block.number][-1], block.end, rtol=1e-14)
    assert summary["track"]["passes"] == pytest.approx(2 + 4 + 2)
    inside = int(np.flatnonzero(number == 2.0)[0])
    run_stopped(study, other, inside, threads=2, device=device)
    run_stopped(study, other, 2, resume=True, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


def test_a_second_stroke_meets_what_the_first_has_left(device: str) -> None:
    """A disc alone that wears, in its middle, is what a run of that stroke begins with."""
    alone = {"wear.counter": 0.0, "counter.radius": "3 mm", "friction.shear_strength": "4 MPa"}
    study = small("full").replace(alone)
    first, second = {"stroke": "0.9 mm", "cycles": 2}, {"stroke": "0.5 mm", "cycles": 2}
    both = warpwear.run(study.replace(block=[first, second]), device=device)
    before = warpwear.run(study.replace({"sliding.cycles": 2}), device=device)
    whole = slice(0, before.track_x.size)
    worn = before.track_heights(whole) - np.add(*before.track_loss(before.snapshot_distances.size - 1, whole))
    spare = round((0.9 - 0.5) / CELL)
    middle = worn[spare // 2 : worn.shape[0] - spare // 2]
    later = study.replace({"sliding.stroke": "0.5 mm", "sliding.cycles": 2, "sliding.shift": 7})
    after = warpwear.run(later, surface=middle, device=device)
    mine = both.history["block"] == 2.0
    for name in ("area_contact", "pressure_max", "position"):
        assert_allclose(both.history[name][mine], after.history[name], rtol=1e-9, atol=1e-12, err_msg=name)


def test_cycles_of_a_stroke_stand_for_its_own(tmp_path: Path, device: str) -> None:
    """Jumps of two strokes wear as much as every cycle would, and go on where they were stopped."""
    study = of_strokes("full").replace({"stepping.jump": 4, "counter.radius": "3 mm"})
    study = study.replace({f"block.{number}.load": "1 N" for number in (1, 2, 3)})
    study = study.replace({"block.1.cycles": 8, "block.2.cycles": 10, "block.3.passes": 12})
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, jumps = result.history, result.summary["track"]["jumps"]
    assert history["cycles"].max() > 1.0
    assert jumps["cycles"] == pytest.approx(8 + 10 + 6)
    volume = study.wear_coefficients[1] * sum(block.load * block.length for block in study.blocks)
    assert_allclose(history["wear_volume_disc"][-1], volume, rtol=1e-12)
    inside = int(np.flatnonzero(history["block"] == 2.0)[0]) + 9
    run_stopped(study, other, inside, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


def test_strokes_that_do_not_follow_each_other_are_refused() -> None:
    still = Study.load("v3-fine").replace({"grid.cell": "20 um", "output.snapshots": []})
    blocks: list[dict[str, Any]] = [{"cycles": 2, "stroke": "3 mm"}, {"cycles": 2, "stroke": "1 mm"}]
    assert [block.length for block in still.replace(block=blocks).blocks] == [12.0, 4.0]
    with pytest.raises(
        InputError, match=r"block 1: its length, 0\.9 mm, is not a whole number of pairs of pass"
    ):
        small("full").replace(block=[{"passes": 1}, {"cycles": 2, "stroke": "0.5 mm"}])
    with pytest.raises(InputError, match=r"block 2: it does not move as block 1 does"):
        small("full").replace(block=[{"passes": 2}, {"revolutions": 2, "track_radius": "1 mm"}])
    track = small("full").replace(block=[{"passes": 2, "stroke": "1.8 mm"}] * 2)
    assert track.track.stroke == 1.8
    assert Study.stored(track.to_toml()) == track


@pytest.mark.slow
def test_cycles_that_stand_for_many_stay_within_their_block(tmp_path: Path, device: str) -> None:
    """Jumped-over cycles too wear by the load of their block; a run stopped in the second goes on."""
    jumps = {"stepping.jump": 4, "counter.radius": "3 mm"}
    blocks = [{"load": "1 N", "cycles": 9}, {"load": "4 N", "passes": 17}, {"load": "2 N", "cycles": 6}]
    study = small("full").replace(jumps).replace(block=blocks)
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, passes = result.history, np.array([18, 17, 12])
        assert history["cycles"].max() > 1.0
        for number, count in enumerate(passes, 1):
            mine = history["block"] == number
            assert_allclose(history["increment"][mine].sum(), 0.9 * count, rtol=1e-12)
        expected = study.wear_coefficients[1] * 0.9 * float(passes @ [1.0, 4.0, 2.0])
        assert_allclose(history["wear_volume_disc"][-1], expected, rtol=1e-12)
        inside = int(np.flatnonzero(history["block"] == 2.0)[0]) + 20
    run_stopped(study, other, inside, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


RADII = (0.161, 0.9, 0.161)


ON_CIRCLES: dict[str, dict[str, Any]] = {
    "local": {"sliding.plastic": "keep"} | SOFT,
    "half-space": HALF_SPACE,
    "part of the lap": {"sliding.track": "0.8 mm", "sliding.shift": 8},
    "pieces": {
        "wear.particle": "60 um",
        "wear.particle_thickness": "0.6 um",
        "contact.law": "half-space",
        "counter.radius": "3 mm",
    },
    "film": {"friction.film.thickness": "20 nm", "friction.film.shear_strength": "10 MPa"},
}


def of_circles(case: str, revolutions: tuple[int, ...] = (2, 1, 1), **changes: Any) -> Study:
    """A programme on two circles of a disc, to the first of which it returns."""
    loads = (4, 9, 6)
    blocks = [
        {"track_radius": f"{radius} mm", "load": f"{load} N", "revolutions": turns}
        for radius, load, turns in zip(RADII, loads, revolutions, strict=True)
    ]
    return small("rotating").replace(ON_CIRCLES[case] | changes).replace(block=blocks)


@pytest.mark.parametrize("case", quick(ON_CIRCLES, slow="pieces"))
def test_a_programme_slides_on_circles_of_its_disc(case: str, tmp_path: Path, device: str) -> None:
    """Volumes are Σ K F L, the ball keeps its wear, and a run that is stopped on either circle goes on."""
    study = of_circles(case)
    assert Study.stored(study.to_toml()) == study
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, number = result.history, result.history["block"]
        assert [block["track_radius_mm"] for block in result.summary["blocks"]] == [*RADII]
        assert f"{len(study.blocks)} of {len(study.blocks)} blocks; in the last" in str(result)
        assert "along tracks of 0.161 and 0.9 mm radius under" in words_of(result)["asked"]
        kept = [float(distance) for distance in result.snapshot_distances]
    assert study.blocks[0].end in kept or not study.output.snapshots
    for body, law in zip(("counter", "disc"), study.wear_laws, strict=True):
        gone = history[f"wear_volume_{body}"] + history.get(f"pending_volume_{body}", 0.0)
        for block in study.blocks:
            volume = sum(
                b.load * law.wear_per_pressure(b.start, b.length) for b in study.blocks[: block.number]
            )
            assert_allclose(gone[number == block.number][-1], volume, rtol=1e-12)
    firsts = [int(np.flatnonzero(number == block)[0]) for block in (2.0, 3.0)]
    run_stopped(study, other, firsts[0] + 2, threads=2, device=device)
    run_stopped(study, other, firsts[1] - firsts[0], resume=True, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


@pytest.mark.parametrize("case", ["local", "half-space"])
def test_each_circle_goes_its_own_way(case: str, device: str) -> None:
    """Under a ball that does not wear circles know nothing of each other, to the last bit."""
    alone = {"wear.counter": 0.0, "contact.load": "6 N", "counter.radius": "3 mm"}
    alone |= {"sliding.shift": 1}  # of one part, however wide the contact was before
    study = of_circles(case, (1, 1, 1), **alone).replace({f"block.{n}.load": "6 N" for n in (1, 2, 3)})
    history = warpwear.run(study, device=device).history
    part = {"sliding.track": f"{study.tracks[0].cells * CELL!r} mm"}
    for radius, turns, blocks in ((0.161, 2, (1.0, 3.0)), (0.9, 1, (2.0,))):
        way = {"sliding.track_radius": f"{radius} mm", "sliding.revolutions": turns}
        own = warpwear.run(study.replace({"block": None} | way | part), device=device).history
        mine = np.isin(history["block"], blocks)
        for name in ("area_contact", "pressure_max", "wear_depth_disc", "position"):
            # A GPU adds in another order, which contacts on the way, solved to 1e-4, pass on.
            exact = {"rtol": 1e-9 if device == "cpu" else 1e-7, "atol": 1e-15}
            assert_allclose(history[name][mine], own[name], err_msg=name, **exact)


@pytest.mark.slow
def test_cycles_on_circles_stand_for_their_own(tmp_path: Path, device: str) -> None:
    study = of_circles("local", (24, 16, 24), **{"stepping.jump": 3})
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, jumps = result.history, result.summary["track"]["jumps"]
    assert history["cycles"].max() == 3.0
    assert jumps["cycles"] == pytest.approx(64)
    assert 0.0 < jumps["depth_error_percent"]["disc"] < 20.0
    volume = study.wear_coefficients[1] * sum(block.load * block.length for block in study.blocks)
    assert_allclose(history["wear_volume_disc"][-1], volume, rtol=1e-12)
    run_stopped(study, other, int(np.flatnonzero(history["block"] == 2.0)[0]) + 12, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


def test_circles_that_overlap_are_refused() -> None:
    radii = [{"revolutions": 2, "track_radius": f"{radius} mm"} for radius in (1.0, 1.2)]
    with pytest.raises(
        InputError, match=r"1 and 1\.2 mm radius would overlap: .* 0\.62 mm \(grid\.extent\) b"
    ):
        small("rotating").replace(block=radii)
    ring = {"counter.shape": "cylinder", "counter.radius": "1 mm"}
    with pytest.raises(InputError, match=r"would overlap: .* a counter-body that ends across"):
        small("rotating").replace(ring).replace(block=[radii[0], {**radii[0], "track_radius": "5 mm"}])
    with pytest.raises(InputError, match=r"block 1: its length, 5 mm, is not a whole number of passes"):
        small("rotating").replace(block=[{"distance": "5 mm", "track_radius": "3 mm"}, radii[0]])
