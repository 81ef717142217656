"""Friction of three states: its closed form and quadrature beside an ODE solver, and what it goes with."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import warpwear
from warpwear import InputError, Study
from warpwear.laws.states import shares, wait_and_width

STATES = {"film": 0.15, "slope": 1e-3, "metal": 1.03, "cover": 0.47, "spread": 0.2, "seed": 2e-5}
STATES |= {"cover_rate": 0.1}


def study(preset: str = "v3-fine", **changes: Any) -> Study:
    """A study by the law, per mm, with changes of its keys."""
    states: dict[str, Any] = {f"friction.states.{key}": value for key, value in STATES.items()}
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    return Study.load(preset).replace({"friction.law": "states", "friction.states.per": "mm"} | states | keys)


@pytest.mark.parametrize(
    ("spread", "seed", "cover_rate"),
    [
        (0.18, 6e-5, 0.1),
        (0.2, 2e-8, 0.067),
        (0.18, 1e-4, 5.0),
        (0.3, 0.3, 0.05),
        (0.1, 0.5, 1e-3),
        (1.0, 1e-10, 30.0),
        (0.02, 1e-5, 0.5),
    ],
)
def test_the_shares_are_those_of_an_ode_solver(spread: float, seed: float, cover_rate: float) -> None:
    count = np.linspace(0.0, 500.0, 126)

    def rates(_: float, state: np.ndarray) -> list[float]:
        b, c = state
        return [(1.0 - b) * (seed + spread * b), cover_rate * (b - c)]

    how: Any = {"method": "LSODA", "rtol": 1e-12, "atol": 1e-20, "t_eval": count}
    bare, covered = solve_ivp(rates, (0.0, 500.0), [0.0, 0.0], **how).y
    middle = math.log(spread / seed)
    own = shares(count, rate=spread + seed, middle=middle, cover_rate=cover_rate)
    assert np.abs(1.0 - own.filmed - bare).max() < 1e-8
    assert np.abs(own.covered - covered).max() < 1e-8
    wait, width = wait_and_width(rate=spread + seed, middle=middle)
    places = np.array([wait, wait]) + 0.5 * np.array([-1e-9, 1e-9])
    assert 1.0 - shares(places, rate=spread + seed, middle=middle, cover_rate=0.1).filmed == pytest.approx(
        0.5
    )
    tenth, ninth = (math.log((1.0 + part * spread / seed) / (1.0 - part)) for part in (0.1, 0.9))
    assert width == pytest.approx((ninth - tenth) / (spread + seed))


def test_a_seed_too_small_for_a_number() -> None:
    """e = r e^(−2000): half is bare after 2000/r, and nothing overflows."""
    with np.errstate(all="raise", under="ignore"):
        own = shares(np.array([0.0, 1999.0, 2000.0, 2001.0, 9e9]), rate=1.0, middle=2000.0, cover_rate=0.1)
    assert own.filmed == pytest.approx([1.0, 1.0 / (1.0 + math.exp(-1.0)), 0.5, 1.0 / (1.0 + math.e), 0.0])


def test_a_law_of_arrays() -> None:
    """Samples of the constants, (samples, 1), are as each by itself."""
    count, rate = np.linspace(0.5, 159.5, 40), np.array([[0.15], [0.25]])
    both = shares(count, rate=rate, middle=8.0, cover_rate=np.array([[0.05], [0.2]]))
    for row, (r, k) in enumerate(((0.15, 0.05), (0.25, 0.2))):
        one = shares(count, rate=r, middle=8.0, cover_rate=k)
        assert all(np.array_equal(a[row], b) for a, b in zip(both, one, strict=True))


def test_laps_are_of_a_circle_or_of_two_strokes() -> None:
    own = study("track", friction__states__per="lap")
    assert own.cycle == 2.0 * own.sliding.stroke
    stress = own.friction_law(pressure=[1.0, 2.0], distance=45.0 * own.cycle)
    per_mm = study(
        "track", **{f"friction__states__{k}": v / own.cycle for k, v in STATES.items() if k in RATES}
    )
    assert stress == pytest.approx(per_mm.friction_law(pressure=[1.0, 2.0], distance=45.0 * own.cycle))


RATES = ("slope", "spread", "seed", "cover_rate")
LAYER = [{"name": "dlc", "thickness": "1 um", "wear": "1e-6 mm^3/N/m", "shear_strength": "5 MPa"}]
FILM = {"friction__film__thickness": "5 nm", "friction__film__shear_strength": "5 MPa"}
ENERGY = {"wear__law": "energy", "wear__counter": "1e-5 mm^3/J", "wear__disc": "1e-5 mm^3/J"}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (FILM, "[friction.film] does not go with friction.law = 'states', whose coefficient follows no"),
        ({"friction__junction_growth": 9.0}, "friction.junction_growth = 9 does not go with friction.law"),
        ({"disc__layers": LAYER}, "friction.law = 'states' needs layers without a shear_strength or"),
        (ENERGY, "wear.law = 'energy' does not go with friction.law = 'states', whose coefficient changes"),
        ({"friction__states__per": "lap"}, "friction.states.per = 'lap' needs laps, all of one length"),
        ({"friction__states__seed": 0.0}, "friction.states.seed = 0.0: must be greater than 0"),
    ],
)
def test_what_it_does_not_go_with(changes: dict[str, Any], sentence: str) -> None:
    without = {"sliding__stroke": None, "sliding__distance": "60 mm", "sliding__passes": None}
    keys = without | changes if "friction__states__per" in changes else changes
    with pytest.raises(InputError) as error:
        study(**keys)
    assert str(error.value).startswith(sentence)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("beside", [{"coefficient": 0.5}, {"shear_strength": "5 MPa"}, {"calibrate": "end"}])
def test_what_fixes_friction_otherwise_is_refused(beside: dict[str, Any]) -> None:
    sections = {"law": "states", "states": STATES | {"per": "mm"}, **beside}
    with pytest.raises(InputError, match=f"friction.states and friction.{next(iter(beside))} excl"):
        Study.load("v1").replace(friction=sections)


def test_a_law_without_its_section() -> None:
    with pytest.raises(InputError, match=r"friction.law = 'states' needs a section \[friction.states\]"):
        Study.load("v1").replace({"friction.law": "states"})


@pytest.mark.parametrize("preset", ["v1", "v3-fine"])
def test_a_run_has_the_friction_of_the_law(preset: str) -> None:
    """The course is the law's in every model; what wears is not asked, and the energy is its integral."""
    short = {
        "grid__cell": "20 um",
        "sliding__distance": "200 mm",
        "output__snapshots": [],
        "stepping__scheme": "implicit",
    }
    own = study(preset, **short)
    with warpwear.run(own, device="cpu") as result:
        history, distance = result.history, result.history["distance"]
    middle = math.log(STATES["spread"] / STATES["seed"])
    parts = shares(distance, rate=STATES["spread"] + STATES["seed"], middle=middle, cover_rate=0.1)
    cof = parts.filmed * (0.15 + 1e-3 * distance) + parts.metal * 1.03 + parts.covered * 0.47
    assert history["cof"] == pytest.approx(cof, rel=1e-13)
    assert history["friction_energy"][-1] == pytest.approx(8e-3 * np.trapezoid(cof, distance), rel=0.01)
