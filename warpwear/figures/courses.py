"""Courses of several runs over each other, the mean of like ones in a band: of comparisons and of sweeps."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from warpwear.figures.describe import Axis, Chart, Line, Look, over_distance
from warpwear.figures.of_run.table import FIGURES
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.results.ensemble import band

#: Figure of a run -> quantities of a step of which it says that their courses are laid over each other.
OVERLAID = {
    name: [BY_NAME[column] for column in entry.overlaid] for name, entry in FIGURES.items() if entry.overlaid
}


@dataclass(frozen=True, eq=False)
class Course:
    """Values (runs, places) of like runs over places (places,), NaN where a run has none, and their line.

    name: in full, on a page, where the label is short or the legend does not name it.
    """

    label: str
    look: Look
    places: FloatArray
    values: FloatArray
    name: str = ""

    def line(self, factor: float = 1.0, *, positive: bool = False) -> Line:
        """Draw the mean, in a band of 5 to 95 % of several runs. positive: with gaps where values are not."""
        values = factor * self.values
        mean, low, high = band(np.where(values > 0.0, values, np.nan) if positive else values)
        look = self.look if self.places.size > 1 else replace(self.look, marker="o", size=4.0)
        line = Line(self.places, mean, self.label, look, name=self.name)
        return replace(line, low=low, high=high) if len(values) > 1 else line


def over_each_other(
    quantity: Quantity, courses: Iterable[Course], *, more: Sequence[Line] = (), note: str = ""
) -> Chart:
    """Lay courses of a quantity over each other. more: lines of what was measured, or of names alone."""
    lines = [*more, *(course.line(quantity.factor, positive=quantity.log) for course in courses)]
    along, up = Axis("", low=0.0), Axis(quantity.axis, low=0.0)
    if quantity.log:
        along, up = over_distance(*(line.x for line in lines if line.x.size)), Axis(quantity.axis, "auto")
    along = replace(along, label=BY_NAME["distance"].axis)
    return Chart(quantity.label[:1].upper() + quantity.label[1:], along, up, lines, note)
