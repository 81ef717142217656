"""How hot a sliding contact gets, against closed forms, a dense solve and integrals cell by cell."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import fft

import warpwear
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.joint.flash import Heated, cell_rises, shared
from warpwear.errors import InputError
from warpwear.grid import FloatArray

CELLS = 256
SIDE = 2.2  # of the array, in radii of the disc
#: Largest and mean rise × k/(q a) of a uniform disc by its Péclet number v a/2κ.
DISCS = {0.0: (1.0, 8.0 / (3.0 * math.pi)), 0.1: (0.9541, 0.8016), 1.0: (0.7321, 0.5551)}
DISCS |= {10.0: (0.3380, 0.2125), 100.0: (0.1118, 0.0684)}


def disc(cells: int, side: float) -> FloatArray:
    """A heat of 1 on a disc of radius 1."""
    x = ((np.arange(cells) + 0.5) / cells - 0.5) * side
    return np.where(np.hypot(x[:, np.newaxis], x) <= 1.0, 1.0, 0.0)


def rise(heat: FloatArray, body: Heated, cell: float) -> FloatArray:
    """What a heat makes alone, of all cells."""
    shape = tuple(2 * n for n in heat.shape)
    waves = body.response(shape, 1) * fft.rfft2(heat, s=shape)
    return np.asarray(cell * fft.irfft2(waves, s=shape)[: heat.shape[0], : heat.shape[1]])


def spots(seed: int = 0) -> ArrayContact:
    heights = np.random.default_rng(seed).normal(size=(24, 18))
    return warpwear.solve_contact(heights, cell=0.5, modulus=1.0, mean_pressure=0.3)


def dense(body: Heated, touches: Any, cell: float) -> FloatArray:
    """What heat of each cell in contact makes on each other one."""
    here = np.argwhere(touches)
    way, across = np.moveaxis(here[:, np.newaxis] - here, 2, 0)
    size = max(touches.shape)
    table = cell_rises(np.arange(-size, size), np.arange(size), body.decay) * cell / body.conductivity
    return np.asarray(table[way + size, np.abs(across)])


@pytest.mark.parametrize("peclet", DISCS)
def test_a_uniform_disc(peclet: float) -> None:
    heat, cell = disc(CELLS, SIDE), SIDE / CELLS
    rises = rise(heat, Heated(1.0, peclet * cell, 0.0), cell)
    largest, mean = DISCS[peclet]
    assert rises.max() == pytest.approx(largest, rel=5e-3)
    assert rises[heat > 0.0].mean() == pytest.approx(mean, rel=5e-3)


@pytest.mark.parametrize("peclet", [1e3, 1e4, 1e5])
def test_a_fast_disc(peclet: float) -> None:
    """Heat flows straight down: 2 √(1/(π Pe)) where the longest chord ends, and its mean over all chords."""
    heat, cell = disc(CELLS, SIDE), SIDE / CELLS
    rises = rise(heat, Heated(1.0, peclet * cell, 0.0), cell)
    chord = 2.0 * np.sqrt(1.0 - np.linspace(-1.0, 1.0, 20001) ** 2)
    mean = np.mean(chord**1.5) / np.mean(chord) * 2.0 / 3.0 * math.sqrt(2.0 / (math.pi * peclet))
    assert rises.max() == pytest.approx(2.0 / math.sqrt(math.pi * peclet), rel=5e-3)
    assert rises[heat > 0.0].mean() == pytest.approx(mean, rel=1e-2)


@pytest.mark.parametrize("decay", [0.0, 0.01, 0.099, 0.101, 1.0, 30.0])
def test_cells(decay: float) -> None:
    """Against integrals over each cell by points so dense that the cell of the source shows it at 0.1 %."""
    away, across = np.arange(-14, 40), np.arange(14)
    table = cell_rises(away, across, decay)
    points, weights = np.polynomial.legendre.leggauss(200)
    y = np.concatenate([0.25 * (points + 1.0), 0.25 * (points - 1.0)])
    share = np.tile(weights, 2) * 0.25
    for i, j in ((0, 0), (3, 0), (-2, 0), (1, 1), (8, 8), (9, 0), (9, 8), (2, 9), (30, 0), (30, 3), (-12, 5)):
        x, v = i + y[:, np.newaxis], j + y
        distance = np.hypot(x, v)
        late = np.where(x > 0.0, v**2 / (distance + np.abs(x)), distance - x)
        exact = share @ (np.exp(-decay * late) / distance) @ share / (2.0 * math.pi)
        assert table[i + 14, j] == pytest.approx(exact, rel=3e-3, abs=1e-5)


def test_the_wake_does_not_come_round() -> None:
    heat, wide = disc(40, SIDE), np.zeros((200, 80))
    wide[20:60, 20:60] = heat
    for decay in (0.0, 0.3, 3.0):
        body = Heated(1.0, decay, 0.0)
        assert_allclose(rise(wide, body, 1.0)[20:60, 20:60], rise(heat, body, 1.0), atol=1e-9)


@pytest.mark.parametrize(
    "bodies",
    [
        (Heated(1.0, 0.0, 0.0), Heated(3.0, 0.5, 0.0)),
        (Heated(1.0, 0.3, 0.1), Heated(0.2, 5.0, 0.0)),
        (Heated(2.0, 30.0, 0.0), Heated(2.0, 0.0, -0.4)),
        (Heated(400.0, 30.0, 0.0), Heated(0.02, 0.0, 0.0)),
        (Heated(0.02, 0.0, 0.0), Heated(400.0, 30.0, 0.0)),
    ],
)
def test_both_bodies_are_as_hot(bodies: tuple[Heated, Heated]) -> None:
    """Against a dense solve; what does not flow into the one flows into the other."""
    heat = spots().pressure
    into, temperature = shared(heat, list(bodies), cell=0.5, workers=1)
    touches = heat > 0.0
    one, two = (dense(body, touches, 0.5) for body in bodies)
    wanted = two @ heat[touches] + bodies[1].bulk - bodies[0].bulk
    exact = np.linalg.solve(one + two, wanted)
    rise_alone = min(np.abs(body @ heat[touches]).max() for body in (one, two))
    assert np.abs(into[touches] - exact).max() < 5e-3 * np.abs(exact).max()
    assert_allclose(temperature[touches], one @ exact + bodies[0].bulk, atol=1e-3 * rise_alone)
    other = two @ (heat - into)[touches] + bodies[1].bulk
    assert_allclose(other, temperature[touches], atol=1e-3 * rise_alone)
    assert not into[~touches].any()
    assert np.isnan(temperature[~touches]).all()


def test_far_hotter_below() -> None:
    """Of a body that is hotter by far more than friction makes, the contact conducts the difference."""
    heat = spots().pressure
    bodies = [Heated(2.0, 0.3, 0.0), Heated(0.5, 0.0, 1e5)]
    into, _ = shared(1e-3 * heat, bodies, cell=0.5, workers=1)
    touches = heat > 0.0
    exact = np.linalg.solve(sum(dense(body, touches, 0.5) for body in bodies), np.full(touches.sum(), 1e5))
    assert_allclose(into[touches], exact, atol=1e-4 * exact.max())


def test_shares() -> None:
    """At rest by the conductivities; one that moves fast takes most, whichever of them it is."""
    contact = spots()
    numbers: dict[str, Any] = {"diffusivity": 1.0, "friction": 0.5}
    slow = contact.flash(1e-6, conductivity=(1.0, 3.0), **numbers)
    assert slow.share == pytest.approx(0.25, rel=1e-3)
    assert slow.heat.sum() == pytest.approx(0.5e-6 * contact.pressure.sum())
    moved, still = (
        contact.flash(40.0, conductivity=2.0, moving=one, **numbers) for one in ("heights", "counter")
    )
    assert moved.share > 0.8
    assert moved.share + still.share == pytest.approx(1.0, abs=1e-3)
    assert_allclose(moved.temperature, still.temperature, atol=2e-3 * moved.largest)
    assert contact.flash(40.0, conductivity=2.0, threads=2, **numbers).largest == moved.largest
    warm = contact.flash(40.0, conductivity=2.0, bulk=(20.0, 20.0), **numbers)
    assert warm.mean == pytest.approx(20.0 + moved.mean, rel=1e-3)
    sheared = {"diffusivity": 1.0, "shear_strength": 0.1}
    assert contact.flash(2.0, conductivity=2.0, **sheared).heat.sum() * 0.25 == pytest.approx(
        0.2 * contact.area
    )


def test_a_steel_ball() -> None:
    """Blok's rise for equal bodies at rest, 8/3π of Q/(π a k) for each half of a uniform heat's mean."""
    contact = warpwear.solve_contact(
        np.zeros((96, 96)), cell=1e-3, load=3.0, modulus=110e3, counter_radius=1.5
    )
    radius = math.sqrt(contact.area / math.pi)
    hot = contact.flash(1e-3, conductivity=46.0, diffusivity=13.0, shear_strength=300.0)
    power = 300.0 * contact.area * 1e-3
    assert hot.mean == pytest.approx(
        0.5 * 8.0 / (3.0 * math.pi) * power / (math.pi * radius * 46.0), rel=5e-3
    )


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"speed": 0.0}, "speed = 0 is not possible"),
        ({"conductivity": (1.0, -1.0)}, "conductivity = -1 is not possible"),
        ({"conductivity": (1.0, 2.0, 3.0)}, "conductivity = .* is not possible; it must be"),
        ({"diffusivity": "steel"}, "diffusivity = 'steel' is not possible"),
        ({"moving": "disc"}, "moving = 'disc' is unknown"),
        ({"moving": np.ones(2)}, "moving = array.* is unknown"),
        ({"shear_strength": 1.0}, "exactly one of friction and shear_strength"),
        ({"friction": None}, "exactly one of friction and shear_strength"),
    ],
)
def test_what_is_refused(wrong: dict[str, Any], message: str) -> None:
    usual = {"speed": 1.0, "conductivity": 1.0, "diffusivity": 1.0, "friction": 0.5}
    with pytest.raises(InputError, match=message):
        spots().flash(**(usual | wrong))


def test_no_line() -> None:
    line = warpwear.solve_contact(np.zeros((64, 4)), cell=0.1, load=1.0, modulus=100.0, boundary="line")
    with pytest.raises(InputError, match='boundary = "line" is not possible for heat'):
        line.flash(1.0, conductivity=1.0, diffusivity=1.0, friction=0.5)
