"""Roughness of worn heights in the middle of a scar, once the form that wear gave them is gone."""

import math

import numpy as np

from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.roughness import bearing_parameters, height_parameters, rms_slope
from warpwear.surfaces.spectrum import Spectrum, power_spectrum

#: Parameters of `roughness_without_form` that are lengths.
LENGTHS = ("sa", "sq", "sk", "spk", "svk")
#: A worn scar is a bowl, a groove a trough: a polynomial of this degree is taken off as their form.
FORM_DEGREE = 2
#: Total degree of the form of both bodies alike: it also holds how a scar flattens towards its rim.
FINE_DEGREE = 4
#: A part of fewer cells has no roughness worth a number.
FEWEST_CELLS = 100


def ellipse(shape: tuple[int, int], *, size: float = 1.0) -> BoolArray:
    """Return which cells of a field lie in the ellipse of this part of its length and width, (nx, ny)."""
    x, y = (np.linspace(-1.0, 1.0, 2 * n + 1)[1::2] for n in shape)
    return np.asarray(np.add.outer(np.square(x), np.square(y)) <= size**2)


def roughness_without_form(heights: FloatArray, inside: BoolArray) -> dict[str, float]:
    """Sa, Sq, Sk, Spk, Svk [µm] and Ssk of worn heights [mm], of the cells inside, once their form is gone.

    NaN where too few cells are inside.
    """
    if np.count_nonzero(inside) < FEWEST_CELLS:
        return dict.fromkeys((*LENGTHS, "ssk"), np.nan)
    level = without_polynomial(heights, degree=FORM_DEGREE, where=inside)[inside]
    found = height_parameters(level) | vars(bearing_parameters(level))
    return {name: 1.0e3 * found[name] for name in LENGTHS} | {"ssk": found["ssk"]}


def texture(heights: FloatArray, *, cell: float) -> tuple[float, float]:
    """Return Sq [mm] and the rms gradient Sdq (ISO 25178-2) in the ellipse of a field of heights.

    heights [mm], shape (nx, ny), NaN where missing; cell: their pitch [mm]. A polynomial of `FINE_DEGREE` is
    taken off first. NaN twice where too few cells are there.
    """
    inside = ellipse((heights.shape[0], heights.shape[1])) & np.isfinite(heights)
    if np.count_nonzero(inside) < FEWEST_CELLS:
        return math.nan, math.nan
    level = np.where(inside, without_polynomial(heights, degree=FINE_DEGREE, where=inside), np.nan)
    return height_parameters(level)["sq"], rms_slope(level, pixel=(cell, cell))


def fine_spectrum(heights: FloatArray, *, cell: float) -> Spectrum | None:
    """Return the power spectrum over all directions of a field of heights [mm], shape (nx, ny), form removed.

    None where cells are missing or too few.
    """
    if heights.size < FEWEST_CELLS or not np.isfinite(heights).all():
        return None
    return power_spectrum(without_polynomial(heights, degree=FINE_DEGREE), pixel=(cell, cell))
