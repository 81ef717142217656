"""Figures of the bodies' roughness in the scar and of the islands of contact, over the snapshots."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.figures.axes import panels, share
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


@panels()
def roughness(axes: Axes, data: "FigureData") -> None:
    """Height parameters of the disc in the middle of the scar, its bowl taken off, over the distance slid."""
    table = data.roughness
    for name, (label, line) in PARAMETERS.items():
        fs.over_distance(axes, table["distance"], table[name], label=label, ms=3, **line)
    fs.scale_distance(axes, table["distance"])
    axes.set(ylabel="roughness in the scar, µm", ylim=(0.0, None))
    fs.legend_above(axes, columns=5)


@panels(2)
def texture(axes: Any, data: "FigureData") -> None:
    """Sq and rms gradient Sdq of ball and disc in the inner scar over the distance, with fits of Sq.

    A disc's Sq is over that of the same cells before wear, times that of the last ones.
    """
    table = data.roughness
    heights, slopes = axes
    for body, color, mark in (("sphere", fs.SPHERE, "o"), ("disc", fs.DISC, "s")):
        line: dict[str, Any] = {"color": color, "marker": mark, "ms": 3, "clip_on": False}
        slid, sq, fit = data.settling[body]
        name = data.about.name_of(body)
        dots = line if isinstance(fit, str) else line | {"ls": "none"}
        heights.plot(slid, sq, label=name, **dots)
        if not isinstance(fit, str):  # the fit is the line
            places = np.append(0.0, np.geomspace(1e-3 * slid[slid > 0.0][0], slid[-1], 200))
            level, length = (fs.short(float(f"{value:.2g}")) for value in (fit.equilibrium, fit.length))
            told = f"{name}: to {level} µm over {length} mm"
            heights.plot(places, fit.at(places), color=color, ls="--", lw=1.0, label=told)
        slopes.plot(table["distance"], table[f"sdq_{body}"], **line)
    heights.set_ylabel("Sq in the inner scar, µm")
    slopes.set_ylabel("Sdq in the inner scar, –")
    share(slopes, heights, "x")
    for panel in (slopes, heights):
        panel.set_ylim(0.0, None)
        fs.scale_from_unworn(panel, table["distance"], "sliding distance, mm")
    fs.legend_above(heights, columns=4)


@panels(2)
def spectrum(axes: Any, data: "FigureData") -> None:
    """Power spectrum of ball and disc in the inner scar over the wavelength, a line a snapshot."""
    for panel, body, color in zip(axes, ("sphere", "disc"), (fs.SPHERE, fs.DISC), strict=True):
        shown = data.spectra[body]
        for (distance, found), line in zip(shown, fs.in_time(color, len(shown)), strict=True):
            # from mm⁴ to µm⁴
            panel.plot(1e3 * found.wavelength, 1e12 * found.density, **line)
            if body == "disc":
                panel.plot([], [], label=fs.after(distance), **line | {"color": fs.NEUTRAL})
        panel.set(xscale="log", xlabel="wavelength, µm", title=data.about.name_of(body))
        fs.logarithmic(panel)
        fs.plain_numbers(panel.xaxis)
    densities = [found.density for body in data.spectra.values() for _, found in body]
    ends = 5e11 * min(d.min() for d in densities), 2e12 * max(d.max() for d in densities)
    axes[1].tick_params(which="both", labelleft=False)
    axes[0].set_ylabel("power spectral density, µm⁴")
    for panel in axes:
        panel.set_ylim(ends)
        panel.xaxis.set_inverted(True)
    fs.legend_above(axes[1], columns=4)


@panels(2)
def islands(axes: Any, data: "FigureData") -> None:
    """Number of islands of contact over the distance slid, and how their areas are distributed."""
    evolution = data.evolution
    table = evolution.table
    number, sizes = axes
    for name, label, line in (
        ("islands", "islands, all", {"color": fs.CONTACT, "marker": "o"}),
        ("islands_of_one_cell", "of one cell", {"color": fs.HARDNESS, "ls": ":", "marker": "x"}),
    ):
        fs.over_distance(number, table["distance"], table[name], label=label, ms=3, **line)
    fs.scale_distance(number, table["distance"])
    number.set(ylabel="islands of contact, –", ylim=(0.0, None))
    shown = [index for index in data.shown if evolution.island_areas[index].size]
    for index, line in zip(shown, fs.in_time(fs.CONTACT, len(shown)), strict=True):
        falling = np.sort(evolution.island_areas[index])[::-1]
        label = f"right: {fs.after(table['distance'][index])}"
        # Islands at least as large: between two areas, those of the larger.
        sizes.step(falling, np.arange(1, falling.size + 1), where="post", label=label, **line)
    sizes.set(xscale="log", yscale="log")
    fs.plain_numbers(sizes.xaxis)
    fs.plain_numbers(sizes.yaxis)
    sizes.set(xlabel="area of an island, mm²", ylabel="islands at least as large, –")
    # To a whole decade, and only decades labelled: labels between them would run into each other.
    everything = np.log10(np.concatenate([evolution.island_areas[index] for index in shown]))
    sizes.set_xlim(0.8 * 10.0 ** everything.min(), 10.0 ** np.floor(everything.max() + 1.0))
    sizes.tick_params(axis="x", which="minor", labelbottom=False)
    fs.legend_above(*axes, columns=6)


@panels()
def junctions(axes: Axes, data: "FigureData") -> None:
    """Share of the contact area in islands larger than a diameter, a line a snapshot.

    An island's diameter is that of the circle of its area. Dots mark the share above d*, which the legend
    gives: d* is that of the pieces where bodies wear in pieces, else that of eq 2.3. A study without it has
    neither.
    """
    evolution, critical = data.evolution, data.study.critical_diameter
    shown = [index for index in data.shown if evolution.island_areas[index].size]
    for index, line in zip(shown, fs.in_time(fs.CONTACT, len(shown)), strict=True):
        areas = np.sort(evolution.island_areas[index])
        label = fs.after(evolution.table["distance"][index])
        diameters = 1e3 * diameters_of(areas)
        above = 1.0 - np.cumsum(areas) / areas.sum()
        if critical is not None:
            share = share_above(areas, critical)
            label += f": {100.0 * share:.0f} %"
            axes.plot(1e3 * critical, share, "o", ms=4, color=line["color"], zorder=3)
        # All of the area below the smallest island, none beyond the largest.
        places, steps = np.append(diameters[0] / 2.0, diameters), np.append(1.0, above)
        axes.step(places, steps, where="post", label=label, **line)
    if critical is not None:
        axes.axvline(1e3 * critical, color=fs.HARDNESS, lw=0.8)
        axes.set_title(f"share above d* = {1e3 * critical:.3g} µm")
    axes.set_xscale("log")
    fs.plain_numbers(axes.xaxis)
    mesh = 1e3 * float(diameters_of(np.array([data.result.study.cells.cell_area]))[0])
    axes.set(xlabel="diameter of an island, µm", ylabel="share of area in larger islands, –")
    axes.set(xlim=(0.9 * mesh, None), ylim=(0.0, 1.02))
    fs.legend_above(axes, columns=2)
