"""A law of a study is a function of arrays: K of a cell, and its shear stress, against closed forms."""

from typing import Any

import numpy as np
import pytest

import warpwear

PRESSURE, DISTANCE = np.array([[0.5], [90.0], [400.0]]), np.array([0.0, 7.0, 300.0])
UNIT = 1e-3  # mm²/N of 1 mm³/(N·m)


def study(**changes: Any) -> warpwear.Study:
    own: dict[str, Any] = {"wear.counter": "1e-4 mm^3/N/m", "wear.disc": "8e-4 mm^3/N/m"}
    if "friction__law" not in changes:
        own |= {"friction.law": "coulomb", "friction.coefficient": 0.4}
    return warpwear.Study.load("v3-fine").replace(own | {k.replace("__", "."): v for k, v in changes.items()})


CASES: dict[str, tuple[dict[str, Any], Any]] = {
    "archard": ({}, 8e-4),
    "bearing-curve": ({"study__model": "macro"}, 8e-4),
    "exponential": ({"wear__decay": "0.02 1/mm"}, 8e-4 * np.exp(-0.02 * DISTANCE)),
    "running-in": (
        {"wear__running_in": "40 mm", "wear__initial_disc": "3e-3 mm^3/N/m"},
        8e-4 + (3e-3 - 8e-4) * np.exp(-DISTANCE / 40.0),
    ),
    "transition": (
        {
            "wear__severe_counter": "1e-4 mm^3/N/m",
            "wear__severe_disc": "4e-3 mm^3/N/m",
            "wear__transition_pressure": "100 MPa",
            "wear__transition_width": "40 MPa",
        },
        np.array([[8e-4], [8e-4 + 3.2e-3 / 4.0], [4e-3]]),
    ),
}


@pytest.mark.parametrize("law", CASES)
def test_a_wear_law_is_k_of_pressure_and_distance(law: str) -> None:
    changes, expected = CASES[law]
    counter, disc = study(wear__law=law, **changes).wear_laws
    found = disc(pressure=PRESSURE, distance=DISTANCE)
    assert found.shape == (3, 3)
    np.testing.assert_allclose(found, np.broadcast_to(UNIT * expected, (3, 3)), rtol=1e-12)
    slid = 1e-4  # what a run wears over a short way is the same law
    worn = [disc.wear_per_pressure(float(start), slid) / slid for start in DISTANCE]
    if law != "transition":
        np.testing.assert_allclose(found[0], worn, rtol=1e-5)
    assert counter(distance=0.0) == pytest.approx(UNIT * 1e-4)


def test_wear_by_the_energy_of_friction() -> None:
    """α μ by Coulomb's law; with a shear strength α (μ_p + τ/p)."""
    energy = {"wear__law": "energy", "wear__counter": "1e-4 mm^3/J", "wear__disc": "2e-4 mm^3/J"}
    disc = study(**energy, friction__coefficient=0.4).wear_laws[1]
    np.testing.assert_allclose(disc(pressure=PRESSURE), UNIT * 2e-4 * 0.4 * np.ones((3, 1)))
    own = {"friction__law": "shear-strength", "friction__shear_strength": "5 MPa", "friction__ploughing": 0.1}
    own |= {"friction__initial_ratio": 3.0, "friction__running_in": "20 mm"}
    disc = study(**energy, **own).wear_laws[1]
    tau = 5.0 * (1.0 + 2.0 * np.exp(-DISTANCE / 20.0))
    found = disc(pressure=PRESSURE, distance=DISTANCE)
    np.testing.assert_allclose(found, UNIT * 2e-4 * (0.1 + tau / PRESSURE), rtol=1e-12)


def test_a_friction_law_is_a_shear_stress() -> None:
    pressure = np.array([0.0, 2.0, 40.0])
    assert study(friction__coefficient=0.4).friction_law(pressure=pressure).tolist() == [0.0, 0.8, 16.0]
    own = {"friction__law": "shear-strength", "friction__shear_strength": "5 MPa", "friction__ploughing": 0.1}
    law = study(**own).friction_law
    np.testing.assert_allclose(law(pressure=pressure), [0.0, 5.2, 9.0])
    least = study(**own, friction__largest_coefficient=0.5).friction_law
    np.testing.assert_allclose(least(pressure=pressure), [0.0, 1.2, 9.0])
    runs_in = study(**own, friction__initial_ratio=3.0, friction__running_in="20 mm").friction_law
    tau = 5.0 * (1.0 + 2.0 * np.exp(-DISTANCE / 20.0))
    np.testing.assert_allclose(runs_in(pressure=PRESSURE, distance=DISTANCE), 0.1 * PRESSURE + tau)
    film = {"friction__film": {"thickness": "0.1 um", "shear_strength": "1 MPa"}}
    filmed = study(**own, **film).friction_law
    np.testing.assert_allclose(filmed(pressure=40.0, bare_fraction=np.array([1.0, 0.25])), [9.0, 6.0])
    with pytest.raises(warpwear.InputError, match=r"friction\.shear_strength is not given"):
        study(friction__law="shear-strength", friction__coefficient=0.4).friction_law(pressure=pressure)


def test_the_shear_stress_adds_up_to_the_friction_of_a_run() -> None:
    own = {"friction__law": "shear-strength", "friction__shear_strength": "5 MPa", "friction__ploughing": 0.1}
    changes = {"grid__cell": "20 um", "sliding__distance": "1 mm", "friction__area": "contact"}
    result = warpwear.run(study(**own, **changes), plots=False)
    pressure = result.snapshot(-1).pressure
    stress = result.study.friction_law(pressure=pressure, distance=result.history["distance"][-1])
    cell = result.study.grid.cell**2
    assert stress.sum() * cell / result.study.contact.load == pytest.approx(result.history["cof"][-1])
