"""Figures of the bodies' shapes: how they stood before sliding, what is left of them and what is gone."""

from dataclasses import replace

import numpy as np

from warpwear.figures import describe
from warpwear.figures.coarse import coarsen
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look, Map, lines_in_time, shade
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.view import Fields, or_nan, positive
from warpwear.grid import FloatArray

#: Where one body is worn this many times as deep as the other, each has a scale of its own.
UNLIKE = 4.0
#: Blocks along a side of a body in 3-D, and of one that a page turns.
RELIEF, TURNED = 70, 250
#: About how many lines of equal height a map has.
CONTOURS = 9
#: Names of counter-bodies that rise from where they touch.
ROUND = ("ball", "counter-body")
#: Length of the arrow of sliding over the domain's side.
ARROW = 0.4
CUTS = (("along", describe.ALONG, "Along the sliding direction"), ("across", describe.ACROSS, "Across it"))
#: What is said above sections, whose heights are in µm and places in mm.
LARGER = "heights drawn {} times as large"


@words.figure(words.NARROW, *words.FIELD, essential=True)
def setup(data: FigureData) -> Figure:
    """The {slider} on the unworn disc at first contact, its near half cut away; heights are exaggerated
    as the figure says.

    Only the ball's far half is drawn, so that the disc below it is seen; the disc is shown as far as it is
    computed.
    """
    study = data.study
    disc, window = 1e3 * data.relief[0], data.relief[1]
    x0, x1, y0, y1 = window.extent
    x, y = np.linspace(x0, x1, 61), np.linspace(0.5 * (y0 + y1), y1, 31)
    approach = float(data.history["approach"][0])
    counter = 1e3 * (or_nan(data.result.unworn_counter(x, y)) - approach)
    low, top, high = float(np.nanmin(disc)), float(np.nanmax(disc)), float(np.nanmax(counter))
    middle, half = 0.5 * (x0 + x1), 0.5 * ARROW * (x1 - x0)
    note = (
        f"{study.counter.title}\n{study.loads}, domain {study.grid.size} wide\n"
        f"heights drawn {{larger}} times as large"
    )
    parts = (
        describe.Relief(disc, describe.DISC, low, top),
        describe.Glass(x, y, counter, describe.COUNTER),
        describe.Arrow(middle - half, middle + half, top + 0.15 * (high - low), "sliding"),
    )
    ends = low, max(high, top) + 0.05 * (high - low)
    return Figure([describe.Box("Setup", window.extent, "height, µm", *ends, parts, note)])


@words.figure(words.SWEPT, words.NARROW, *words.FIELD, words.UNWORN)
def wear_map(data: FigureData) -> Figure:
    """Wear depth of {slider} and disc {end}."""
    when, maps = data.after(data.distances[-1]), []
    depths = {body: 1.0e3 * data.bodies[-1][f"wear_{body}"] for body in describe.BODIES}
    deepest = {body: float(depth.max()) for body, depth in depths.items()}
    unlike = UNLIKE * min(deepest.values()) < max(deepest.values())
    for body, depth in depths.items():
        high, name = deepest[body] if unlike else max(deepest.values()), data.name_of(body)
        scale = describe.Scale("wear depth, µm", 0.0, high or 1.0, colours="depths")
        label = f"{name} {when}{', a scale of its own' * unlike}"
        maps.append(Map(f"Wear of the {name}", [positive(depth)], data.window.extent, scale, [label]))
    return Figure(maps)


@words.figure(words.NARROW, *words.COUNTER_WORN)
def counter_map(data: FigureData) -> Figure:
    """Height of the {slider}, turned over, unworn and at distances slid; lines are of equal height, and
    far apart where it is worn flat.
    """
    return _maps(data, "counter")


@words.figure(words.NARROW, *words.DISC_WORN)
def disc_map(data: FigureData) -> Figure:
    """Height of the disc, unworn and at distances slid, on one scale."""
    return _maps(data, "disc")


@words.figure(words.NARROW, *words.COUNTER_WORN)
def counter_3d(data: FigureData) -> Figure:
    """The {slider}, turned over, unworn and {end}; pale where it is worn."""
    return _surfaces(data, "counter")


