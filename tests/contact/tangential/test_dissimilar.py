"""Bodies of different materials, and CONTACT's results of both kinds.

CONTACT (E.A.H. Vollebregt and J.J. Kalker; Vtech CMCC; Apache-2.0) comes with the examples `cattaneo` and
`spence35`, whose printed results are compared here.
"""

import math
from typing import Any

import numpy as np
import pytest
from cases_tangential import pressed, squares

from warpwear import ShearedContact, solve_tangential
from warpwear.contact.half_space.coupling import Coupling
from warpwear.grid import Grid

#: CONTACT's Cattaneo shift: shear modulus, Poisson's ratio, ball, load, friction [MPa, mm, N].
SHEAR, POISSON, RADIUS, LOAD, FRICTION = 200.0, 0.42, 50.0, 9.1954, 0.4


def cattaneo(cells: int) -> ShearedContact:
    """Its ball, on cells across the same 2.53 mm."""
    cell = 19 * 0.13333 / cells
    contact = pressed(-0.01 * squares(cells, cell), cell, LOAD, SHEAR / (1.0 - POISSON))
    force = (0.875 * FRICTION * LOAD, 0.0)
    return solve_tangential(contact, friction=FRICTION, poisson=POISSON, force=force)


def approach_of(sheared: ShearedContact, curvature: float) -> float:
    """From first touch, where heights fall as curvature × r² from the middle."""
    contact = sheared.contact
    mean = curvature * float(squares(len(contact.pressure), contact.cell).mean())
    return contact.approach + mean


def test_cattaneos_shift_on_contacts_own_cells() -> None:
    """The printed digits of its approach, largest pressure and shift, and how many cells stick."""
    sheared = cattaneo(19)
    assert approach_of(sheared, 0.01) == pytest.approx(0.01998, abs=5e-6)
    assert sheared.contact.pressure.max() == pytest.approx(4.393, abs=5e-4)
    assert sheared.displacement[0] == pytest.approx(8.155e-3, abs=5e-7)
    assert np.count_nonzero(sheared.contact.pressure) == 177
    assert np.count_nonzero(sheared.stick) == 45


@pytest.mark.slow
def test_cattaneos_shift_on_fine_cells() -> None:
    """Closed forms: approach a²/R, p₀, stick radius a/2 and Mindlin's shift, which neglects q_y."""
    sheared = cattaneo(19 * 16)
    assert approach_of(sheared, 0.01) == pytest.approx(0.02, rel=1e-3)
    assert sheared.contact.pressure.max() == pytest.approx(1.5 * LOAD / math.pi, rel=1e-3)
    assert math.sqrt(sheared.stick_area / math.pi) == pytest.approx(0.5, rel=5e-3)
    softness = 2.0 * (2.0 - POISSON) / SHEAR
    shift = 3.0 * FRICTION * LOAD * softness / 16.0 * (1.0 - 0.125 ** (2.0 / 3.0))
    assert shift == pytest.approx(8.172e-3, rel=1e-4)
    assert sheared.displacement[0] == pytest.approx(shift, rel=5e-3)


def compressed(stages: list[float], heights: Any, cell: float, **options: Any) -> ShearedContact:
    """Press stage by stage, without a tangential force."""
    previous = None
    for load in stages:
        contact = pressed(heights, cell, load, 1.0)
        previous = solve_tangential(contact, force=(0.0, 0.0), previous=previous, **options)
    assert previous is not None
    return previous


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the contact is of")
def test_spences_compression_is_contacts() -> None:
    """Its 35 stages of a soft ball on a rigid plane: a cell more a stage. There 225 cells stick."""
    stages = [0.000011, 0.000088, *((k / 45) ** 3 for k in range(3, 36))]
    options = {"friction": 0.2986, "poisson": ((1.0, 0.0), (2e5, 0.0))}
    last = compressed(stages, -0.004116 * squares(45, 0.2), 0.2, **options)
    assert approach_of(last, 0.004116) == pytest.approx(0.09874, rel=1e-3)
    assert last.contact.pressure.max() == pytest.approx(0.02392, rel=1e-3)
    assert np.count_nonzero(last.stick) == pytest.approx(225, abs=8)
    assert last.force == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.filterwarnings("ignore:the contact is of")
def test_goodmans_compression_sticks_where_spence_says() -> None:
    """(a/2c) ln((a + c)/(a − c)) = (μ/β) K(√(1 − c²/a²)): 0.810 of μ/β = 0.8, in many stages."""
    radius, poisson = 64 / 2.6, 0.2
    options: dict[str, Any] = {"friction": 0.3, "coupled": False}
    options["poisson"] = ((1.0 - poisson**2, poisson), (math.inf, 0.3))
    share = []
    for count in (8, 16, 32):
        stages = [4.0 / 300.0 * radius**2 * (k / count) ** 3 for k in range(1, count + 1)]
        last = compressed(stages, -squares(64, 1.0) / (200.0 * radius), 1.0, **options)
        share.append(math.sqrt(last.stick_area / last.contact.area))
    assert share == sorted(share)
    assert -0.02 <= share[-1] / 0.810 - 1.0 <= 0.005


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_tractions_lift_as_pressures_shear(boundary: str) -> None:
    """The operator of both bodies is symmetric, and that of integrals over cells."""
    grid, rng = Grid(14, 11, 0.5), np.random.default_rng(3)
    tie = Coupling(grid, modulus=2.0, beta=0.3, boundary=boundary, threads=1)
    traction, pressure = rng.standard_normal((2, *grid.shape)), rng.standard_normal(grid.shape)
    lifted = float((tie.lift(traction) * pressure).sum())
    assert lifted == pytest.approx(float((tie.shear(pressure) * traction).sum()), rel=1e-12)
    point = np.zeros((2, *grid.shape))
    point[0, 2, 5] = 1.0
    if boundary == "free":  # far away that of a point
        away = 9 * grid.cell
        expected = 0.3 / (math.pi * 2.0) * grid.cell**2 / away
        assert tie.lift(point)[11, 5] == pytest.approx(expected, rel=2e-3)
        assert tie.lift(point)[2, 5] == pytest.approx(0.0, abs=1e-15)


def test_tractions_of_unlike_bodies_press_the_middle() -> None:
    """A soft ball spreads less on a rigid plane: friction holds it in, and more where there is more of it."""
    heights, largest = -squares(48, 1.0) / 4000.0, []
    for friction in (0.05, 0.3):
        law: dict[str, Any] = {"friction": friction, "poisson": ((0.96, 0.2), (math.inf, 0.3))}
        last = compressed([0.5, 1.0, 1.5], heights, 1.0, **law)
        largest.append(last.contact.pressure.max())
        assert last.contact.load == pytest.approx(1.5)
        assert (np.hypot(*last.traction) <= friction * last.contact.pressure * (1.0 + 1e-14)).all()
    free = pressed(heights, 1.0, 1.5, 1.0).pressure.max()
    assert free < largest[0] < largest[1]
