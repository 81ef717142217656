"""Wear by the energy of friction, and Coulomb's law: the same as Archard's with K = α μ, and refusals."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs.stopped.cases_stopped import run_stopped

import warpwear
from warpwear import InputError, Study
from warpwear.calibration.bayes.unknowns import unknowns_of
from warpwear.calibration.energy import calibrate_energy
from warpwear.laws import friction

COULOMB = {"friction.law": "coulomb", "friction.coefficient": 0.37}
#: Wear per energy of counter-body and disc [mm³/J].
ALPHA = (2e-3, 3e-3)
ENERGY = COULOMB | {
    "wear.law": "energy",
    "wear.counter": f"{ALPHA[0]!r} mm^3/J",
    "wear.disc": f"{ALPHA[1]!r} mm³/J",
}
ARCHARD = COULOMB | {
    "wear.counter": f"{ALPHA[0] * 0.37!r} mm^3/N/m",
    "wear.disc": f"{ALPHA[1] * 0.37!r} mm^3/N/m",
}
SMOOTH = {"grid.cell": "20 um", "sliding.distance": "60 mm", "output.snapshots": []}
SMOOTH |= {"stepping.scheme": "implicit", "stepping.increment": "0.5 mm"}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "smooth": ("v1", SMOOTH),
    "rough": ("v3-fine", {"grid.cell": "10 um", "sliding.distance": "6 mm", "output.snapshots": []}),
    "track": (
        "track",
        {
            "grid.cell": "20 um",
            "sliding.distance": "3 mm",
            "sliding.stroke": "0.9 mm",
            "sliding.track": "full",
        }
        | {"sliding.shift": 3, "grid.extent": "0.62 mm", "output.snapshots": []},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_energy_with_coulomb_is_archard(case: str, device: str) -> None:
    """To the last bit, with every step; and volumes are α times the energy."""
    preset, keys = CASES[case]
    study = Study.load(preset).replace(keys)
    by_energy, by_load = (warpwear.run(study.replace(law), device=device) for law in (ENERGY, ARCHARD))
    for name, values in by_energy.history.items():
        np.testing.assert_array_equal(values, by_load.history[name], err_msg=name)
    history = by_energy.history
    expected = np.full(history["cof"].size, 0.37)
    np.testing.assert_array_equal(history["cof"], expected)
    force = 0.37e-3 * study.contact.load  # [J/mm]
    np.testing.assert_allclose(history["friction_energy"], force * history["distance"], rtol=1e-12)
    for alpha, body in zip(ALPHA, ("counter", "disc"), strict=True):
        worn = history[f"wear_volume_{body}"]
        np.testing.assert_allclose(worn, alpha * history["friction_energy"], rtol=1e-12)


def test_the_energy_of_a_rising_coefficient(tmp_path: Path) -> None:
    """By trapezoids, as the calibration has it; in the summary; and not known before the end."""
    study = Study.load("v1").replace(SMOOTH | {"friction.coefficient": 0.6})
    with warpwear.run(study, out=tmp_path / "run", plots=False) as result:
        history, summary = result.history, result.summary
    cof, distance, energy = history["cof"], history["distance"], history["friction_energy"]
    sums = np.cumsum(0.5 * (cof[1:] + cof[:-1]) * np.diff(distance)) + cof[0] * distance[0]
    np.testing.assert_allclose(energy[1:], 1e-3 * study.contact.load * sums, rtol=1e-12)
    assert cof[0] < 0.5 * cof[-1]
    assert summary["friction_energy_J"] == energy[-1]
    told = calibrate_energy(result=tmp_path / "run").numbers
    assert told["energy_J"] == pytest.approx(energy[-1], rel=1e-12)
    assert told["wear_mm3_per_J"]["disc"] == pytest.approx(history["wear_volume_disc"][-1] / energy[-1])
    step = next(iter(warpwear.steps(study)))
    assert np.isnan(step.row["cof"])
    assert np.isnan(step.row["friction_energy"])
    assert next(iter(warpwear.steps(study.replace(COULOMB)))).row["cof"] == 0.37
    static = warpwear.run(study.replace({"sliding.distance": "0 mm"}))
    assert "friction_energy_J" not in static.summary


#: Cases of wear by a shear strength: what each adds to one of `CASES`.
STRENGTH = 40.0  # [MPa]
BY_STRENGTH: dict[str, Any] = {key: value for key, value in ENERGY.items() if key.startswith("wear.")}
BY_STRENGTH |= {"friction.shear_strength": f"{STRENGTH} MPa", "output.precision": "double"}
HALF_SPACE = {"contact.law": "half-space", "counter.radius": "3 mm"}
RUNS_IN = {"friction.initial_ratio": 0.25, "friction.running_in": "1.5 mm"}
FILM = {"friction.film.thickness": "9 nm", "friction.film.shear_strength": "12 MPa"}
SHEARED: dict[str, tuple[str, dict[str, Any]]] = {
    "smooth": ("smooth", {}),
    "bearing area": ("rough", {}),
    "springs": ("rough", {"contact.stiffness": "2e5 N/mm^3"}),
    "half-space": ("rough", HALF_SPACE),
    "half-space, running in": ("rough", HALF_SPACE | RUNS_IN),
    "track": ("track", {}),
    "track, springs, dents": ("track", {"contact.stiffness": "2e5 N/mm^3", "sliding.plastic": "keep"}),
    "track, running in": ("track", RUNS_IN),
    "bearing area, film": ("rough", FILM),
    "springs, film": ("rough", {"contact.stiffness": "2e5 N/mm^3"} | FILM),
    "half-space, film that grows": ("rough", HALF_SPACE | FILM | {"friction.film.regrowth": "1 mm"}),
    "track, film": ("track", FILM),
    "track, half-space, strong film": (
        "track",
        HALF_SPACE
        | {"grid.extent": "0.8 mm", "friction.film.bodies": "disc"}
        | FILM
        | {"friction.film.shear_strength": "70 MPa"},
    ),
    "representative": ("track", {"sliding.stroke": "3 mm", "sliding.track": "0.84 mm"}),
    "track, half-space, ploughing": (
        "track",
        HALF_SPACE | {"grid.extent": "0.8 mm", "friction.ploughing": 0.1},
    ),
}


@pytest.mark.parametrize("case", SHEARED)
def test_a_shear_strength_wears_what_it_shears(case: str, device: str) -> None:
    """V = α E to rounding at every step, and the coefficient is τ0 A/F of the area that wears."""
    name, more = SHEARED[case]
    preset, keys = CASES[name]
    study = Study.load(preset).replace(keys | more | BY_STRENGTH)
    history = warpwear.run(study, device=device).history
    for alpha, body in zip(ALPHA, ("counter", "disc"), strict=True):
        worn = history[f"wear_volume_{body}"]
        np.testing.assert_allclose(worn, alpha * history["friction_energy"], rtol=1e-12)
    sheared, contact = history["area_sheared"], history["area_contact"]
    load = study.contact.load
    strength = STRENGTH
    if "running in" in case:  # the mean over each step, from a quarter
        ends = np.append(0.0, history["distance"])
        passed = ends - 0.75 * 1.5 * (1.0 - np.exp(-ends / 1.5))
        strength = STRENGTH * np.diff(passed) / history["increment"]
    np.testing.assert_allclose(history["cof"], study.friction.ploughing + strength * sheared / load)
    part = 1.0
    if "film" in case:  # the area counts as if all of it were bare
        filmed = study.friction.film.shear_strength / STRENGTH
        part = filmed + (1.0 - filmed) * history["bare_fraction"]
        assert (history["bare_fraction"] > 0.0).any()
    assert (sheared >= part * contact * (1.0 - 1e-12)).all()
    assert np.abs(history["load_residual"]).max() <= max(1e-12 * load, study.load_tolerance)


def approach_of(gap: np.ndarray, depth: Any, stiffness: float, load: float, area: float) -> float:
    """Return the approach of cells on springs, from which shear takes a depth, by bisection."""
    low, high = gap.min(), gap.max() + np.max(depth)
    for _ in range(200):
        middle = 0.5 * (low + high)
        carried = stiffness * np.maximum(middle - depth - gap, 0.0).sum() * area
        low, high = (middle, high) if carried < load else (low, middle)
    return float(0.5 * (low + high))


def worn_by_shear(gap: np.ndarray, depth: Any, stiffness: float, load: float, area: float) -> np.ndarray:
    """Return what the step of cells on springs wears off them by their shear: w in [0, d]."""
    return np.clip(approach_of(gap, depth, stiffness, load, area) - gap, 0.0, depth)


def test_springs_wear_by_shear_as_a_reference_does(device: str) -> None:
    """A ball on a smooth disc, step by step, and by steps of any length."""
    keys = CASES["rough"][1] | {"disc.synthetic.kind": "flat", "contact.stiffness": "2e4 N/mm^3"}
    keys |= {"contact.hardness": "inf MPa", "sliding.distance": "8 mm", "counter.radius": "4 mm"}
    volumes = {}
    for count in (8, 16, 32, 256):
        study = Study.load("v3-fine").replace(keys | BY_STRENGTH)
        study = study.replace({"stepping.increment": f"{8 / count} mm"})
        history = warpwear.run(study, device=device).history
        volumes[count] = history["wear_volume_disc"][-1]
        if count > 32:
            continue
        cells = study.cells
        gap = np.square(cells.x[:, None]) + np.square(cells.y)
        gap = 4.0 - np.sqrt(16.0 - gap)
        depth = 1e-3 * sum(ALPHA) * STRENGTH * 8.0 / count
        for step in range(count):
            worn = worn_by_shear(gap, depth, 2e4, study.contact.load, cells.cell_area)
            area = worn.sum() / depth * cells.cell_area
            assert history["area_sheared"][step] == pytest.approx(area, rel=1e-9)
            gap = gap + worn
    # What bears goes down by one depth and bears on as before, so that steps of any length are exact.
    np.testing.assert_allclose([*volumes.values()], volumes[256], rtol=1e-12)
    np.testing.assert_allclose(history["pressure_max"], history["pressure_max"][0], rtol=1e-9)


@pytest.mark.parametrize("filmed", [15.0, 70.0])
def test_a_film_lets_cells_wear_unalike_as_a_reference_does(filmed: float, device: str) -> None:
    """Bare cells lose their own depth, by bisection step by step; a film may be weaker or stronger."""
    keys = CASES["rough"][1] | {"contact.stiffness": "2e5 N/mm^3", "friction.ploughing": 0.3}
    keys |= {"contact.hardness": "inf MPa", "sliding.distance": "8 mm", "counter.radius": "4 mm"}
    keys |= {"friction.film.thickness": "0.1 um", "friction.film.shear_strength": f"{filmed} MPa"}
    study = Study.load("v3-fine").replace(keys | BY_STRENGTH | {"stepping.increment": "0.5 mm"})
    history, cells = warpwear.run(study, device=device).history, study.cells
    gap = np.array(warpwear.run(study.replace({"sliding.distance": "0 mm"})).snapshot(-1).gap)
    worn, unit = np.zeros((2, *gap.shape)), 1e-3 * 0.5
    for step in range(16):
        bare = (worn > 1e-4).all(axis=0)
        depth = sum(ALPHA) * unit * np.where(bare, STRENGTH, filmed)
        by_pressure = sum(ALPHA) * unit * 0.3  # ploughing wears by the pressure, which softens the contact
        stiffness = 1.0 / (1.0 / 2e5 + by_pressure)
        lost = worn_by_shear(gap, depth, stiffness, study.contact.load, cells.cell_area)
        sheared = (lost / (sum(ALPHA) * unit * STRENGTH)).sum() * cells.cell_area
        assert history["area_sheared"][step] == pytest.approx(sheared, rel=1e-9)
        approach = approach_of(gap, depth, stiffness, study.contact.load, cells.cell_area)
        lost += by_pressure * stiffness * np.maximum(approach - depth - gap, 0.0)
        gap = gap + lost
        worn += np.array(ALPHA)[:, None, None] / sum(ALPHA) * lost
    bared = history["bare_fraction"]
    assert ((bared > 0.02) & (bared < 0.98)).any()


def test_a_half_space_wears_by_shear_as_its_contact_says(device: str) -> None:
    """Each step's pressure is that of the bodies as they were; what is within the depth is worn clear."""
    keys = CASES["rough"][1] | HALF_SPACE | {"contact.hardness": "inf MPa", "stepping.increment": "2 mm"}
    study = Study.load("v3-fine").replace(keys | BY_STRENGTH)
    history = warpwear.run(study, device=device).history
    gap = np.array(warpwear.run(study.replace({"sliding.distance": "0 mm"})).snapshot(-1).gap)
    depth = 1e-3 * sum(ALPHA) * STRENGTH * 2.0
    for step in range(3):
        how = {"load": 8.0, "modulus": study.pair.effective_modulus, "boundary": "free"}
        contact = warpwear.solve_contact(-gap, cell=study.grid.cell, **how)
        rubs = np.where(contact.pressure > 0.0, 1.0, np.clip(1.0 - contact.gap / depth, 0.0, 1.0))
        area = rubs.sum() * study.cells.cell_area
        assert history["area_sheared"][step] == pytest.approx(area, rel=1e-6)
        gap = gap + depth * rubs


