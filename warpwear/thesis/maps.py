"""Maps and profiles of the report of the thesis: the versions' fields side by side."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Circle

from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS, draw_map, panels_of
from warpwear.figures.of_run.view import Window, positive
from warpwear.grid import FloatArray
from warpwear.result import Result
from warpwear.results.formats.bodies import worn_heights
from warpwear.thesis.figures import Gallery
from warpwear.thesis.numbers import Numbers, snapshot_at
from warpwear.thesis.printed import DRAWN_AT, STROKE
from warpwear.thesis.runs import VERSIONS, Runs

FIGURES = Gallery()
figure = FIGURES.figure
HEIGHT = "height of the disc, µm"
#: Labels of two panels, of which the second is plain from the first.
PRESSURE = ("pressure, MPa", "")
#: Blocks along a side of a map.
BLOCKS = 300


def window_of(result: Result) -> Window:
    """Make a window of the whole grid, in blocks that a map can show."""
    n = result.study.cells.nx
    factor = -(-n // BLOCKS)
    shown = slice(0, n // factor * factor)
    return Window.of(result.study.cells, shown, shown, factor=factor)


def _middle(field: FloatArray, axis: int) -> FloatArray:
    """Take the line through the middle of a field, (nx, ny): along (axis 0) or across (1) sliding."""
    line: FloatArray = np.take(field, field.shape[1 - axis] // 2, axis=1 - axis)
    return line


def _start_of(axes: Axes, result: Result, axis: int) -> None:
    """Draw pressures of the first step with Hertz's, along (axis 0) or across (1) sliding."""
    hertz = result.study.hertz
    assert hertz is not None
    places = result.x if axis == 0 else result.y
    reach = max(2.0 * hertz.radius, 3.0 * result.study.grid.cell)
    fine = np.linspace(-reach, reach, 400)
    shown = np.abs(places) <= reach
    axes.plot(1e3 * fine, hertz.pressure(np.abs(fine)), color=fs.HARDNESS, ls="--", label="Hertz")
    pressure = _middle(result.snapshot(0).pressure, axis)[shown]
    axes.step(1e3 * places[shown], pressure, where="mid", color=fs.CONTACT, label="Winkler, first step")
    axes.set_title("start")


@figure(columns=2, legend=2, xlabel=("along sliding, µm", "along sliding, mm"), ylabel=PRESSURE)
def pressure_of_v1(axes: Any, runs: Runs, numbers: Numbers) -> None:
    v1 = runs["v1"]
    _start_of(axes[0], v1, 0)
    last = v1.snapshot(-1)
    axes[1].step(v1.x, _middle(last.pressure, 0), where="mid", color=fs.CONTACT)
    axes[1].set(title=fs.after(last.distance), ylim=(0.0, 1.3 * float(last.pressure.max())))


