"""Figures of the disc's roughness inside the scar and of the islands of contact, over the snapshots."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear import figure_style as fs
from warpwear.figure_data import FigureData

#: Parameter -> line. Sq and Sk are heights of the whole, Spk and Svk of peaks and valleys.
PARAMETERS: dict[str, tuple[str, dict[str, Any]]] = {
    "sk": ("Sk", {"color": fs.NOMINAL, "ls": "-.", "marker": "D"}),
    "svk": ("Svk", {"color": fs.TOUCHED, "ls": "--", "marker": "v"}),
    "sq": ("Sq", {"color": fs.HARDNESS, "ls": "-", "marker": "o"}),
    "sa": ("Sa", {"color": fs.SUM, "ls": "-", "marker": "s"}),
    "spk": ("Spk", {"color": fs.MEAN_PRESSURE, "ls": ":", "marker": "^"}),
}


def roughness(data: FigureData) -> Figure:
    """Height parameters of the disc inside the nominal scar, its bowl taken off, over the distance slid."""
    table = data.result.surface_evolution.table

    def draw(axes: Axes) -> None:
        for name, (label, line) in PARAMETERS.items():
            fs.over_distance(axes, table["distance"], table[name], label=label, ms=3, **line)
        fs.scale_distance(axes, table["distance"])
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel("roughness inside the scar, µm")
        fs.legend_above(axes, columns=5)

    return fs.new_figure(draw)


def islands(data: FigureData) -> Figure:
    """Number of islands of contact over the distance slid, and how their areas are distributed."""
    evolution = data.result.surface_evolution
    table = evolution.table

    def draw(axes: Any) -> None:
        number, sizes = axes
        for name, label, line in (
            ("islands", "all", {"color": fs.CONTACT, "marker": "o"}),
            ("islands_of_one_cell", "of one cell", {"color": fs.HARDNESS, "ls": ":", "marker": "x"}),
        ):
            fs.over_distance(number, table["distance"], table[name], label=label, ms=3, **line)
        fs.scale_distance(number, table["distance"])
        number.set_ylim(bottom=0.0)
        number.set_ylabel("islands of contact, –")
        number.legend()
        shades = np.linspace(0.1, 0.9, len(evolution.island_areas))
        for index, (areas, shade) in enumerate(zip(evolution.island_areas, shades, strict=True)):
            falling = np.sort(areas)[::-1]
            sizes.step(
                falling,
                np.arange(1, falling.size + 1),
                color=fs.PRESSURES(shade),
                ls=("-", "--", "-.", ":")[index % 4],
                label=f"{table['distance'][index]:.4g} mm",
            )
        sizes.set(xscale="log", yscale="log", xlabel="area of an island, mm²")
        # To a whole decade, and only decades labelled: labels between them would run into each other.
        everything = np.log10(np.concatenate(evolution.island_areas))
        sizes.set_xlim(0.8 * 10.0 ** everything.min(), 10.0 ** np.floor(everything.max() + 1.0))
        sizes.tick_params(axis="x", which="minor", labelbottom=False)
        sizes.set_ylabel("islands at least as large, –")
        fs.legend_above(sizes, columns=5)

    return fs.new_figure(draw, columns=2)
