"""Tangential tractions are those of a dense reference, stay within friction's bound, and are certified."""

from typing import Any

import numpy as np
import pytest
from cases_half_space import rough
from cases_tangential import accelerated, dense, device, pressed
from numpy.testing import assert_allclose

from warpwear import ArrayContact, ConvergenceError, ShearedContact, solve_tangential
from warpwear.contact.half_space import shear
from warpwear.contact.half_space.shear import ShearInfluence
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid

__all__ = ["device"]  # the fixture
GRID, MODULUS, FRICTION, POISSON = Grid(20, 20, 0.5), 3.0, 0.4, 0.3
EXCESS = POISSON / (1.0 - POISSON)
#: Rigid displacements of three increments, which turn.
TURNS = [(0.10, 0.0), (0.11, 0.09), (0.02, 0.10)]


@pytest.fixture(scope="module")
def contact() -> ArrayContact:
    """A rough contact of a fifth of the cells."""
    return pressed(rough(GRID, shortest=6), GRID.cell, 14.0, MODULUS, tolerance=1e-12)


@pytest.fixture(scope="module")
def matrix(contact: ArrayContact) -> FloatArray:
    """Of all cells."""
    return dense(GRID, MODULUS, EXCESS)


def expected(contact: ArrayContact, matrix: FloatArray) -> list[FloatArray]:
    """Tractions after the increments, by a method that shares nothing with the solver."""
    touching = np.flatnonzero(contact.pressure.ravel() > 0.0)
    both = np.concatenate([touching, touching + GRID.cells])
    part, bound = matrix[np.ix_(both, both)], FRICTION * contact.pressure.ravel()[touching]
    traction, before, course = np.zeros((2, touching.size)), (0.0, 0.0), []
    for turn in TURNS:
        further = np.subtract(turn, before)[:, np.newaxis]
        push = (part @ traction.ravel()).reshape(2, -1) + further
        traction, before = accelerated(part, push, bound), turn
        whole = np.zeros((2, GRID.cells))
        whole[:, touching] = traction
        course.append(whole.reshape(2, *GRID.shape))
    return course


def course_of(contact: ArrayContact, steps: dict[str, list[Any]], **options: Any) -> list[ShearedContact]:
    """Increments one after another."""
    course: list[ShearedContact] = []
    ((name, values),) = steps.items()
    for value in values:
        law: dict[str, Any] = {"friction": FRICTION, "poisson": POISSON, name: value, **options}
        course.append(solve_tangential(contact, previous=course[-1] if course else None, **law))
    return course


def test_three_turning_increments_are_those_of_a_dense_reference(
    device: str, contact: ArrayContact, matrix: FloatArray
) -> None:
    """At displacements, and at the forces that these take, to 1e-8 of the largest bound."""
    reference = expected(contact, matrix)
    largest = FRICTION * contact.pressure.max()
    options: dict[str, Any] = {"tolerance": 1e-10, "device": device}
    moved = course_of(contact, {"displacement": TURNS}, **options)
    assert 0 < np.count_nonzero(moved[1].stick) < 0.9 * np.count_nonzero(contact.pressure)
    forces = [tuple(traction.sum(axis=(1, 2)) * GRID.cell**2) for traction in reference]
    pushed = course_of(contact, {"force": forces}, **options)
    for traction, by_displacement, by_force, turn in zip(reference, moved, pushed, TURNS, strict=True):
        assert_allclose(by_displacement.traction, traction, rtol=0.0, atol=1e-8 * largest)
        assert_allclose(by_force.traction, traction, rtol=0.0, atol=1e-8 * largest)
        assert by_force.displacement == pytest.approx(turn, abs=1e-7)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-6])
