"""Declare figures of fields: pressure, state of contact, loads of patches; as maps, in 3-D, as lines."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpwear.figures import describe
from warpwear.figures.coarse import coarsen
from warpwear.figures.describe import Axis, Box, Chart, Figure, Line, Look, Map, Scale, Towers
from warpwear.figures.of_run import words
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.view import Cutout, FilmState, State, positive
from warpwear.figures.wording import with_scatter
from warpwear.grid import FloatArray
from warpwear.history.quantities import FIELDS, Quantity
from warpwear.laws import archard
from warpwear.laws.patches import Patches

STATES = {
    State.UNTOUCHED: ("never touched", describe.CLEAR),
    State.TOUCHED: ("touched before", describe.TOUCHED),
    State.IN_CONTACT: ("in contact", describe.CONTACT),
    State.AT_HARDNESS: ("at hardness", describe.HARDNESS),
}
FILMS = {
    FilmState.ELSEWHERE: ("neither bare nor in contact", describe.CLEAR),
    FilmState.BARE_BESIDE: ("bare, not in contact", "#DDDDDD"),
    FilmState.ON_FILM: ("in contact on film", describe.TOUCHED),
    FilmState.ON_METAL: ("in contact, bare", describe.DISC),
}
#: Percentage of places whose pressure may lie below a logarithmic scale, and its largest span.
BELOW, SPAN = 2.0, 1e3
#: Towers along a side.
TOWERS = 45
#: Half the width shown over the wider of two contacts.
MARGIN = 1.3
#: Patches beside the one that is zoomed into, on each side; snapshots that are zoomed into.
NEIGHBOURS, ZOOMED = 1, 2


def pressure_scale(fields: Sequence[FloatArray], means: Sequence[float], label: str) -> Scale:
    """Choose one scale for pressures: logarithmic where they span much, else linear from 0.

    fields: [MPa], of any shape, 0 where there is no contact; means: of the pressure in contact of each [MPa].
    """
    most = max(float(field.max()) for field in fields)
    if most <= describe.WIDE * min(means):
        return Scale(label, 0.0, most or 1.0)
    low = min(float(np.percentile(field[field > 0.0], BELOW)) for field in fields if field.any())
    return Scale(label, max(0.8 * low, most / SPAN), most, log=True, beyond="min")


@words.figure(*words.FIELD, essential=True, section="maps")
def pressure_map(data: FigureData) -> Figure:
    """Pressure of the cells in contact {when}, all on one scale; above each its mean and standard
    deviation over these cells.{blocks}
    """
    means, scatter = (data.history[name] for name in ("pressure_mean", "pressure_std"))
    fields, rows = [view.pressure for view in data.views], [view.row for view in data.views]
    scale = pressure_scale(fields, [means[row] for row in rows], "pressure in contact, MPa")
    notes = [f"{with_scatter(float(means[row]), float(scatter[row]))} MPa" for row in rows]
    theory = [_hertz_line(data.study.hertz)] if data.study.hertz else []
    return of_views(data, "Pressure in contact", [*map(positive, fields)], notes, *theory, scale=scale)


def _hertz_line(theory: Any) -> Line:
    """Draw Hertz's pressure along sliding, of unworn smooth bodies."""
    r = np.linspace(-theory.semi_axes[0], theory.semi_axes[0], 401)
    return Line(r, theory.pressure(np.abs(r)), "Hertz, unworn bodies", Look(describe.NEUTRAL, "dash"))


def of_views(
    data: FigureData, title: str, fields: Sequence[Any], notes: Sequence[str], *beside: Line, **more: Any
) -> Figure:
    """Lay out a map of each snapshot shown; notes: what is said above each. more: of the `Map`.

    Of a line contact the fields are lines along sliding, with others beside them.
    """
    labels = [data.after(view.distance) for view in data.views]
    if words.NARROW.applies(data):
        rows = [np.nan_to_num(field).mean(axis=1) for field in fields]
        x = np.linspace(*data.window.extent[:2], 2 * rows[0].size + 1)[1::2]
        lines = describe.lines_in_time(
            describe.CONTACT, [(x, *row) for row in zip(rows, labels, strict=True)]
        )
        axes = Axis(describe.ALONG), Axis(more["scale"].label, low=0.0)
        return Figure([Chart(title, *axes, [*lines, *beside])], legend=2)
    panel = Map(title, fields, data.window.extent, labels=labels, notes=notes, **more)
    return Figure([panel], legend=4 if len(fields) > 1 else 2)


