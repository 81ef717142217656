"""Every argument of solve_contact, solve_tangential and stresses refuses nonsense by one sentence."""

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from warpwear import solve_contact, solve_tangential, stresses
from warpwear.errors import ConvergenceError, InputError

FLAT = np.zeros((16, 16))
BALL = solve_contact(FLAT, cell=0.1, load=1.0, modulus=1.0, counter_radius=10.0)
PUSHED = solve_tangential(BALL, friction=0.5, poisson=0.3, force=0.1)
NONSENSE: tuple[Any, ...] = (
    *(10**400, -(10**400), [10**400], [[10**400] * 2] * 2, math.nan, math.inf, -1.0, 0.0, True, 1 + 2j),
    *("x", "", b"x", [], [1.0], [[1.0, 2.0], [3.0]], ((1.0, "x"), (2.0, None)), ["a", "b"], [None, None]),
    *({}, {"radius": [1.0]}, {"shape": np.zeros(2), "radius": np.zeros(3)}, {1: 2}, object(), float),
    *(FLAT, FLAT[0], FLAT[:0], [FLAT, FLAT], [FLAT, FLAT[:3]], np.array("x"), np.ma.masked_all((16, 16))),
    *(np.datetime64("2020-01-01"), BALL, PUSHED),
)
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "springs": (
        solve_contact,
        {"heights": FLAT, "cell": 0.1, "mean_pressure": 0.1, "hardness": 2.0, "stiffness": 1.0}
        | dict.fromkeys(("modulus", "boundary", "counter_radius", "load", "approach", "threads"))
        | {"device": "cpu"},
    ),
    "half-space": (
        solve_contact,
        {"heights": FLAT, "cell": 0.1, "load": 0.1, "modulus": 1.0, "boundary": "free", "tolerance": 1e-6}
        | {"counter": {"radius": 10.0}},
    ),
    "friction": (
        solve_tangential,
        {"contact": BALL, "friction": 0.5, "poisson": 0.3, "force": 0.1, "displacement": None}
        | {"previous": None, "tolerance": 1e-6, "device": "cpu", "threads": None},
    ),
    "below a pressure": (
        stresses,
        {"contact": FLAT + 1.0, "depths": [0.0, 0.1], "poisson": 0.3, "traction": None, "cell": 0.1}
        | {"boundary": "free", "threads": None},
    ),
    "below a contact": (stresses, {"contact": BALL, "depths": 0.1, "poisson": 0.3, "boundary": None}),
}


@pytest.mark.parametrize("call", CALLS)
def test_nonsense_is_a_sentence(call: str) -> None:
    function, arguments = CALLS[call]
    for name in arguments:
        for value in NONSENSE:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    function(**{**arguments, name: value})
                except (InputError, ConvergenceError):
                    continue
                except Exception as error:
                    raise AssertionError(f"{name} = {value!r:.60} ends in {error!r:.200}") from error


def test_an_infinite_hardness_is_none() -> None:
    heights = np.random.default_rng(0).normal(size=(32, 32))
    of = {"cell": 1.0, "mean_pressure": 0.2, "modulus": 1.0}
    limitless, infinite = (solve_contact(heights, hardness=hardness, **of) for hardness in (None, math.inf))
    np.testing.assert_array_equal(limitless.pressure, infinite.pressure)
    assert infinite.hardness is None
    with pytest.raises(InputError, match="the bearing area needs a hardness"):
        solve_contact(heights, cell=1.0, mean_pressure=0.2, hardness=math.inf)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_row_of_pressures_is_one_amid_nothing(axis: int) -> None:
    line = np.random.default_rng(0).random((24, 1))
    wide = np.pad(line, ((0, 0), (1, 1)))
    line, wide = (line, wide) if axis == 0 else (line.T, wide.T)
    of: dict[str, Any] = {"poisson": 0.3, "cell": 0.1, "boundary": "free"}
    alone = stresses(line, [0.0, 0.15], traction=(line, 0.5 * line), **of).tensor
    within = stresses(wide, [0.0, 0.15], traction=(wide, 0.5 * wide), **of).tensor
    middle = within[..., 1:2] if axis == 0 else within[..., 1:2, :]
    np.testing.assert_allclose(alone, middle, rtol=0.0, atol=1e-12)


def test_memory_that_runs_out_is_a_memory_error(failing: Callable[[str, Exception], None]) -> None:
    error = RuntimeError("Failed to allocate 33816576 bytes on device 'cpu'")  # as Warp says it
    failing("warpwear.contact.array.solve.solve_half_space", error)
    with pytest.raises(MemoryError, match="33816576 bytes"):
        solve_contact(FLAT, cell=0.1, load=1.0, modulus=1.0, counter_radius=10.0)
