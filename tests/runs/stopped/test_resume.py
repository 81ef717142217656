"""A run that was stopped goes on as if it had not been."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import CASES, COVERED, differences, run_stopped, soon_done
from cases_tiles import CELL, LAWS, SHAPE, SURFACES
from numpy.testing import assert_array_equal

import warpwear
from warpwear import Study
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.engine.tiles import Tiles
from warpwear.grid import FloatArray, Grid
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.arrangements import model_at_rest


def steps_of(law: str, heights: FloatArray, increments: list[float], restart: int | None) -> Any:
    """Rows and fields of a model; with `restart`, of another one that goes on with its state at that step."""
    study = Study.load("v3-fine").replace({"stepping.increment": "1 mm", "stepping.force": True} | LAWS[law])
    with Executor(Grid(*SHAPE, CELL)) as executor:
        model = OneScaleModel(study.contact_task, heights.copy(), executor)
        rows = []
        for number, increment in enumerate(increments):
            if number == restart:
                arrays, numbers = saved.save(model)
                model = OneScaleModel(study.contact_task, heights.copy(), executor)
                saved.restore(model, arrays, json.loads(json.dumps(numbers)))
            rows.append(model.advance(increment).row)
        return rows, [executor.to_numpy(model.gap).copy(), *model.worn_depths()]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", SURFACES)
def test_a_model_goes_on_from_any_step(
    make: Callable[[np.random.Generator], FloatArray], law: str, threads: int
) -> None:
    """After a random sequence of short and long steps, in every number of every row."""
    dice = np.random.default_rng(7)
    heights = make(dice)
    increments = (10.0 ** dice.uniform(-3.0, 1.0, 12)).tolist()
    rows, fields = steps_of(law, heights, increments, None)
    for restart in (1, int(dice.integers(2, 12))):
        again, fields_again = steps_of(law, heights, increments, restart)
        assert again == rows
        for one, other in zip(fields, fields_again, strict=True):
            assert_array_equal(one, other)


#: Laws of cell by cell, which are those of a track that does not move.
CELL_BY_CELL = {
    "radial": {"wear.distance_factor": "radial"},
    "radial, bearing area": LAWS["bearing area"] | {"wear.distance_factor": "radial"},
    "running in apart": {
        "wear.law": "running-in",
        "wear.running_in": "1 mm",
        "wear.initial_counter": "3e-3 mm^3/N/m",
    },
    "layers": {
        "disc.layers": [{"name": "coat", "thickness": "0.4 um", "wear": "2e-4 mm^3/N/m"}],
        "counter.layers": [{"name": "skin", "thickness": "0.1 um", "wear": "2e-3 mm^3/N/m"}],
    },
}


@pytest.mark.parametrize("law", CELL_BY_CELL)
def test_a_law_of_cell_by_cell_goes_on_from_any_step(law: str, threads: int) -> None:
    dice = np.random.default_rng(11)
    heights = SURFACES[0](dice)
    plan = [(increment, False) for increment in (10.0 ** dice.uniform(-3.0, 0.0, 8)).tolist()]
    study = Study.load("v3-fine").replace({"stepping.increment": "1 mm", "stepping.force": True})
    task = study.replace(CELL_BY_CELL[law]).contact_task
    with Executor(Grid(*SHAPE, CELL)) as executor:
        rows = [step.row for step in model_at_rest(task, heights.copy(), executor).steps(plan)]
        for restart in (1, 5):
            before = model_at_rest(task, heights.copy(), executor)
            again = [step.row for step in before.steps(plan[:restart])]
            arrays, numbers = saved.save(before)
            after = model_at_rest(task, heights.copy(), executor)
            saved.restore(after, arrays, json.loads(json.dumps(numbers)))
            assert [*again, *(step.row for step in after.steps(plan[restart:]))] == rows


def test_the_list_of_tiles_is_part_of_the_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it the test above fails: a bearing area has more than one approach within its tolerance."""
    dice = np.random.default_rng(7)
    heights = SURFACES[0](dice)
    increments = (10.0 ** dice.uniform(-3.0, 1.0, 12)).tolist()
    rows, _ = steps_of("bearing area", heights, increments, None)
    monkeypatch.setattr(Tiles, "STATE", {})
    assert any(steps_of("bearing area", heights, increments, k)[0] != rows for k in range(1, 12))


#: Long, or like quicker ones; what each of them has is stopped in another, too.
SLOW = (
    *COVERED,
    "programme, swept, stresses",
    "half-space track, jumps",
    "layers, jumps",
    "fretting, gross slip",
)


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=[pytest.mark.slow] if c in SLOW else []) for c in CASES]
)
def test_a_resumed_run_is_the_same_bit_for_bit(case: str, tmp_path: Path, cores: int) -> None:
    """Stopped twice, before and after its first snapshot, on one thread and on two."""
    study = soon_done(case)
    one, other = tmp_path / "alone", tmp_path / "stopped"
    warpwear.run(study, out=one, plots=False, threads=1).close()
    run_stopped(study, other, 3, threads=min(2, cores))
    run_stopped(study, other, 5, resume=True, threads=1)
    with warpwear.run(study, out=other, plots=False, resume=True, threads=min(2, cores)) as result:
        assert result.finished
        assert len(result.snapshot_distances) == 2
    assert differences(one, other) == []
    assert sorted(p.name for p in other.iterdir()) == sorted(p.name for p in one.iterdir())
