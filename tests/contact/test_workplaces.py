"""Places that are kept from one solve of an array to the next: nothing but time depends on them."""

import os
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough
from cases_solve import HEIGHTS

from warpwear import ArrayContact, solve_contact, solve_tangential
from warpwear.contact.array import workplace
from warpwear.contact.half_space.search import Search
from warpwear.engine import program
from warpwear.errors import ConvergenceError
from warpwear.grid import Grid

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

OTHERS = rough(Grid(64, 48, 0.25), shortest=5)
LARGER = rough(Grid(90, 131, 0.25), shortest=9)
#: Laws and numbers that follow each other, of which many share a place or a solver.
CALLS: list[dict[str, Any]] = [
    {"modulus": 5.0, "mean_pressure": 0.02},
    {"modulus": 5.0, "mean_pressure": 0.2, "tolerance": 1e-10},
    {"modulus": 5.0, "approach": -0.01},
    {"modulus": 2.0, "mean_pressure": 0.01, "tolerance": 1e-3, "boundary": "free"},
    {"modulus": 2.0, "mean_pressure": 0.01, "boundary": "free", "hardness": 0.2},
    {"modulus": 2.0, "mean_pressure": 1e-4, "counter_radius": 40.0},
    {"modulus": 2.0, "mean_pressure": 1e-3, "counter_radius": 40.0},
    {"modulus": 2.0, "mean_pressure": 0.01, "boundary": "line"},
    {"modulus": 5.0, "mean_pressure": 0.2, "hardness": 0.5},
    {"stiffness": 2.0, "mean_pressure": 0.01},
    {"hardness": 2.0, "mean_pressure": 0.01},
]


@pytest.fixture(autouse=True)
def kept(monkeypatch: pytest.MonkeyPatch) -> dict[Any, workplace.Workplace]:
    """Places of this test alone."""
    monkeypatch.setattr(workplace, "_kept", {})
    return workplace._kept


def solved(heights: Any, device: str = "cpu", **options: Any) -> ArrayContact:
    return solve_contact(heights, cell=0.25, device=device, threads=1, **options)


def are_same(one: ArrayContact, other: ArrayContact) -> bool:
    numbers = ("approach", "certificate", "evaluations")
    return all(getattr(one, name) == getattr(other, name) for name in numbers) and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ("pressure", "gap")
    )


@pytest.mark.filterwarnings("ignore:the contact")
def test_no_solve_depends_on_those_before(kept: dict[Any, Any], device: str) -> None:
    calls = [(heights, options) for options in CALLS for heights in (HEIGHTS, OTHERS, LARGER)]
    fresh = []
    for heights, options in calls:
        kept.clear()
        fresh.append(solved(heights, device, **options))
    for number in np.random.default_rng(0).permutation(np.repeat(np.arange(len(calls)), 2)):
        heights, options = calls[number]
        assert are_same(solved(heights, device, **options), fresh[number])


def test_no_shear_depends_on_those_before(kept: dict[Any, Any], device: str) -> None:
    pressed = [solved(heights, **CALLS[2 * n]) for n in range(2) for heights in (HEIGHTS, OTHERS)]

    def sheared(contact: ArrayContact, poisson: Any) -> Any:
        force = 0.2 * contact.load, 0.1 * contact.load
        options: dict[str, Any] = {"poisson": poisson, "device": device, "threads": 1}
        return solve_tangential(contact, friction=0.5, force=force, **options)

    fresh = []
    for contact in pressed:
        kept.clear()
        fresh.append(sheared(contact, 0.3))
    for number in (0, 1, 1, 2, 0, 3):
        again = sheared(pressed[number], 0.3)
        np.testing.assert_array_equal(again.traction, fresh[number].traction)
        np.testing.assert_array_equal(again.slip, fresh[number].slip)
        assert again.certificate == fresh[number].certificate


@pytest.mark.parametrize("options", CALLS[:4])
def test_a_second_solve_records_nothing(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    made, record = [], program.Recording.__init__
    monkeypatch.setattr(program.Recording, "__init__", lambda *given: made.append(given) or record(*given))
    for _ in range(3):
        before = len(made)
        solved(LARGER, **options)
    assert before == len(made) > 0


def test_two_threads_have_no_place_in_common(kept: dict[Any, Any]) -> None:
    expected, met = solved(LARGER, **CALLS[3]), Barrier(2, timeout=60.0)

    def work(_: int) -> ArrayContact:
        met.wait()
        return solved(LARGER, **CALLS[3])

    with ThreadPoolExecutor(2) as pool:
        for _ in range(5):
            assert all(are_same(contact, expected) for contact in pool.map(work, range(2)))
    lend = workplace.workplace("normal", (8, 8), lambda: None, device="cpu", threads=1)
    also = workplace.workplace("normal", (8, 8), lambda: None, device="cpu", threads=1)
    with lend as one, also as other:
        assert one is not other
    assert len(kept) == 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_solves_as_its_parent_does() -> None:
    expected = solved(LARGER, **CALLS[3])
    child = os.fork()
    if not child:
        status = 1
        try:
            status = 0 if are_same(solved(LARGER, **CALLS[3]), expected) else 2
        finally:
            os._exit(status)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert are_same(solved(LARGER, **CALLS[3]), expected)


def test_a_solve_that_failed_leaves_no_place(kept: dict[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    expected = solved(HEIGHTS, **CALLS[0])
    run = Search.run

    def fail(*how: Any) -> int:
        run(*how)
        raise ConvergenceError("of a test")

    with monkeypatch.context() as patch:
        patch.setattr(Search, "run", fail)
        with pytest.raises(ConvergenceError):
            solved(OTHERS, **CALLS[0])
    assert not kept
    assert are_same(solved(HEIGHTS, **CALLS[0]), expected)


def test_few_and_small_places_are_kept(kept: dict[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    for side in (8, 9, 10, 11, 12):
        for load in np.geomspace(1e-5, 1e-2, 2 * workplace.MOST_SOLVERS):
            solved(HEIGHTS[:side], modulus=2.0, mean_pressure=load, boundary="free", hardness=10.0 * load)
    assert [key[1][0] for key in kept] == [9, 10, 11, 12]
    assert max(len(place._solvers) for place in kept.values()) == workplace.MOST_SOLVERS
    monkeypatch.setattr(workplace, "MOST_CELLS", 100)
    solved(HEIGHTS, **CALLS[0])
    assert len(kept) == workplace.MOST_PLACES
    monkeypatch.setattr(workplace, "free_memory", lambda device: {"the host": 2**30})
    solved(LARGER, **CALLS[0])
    assert not kept
