"""warpwear.solve_tangential is compared with closed forms of balls, and with rough normal contacts."""

import math
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough
from cases_tangential import (
    CONTACT_RADIUS,
    FRICTION,
    LARGEST,
    LOAD,
    at_sliding,
    ball,
    device,
    softness,
    squares,
)
from numpy.testing import assert_array_equal

from warpwear import ShearedContact, solve_contact, solve_tangential
from warpwear.grid import Grid

__all__ = ["device"]  # the fixture
ALL = FRICTION * LOAD
SIZES = [64, 128, 256, pytest.param(512, marks=pytest.mark.slow)]


@pytest.mark.parametrize("poisson", [0.0, 0.3])
@pytest.mark.parametrize("cells", SIZES)
def test_a_ball_sticks_where_cattaneo_says(device: str, cells: int, poisson: float) -> None:
    """Cattaneo and Mindlin, to the cells at the ring; both along one axis, and along two where ν is not 0.

    Mindlin's neglect of the traction across is 0.05 % of the displacement where ν = 0.3.
    """
    force = 0.6 * ALL
    sheared = solve_tangential(
        ball(cells, device),
        friction=FRICTION,
        poisson=poisson,
        force=(force, 0.0) if poisson else force,
        device=device,
    )
    allowed = {64: 0.01, 128: 0.005, 256: 0.003, 512: 0.002}[cells]
    stick = CONTACT_RADIUS * 0.4 ** (1.0 / 3.0)
    assert math.sqrt(sheared.stick_area / math.pi) == pytest.approx(stick, rel=allowed)
    if cells >= 128:
        moved = at_sliding(poisson) * (1.0 - 0.4 ** (2.0 / 3.0))
        assert sheared.displacement[0] == pytest.approx(moved, rel=1e-3 if poisson else 1e-4)
    assert sheared.iterations <= (80 if poisson else 20)
    assert sheared.force == pytest.approx((force, 0.0), abs=1e-12 * ALL)
    if poisson:  # else Mindlin's neglect is a part of the difference
        return
    square = squares(cells, sheared.contact.cell)
    roots = [np.sqrt(np.maximum(1.0 - square / radius**2, 0.0)) for radius in (CONTACT_RADIUS, stick)]
    off = sheared.traction[0] - FRICTION * LARGEST * (roots[0] - stick / CONTACT_RADIUS * roots[1])
    inside = square < CONTACT_RADIUS**2
    assert math.sqrt(float(np.square(off[inside]).mean())) < 0.4 / cells * FRICTION * LARGEST


def loop(forces: list[float], **options: Any) -> list[ShearedContact]:
    """Increments one after another."""
    course: list[ShearedContact] = []
    for force in forces:
        previous = course[-1] if course else None
        course.append(solve_tangential(ball(128), poisson=0.0, force=force, previous=previous, **options))
    return course


def test_a_loop_is_that_of_mindlin_and_deresiewicz() -> None:
    """Displacement over the loop, its closure, and what it dissipates, by two steps a quarter and by none."""
    shares = [0.3, 0.6, 0.3, 0.0, -0.3, -0.6, -0.3, 0.0, 0.3, 0.6]
    course = loop([share * ALL for share in shares], friction=FRICTION)

    def back(share: float) -> float:
        return 2.0 * (1.0 - 0.5 * (0.6 - share)) ** (2.0 / 3.0) - 0.4 ** (2.0 / 3.0) - 1.0

    for number, (share, sheared) in enumerate(zip(shares, course, strict=True)):
        first = 1.0 - (1.0 - share) ** (2.0 / 3.0)
        moved = first if number < 2 else back(share) if number < 6 else -back(-share)
        assert sheared.displacement[0] / at_sliding(0.0) == pytest.approx(moved, abs=1e-4)
    assert course[-1].displacement[0] == pytest.approx(course[1].displacement[0], rel=1e-6)
    whole = 1.0 - 0.4 ** (5.0 / 3.0) - 0.5 * (1.0 + 0.4 ** (2.0 / 3.0))
    dissipated = 0.9 * FRICTION**2 * LOAD**2 * softness(0.0) / CONTACT_RADIUS * whole
    assert sum(sheared.energy for sheared in course[2:]) == pytest.approx(dissipated, rel=5e-4)
    two = loop([0.6 * ALL, -0.6 * ALL, 0.6 * ALL], friction=FRICTION)
    assert two[1].energy + two[2].energy == pytest.approx(dissipated, rel=5e-4)
    assert np.abs(two[2].traction - course[-1].traction).max() < 1e-5 * FRICTION * LARGEST


@pytest.mark.parametrize("share", [0.3, 1.0, 4.0])
def test_a_displacement_leads_to_its_force_and_energy(share: float) -> None:
    """Q to 1e-4 below sliding and μP beyond it; half a loop dissipates what Mindlin's does."""
    most = at_sliding(0.0)
    options: dict[str, Any] = {"friction": FRICTION, "poisson": 0.0}
    first = solve_tangential(ball(128), displacement=share * most, **options)
    force = 1.0 - (1.0 - min(share, 1.0)) ** 1.5
    assert first.force[0] == pytest.approx(force * ALL, rel=1e-4)
    there = solve_tangential(ball(128), displacement=-share * most, previous=first, **options)
    back = solve_tangential(ball(128), displacement=share * most, previous=there, **options)
    if share >= 1.0:
        dissipated = ALL * most * (0.8 + 4.0 * (share - 1.0))
        assert there.energy + back.energy == pytest.approx(dissipated, rel=5e-4)
        assert not first.stick.any() or share == 1.0
    assert back.displacement == pytest.approx((share * most, 0.0))


