"""The half-space by dense matrices, and a bound-constrained least-squares solve; shared by tests."""

import math
from functools import cache

import numpy as np
from scipy.optimize import lsq_linear

from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.grid import FloatArray, Grid

MODULUS = 3.0


def rough(grid: Grid, *, seed: int = 1, rms: float = 1.0, shortest: int = 4) -> FloatArray:
    """A periodic gap of random long waves [mm]."""
    generator = np.random.default_rng(seed)
    i = np.fft.fftfreq(grid.nx, 1.0 / grid.nx)[:, np.newaxis]
    j = np.fft.rfftfreq(grid.ny, 1.0 / grid.ny)
    waves = np.hypot(i, j)
    amplitude = np.where((waves > 0.0) & (waves <= shortest), np.maximum(waves, 1.0) ** -1.8, 0.0)
    phase = generator.standard_normal(waves.shape) + 1j * generator.standard_normal(waves.shape)
    gap = np.fft.irfft2(amplitude * phase, s=grid.shape)
    return np.asarray(gap * rms / gap.std())


def dense_free(grid: Grid) -> FloatArray:
    """Influence of every cell on every other, by the logarithms of Johnson's eq. 3.25."""
    return _of_squares(grid).copy()


@cache
def _of_squares(grid: Grid) -> FloatArray:
    x, y = (c.ravel() for c in np.meshgrid(grid.x, grid.y, indexing="ij"))
    return _of_square(np.subtract.outer(x, x), np.subtract.outer(y, y), 0.5 * grid.cell)


def _of_square(dx: FloatArray, dy: FloatArray, h: float) -> FloatArray:
    """Displacement at a distance from a square of side 2 h under a unit pressure."""

    def part(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
        """a ln((b + …)/(c + …)) of the square's side at distance a."""
        return np.asarray(a * np.log((b + np.hypot(a, b)) / (c + np.hypot(a, c))))

    total = part(dx + h, dy + h, dy - h) + part(dy + h, dx + h, dx - h)
    total += part(dx - h, dy - h, dy + h) + part(dy - h, dx - h, dx + h)
    return np.asarray(total / (math.pi * MODULUS))


def dense_line(grid: Grid, datum: float | None = None) -> FloatArray:
    """Influence of every cell on every other where each repeats across: of thousands of images, extrapolated.

    datum: distance at which a line of pressure displaces nothing; by default the length along x.
    """
    return _of_images(grid, grid.nx * grid.cell if datum is None else datum).copy()


@cache
def _of_images(grid: Grid, datum: float) -> FloatArray:
    """What is left out beyond n images goes as the square of 1/(n + 1/2): two sums tell it."""
    h, period = grid.cell, grid.ny * grid.cell
    x, y = np.arange(grid.nx) * h, np.arange(grid.ny) * h
    nearest = -(-300 // grid.ny)
    places = np.arange(-nearest, nearest + 1)[:, np.newaxis, np.newaxis] * period
    total, sums = _of_square(x[:, np.newaxis], np.abs(y + places), 0.5 * h).sum(axis=0), []
    count = -(-16000 // grid.ny)
    for images in (count, 2 * count):
        places = np.arange(nearest + 1, images + 1)[:, np.newaxis, np.newaxis] * period
        for side in (-1.0, 1.0):
            r = np.hypot(x[:, np.newaxis], y + side * places)
            # a square's, of which the next term is of the fourth order
            part = (h**2 / r + h**4 / (24.0 * r**3)).sum(axis=0)
            sums.append(part - h**2 / period * math.log(2.0 * (images + 0.5) * period / datum))
    lesser, greater = sums[0] + sums[1], sums[2] + sums[3]
    ratio = ((2 * count + 0.5) / (count + 0.5)) ** 2
    total += (greater + (greater - lesser) / (ratio - 1.0)) / (math.pi * MODULUS)
    i, j = np.indices(grid.shape).reshape(2, -1)
    away = np.abs(np.subtract.outer(i, i)), np.abs(np.subtract.outer(j, j))
    return np.asarray(total[away])


def dense_of(grid: Grid, boundary: str) -> FloatArray:
    """Influence of every cell on every other by the boundary's name."""
    return {"free": dense_free, "periodic": dense_periodic, "line": dense_line}[boundary](grid)


def dense_periodic(grid: Grid) -> FloatArray:
    """Influence of every cell on every other in an endless row of grids, by a sum over waves.

    The mean of the displacement is left out.
    """
    return _sum_over_waves(grid).copy()


@cache
def _sum_over_waves(grid: Grid) -> FloatArray:
    x, y = (c.ravel() for c in np.meshgrid(grid.x, grid.y, indexing="ij"))
    total = np.zeros((grid.cells, grid.cells))
    for i in range(-(grid.nx // 2), (grid.nx + 1) // 2):
        for j in range(-(grid.ny // 2), (grid.ny + 1) // 2):
            if (i, j) != (0, 0):
                p, q = 2 * math.pi * i / (grid.nx * grid.cell), 2 * math.pi * j / (grid.ny * grid.cell)
                wave = np.cos(p * np.subtract.outer(x, x) + q * np.subtract.outer(y, y))
                total += wave * 2.0 / (MODULUS * math.hypot(p, q) * grid.cells)
    return total


def dense_streak(grid: Grid, boundary: str, window: int | None) -> FloatArray:
    """S twice, the mean along x over a window, or of the line; rows of a free grid end in empty ones."""
    if window is None or window > grid.nx:
        mean = np.full((grid.nx, grid.nx), 1.0 / grid.nx)
    else:
        half, around = window // 2, window + 1 - window % 2
        weights = np.full(around, 1.0 / window)
        if window % 2 == 0:
            weights[[0, -1]] /= 2.0
        mean = np.zeros((grid.nx, grid.nx + 2 * half))
        for row in range(grid.nx):
            mean[row, row : row + around] = weights
        if boundary == "periodic":
            inner = mean[:, half : half + grid.nx].copy()
            inner[:, -half:] += mean[:, :half]
            inner[:, :half] += mean[:, -half:]
            mean = inner
    return np.kron(mean @ mean.T, np.eye(grid.ny))


def bounded(matrix: FloatArray, gap: FloatArray, approach: float, hardness: float) -> FloatArray:
    """argmin ½ p·Gp + p·(g − δ), 0 ≤ p ≤ H, by active sets."""
    root = np.linalg.cholesky(matrix).T
    right = np.linalg.solve(root.T, approach - gap.ravel())
    found = lsq_linear(root, right, bounds=(0.0, hardness), method="bvls", tol=1e-15, max_iter=5000)
    return np.asarray(found.x.reshape(gap.shape))


def area_fraction_of(contact: HalfSpaceContact) -> float:
    """The contact area over the nominal one."""
    return contact.cells_in_contact / contact.executor.grid.cells


def separation_of(contact: HalfSpaceContact) -> FloatArray:
    """The gap left by deformation and implicit wear [mm]; negative where p = H."""
    return np.asarray(contact.executor.to_numpy(contact.gradient_field) - contact.approach)
