"""Which input decides an output: Sobol's indices of a Saltelli design, with bootstrap intervals."""

from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

stats = lazy.module("scipy.stats")

#: Part of the bootstrap's indices that an interval holds.
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Indices:
    """Sobol's indices of one output, each of shape (factors,), with the ends of their intervals (2, factors).

    first: the part of the output's variance that an input explains by itself; total: the part that goes when
    it alone is known, interactions included.
    """

    first: FloatArray
    total: FloatArray
    first_interval: FloatArray
    total_interval: FloatArray


def sobol(values: FloatArray, factors: int) -> Indices:
    """Sobol's indices of the outputs of a Saltelli design (`Design.unit_samples`), shape (runs,).

    Estimators of Saltelli (2010) and Jansen, as `scipy.stats.sobol_indices` has them; its bootstrap gives
    intervals of 95 %. Samples with a value that is not finite are left out, in all of their runs.
    """
    blocks = values.reshape(factors + 2, -1)
    known = np.isfinite(blocks).all(axis=0)
    blocks = blocks[:, known]
    count = blocks.shape[1]
    if count < 2 or np.ptp(blocks) == 0.0:
        nothing = np.full(factors, np.nan)
        return Indices(nothing, nothing, np.tile(nothing, (2, 1)), np.tile(nothing, (2, 1)))
    # Saltelli's estimators lose digits where the mean is large beside the scatter.
    blocks = blocks - blocks[:2].mean()
    outputs = {"f_A": blocks[:1], "f_B": blocks[1:2], "f_AB": blocks[2:, None, :]}
    found = stats.sobol_indices(func=outputs, n=count)
    drawn = found.bootstrap(confidence_level=CONFIDENCE)
    first, total = drawn.first_order.confidence_interval, drawn.total_order.confidence_interval
    return Indices(
        np.asarray(found.first_order).ravel(),
        np.asarray(found.total_order).ravel(),
        np.stack([np.ravel(first.low), np.ravel(first.high)]),
        np.stack([np.ravel(total.low), np.ravel(total.high)]),
    )