@pytest.mark.parametrize("share", [0.3, 0.7, 0.95])
@pytest.mark.parametrize("axes", [1, 2])
def test_a_rough_traction_is_the_difference_of_two_pressures(device: str, axes: int, share: float) -> None:
    """Ciavarella and Jäger, exact on any surface where ν = 0: nothing is discretised in it."""
    heights, mean = rough(Grid(128, 128, 1.0), shortest=32), 0.01
    law: dict[str, Any] = {"cell": 1.0, "modulus": 1.0, "tolerance": 1e-9, "device": device}
    contact = solve_contact(heights, mean_pressure=mean, **law)
    less = solve_contact(heights, mean_pressure=(1.0 - share) * mean, **law)
    force = share * FRICTION * contact.load
    sheared = solve_tangential(
        contact,
        friction=FRICTION,
        poisson=0.0,
        force=force if axes == 1 else (0.6 * force, 0.8 * force),
        tolerance=1e-8,
        device=device,
    )
    expected = FRICTION * (contact.pressure - less.pressure)
    way = (1.0, 0.0) if axes == 1 else (0.6, 0.8)
    largest = FRICTION * contact.pressure.max()
    for part, traction in zip(way, sheared.traction, strict=True):
        assert np.abs(traction - part * expected).max() < 1e-6 * largest
    # what slips is what the smaller contact leaves open
    slip = way[0] * sheared.slip[0] + way[1] * sheared.slip[1]
    assert np.abs(slip - FRICTION * np.where(contact.pressure > 0.0, less.gap, 0.0)).max() < 1e-6


def test_results_do_not_depend_on_threads(two_threads: int) -> None:
    contact = ball(64)
    options: dict[str, Any] = {"friction": FRICTION, "poisson": 0.3, "force": (0.4 * ALL, 0.3 * ALL)}
    one, more = (solve_tangential(contact, threads=count, **options) for count in (1, two_threads))
    for name in ("traction", "slip", "stick", "displacement", "energy", "certificate"):
        assert_array_equal(getattr(one, name), getattr(more, name))


def test_a_line_contact_is_cattaneos() -> None:
    """Carter and Cattaneo: c = a √(1 − Q/μP), whatever Poisson's ratio is."""
    cells, radius = 512, 1.0
    cell = 2.6 * radius / cells
    x = cell * (np.arange(cells) - 0.5 * (cells - 1))
    load = math.pi * radius**2 / 4.0 / 100.0 * cell  # a² = 4 P' R/(π E*)
    heights = -(x**2)[:, np.newaxis] / 200.0
    contact = solve_contact(heights, cell=cell, load=load, modulus=1.0, boundary="line")
    sheared = solve_tangential(contact, friction=0.5, poisson=0.4, force=0.5 * 0.6 * load)
    assert np.count_nonzero(sheared.stick) * cell == pytest.approx(2.0 * math.sqrt(0.4), rel=0.01)


def test_loads_may_change_between_increments() -> None:
    """What is pressed and sheared alike, P ∝ Q, sticks everywhere if Q < μP (Mindlin and Deresiewicz)."""
    previous = None
    for share in (0.25, 0.5, 0.75, 1.0):
        heights = -squares(64, 2.6 * CONTACT_RADIUS / 64) / 10.0
        options: dict[str, Any] = {"cell": ball(64).cell, "modulus": ball(64).modulus, "boundary": "free"}
        contact = solve_contact(heights, load=share * LOAD, **options)
        sheared = solve_tangential(
            contact, friction=FRICTION, poisson=0.0, force=0.5 * share * ALL, previous=previous
        )
        # of each increment new cells slip, which had no pressure to stick by before
        old = sheared.stick if previous is None else previous.contact.pressure > 0.0
        assert sheared.stick[old].all()
        previous = sheared
    assert previous is not None
    assert previous.force[0] == pytest.approx(0.5 * ALL)


@pytest.mark.parametrize(
    ("cells", "most"), [(512, 45), pytest.param(2048, 150, marks=pytest.mark.slow)], ids=str
)
def test_a_large_rough_surface_is_solved_in_few_iterations(device: str, cells: int, most: int) -> None:
    """Cells that are to leave their circles do, however many others come to theirs in a step."""
    rng = np.random.default_rng(2)
    along, across = np.fft.fftfreq(cells, 1.0 / cells), np.fft.rfftfreq(cells, 1.0 / cells)
    waves = np.hypot(along[:, np.newaxis], across)
    inside = (waves > 0.0) & (waves <= cells / 16)
    sizes = np.where(inside, np.maximum(waves, 2.0), np.inf) ** -1.8
    heights = np.fft.irfft2(sizes * np.exp(2j * np.pi * rng.random(waves.shape)), s=(cells, cells))
    heights *= 0.1 / np.sqrt(np.square(np.gradient(heights)).sum(axis=0).mean())
    contact = solve_contact(
        heights, cell=1.0, load=0.01 * cells**2, modulus=1.0, boundary="periodic", device=device
    )
    push = 0.58 * 0.5 * contact.load
    sheared = solve_tangential(
        contact, friction=0.5, poisson=0.3, force=(0.8 * push, 0.6 * push), device=device
    )
    assert sheared.certificate.violation <= 1e-6
    assert sheared.iterations <= most
