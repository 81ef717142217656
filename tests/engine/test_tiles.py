"""Visiting listed tiles only gives what visiting every tile gives."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from cases_tiles import CELL, LAWS, SHAPE, SURFACES
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.models.rest.local import OneScaleModel
from warpwear.runs.arrangements import model_at_rest


def run(
    law: str, heights: FloatArray, increments: list[float], threads: int, *, every: bool = False
) -> tuple[list, list]:
    """Steps and fields. every: whether each step visits every tile."""
    study = Study.load("v3-fine").replace({"stepping.increment": "1 mm", "stepping.force": True} | LAWS[law])
    with Executor(Grid(*SHAPE, CELL), threads=threads) as executor:
        model = model_at_rest(study.contact_task, heights.copy(), executor)
        assert isinstance(model, OneScaleModel)
        model.tiles.lists.set(is_fixed=int(every))
        steps = list(model.steps((increment, True) for increment in increments))
        last = model.snapshot(steps[-1], 0.0)
        fields = [field.copy() for field in (last.gap, last.wear_counter, last.wear_disc)]
    return steps, fields


def drawn(make: Callable[[np.random.Generator], FloatArray]) -> tuple[FloatArray, list[float]]:
    """Heights, and a random sequence of short and long steps."""
    rng = np.random.default_rng(5)
    return make(rng), (10.0 ** rng.uniform(-3.0, 1.0, 40)).tolist()


@cache
def of_every_tile(make: Callable[[np.random.Generator], FloatArray], law: str) -> tuple[list, list]:
    """The run that visits every tile, on one thread."""
    return run(law, *drawn(make), 1, every=True)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("make", SURFACES)
def test_listed_tiles_give_what_every_tile_gives(
    make: Callable[[np.random.Generator], FloatArray], law: str, threads: int
) -> None:
    """The same cells, approaches and volumes to 1e-12, on one thread and on two."""
    some, some_fields = run(law, *drawn(make), threads)
    every, every_fields = of_every_tile(make, law)
    for one, other in zip(some, every, strict=True):
        assert_array_equal(one.pressure > 0.0, other.pressure > 0.0)
        for name in ("area_contact", "area_plastic", "area_touched", "patch_along", "patch_across"):
            assert one.row[name] == pytest.approx(other.row[name], rel=1e-13), name
        assert one.row["approach"] == pytest.approx(other.row["approach"], rel=1e-12)
        for name in ("wear_volume_counter", "wear_volume_disc", "wear_depth_disc", "pressure_max"):
            assert one.row[name] == pytest.approx(other.row[name], rel=1e-11), name
    for one, other in zip(some_fields, every_fields, strict=True):
        assert_allclose(one, other, rtol=1e-11, atol=1e-15)


def test_an_early_contact_visits_few_tiles() -> None:
    study = Study.load("v3-fine").replace({"grid.cell": "2 um"})
    from warpwear.study.surface import surface_in

    grid = study.cells
    with Executor(grid) as executor:
        model = OneScaleModel(study.contact_task, surface_in(study).heights(grid.x, grid.y), executor)
        for _ in range(5):
            model.advance(3e-3)
        assert 0.0 < model.tiles.lists["listed"] < 0.1 * grid.nx * executor.tiles_per_row
