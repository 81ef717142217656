"""Studies are values: equal ones have equal hashes; copies and pickles carry nothing stale."""

import copy
import pickle
import tomllib
from collections.abc import Callable

import pytest

from warpwear import Study
from warpwear.study.loading import presets
from warpwear.study.text import assumptions

COPIES: dict[str, Callable[[Study], Study]] = {
    "pickle": lambda study: pickle.loads(pickle.dumps(study)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "model_copy": lambda study: study.model_copy(),
    "deep model_copy": lambda study: study.model_copy(deep=True),
    "text": lambda study: Study(**tomllib.loads(study.to_toml())),
    "replace": lambda study: study.replace({}),
}


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("name", presets())
def test_a_copy_is_equal(name: str, how: str) -> None:
    study = Study.load(name)
    again = COPIES[how](study)
    assert again == study
    assert hash(again) == hash(study)
    assert again.notices() == study.notices()
    assert len({study, again}) == 1


def test_studies_that_differ_are_unequal() -> None:
    study = Study.load("v3-fine")
    others = [
        study.replace({"contact.load": "4 N"}),
        study.replace({"contact.stiffness": "inf N/mm^3"}),  # no longer assumed
        study.replace({"study.name": "other"}),
        Study.load("v3"),
    ]
    assert len({study, *others}) == 5
    assert study != "v3-fine"
    assert study == study.replace({"contact.load": "8000 mN"})
    assert hash(study) == hash(study.replace({"contact.load": (8, "N")}))


def test_derived_values_of_a_changed_copy_are_its_own() -> None:
    study = Study.load("v3-fine")
    before = study.hertz, study.cells, study.wear_laws, study.hardness
    heavier = study.contact.model_copy(update={"load": 16.0, "hardness": 1000.0})
    changed = study.model_copy(update={"contact": heavier})
    assert changed.hardness == 1000.0
    assert changed.hertz is not None
    assert changed.hertz.load == 16.0
    assert (study.hertz, study.cells, study.wear_laws, study.hardness) == before


def test_a_key_that_is_left_open_again_is_as_if_never_given() -> None:
    """Its assumption is told, as of a study that never had it."""
    study = Study.load("running-in").replace({"sliding.shift": None})
    assert COPIES["text"](study).to_toml() == study.to_toml()
    assert "sliding.shift" in assumptions(study)
