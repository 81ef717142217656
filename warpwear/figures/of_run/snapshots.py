"""Declare figures of the bodies' roughness in the scar and of the islands of contact, over the snapshots."""

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, in_time, over_distance
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.wording import short
from warpwear.grid import FloatArray
from warpwear.laws.junctions import diameters_of, share_above
from warpwear.results.evolution import settling, settling_course

#: Parameter -> line. Sq and Sk are heights of the whole, Spk and Svk of peaks and valleys.
PARAMETERS: dict[str, tuple[str, Look]] = {
    "sk": ("Sk", Look(describe.NOMINAL, "dashdot", marker="D")),
    "svk": ("Svk", Look(describe.TOUCHED, "dash", marker="v")),
    "sq": ("Sq", Look(describe.HARDNESS, marker="o")),
    "sa": ("Sa", Look(describe.SUM, marker="s")),
    "spk": ("Spk", Look(describe.MEAN_PRESSURE, "dot", marker="^")),
}


@words.figure(*words.ROUGHNESS, essential=True, section="roughness")
def roughness(data: FigureData) -> Figure:
    """Height parameters (ISO 25178-2) of the disc in the middle of the scar, its bowl taken off, over the
    sliding distance.
    """
    table = data.evolution.table
    return of_parameters("scar", over_distance(table["distance"]), table["distance"], table)


def of_parameters(place: str, over: Axis, places: FloatArray, table: dict[str, FloatArray]) -> Figure:
    """Show the height parameters of a table over places. place: where on the disc they are measured."""
    lines = [Line(places, table[name], label, look) for name, (label, look) in PARAMETERS.items()]
    title, heights = f"Roughness in the {place}", Axis(f"roughness in the {place}, µm", low=0.0)
    return Figure([Chart(title, over, heights, lines)], legend=5)


@words.figure(words.ONE_SNAPSHOT, words.UNWORN, words.SMOOTH, words.NO_TEXTURE)
def texture(data: FigureData) -> Figure:
    """Root mean square height Sq and gradient Sdq of both bodies in the inner scar over the sliding
    distance; dashed, the exponential course fitted to Sq.

    A disc's Sq is over that of the same cells before wear, times that of the last ones.
    """
    table = data.evolution.table
    heights: list[Line] = []
    slopes: list[Line] = []
    looks = {"counter": Look(describe.COUNTER, marker="o"), "disc": Look(describe.DISC, marker="s")}
    for body, look in looks.items():
        (slid, sq), fit = settling_course(data.result, body), settling(data.result, body)
        name, is_fitted = data.name_of(body), not isinstance(fit, str)
        dots = Look(look.colour, "", marker=look.marker) if is_fitted else look
        heights.append(Line(slid, sq, name, dots, clipped=False))
        if not isinstance(fit, str):  # the fit is the line
            places = np.append(0.0, np.geomspace(1e-3 * slid[slid > 0.0][0], slid[-1], 200))
            level, length = (short(float(f"{value:.2g}")) for value in (fit.equilibrium, fit.length))
            label = f"{name}: to {level} µm over {length} mm"
            heights.append(Line(places, fit.at(places), label, Look(look.colour, "dash", 1.0)))
        slopes.append(Line(table["distance"], table[f"sdq_{body}"], "", look, clipped=False))
    distance = table["distance"]
    over = Axis(describe.DISTANCE, "unworn", least=float(distance[distance > 0.0].min(initial=np.inf)))
    panels = [
        Chart("Height", over, Axis("Sq in the inner scar, µm", low=0.0), heights),
        Chart("Gradient", over, Axis("Sdq in the inner scar, –", low=0.0), slopes),
    ]
    return Figure(panels, legend=4)


@words.figure(words.NO_SNAPSHOT, words.UNWORN, words.SMOOTH, words.NO_SPECTRUM)
def spectrum(data: FigureData) -> Figure:
    """Power spectral density of both bodies in the inner scar {when}."""
    known = [spectrum.density for body in data.spectra.values() for _, spectrum in body]
    ends = 5e11 * min(d.min() for d in known), 2e12 * max(d.max() for d in known)
    density = Axis("power spectral density, µm⁴", "log", *ends)
    panels = []
    for body, colour in (("counter", describe.COUNTER), ("disc", describe.DISC)):
        states = data.spectra[body]
        densities = [(1e3 * s.wavelength, 1e12 * s.density, "") for _, s in states]  # from mm⁴ to µm⁴
        lines = describe.lines_in_time(colour, densities)
        if body == "disc":
            none = np.zeros(0)
            lines += describe.lines_in_time(
                describe.NEUTRAL, [(none, none, data.after(slid)) for slid, _ in states]
            )
        name = data.name_of(body)
        panels.append(Chart(name, Axis("wavelength, µm", "log", inverted=True), density, lines, name))
    return Figure(panels, legend=4, shared="y")


