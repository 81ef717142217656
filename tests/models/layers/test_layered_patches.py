"""Patches whose bodies have layers: against closed forms, a plain reference and dense matrices."""

import json
from dataclasses import replace
from typing import Any

import cases_half_space
import numpy as np
import pytest
import reference
from cases_layered import CASE, COAT, HALF_SPACE, PLAIN, SKIN, Profiles, layered, task_of
from numpy.testing import assert_allclose

from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.history.recorder import Step
from warpwear.history.snapshot import Snapshot
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.patches.half_space import HalfSpacePatches
from warpwear.models.patches.local import TwoScaleModel

DOMAIN = Grid(15, 15, 0.01)
WHOLE, SOME = (Patches.laid_out(DOMAIN, pitch=5, side=side) for side in (5, 3))
HEIGHTS = np.random.default_rng(3).normal(0.0, 1.5e-3, DOMAIN.shape)
BULK = {"uses_bulk_stiffness": True, "bulk_stiffness": 2.0e5}
LAWS = [{}, pytest.param(HALF_SPACE | {"boundary": "periodic"}, marks=pytest.mark.transforms)]
of_laws = pytest.mark.parametrize("law", LAWS, ids=["local", "half-space"])
of_both = pytest.mark.parametrize("profiles", [(PLAIN, COAT), (SKIN, COAT)], ids=["disc", "both"])


def model_of(
    task: ContactTask, executor: Executor, heights: FloatArray = HEIGHTS, patches: Patches = WHOLE
) -> TwoScaleModel | HalfSpacePatches:
    """A model of its law."""
    return (HalfSpacePatches if task.half_space else TwoScaleModel)(task, patches, heights, executor)


def stepped(model: TwoScaleModel | HalfSpacePatches, increments: list[float]) -> tuple[list[Step], Snapshot]:
    """All steps, of which the last leaves a snapshot."""
    steps = list(model.steps([(d, n + 1 == len(increments)) for n, d in enumerate(increments)]))
    return steps, model.snapshot(steps[-1], steps[-1].row["distance"])


@pytest.mark.parametrize(
    "profiles", [(PLAIN, COAT), (SKIN, COAT), (COAT, CASE)], ids=["disc", "both", "gradient"]
)
@of_laws
@pytest.mark.parametrize("patches", [WHOLE, SOME], ids=["whole", "some"])
def test_flat_on_flat_wears_by_the_closed_form(
    profiles: Profiles, law: dict[str, Any], patches: Patches, device: str, threads: int
) -> None:
    """Every cell bears F/A; Σ V_m / K_m = F L of each body, of what patches stand for."""
    load, count, increment = 8.0, 100, 12000.0
    with Executor(patches.grid, device=device, threads=threads) as executor:
        model = model_of(task_of(profiles, load=load, **law), executor, np.zeros(DOMAIN.shape), patches)
        steps, fields = stepped(model, [increment] * count)
    row, total = steps[-1].row, load * increment * count
    for body, profile in zip(("counter", "disc"), profiles, strict=True):
        depth = getattr(fields, f"wear_{body}")
        expected = float(profile.worn(np.zeros(1), np.array([total / DOMAIN.area]))[0])
        assert_allclose(depth[depth > 0.0], expected, rtol=1e-12)
        assert np.count_nonzero(depth) == patches.count * patches.side**2
        assert row[f"archard_volume_{body}"] == pytest.approx(row[f"wear_volume_{body}"], rel=1e-12)
        if len(profile.materials) > 1 and not profile.graded:
            assert getattr(fields, f"material_{body}").max() == len(profile.materials) - 1
            volumes = [row[f"wear_volume_{body}_{m.name}"] for m in profile.materials]
            books = sum(v / m.wear for v, m in zip(volumes, profile.materials, strict=True))
            assert books == pytest.approx(total, rel=1e-12)
            assert row[f"load_share_{body}_substrate"] == pytest.approx(1.0, rel=1e-12)
            assert row[f"area_{body}_substrate"] == pytest.approx(DOMAIN.area, rel=1e-12)


@of_both
def test_rough_patches_of_one_approach_wear_as_one_grid(
    profiles: Profiles, device: str, threads: int
) -> None:
    """Without a bulk patches that tile the domain are a contact of all its cells."""
    load, increments = 60.0, [400.0] * 19
    with Executor(WHOLE.grid, device=device, threads=threads) as executor:
        steps, fields = stepped(model_of(task_of(profiles, load=load), executor), increments)
    counter, disc, pressure = reference.layered_run(
        -HEIGHTS, (layered(profiles[0]), layered(profiles[1])), load=load, increments=increments,
        cell=DOMAIN.cell, own=1e-7,
    )  # fmt: skip
    assert_allclose(fields.wear_counter, counter, rtol=1e-8, atol=1e-13)
    assert_allclose(fields.wear_disc, disc, rtol=1e-8, atol=1e-13)
    assert_allclose(fields.gap, counter + disc - HEIGHTS, rtol=1e-8, atol=1e-13)
    assert_allclose(fields.pressure, pressure, rtol=1e-6, atol=1e-4)
    assert any(0.0 < step.row["load_share_disc_bond"] < 0.5 for step in steps)
    assert fields.material_disc is not None
    assert np.array_equal(fields.material_disc, profiles[1].material_at(fields.wear_disc))


