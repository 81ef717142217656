"""Coefficient of friction: each area, each way of fixing the shear strength."""

import math

import numpy as np
import pytest

from warpwear.study.sections.friction import Friction

HISTORY = {
    "distance": np.array([1.0, 50.0, 100.0]),
    "area_contact": np.array([0.01, 0.5, 1.25]),
    "area_touched": np.array([0.01, 0.6, 1.3]),
    "area_cumulative": np.array([0.01, 0.51, 1.76]),
    "area_nominal": np.array([0.1, 0.7, 1.4]),
}
LOAD = 8.0


def cof(given: Friction, *, finished: bool = True) -> np.ndarray:
    return given.law_with().coefficient(HISTORY, load=LOAD, finished=finished)


def test_a_given_strength() -> None:
    # Thesis eq 4.18
    assert cof(Friction(shear_strength="4 MPa")) == pytest.approx([0.005, 0.25, 0.625])
    assert cof(Friction(shear_strength="4 MPa", ploughing=0.1)) == pytest.approx([0.105, 0.35, 0.725])


@pytest.mark.parametrize("area", ["contact", "touched", "cumulative", "nominal"])
def test_calibrated_at_the_end_and_at_the_start(area: str) -> None:
    # Thesis eq 4.19
    at_end = cof(Friction(coefficient=0.6, calibrate="end", area=area, ploughing=0.1))
    assert at_end[-1] == pytest.approx(0.6)
    areas = HISTORY[f"area_{area}"]
    assert at_end - 0.1 == pytest.approx(0.5 * areas / areas[-1])
    at_start = cof(Friction(coefficient=0.6, calibrate="initial", area=area))
    assert at_start == pytest.approx(0.6 * areas / areas[0])


def test_a_coefficient_that_waits_for_the_end_is_not_a_number_before() -> None:
    waiting = Friction(coefficient=0.6, calibrate="end")
    assert np.isnan(cof(waiting, finished=False)).all()
    assert np.isfinite(cof(Friction(coefficient=0.6, calibrate="initial"), finished=False)).all()


def test_every_calibration_is_told() -> None:
    told = Friction(coefficient=0.6).law_with().calibrations(HISTORY, load=LOAD, hardness=590.0)
    assert told["contact_end"] == pytest.approx(0.6 * 8.0 / 1.25)
    assert told["contact_initial"] == pytest.approx(0.6 * 8.0 / 0.01)
    assert told["hardness"] == pytest.approx(590.0 / (3.0 * math.sqrt(3.0)))
    assert len(told) == 9


def test_a_shear_strength_that_runs_in() -> None:
    # τ0 (1 + (r − 1) e^(−L/L_τ)); a measured coefficient holds where it was measured.
    given = {"initial_ratio": 3.0, "running_in": "20 mm"}
    ratio = 1.0 + 2.0 * np.exp(-HISTORY["distance"] / 20.0)
    fixed = cof(Friction(shear_strength="4 MPa", **given))
    assert fixed == pytest.approx(4.0 * ratio * HISTORY["area_contact"] / LOAD, rel=1e-14)
    assert cof(Friction(coefficient=0.6, **given))[-1] == pytest.approx(0.6)
    assert cof(Friction(coefficient=0.6, calibrate="initial", **given))[0] == pytest.approx(0.6)


@pytest.mark.parametrize("when", ["initial", "end"])
def test_a_calibration_that_is_told_is_the_strength_that_a_run_takes(when: str) -> None:
    # It once left the running-in out: 480 MPa, where the run took 165.4.
    section = {"coefficient": 0.6, "calibrate": when, "initial_ratio": 3.0, "running_in": "20 mm"}
    law = Friction(**section).law_with()
    taken = law.final_strength(HISTORY, load=LOAD, finished=True)
    told = law.calibrations(HISTORY, load=LOAD, hardness=590.0)
    assert told[f"contact_{when}"] == taken
    if when == "initial":
        assert taken == pytest.approx(480.0 / (1.0 + 2.0 * math.exp(-0.05)))
        assert taken == pytest.approx(165.4, abs=0.1)
