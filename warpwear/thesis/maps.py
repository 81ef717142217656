"""Declare maps and profiles of the report of the thesis: the versions' fields side by side."""

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look, Map, Outline, Scale, in_time
from warpwear.figures.of_run.view import Window, positive
from warpwear.figures.wording import after, with_scatter
from warpwear.grid import FloatArray
from warpwear.result import Result
from warpwear.results.formats.bodies import worn_heights
from warpwear.thesis.figures import chart, figure, root_through_end
from warpwear.thesis.numbers import Numbers, snapshot_at
from warpwear.thesis.printed import DRAWN_AT, STROKE
from warpwear.thesis.runs import VERSIONS, Runs

HEIGHT, PRESSURE = "height of the disc, µm", "pressure, MPa"
#: Blocks along a side of a map.
BLOCKS = 300
CONTACT = Look(describe.CONTACT)


def window_of(result: Result) -> Window:
    """Make a window of the whole grid, in blocks that a map can show."""
    n = result.study.cells.nx
    factor = -(-n // BLOCKS)
    part = slice(0, n // factor * factor)
    return Window.of(result.study.cells, part, part, factor=factor)


def _middle(field: FloatArray, axis: int) -> FloatArray:
    """Take the line through the middle of a field, (nx, ny): along (axis 0) or across (1) sliding."""
    line: FloatArray = np.take(field, field.shape[1 - axis] // 2, axis=1 - axis)
    return line


def _start_of(result: Result, axis: int) -> Chart:
    """Show pressures of the first step with Hertz's, along (axis 0) or across (1) sliding."""
    hertz = result.study.hertz
    assert hertz is not None
    places = result.x if axis == 0 else result.y
    reach = max(2.0 * hertz.radius, 3.0 * result.study.grid.cell)
    fine, near = np.linspace(-reach, reach, 400), np.abs(places) <= reach
    pressure = _middle(result.snapshot(0).pressure, axis)[near]
    lines = [
        Line(1e3 * fine, hertz.pressure(np.abs(fine)), "Hertz", Look(describe.HARDNESS, "dash")),
        Line(1e3 * places[near], pressure, "Winkler, first step", CONTACT, step="mid"),
    ]
    return chart(lines, PRESSURE, f"{('along', 'across')[axis]} sliding, µm", "start")


@figure
def pressure_of_v1(runs: Runs, numbers: Numbers) -> Figure:
    v1 = runs["v1"]
    last = v1.snapshot(-1)
    pressure = Axis(PRESSURE, low=0.0, high=1.3 * float(last.pressure.max()))
    line = Line(v1.x, _middle(last.pressure, 0), look=CONTACT, step="mid")
    return Figure(
        [_start_of(v1, 0), chart([line], pressure, "along sliding, mm", after(last.distance))], legend=2
    )


@figure
def pressure_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    v2 = runs["v2"]
    last = v2.snapshot(-1)
    counter, disc = v2.study.wear_coefficients
    across, along = (_middle(last.pressure, axis) for axis in (1, 0))
    y = v2.y[across > 0.0]
    cosine = np.sqrt(1.0 - (y * v2.study.counter.form.curvature) ** 2)
    level = across[v2.y.size // 2] * (counter + disc)
    lines = [
        Line(v2.y, positive(across), "across", CONTACT),
        Line(v2.x, positive(along), "along", Look(describe.CONTACT, "dash")),
        Line(y, level / (counter + disc * cosine), "closed form", Look(describe.HARDNESS, "dot")),
    ]
    both = np.concatenate([across, along])
    low, high = float(both[both > 0.0].min()), float(both.max())
    pressure = Axis(PRESSURE, low=low - 0.5 * (high - low), high=high + 0.3 * (high - low))
    note = f"{after(last.distance)} (axis not from zero)"
    return Figure([_start_of(v2, 1), chart(lines, pressure, "across or along sliding, mm", note)], legend=5)


@figure
def disc_of_v1(runs: Runs, numbers: Numbers) -> Figure:
    v1 = runs["v1"]
    distance, depth = v1.history["distance"], 1e3 * v1.history["wear_depth_disc"]
    snapshots = {s.distance: s for s in (snapshot_at(v1, printed.value) for printed in DRAWN_AT)}
    profiles = [
        Line(v1.y, -1e3 * _middle(snapshot.wear_disc, 1), after(snapshot.distance), look)
        for snapshot, look in zip(snapshots.values(), in_time(describe.DISC, len(snapshots)), strict=True)
    ]
    root = root_through_end(distance, depth, "square root", describe.HARDNESS)
    depths = [Line(distance, depth, "deepest cell", Look(describe.DISC)), root]
    sections = chart(profiles, Axis(HEIGHT), describe.ACROSS)
    return Figure([sections, chart(depths, "depth of the disc, µm")], legend=3)


@figure
def pressure_maps(runs: Runs, numbers: Numbers) -> Figure:
    maps = []
    for name, version in VERSIONS.items():
        window = window_of(runs[name])
        pressure = positive(window.largest(runs[name].snapshot(-1).pressure))
        mean, most = float(np.nanmean(pressure)), float(np.nanmax(pressure))
        scale = Scale(PRESSURE, *((0.0, most) if name == "v3" else (0.98 * mean, 1.02 * mean)))
        scatter = float(runs[name].history["pressure_std"][-1])
        label = f"{version}: {with_scatter(numbers[f'{name}.pressure_end_MPa'], scatter)} MPa"
        maps.append(Map(version, [pressure], window.extent, scale, [label]))
    return Figure(maps, columns=2)


@figure
def counter_patches(runs: Runs, numbers: Numbers) -> Figure:
    maps = []
    for name, version in VERSIONS.items():
        window = window_of(runs[name])
        depth = positive(window.means(1e3 * runs[name].snapshot(-1).wear_counter))
        scale = Scale("wear depth, µm", 0.0, float(np.nanmax(depth)), colours="depths")
        along, across = (numbers[f"{name}.patch_{side}_mm"] for side in ("along", "across"))
        label = f"{version}: {along:.3g} × {across:.3g} mm"
        maps.append(Map(version, [depth], window.extent, scale, [label]))
    return Figure(maps, columns=2)


@figure
def disc_profiles(runs: Runs, numbers: Numbers) -> Figure:
    profiles = {}
    for name in VERSIONS:
        last = runs[name].snapshot(-1)
        worn = 1e3 * _middle(worn_heights(runs[name], last, "disc"), 1)
        profiles[name] = (worn + 1e3 * _middle(last.wear_disc, 1), worn)
    low, high = (float(end([end(both) for both in profiles.values()])) for end in (np.nanmin, np.nanmax))
    room, panels = 0.05 * (high - low), []
    for name, (unworn, worn) in profiles.items():
        lines = [
            Line(runs[name].y, unworn, "unworn", Look(describe.UNWORN, width=0.5)),
            Line(runs[name].y, worn, "worn", Look(describe.DISC)),
        ]
        note = f"{VERSIONS[name]}: deepest wear {numbers[f'{name}.disc_depth_um']:.3g} µm"
        panels.append(chart(lines, Axis(HEIGHT, low=low - room, high=high + room), describe.ACROSS, note))
    return Figure(panels, columns=2, legend=2, height=2.3)


@figure
def contact_areas(runs: Runs, numbers: Numbers) -> Figure:
    v1 = runs["v1"]
    hertz, window = v1.study.hertz, window_of(v1)
    assert hertz is not None
    snapshots = (v1.snapshot(0), snapshot_at(v1, STROKE.value), v1.snapshot(-1))
    contacts = [(snapshot.pressure > 0.0).astype(np.uint8) for snapshot in snapshots]
    areas = [contact.sum() * v1.study.cells.cell_area for contact in contacts]
    times = ["start", *(after(snapshot.distance) for snapshot in snapshots[1:])]
    labels = [f"{when}: {area:.3g} mm²" for when, area in zip(times, areas, strict=True)]
    states = (("no contact", describe.CLEAR), ("in contact", describe.CONTACT))
    ends = (-hertz.radius, hertz.radius, -hertz.radius, hertz.radius)
    circle = Outline(ends, Look(describe.HARDNESS, "dash", 0.8), round=True)
    fields = [window.largest(contact) for contact in contacts]
    return Figure(
        [Map("Contact", fields, window.extent, labels=labels, states=states, outlines=[circle])], legend=2
    )


@figure
def counter_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    first, second = (runs[name].snapshot(-1).wear_counter for name in ("v1", "v2"))
    panels = []
    for wear, label in ((second, "wear of the counter-body, V2, µm"), (second - first, "V2 minus V1, µm")):
        lines = [
            Line(runs["v2"].x, 1e3 * _middle(wear, axis), name, look)
            for axis, name, look in (
                (0, "along sliding", Look(describe.COUNTER)),
                (1, "across sliding", Look(describe.COUNTER, "dash")),
            )
        ]
        panels.append(chart(lines, Axis(label), "distance from the middle, mm"))
    return Figure(panels, legend=2)
