"""Wear by the energy of friction, and Coulomb's law: the same as Archard's with K = α μ, and refusals."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import warpwear
from warpwear import InputError, Result, Study
from warpwear.calibration.energy import calibrate_energy
from warpwear.inference.unknowns import unknowns_of
from warpwear.page.content import words_of
from warpwear.results.file import MAGIC
from warpwear.results.seal import sealing
from warpwear.results.summary import summarise

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
    told = json.loads(calibrate_energy(result=tmp_path / "run", as_json=True))
    assert told["energy_J"] == pytest.approx(energy[-1], rel=1e-12)
    assert told["wear_mm3_per_J"]["disc"] == pytest.approx(history["wear_volume_disc"][-1] / energy[-1])
    step = next(iter(warpwear.steps(study)))
    assert np.isnan(step.row["cof"])
    assert np.isnan(step.row["friction_energy"])
    assert next(iter(warpwear.steps(study.replace(COULOMB)))).row["cof"] == 0.37
    static = warpwear.run(study.replace({"sliding.distance": "0 mm"}))
    assert "friction_energy_J" not in static.summary


def test_a_result_of_before_has_no_energy(tmp_path: Path) -> None:
    study = Study.load("v1").replace(SMOOTH)
    warpwear.run(study, out=tmp_path / "run", plots=False).close()
    path = tmp_path / "run" / "result.h5"
    with h5py.File(path, "r+") as file:
        del file["history/friction_energy"]
    with sealing(path, MAGIC):
        pass
    with Result.open(tmp_path / "run") as result:
        assert "friction_energy" not in result.history
        assert "friction energy" not in words_of(study, summarise(result))["summary"]


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        (ENERGY | {"friction.law": "shear-strength"}, "wear.law = 'energy' needs friction.law = 'coulomb'"),
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
        measured={"volume_disc": f"{volume!r} +- {0.02 * volume!r} mm^3", "cof": "0.4 +- 0.008"},
    )
    alpha, mu = found.values["wear.disc"], found.values["friction.coefficient"]
    assert mu.mean() == pytest.approx(0.4, abs=0.001)
    assert alpha.mean() == pytest.approx(4e-3, rel=0.003)
    assert alpha.std() / alpha.mean() == pytest.approx(np.hypot(0.02, 0.02), rel=0.1)
    with pytest.raises(InputError, match=r"the unit mm.3/N/m: it does not go with the study's wear.law"):
        unknowns_of(study, {"wear.disc": "log-uniform 1e-3 .. 1e-2 mm^3/N/m"})
