"""Patches on the half-space: against dense matrices, the solver of one grid, and the local law."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import drawn
from cases_half_space import MODULUS, bounded
from cases_half_space_patches import BOUNDARIES, GAPS, KINDS, ONE, PATCHES, Solved, Stepped, quick
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import InputError, Study
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine import state as saved
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray
from warpwear.models.patches.local import TwoScaleModel
from warpwear.study.surface import surface_in

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


@pytest.mark.parametrize("hardness", [math.inf, 1.5, 0.2])
@pytest.mark.parametrize(
    ("boundary", "bulk", "compliance"),
    [
        ("periodic", 0.7, 0.0),
        ("periodic", 0.7, 0.3),
        ("periodic", 0.0, 0.3),
        ("periodic", 0.0, 0.0),
        ("free", 0.0, 0.0),
        ("free", 0.0, 0.3),
    ],
)
def test_against_a_dense_block_diagonal_matrix(
    boundary: str, bulk: float, compliance: float, hardness: float, device: str
) -> None:
    block = BOUNDARIES[boundary] + bulk / ONE.cells + compliance * np.eye(ONE.cells)
    matrix = np.kron(np.eye(PATCHES.count), block)
    mean = min(0.15, 0.3 * hardness)
    solved = Solved(boundary, bulk, hardness, device=device)
    contact, pressure = solved.at(mean_pressure=mean, compliance=compliance)
    assert pressure.mean() == pytest.approx(mean, rel=1e-12)
    assert contact.cells_in_contact == np.count_nonzero(pressure)
    assert 0 < np.count_nonzero(pressure.sum(axis=1)) < PATCHES.count
    # The conditions of complementarity, which make it the minimum.
    apart = (matrix @ pressure.ravel()).reshape(pressure.shape) + GAPS.reshape(pressure.shape)
    apart -= contact.approach
    assert apart[pressure == 0.0].min() >= -1e-9
    assert apart[pressure > 0.0].max() <= 1e-9
    assert apart[pressure < hardness].min() >= -1e-9
    if bulk or compliance or boundary == "free":  # so that the matrix is definite
        expected = bounded(matrix, GAPS.reshape(pressure.shape), contact.approach, hardness)
        if ((pressure > 0.0) & (pressure < hardness)).any():
            assert_allclose(pressure, expected, atol=1e-8 * expected.max())
        solved.solver.forget()
        _, found = solved.at(approach=contact.approach + 1e-6, compliance=compliance)
        expected = bounded(matrix, GAPS.reshape(pressure.shape), contact.approach + 1e-6, hardness)
        assert_allclose(found, expected, atol=1e-8 * expected.max())


@pytest.mark.parametrize("compliance", [0.0, 0.05])
@pytest.mark.parametrize(("boundary", "bulk"), [("periodic", 0.7), ("periodic", 0.0), ("free", 0.0)])
def test_every_patch_is_a_contact_of_its_own(boundary: str, bulk: float, compliance: float) -> None:
    """u_k + p_k/K_N = δ with the approach u_k of a grid that the solver of one grid presses by itself."""
    hardness, mean = 3.0, 0.3
    solved = Solved(boundary, bulk, hardness)
    contact, pressure = solved.at(mean_pressure=mean, compliance=compliance)
    means = pressure.mean(axis=1)
    assert 1 < np.count_nonzero(means) < PATCHES.count
    block, joined = BOUNDARIES[boundary] + compliance * np.eye(ONE.cells), 0.0
    with Executor(ONE) as executor:
        for gap, p_k in zip(GAPS, means, strict=True):
            if p_k == 0.0:
                assert gap.min() >= contact.approach - 1e-10
                continue
            alone = HalfSpace(
                executor, modulus=MODULUS, boundary=boundary, hardness=hardness, tolerance=1e-11
            )
            pressed = alone.solve(executor.field(gap), mean_pressure=p_k, compliance=compliance)
            assert pressed.approach + bulk * p_k == pytest.approx(contact.approach, abs=1e-9)
            alone.forget()
            approach = contact.approach - bulk * p_k
            moved = alone.solve(executor.field(gap), approach=approach, compliance=compliance)
            assert moved.mean_pressure == pytest.approx(p_k, rel=1e-7)
            between = ((moved.pressure > 0.0) & (moved.pressure < hardness)).ravel()
            inverse = np.linalg.inv(block[np.ix_(between, between)])
            slope = inverse.sum() / ONE.cells
            joined += slope / (1.0 + bulk * slope) / PATCHES.count
    step = 1e-4 * mean
    ends = [solved.at(mean_pressure=mean + s, compliance=compliance)[0].approach for s in (-step, step)]
    assert 2.0 * step / (ends[1] - ends[0]) == pytest.approx(joined, rel=1e-4)


@pytest.mark.parametrize("coupling", ["approach", "load"])
def test_threads_change_nothing(two_threads: int, coupling: str) -> None:
    found = []
    for count in (1, two_threads):
        stepped = Stepped(quick(patches__coupling=coupling), threads=count)
        found.append([stepped.model.advance(increment).row for increment in (0.003, 0.3, 3.0)])
        assert stepped.executor.is_shared == (count > 1)
    assert found[0] == found[1]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_conserved_in_every_step(kind: str, device: str) -> None:
    """The load, each patch's mean wear, the volumes, what was ever touched, and what was left out."""
    study = quick().replace(KINDS[kind])
    stepped = Stepped(study, device=device)
    model, patches = stepped.model, stepped.model.patches
    wear, load = sum(study.wear_coefficients), study.contact.load
    unworn = before = stepped.gap()
    slid = 0.0
    for increment in (3e-3, 0.01, 0.3, 3.0, 0.1):
        row = model.advance(increment).row
        slid += increment
        share = model.book.table("load_share")[-1]
        assert share.sum() == pytest.approx(load, rel=1e-12)
        assert abs(row["load_residual"]) <= 1e-12 * load
        after = stepped.gap()
        asked = wear * share[model._order] / patches.area * increment
        # What is taken off a gap of 0.1 mm is rounded to 1e-17 mm.
        assert_allclose((after - before).mean(axis=(1, 2)), asked, rtol=1e-12, atol=1e-12 * asked.max())
        for body, k in zip(("counter", "disc"), study.wear_coefficients, strict=True):
            assert row[f"wear_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-10)
            assert row[f"archard_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-12)
        patch, line, column = np.nonzero(after > unworn)
        of_cell = patches.weight * study.grid.cell**2
        assert row["area_touched"] == pytest.approx(patch.size * of_cell, rel=1e-12)
        along = np.ptp(patches.first_row[patch] + line) + 1
        across = np.ptp(patches.first_column[patch] + column) + 1
        assert row["patch_along"] == pytest.approx(along * study.grid.cell, rel=1e-12)
        assert row["patch_across"] == pytest.approx(across * study.grid.cell, rel=1e-12)
        worn = after - before > 0.0
        in_contact = np.zeros(patches.count)
        in_contact[model._order] = worn.sum(axis=(1, 2)) * of_cell
        assert_allclose(model.book.table("area_patch")[-1], in_contact, rtol=1e-12)
        assert row["area_contact"] == pytest.approx(in_contact.sum(), rel=1e-12)
        assert 0 < model.visited < patches.count
        assert not share[model._order[model.visited :]].any()
        if study.patches.coupling == "approach":
            assert unworn[model.visited :].min() >= row["approach"]
        before = after


def test_patches_that_are_left_out_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """From a first guess of the patches that is too few, too."""
    study = quick()
    some, every = Stepped(study).model, Stepped(study).model
    monkeypatch.setattr(every, "_below", lambda approach: every.patches.count)
    for model in (some, every):
        model._solver.tolerance = 1e-10
    for increment in (0.003, 0.1, 3.0):
        guess = some._below(some._reached)
        row, expected = some.advance(increment).row, every.advance(increment).row
        assert guess < some.visited < every.visited
        for name, value in row.items():
            if name != "evaluations":
                assert value == pytest.approx(expected[name], rel=1e-6, abs=1e-12, nan_ok=True), name
        shares = [model.book.table("load_share")[-1] for model in (some, every)]
        assert_allclose(*shares, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("behind", [{"bulk": "none"}, {"bulk": "spring"}, {"coupling": "load"}])
def test_stiff_bodies_are_on_the_capped_foundation(behind: dict[str, str]) -> None:
    """What is left of a cell's compliance is K ΔL, as with the local law."""
    study = quick(**{"counter.young": "1e9 GPa", "disc.young": "1e9 GPa"})
    study = study.replace({f"patches.{key}": value for key, value in behind.items()})
    study = study.replace({"contact.bulk_stiffness": "2e5 N/mm^3"})
    one = Stepped(study)
    local = study.replace({"contact.law": "local"})
    heights = surface_in(study).heights(study.cells.x, study.cells.y)
    with Executor(study.patch_layout.grid) as executor:
        other = TwoScaleModel(local.contact_task, study.patch_layout, heights, executor)
        for increment in (0.03, 0.3, 3.0, 3.0):
            row, expected = one.model.advance(increment).row, other.advance(increment).row
            assert row["approach"] == pytest.approx(expected["approach"], abs=1e-8)
            for name in ("area_contact", "area_plastic", "wear_volume_counter", "wear_depth_disc"):
                assert row[name] == pytest.approx(expected[name], rel=1e-3), name
            found, wanted = (model.book.table("load_share")[-1] for model in (one.model, other))
            assert 0.5 * np.abs(found - wanted).sum() < 1e-3 * study.contact.load


def test_soft_cells_are_those_below_a_cut() -> None:
    """With bodies that hardly yield but flow at H, cells in contact are the lowest, F/H of them."""
    study = quick(**{"counter.young": "1e6 GPa", "disc.young": "1e6 GPa", "patches.bulk": "none"})
    stepped = Stepped(study)
    gap = stepped.gap()
    row = stepped.model.advance(0.0, with_pressure=True).row
    cells = study.contact.load / (study.hardness * study.cells.cell_area)
    assert row["cells_in_contact"] == math.ceil(cells)
    assert row["area_plastic"] == pytest.approx(math.floor(cells) * study.cells.cell_area)
    assert row["approach"] == pytest.approx(np.sort(gap.ravel())[math.ceil(cells) - 1], abs=1e-8)


@pytest.mark.parametrize("bulk", ["none", "spring"])
def test_flat_bodies_share_the_load_evenly(bulk: str) -> None:
    """Also where nothing but the choice of the patches visited says so."""
    flat = {"counter.radius": "inf mm", "contact.bulk_stiffness": "2e6 N/mm^3", "patches.bulk": bulk}
    model = Stepped(quick(disc__synthetic={"kind": "flat"}).replace(flat)).model
    for increment in (0.0, 3.0):
        model.advance(increment)
        assert_allclose(model.book.table("load_share")[-1], 8.0 / 400.0, rtol=1e-9)


#: Static, of a smooth ball on a smooth disc; patches yield in no way to their means.
SMOOTH: dict[str, Any] = {
    "contact.law": "half-space",
    "patches.bulk": "none",
    "disc.synthetic.kind": "flat",
    "sliding.distance": "0 mm",
    "output.snapshots": ["0 mm"],
}


def test_patches_that_do_not_resist_fill_in_the_order_of_their_gaps() -> None:
    """From one patch to another load goes for nothing: no length of a step is the best, and none too long."""
    study = Study.load("two-scale").replace(
        SMOOTH
        | {
            "counter.radius": "30 mm",
            "grid.cell": "5 um",
            "grid.extent": "50 um",
            "patches.macro_cell": "10 um",
            "contact.load": "0.1 N",
            "checks.strict": False,  # the contact is as wide as the domain
        }
    )
    result = warpwear.run(study)
    pressure = result.snapshot(0).pressure
    assert_allclose(pressure[4:6, 4:6], 590.0)  # the one beneath the apex is full
    share = result.load_share[0].reshape(5, 5)
    beside = [share[1, 2], share[3, 2], share[2, 1], share[2, 3]]
    assert math.fsum(beside) == pytest.approx(0.1 - 590.0 * 1e-4, rel=1e-9)


def test_a_load_near_what_the_counter_can_carry_asks_for_more_patches() -> None:
    """Cells beyond its rim carry nothing."""
    study = Study.load("two-scale").replace(
        SMOOTH
        | {
            "counter.radius": "0.2 mm",
            "contact.hardness": "100 MPa",
            "contact.load": "11.8 N",  # of 12.57
            "grid.cell": "10 um",
            "grid.extent": "0.42 mm",
            "patches.macro_cell": "70 um",
            "patches.bulk": "spring",
            "checks.strict": False,  # the contact is as wide as the counter-body
        }
    )
    result = warpwear.run(study)
    assert result.history["load_residual"][0] == pytest.approx(0.0, abs=1e-10)
    assert result.history["area_plastic"][0] > 0.9 * 0.118


@pytest.mark.parametrize("kind", ["bulk", "bulk that follows, no cap", *(k for k in KINDS if "loads" in k)])
def test_a_model_goes_on_from_any_step(kind: str) -> None:
    study = quick().replace(KINDS[kind])
    increments = (0.003, 0.1, 3.0, 0.01, 1.0)

    def rows(restart: int | None) -> tuple[list[dict[str, float]], FloatArray, FloatArray]:
        stepped, found = Stepped(study), []
        for number, increment in enumerate(increments):
            if number == restart:
                arrays, numbers = saved.save(stepped.model)
                stepped = Stepped(study)
                saved.restore(stepped.model, arrays, json.loads(json.dumps(numbers)))
            found.append(stepped.model.advance(increment).row)
        return found, stepped.gap(), stepped.model.book.table("load_share")

    alone = rows(None)
    for restart in (1, 3):
        again = rows(restart)
        assert again[0] == alone[0]
        assert_array_equal(again[1], alone[1])
        assert_array_equal(again[2], alone[2])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"patches.coupling": "load", "contact.hardness": "inf MPa"}, "needs a finite contact.hardness"),
        ({"contact.boundary": "free"}, "patches.bulk = 'spring' does not go with contact.boundary = 'free'"),
        ({"stepping.scheme": "explicit"}, "needs stepping.scheme = 'implicit'"),
        ({"sliding.kinematics": "swept"}, "sliding.kinematics"),
        ({"counter.material": None}, "needs Young's modulus and Poisson's ratio of both bodies"),
        ({"patches.width": "12 um"}, "patches.width = 12 µm is not a whole number of cells"),
        ({"contact.hardness": "1 MPa"}, "more than the domain under the counter-body carries"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_sentence(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as refused:
        quick().replace(changes)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_patches_are_periodic_unless_it_is_said_otherwise() -> None:
    assert quick().boundary == "periodic"
    assert quick(**KINDS["free"]).boundary == "free"
    assert quick(study__model="micro").boundary == "free"


def test_a_whole_run(tmp_path: Path, device: str) -> None:
    with warpwear.run(
        quick(output__snapshots=["0.3 mm"]), device=device, out=tmp_path, plots=False
    ) as result:
        area = result.study.cells.cell_area
        assert_allclose(result.load_share.sum(axis=1), 8.0, rtol=1e-12)
        assert_allclose(result.area_patch.sum(axis=1), result.history["area_contact"], rtol=1e-12)
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10
        for index in range(2):
            snapshot = result.snapshot(index)
            row = int(np.searchsorted(result.history["distance"], snapshot.distance))
            n = round(result.study.cells.nx / result.study.patches.macro_cell * result.study.cells.cell)
            of_patches = snapshot.pressure.reshape(n, -1, n, 5).sum(axis=(1, 3)) * area
            assert_allclose(of_patches.ravel(), result.load_share[row], atol=1e-12)
            assert snapshot.wear_disc.sum() * area == pytest.approx(
                result.history["wear_volume_disc"][row], rel=1e-10
            )
        figure, _ = drawn(result, "load_share")
        maps = [axes for axes in figure.axes if axes.images]
        assert len(maps) == 4
        for axes in maps:
            shown = np.ma.filled(axes.images[0].get_array(), np.nan)
            assert np.nansum(shown) * result.study.patches.macro_cell**2 == pytest.approx(8.0, rel=1e-9)
        assert drawn(result, "patch_zoom")[0].axes
