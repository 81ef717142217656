"""What solve_tangential cannot do is said in a sentence with the field, its value and what is allowed."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cases_tangential import FRICTION, LOAD, MODULUS, POISSON, YOUNG, ball

from warpwear import InputError, solve_contact, solve_tangential

FLAT = np.zeros((16, 16))
#: Sentence -> arguments, solutions among them by what makes them: files are read by who does not run them.
REFUSED: dict[str, dict[str, Any]] = {
    "contact is not possible without a half-space; it must be solved with a modulus": {
        "contact": lambda: solve_contact(FLAT, cell=1.0, mean_pressure=0.5, stiffness=1.0)
    },
    r"contact of load = 0 is not possible": {
        "contact": lambda: solve_contact(FLAT, cell=1.0, approach=-1.0, modulus=1.0)
    },
    'contact of boundary "line" is not possible but with one column': {
        "force": 0.1,
        "contact": lambda: solve_contact(FLAT, cell=1.0, load=1.0, modulus=MODULUS, boundary="line"),
    },
    "friction = 0 is not possible; it must be a positive": {"friction": 0.0},
    "poisson = 0.6 is not possible; it must be above -1 and at most 0.5": {"poisson": 0.6},
    r"poisson = \(0.3, 0.2\) is not possible; it must be a number, or \(young, poisson\)": {
        "poisson": (0.3, 0.2)
    },
    "these bodies have the modulus .*; it must be that of their contact": {
        "poisson": ((YOUNG, POISSON), (math.inf, 0.3)),
        "force": (1.0, 0.0),
    },
    "poisson of dissimilar bodies is not possible along one axis": {
        "poisson": ((MODULUS * 0.96, 0.2), (math.inf, 0.3))
    },
    "force = 12.0 is not possible; it must be less than friction × load, 12,": {"force": FRICTION * LOAD},
    r"force = \[1, 2, 3\] is not possible; it must be a number, or two": {"force": [1, 2, 3]},
    "force = None and displacement = None are given; exactly one must be": {"force": None},
    "force = 1 and displacement = 1 are given": {"force": 1, "displacement": 1},
    "tolerance = 0.1 is not possible": {"tolerance": 0.1},
    "previous of .* cells .* is not possible; those of contact must be the same": {
        "previous": lambda: solve_tangential(ball(128), friction=0.1, poisson=0.0, force=0.1)
    },
    "previous has a traction along axis 1": {
        "previous": lambda: solve_tangential(ball(64), friction=0.6, poisson=0.0, force=(0.1, 0.1))
    },
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_bad_arguments_are_refused_in_a_sentence(sentence: str) -> None:
    arguments: dict[str, Any] = {"contact": ball(64), "friction": FRICTION, "poisson": POISSON, "force": 1.0}
    for name, value in REFUSED[sentence].items():
        arguments[name] = value() if callable(value) else value
    with pytest.raises(InputError, match=sentence):
        solve_tangential(**arguments)


def test_memory_that_is_not_there_is_told(host_with: Callable[[float], None]) -> None:
    host_with(2**20)
    with pytest.raises(
        InputError, match=r"64 × 64 cells need 0\.0 GiB of memory; the host has 0\.0 GiB free"
    ):
        solve_tangential(ball(64), friction=FRICTION, poisson=0.0, force=1.0)


def test_a_counter_body_that_ends_cannot_be_pressed_anew() -> None:
    contact = solve_contact(np.zeros((32, 32)), cell=0.1, load=0.01, modulus=1.0, counter_radius=1.0)
    poisson = ((0.96, 0.2), (math.inf, 0.3))
    with pytest.raises(InputError, match="a counter-body that ends over heights is not possible"):
        solve_tangential(contact, friction=0.3, poisson=poisson, force=(0.0, 0.0))


def test_a_result_says_what_it_is() -> None:
    sheared = solve_tangential(ball(64), friction=FRICTION, poisson=0.0, force=3.0)
    along, across = sheared.traction
    assert along.shape == across.shape == (64, 64)
    assert repr(sheared).startswith("<sheared contact: force (3, 0), displacement (0.000")
    assert sheared.evaluations > sheared.iterations
