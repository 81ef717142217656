"""Declare figures of an inference: unknowns by pairs, and the predicted course of friction with its data."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from warpwear import lazy
from warpwear.calibration.bayes.data import Data
from warpwear.calibration.bayes.unknowns import Unknown
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Density, Empty, Figure, Line, Look, Panel
from warpwear.figures.wording import power_of_ten
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME, printed
from warpwear.results.ensemble import in_legend

ndimage = lazy.module("scipy.ndimage")

#: Side of a panel of pairs [inch], and the room of labels.
SIDE, ROOM = 1.12, 0.7
#: Parts of the samples that the lines of a pair enclose.
ENCLOSED = (0.5, 0.9)
#: Cells of a pair's histogram, how far it is smoothed [cells], and to where.
CELLS, SMOOTH, REACH = 40, 1.6, 6


def corner(unknowns: Sequence[Unknown], values: Mapping[str, FloatArray]) -> Figure:
    """Draw samples of the unknowns by pairs, 50 and 90 % of them enclosed, each alone beside its prior."""
    count = len(unknowns)
    factors = [10.0 ** _power(values[unknown.key]) for unknown in unknowns]
    columns = [values[unknown.key] / factor for unknown, factor in zip(unknowns, factors, strict=True)]
    labels = [_label(unknown, values[unknown.key]) for unknown in unknowns]
    panels: list[Panel] = []
    for row, column in np.ndindex(count, count):
        if column > row:
            panels.append(Empty())
            continue
        low, high = _ends(columns[column])
        last = row == count - 1
        across = Axis(labels[column] if last else "", low=low, high=high, ticks=3, numbered=last)
        if column == row:
            lines = _alone(unknowns[row], columns[row], factors[row])
            panels.append(Chart("", across, Axis(numbered=False, places=((0.0, ""),)), lines))
            continue
        low, high = _ends(columns[row])
        first = column == 0
        up = Axis(labels[row] if first else "", low=low, high=high, ticks=3, numbered=first)
        panels.append(Chart("", across, up, [_pair(columns[column], columns[row])]))
    size = count * SIDE + ROOM
    return Figure(panels, count, width=max(size, describe.COLUMN), height=max(size, describe.ROW) / count)


def course(predicted: tuple[FloatArray, FloatArray, FloatArray], data: Data) -> Figure:
    """Draw the predicted coefficient of friction with what was measured on it."""
    distance, (mean, low, high), (least, most) = predicted
    lines: list[Line] = []
    if np.any(most - least > (high - low) * (1.0 + 1e-9)):
        label = "90 % of points of another test"
        lines.append(Line(distance, mean, label, Look(describe.CONTACT, "", alpha=0.15), least, most))
    lines += [
        Line(distance, mean, "90 % of what is computed", Look(describe.CONTACT, "", alpha=0.4), low, high),
        Line(distance, mean, "mean of what is computed", Look(describe.CONTACT)),
    ]
    for place, measured in enumerate(data.courses):
        look = replace(describe.look_of_measured(place), dash="")
        lines.append(Line(measured.distance, measured.cof, in_legend(measured.name), look))
    for number, point in enumerate(data.points):
        at, label = np.full(1, point.at or 0.0), "" if number else "measured ± u"
        ends = np.array([point.value - point.error, point.value + point.error])
        lines.append(Line(np.repeat(at, 2), ends, look=Look(describe.GREYS[0], width=1.0)))
        dot = Look(describe.GREYS[0], "", marker="o", size=4.0)
        lines.append(Line(at, np.full(1, point.value), label, dot))
    end = float(distance[-1]) * 1.02
    up = Axis(BY_NAME["cof"].axis, low=0.0)
    chart = Chart("Coefficient of friction", Axis(describe.DISTANCE, low=0.0, high=end), up, lines)
    return Figure([chart], legend=2, width=0.72 * describe.PAGE, height=3.4)


def _power(column: FloatArray) -> int:
    """Return the power of ten that is written at the label: 0 where numbers are short anyway."""
    typical = float(np.median(np.abs(column)))
    power = int(np.floor(np.log10(typical))) if typical > 0.0 else 0
    return 0 if -2 <= power < 4 else power


def _label(unknown: Unknown, column: FloatArray) -> str:
    unit, power = printed(unknown.unit), _power(column)
    what = " ".join(part for part in (power_of_ten(power) if power else "", unit) if part)
    section, _, name = unknown.key.rpartition(".")
    key = unknown.key if len(unknown.key) < 14 else f"{section}.\n{name}"
    return key + (f",\n{what}" if what else "")


def _ends(column: FloatArray) -> tuple[float, float]:
    """Return the ends of an axis: where nearly all samples lie."""
    low, high = np.percentile(column, (0.2, 99.8))
    room = 0.08 * (high - low) or 1e-9
    return float(low - room), float(high + room)


def _alone(unknown: Unknown, column: FloatArray, factor: float) -> list[Line]:
    """Give a histogram of samples under the prior's density, dashed."""
    density, edges = np.histogram(column, bins=30, range=_ends(column), density=True)
    z = np.linspace(-4.0, 4.0, 2001)
    values = unknown.values(z) / factor
    with np.errstate(all="ignore"):
        prior = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi) / np.gradient(values, z)
    places, heights = np.repeat(edges, 2)[1:-1], np.repeat(density, 2)
    return [
        Line(places, heights, look=Look(describe.TOUCHED, ""), low=0.0 * heights, high=heights),
        Line(values, prior, look=Look(describe.HARDNESS, "dash", 0.8)),
    ]


def _pair(across: FloatArray, up: FloatArray) -> Density:
    """Give samples of two unknowns: shades, and lines around parts of them."""
    counts, xs, ys = np.histogram2d(across, up, bins=CELLS, range=[_ends(across), _ends(up)])
    smooth = np.asarray(ndimage.gaussian_filter(counts, SMOOTH, mode="constant", radius=REACH))
    order = np.sort(smooth.ravel())[::-1]
    part = np.cumsum(order) / order.sum()
    levels = sorted({float(order[min(int(np.searchsorted(part, p)), order.size - 1)]) for p in ENCLOSED})
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (xs, ys))
    colours = ("#cfe6f5", describe.TOUCHED)[-len(levels) :]
    return Density(x, y, smooth, tuple(levels), colours)