@words.figure(words.NARROW, *words.FIELD)
def pressure_3d(data: FigureData) -> Figure:
    """Load over area of coarse squares, cells without contact included, at the first and the last
    distance kept; axes differ, colours are of one scale.
    """
    indices = sorted({data.indices[0], data.indices[-1]})
    fields = [coarsen(data.window.means(data.snapshot(index).pressure), TOWERS) for index in indices]
    # The axes differ, as the pressures do; the colours are of one scale.
    means = [float(field[field > 0.0].mean()) for field, _ in fields]
    scale = pressure_scale([field for field, _ in fields], means, "pressure, MPa")
    boxes = []
    for index, (pressure, blocks) in zip(indices, fields, strict=True):
        side = blocks * data.window.factor * data.study.grid.cell
        when = data.after(data.snapshot(index).distance)
        towers = Towers(pressure, (data.window.extent[0], data.window.extent[2]), side, scale)
        note = f"{when}\nload over area, {1e3 * side:.3g} µm squares"
        top = 1.15 * float(pressure.max())
        boxes.append(Box(f"Pressure {when}", data.window.extent, scale.label, 0.0, top, [towers], note))
    return Figure(boxes)


@words.figure(*words.FIELD)
def pressure_profiles(data: FigureData) -> Figure:
    """Pressure along and across sliding in a strip through the middle {when}, means that include cells
    without contact.
    """
    tops = [float(max(cut["pressure"].max() for cut in view.cuts.values())) for view in data.views]
    seen = [top for top in tops if top > 0.0]
    widths = [*dict.fromkeys(f"{1e3 * strip:.3g}" for strip in data.strips)]
    mean = "mean of " if len(widths) == 1 else ""
    label = f"pressure, {mean}middle {' and '.join(widths)} µm, MPa"
    pressure = Axis(label, low=0.0, high=1.15 * max(tops) or None)
    if seen and max(seen) > describe.WIDE * min(seen):
        pressure = Axis(label, "log", 0.2 * min(seen), 1.5 * max(seen))
    panels = []
    ways = (("along", describe.ALONG, "Along sliding"), ("across", describe.ACROSS, "Across it"))
    for cut, place, title in ways[: data.study.cells.ny]:
        states = [(v.cuts[cut]["bins"], v.cuts[cut]["pressure"], data.after(v.distance)) for v in data.views]
        lines = describe.lines_in_time(describe.CONTACT, states)
        panels.append(Chart(title, Axis(place), pressure, lines))
    return Figure(panels, legend=4, shared="y")


@words.figure(words.NARROW, *words.FIELD, essential=True, section="maps")
def contact_map(data: FigureData) -> Figure:
    """State of the cells {when}; above each the area in contact.{blocks}"""
    area = data.history["area_contact"]
    notes = [f"{area[view.row]:.3g} mm² in contact" for view in data.views]
    fields = [view.state for view in data.views]
    return of_views(data, "State of contact", fields, notes, states=tuple(STATES.values()))


@words.figure(words.NO_FILM, words.NARROW, *words.FIELD, essential=True, section="maps")
def bare_map(data: FigureData) -> Figure:
    """Where the film is gone {when}; above each the bare part of the area in contact.{blocks}"""
    fraction = data.history["bare_fraction"]
    notes = [f"{100.0 * fraction[view.row]:.3g} % of the contact bare" for view in data.views]
    fields = [view.film for view in data.views]
    return of_views(data, "Where the film is gone", fields, notes, states=tuple(FILMS.values()))


def _declare_map(quantity: Quantity) -> None:
    """Declare the map of a field by what is said of it among the quantities."""

    def declare(data: FigureData) -> Figure:
        fields = []
        for snapshot in map(data.snapshot, data.indices):
            values = quantity.scaled(snapshot.fields[quantity.name])
            on_track = quantity.frame == "disc" and snapshot.row is not None
            fields.append(data.window.means(snapshot.beneath(values) if on_track else values))
        low, high = min(float(field.min()) for field in fields), max(float(field.max()) for field in fields)
        scale = Scale(quantity.axis, low if quantity.signed else 0.0, high if high > low else 1.0)
        notes = [f"{field.max():.3g} {quantity.unit} at most" for field in fields]
        drawn = fields if quantity.signed else [*map(positive, fields)]
        return of_views(data, quantity.label.capitalize(), drawn, notes, scale=scale)

    declare.__name__, declare.__module__ = f"{quantity.name}_map", __name__
    declare.__doc__ = f"{quantity.label.capitalize()} {{when}}: {quantity.meaning}.{{blocks}}"
    without = words.Reason("no_field", lambda data: not quantity.applies_to(data.study))
    words.figure(without, *words.FIELD, essential=True, section="maps")(declare)


for _quantity in FIELDS.values():
    if _quantity.map:
        _declare_map(_quantity)


