"""Extents that a sentence names, or `new` chooses, hold the contact of the whole test, roughness included."""

import re
import warnings
from typing import Any

import pytest

from warpwear import InvariantError, new_study, run
from warpwear.errors import InputError
from warpwear.runs import order
from warpwear.study.rules_track import too_small
from warpwear.study.study import Study

#: Of small rough tests: sliding one way over a short disc, to and fro, and on a disc at rest.
KEYS: dict[str, dict[str, Any]] = {
    "rotation": {"track_radius": "1 mm", "revolutions": 40, "track": "0.6 mm"},
    "strokes": {"stroke": "0.6 mm", "cycles": 40, "track": "full"},
    "at rest": {"distance": "200 mm", "kinematics": "stationary"},
}
SEEDS = [*range(3), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 20))]
#: Extents of which a notice says that they may be too small, and of which a sentence says that they are.
TIGHT = {"rotation": "0.18 mm", "strokes": "0.16 mm", "at rest": "0.2 mm"}
SMALL = {"rotation": "0.14 mm", "strokes": "0.1 mm", "at rest": "0.16 mm"}


def rough(how: str, seed: int, extent: str = "0.3 mm") -> Study:
    sliding = KEYS[how]
    return Study(
        counter={"radius": "3 mm", "young": "210 GPa", "poisson": 0.3},
        disc={
            "young": "210 GPa",
            "poisson": 0.3,
            "synthetic": {"kind": "self-affine", "sq": "0.2 um", "cut_off": "20 um", "seed": seed},
        },
        contact={"load": "2 N", "law": "local", "hardness": "2 GPa"},
        wear={"counter": "2e-5 mm^3/N/m", "disc": "2e-5 mm^3/N/m"},
        friction={"coefficient": 0.6},
        grid={"cell": "10 um", "extent": extent},
        output={"snapshots": []},
        sliding=sliding,
    )


def completes(study: Study) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            run(study)
        except InvariantError:
            return False
    return True


@pytest.mark.parametrize("how", KEYS)
@pytest.mark.parametrize("seed", SEEDS)
def test_what_a_sentence_names_holds_the_contact(
    how: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    notices = " ".join(rough(how, seed, TIGHT[how]).notices())
    told = re.search(r"may be too small: .*; ([\d.]+ mm) would do", notices)
    refusal = re.search(
        r"is too small: .*extent of ([\d.]+ mm) would do", too_small(rough(how, seed, SMALL[how]))
    )
    assert told
    assert refusal
    assert told[1] == refusal[1]
    assert completes(rough(how, seed, told[1]))
    assert not any("may be too small" in notice for notice in rough(how, seed, told[1]).notices())
    monkeypatch.setattr(order, "too_small", lambda study: None)
    assert not completes(rough(how, seed, SMALL[how]))  # so that it is refused with reason


@pytest.mark.parametrize("seed", SEEDS)
def test_what_a_draft_chooses_holds_the_contact(seed: int) -> None:
    keys = {f"sliding.{name}": value for name, value in KEYS["rotation"].items()}
    keys |= {"contact.law": "local", "contact.load": "2 N", "disc.synthetic.seed": seed, "grid.cell": "10 um"}
    keys |= {"wear.counter": "2e-5 mm^3/N/m", "wear.disc": "2e-5 mm^3/N/m", "output.snapshots": []}
    study = new_study(like="rotating", changes=keys)
    assert completes(study)


def test_summits_of_a_long_track_are_foreseen_before_heights_are_made(
    failing: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    failing("warpwear.runs.order.surface_in", AssertionError("heights are made"))
    study = new_study(like="rotating", changes={"grid.extent": "0.15 mm"})
    assert max(study.grid.sides) > 0.131  # which would hold smooth bodies
    with pytest.raises(InputError, match=r"will be 0\.15\d mm wide or more; a grid.extent of 0\.2\d mm"):
        _ = order.RunOrder(study).surface


def test_no_domain_is_too_large_for_a_draft() -> None:
    keys = {"grid.extent": "1 m", "sliding.track_radius": "10 m", "sliding.track": "full"}
    assert new_study(like="rotating", changes=keys).grid.sides == (1000.0, 1000.0)
