"""Figures of the report of the thesis that show end values of its versions side by side, as bars."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear import figure_style as fs
from warpwear import thesis
from warpwear.thesis_curves import EXPERIMENT, LINES, PRINTED
from warpwear.thesis_numbers import Numbers
from warpwear.thesis_runs import VERSIONS, Runs


def _bars(
    axes: Axes, labels: list[str], values: list[float], colours: list[str], text: str = "{:.3g}"
) -> None:
    bars = axes.bar(range(len(values)), values, color=colours, width=0.65)
    axes.bar_label(bars, [text.format(v) for v in values], fontsize=7, padding=2)
    axes.set_xticks(range(len(values)), labels)
    axes.margins(y=0.12)


def disc_volumes(runs: Runs, numbers: Numbers) -> Figure:
    values = [numbers[f"{name}.disc_volume_mm3"] for name in VERSIONS]
    colours = [LINES[name]["color"] for name in VERSIONS]

    def draw(axes: Any) -> None:
        _bars(axes[0], list(VERSIONS.values()), values, colours, "{:.5f}")
        axes[0].set_ylabel("worn volume of the disc, mm³")
        change = [100.0 * (value / values[0] - 1.0) for value in values]
        _bars(axes[1], list(VERSIONS.values()), change, colours, "{:.3f}")
        axes[1].axhline(0.0, color=fs.NEUTRAL, lw=0.6)
        axes[1].set_ylabel("against V1, %")
        axes[1].margins(y=0.2)

    return fs.new_figure(draw, columns=2)


def disc_depths(runs: Runs, numbers: Numbers) -> Figure:
    labels = [*VERSIONS.values(), "groove of\nTable 4.1"]
    values = [numbers[f"{name}.disc_depth_um"] for name in VERSIONS] + [numbers["experiment.groove_depth_um"]]

    def draw(axes: Any) -> None:
        _bars(axes, labels, values, [*(LINES[name]["color"] for name in VERSIONS), EXPERIMENT])
        axes.set_ylabel("depth of the disc's wear, µm")

    return fs.new_figure(draw)


def patch_bars(runs: Runs, numbers: Numbers) -> Figure:
    ours = [
        numbers["v1.patch_by_depth_mm"],
        numbers["v2.patch_by_depth_mm"],
        numbers["v3.patch_along_mm"],
        numbers["fine.patch_along_mm"],
    ]
    printed = [thesis.PATCH_DIAMETERS[name].value for name in ("experiment", "v1", "v2", "v3")]

    def draw(axes: Any) -> None:
        place = np.arange(4)
        for bars in (
            axes.bar(
                place - np.array([0.0, 0.19, 0.19, 0.19]),
                printed,
                0.36,
                color=[EXPERIMENT, *[PRINTED] * 3],
                label="printed in the thesis",
            ),
            axes.bar(place[1:] + 0.19, ours[:3], 0.36, color=[LINES[n]["color"] for n in ("v1", "v2", "v3")]),
            axes.bar([4.0], ours[3:], 0.36, color=LINES["fine"]["color"]),
        ):
            axes.bar_label(bars, fmt="{:.2f}", fontsize=7, padding=2)
        axes.set_xticks(range(5), ["experiment", "V1", "V2", "V3", "V3 fine"])
        axes.set_ylabel("diameter of the sphere's patch, mm")
        axes.margins(y=0.12)
        axes.set_title("grey and black: printed; coloured: ours")

    return fs.new_figure(draw, width=5.0)
