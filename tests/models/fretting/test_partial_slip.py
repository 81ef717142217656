"""Partial slip: volume, energy and stick of the closed forms, the limit of wear, and what a drive yields."""

import math
from typing import Any

import numpy as np
import pytest
from cases_fretting import (
    BORDER,
    FRICTION,
    HERTZ,
    LOAD,
    MODULUS,
    RADIUS,
    energy_of_cycle,
    sheared,
    study_of,
)

import warpwear
from warpwear import InputError, Study
from warpwear.laws.fretting import energy_ratio, power_of


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


def test_the_first_cycle_wears_what_its_energy_asks_for(device: str) -> None:
    """Energy of a cycle by Mindlin and Deresiewicz, ν entering by its compliance alone; V = (K/μ) E_d."""
    result = warpwear.run(sheared(128, sliding__cycles=1, stepping__increment="1 mm"), device=device)
    row = {name: values[-1] for name, values in result.history.items()}
    energy = energy_of_cycle(0.6)
    assert row["energy"] == pytest.approx(energy, rel=1e-3)
    assert row["wear_volume_disc"] == pytest.approx(1e-9 / FRICTION * energy, rel=1e-3)
    displacement = BORDER * (1.0 - 0.4 ** (2 / 3))
    assert row["displacement"] == pytest.approx(displacement, rel=1e-3)
    assert row["displacement_border"] == pytest.approx(BORDER, rel=1e-3)
    assert row["energy_ratio"] == pytest.approx(energy / (4.0 * 7.2 * displacement), rel=2e-3)
    stick = math.sqrt(row["stick_area"] / math.pi)
    assert stick == pytest.approx(HERTZ * 0.4 ** (1 / 3), rel=5e-3)


@pytest.mark.parametrize("ratio", [0.1, 0.9])
def test_other_forces(ratio: float) -> None:
    study = sheared(128, sliding__cycles=1, stepping__increment="1 mm", sliding__force=f"{ratio * 12.0} N")
    row = {name: values[-1] for name, values in warpwear.run(study).history.items()}
    assert row["energy"] == pytest.approx(energy_of_cycle(ratio), rel=1e-2)
    assert row["displacement"] == pytest.approx(BORDER * (1.0 - (1.0 - ratio) ** (2 / 3)), rel=1e-3)


@pytest.fixture(scope="module")
def worn() -> warpwear.Result:
    """Λ = 4κμ K p0 N of 30: most of what the ring carried is gone."""
    return warpwear.run(sheared(128, wear__counter="2e-5 mm^3/N/m", wear__disc="2.1e-5 mm^3/N/m"))


def test_volumes_follow_the_energy_and_what_sticks_never_wears(worn: warpwear.Result) -> None:
    history = worn.history
    energy = np.cumsum(history["energy"] * history["cycles"])
    for body, coefficient in (("counter", 2e-8), ("disc", 2.1e-8)):
        volume = history[f"wear_volume_{body}"]
        np.testing.assert_allclose(volume, coefficient / FRICTION * energy, rtol=1e-12)
        np.testing.assert_allclose(volume, history[f"archard_volume_{body}"], rtol=1e-12)
    np.testing.assert_allclose(history["friction_energy"], 1e-3 * energy, rtol=1e-12)
    assert np.ptp(history["stick_area"]) == 0.0
    end = worn.snapshots[-1]
    assert end.slip is not None
    sticks = (end.slip == 0.0) & (end.pressure > 0.0)
    assert np.count_nonzero(sticks) * worn.study.cells.cell_area == pytest.approx(history["stick_area"][0])
    assert not end.wear_counter[sticks].any()
    assert not end.wear_disc[sticks].any()
    assert end.wear_disc[end.slip > 0.0].all()


