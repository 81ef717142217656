"""One number from repeated measurements: its mean and scatter, and what their own uncertainties say of it."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Repeats:
    """Hold values of one number, each with its standard uncertainty, None where unknown."""

    values: Sequence[float]
    errors: Sequence[float | None]

    @property
    def mean(self) -> float:
        """Return the mean, which counts all alike."""
        return statistics.fmean(self.values)

    @property
    def deviation(self) -> float | None:
        """Return the standard deviation of the values, divided by n − 1; None of a single one."""
        return statistics.stdev(self.values) if len(self.values) > 1 else None

    @property
    def uncertainty(self) -> float | None:
        """Return the standard uncertainty of the mean: by the scatter of several, else of the single one."""
        deviation = self.deviation
        return self.errors[0] if deviation is None else deviation / math.sqrt(len(self.values))

    @property
    def weighted(self) -> tuple[float, float] | None:
        """Return the posterior's mean and deviation under a flat prior and normal errors; None without these.

        That is the mean weighted by 1/u², whose uncertainty is not widened by what the values scatter.
        """
        errors = [error for error in self.errors if error]
        if len(errors) < len(self.values):
            return None
        weights = [error**-2.0 for error in errors]
        total = math.fsum(weights)
        mean = math.fsum(w * v for w, v in zip(weights, self.values, strict=True)) / total
        return mean, total**-0.5

    @property
    def birge(self) -> float:
        """Return how much more the values scatter than their uncertainties say (Birge's ratio); 0 of one."""
        if self.weighted is None or len(self.values) < 2:
            return 0.0
        mean = self.weighted[0]
        square = sum(
            ((v - mean) / (e or math.inf)) ** 2 for v, e in zip(self.values, self.errors, strict=True)
        )
        return math.sqrt(square / (len(self.values) - 1))
