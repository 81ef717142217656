"""Friction of three states: under a film, of bare metal, of metal under a cover of debris or oxide.

db/dN = (1 − b)(e + r b): the share b loses its film, on its own by e and by bare metal beside it by r.
dc/dN = k (b − c): the share c of it is covered. b has a closed form, b − c takes one quadrature.
"""

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


def shares(count: FloatArray, *, spread: Any, seed: Any, cover_rate: Any) -> Shares:
    """Return the shares after a count N of laps or mm.

    spread r, seed e, cover_rate k: per lap or mm, numbers or arrays that broadcast with the count.
    """
    rate, ratio = spread + seed, spread / seed
    place = rate * count
    filmed = (1.0 + ratio) * np.exp(-place) / (1.0 + ratio * np.exp(-place))
    # b − c = ∫ e^(−k(N − s)) b'(s) ds where both factors are not nothing, in lengths of 1/(r + e)
    cover, middle = cover_rate / rate, np.log(ratio)
    low = np.maximum(np.maximum(middle - BEYOND, 0.0), place - BEYOND / np.maximum(cover, 1e-300))
    high = np.maximum(np.minimum(place, np.maximum(middle, 0.0) + BEYOND), low)
    metal: Any = 0.0
    first, last, here, cover, middle = (
        end[..., None] for end in np.broadcast_arrays(low, high, place, cover, middle)
    )
    for points, weights in zip(_POINTS, _WEIGHTS, strict=True):
        at = 0.5 * (first + last) + 0.5 * points * (last - first)
        slope = np.exp(-np.abs(at - middle))
        terms = weights * np.exp(cover * (at - here)) * slope / (1.0 + slope) ** 2
        metal = metal + terms.sum(axis=-1)
    metal = 0.5 * (high - low) * metal * (1.0 + 1.0 / ratio)
    return Shares(filmed, metal, 1.0 - filmed - metal)


def wait_and_width(*, spread: Any, seed: Any) -> tuple[Any, Any]:
    """Return after how many laps or mm half has lost its film, and how many it takes from 10 to 90 %."""
    rate, ratio = spread + seed, spread / seed
    return np.log(2.0 + ratio) / rate, np.log(9.0 * (1.0 + 0.9 * ratio) / (1.0 + 0.1 * ratio)) / rate
