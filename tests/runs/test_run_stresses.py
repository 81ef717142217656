"""Stresses below the surface in runs: their numbers, how they are told and drawn, and what is refused."""

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import OF_STRESSES, drawn, faults_of
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Result, Study
from warpwear.errors import InputError
from warpwear.history.snapshot import Snapshot
from warpwear.history.stresses import traction_of

STEEL = {"young": "210 GPa", "poisson": 0.3}
FATIGUE = {"bending": "500 MPa", "torsion": "300 MPa", "length": "30 um"}


def study_of(**sections: Any) -> Study:
    """A steel ball that rests on a smooth steel disc and rubs: a of Hertz is 86.6 µm, p₀ 1273 MPa."""
    keys: dict[str, Any] = {
        "study": {"name": "stresses"},
        "counter": {"radius": "5 mm", **STEEL},
        "disc": {"synthetic": {"kind": "flat"}, "hardness": "6 GPa", **STEEL},
        "contact": {"load": "20 N", "law": "half-space"},
        "wear": {"counter": "1e-6 mm^3/N/m", "disc": "1e-6 mm^3/N/m"},
        "grid": {"cell": "5 um", "extent": "320 um"},
        "sliding": {"distance": "2 mm"},
        "stepping": {"scheme": "implicit"},
        "friction": {"law": "coulomb", "coefficient": 0.4},
        "output": {"stress_depths": ["0 um", "40 um", "80 um"], "snapshots": ["0.2 mm"]},
    }
    for name, values in sections.items():
        keys[name] = {**keys.get(name, {}), **values}
    return Study(**keys)


@pytest.fixture(scope="module")
def result() -> Result:
    return warpwear.run(study_of(fatigue=FATIGUE, disc={"yield_strength": "400 MPa"}))


def test_they_are_those_of_the_pressure_and_its_friction(result: Result) -> None:
    """By `warpwear.stresses`, of a snapshot: largest values, places, shares, and the plane y = 0."""
    table, grid = result.stresses, result.study.cells
    assert {values.shape[:2] for values in table.values()} == {(2, 3)}
    assert set(table) <= set(result.units)
    for number, snapshot in enumerate(result.snapshots):
        states = [
            warpwear.stresses(
                snapshot.pressure,
                [0.0, 0.04, 0.08],
                cell=grid.cell,
                boundary="free",
                poisson=0.3,
                traction=(sign * 0.4 * snapshot.pressure, None),
            )
            for sign in (1.0, -1.0)
        ]
        cycle = states[0].cycle(states[1], bending=500.0, torsion=300.0, length=0.03)
        fields = {"mises": states[0].mises, "max_shear": states[0].shear, "principal": states[0].principal}
        fields |= {"crossland": cycle.crossland, "dang_van": cycle.dang_van}
        assert_allclose(table["depth"][number], states[0].depths)
        assert_allclose(table["yielding"][number], states[0].yielding(400.0).shares)
        for name, field in fields.items():
            assert_allclose(table[name][number], field.max(axis=(1, 2)), rtol=1e-9)
            assert_allclose(table[f"{name}_plane"][number], states[0].plane(field, "y"), atol=1e-7)
            for depth in range(3):
                place = [table[f"{name}_{axis}"][number, depth] for axis in "xy"]
                i, j = (int(np.abs(a - p).argmin()) for a, p in zip((grid.x, grid.y), place, strict=True))
                assert field[depth, i, j] == pytest.approx(field[depth].max(), rel=1e-9)


def test_the_summary_tells_them(result: Result) -> None:
    told = result.summary["stress_below_disc"]
    table = result.stresses
    assert told["mises"]["value_MPa"] == table["mises"][-1].max()
    assert told["crossland"]["z_mm"] == table["depth"][-1][table["crossland"][-1].argmax()]
    assert told["beyond_yield"]["yield_strength_MPa"] == 400.0
    assert 0.04 < told["beyond_yield"]["depth_mm"] <= 0.08
    shares = np.trapezoid(table["yielding"][-1], table["depth"][-1])
    assert told["beyond_yield"]["volume_mm3"] == pytest.approx(shares * 0.32**2)


def test_a_third_of_the_hardness_yields_where_nothing_is_given() -> None:
    assert study_of().pair.yield_strength == 2000.0
    assert study_of(disc={"hardness": None}, contact={"hardness": "3 GPa"}).pair.yield_strength == 1000.0
    assert study_of(disc={"hardness": None}, contact={"hardness": "inf MPa"}).pair.yield_strength is None


def test_depths_of_themselves() -> None:
    depths = study_of(output={"stress_depths": "auto"}).stress_depths
    assert len(depths) == 21
    assert depths[:2] == (0.0, 0.005)
    assert depths[-1] == pytest.approx(0.16)
    assert study_of(output={"stress_depths": None}).stress_depths == ()


def test_traction_by_each_law() -> None:
    pressure = np.array([[0.0, 100.0], [300.0, 0.0]])
    snapshot = Snapshot(1.0, pressure, *np.zeros((3, 2, 2)))
    assert_allclose(traction_of(study_of(), snapshot, {"cof": 0.4}), 0.4 * pressure)
    law = {"law": "shear-strength", "ploughing": 0.1}
    sheared = traction_of(study_of(friction=law), snapshot, {"cof": 0.4})
    assert_allclose(sheared, 0.1 * pressure + 60.0 * (pressure > 0.0))
    assert_array_equal(traction_of(study_of(), snapshot, {"cof": math.nan}), 0.0)


