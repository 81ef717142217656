"""How hot a finished contact gets that slides is found: its heat is shared so that both bodies are as hot.

The rise at x of a steady source on a half-space that moves with v along +x is ∫ q e^{−a (R − X)}/(2πkR) dA,
R the distance from the source, X the way behind it, a = v/2κ (Jaeger 1942, J. Proc. R. Soc. N. S. W. 76,
203; Tian and Kennedy 1994, J. Tribol. 116, 167).
"""

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from warpwear import lazy
from warpwear.contact.array.arguments import check_choice, number, shape_of, shown
from warpwear.contact.array.found import Flash
from warpwear.engine.device import check_threads
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, IntArray, box_of

fft, special = lazy.module("scipy.fft"), lazy.module("scipy.special")
solvers = lazy.module("scipy.sparse.linalg")

#: Bodies that may move through the contact, which the other one carries along.
MOVING = ("heights", "counter")
#: Cells around a source in which its kernel is integrated, and points of each of them across sliding.
NEAR = 8
POINTS = 24
#: Half the Péclet number of a cell, below which nothing varies within those further away, and the least.
SLOW = 0.1
LEAST = 1.0e-9
#: Difference of the temperatures in contact, over the rise of the body alone that would be less hot, rms.
TOLERANCE = 3.0e-4
#: That difference over the whole, which is more where the bodies are not as hot far below: of 32 bits.
ROUNDING = 1.0e-5


def flash(
    pressure: FloatArray,
    speed: float,
    *,
    cell: float,
    conductivity: float | Sequence[float],
    diffusivity: float | Sequence[float],
    friction: float | None = None,
    shear_strength: float | None = None,
    moving: str = "heights",
    bulk: float | Sequence[float] = 0.0,
    threads: int | None = None,
) -> Flash:
    """Return what `ArrayContact.flash` does, under a pressure of cells."""
    speed = number("speed", speed, optional=False)
    friction, strength = number("friction", friction), number("shear_strength", shear_strength)
    check_choice("exactly one", friction=friction, shear_strength=strength)
    if shape_of(moving) or moving not in MOVING:
        raise InputError(f"moving = {shown(moving)} is unknown; allowed are {' and '.join(MOVING)}.")
    given = {"conductivity": conductivity, "diffusivity": diffusivity, "bulk": bulk}
    constants = []
    for name, one in given.items():
        pair: Any = one if shape_of(one) == (2,) else (one, one)
        constants.append([number(name, value, any_sign=name == "bulk", optional=False) for value in pair])
    bodies = [
        Heated(conducts, (moving == body) * speed * cell / (2.0 * diffuses), far)
        for body, conducts, diffuses, far in zip(MOVING, *constants, strict=True)
    ]
    heat = speed * (friction * pressure if strength is None else np.where(pressure > 0.0, strength, 0.0))
    return Flash(heat, *shared(heat, bodies, cell=cell, workers=check_threads(threads)))


