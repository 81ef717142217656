"""Two scales: patches that share a load, against the one-scale run and an independent NumPy solver."""

import numpy as np
import pytest
from cases_stepped import Stepped
from cases_two_scale import KINDS, of_kind, quick
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import ConvergenceError


@pytest.mark.parametrize(
    ("macro", "stiffness", "hardness", "distance"),
    [
        ("50 um", "inf N/mm^3", "590 MPa", "300 mm"),
        ("250 um", "inf N/mm^3", "590 MPa", "3 mm"),
        ("30 um", "1.9e6 N/mm^3", "590 MPa", "3 mm"),
        ("30 um", "1.9e6 N/mm^3", "inf MPa", "3 mm"),
    ],
)
def test_full_tiling_without_bulk_is_the_one_scale_run(
    macro: str, stiffness: str, hardness: str, distance: str, device: str
) -> None:
    """To 1e-12 in approach, pressures and wear, in every step of a worn run."""
    study = quick(
        patches__macro_cell=macro, patches__width=None, patches__bulk="none", contact__stiffness=stiffness
    )
    study = study.replace({"sliding.distance": distance, "contact.hardness": hardness})
    with (
        warpwear.run(study.replace({"study.model": "micro"}), device=device) as one,
        warpwear.run(study, device=device) as two,
    ):
        assert one.history["approach"].size > 100
        for name in ("approach", "pressure_max", "pressure_mean", "wear_volume_disc", "wear_depth_counter"):
            assert_allclose(two.history[name], one.history[name], rtol=1e-12, err_msg=name)
        for name in ("area_contact", "area_touched", "area_cumulative", "patch_along", "patch_across"):
            assert_allclose(two.history[name], one.history[name], rtol=1e-12, err_msg=name)
        for i in range(one.snapshot_distances.size):
            a, b = one.snapshot(i), two.snapshot(i)
            for name in ("wear_counter", "wear_disc"):
                expected = getattr(a, name)
                assert_allclose(getattr(b, name), expected, rtol=0.0, atol=1e-12 * expected.max())
            # heights sampled patch by patch and all at once are the same sum to its rounding, 1e-17 mm; a
            # pressure below hardness is their difference by the compliance 1/k + (K_s + K_d) ΔL
            wear_per_mm = 1e-3 * (study.wear.counter.value + study.wear.disc.value)
            step = one.history["increment"][np.argmin(np.abs(one.history["distance"] - a.distance))]
            compliance = 1.0 / study.contact.stiffness + wear_per_mm * step
            allowed = 1e-12 * a.pressure.max() + 1e-17 / compliance
            assert_allclose(b.pressure, a.pressure, rtol=0.0, atol=allowed)
            assert_allclose(b.gap, a.gap, rtol=0.0, atol=1e-15)
            assert_array_equal(b.pressure > 0.0, a.pressure > 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_conserved_in_every_step(kind: str, device: str) -> None:
    """The load, each patch's mean wear, the volumes, and what was ever touched."""
    study = of_kind(kind)
    stepped = Stepped(study, device=device)
    wear, load = sum(study.wear_coefficients), study.contact.load
    area = stepped.patches.area
    increments = (3e-3, 3e-3, 3e-3, 0.01, 0.03, 0.1, 0.1, 0.3, 0.3)
    unworn = before = stepped.gap()
    slid = 0.0
    for increment, step in zip(increments, stepped.model.steps((d, True) for d in increments), strict=True):
        row = step.row
        slid += increment
        share = stepped.model.book.table("load_share")[-1]
        assert share.sum() == pytest.approx(load, rel=1e-12)
        assert abs(row["load_residual"]) <= 1e-12 * load
        after = stepped.gap()
        worn = (after - before).mean(axis=(1, 2))
        asked = wear * share / area * increment
        # What is taken off a gap of 0.1 mm is rounded to 1e-17 mm.
        assert_allclose(worn, asked, rtol=1e-12, atol=1e-12 * asked.max())
        for body, k in zip(("counter", "disc"), study.wear_coefficients, strict=True):
            assert row[f"wear_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-10)
            assert row[f"archard_volume_{body}"] == pytest.approx(k * load * slid, rel=1e-12)
        patch, line, column = np.nonzero(after > unworn)
        weight = stepped.patches.weight * study.grid.cell**2
        assert row["area_touched"] == pytest.approx(patch.size * weight, rel=1e-12)
        along = np.ptp(stepped.patches.first_row[patch] + line) + 1
        across = np.ptp(stepped.patches.first_column[patch] + column) + 1
        assert row["patch_along"] == pytest.approx(along * study.grid.cell, rel=1e-12)
        assert row["patch_across"] == pytest.approx(across * study.grid.cell, rel=1e-12)
        before = after


@pytest.mark.parametrize("distance", ["10 mm", pytest.param("2400 mm", marks=pytest.mark.slow)])
def test_iterations_and_residuals_of_a_run(distance: str) -> None:
    with warpwear.run(quick(sliding__distance=distance)) as result:
        assert np.median(result.history["evaluations"]) <= 7.0  # and one that was made ahead
        assert np.abs(result.history["load_residual"]).max() <= 1e-12 * 8.0
        assert_allclose(result.load_share.sum(axis=1), 8.0, rtol=1e-12)
        assert_allclose(result.area_patch.sum(axis=1), result.history["area_contact"], rtol=1e-12)
        assert result.load_share.shape == (result.history["distance"].size, 900)
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10


@pytest.mark.parametrize("kind", ["no bulk", "bulk", "load"])
def test_a_step_that_does_not_converge_stops_the_run(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("warpwear.models.patches.shares.MAX_EVALUATIONS", 3)
    with pytest.raises(ConvergenceError, match=r"did not converge .*[0-9] (N|MPa) of") as caught:
        warpwear.run(of_kind(kind))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("first", ["1e-6 mm", "1e-10 mm"])
def test_a_run_may_begin_with_any_step(first: str) -> None:
    changes = {"stepping.first": first, "stepping.growth": 10.0, "sliding.distance": "1 mm"}
    with warpwear.run(quick().replace(changes)) as result:
        assert np.abs(result.history["load_residual"]).max() <= 1e-12 * 8.0
        assert max(map(abs, result.summary["conservation_relative"].values())) < 1e-10


def test_patches_of_a_field_come_back() -> None:
    field = np.random.default_rng(0).random((180, 180))
    tiling = quick(grid__extent="1.8 mm").patch_layout
    assert_array_equal(tiling.on_domain(tiling.stored(field)), field)
    for rule in ("centre", "random"):
        some = (
            of_kind("some of the area").replace({"patches.placement": rule, "patches.seed": 3}).patch_layout
        )
        back = some.on_domain(some.stored(field), beside=-1.0)
        covered = back != -1.0
        assert_array_equal(back[covered], field[covered])
        assert covered.sum() == some.count * some.side**2
        assert some.weight == pytest.approx(9.0)
        inside = (some.first_row % some.pitch) + some.side
        assert inside.max() <= some.pitch
    assert len(set(some.first_row % some.pitch)) > 1