@words.figure(words.SMOOTH_DISC, words.ONE_SNAPSHOT, words.ONLY_SAMPLES)
def islands(data: FigureData) -> Figure:
    """Number of islands of contact over the sliding distance, and of those at least as large as an area
    {when}; islands of one cell are limits of the mesh.
    """
    evolution = data.evolution
    table, areas = evolution.table, evolution.island_areas
    every, single = Look(describe.CONTACT, marker="o"), Look(describe.HARDNESS, "dot", marker="x")
    number = [
        Line(table["distance"], table["islands"], "islands, all", every),
        Line(table["distance"], table["islands_of_one_cell"], "of one cell", single),
    ]
    indices = [index for index in data.indices if areas[index].size]
    labels = [f"right: {data.after(table['distance'][index])}" for index in indices]
    falling = [(np.sort(areas[index])[::-1], np.arange(1.0, areas[index].size + 1)) for index in indices]
    states = [(*both, label) for both, label in zip(falling, labels, strict=True)]
    # Islands at least as large: between two areas, those of the larger.
    sizes = describe.lines_in_time(describe.CONTACT, states, "post")
    # To a whole decade, and only decades labelled: labels between them would run into each other.
    powers = np.log10(np.concatenate([areas[index] for index in indices]))
    ends = 0.8 * 10.0 ** powers.min(), 10.0 ** np.floor(powers.max() + 1.0)
    area = Axis("area of an island, mm²", "log", *ends, numbered=False)
    panels = [
        Chart("Number", over_distance(table["distance"]), Axis("islands of contact, –", low=0.0), number),
        Chart("Areas", area, Axis("islands at least as large, –", "log"), sizes),
    ]
    return Figure(panels, legend=6)


@words.figure(words.SMOOTH_DISC, words.NO_JUNCTIONS, *words.FIELD)
def junctions(data: FigureData) -> Figure:
    """Share of the area in contact that lies in islands larger than a diameter {when}.{critical}

    An island's diameter is that of the circle of its area. Dots mark the share above d*, which the legend
    gives: d* is that of the pieces where bodies wear in pieces, else that of eq 2.3. A study without it has
    neither.
    """
    evolution, critical = data.evolution, data.study.pair.critical_diameter
    indices = [index for index in data.indices if evolution.island_areas[index].size]
    lines: list[Line | Level] = []
    for index, look in zip(indices, in_time(describe.CONTACT, len(indices)), strict=True):
        areas = np.sort(evolution.island_areas[index])
        label = data.after(evolution.table["distance"][index])
        diameters = 1e3 * diameters_of(areas)
        above = 1.0 - np.cumsum(areas) / areas.sum()
        if critical is not None:
            share = share_above(areas, critical)
            label += f": {100.0 * share:.0f} %"
            dot = Look(look.colour, "", marker="o", size=4.0)
            lines.append(Line(np.array([1e3 * critical]), np.array([share]), look=dot))
        # All of the area below the smallest island, none beyond the largest.
        places, steps = np.append(diameters[0] / 2.0, diameters), np.append(1.0, above)
        lines.append(Line(places, steps, label, look, step="post"))
    note = ""
    if critical is not None:
        lines.append(Level(1e3 * critical, look=Look(describe.HARDNESS, width=0.8), axis="x"))
        note = f"share above d* = {1e3 * critical:.3g} µm"
    mesh = 1e3 * float(diameters_of(np.array([data.study.cells.cell_area]))[0])
    diameter = Axis("diameter of an island, µm", "log", low=0.9 * mesh)
    share_axis = Axis("share of area in larger islands, –", low=0.0, high=1.02)
    return Figure([Chart("Junctions", diameter, share_axis, lines, note)], legend=2)
