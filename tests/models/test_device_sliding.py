"""Displaced steps made in blocks on a device are those made one by one."""

import pytest
from cases_track import LOSES, TRACKS, rough, small
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.engine.executor import Executor
from warpwear.models import on_gpu
from warpwear.models.track.model import SweptModel
from warpwear.runs.make import plan_of

LAWS = {
    **LOSES,
    "hard sphere": {"wear.sphere": "0 mm^3/N/m"},
    "no cap": {"contact.hardness": "inf MPa"},
    "explicit": {"stepping.scheme": "explicit", "contact.stiffness": "2e5 N/mm^3"},
    "running in": {"wear.law": "running-in", "wear.running_in": "1 mm", "wear.initial_disc": "5e-3 mm^3/N/m"},
}


CASES = [
    *((track, "keeps") for track in TRACKS),
    *(("representative", law) for law in LAWS if law != "keeps"),
]


@pytest.mark.parametrize(("track", "law"), CASES)
def test_blocks_are_steps(track: str, law: str, device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Same cells in contact; approach, areas, volumes and pressures to 1e-10; about as many evaluations."""
    monkeypatch.setattr(on_gpu, "PIECE", 7)
    monkeypatch.setattr(on_gpu, "STEPS_OF_GRAPH", 3)
    study = small(track, **{k.replace(".", "__"): v for k, v in LAWS[law].items()})
    path = study.track
    plan = [(increment, number in (11, 59)) for number, (increment, _, _) in enumerate(plan_of(study))]
    outcomes = []
    for in_blocks in (False, True):
        with Executor(study.cells, device=device) as executor:
            model = SweptModel(study.contact_task, path, rough(path.rows), executor)
            model.contact.blocks_allowed = in_blocks
            steps = list(model.steps(plan))
            fields = {k: executor.to_numpy(v).copy() for k, v in model.contact.state.fields.items()}
            lowest = [model.contact.tiles.lowest.to_numpy(), model.contact.tiles.highest.to_numpy()]
        outcomes.append((steps, fields, [bounds.copy() for bounds in lowest]))
    (one_by_one, fields, bounds), (blocks, fields_of_blocks, bounds_of_blocks) = outcomes
    assert [step.pressure is not None for step in blocks] == [keep for _, keep in plan]
    for one, other in zip(one_by_one, blocks, strict=True):
        for name, value in one.row.items():
            if name in ("cells_in_contact", "patch_along", "patch_across", "position"):
                assert other.row[name] == value, name
            elif name not in ("evaluations", "load_residual", "pressure_std"):
                assert other.row[name] == pytest.approx(value, rel=1e-10, abs=1e-15), name
        assert abs(other.row["load_residual"]) <= 1e-12 * 8.0
        assert other.touches_edge == one.touches_edge
    for name, field in fields.items():
        assert_allclose(fields_of_blocks[name], field, rtol=1e-10, atol=1e-15, err_msg=name)
    for one_bound, other_bound in zip(bounds, bounds_of_blocks, strict=True):
        assert_allclose(other_bound, one_bound, rtol=1e-10, atol=1e-15)
    assert blocks[11].pressure is not None
    assert one_by_one[11].pressure is not None
    assert_array_equal(blocks[11].pressure > 0.0, one_by_one[11].pressure > 0.0)
    alone = sum(step.row["evaluations"] for step in one_by_one)
    assert sum(step.row["evaluations"] for step in blocks) <= 1.1 * alone + 1
