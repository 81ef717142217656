"""Hold the coefficient of friction that an experiment measured over the distance slid."""

from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray


@dataclass(frozen=True, eq=False)
class Experiment:
    """A measured coefficient of friction depends on the distance slid."""

    name: str  # of the file, without its ending
    distance: FloatArray  # [mm], rising, shape (points,)
    cof: FloatArray  # shape (points,)
    notes: tuple[str, ...] = ()  # what was assumed and done, each a sentence
    cycles: FloatArray | None = None  # number of each point's cycle, from 1, where a raw record was averaged
    warnings: tuple[str, ...] = ()  # what makes the whole doubtful, each a sentence

    @property
    def course(self) -> tuple[FloatArray, FloatArray]:
        """Return distances and coefficients."""
        return self.distance, self.cof

    @property
    def final_cof(self) -> float:
        """Return the mean coefficient over the last tenth of the distance."""
        return mean_of_last_tenth(self.distance, self.cof)


def mean_of_last_tenth(distance: FloatArray, values: FloatArray) -> float:
    """Return the mean of the values over the last tenth of the distance: the end of a course that scatters.

    distance [mm], rising, and values have the same shape (points,). Between rows a course is a line, so that
    each row counts by the distance it stands for.
    """
    end = float(distance[-1])
    start = max(float(distance[0]), 0.9 * end)
    return mean_over(distance, values, start, end) if end > start else float(values[-1])


def mean_over(distance: FloatArray, values: FloatArray, start: float, end: float) -> float:
    """Return the mean of a course over a piece of it [mm], lines between points; beyond its ends as there."""
    places = np.concatenate([[start], distance[(distance > start) & (distance < end)], [end]])
    return float(np.trapezoid(np.interp(places, distance, values), places) / (end - start))
