"""Laws of arrays are those of numbers, one by one; and what they say of themselves."""

from typing import Any

import numpy as np
import pytest

from warpwear.laws.archard import WEAR_LAWS, WearLaw, said
from warpwear.study.sections.friction import Friction
from warpwear.study.sections.wear import Wear

#: Numbers of keys of [wear], three of each, K in mm²/N.
NUMBERS = {"counter": [1e-6, 2e-6, 0.0], "initial_counter": [4e-6, 2e-6, 1e-6]}
NUMBERS |= {"severe_counter": [9e-6, 2e-6, 1e-6], "transition_pressure": [300.0, 500.0, 700.0]}
NUMBERS |= {"transition_width": [100.0, 10.0, 1.0]}
NUMBERS |= {"decay": [0.02, 1e-4, 3.0], "running_in": [20.0, 1e3, 0.1]}
STARTS = np.array([0.0, 3.0, 80.0])


@pytest.mark.parametrize("law", WEAR_LAWS.values(), ids=WEAR_LAWS)
def test_a_wear_law_of_arrays(law: type[WearLaw]) -> None:
    increments = np.array([[1e-9, 0.5, 40.0]])
    many = law.of("counter", lambda key: np.array(NUMBERS[key])[:, None])
    for start in STARTS:
        worn = many.wear_per_pressure(float(start), increments)
        for place in range(3):
            one = law.of("counter", lambda key, place=place: NUMBERS[key][place])
            each = [one.wear_per_pressure(float(start), float(increment)) for increment in increments[0]]
            np.testing.assert_allclose(np.broadcast_to(worn, (3, 3))[place], each, rtol=1e-14)


def test_a_friction_law_of_arrays() -> None:
    section = Friction(shear_strength="4 MPa", initial_ratio=3.0, running_in="20 mm")
    numbers = {"shear_strength": [4.0, 5.0], "initial_ratio": [3.0, 0.5], "running_in": [20.0, 1.0]}
    distance = np.array([[0.1, 5.0, 90.0]])
    history = {"distance": distance, "area_contact": np.array([[0.1, 0.5, 1.2]])}
    columns = {f"friction.{key}": np.array(column)[:, None] for key, column in numbers.items()}
    many = section.law_with(columns).coefficient(history, load=8.0, finished=True)
    for place in range(2):
        one = section.law_with({f"friction.{key}": column[place] for key, column in numbers.items()})
        np.testing.assert_allclose(
            many[place], one.coefficient(history, load=8.0, finished=True)[0], rtol=1e-14
        )


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, ""),
        ({"law": "exponential", "decay": "0.02 1/mm"}, "α = 0.02 1/mm"),
        (
            {"law": "running-in", "running_in": "20 mm", "initial_disc": "4e-3 mm^3/N/m"},
            "L0 = 20 mm and K0 = 0.001 and 0.004 mm³/(N·m)",
        ),
        (
            {
                "law": "transition",
                "severe_counter": "9e-3 mm^3/N/m",
                "severe_disc": "4e-3 mm^3/N/m",
                "transition_pressure": "300 MPa",
                "transition_width": "100 MPa",
            },
            "of severe wear over 100 MPa about a pressure of the cell of 300 MPa",
        ),
    ],
)
def test_a_law_says_its_numbers(keys: dict[str, Any], words: str) -> None:
    wear = Wear(counter="1e-3 mm^3/N/m", disc="2e-3 mm^3/N/m", **keys)
    sentence = said(wear.laws(590.0, Friction()))
    assert words in sentence
    assert bool(sentence) == bool(keys)
    film = {"thickness": "10 nm", "shear_strength": "40 MPa"}
    law = Friction(shear_strength="172 MPa", ploughing=0.1, film=film).law_with()
    assert law.said == "0.1 of the coefficient does not shear"
    assert r"\varphi" in law.formula
