"""Cases that tests of solve_tangential share: a ball and its closed forms, and a dense reference."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from warpwear import ArrayContact, solve_contact
from warpwear.grid import FloatArray, Grid

#: A ball of steel: radius, load, Young's modulus, Poisson's ratio, friction.
RADIUS, LOAD, YOUNG, POISSON, FRICTION = 5.0, 20.0, 210e3, 0.3, 0.6
MODULUS = YOUNG / (2.0 * (1.0 - POISSON**2))
#: Radius of the contact and largest pressure of Hertz's.
CONTACT_RADIUS = (3.0 * LOAD * RADIUS / (4.0 * MODULUS)) ** (1.0 / 3.0)
LARGEST = 1.5 * LOAD / (math.pi * CONTACT_RADIUS**2)


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


@cache
def ball(cells: int, device: str = "cpu") -> ArrayContact:
    """The ball pressed on cells along each side of 2.6 contact radii."""
    heights = -squares(cells, 2.6 * CONTACT_RADIUS / cells) / (2.0 * RADIUS)
    return pressed(heights, 2.6 * CONTACT_RADIUS / cells, LOAD, MODULUS, tolerance=1e-9, device=device)


def pressed(heights: FloatArray, cell: float, load: float, modulus: float, **options: Any) -> ArrayContact:
    """A plane on a free half-space."""
    return solve_contact(heights, cell=cell, load=load, modulus=modulus, boundary="free", **options)


def squares(cells: int, cell: float) -> FloatArray:
    """Squared distances of cells from the middle."""
    x = cell * (np.arange(cells) - 0.5 * (cells - 1))
    return np.asarray(np.add.outer(x**2, x**2))


def softness(poisson: float) -> float:
    """C = Σ (2 − ν)/G of two bodies alike, with the modulus of the ball."""
    return 2.0 * (2.0 - poisson) / ((1.0 - poisson) * MODULUS)


def at_sliding(poisson: float) -> float:
    """Displacement at which the ball slides (Mindlin), and the unit of those below."""
    return 3.0 * FRICTION * LOAD * softness(poisson) / (16.0 * CONTACT_RADIUS)


def dense(grid: Grid, modulus: float, excess: float) -> FloatArray:
    """Tangential displacements of all cells by tractions on all, first along x, then along y.

    By integrals over squares: with corners X, Y at distance R those of 1/r, x²/r³, y²/r³ and xy/r³ are sums
    of X ln(Y + R) + Y ln(X + R), Y ln(X + R), X ln(Y + R) and −R.
    """
    x, y = (c.ravel() for c in np.meshgrid(grid.x, grid.y, indexing="ij"))
    dx, dy, half = np.subtract.outer(x, x), np.subtract.outer(y, y), 0.5 * grid.cell
    along, across, aside = np.zeros_like(dx), np.zeros_like(dx), np.zeros_like(dx)
    for side in (1.0, -1.0):
        for other in (1.0, -1.0):
            at_x, at_y = dx + side * half, dy + other * half
            far = np.hypot(at_x, at_y)
            along += side * other * at_y * _log(at_x, far, at_y)
            across += side * other * at_x * _log(at_y, far, at_x)
            aside -= side * other * far
    normal = along + across
    rows = [[normal + excess * along, excess * aside], [excess * aside, normal + excess * across]]
    return np.block(rows) / (math.pi * modulus)


def _log(a: FloatArray, far: FloatArray, other: FloatArray) -> FloatArray:
    """ln(a + R), for a < 0 without cancellation."""
    return np.where(a >= 0.0, np.log(np.abs(a) + far), np.log(other**2) - np.log(np.abs(a) + far))


def accelerated(matrix: FloatArray, push: FloatArray, bound: FloatArray, steps: int = 20_000) -> FloatArray:
    """Least ½ q·Aq − q·push under |q_i| ≤ c_i (Beck and Teboulle 2009), restarted where a step turns back.

    push: shape (2, n). bound: shape (n,).
    """
    length = 1.0 / np.linalg.eigvalsh(matrix)[-1]
    q, ahead, momentum = np.zeros_like(push), np.zeros_like(push), 1.0
    for _ in range(steps):
        stepped = ahead - length * ((matrix @ ahead.ravel()).reshape(2, -1) - push)
        size = np.hypot(*stepped)
        new = stepped * np.minimum(1.0, bound / np.maximum(size, 1e-300))
        if ((ahead - new) * (new - q)).sum() > 0.0:
            momentum = 1.0
        grown = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * momentum**2))
        ahead = new + (momentum - 1.0) / grown * (new - q)
        done, q, momentum = float(np.abs(new - q).max()), new, grown
        if done < 1e-16 * bound.max():
            return q
    raise AssertionError(f"the reference still moves by {done:g}")