class Heated(NamedTuple):
    """A half-space that heat flows into."""

    conductivity: float
    decay: float  # v/2κ of a body that moves along axis 0, times a cell
    bulk: float  # temperature far below

    def response(self, shape: Sequence[int], workers: int) -> FloatArray:
        """Return the waves of the rise, over the cell, by heat of cells on a padded shape."""
        rows, columns = (size // 2 for size in shape)
        rises = cell_rises(np.arange(-rows, rows), np.arange(columns + 1), self.decay) / self.conductivity
        rises = np.concatenate([rises, rises[:, columns - 1 : 0 : -1]], axis=1)
        return np.asarray(fft.rfft2(fft.ifftshift(rises, axes=0), workers=workers))


def cell_rises(away: IntArray, across: IntArray, decay: float) -> FloatArray:
    """Return 1/2π ∫ e^{−a (R − X)}/R dA over a cell, from 0 on across; X from its middle, cells 1 wide.

    Far behind it in parabolas, √(R ± X), across which the integral is of an exponential of a square.
    """
    x, y = away[:, np.newaxis].astype(np.float64), across.astype(np.float64)
    distance = np.hypot(x, y)
    late = np.where(x > 0.0, y**2 / np.maximum(distance + x, 1.0), distance - x)
    values = np.exp(-decay * late) / np.maximum(distance, 1.0)
    if decay >= SLOW:
        x = x[away >= 0]
        edges = np.arange(across[-1] + 2) - 0.5
        parabola = special.erf(np.sqrt(decay) * edges / np.sqrt(np.hypot(x, edges) + x))
        width = np.sqrt(np.maximum(np.hypot(x, y) + x, 1.0))
        values[away >= 0] = np.sqrt(np.pi / decay) * np.diff(parabola, axis=1) / width
    near = np.abs(away) <= NEAR
    values[near, : NEAR + 1] = _near_rises(max(decay, LEAST))[away[near] + NEAR, : across.size]
    return values / (2.0 * np.pi)


def _near_rises(decay: float) -> FloatArray:
    """Return ∫ e^{−a (R − X)}/R dA over the cells up to `NEAR` away: along X it is exact, E₁(a (R − X)).

    From the middle outwards, where that is a logarithm, points across lie as the fifth powers of Gauss's.
    """
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    y = np.concatenate([[0.5 * points**5], np.arange(1, NEAR + 1)[:, np.newaxis] - 0.5 + points])
    shares = np.concatenate([[5.0 * points**4 * weights], np.tile(weights, (NEAR, 1))])
    x = (np.arange(-NEAR, NEAR + 2) - 0.5)[:, np.newaxis, np.newaxis]
    distance = np.hypot(x, y)
    late = np.where(x > 0.0, y**2 / (distance + np.maximum(x, 0.0)), distance - x)
    return np.asarray(np.sum(np.diff(special.exp1(decay * late), axis=0) * shares, axis=-1))


def shared(
    heat: FloatArray, bodies: list[Heated], *, cell: float, workers: int
) -> tuple[FloatArray, FloatArray]:
    """Return the heat that flows into the first body, and the temperature where there is any heat.

    There both bodies are as hot. heat: of each cell, a power over an area, 0 where nothing touches.
    """
    into, temperature, box = np.zeros(heat.shape), np.full(heat.shape, np.nan), box_of(heat > 0.0)
    if box is None:
        return into, temperature
    window = slice(box[0], box[1] + 1), slice(box[2], box[3] + 1)
    heat = heat[window]
    part, touches, size = heat.shape, heat > 0.0, float(heat.max())
    half = [fft.next_fast_len(n, real=True) for n in part]
    padded = [2 * n for n in half]
    responses = [body.response(padded, workers).astype(np.complex64) for body in bodies]
    field = np.zeros(part, dtype=np.float32)  # whose rounding is far below the tolerance

    def applied(spectrum: Any, shape: list[int], values: FloatArray) -> FloatArray:
        field[touches] = values
        waves = fft.rfft2(field, s=shape, workers=workers)
        waves *= spectrum
        return np.asarray(fft.irfft2(waves, s=shape, workers=workers)[: part[0], : part[1]][touches])

    alone = [applied(waves, padded, heat[touches] / size) for waves in responses]
    # What is found flows into the body that would be hotter alone: less than half, maybe a ten thousandth.
    hotter = int(np.linalg.norm(alone[1]) > np.linalg.norm(alone[0]))
    wanted = alone[1 - hotter]
    allowed = TOLERANCE * float(np.linalg.norm(wanted))
    wanted += (bodies[1 - hotter].bulk - bodies[hotter].bulk) / (size * cell)
    both = responses[0] + responses[1]
    # Every other wave is one of what comes round on half of the shape: about its inverse, for a quarter.
    makes, inverts = (
        solvers.LinearOperator((wanted.size, wanted.size), partial(applied, waves, shape))
        for waves, shape in ((both, padded), (1.0 / both[::2, ::2], half))
    )
    limits = {"rtol": ROUNDING, "atol": allowed, "restart": 60, "maxiter": 5}
    flow, failed = solvers.gmres(makes, wanted, M=inverts, **limits)
    if failed:
        raise ConvergenceError("the temperatures of both bodies in contact could not be made the same.")
    into[window][touches] = heat[touches] - flow * size if hotter else flow * size
    temperature[window][touches] = applied(responses[hotter], padded, flow) * (size * cell)
    temperature += bodies[hotter].bulk
    return into, temperature