@words.figure(words.ROUGH, words.NO_HERTZ, words.NO_SNAPSHOT, essential=True)
def hertz(data: FigureData) -> Figure:
    """Pressure along sliding through the middle at the first and the last distance kept, beside Hertz's
    of the unworn bodies.
    """
    theory, places, row = data.study.hertz, data.result.x, data.result.y.size // 2
    assert theory is not None  # or the figure is left out
    unworn = _hertz_line(theory)
    panels: list[Chart] = []
    for index in (data.indices[0], data.indices[-1]):
        snapshot = data.snapshot(index)
        values = np.array(snapshot.pressure[:, row])
        seen = np.flatnonzero(values > 0.0)
        seen = np.arange(max(seen[0] - 1, 0), min(seen[-1] + 2, values.size))
        look = Look(describe.MEAN_PRESSURE)
        worn = Line(places[seen], values[seen], "elastic foundation", look, step="mid")
        half = MARGIN * max(theory.semi_axes[0], float(np.abs(places[seen]).max()))
        pressure = Axis("pressure, MPa", low=0.0)
        if panels:
            median = float(np.median(snapshot.pressure[snapshot.pressure > 0.0]))
            ends = 0.3 * median, 2.0 * theory.peak_pressure
            pressure = Axis("pressure, MPa", "log", *ends)
        when, along = data.after(snapshot.distance), Axis(describe.ALONG, low=-half, high=half, ticks=5)
        panels.append(Chart(when, along, pressure, [unworn, worn], when))
    return Figure(panels, legend=2)


@words.figure(words.SWEPT_FACTOR, words.NO_FACTOR, words.NO_SNAPSHOT)
def distance_factor(data: FigureData) -> Figure:
    """Sliding distance of cells of the disc over that of the middle."""
    study, window, kind = data.study, data.window, data.study.wear.distance_factor
    factors = archard.distance_factor(study.cells, kind, curvature=study.counter.form.curvature)
    whole = np.broadcast_to(factors, study.cells.shape)
    part, label = whole[window.x, window.y], "relative sliding distance, –"
    scale = Scale(label, float(part.min()), float(part.max()), colours="heights")
    line = Line(study.cells.y[window.y], whole[study.cells.nx // 2, window.y], look=Look(describe.DISC))
    across = Chart("Across", Axis(describe.ACROSS), Axis(label), [line], "1 = sliding distance in the middle")
    return Figure([Map("Factor", [part], window.extent, scale), across], height=2.9)


@words.figure(*words.PATCHES, essential=True, section="load_share")
def load_share(data: FigureData) -> Figure:
    """Load of each patch over its area {when}{smooth}."""
    loads, labels = data.loads, [data.after(distance) for distance in data.distances]
    fields = [field for shares in loads.of.values() for field in shares]
    means = [float(field[field > 0.0].mean()) for field in fields]
    scale = pressure_scale(fields, means, "load over area, MPa")
    apart = ["prescribes them"] * len(labels)
    if not loads.prescribed:
        apart = [f"{100.0 * part:.2g} % of the load elsewhere" for part in loads.apart]
    maps: list[Map] = []
    for name, shares in loads.of.items():
        when, said = ((), apart) if maps else (labels, ())
        maps.append(Map(name, [*map(positive, shares)], loads.window.extent, scale, when, said, heading=True))
    return Figure(maps)


@words.figure(*words.PATCHES)
def patch_zoom(data: FigureData) -> Figure:
    """From the load of the patches to the pressure of the cells of one that carries half of the most.

    At the first two snapshots shown: later patches are worn smooth, and the most loaded are so first. Grey is
    what no patch covers.
    """
    patches, window = data.study.patch_layout, data.loads.window
    maps = []
    for index in data.indices[:ZOOMED]:
        snapshot = data.snapshot(index)
        share = data.result.load_share[data.row_of(snapshot.distance)]
        half = int(np.where(share > 0.0, np.abs(share - 0.5 * share.max()), np.inf).argmin())
        square = (share / patches.area).reshape(patches.across, patches.across)
        carried = square[window.x, window.y]
        near, alone = (_around(patches, half, neighbours) for neighbours in (NEIGHBOURS, 0))
        top = float(snapshot.pressure[near.x, near.y].max())
        loads = Scale("load/area, MPa", 0.0, float(carried.max()))
        title = f"{data.after(snapshot.distance)}: patches"
        maps.append(Map(title, [positive(carried)], window.extent, loads, [title], frames=[near.extent]))
        parts = {"around one of them": (near, [alone.extent])}
        parts[f"this patch: {share[half]:.3g} N"] = (alone, [])
        for title, (part, frame) in parts.items():
            pressure, hidden = (cut[part.x, part.y] for cut in (snapshot.pressure, np.isnan(snapshot.gap)))
            more: dict[str, Any] = {"frames": frame, "hidden": hidden}
            scale = Scale("pressure, MPa", 0.0, top)
            maps.append(Map(title, [positive(pressure)], part.extent, scale, [title], **more))
    return Figure(maps, columns=3)


def _around(patches: Patches, patch: int, neighbours: int) -> Cutout:
    """Find the cells of a patch, or with neighbours of its macro cell and those beside it."""
    starts, pitch = (int(patches.first_row[patch]), int(patches.first_column[patch])), patches.pitch
    parts = [slice(start, start + patches.side) for start in starts]
    if neighbours:
        places = divmod(patch, patches.across)
        ends = [(max(place - neighbours, 0), min(place + neighbours + 1, patches.across)) for place in places]
        parts = [slice(low * pitch, high * pitch) for low, high in ends]
    return Cutout.of(patches.domain, parts[0], parts[1])
