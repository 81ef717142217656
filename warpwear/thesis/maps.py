"""Declare maps and profiles of the report of the thesis: the versions' fields side by side."""

from dataclasses import replace
from typing import Any

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import Axis, Figure, Line, Look, Map, Scale, in_time
from warpwear.figures.of_run.view import positive
from warpwear.figures.wording import after, with_scatter
from warpwear.grid import FloatArray
from warpwear.thesis.figures import chart, figure, root_through_end
from warpwear.thesis.numbers import Numbers, snapshot_at
from warpwear.thesis.printed import DRAWN_AT
from warpwear.thesis.runs import VERSIONS, Runs

PRESSURE = "pressure, MPa"


def _middle(field: FloatArray, axis: int) -> FloatArray:
    """Take the line through the middle of a field, (nx, ny): along (axis 0) or across (1) sliding."""
    line: FloatArray = np.take(field, field.shape[1 - axis] // 2, axis=1 - axis)
    return line


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
        Line(v2.y, positive(across), "across", Look(describe.CONTACT)),
        Line(v2.x, positive(along), "along", Look(describe.CONTACT, "dash")),
        Line(y, level / (counter + disc * cosine), "closed form", Look(describe.HARDNESS, "dot")),
    ]
    both = np.concatenate([across, along])
    low, high = float(both[both > 0.0].min()), float(both.max())
    pressure = Axis(PRESSURE, low=low - 0.5 * (high - low), high=high + 0.3 * (high - low))
    note = f"{after(last.distance)} (axis not from zero)"
    at_end = chart(lines, pressure, "across or along sliding, mm", note)
    return Figure([v2.plot.declared("hertz").panels[0], at_end], legend=5)


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
    sections = chart(profiles, Axis("height of the disc, µm"), describe.ACROSS)
    return Figure([sections, chart(depths, "depth of the disc, µm")], legend=3)


@figure
def pressure_maps(runs: Runs, numbers: Numbers) -> Figure:
    maps = []
    for name, version in VERSIONS.items():
        pressure: Any = runs[name].plot.declared("pressure_map").panels[0]
        mean, most = float(np.nanmean(pressure.fields[-1])), float(np.nanmax(pressure.fields[-1]))
        scale = Scale(PRESSURE, *((0.0, most) if name == "v3" else (0.98 * mean, 1.02 * mean)))
        scatter = float(runs[name].history["pressure_std"][-1])
        label = f"{version}: {with_scatter(numbers[f'{name}.pressure_end_MPa'], scatter)} MPa"
        maps.append(Map(version, pressure.fields[-1:], pressure.extent, scale, [label]))
    return Figure(maps, columns=2)


@figure
def counter_patches(runs: Runs, numbers: Numbers) -> Figure:
    maps = []
    for name, version in VERSIONS.items():
        along, across = (numbers[f"{name}.patch_{side}_mm"] for side in ("along", "across"))
        wear: Any = runs[name].plot.declared("wear_map").panels[0]
        maps.append(replace(wear, title=version, labels=[f"{version}: {along:.3g} × {across:.3g} mm"]))
    return Figure(maps, columns=2)


@figure
def disc_profiles(runs: Runs, numbers: Numbers) -> Figure:
    panels = []
    for name, version in VERSIONS.items():
        across: Any = runs[name].plot.declared("disc_profiles").panels[-1]
        note = f"{version}: deepest wear {numbers[f'{name}.disc_depth_um']:.3g} µm"
        panels.append(replace(across, lines=[across.lines[0], across.lines[-1]], note=note))
    return Figure(panels, columns=2, legend=2, height=2.3, shared="y")


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
