"""Figures of the smooth model: the foundation's pressure beside Hertz's, and how far cells slide."""

from typing import Any

import numpy as np

from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS, ALONG, draw_map
from warpwear.figures.data import FigureData
from warpwear.laws.archard import distance_factor

#: Half the width shown over the wider of both contacts.
MARGIN = 1.3


@fs.panels(2)
def hertz(axes: Any, data: FigureData) -> None:
    """Pressure along the sliding direction through the middle, beside Hertz's of the unworn bodies."""
    result, theory = data.result, data.study.hertz
    assert theory is not None  # or the figure is left out
    first, last = (result.snapshot(index) for index in (0, -1))
    middle = result.y.size // 2
    r = np.linspace(0.0, theory.radius, 200)
    both = np.concatenate([-r[::-1], r])
    unworn = {"color": fs.NEUTRAL, "ls": "--", "label": "Hertz, unworn bodies"}
    worn = {"color": fs.MEAN_PRESSURE, "where": "mid", "label": "elastic foundation"}
    for panel, snapshot in zip(axes, (first, last), strict=True):
        line = snapshot.pressure[:, middle]
        shown = np.flatnonzero(line > 0.0)
        shown = np.arange(max(shown[0] - 1, 0), min(shown[-1] + 2, line.size))
        panel.plot(both, theory.pressure(np.abs(both)), **unworn)
        panel.step(result.x[shown], line[shown], **worn)
        half = MARGIN * max(theory.radius, float(np.abs(result.x[shown]).max()))
        panel.set(xlim=(-half, half), xlabel=ALONG, ylabel="pressure, MPa")
        panel.set_title(fs.after(snapshot.distance))
    axes[0].set_ylim(bottom=0.0)
    positive = last.pressure[last.pressure > 0.0]
    axes[1].set(yscale="log", ylim=(0.3 * float(np.median(positive)), 2.0 * theory.peak_pressure))
    axes[1].yaxis.set_major_formatter(fs.PlainNumbers())
    fs.legend_above(axes[0], columns=2)


@fs.panels(2, height=2.9)
def factor(axes: Any, data: FigureData) -> None:
    """Sliding distance of disc cells over that in the middle (thesis eq 4.22), at the scar and its margin."""
    study, window = data.study, data.window
    factors = distance_factor(study.cells, study.wear.distance_factor, curvature=study.sphere.curvature)
    whole = np.broadcast_to(factors, study.cells.shape)
    draw_map(axes[0], whole[window.x, window.y], window, fs.HEIGHTS, "relative sliding distance, –")
    axes[1].plot(study.cells.y[window.y], whole[study.cells.nx // 2, window.y], color=fs.DISC)
    axes[1].set(xlabel=ACROSS, ylabel="relative sliding distance, –")
    axes[1].set_title("1 = sliding distance in the middle")
    axes[1].ticklabel_format(axis="y", useOffset=False)
