"""Courses of groups and measured courses laid over each other, of one look in every figure."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from warpwear.ensembles.ensemble import Ensemble, Group, M, means_of_parts
from warpwear.figures import describe
from warpwear.figures.blocks import with_blocks
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look, over_distance
from warpwear.figures.of_run.table import FIGURES
from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.measured.experiment import Experiment
from warpwear.results.ensemble import band, band_told, in_legend
from warpwear.study.study import Study

#: Figure of a run -> quantities of a step of which it says that their courses are laid over each other.
OVERLAID = {
    name: [BY_NAME[column] for column in entry.overlaid] for name, entry in FIGURES.items() if entry.overlaid
}
#: Parts that a measured course of many more points is averaged in, its scatter a band.
POINTS = 120
#: Markers along a measured course, about.
MARKED = 30


def lines_of(
    groups: Sequence[Group[M]],
    name: str,
    factor: float = 1.0,
    *,
    positive: bool = False,
    looks: Sequence[Look] = (),
) -> Iterator[tuple[Group[M], Line]]:
    """Draw the mean of each group that has courses of a column, in a band of 5 to 95 % of several rows.

    positive: with gaps where values are not. looks: of each group, by default those of its number.
    """
    for index, group in enumerate(groups):
        if (course := group.courses(name)) is None:
            continue
        places, values = course[0], factor * course[1]
        mean, low, high = band(np.where(values > 0.0, values, np.nan) if positive else values)
        look = looks[index] if looks else describe.look_of_group(index)
        look = look if places.size > 1 else replace(look, marker="o", size=4.0)
        line = Line(places, mean, in_legend(group.name), look, name=group.name)
        yield group, replace(line, low=low, high=high) if len(values) > 1 else line


def chart_of(
    ensemble: Ensemble[M],
    quantity: Quantity,
    *,
    looks: Sequence[Look] = (),
    names: Sequence[Line] = (),
    note: str = "",
) -> Chart:
    """Lay courses of a quantity over each other, those of friction over measured ones.

    names: lines of names alone, in whose place groups have none in the legend.
    """
    experiments = ensemble.experiments if quantity.name == "cof" else ()
    measured = [measured_line(*pair) for pair in enumerate(experiments)]
    drawn = lines_of(ensemble.groups, quantity.name, quantity.factor, positive=quantity.log, looks=looks)
    lines = [*names, *measured, *(replace(line, label="") if names else line for _, line in drawn)]
    along, up = Axis(describe.DISTANCE, low=0.0), Axis(quantity.axis, low=0.0)
    if quantity.log:
        along, up = over_distance(*(line.x for line in lines if line.x.size)), Axis(quantity.axis, "auto")
    return Chart(quantity.label[:1].upper() + quantity.label[1:], along, up, lines, note)


def figure_of(
    ensemble: Ensemble[M], charts: Sequence[Chart], studies: Iterable[Study], columns: int = 0
) -> Figure:
    """Make a figure with one legend, and say above the first panel what bands are.

    studies: of the rows; where all follow one programme, the borders of its blocks are drawn.
    """
    text = band_told([len(group.rows) for group in ensemble.groups])
    note = "\n".join(filter(None, [charts[0].note, text]))
    several = len(ensemble.groups) + len(ensemble.experiments)
    charts = [replace(charts[0], note=note), *charts[1:]]
    figure = Figure(charts, columns=columns, legend=several * (several > 1))
    programmes = {study.programme: study for study in studies}
    return with_blocks(figure, *programmes.values()) if len(programmes) == 1 else figure


def measured_line(number: int, experiment: Experiment) -> Line:
    """Give measured points; of many more the means of parts, in a band of scatter."""
    distance, values, look = experiment.distance, experiment.cof, describe.look_of_measured(number)
    label, every = in_legend(experiment.name), max(1, min(distance.size, POINTS) // MARKED)
    if distance.size <= 2 * POINTS:
        return Line(distance, values, label, look, every=max(1, distance.size // MARKED))
    distance, values, squares = means_of_parts(POINTS, distance, values, values**2)
    scatter = np.sqrt(np.clip(squares - values**2, 0.0, None))
    return Line(distance, values, label, look, values - scatter, values + scatter, every=every)
