"""Steps made in blocks on a device are the steps made one by one."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.errors import ConvergenceError
from warpwear.history.recorder import Step
from warpwear.models import on_gpu
from warpwear.models.rest.bodies import RestingBodies
from warpwear.models.rest.local import OneScaleModel
from warpwear.study.surface import surface_in

KINDS = {
    "implicit": {},
    "elastic, capped": {"contact.stiffness": "1.9e6 N/mm^3"},
    "no cap": {"contact.hardness": "inf MPa"},
    "explicit": {"stepping.scheme": "explicit", "contact.stiffness": "2e5 N/mm^3"},
    "exponential": {"wear.law": "exponential", "wear.decay": "0.5 1/mm"},
    "smooth": {"study.model": "macro", "contact.bulk_stiffness": "pressure", "contact.hardness": "inf MPa"},
}


@pytest.mark.parametrize("kind", KINDS)
def test_blocks_are_steps(kind: str, device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Same cells in contact; approach, areas, volumes and pressures to 1e-10; as few evaluations."""
    monkeypatch.setattr(on_gpu, "PIECE", 7)
    monkeypatch.setattr(on_gpu, "STEPS_OF_GRAPH", 3)
    study = Study.load("v3-fine").replace({"grid.cell": "20 um", "grid.extent": "1.5 mm"} | KINDS[kind])
    grid = study.cells
    plan = [(0.003 * 1.1**n, n in (20, 59)) for n in range(60)]
    outcomes: list[tuple[list[Step], list[np.ndarray]]] = []
    for in_blocks in (False, True):
        with Executor(grid, device=device) as executor:
            model = OneScaleModel(study.contact_task, surface_in(study).heights(grid.x, grid.y), executor)
            model.blocks_allowed = in_blocks
            steps = list(model.steps(plan))
            fields = [executor.to_numpy(model.state.gap).copy(), *model.worn()]
        outcomes.append((steps, fields))
    (one_by_one, fields), (blocks, fields_of_blocks) = outcomes
    assert [step.pressure is not None for step in blocks] == [keep for _, keep in plan]
    for one, other in zip(one_by_one, blocks, strict=True):
        for name, value in one.row.items():
            if name in ("cells_in_contact", "patch_along", "patch_across"):
                assert other.row[name] == value, name
            elif name not in ("evaluations", "load_residual", "pressure_std"):
                assert other.row[name] == pytest.approx(value, rel=1e-10), name
        assert abs(other.row["load_residual"]) <= 1e-12 * 8.0
        assert other.touches_edge == one.touches_edge
    for one_field, other_field in zip(fields, fields_of_blocks, strict=True):
        assert_allclose(other_field, one_field, rtol=1e-10, atol=1e-15)
    assert blocks[20].pressure is not None
    assert one_by_one[20].pressure is not None
    assert_array_equal(blocks[20].pressure > 0.0, one_by_one[20].pressure > 0.0)
    # The plan makes two blocks: each begins without knowing where its first steps lead.
    few = sum(step.row["evaluations"] for step in one_by_one) + 10
    assert sum(step.row["evaluations"] for step in blocks) <= few


def test_a_load_that_no_approach_carries_is_refused(device: str) -> None:
    study = Study.load("v3-fine").replace({"grid.cell": "20 um", "grid.extent": "0.5 mm"})
    grid, task = study.cells, replace(study.contact_task, load=1e6)
    with Executor(grid, device=device) as executor:
        bodies = RestingBodies.of(task, executor, surface_in(study).heights(grid.x, grid.y))
        steps = on_gpu.at_rest(executor, task, bodies.gap, bodies.unworn)
        with pytest.raises(ConvergenceError, match="of 1e\\+06 N are left"):
            next(steps.run([(1e-9, 1e-9)], approach=0.0, mean_pressure=1.0))