def test_traction_of_partial_slip() -> None:
    """Cattaneo and Mindlin: q = μ p₀ (√(1 − r²) − c √(1 − r²/c²)), with c = (1 − Q/μP)^⅓ of a that sticks."""
    drive = {"kinematics": None, "distance": None, "force": "4.8 N", "cycles": 1}
    cells = {"cell": f"{2.6 * 86.62 / 96:.6f} um", "extent": f"{2.6 * 86.62:.4f} um"}
    study = study_of(
        sliding=drive, grid=cells, stepping={"increment": "1 mm"}, disc={"yield_strength": "1 GPa"}
    )
    result = warpwear.run(study)
    row = {name: float(column[-1]) for name, column in result.history.items()}
    traction = traction_of(study, result.snapshots[-1], row)
    assert traction.sum() * study.cells.cell_area == pytest.approx(4.8, rel=1e-6)
    assert (traction <= 0.4 * result.snapshots[-1].pressure).all()
    r, stick = np.hypot(result.x[:, np.newaxis], result.y) / 0.08662, 0.4 ** (1.0 / 3.0)
    part = stick * np.sqrt(np.maximum(1.0 - (r / stick) ** 2, 0.0))
    exact = np.sqrt(np.maximum(1.0 - r**2, 0.0)) - part
    error = traction / (0.4 * 1273.0) - exact
    assert np.abs(error).max() < 0.035  # at the rings, where it falls as the root of the cell
    assert math.sqrt((error**2).mean()) < 0.004


def test_threads_and_a_folder_change_no_bit(tmp_path: Path) -> None:
    results = [
        warpwear.run(study_of(fatigue=FATIGUE), out=out, plots=False, threads=threads).stresses
        for out, threads in ((None, 1), (tmp_path / "run", 2))
    ]
    for name, values in results[0].items():
        assert_array_equal(values, results[1][name])


def test_a_run_that_was_stopped_ends_as_one_left_alone(tmp_path: Path) -> None:
    def stop(step: Any) -> None:
        if step.row["distance"] > 0.5:
            raise KeyboardInterrupt

    study, out = study_of(fatigue=FATIGUE), tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        warpwear.run(study, out=out, plots=False, callback=stop)
    with Result.open(out) as stopped:
        assert stopped.stresses["mises"].shape == (1, 3)
    whole, resumed = warpwear.run(study), warpwear.run(study, out=out, plots=False, resume=True)
    for name, values in whole.stresses.items():
        assert_array_equal(values, resumed.stresses[name])


def test_periodic_and_line_contacts(quick_pictures: Callable[..., AbstractContextManager[None]]) -> None:
    rough = {
        "kind": "self-affine",
        "sq": "0.2 um",
        "period": "320 um",
        "cut_off": "40 um",
        "roll_off": "200 um",
    }
    periodic = warpwear.run(
        study_of(counter={"radius": "inf mm"}, disc={"synthetic": rough}, output={"stress_plane": "x = 0"})
    )
    assert periodic.study.boundary == "periodic"
    assert periodic.stresses["mises_plane"].shape == (2, 3, 64)
    line = warpwear.run(
        study_of(
            counter={"shape": "cylinder"},
            contact={"load": "30 N/mm", "boundary": "line"},
            grid={"extent": ["320 um", "20 um"]},
        )
    )
    p0 = float(line.snapshots[0].pressure.max())
    assert 0.5 < float(line.stresses["mises"][0].max()) / p0 < 1.0
    for run in (periodic, line):
        figure, renderer = drawn(run, "stress_map")
        assert not faults_of("stress_map", figure, renderer)


@pytest.mark.parametrize("name", sorted(OF_STRESSES))
def test_figures_are_fit_to_print(result: Result, name: str) -> None:
    figure, renderer = drawn(result, name)
    assert not faults_of(name, figure, renderer)
    assert "below the disc" in result.plot.caption(name)


def test_a_run_without_them() -> None:
    plain = warpwear.run(study_of(output={"stress_depths": None}))
    with pytest.raises(InputError, match=r"has no stresses: output\.stress_depths is not given"):
        _ = plain.stresses
    assert "stress_below_disc" not in plain.summary
    assert "output.stress_depths" in str(plain.plot.reason("stress_map"))


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "local": ({"contact": {"law": "local"}}, r"output\.stress_depths .* needs contact\.law = 'half-space'"),
    "falling": (
        {"output": {"stress_depths": ["2 um", "1 um"]}},
        r"needs depths that rise, not 0\.002, 0\.001",
    ),
    "none": ({"output": {"stress_depths": []}}, "has no depth; leave it out for no stresses"),
    "no depths": (
        {"output": {"stress_depths": None}, "fatigue": FATIGUE},
        r"\[fatigue\] needs output.stress_",
    ),
    "ratio": (
        {"fatigue": {**FATIGUE, "torsion": "200 MPa"}},
        r"torsion = 200 MPa is 0\.4 of fatigue\.bending",
    ),
    "long": (
        {"fatigue": {**FATIGUE, "length": "1 mm"}},
        r"length = 1000 µm is longer than the domain, 320 µm",
    ),
    "swept": (
        {
            "fatigue": FATIGUE,
            "sliding": {"kinematics": "swept", "distance": None, "stroke": "1 mm", "cycles": 1},
        },
        r"\[fatigue\] needs a contact that stays where it is, by sliding\.kinematics = 'stationary' or",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_computed_is_refused(case: str) -> None:
    sections, words = REFUSED[case]
    with pytest.raises(InputError, match=words):
        study_of(**sections)