def test_the_rest_of_a_run_by_energy_goes_on_with_its_friction(tmp_path: Path) -> None:
    """Another strength would wear otherwise, so a run that was stopped goes on with its own alone."""
    study = Study.load("v3-fine").replace(CASES["rough"][1] | BY_STRENGTH)
    run_stopped(study, tmp_path / "run", 3)
    other = study.replace({"friction.shear_strength": "80 MPa"})
    with pytest.raises(InputError, match=r"of another study \(friction.shear_strength\)"):
        warpwear.run(other, out=tmp_path / "run", plots=False, resume=True)
    warpwear.run(study, out=tmp_path / "run", plots=False, resume=True).close()


NOT_ALIKE: list[tuple[dict[str, Any], str]] = [
    ({"stepping.scheme": "explicit"}, "stepping.scheme = 'explicit'"),
    ({"friction.area": "nominal"}, "friction.area = 'nominal'"),
    ({"wear.distance_factor": "across"}, "wear.distance_factor = 'across'"),
    ({"wear.particle": "60 um", "wear.particle_thickness": "0.1 um"}, "wear.particle = "),
]


@pytest.mark.parametrize(("keys", "sentence"), NOT_ALIKE)
def test_cells_that_do_not_lose_one_depth_are_refused(keys: dict[str, Any], sentence: str) -> None:
    told = rf"wear\.law = 'energy' does not go with {sentence}.*, unless friction\.law = 'coulomb'"
    with pytest.raises(InputError, match=told):
        Study.load("v3-fine").replace(CASES["rough"][1] | BY_STRENGTH | keys)