@of_both
@of_laws
def test_patches_on_their_bulk_are_those_of_a_dense_matrix(
    profiles: Profiles, law: dict[str, Any], device: str
) -> None:
    """With K and the cap of each cell as a step begins; a cell that wears through is split by volume."""
    load, increment = 25.0, 2000.0
    one = Grid(WHOLE.side, WHOLE.side, DOMAIN.cell)
    block = np.full((one.cells, one.cells), 1.0 / BULK["bulk_stiffness"] / one.cells)
    if law:
        block += cases_half_space.dense_periodic(one) * cases_half_space.MODULUS / law["modulus"]
    else:
        block += 1e-7 * np.eye(one.cells)
    elastic = np.kron(np.eye(WHOLE.count), block)
    unworn, worn = -cells_of(HEIGHTS).ravel(), [np.zeros(DOMAIN.cells), np.zeros(DOMAIN.cells)]
    met = []
    with Executor(WHOLE.grid, device=device, threads=1) as executor:
        model = model_of(task_of(profiles, load=load, **BULK, **law), executor)
        if isinstance(model, HalfSpacePatches):
            model._solver._rules = replace(model._solver._rules, tolerance=1e-11)
        for _ in range(12):
            (step,), fields = stepped(model, [increment])
            pairs = list(zip(profiles, worn, strict=True))
            k = sum(profile.coefficient_at(depth) for profile, depth in pairs) * increment
            caps = np.minimum(*(profile.hardness_at(depth) for profile, depth in pairs))
            matrix = elastic + np.diag(k)
            p = cases_half_space.bounded(matrix, unworn + sum(worn), step.row["approach"], caps)
            assert_allclose(cells_of(fields.pressure).ravel(), p, atol=1e-6 * p.max())
            assert p.sum() * DOMAIN.cell_area == pytest.approx(load, rel=1e-6)
            for profile, depth in pairs:
                depth[:] = profile.worn(depth, p * increment)
            for body, depth in zip(("counter", "disc"), worn, strict=True):
                found = cells_of(getattr(fields, f"wear_{body}")).ravel()
                assert_allclose(found, depth, atol=1e-6 * depth.max())
            met.append(np.mean(worn[1] > profiles[1].depths[1]))
    assert any(0.0 < part < 1.0 for part in met)


def cells_of(field: FloatArray) -> FloatArray:
    """A field of the domain patch by patch."""
    return WHOLE.stored(field).reshape(WHOLE.count, WHOLE.side, -1)[:, :, : WHOLE.side]


@of_laws
@pytest.mark.parametrize("bulk", [{}, BULK], ids=["no bulk", "bulk"])
def test_a_layer_that_is_not_worn_through_leaves_the_plain_numbers(
    law: dict[str, Any], bulk: dict[str, Any]
) -> None:
    """To the last bit, whatever lies below."""
    task = task_of((PLAIN, replace(COAT, depths=(0.0, 1.0, 2.0))), load=25.0, **law, **bulk)
    found = []
    for one in (task, replace(task, profiles=None)):
        with Executor(WHOLE.grid, threads=1) as executor:
            found.append(stepped(model_of(one, executor), [400.0] * 30))
    (steps, fields), (plain, expected) = found
    for step, bare in zip(steps, plain, strict=True):
        assert {name: step.row[name] for name in bare.row} == bare.row
    for name, values in expected.fields.items():
        assert np.array_equal(values, fields.fields[name])


@of_laws
def test_two_threads_and_a_restart_find_the_same(two_threads: int, law: dict[str, Any]) -> None:
    """A block before the first material is reached, and one after it."""
    task, found = task_of((SKIN, COAT), load=25.0, **BULK, **law), []
    increments = [20.0] * 30 + [900.0] * 10
    for threads, restarts in ((1, ()), (two_threads, (3, 12, 35))):
        with Executor(WHOLE.grid, threads=threads) as executor:
            model, rows, done = model_of(task, executor), [], 0
            for end in (*restarts, len(increments)):
                plan = [(increment, False) for increment in increments[done:end]]
                rows += [step.row for step in model.steps(plan)]
                arrays, numbers = saved.save(model, whole=True)
                done, model = end, model_of(task, executor)
                saved.restore(model, arrays, json.loads(json.dumps(numbers)))
        found.append(rows)
    assert found[0] == found[1]
