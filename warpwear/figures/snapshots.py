"""Figures of the bodies' roughness in the scar and of the islands of contact, over the snapshots."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.laws.junctions import diameters_of, share_above

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

#: Parameter -> line. Sq and Sk are heights of the whole, Spk and Svk of peaks and valleys.
PARAMETERS: dict[str, tuple[str, dict[str, Any]]] = {
    "sk": ("Sk", {"color": fs.NOMINAL, "ls": "-.", "marker": "D"}),
    "svk": ("Svk", {"color": fs.TOUCHED, "ls": "--", "marker": "v"}),
    "sq": ("Sq", {"color": fs.HARDNESS, "ls": "-", "marker": "o"}),
    "sa": ("Sa", {"color": fs.SUM, "ls": "-", "marker": "s"}),
    "spk": ("Spk", {"color": fs.MEAN_PRESSURE, "ls": ":", "marker": "^"}),
}


@fs.panels()
def roughness(axes: Axes, data: "FigureData") -> None:
    """Height parameters of the disc in the middle of the scar, its bowl taken off, over the distance slid."""
    table = data.roughness
    for name, (label, line) in PARAMETERS.items():
        fs.over_distance(axes, table["distance"], table[name], label=label, ms=3, **line)
    fs.scale_distance(axes, table["distance"])
    axes.set(ylabel="roughness in the scar, µm", ylim=(0.0, None))
    fs.legend_above(axes, columns=5)


@fs.panels(2)
def texture(axes: Any, data: "FigureData") -> None:
    """Sq and rms gradient Sdq of ball and disc in the inner scar over the distance, with fits of Sq.

    A disc's Sq is over that of the same cells before wear, times that of the last ones.
    """
    table = data.roughness
    heights, slopes = axes
    for body, color, mark in (("sphere", fs.SPHERE, "o"), ("disc", fs.DISC, "s")):
        line: dict[str, Any] = {"color": color, "marker": mark, "ms": 3}
        slid, sq, fit = data.settling[body]
        dots = line if isinstance(fit, str) else line | {"ls": "none"}
        fs.over_distance(heights, slid, sq, label=data.about.name_of(body), **dots)
        if not isinstance(fit, str):  # the fit is the line
            places = np.linspace(0.0, float(slid[-1]), 200)
            level, length = (fs.short(float(f"{value:.2g}")) for value in (fit.equilibrium, fit.length))
            heights.plot(
                places, fit.at(places), color=color, ls="--", lw=1.0, label=f"to {level} µm over {length} mm"
            )
        fs.over_distance(slopes, table["distance"], table[f"sdq_{body}"], **line)
    heights.set_ylabel("Sq in the inner scar, µm")
    slopes.set_ylabel("rms gradient Sdq in the inner scar, –")
    for panel in axes:
        panel.set(xlim=(0.0, None), ylim=(0.0, None))
    fs.legend_above(heights, columns=4)


@fs.panels(2)
def spectrum(axes: Any, data: "FigureData") -> None:
    """Power spectrum of ball and disc in the inner scar over the wavelength, a line a snapshot."""
    for panel, body, color in zip(axes, ("sphere", "disc"), (fs.SPHERE, fs.DISC), strict=True):
        shown = data.spectra[body]
        for (distance, found), line in zip(shown, fs.in_time(color, len(shown)), strict=True):
            label = f"{distance:.4g} mm" if body == "sphere" else None
            # from mm⁴ to µm⁴
            panel.plot(1e3 * found.wavelength, 1e12 * found.density, label=label, **line)
        panel.set(xscale="log", xlabel="wavelength, µm", title=data.about.name_of(body))
        panel.set_ylabel("power spectral density, µm⁴")
        panel.invert_xaxis()
        fs.logarithmic(panel)
        fs.plain_numbers(panel.xaxis)
    fs.legend_above(axes[0], columns=4)


@fs.panels(2)
def islands(axes: Any, data: "FigureData") -> None:
    """Number of islands of contact over the distance slid, and how their areas are distributed."""
    evolution = data.evolution
    table = evolution.table
    number, sizes = axes
    for name, label, line in (
        ("islands", "all", {"color": fs.CONTACT, "marker": "o"}),
        ("islands_of_one_cell", "of one cell", {"color": fs.HARDNESS, "ls": ":", "marker": "x"}),
    ):
        fs.over_distance(number, table["distance"], table[name], label=label, ms=3, **line)
    fs.scale_distance(number, table["distance"])
    number.set(ylabel="islands of contact, –", ylim=(0.0, None))
    number.legend()
    shades = np.linspace(0.1, 0.9, len(evolution.island_areas))
    for index, (areas, shade) in enumerate(zip(evolution.island_areas, shades, strict=True)):
        falling = np.sort(areas)[::-1]
        label = f"{table['distance'][index]:.4g} mm"
        line = {"color": fs.PRESSURES(shade), "ls": ("-", "--", "-.", ":")[index % 4], "label": label}
        # Islands at least as large: between two areas, those of the larger.
        sizes.step(falling, np.arange(1, falling.size + 1), where="post", **line)
    sizes.set(xscale="log", yscale="log")
    fs.plain_numbers(sizes.xaxis)
    fs.plain_numbers(sizes.yaxis)
    sizes.set(xlabel="area of an island, mm²", ylabel="islands at least as large, –")
    # To a whole decade, and only decades labelled: labels between them would run into each other.
    everything = np.log10(np.concatenate(evolution.island_areas))
    sizes.set_xlim(0.8 * 10.0 ** everything.min(), 10.0 ** np.floor(everything.max() + 1.0))
    sizes.tick_params(axis="x", which="minor", labelbottom=False)
    fs.legend_above(sizes, columns=5)


@fs.panels(height=2.9)
def junctions(axes: Axes, data: "FigureData") -> None:
    """Share of the contact area in islands up to a diameter, a line a snapshot, beside d* and the mesh.

    An island's diameter is that of the circle of its area. The legend says what share of the contact area
    is in islands larger than d*; a study without d* has neither that share nor the line. d* is that of the
    pieces where bodies wear in pieces; one of eq 2.3 that is not it has a line, too.
    """
    evolution = data.evolution
    critical, formula = data.study.critical_diameter, data.study.critical_junction
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
        places, steps = np.append(diameters[0], diameters), np.append(0.0, shares)
        axes.step(places, steps, where="post", label=label, **line)
    mesh = 1e3 * float(diameters_of(np.array([data.result.study.cells.cell_area]))[0])
    axes.axvline(mesh, color=fs.NOMINAL, lw=0.6, label="one cell (mesh limit)")
    if critical is not None:
        axes.axvline(1e3 * critical, color=fs.HARDNESS, lw=1.4, label=f"d* = {1e3 * critical:.3g} µm")
        if formula is not None and formula != critical:
            told = f"{1e3 * formula:.3g} µm by eq 2.3"
            axes.axvline(1e3 * formula, color=fs.HARDNESS, lw=0.8, ls="--", label=told)
    axes.set_xscale("log")
    fs.plain_numbers(axes.xaxis, decades=0.3)
    axes.tick_params(axis="x", which="minor", pad=5.0)  # its labels in line with those of decades
    axes.set(xlabel="diameter of an island, µm", ylabel="cumulative share of contact area, –")
    axes.set_ylim(0.0, 1.02)
    fs.legend_above(axes, columns=2)