def limit(study: Study, stick: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return radii, and pressure and wear of both bodies as N → ∞ (Ciavarella and Hills 1999, Popov 2014)."""
    x, c = study.cells.x, stick
    r = np.hypot.outer(x, x)
    depth = LOAD / (2.0 * MODULUS * c) + c**2 / (3.0 * RADIUS)
    root = np.sqrt(np.maximum(c**2 - r**2, 1e-30))
    inside = 2.0 * root / (math.pi * RADIUS) + (depth - c**2 / RADIUS) / (math.pi * root)
    out = np.maximum(r, c * (1.0 + 1e-12))
    shape = 2.0 / (math.pi * RADIUS) * (0.5 * out**2 * np.arcsin(c / out) - 0.5 * c * np.sqrt(out**2 - c**2))
    shape += 2.0 * depth / math.pi * np.arccos(c / out)
    wear = np.where(r > c, np.maximum(shape - r**2 / (2.0 * RADIUS), 0.0), 0.0)
    return r, np.where(r < c, MODULUS * inside, 0.0), wear


@pytest.mark.parametrize("cells", [64, 128])
def test_the_limit_of_wear(cells: int) -> None:
    """A punch with the unworn shape and sharp edges; what is off halves with the cell."""
    off = 128 / cells
    study = sheared(cells, wear__counter="1e-3 mm^3/N/m", wear__disc="1e-3 mm^3/N/m")
    result = warpwear.run(study)
    end, stick = result.snapshots[-1], math.sqrt(result.history["stick_area"][-1] / math.pi)
    r, pressure, wear = limit(study, stick)
    assert end.pressure[r > stick + 2.0 * study.grid.cell].sum() < 1e-3 * end.pressure.sum()
    middle = r < 1.01 * study.grid.cell
    assert end.pressure[middle].mean() == pytest.approx(pressure[middle].mean(), rel=5e-3 * off)
    within = r < 0.8 * stick
    np.testing.assert_allclose(end.pressure[within], pressure[within], rtol=1.5e-2 * off)
    both = end.wear_counter + end.wear_disc
    assert both.sum() == pytest.approx(wear.sum(), rel=5e-2 * off)


def test_the_border_to_gross_slip() -> None:
    """A drive of Mindlin's displacement: an energy ratio of 1/5, and gross slip a little beyond."""
    once: dict[str, Any] = {"sliding__stroke_of": "body", "sliding__cycles": 1, "stepping__increment": "1 mm"}
    rows = {}
    for factor in (0.5, 1.0, 1.25, 4.0):
        study = sheared(128, sliding__stroke=f"{2.0 * factor * BORDER!r} mm", **once)
        rows[factor] = {name: values[-1] for name, values in warpwear.run(study).history.items()}
        assert rows[factor]["displacement"] == pytest.approx(factor * BORDER, rel=1e-3)
    assert rows[1.0]["energy_ratio"] == pytest.approx(0.2, abs=5e-4)
    for factor in (1.25, 4.0):
        assert rows[factor]["stick_area"] == 0.0
        assert rows[factor]["tangential_force"] == pytest.approx(12.0, rel=1e-9)
        assert rows[factor]["energy_ratio"] == pytest.approx(1.0 - 0.8 / factor, abs=2e-3)
    force = rows[0.5]["tangential_force"]
    assert force == pytest.approx(12.0 * (1.0 - 0.5**1.5), rel=1e-3)
    assert rows[0.5]["energy"] == pytest.approx(energy_of_cycle(force / 12.0), rel=5e-3)


def test_a_rig_yields_beside_the_bodies() -> None:
    """Its compliance times the force, and the rest, are what the drive moves."""
    study = sheared(
        64,
        sliding__stroke="2.4 um",
        sliding__stroke_of="body",
        sliding__rig_compliance="0.1 um/N",
        sliding__cycles=1,
        stepping__increment="1 mm",
    )
    row = {name: values[-1] for name, values in warpwear.run(study).history.items()}
    assert row["displacement"] + 1e-4 * row["tangential_force"] == pytest.approx(1.2e-3, rel=1e-9)
    again = BORDER * (1.0 - (1.0 - row["tangential_force"] / 12.0) ** (2 / 3))
    assert row["displacement"] == pytest.approx(again, rel=2e-3)


@pytest.mark.parametrize(("factor", "regime"), [(0.95, "partial"), (1.02, "mixed"), (1.3, "gross")])
def test_a_drive_near_the_border(factor: float, regime: str) -> None:
    """The middle slips least: near the border it takes load from the worn edge until it sticks for good.

    Well beyond the border all of the contact wears, conforms, and yields less before it slips.
    """
    study = sheared(
        96,
        over=8.0,
        sliding__stroke=f"{2.0 * factor * BORDER!r} mm",
        sliding__stroke_of="body",
        wear__counter="1e-4 mm^3/N/m",
        wear__disc="1e-4 mm^3/N/m",
        sliding__cycles=20_000,
    )
    result = warpwear.run(study)
    history = result.history
    energy = np.cumsum(history["energy"] * history["cycles"])
    np.testing.assert_allclose(history["wear_volume_disc"], 1e-7 / FRICTION * energy, rtol=1e-12)
    sticks = history["stick_area"] > 0.0
    assert (sticks[0], sticks[-1]) == {
        "partial": (True, True),
        "mixed": (False, True),
        "gross": (False, False),
    }[regime]
    grows = history["displacement_border"][-1] / BORDER
    assert grows < 0.5 if regime == "gross" else grows > 1.5
    assert (history["tangential_force"][-1] < 9.0) == (regime != "gross")


def test_threads_and_resuming_change_no_bit(tmp_path: Any) -> None:
    drives: list[dict[str, Any]] = [{}, {"sliding__stroke": "1.6 um", "sliding__stroke_of": "body"}]
    for drive in drives:
        study = sheared(64, **drive, output__snapshots=["1 mm"], sliding__cycles=2000)
        first, second = (warpwear.run(study, threads=threads) for threads in (1, 2))
        folder = tmp_path / f"run-{len(drive)}"

        def stop(step: Any) -> None:
            if step.index == 20:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            warpwear.run(study, out=folder, plots=False, callback=stop)
        resumed = warpwear.run(study, out=folder, plots=False, resume=True)
        for other in (second, resumed):
            for name, values in first.history.items():
                np.testing.assert_array_equal(values, other.history[name], err_msg=name)
            for field, values in first.snapshots[-1].fields.items():
                np.testing.assert_array_equal(values, other.snapshots[-1].fields[field])


def test_loops_have_the_energy_that_they_are_drawn_by() -> None:
    for ratio in (0.3, 0.6, 0.99):
        displacement = BORDER * (1.0 - (1.0 - ratio) ** (2 / 3))
        energy = energy_of_cycle(ratio) / (4.0 * 12.0 * ratio * displacement)
        assert energy_ratio(2 / 3, ratio) == pytest.approx(energy, rel=1e-9)
        assert power_of(energy, ratio) == pytest.approx(2 / 3, rel=1e-6)
    assert energy_ratio(2 / 3, 1.0, 3.0) == pytest.approx(1.0 - 0.8 / 4.0)
    assert power_of(0.0) == 1.0


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"sliding__force": "12 N"}, r"force = 12 N is not less than .* = 12 N"),
        ({"sliding__stroke": "50 um", "sliding__force": "7 N"}, "exclude each other"),
        (
            {"sliding__force": "7 N", "sliding__kinematics": "swept"},
            r"allowed is .*kinematics = 'fretting'\.$",
        ),
        ({"sliding__force": "7 N", "counter__shape": "pin"}, "a ball"),
        ({"sliding__force": "7 N", "sliding__positions": "cells"}, "sliding.positions"),
        ({"sliding__stroke": "2 um", "sliding__stroke_of": "body", "contact__boundary": "line"}, "line"),
    ],
)
def test_what_is_refused(changes: dict[str, Any], told: str) -> None:
    base: dict[str, Any] = {"sliding__stroke": None, "sliding__kinematics": None}
    with pytest.raises(InputError, match=told):
        study_of(**(base | changes))


def test_a_study_of_a_force_reads_back() -> None:
    study = sheared(64)
    assert Study.stored(study.to_toml()) == study
    assert "stroke =" not in study.to_toml()
    assert study.sliding.total == pytest.approx(1e5 * 4.0 * BORDER * (1.0 - 0.4 ** (2 / 3)), rel=1e-9)


def test_finer_jumps_change_little() -> None:
    """While the ring gives up its load, where most is off."""
    worn: dict[str, Any] = {"wear__counter": "1e-5 mm^3/N/m", "wear__disc": "1e-5 mm^3/N/m", "over": 3.2}
    jumps, fine = (
        warpwear.run(sheared(64, **worn, **more)).history
        for more in ({}, {"stepping__growth": 10.0 ** (1.0 / 190.0)})
    )
    assert fine["cycles"].size > 3 * jumps["cycles"].size
    for name in ("wear_volume_disc", "wear_depth_disc"):
        assert jumps[name][-1] == pytest.approx(fine[name][-1], rel=6e-3)
