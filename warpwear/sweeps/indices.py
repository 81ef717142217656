"""Which input decides an output: Sobol's indices of a Saltelli design, with bootstrap intervals."""

import math
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray

#: Part of the bootstrap's indices that an interval holds.
CONFIDENCE = 0.95
#: Times that the samples are drawn again.
RESAMPLES = 1000
#: Half of an interval from which an index is known well enough to set inputs in order.
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
        half = 0.5 * float(np.max(np.diff(self.total_interval, axis=0)))
        if not half > WELL_KNOWN:
            return ""
        needed = 2 ** math.ceil(math.log2(self.samples * (half / WELL_KNOWN) ** 2))
        return (
            f"{self.samples} samples tell total indices to ± {half:.2g} only (95 %): about {needed} samples "
            f"tell them to ± {WELL_KNOWN:g}."
        )


def sobol(values: FloatArray, factors: int) -> Indices:
    """Sobol's indices of the outputs of a Saltelli design (`Design.unit_samples`), shape (runs,).

    Samples with a value that is not finite are left out, in all of their runs, which
    `scipy.stats.sobol_indices` does not allow. Intervals of 95 % are those of a bootstrap over samples.
    """
    blocks = values.reshape(factors + 2, -1)
    blocks = blocks[:, np.isfinite(blocks).all(axis=0)]
    count = blocks.shape[1]
    if count < 2 or np.ptp(blocks) == 0.0:
        nothing = np.full((2, factors), np.nan)
        return Indices(nothing[0], nothing[0], nothing, count)
    drawn = np.random.default_rng(0).integers(0, count, (RESAMPLES, count))
    totals = np.stack([_estimated(blocks[:, sample])[1] for sample in drawn])
    ends = (50.0 * (1.0 - CONFIDENCE), 50.0 * (1.0 + CONFIDENCE))
    first, total = _estimated(blocks)
    return Indices(first, total, np.nanpercentile(totals, ends, axis=0), count)


def _estimated(blocks: FloatArray) -> FloatArray:
    """Estimate first-order and total indices, (2, factors), of outputs of A, B and A with a column of B each.

    Estimators (b) and (f) of Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018, table 2; the mean is taken
    off, as a large one costs digits (Sobol and Levitan 1999).
    """
    centred = blocks - blocks[:2].mean()
    a, b, mixed = centred[0], centred[1], centred[2:]
    first, total = (b * (mixed - a)).mean(axis=1), 0.5 * ((a - mixed) ** 2).mean(axis=1)
    with np.errstate(invalid="ignore"):  # a few samples, drawn again, may all be one
        return np.stack([first, total]) / centred[:2].var()
