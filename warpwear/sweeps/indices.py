"""Which input decides an output: Sobol's indices of a Saltelli design, with their intervals."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray

special = lazy.module("scipy.special")

#: Probability that an interval holds an index.
CONFIDENCE = 0.95
#: Parts of the design that stand for other designs, each a scrambled one of its own size.
PARTS = 8
#: Farther end of an interval from which an index is known well enough to set inputs in order.
WELL_KNOWN = 0.1


@dataclass(frozen=True)
class Indices:
    """Hold Sobol's indices of one output, (factors,) each, and the ends of the totals' intervals.

    first: the part of the output's variance that goes when an input alone is known; total: the part that
    would be left if all others were known, interactions included. Those of few samples may exceed 1.
    total_interval: (2, factors). samples: of the design, (keys + 2) runs each.
    """

    first: FloatArray
    total: FloatArray
    total_interval: FloatArray
    samples: int = 0

    def total_in_words(self, place: int) -> str:
        """Write a total index with its interval, cut off at 0 and 1: it is a part of a variance."""
        interval = self.total_interval[:, place]
        value, low, high = np.clip([self.total[place], *interval], 0.0, 1.0)
        return f"{value:.2f} ({low:.2f} to {high:.2f})"

    @property
    def doubt(self) -> str:
        """Where total indices are not well known, a sentence with the samples that it takes; else empty."""
        half = float(np.max(np.abs(self.total_interval - self.total)))
        if not half > WELL_KNOWN:
            return ""
        needed = 2 ** math.ceil(math.log2(self.samples * half / WELL_KNOWN))  # errors go as 1/n, not as 1/√n
        return (
            f"{self.samples} samples tell total indices to ± {half:.2g} only (95 %): about {needed} samples "
            f"tell them to ± {WELL_KNOWN:g}."
        )


def sobol(values: FloatArray, factors: int) -> Indices:
    """Sobol's indices of the outputs of a Saltelli design (`Design.unit_samples`), shape (runs,).

    Samples with a value that is not finite are left out, in all of their runs, which
    `scipy.stats.sobol_indices` does not allow. Estimators (b) and (f) of Saltelli et al. 2010,
    doi:10.1016/j.cpc.2009.09.018, table 2; the mean is taken off, as a large one costs digits (Sobol and
    Levitan 1999). Intervals are Student's, of the logarithm, by the parts of the design in their order: each
    is a scrambled design by itself, and the whole is no worse than independent ones.
    """
    blocks = values.reshape(factors + 2, -1)
    blocks = blocks[:, np.isfinite(blocks).all(axis=0)]
    count = blocks.shape[1]
    if count < 2 or np.ptp(blocks) == 0.0:
        nothing = np.full((2, factors), np.nan)
        return Indices(nothing[0], nothing[0], nothing, count)
    centred = blocks - blocks[:2].mean()
    a, b, mixed = centred[0], centred[1], centred[2:]
    with np.errstate(all="ignore"):  # of a few samples A and B may all be one
        first, total = b * (mixed - a) / centred[:2].var(), 0.5 * (a - mixed) ** 2 / centred[:2].var()
        index = total.mean(axis=1)
        off = total - index[:, None] * 0.5 * (a**2 + b**2) / centred[:2].var()
        parts = np.array_split(off, min(PARTS, max(count // 2, 2)), axis=1)
        error = np.std([part.mean(axis=1) for part in parts], axis=0, ddof=1) / math.sqrt(len(parts))
        room = special.stdtrit(len(parts) - 1, 0.5 * (1.0 + CONFIDENCE)) * error / index
        factor = np.exp(np.nan_to_num(room))
    ends = index / factor, np.minimum(index * factor, np.maximum(index, 1.0))
    return Indices(first.mean(axis=1), index, np.array(ends), count)