@pytest.mark.parametrize(
    ("keys", "beside"),
    [
        (BY_STRENGTH, "wear.law = 'energy'"),
        ({"friction.junction_growth": 9.0}, "friction.junction_growth = 9"),
    ],
)
def test_a_factor_that_only_friction_follows_is_refused(
    keys: dict[str, Any], beside: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wear and caps would else be those of another shear strength."""
    study = Study.load("v3-fine").replace(CASES["rough"][1] | {"friction.shear_strength": "4 MPa"})
    factor = friction.StrengthFactor(("ploughing",), of=lambda history, by: 1.0 + by, formula="", sentence="")
    monkeypatch.setattr(friction, "FACTORS", (friction.RUNNING_IN, factor))
    study.replace({"friction.ploughing": 0.1})
    with pytest.raises(InputError, match=f"friction.ploughing does not go with {beside}, which does not"):
        study.replace(keys | {"friction.ploughing": 0.1})


def test_patches_do_not_wear_by_a_shear_strength() -> None:
    patches = Study.load("two-scale").replace({"contact.stiffness": "2e5 N/mm^3"})
    with pytest.raises(InputError, match=r"study\.model = 'two-scale', unless friction\.law = 'coulomb'"):
        patches.replace(BY_STRENGTH)


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        (
            ENERGY | {"friction.law": "shear-strength"},
            "wear.law = 'energy' needs friction.shear_strength, a pressure",
        ),
        (
            ENERGY | {"wear.disc": "2e-6 mm^3/N/m"},
            "wear.disc = '2e-06 mm.3/N/m' does not go with wear.law = ",
        ),
        (COULOMB | {"wear.disc": "2e-6 mm^3/J"}, "wear.disc = '2e-06 mm.3/J' does not go with wear.law = "),
        (ENERGY | {"wear.counter": 1e-3}, "wear.counter = '0.001' does not go with wear.law = 'energy'"),
        (COULOMB | {"friction.shear_strength": "4 MPa"}, "exclude each other"),
        (
            {"friction.law": "coulomb", "friction.shear_strength": "4 MPa"},
            "friction.shear_strength = 4 MPa does not go with friction.law = 'coulomb'",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(keys: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as error:
        Study.load("v3-fine").replace({"friction.shear_strength": None} | keys)
    assert "\n" not in str(error.value)


def test_a_body_that_does_not_wear_needs_no_unit_of_energy() -> None:
    study = Study.load("v3-fine").replace(ENERGY | {"wear.counter": 0})
    assert study.wear_coefficients == (0.0, 1e-3 * (ALPHA[1] * 0.37))


def test_unused_keys_of_friction_are_told() -> None:
    study = Study.load("v1").replace(COULOMB | {"friction.ploughing": 0.1, "friction.area": "nominal"})
    (notice,) = study.notices()
    assert notice == "friction.ploughing, friction.area do not apply to friction.law = 'coulomb'."


def test_a_wear_of_energy_is_inferred(tmp_path: Path) -> None:
    """From a volume and a coefficient with small errors follows α = V/(μ F L), with both errors."""
    study = Study.load("v1").replace(SMOOTH | ENERGY)
    work = 0.4 * study.contact.load * 1e-3 * study.sliding.total
    unknown = {
        "wear.disc": "log-uniform 1e-3 .. 1e-2 mm^3/J",
        "friction.coefficient": "uniform 0.2 .. 0.6",
    }
    volume = 4e-3 * work
    found = warpwear.infer(
        study,
        unknown=unknown,
        tests=[{"volume_disc": f"{volume!r} +- {0.02 * volume!r} mm^3", "friction": "0.4 +- 0.008"}],
    )
    alpha, mu = found.values["wear.disc"], found.values["friction.coefficient"]
    assert mu.mean() == pytest.approx(0.4, abs=0.001)
    assert alpha.mean() == pytest.approx(4e-3, rel=0.003)
    assert alpha.std() / alpha.mean() == pytest.approx(np.hypot(0.02, 0.02), rel=0.1)
    with pytest.raises(InputError, match=r"the unit mm.3/N/m: it does not go with the study's wear.law"):
        unknowns_of(study, {"wear.disc": "log-uniform 1e-3 .. 1e-2 mm^3/N/m"})
