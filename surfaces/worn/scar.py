"""Roughness of worn heights in the middle of a scar, once the form that wear gave them is gone."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.roughness import bearing_parameters, height_parameters
from warpwear.surfaces.spectrum import Spectrum, power_spectrum

#: Parameters of `roughness_without_form` that are lengths.
LENGTHS = ("sa", "sq", "sk", "spk", "svk")
#: A worn scar is a bowl, a groove a trough: a polynomial of this degree is taken off as their form.
FORM_DEGREE = 2
#: Total degree of the form of both bodies alike: it also holds how a scar flattens towards its rim.
FINE_DEGREE = 4
#: Cells along the shorter side of a field that its form is fitted to, about.
FITTED = 100
#: A part of fewer cells has no roughness worth a number.
FEWEST_CELLS = 100


def ellipse(shape: tuple[int, int], *, size: float = 1.0) -> BoolArray:
    """Return which cells of a field lie in the ellipse of this part of its length and width, (nx, ny)."""
    x, y = (np.linspace(-1.0, 1.0, 2 * n + 1)[1::2] for n in shape)
    return np.asarray(np.add.outer(np.square(x), np.square(y)) <= size**2)


def roughness_without_form(heights: FloatArray, inside: BoolArray) -> dict[str, float]:
    """Return Sa, Sq, Sk, Spk, Svk [µm] and Ssk of worn heights [mm] less their form.

    They are of the cells inside; NaN where too few cells are inside.
    """
    if np.count_nonzero(inside & np.isfinite(heights)) < FEWEST_CELLS:
        return dict.fromkeys((*LENGTHS, "ssk"), np.nan)
    level = without_polynomial(heights, degree=FORM_DEGREE, where=inside)[inside]
    parameters = height_parameters(level) | vars(bearing_parameters(level))
    return {name: 1.0e3 * parameters[name] for name in LENGTHS} | {"ssk": parameters["ssk"]}


@dataclass(frozen=True)
class Texture:
    """Roughness of one field once its form is gone; NaN where too few cells are there."""

    sq: float = math.nan  # [mm]
    sdq: float = math.nan  # rms gradient (ISO 25178-2)
    rq: float = math.nan  # of the profiles along sliding, each without its form [mm]


def texture(heights: FloatArray, *, cell: float) -> Texture:
    """Return the roughness of heights in the ellipse of their field.

    heights [mm], shape (nx, ny), NaN where missing; cell: their pitch [mm]. A polynomial of total degree
    `FINE_DEGREE` is taken off first, fitted to every n-th cell of a large field. Rq is of whole profiles of
    the field along its first axis, each less a polynomial of this degree of its own: ridges that a rough
    counterbody ploughs along sliding are no part of it.
    """
    inside = ellipse((heights.shape[0], heights.shape[1])) & np.isfinite(heights)
    if np.count_nonzero(inside) < FEWEST_CELLS:
        return Texture()
    every = max(min(heights.shape) // FITTED, 1)
    level = without_polynomial(heights, degree=FINE_DEGREE, where=inside, every=every)
    level -= level.mean(where=inside)
    sq = math.sqrt(float(np.square(level).mean(where=inside)))
    slopes = 0.0
    for axis in (0, 1):
        both = inside[1:] & inside[:-1] if axis == 0 else inside[:, 1:] & inside[:, :-1]
        slopes += float(np.square(np.diff(level, axis=axis)).mean(where=both)) / cell**2
    basis, _ = np.linalg.qr(legendre.legvander(np.linspace(-1.0, 1.0, heights.shape[0]), FINE_DEGREE))
    # sums by einsum, in one order whatever the threads of BLAS
    rest = heights - np.einsum("xi,iy->xy", basis, np.einsum("xi,xy->iy", basis, heights))
    return Texture(sq, math.sqrt(slopes), math.sqrt(float(np.square(rest).mean())))


def fine_spectrum(heights: FloatArray, *, cell: float) -> Spectrum | None:
    """Return the power spectrum over all directions of a field of heights [mm], shape (nx, ny), form removed.

    None where cells are missing or too few.
    """
    if heights.size < FEWEST_CELLS or not np.isfinite(heights).all():
        return None
    return power_spectrum(without_polynomial(heights, degree=FINE_DEGREE), pixel=(cell, cell))
