"""Arrangements: each that is named has what makes its runs, and studies ask for the right one."""

import pytest

from warpwear.history.arrangements import ARRANGEMENTS, name_of
from warpwear.runs.arrangements import Maker
from warpwear.study.study import Study


def test_each_arrangement_has_what_makes_its_runs() -> None:
    missing = ARRANGEMENTS.keys() - Maker.REGISTERED.keys()
    assert not missing, f"warpwear/runs/arrangements.py has no class for {sorted(missing)}"


def test_an_arrangement_needs_a_name() -> None:
    with pytest.raises(KeyError, match=r"'nameless' is not one of warpwear\.history\.arrangements"):
        type("Nameless", (Maker,), {}, name="nameless")


@pytest.mark.parametrize(
    ("preset", "name"), [("v1", "rest"), ("v3", "rest"), ("two-scale", "patches"), ("track", "track")]
)
def test_a_study_asks_for_one(preset: str, name: str) -> None:
    assert name_of(Study.load(preset)) == name
