"""Patches on the half-space pressed to loads of their own: against dense matrices, and one by one."""

import math

import numpy as np
import pytest
from cases_half_space import MODULUS, bounded
from cases_half_space_patches import (
    BOUNDARIES,
    GAPS,
    KINDS,
    ONE,
    PATCHES,
    Solved,
    Stepped,
    quick,
)
from numpy.testing import assert_allclose, assert_array_equal

from warpwear import InputError
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.models.patches.local import TwoScaleModel
from warpwear.study.surface import surface_in

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


OPEN = GAPS.reshape(PATCHES.count, -1)
#: Mean pressures of the patches, over the hardness or 1 MPa; in turn, so that loads come and go.
LOADS = {"all": (0.3, 0.05, 0.9, 1e-3), "to the cap": (1.0, 0.0, 0.2, 1e-6), "some": (0.5, 0.5, 0.0, 0.6)}


def asked(loads: str, hardness: float) -> FloatArray:
    return np.array(LOADS[loads]) * min(hardness, 1.0)


@pytest.mark.parametrize("hardness", [math.inf, 1.5, 0.2])
@pytest.mark.parametrize("compliance", [0.0, 0.3])
@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_against_a_dense_matrix_of_each(
    boundary: str, compliance: float, hardness: float, device: str
) -> None:
    """Also from the pressures under other loads, of which some begin and some end."""
    matrix = BOUNDARIES[boundary] + compliance * np.eye(ONE.cells)
    solved = Solved(boundary, 0.0, hardness, device=device)
    for loads in LOADS:
        mean = asked(loads, hardness)
        contact, pressure = solved.at(mean_pressure=mean, compliance=compliance)
        assert_allclose(pressure.mean(axis=1), mean, rtol=1e-12)
        assert contact.mean_pressure == pytest.approx(mean.mean(), rel=1e-12)
        assert contact.cells_in_contact == np.count_nonzero(pressure)
        # The conditions of complementarity, which make it the minimum.
        apart = pressure @ matrix + OPEN - contact.approaches[:, None]
        assert apart[pressure == 0.0].min() >= -1e-9
        assert apart[pressure > 0.0].max() <= 1e-9
        assert apart[pressure < hardness].min() >= -1e-9
        if compliance or boundary == "free":  # so that the matrix is definite
            for p, gap, level in zip(pressure, OPEN, contact.approaches, strict=True):
                if 0.0 < p.mean() < hardness:
                    expected = bounded(matrix, gap, level, hardness)
                    assert_allclose(p, expected, atol=1e-7 * max(expected.max(), 1e-3))


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("loads", LOADS)
def test_every_patch_is_pressed_as_if_alone(boundary: str, loads: str) -> None:
    """By the solver of one grid."""
    hardness, compliance = 1.5, 0.05
    contact, pressure = Solved(boundary, 0.0, hardness).at(
        mean_pressure=asked(loads, hardness), compliance=compliance
    )
    with Executor(ONE) as executor:
        for k, mean in enumerate(asked(loads, hardness)):
            if mean == 0.0:
                assert not pressure[k].any()
                continue
            alone = HalfSpace(
                executor, modulus=MODULUS, boundary=boundary, hardness=hardness, tolerance=1e-11
            )
            pressed = alone.solve(executor.field(GAPS[k]), mean_pressure=mean, compliance=compliance)
            assert_allclose(pressure[k], pressed.pressure.ravel(), rtol=0.0, atol=1e-8 * hardness)
            assert contact.approaches[k] == pytest.approx(pressed.approach, abs=1e-9)


def test_only_the_patches_visited_need_loads() -> None:
    """One of them is a row with a load of its own, not all cells."""
    whole, pressures = Solved("free", 0.0, 1.5).at(mean_pressure=np.array([0.3, 0.2, 0.1, 0.4]))
    for visited in (1, 3):
        some = Solved("free", 0.0, 1.5)
        some.influence.visit(visited)
        contact, found = some.at(mean_pressure=np.array([0.3, 0.2, 0.1])[:visited])
        assert_allclose(found[:visited], pressures[:visited], atol=1e-8)
        assert not found[visited:].any()
        assert_allclose(contact.approaches, whole.approaches[:visited], atol=1e-9)


@pytest.mark.parametrize(
    ("loads", "told"),
    [
        ((0.1, -0.2, 0.1, 0.1), "-0.2"),
        ((0.1, 1.6, 0.0, 0.0), "1.6"),
        ((0, 0, 0, 0), "0"),
        ((math.nan,) * 4, "nan"),
    ],
)
def test_loads_that_no_patch_carries(loads: tuple[float, ...], told: str) -> None:
    with pytest.raises(InputError, match=f"a mean pressure of {told} MPa is not possible"):
        Solved("free", 0.0, 1.5).at(mean_pressure=np.array(loads))


@pytest.mark.parametrize("kind", [k for k in KINDS if "loads" in k])
def test_the_loads_are_those_of_the_local_law(kind: str) -> None:
    """What a smooth contact prescribes does not depend on how the patches answer."""
    study = quick().replace(KINDS[kind])
    if study.contact.bulk_update == "updated":  # which follows the scar, and so the patches
        study = study.replace({"contact.bulk_update": "initial"})
    model = Stepped(study).model
    heights = surface_in(study).heights(study.cells.x, study.cells.y)
    with Executor(study.patch_layout.grid) as executor:
        local = study.replace({"contact.law": "local"})
        other = TwoScaleModel(local.contact_task, study.patch_layout, heights, executor)
        for increment in (0.003, 0.3, 3.0, 0.1):
            row, expected = model.advance(increment).row, other.advance(increment).row
            shares = [m.book.table("load_share")[-1] for m in (model, other)]
            assert_allclose(*shares, rtol=3e-12)
            assert row["approach"] == expected["approach"]
    assert 0 < np.count_nonzero(shares[0]) <= model.visited < model.patches.count


def test_a_patch_may_let_go_of_its_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """It then carries nothing, is not worn, and takes load again; also in the first step after a restart."""
    study = quick(patches__coupling="load")
    begun, stepped = Stepped(study), Stepped(study)
    begun.model.advance(3.0)
    saved.restore(stepped.model, *saved.save(begun.model))
    model, smooth = stepped.model, stepped.model._smooth
    assert smooth is not None
    press = type(smooth).press
    last = model._order[begun.model.visited - 1]
    number = begun.model.visited
    before = stepped.gap()[number - 1]

    def without(self: object, **options: float) -> FloatArray:
        loads = press(smooth, **options)
        loads[model._order[0]] += loads[last]
        loads[last] = 0.0
        return loads

    monkeypatch.setattr(type(smooth), "press", without)
    model.advance(0.1)
    assert model.visited == number
    assert model.book.table("load_share")[-1][last] == 0.0
    assert_array_equal(stepped.gap()[number - 1], before)
    assert not model._executor.to_numpy(model._solver.pressure_field)[number - 1].any()
    monkeypatch.undo()
    model.advance(0.1)
    assert model.book.table("load_share")[-1][last] > 0.0
