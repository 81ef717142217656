"""Declare figures of bodies with layers: which material lies bare, and sections through the layers."""

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look, Map
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.shape import cuts_of, told
from warpwear.figures.of_run.view import Fields
from warpwear.figures.wording import short
from warpwear.laws.depth_profile import SUBSTRATE, DepthProfile

#: Colours of layers, from the surface down; a body below them has its own.
COLOURS = (describe.TOUCHED, describe.SUM, describe.CONTACT, describe.MEAN_PRESSURE, describe.NOMINAL)
#: Place of their shades between pale and dark.
PALE = 0.15
#: Depth that a section shows over the deepest wear, and at most for layers of which little is worn.
ROOM, MOST_ROOM = 1.4, 4.0


@words.figure(words.NO_LAYERS, *words.FIELD, essential=True, section="maps")
def material_map(data: FigureData) -> Figure:
    """Which material lies bare {when}.{deepest}"""
    labels, maps = [data.after(distance) for distance in data.distances], []
    for body, profile in data.layered.items():
        fields = [getattr(data.snapshot(i), f"material_{body}") for i in data.indices]
        codes = [data.window.largest(field).astype(np.uint8) for field in fields]
        states, apart = tuple(_shown(data, body, profile)), len(data.layered) > 1
        title = f"Materials of the {data.name_of(body)}"
        maps.append(Map(title, codes, data.window.extent, labels=labels, states=states, heading=apart))
    return Figure(maps, legend=4)


@words.figure(words.NO_LAYERS, *words.FIELD, essential=True, section="profiles")
def layers(data: FigureData) -> Figure:
    """Sections through the layers, through the middle {end}; thin: unworn."""
    panels: list[Chart] = []
    for body, profile in data.layered.items():
        name = data.name_of(body)
        for cut, label, title in cuts_of(data):
            lines, low = _section(data, body, profile, data.views[-1].cuts[cut])
            height = Axis(f"height of the {name}, µm", low=low)
            title = f"Layers of the {name}, {title[0].lower()}{title[1:]}"
            panels.append(Chart(title, Axis(label), height, lines, stretch_factor=1e3))
    return Figure(told(panels), columns=len(cuts_of(data)), legend=4)


def _section(data: FigureData, body: str, profile: DepthProfile, cut: Fields) -> tuple[list[Line], float]:
    """Return what a section through a body shows, heights out of its material, and its lowest height [µm]."""
    surface, wear = (-1.0 if body == "counter" else 1.0) * cut[body], cut[f"wear_{body}"]
    unworn, deepest = surface + wear, float(wear.max())
    depth = max(ROOM * deepest, min(ROOM * profile.depths[-1], MOST_ROOM * deepest or np.inf))
    low = float(np.nanmin(unworn)) - depth
    ends = [*profile.depths[1:], np.inf]
    lines = []
    for (name, colour), begin, end in zip(_shown(data, body, profile), profile.depths, ends, strict=True):
        top, bottom = (1e3 * np.clip(unworn - at, low, surface) for at in (begin, end))
        lines.append(Line(cut["place"], top, name, Look(colour, ""), low=bottom, high=top))
    lines.append(Line(cut["place"], 1e3 * unworn, "unworn", Look(describe.UNWORN, width=0.5)))
    lines.append(Line(cut["place"], 1e3 * surface, "worn", Look(describe.HARDNESS, width=0.8)))
    return lines, 1e3 * low


def _shown(data: FigureData, body: str, profile: DepthProfile) -> list[tuple[str, str]]:
    """Return name and colour of a body's materials from the surface down, layers with their thickness."""
    thick = [short(float(f"{1e3 * depth:.3g}")) for depth in np.diff(profile.depths)]
    named = [f"{m.name}, {depth} µm" for m, depth in zip(profile.materials, thick, strict=False)]
    first = 0 if body == next(iter(data.layered)) else 2  # bodies' first layers differ
    colours = [
        *(COLOURS[(first + layer) % len(COLOURS)] for layer in range(len(named))),
        describe.BODIES[body],
    ]
    return [
        (f"{data.name_of(body)}: {name}", describe.shade(colour, PALE))
        for name, colour in zip((*named, SUBSTRATE), colours, strict=True)
    ]
