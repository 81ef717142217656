"""A half-space under pressures that repeat across sliding without end, and end along it: line contacts.

The surface sinks as a logarithm of the distance, which has no limit far away: it counts from that at a datum.
"""

import math

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray, blocks_of_rows

fft = lazy.module("scipy.fft")
special = lazy.module("scipy.special")

#: Images of a cell on either side that are added one by one, and the cells that they span at least.
IMAGES, SPAN = 8, 24
#: Terms of the sum over all further images beside its integral (Euler and Maclaurin).
TERMS = 6
#: Places in a far cell, over its width, and the parts of the pressure there: Gauss's of degree five.
PLACES, PARTS = (-0.5 * math.sqrt(0.6), 0.0, 0.5 * math.sqrt(0.6)), (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def line_quarter(cell: float, modulus: float, shape: tuple[int, int], datum: float) -> FloatArray:
    """Return responses of modes [mm/MPa], a quarter of an even table: (shape[0]//2 + 1, shape[1]//2 + 1).

    shape: even along; across it is the period, in cells. datum: see `line_coefficients`.
    """
    rows, columns = shape[0] // 2 + 1, shape[1]
    coefficients = line_coefficients(cell, modulus, rows, columns, datum)
    across = np.minimum(np.arange(columns), columns - np.arange(columns))
    spectrum = fft.rfft(coefficients[:, across], axis=1).real
    return np.ascontiguousarray(fft.dct(spectrum, type=1, axis=0))


def line_coefficients(cell: float, modulus: float, rows: int, period: int, datum: float) -> FloatArray:
    """Return displacements at a cell's centre under unit pressures on others [mm/MPa], by distance in cells.

    All images of the cell across, a period of cells apart, press as well: their sum is that of Love's cells
    (Johnson, Contact Mechanics, 1985, eq 3.25) less a constant, by which a line of pressure, the mean across,
    displaces nothing at the datum [mm] from it: 2 P'/(π E*) ln(datum/x). Shape (rows, period//2 + 1).
    """
    blocks = blocks_of_rows(rows, values=(2 * _images(period) + 1) * period)
    near = [_near(range(rows)[block], period) for block in blocks]
    total = np.concatenate(near) + _far(rows, period, datum / cell)
    return np.asarray(total * (cell / (math.pi * modulus)))


def _images(period: int) -> int:
    """Return the images of a cell on either side that are added one by one."""
    return max(IMAGES, -(-SPAN // period))


def _near(rows: range, period: int) -> FloatArray:
    """Return what cells and their next images add, in cells times π E*, of some rows."""
    images = _images(period)
    corners_x = (np.arange(rows.start, rows.stop + 1) - 0.5)[:, np.newaxis]
    first = -images * period
    corners_y = np.arange(first, (images + 1) * period + 1) - 0.5
    by_y, by_x = np.arcsinh(corners_y / np.abs(corners_x)), np.arcsinh(corners_x / np.abs(corners_y))
    corner = corners_x * by_y + corners_y * by_x
    cells = np.diff(np.diff(corner, axis=0), axis=1)
    # Places across that differ by a period are images of each other.
    by_image = cells.reshape(len(rows), 2 * images + 1, period)
    return np.asarray(by_image.sum(axis=1)[:, : period // 2 + 1])


def _far(rows: int, period: int, datum: float) -> FloatArray:
    """Return what all further images add, in cells times π E*: one point for each of nine parts of a cell."""
    x, y = np.arange(rows, dtype=np.float64)[:, np.newaxis], np.arange(period // 2 + 1, dtype=np.float64)
    images, total = _images(period), np.zeros((rows, y.size))
    for place, part in zip(PLACES, PARTS, strict=True):
        for place_across, part_across in zip(PLACES, PARTS, strict=True):
            for side in (-1.0, 1.0):
                begin = (images + 0.5) * period + side * (y - place_across)
                total += part * part_across * _beyond(x - place, begin, float(period), datum)
    return total


def _beyond(x: FloatArray, begin: FloatArray, step: float, datum: float) -> FloatArray:
    """Return the sum of 1/r over points beside a line, `step` apart, the first half a step beyond `begin`.

    Without the constant that makes it endless: the integral and its corrections, whose derivatives are those
    of 1/r along y, (−1)ⁿ n! Pₙ(y/r)/rⁿ⁺¹.
    """
    r = np.hypot(x, begin)
    total = np.log(datum / (begin + r)) / step
    for term in range(1, TERMS + 1):
        # B_2k(1/2)/(2k)! times the derivative of order 2k − 1
        factor = (2.0 ** (1 - 2 * term) - 1.0) * special.bernoulli(2 * term)[-1] / (2 * term)
        total += factor * special.eval_legendre(2 * term - 1, begin / r) / r * (step / r) ** (2 * term - 1)
    return np.asarray(total)
