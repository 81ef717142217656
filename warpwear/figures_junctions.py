"""Figure of the islands of contact against the critical size of a junction."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear import figure_style as fs
from warpwear.figure_data import FigureData
from warpwear.grid import FloatArray


def junctions(data: FigureData) -> Figure:
    """Share of the contact area in islands up to a diameter, a line a snapshot, beside d* and the mesh.

    An island's diameter is that of the circle of its area. The legend says what share of the contact area
    is in islands larger than d*; a study without a critical junction has neither that share nor the line.
    """
    evolution = data.result.surface_evolution
    critical = data.study.critical_junction

    def draw(axes: Axes) -> None:
        shown = [index for index in data.shown if evolution.island_areas[index].size]
        for index, line in zip(shown, fs.in_time(fs.CONTACT, len(shown)), strict=True):
            areas = evolution.island_areas[index]
            distance = evolution.table["distance"][index]
            label = f"{distance:.4g} mm" if distance else "static"
            if critical is not None:
                label += f": {100.0 * share_above(areas, critical):.0f} % > d*"
            diameters = 1e3 * diameters_of(np.sort(areas))
            shares = np.cumsum(np.sort(areas)) / areas.sum()
            # From nothing below the smallest island.
            axes.step(
                np.append(diameters[0], diameters), np.append(0.0, shares), where="post", label=label, **line
            )
        mesh = 1e3 * float(diameters_of(np.array([data.result.study.cells.cell_area]))[0])
        axes.axvline(mesh, color=fs.NOMINAL, lw=0.6, label="one cell (mesh limit)")
        if critical is not None:
            axes.axvline(1e3 * critical, color=fs.HARDNESS, lw=1.4, label=f"d* = {1e3 * critical:.3g} µm")
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(fs.PlainNumbers())
        axes.xaxis.set_minor_formatter(fs.PlainNumbers(minor_thresholds=(1.2, 0.3)))
        axes.tick_params(axis="x", which="minor", pad=5.0)  # its labels in line with those of decades
        axes.set_ylim(0.0, 1.02)
        axes.set_xlabel("diameter of an island, µm")
        axes.set_ylabel("cumulative share of contact area, –")
        fs.legend_above(axes, columns=2)

    return fs.new_figure(draw, height=2.9)


def diameters_of(areas: FloatArray) -> FloatArray:
    """Diameters [mm] of circles of these areas [mm²], any shape."""
    return np.asarray(2.0 * np.sqrt(areas / np.pi))


def share_above(areas: FloatArray, diameter: float) -> float:
    """Share of the area of all islands that is in islands larger than a circle. areas: (islands,) [mm²]"""
    return float(areas[diameters_of(areas) > diameter].sum() / areas.sum())
