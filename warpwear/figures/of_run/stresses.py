"""Declare figures of the stresses below the disc's surface: in a plane through the middle, and by depth."""

from typing import Any

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Level, Line, Look, Map, Scale
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.grid import FloatArray
from warpwear.history.quantities import BY_NAME, MEASURES, OF_A_CYCLE
from warpwear.history.snapshot import extents

#: Points of a map in depth.
POINTS = 120
#: A limit beyond so many times the largest value is not drawn.
NEAR = 3.0


def _unit(data: FigureData) -> tuple[float, str, str]:
    """Return the length of an axis's unit [mm], how a label ends in it, and what is said of it.

    It is half the width of the last contact in the plane, or a millimetre where that fills the domain.
    """
    number = _along(data)
    along = extents(data.snapshot(data.indices[-1]).pressure > 0.0)[number]
    width = (along.stop - along.start) * data.study.grid.cell
    if width >= data.study.grid.sides[number] or not width:
        return 1.0, ", mm", ""
    return 0.5 * width, "/a, –", f"a = {0.5 * width:.3g} mm, half the contact's width"


def _along(data: FigureData) -> int:
    """Return the axis along the plane: 0 where it is one of y, else 1."""
    return "yx".index(data.study.output.stress_plane[0])


def _limit(data: FigureData, measure: str) -> tuple[str, float | None]:
    """Return name and value [MPa] of the limit that a measure of stress is held against."""
    if measure in OF_A_CYCLE and data.study.fatigue is not None:
        return "limit in torsion", data.study.fatigue.torsion
    return "yield strength", data.study.pair.yield_strength


@words.figure(words.NO_STRESSES, words.NO_SNAPSHOT, essential=True, section="stresses")
def stress_map(data: FigureData) -> Figure:
    """Stresses below the disc in the plane {plane} {end}, under pressure and friction towards greater x, over
    half the contact's width, a; between the depths that were computed by straight lines.
    """
    index, table = data.indices[-1], data.result.stresses
    unit, suffix, note = _unit(data)
    depths = table["depth"][index]
    levels = np.linspace(depths[0], depths[-1], 2 * POINTS + 1)[1::2]
    half, across = 0.5 * data.study.grid.sides[_along(data)] / unit, f"{'xy'[_along(data)]}{suffix}"
    extent, notes = (-half, half, -depths[-1] / unit, -depths[0] / unit), [note] if note else []
    panels: list[Map] = []
    for measure in ("mises", "principal", *(OF_A_CYCLE if data.study.fatigue else ())):
        plane: FloatArray = table[f"{measure}_plane"][index]
        field = np.array([np.interp(levels, depths, column) for column in plane.T])[:, ::-1]
        scale = Scale(BY_NAME[measure].axis, 0.0, max(float(plane.max()), 1e-9), beyond="min")
        label, more = BY_NAME[measure].label, dict[str, Any](x=across, y=f"−z{suffix}")
        name, limit = _limit(data, measure)
        said = [] if panels else notes
        if limit is not None and (field > limit).any() and measure != "principal":
            more["regions"] = [(field > limit, Look(describe.HARDNESS, "dash", 1.0))]
            said = [*said, f"dashed: {name}, {limit:g} MPa"]
        panels.append(Map(label, [field], extent, scale, [label], ["\n".join(said)], square=False, **more))
    return Figure(panels, columns=2)


@words.figure(words.NO_STRESSES, words.NO_SNAPSHOT, essential=True, section="stresses")
def stress_depths(data: FigureData) -> Figure:
    """Largest stresses of each depth below the disc at the first snapshot (dotted) and {end}, with the yield
    strength, and of a cycle in which friction turns round with the limit in torsion.
    """
    table = data.result.stresses
    unit, suffix, note = _unit(data)
    over = Axis(f"depth z{suffix}", low=0.0)
    panels: list[Chart] = []
    for title, measures in (("Stress", MEASURES), ("Cycle", OF_A_CYCLE))[: 1 + bool(data.study.fatigue)]:
        lines: list[Line | Level] = []
        for measure in measures:
            quantity = BY_NAME[measure]
            colour = getattr(describe, quantity.colour)
            ends = {data.indices[0]: ("", Look(colour, "dot"))}
            for index, how in (ends | {data.indices[-1]: (quantity.short, Look(colour))}).items():
                lines.append(Line(table["depth"][index] / unit, table[measure][index], *how))
        most, (name, limit) = (
            max(float(table[measure].max()) for measure in measures),
            _limit(data, measures[0]),
        )
        said = [] if panels else [note]
        if limit is not None and limit < NEAR * most:
            lines.append(Level(limit, look=Look(describe.HARDNESS, "dash", 0.8)))
            said.append(f"dashed: {name}, {limit:g} MPa")
        panels.append(Chart(title, over, Axis(BY_NAME[measures[0]].family_axis), lines, "\n".join(said)))
    return Figure(panels, legend=5)