@figure(columns=2, legend=5, xlabel=("across sliding, µm", "across or along sliding, mm"), ylabel=PRESSURE)
def pressure_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    v2 = runs["v2"]
    last = v2.snapshot(-1)
    sphere, disc = v2.study.wear_coefficients
    _start_of(axes[0], v2, 1)
    for axis, places, label, line in ((1, v2.y, "across", "-"), (0, v2.x, "along", "--")):
        pressure = positive(_middle(last.pressure, axis))
        axes[1].plot(places, pressure, color=fs.CONTACT, ls=line, label=label)
    across = _middle(last.pressure, 1)
    y = v2.y[across > 0.0]
    cosine = np.sqrt(1.0 - (y * v2.study.sphere.curvature) ** 2)
    level = across[v2.y.size // 2] * (sphere + disc)
    axes[1].plot(y, level / (sphere + disc * cosine), color=fs.HARDNESS, ls=":", label="closed form")
    lines = np.concatenate([across, _middle(last.pressure, 0)])
    low, high = lines[lines > 0.0].min(), lines.max()
    axes[1].set_ylim(low - 0.5 * (high - low), high + 0.3 * (high - low))
    axes[1].set_title(f"{fs.after(last.distance)} (axis not from zero)")


@figure(columns=2, legend=3, xlabel=ACROSS, ylabel=(HEIGHT, "depth of the disc, µm"))
def disc_of_v1(axes: Any, runs: Runs, numbers: Numbers) -> None:
    v1 = runs["v1"]
    distance, depth = v1.history["distance"], 1e3 * v1.history["wear_depth_disc"]
    kept = {s.distance: s for s in (snapshot_at(v1, printed.value) for printed in DRAWN_AT)}
    for snapshot, line in zip(kept.values(), fs.in_time(fs.DISC, len(kept)), strict=True):
        axes[0].plot(v1.y, -1e3 * _middle(snapshot.wear_disc, 1), label=fs.after(snapshot.distance), **line)
    fs.over_distance(axes[1], distance, depth, color=fs.DISC, label="deepest cell")
    root = depth[-1] * np.sqrt(distance / distance[-1])
    axes[1].plot(distance, root, color=fs.HARDNESS, ls=":", label="square root")
    axes[1].set_ylim(bottom=0.0)


@figure(maps=len(VERSIONS))
def pressure_maps(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel, (name, told) in panels_of(axes, list(VERSIONS.items())):
        window = window_of(runs[name])
        pressure = positive(window.largest(runs[name].snapshot(-1).pressure))
        mean, most = float(np.nanmean(pressure)), float(np.nanmax(pressure))
        low, high = (0.0, most) if name == "v3" else (0.98 * mean, 1.02 * mean)
        draw_map(panel, pressure, window, fs.PRESSURES, "pressure, MPa", low=low, high=high)
        scatter = float(runs[name].history["pressure_std"][-1])
        panel.set_title(f"{told}: {fs.with_scatter(numbers[f'{name}.pressure_end_MPa'], scatter)} MPa")


@figure(maps=len(VERSIONS))
def sphere_patches(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel, (name, told) in panels_of(axes, list(VERSIONS.items())):
        window = window_of(runs[name])
        depth = positive(window.means(1e3 * runs[name].snapshot(-1).wear_sphere))
        draw_map(panel, depth, window, fs.DEPTHS, "wear depth, µm", low=0.0)
        along, across = (numbers[f"{name}.patch_{side}_mm"] for side in ("along", "across"))
        panel.set_title(f"{told}: {along:.3g} × {across:.3g} mm")


@figure(rows=2, columns=2, height=2.3, legend=2, xlabel=ACROSS, ylabel=HEIGHT)
def disc_profiles(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel, (name, told) in panels_of(axes, list(VERSIONS.items())):
        result = runs[name]
        last = result.snapshot(-1)
        worn = _middle(worn_heights(result, last, "disc"), 1)
        unworn = worn + _middle(last.wear_disc, 1)
        panel.plot(result.y, 1e3 * unworn, color="#999999", lw=0.5, label="unworn")
        panel.plot(result.y, 1e3 * worn, color=fs.DISC, label="worn")
        panel.set_title(f"{told}: deepest wear {numbers[f'{name}.disc_depth_um']:.3g} µm")
        panel.sharey(axes[0])


@figure(maps=3)
def contact_areas(axes: Any, runs: Runs, numbers: Numbers) -> None:
    v1 = runs["v1"]
    hertz = v1.study.hertz
    assert hertz is not None
    window = window_of(v1)
    colours = ListedColormap(["#FFFFFF", fs.CONTACT])
    shown = (v1.snapshot(0), snapshot_at(v1, STROKE.value), v1.snapshot(-1))
    for panel, snapshot in panels_of(axes, shown):
        contact = (snapshot.pressure > 0.0).astype(float)
        draw_map(panel, window.largest(contact), window, colours, None, low=0.0, high=1.0)
        panel.add_patch(Circle((0.0, 0.0), hertz.radius, fill=False, ls="--", lw=0.8, ec=fs.HARDNESS))
        area = contact.sum() * v1.study.cells.cell_area
        when = "start" if snapshot is shown[0] else fs.after(snapshot.distance)
        panel.set_title(f"{when}: {area:.3g} mm²")


@figure(
    columns=2,
    legend=2,
    xlabel="distance from the middle, mm",
    ylabel=("wear of the sphere, V2, µm", "V2 minus V1, µm"),
)
def sphere_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    first, second = (runs[name].snapshot(-1).wear_sphere for name in ("v1", "v2"))
    for panel, wear in panels_of(axes, (second, second - first)):
        for axis, label, line in ((0, "along sliding", "-"), (1, "across sliding", "--")):
            panel.plot(runs["v2"].x, 1e3 * _middle(wear, axis), color=fs.SPHERE, ls=line, label=label)
