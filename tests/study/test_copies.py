"""Studies are values: equal ones have equal hashes; copies and pickles carry nothing stale."""

import copy
import pickle
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import BaseModel

from warpwear import Study
from warpwear.study import study as study_module
from warpwear.study.loading import presets

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


@pytest.mark.parametrize("deep", [False, True])
def test_a_changed_copy_makes_anew_what_follows_from_its_sections(deep: bool) -> None:
    study = Study.load("v3-fine")
    study.notices()  # makes most of what follows
    law = study.contact.model_copy(update={"law": "half-space", "hardness": 1000.0})
    changed = study.model_copy(update={"contact": law}, deep=deep)
    assert changed.pair.caps == (1000.0, 1000.0) != study.pair.caps
    assert changed.parts[0].contact_task.half_space
    assert "contact.stiffness" in changed.unused_keys.keys() - study.unused_keys.keys()


def test_what_is_filled_in_stands_in_new_sections_and_is_not_given() -> None:
    """Sections that a user made stay as they were, and nobody writes past what makes them frozen."""
    body = Study.load("v1").counter
    assert body.material
    assert body.young
    assert "young" not in body.model_fields_set
    blocks = [{"load": "4 N", "distance": "30 mm"}, {"load": "8 N", "distance": "60 mm"}]
    study = Study.load("v3-fine").replace({"block": blocks})
    assert study.sliding.distance == 90.0
    assert "sliding.distance" not in study.given_keys
    sources = (Path(study_module.__file__).parent).rglob("*.py")
    assert not [path for path in sources if "__dict__" in path.read_text(encoding="utf-8")]


def test_a_study_shows_few_names_of_its_own() -> None:
    """What follows from both bodies is their pair's; what one section says is that section's."""
    own = [name for name in dir(Study) if name[0] != "_" and not hasattr(BaseModel, name)]
    assert len(own) <= 60


def test_a_key_that_is_left_open_again_is_as_if_never_given() -> None:
    """Its assumption is told, as of a study that never had it."""
    study = Study.load("running-in").replace({"sliding.shift": None})
    assert COPIES["text"](study).to_toml() == study.to_toml()
    assert "sliding.shift" in study.assumptions