def test_the_certificate_bounds_what_is_missing(
    contact: ArrayContact, matrix: FloatArray, tolerance: float
) -> None:
    """The energy's true excess over the least, and Coulomb's bound, at whatever tolerance."""
    for name, value in (("displacement", TURNS[1]), ("force", (1.6, 1.2))):
        (rough_one,), (best,) = (
            course_of(contact, {name: [value]}, tolerance=of) for of in (tolerance, 1e-12)
        )

        def energy(sheared: ShearedContact, name: str = name) -> float:
            q = sheared.traction.ravel()
            push = np.repeat(TURNS[1], GRID.cells) if name == "displacement" else np.zeros_like(q)
            return float(0.5 * q @ matrix @ q - push @ q) * GRID.cell**2

        certificate = rough_one.certificate
        assert certificate.violation <= tolerance
        excess = energy(rough_one) - energy(best)
        assert -1e-12 * abs(energy(best)) <= excess <= certificate.energy_gap
        size, bound = np.hypot(*rough_one.traction), FRICTION * contact.pressure
        assert (size <= bound * (1.0 + 1e-14)).all()
        assert certificate.force_residual <= 1e-12


def test_what_slips_carries_the_bound_and_goes_along_it(contact: ArrayContact) -> None:
    """The conditions of Coulomb, cell by cell."""
    (sheared,) = course_of(contact, {"force": [(1.6, 1.2)]}, tolerance=1e-10)
    size, bound = np.hypot(*sheared.traction), FRICTION * contact.pressure
    slips = (bound > 0.0) & ~sheared.stick
    assert_allclose(size[slips], bound[slips], rtol=1e-13)
    work = (sheared.traction * sheared.slip).sum(axis=0)[slips]
    assert_allclose(work, (size * np.hypot(*sheared.slip))[slips], rtol=1e-8, atol=1e-12)
    assert np.abs(sheared.slip[:, sheared.stick]).max() < 1e-8
    assert sheared.energy == pytest.approx(work.sum() * GRID.cell**2)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("shape", [(12, 10), (13, 15), (211, 9)])
def test_the_operator_is_that_of_closed_forms(device: str, boundary: str, shape: tuple[int, int]) -> None:
    """Cells of the half-space, or waves of it: 2/(E* k) along them, 2 (1 + B E*)/(E* k) across."""
    grid = Grid(*shape, 0.5)
    traction = np.random.default_rng(1).standard_normal((2, *shape))
    with Executor(grid, device=device, threads=1) as executor:
        field, response = executor.zeros(2 * grid.nx), executor.zeros(2 * grid.nx)
        executor.fill(field, traction.reshape(-1, grid.ny))
        options: dict[str, Any] = {"modulus": MODULUS, "excess": EXCESS, "boundary": boundary}
        operator = ShearInfluence(executor, axes=2, **options)
        program = Program(executor)
        operator.add_response(program, field, response)
        program.run()
        displaced = executor.to_numpy(response).reshape(2, *shape).copy()
        if boundary == "periodic":
            operator.add_inverse(back := Program(executor), response)
            back.run()
            returned = executor.to_numpy(response).reshape(2, *shape)
    if boundary == "free":
        reference = (dense(grid, MODULUS, EXCESS) @ traction.ravel()).reshape(2, *shape)
        assert_allclose(displaced, reference, rtol=0.0, atol=1e-12 * np.abs(reference).max())
        return
    q_x, q_y = (2.0 * np.pi * np.fft.fftfreq(n, grid.cell) for n in shape)
    waves = np.array(np.meshgrid(q_x, q_y, indexing="ij"))
    size = np.hypot(*waves)
    size[0, 0] = np.inf
    modes = np.fft.fft2(traction)
    along = (waves * modes).sum(axis=0) / size * waves / size
    inner = (2 * np.arange(shape[0]) != shape[0])[:, np.newaxis] & (2 * np.arange(shape[1]) != shape[1])
    modes, along = np.where(inner, modes, 0.0), np.where(inner, along, 0.0)
    reference = 2.0 / (MODULUS * size) * (along + (1.0 + EXCESS) * (modes - along))
    assert_allclose(np.fft.fft2(displaced) * inner, reference, atol=1e-12 * np.abs(reference).max())
    modes[:, 0, 0] = 0.0
    assert_allclose(np.fft.fft2(returned) * inner, modes, rtol=0.0, atol=1e-4 * np.abs(modes).max())


def test_a_search_that_does_not_end_says_so(monkeypatch: pytest.MonkeyPatch, contact: ArrayContact) -> None:
    monkeypatch.setattr(shear, "MAX_ITERATIONS", 2)
    with pytest.raises(ConvergenceError, match=r"in 2 iterations: slip conditions are violated by 0\.0"):
        course_of(contact, {"force": [(1.6, 1.2)]})
