"""Figures of an inference: unknowns by pairs, and the predicted course of friction with the data on it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from warpwear.figures import style as fs
from warpwear.grid import FloatArray
from warpwear.inference.data import SHOWN, Data
from warpwear.inference.unknowns import Unknown

#: Side of a panel of pairs [inch], and the room of labels.
SIDE, ROOM = 1.12, 0.7
#: Parts of the samples that the lines of a pair enclose.
ENCLOSED = (0.5, 0.9)
#: Cells of a pair's histogram, and how far it is smoothed [cells].
CELLS, SMOOTH = 40, 1.6
#: Signs of courses, and shades of grey.
SIGNS, GREYS = ("o", "s", "^", "v", "D"), ("#222222", "#666666", "#999999")


def corner(unknowns: Sequence[Unknown], values: Mapping[str, FloatArray]) -> Figure:
    """Draw samples of the unknowns by pairs, 50 and 90 % of them enclosed, each alone beside its prior."""
    count = len(unknowns)
    factors = [10.0 ** _power(values[unknown.key]) for unknown in unknowns]
    shown = [values[unknown.key] / factor for unknown, factor in zip(unknowns, factors, strict=True)]

    def draw(axes: Any) -> None:
        grid = (
            np.array(axes, dtype=object).reshape(count, count)
            if count > 1
            else np.array([[axes]], dtype=object)
        )
        for row in range(count):
            for column in range(count):
                panel = grid[row, column]
                if column > row:
                    panel.set_axis_off()
                elif column == row:
                    _alone(panel, unknowns[row], shown[row], factors[row])
                else:
                    _pair(panel, shown[column], shown[row])
                panel.set_xlim(*_ends(shown[column]))
                if column < row:
                    panel.set_ylim(*_ends(shown[row]))
                for axis in (panel.xaxis, panel.yaxis) if column < row else (panel.xaxis,):
                    axis.set_major_locator(MaxNLocator(3, prune="both"))
                    axis.set_major_formatter(ScalarFormatter(useOffset=False))
                if row == count - 1:
                    panel.set_xlabel(_label(unknowns[column], values[unknowns[column].key]))
                else:
                    panel.tick_params(labelbottom=False)
                if column == 0 and row > 0:
                    panel.set_ylabel(_label(unknowns[row], values[unknowns[row].key]))
                elif column != row:
                    panel.tick_params(labelleft=False)

    size = count * SIDE + ROOM
    return fs.new_figure(
        draw, rows=count, columns=count, height=max(size, fs.ROW) / count, width=max(size, fs.COLUMN)
    )


def course(predicted: tuple[FloatArray, FloatArray, FloatArray], data: Data) -> Figure:
    """Draw the predicted coefficient of friction with what was measured on it."""
    distance, (mean, low, high), (least, most) = predicted

    def draw(axes: Any) -> None:
        if np.any(most - least > (high - low) * (1.0 + 1e-9)):
            axes.fill_between(
                distance,
                least,
                most,
                color=fs.CONTACT,
                alpha=0.15,
                lw=0.0,
                label="90 % of points of another test",
            )
        axes.fill_between(
            distance, low, high, color=fs.CONTACT, alpha=0.4, lw=0.0, label="90 % of what is computed"
        )
        axes.plot(distance, mean, color=fs.CONTACT, label="mean of what is computed")
        for place, measured in enumerate(data.courses):
            sign, grey = SIGNS[place % len(SIGNS)], GREYS[place % len(GREYS)]
            axes.plot(measured.distance, measured.cof, sign, ms=2.2, mew=0.0, color=grey, label=measured.name)
        if data.points:
            at, cof, error = np.array(
                [[point.at or 0.0, point.value, point.error] for point in data.points]
            ).T
            axes.errorbar(at, cof, error, fmt="o", ms=4.0, color=GREYS[0], capsize=2.0, label="measured ± u")
        axes.set_xlabel("sliding distance, mm")
        axes.set_ylabel("coefficient of friction")
        axes.set_xlim(0.0, float(distance[-1]) * 1.02)
        axes.set_ylim(bottom=0.0)
        fs.legend_above(axes, columns=2)

    return fs.new_figure(draw, width=fs.PAGE * 0.72, height=3.4)


def _power(column: FloatArray) -> int:
    """Return the power of ten that is written at the label: 0 where numbers are short anyway."""
    typical = float(np.median(np.abs(column)))
    power = int(np.floor(np.log10(typical))) if typical > 0.0 else 0
    return 0 if -2 <= power < 4 else power


def _label(unknown: Unknown, column: FloatArray) -> str:
    unit, power = SHOWN.get(unknown.unit, unknown.unit), _power(column)
    raised = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    what = " ".join(part for part in (f"10{raised}" if power else "", unit) if part)
    section, _, name = unknown.key.rpartition(".")
    key = unknown.key if len(unknown.key) < 14 else f"{section}.\n{name}"
    return key + (f",\n{what}" if what else "")


def _ends(column: FloatArray) -> tuple[float, float]:
    """Return the ends of an axis: where nearly all samples lie."""
    low, high = np.percentile(column, (0.2, 99.8))
    room = 0.08 * (high - low) or 1e-9
    return float(low - room), float(high + room)


def _alone(panel: Any, unknown: Unknown, column: FloatArray, factor: float) -> None:
    """Draw a histogram of samples over the prior's density, dashed."""
    low, high = _ends(column)
    panel.hist(column, bins=30, range=(low, high), density=True, color=fs.TOUCHED, histtype="stepfilled")
    z = np.linspace(-4.0, 4.0, 2001)
    at = unknown.values(z) / factor
    with np.errstate(all="ignore"):
        density = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi) / np.gradient(at, z)
    panel.plot(at, density, color=fs.HARDNESS, ls="--", lw=0.8)
    panel.set_yticks([])
    panel.spines["left"].set_visible(False)


def _pair(panel: Any, across: FloatArray, up: FloatArray) -> None:
    """Draw samples of two unknowns: shades, and lines around parts of them."""
    ends = [_ends(across), _ends(up)]
    counts, xs, ys = np.histogram2d(across, up, bins=CELLS, range=ends)
    smooth = _smooth(_smooth(counts).T).T
    order = np.sort(smooth.ravel())[::-1]
    part = np.cumsum(order) / order.sum()
    levels = sorted({float(order[min(int(np.searchsorted(part, p)), order.size - 1)]) for p in ENCLOSED})
    middles = [0.5 * (e[1:] + e[:-1]) for e in (xs, ys)]
    top = float(smooth.max()) * 1.01
    colours = ["#cfe6f5", fs.TOUCHED][-len(levels) :]
    panel.contourf(*middles, smooth.T, levels=[*levels, top], colors=colours)
    panel.contour(*middles, smooth.T, levels=levels, colors=fs.SPHERE, linewidths=0.7)


def _smooth(counts: FloatArray) -> FloatArray:
    """Smooth along the first axis by a Gaussian."""
    reach = np.arange(-6, 7)
    weights = np.exp(-0.5 * (reach / SMOOTH) ** 2)
    return np.apply_along_axis(
        lambda line: np.convolve(line, weights / weights.sum(), mode="same"), 0, counts
    )
