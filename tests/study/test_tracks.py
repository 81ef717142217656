"""Studies of a ball that slides: what is refused, warned of and does not apply."""

from collections.abc import Callable
from typing import Any

import pytest
from cases_track import small

import warpwear
from warpwear import InputError, Study


def test_a_rigid_contact_on_a_track_is_warned_of() -> None:
    """Its area depends on the step; the cure is named."""

    def told(study: Study) -> bool:
        return any("depends on its length" in note for note in study.notices())

    study = small("full")
    assert told(study)
    assert any(
        "Take contact.law = 'half-space'" in note
        for note in warpwear.run(study.replace({"sliding.distance": "0.3 mm"})).summary["warnings"]
    )
    for changes in (
        {"contact.law": "half-space"},
        {"contact.stiffness": "2e6 N/mm^3"},
        {"sliding.kinematics": "stationary"},
    ):
        assert not told(study.replace(changes))


BAD: list[tuple[dict[str, Any], str]] = [
    (
        {"sliding.track": "3.25 mm", "sliding.shift": 8},
        r"sliding\.track = 3\.25 mm is not a whole .* nearest that is, is 3\.28 mm",
    ),
    (
        {"sliding.track": "2.9 mm", "sliding.shift": 160, "disc.surface": "disc.npz", "disc.synthetic": None},
        r"sliding\.track = 2\.9 mm .* nearest that is, is 3\.2 mm",
    ),
    ({"sliding.track": "0.8 mm"}, r"sliding\.track = 0\.8 mm is shorter than grid\.extent = 1\.5 mm"),
    ({"sliding.track": "32 mm"}, r"sliding\.track = 32 mm is longer than sliding\.stroke = 30 mm"),
    (
        {"sliding.kinematics": None, "study.model": "macro"},
        r"sliding\.stroke = 30 mm: in the macro model the disc lies still; allowed are .*'stationary'",
    ),
    ({"sliding.stroke": "30.005 mm"}, r"sliding\.stroke = 30\.005 mm is not a whole number of cells"),
    ({"sliding.stroke": None}, r"'swept' needs sliding\.stroke"),
    ({"study.model": "macro"}, r"'swept' needs study\.model = 'micro', not 'macro': .*kind = 'flat'"),
    ({"sliding.track_radius": "0.2 mm"}, r"track_radius = 0\.2 mm \(a track of 1\.257 mm\) is shorter than"),
    ({"sliding.shift": 40_000}, r"sliding\.shift = 40000 cells .* longer than sliding\.stroke"),
    ({"sliding.shift": 0}, r"sliding\.shift = 0"),
    ({"sliding.shift": 2.5}, r"sliding\.shift = 2\.5"),
    ({"sliding.revolutions": 3}, r"sliding\.revolutions = 3 needs sliding\.track_radius"),
    ({"sliding.shift": 1, "grid.cell": "1 um"}, r"takes 2\.4e\+06 steps; .* a larger sliding\.shift or"),
    (
        {"stepping.scheme": "explicit", "sliding.plastic": "keep"},
        r"plastic = 'keep' needs a contact with comp",
    ),
    (
        {"stepping.scheme": "explicit", "contact.stiffness": "1e7 N/mm^3", "sliding.shift": 16},
        r"sliding\.shift = 16 cells, .* mm of sliding, is beyond the explicit stability limit",
    ),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[",".join(c) for c, _ in BAD])
def test_a_bad_track_is_one_sentence(changes: dict[str, Any], message: str) -> None:
    swept = {"grid.cell": "10 um", "sliding.kinematics": "swept"}
    with pytest.raises(InputError, match=message) as caught:
        Study.load("v3-fine").replace(swept | changes)
    assert "\n" not in str(caught.value)


def test_a_track_that_memory_does_not_hold(host_with: Callable[[float], None]) -> None:
    study = Study.load("v3-fine").replace({"sliding.kinematics": "swept"})
    host_with(10**9)
    with pytest.raises(
        InputError, match=r"31500 × 1500 cells, which need 1\.5 GiB .* sliding\.track = '3\.2 mm'"
    ):
        warpwear.run(study)


def test_a_domain_too_narrow_for_the_patch_of_a_swept_counter() -> None:
    """Its patch ends 1.025 mm wide, with summits 1.06; a disc that lies still makes 1.27 mm."""
    swept = {"grid.cell": "10 um", "sliding.kinematics": "swept", "sliding.track": "3.2 mm"}
    study = Study.load("v3-fine").replace(swept)
    with pytest.raises(
        InputError, match=r"grid\.extent = 1 mm is too small: the worn patch will be 1\.06 mm"
    ):
        warpwear.run(study.replace({"grid.extent": "1 mm"}))


def test_keys_that_do_not_apply() -> None:
    fine = Study.load("v3-fine")
    still = fine.replace({"sliding.shift": 16, "sliding.plastic": "keep"})
    assert still.notices() == [
        "sliding.shift, sliding.plastic do not apply to sliding.kinematics = 'stationary'."
    ]
    moving = fine.replace({"sliding.kinematics": "swept", "wear.distance_factor": "across"})
    told = "\n".join(moving.notices())
    assert "stepping.first, stepping.growth, stepping.largest do not apply" in told
    assert "wear.distance_factor does not apply to sliding.kinematics = 'swept'" in told
    seam = fine.replace({"sliding.kinematics": "swept", "sliding.track": "3.2 mm", "grid.cell": "10 um"})
    assert any("has a seam" in notice for notice in seam.notices())
    assert any("longer than a contact" in n for n in seam.replace({"sliding.shift": 16}).notices())
    assert fine.replace({"sliding.track_radius": "5 mm"}).sliding.stroke is None
    assert fine.replace({"sliding.track_radius": "5 mm", "sliding.revolutions": 10}).sliding.distance is None
