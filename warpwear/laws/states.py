"""Friction of three states: under a film, of bare metal, of metal under a cover of debris or oxide.

db/dN = (1 − b)(e + r b): the share b loses its film, on its own by e and by bare metal beside it by r.
dc/dN = k (b − c): the share c of it is covered. b has a closed form, b − c takes one quadrature.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from warpwear.grid import FloatArray

#: Points and weights of the quadrature, eight at a time: courses are short, samples of them many.
_POINTS, _WEIGHTS = np.reshape(np.polynomial.legendre.leggauss(96), (2, 12, 8))
#: Exponent beyond which what is left out is below 1e-10.
BEYOND = 23.5


class Shares(NamedTuple):
    """Shares of the load that film, bare metal and cover bear; they add up to 1."""

    filmed: FloatArray
    metal: FloatArray
    covered: FloatArray


def shares(count: FloatArray, *, rate: Any, middle: Any, cover_rate: Any) -> Shares:
    """Return the shares after a count N of laps or mm.

    rate: r + e per lap or mm; middle: ln(r/e), for e may be smaller than any number; cover_rate: k. Numbers,
    or arrays that broadcast with the count.
    """
    place, cover, both = rate * count, cover_rate / rate, 1.0 + np.exp(-middle)
    filmed = both / (1.0 + np.exp(np.minimum(place - middle, 700.0)))
    # b − c = ∫ e^(−k(N − s)) b'(s) ds where both factors are not nothing, in lengths of 1/(r + e)
    low = np.maximum(np.maximum(middle - BEYOND, 0.0), place - BEYOND / np.maximum(cover, 1e-300))
    high = np.maximum(np.minimum(place, np.maximum(middle, 0.0) + BEYOND), low)
    metal: Any = 0.0
    first, last, here, cover, middle = (
        end[..., None] for end in np.broadcast_arrays(low, high, place, cover, middle)
    )
    for points, weights in zip(_POINTS, _WEIGHTS, strict=True):
        at = 0.5 * (first + last) + 0.5 * points * (last - first)
        slope = np.exp(-np.abs(at - middle))
        faded = np.exp(np.minimum(cover * (at - here), 0.0))  # before the wait there is nothing to fade
        terms = weights * faded * slope / (1.0 + slope) ** 2
        metal = metal + terms.sum(axis=-1)
    metal = 0.5 * (high - low) * metal * both
    return Shares(filmed, metal, 1.0 - filmed - metal)


def wait_and_width(*, rate: Any, middle: Any) -> tuple[Any, Any]:
    """Return after how many laps or mm half has lost its film, and how many it takes from 10 to 90 %.

    rate, middle: as of `shares`.
    """
    wait, width = np.logaddexp(math.log(2.0), middle), np.log(9.0)
    width += np.logaddexp(0.0, middle + math.log(0.9)) - np.logaddexp(0.0, middle + math.log(0.1))
    return wait / rate, width / rate