@words.figure(words.NARROW, *words.DISC_WORN)
def disc_3d(data: FigureData) -> Figure:
    """The disc, unworn and {end}."""
    return _surfaces(data, "disc")


@words.figure(*words.COUNTER_WORN)
def counter_profiles(data: FigureData) -> Figure:
    """Sections of the {slider} through the middle, unworn and {when}."""
    return _profiles(data, "counter")


@words.figure(*words.DISC_WORN)
def disc_profiles(data: FigureData) -> Figure:
    """Sections of the disc through the middle, unworn and {when}."""
    return _profiles(data, "disc")


def _maps(data: FigureData, body: str) -> Figure:
    bodies = [*zip(data.distances, data.bodies, strict=True)]
    if len(bodies) == 4:  # with the unworn one four panels; the third says least
        del bodies[2]
    labels = ["unworn", *(data.after(distance) for distance, _ in bodies)]
    fields = [1e3 * _unworn(data, body), *(1e3 * worn[body] for _, worn in bodies)]
    name = data.name_of(body)
    is_ball = name == "ball"
    # A ball's flank at the corners would take half of the colours.
    seen = [field[:, field.shape[1] // 2] for field in fields] if is_ball else fields
    low = min(float(np.nanmin(field)) for field in seen)
    high = max(float(np.nanmax(field)) for field in fields)
    # One scale for all: what changes is the disc, not the colours.
    label, contours = f"height of the {name}, µm", CONTOURS if name in ROUND else 0
    scale = describe.Scale(label, low, high, colours="heights", beyond="min" if is_ball else "neither")
    shape = Map(f"Height of the {name}", fields, data.window.extent, scale, labels, contours=contours)
    return Figure([shape])


def _surfaces(data: FigureData, body: str) -> Figure:
    last, extent = data.bodies[-1], data.window.extent
    states = {"unworn": _unworn(data, body), data.after(data.distances[-1]): last[body]}
    states = {state: 1e3 * coarsen(field, RELIEF)[0] for state, field in states.items()}
    name, turned = data.name_of(body), ", turned over" if body == "counter" else ""
    is_ball = name == "ball"
    worn = coarsen((last[f"wear_{body}"] > 0.0).astype(float), RELIEF)[0] if name in ROUND else None
    # A cap's corners do not set the scale.
    seen = [_cap(field) if is_ball else field for field in states.values()]
    ends = min(float(np.nanmin(field)) for field in seen), max(float(np.nanmax(field)) for field in seen)
    boxes = []
    for state, field in states.items():
        scar = worn if state != "unworn" else None
        pale = " (pale: worn)" if scar is not None else ""
        note = f"{name}{turned}, {state}{pale}\nheights drawn {{larger}} times as large"
        surface = describe.Relief(field, describe.BODIES[body], *ends, scar, cap=is_ball)
        boxes.append(describe.Box(f"{name} {state}", extent, "height, µm", *ends, [surface], note))
    return Figure(boxes)


def _unworn(data: FigureData, body: str) -> FloatArray:
    """Return the unworn shape of a body [mm]: the mean of the worn shape plus the mean of the wear."""
    return data.bodies[-1][body] + data.bodies[-1][f"wear_{body}"]


def _cap(field: FloatArray) -> FloatArray:
    """Return a field with NaN beyond the largest circle."""
    x, y = (np.linspace(-1.0, 1.0, n) for n in field.shape)
    return np.where(np.add.outer(x**2, y**2) <= 1.0, field, np.nan)


def _profiles(data: FigureData, body: str) -> Figure:
    views = data.views
    sign = -1.0 if body == "counter" else 1.0  # heights are positive out of the material
    panels: list[Chart] = []
    for cut, label, title in cuts_of(data):
        first = views[0].cuts[cut]
        unworn = sign * first[body] + first[f"wear_{body}"]
        lines = [Line(first["place"], 1e3 * unworn, "unworn", Look(describe.UNWORN, width=0.5))]
        states = [
            (v.cuts[cut]["place"], 1e3 * sign * v.cuts[cut][body], data.after(v.distance)) for v in views
        ]
        lines += lines_in_time(describe.BODIES[body], states)
        panels.append(Chart(title, Axis(label), Axis("height, µm"), lines, stretch_factor=1e3))
    return Figure(told(panels), legend=len(views) + 1, shared="y")


def cuts_of(data: FigureData) -> tuple[tuple[str, str, str], ...]:
    """Return the sections through the middle; one row of cells has none across sliding."""
    return CUTS if data.study.cells.ny > 1 else CUTS[:1]


def told(panels: list[Chart]) -> list[Chart]:
    """Say over the first of some sections how much larger heights are drawn."""
    return [replace(panels[0], stretch_note=LARGER), *panels[1:]]


@words.figure(*words.FIELD, essential=True, section="profiles")
def profiles(data: FigureData) -> Figure:
    """Sections of both bodies through the middle in contact {end}, and without their wear."""
    last = data.views[-1]
    approach, slider = float(data.history["approach"][last.row]), data.slider
    cuts = [last.cuts[name] for name, *_ in cuts_of(data)]
    worn = any(cut[f"wear_{body}"].any() for cut in cuts for body in describe.BODIES)
    ends = [_seen(cut, approach) for cut in cuts]
    low, high = min(low for low, _ in ends), max(high for _, high in ends)
    room = 0.05 * (high - low)
    heights = Axis("height over the disc, µm", low=1e3 * (low - room), high=1e3 * (high + room))
    state = ", worn" if worn else ""
    panels: list[Chart] = []
    for cut, (_, label, title) in zip(cuts, cuts_of(data), strict=True):
        counter, disc = cut["counter"] - approach, cut["disc"]
        bodies = [
            (disc + cut["wear_disc"], "disc, unworn", Look(shade(describe.DISC, 0.0), width=0.5)),
            (counter - cut["wear_counter"], f"{slider}, unworn", Look(describe.COUNTER, "dash", 0.7)),
            (counter, f"{slider}{state}", Look(describe.COUNTER, width=2.6, alpha=0.4)),
            (disc, f"disc{state}", Look(describe.DISC, width=0.8)),
        ]
        lines = [Line(cut["place"], 1e3 * y, name, look) for y, name, look in bodies[0 if worn else 2 :]]
        panels.append(Chart(title, Axis(label), heights, lines, stretch_factor=1e3))
    return Figure(told(panels), legend=4, shared="y")


def _seen(cut: Fields, approach: float) -> tuple[float, float]:
    """Return the heights between which both bodies are to be seen [mm]."""
    counter, unworn_disc = cut["counter"] - approach, cut["disc"] + cut["wear_disc"]
    lowest = unworn_disc, cut["disc"], counter - cut["wear_counter"]
    bottom = min(float(np.nanmin(heights)) for heights in lowest)
    rise = float(np.nanmax(counter) - np.nanmin(counter))
    return bottom, max(float(np.nanmax(unworn_disc)), float(np.nanmin(counter)) + 0.25 * rise)


def turned_bodies(data: FigureData) -> Figure:
    """Both bodies at the end and before, which a page's reader turns by hand."""
    last, window = data.bodies_at(data.indices[-1], most=TURNED), data.window_of(TURNED)
    slider, side = data.slider, 1e3 * window.factor * data.study.grid.cell
    heights: Fields = {}
    for body, name in (("disc", "disc"), ("counter", slider)):
        heights |= {f"{name}, worn": last[body], f"{name}, before": last[body] + last[f"wear_{body}"]}
    note = (
        f"Mean heights of squares of {side:.3g} µm, positive out of the material, so that the {slider} lies "
        "turned over. Heights are drawn larger than places. Drag to turn, wheel to zoom; on the keyboard the "
        "arrow keys, + and −."
    )
    known = {name: 1e3 * field for name, field in heights.items() if np.isfinite(field).any()}
    still = [name for name in known if name.endswith("worn")]
    return Figure([describe.Scene("The bodies", window.extent, known, still, note)])
