"""What steps change of a model is in a `STATE`, or made anew; what is named as scratch is just that."""

import json
from typing import Any

import numpy as np
import pytest
from cases_features import STUDIES, arrays_of, model_of, needs_transforms

from warpwear.contact.half_space.solver import BoundedPressure
from warpwear.engine import state
from warpwear.engine.executor import Executor, Field
from warpwear.models.features.film import BareCells
from warpwear.models.features.particles import Pending
from warpwear.models.model import Model
from warpwear.models.patches.cells import PatchContact
from warpwear.models.patches.half_space import HalfSpacePatches
from warpwear.models.rest.local import OneScaleModel
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.tiles import SlidingTiles
from warpwear.runs.order import RunOrder
from warpwear.study.study import Study

FILM = {"friction.film.thickness": "10 nm", "friction.film.shear_strength": "40 MPa"}
FILM |= {"friction.shear_strength": "172 MPa", "friction.film.regrowth": "20 mm"}
FILM |= {"friction.junction_growth": 9.0, "contact.hardness": "590 MPa"}
UNFILMED = ("track, bearing area", "patches, load")
PIECES = {"wear.particle": "60 um", "wear.particle_thickness": "0.6 um"}
LAYERS = {"disc.layers": [{"name": "coat", "thickness": "20 nm", "wear": "4e-4 mm^3/N/m"}]}
CASES = STUDIES | {
    **{
        f"{name}, layers": STUDIES[name].replace(LAYERS)
        for name in ("track", "patches", "patches, half-space")
    },
    **{f"{name}, film": study.replace(FILM) for name, study in STUDIES.items() if name not in UNFILMED},
    **{f"{name}, pieces": STUDIES[name].replace(PIECES) for name in ("track", "track, half-space")},
}


def steps_of(model: Model, *increments: float) -> list[dict[str, float]]:
    return [step.row for step in model.steps([(increment, False) for increment in increments])]


def left_over(study: Study, executor: Executor) -> tuple[list[str], bool]:
    """Arrays that a restored model has as they were, not as restored; and whether its steps are the same."""
    model, fresh = model_of(study, executor), model_of(study, executor)
    steps_of(model, 0.03, 0.03, 0.03)
    arrays, numbers = state.save(model, whole=True, aside=True)
    told = json.dumps(numbers)
    state.restore(fresh, arrays, json.loads(told))
    expected = arrays_of(fresh)
    before = steps_of(model, 0.06, 0.05)
    state.restore(model, arrays, json.loads(told))
    now = arrays_of(model)
    left = [name for name in now if name not in expected or not alike(now[name], expected[name])]
    goes_on = steps_of(model, 0.06, 0.05) == before == steps_of(fresh, 0.06, 0.05)
    return sorted(left), goes_on


def alike(one: Any, other: Any) -> bool:
    """Of structs by their members: between these memory may hold anything."""
    if one.dtype.names:
        return all(alike(one[name], other[name]) for name in one.dtype.names)
    return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


def looked_at(case: str, device: str) -> tuple[list[str], bool]:
    study = CASES[case]
    needs_transforms(study, device)
    with RunOrder(study).arrangement.executor(study, device=device, threads=1) as executor:
        return left_over(study, executor)


@pytest.mark.parametrize("case", CASES)
def test_all_that_steps_change_is_restored_or_made_anew(case: str, device: str) -> None:
    assert looked_at(case, device) == ([], True)


@pytest.mark.parametrize(
    ("case", "part", "name"),
    [
        ("track", SlidingBodies, "disc"),
        ("track", SlidingTiles, "highest"),
        ("track, pieces", Pending, "pending"),
        ("rest", OneScaleModel, "gap"),
        ("patches", PatchContact, "gap"),
        ("patches, half-space", HalfSpacePatches, "worn"),
    ],
)
def test_an_array_that_is_left_out_is_named(
    case: str, part: Any, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(part, "STATE", {key: kind for key, kind in part.STATE.items() if key != name})
    left, _ = looked_at(case, "cpu")
    assert any(name in path for path in left)


@pytest.mark.parametrize("kind", [None, Field])
def test_features_are_refused_that_do_not_declare_an_array(
    kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Left out of their state, or of no frame there."""
    monkeypatch.setattr(BareCells, "STATE", {"healing": kind} if kind else {})
    said = "STATE of film declares no frame .* healing.counter" if kind else "SCRATCH of film has healing"
    with pytest.raises(TypeError, match=said):
        looked_at("track, film", "cpu")


def test_scratch_that_is_none_changes_the_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    state_of = {key: kind for key, kind in BoundedPressure.STATE.items() if key != "pressure_field"}
    monkeypatch.setattr(BoundedPressure, "STATE", state_of)
    assert looked_at("patches, half-space", "cpu") == ([], False)


@pytest.mark.parametrize("case", CASES)
def test_arrays_of_cells_declare_their_frame(case: str) -> None:
    study = CASES[case]
    with RunOrder(study).arrangement.executor(study, device="cpu", threads=1) as executor:
        model = model_of(study, executor)
        arrays, _ = state.save(model, whole=True)
        cells = executor.grid.cells
        without = {name for name, values in arrays.items() if values.size >= cells} - state.frames(
            model
        ).keys()
        assert not without
