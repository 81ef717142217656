"""Figures of the report of the thesis that show its versions side by side, most over the distance."""

from dataclasses import replace

import numpy as np

from warpwear.figures import describe
from warpwear.figures.describe import ACROSS, DISTANCE, Axis, Bars, Figure, Level, Line, Look
from warpwear.thesis import figures
from warpwear.thesis.figures import chart, course, figure, versions
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import PATCH_DIAMETERS, SLOWS_AFTER
from warpwear.thesis.runs import VERSIONS, Runs, worn_radius

AREA, COF = "area in contact, mm²", "coefficient of friction, –"
#: Colour of each version, and then of the experiment.
COLOURS = [*(look.colour for look in figures.LOOKS.values()), figures.EXPERIMENT]


@figure
def radius_and_pressure(runs: Runs, numbers: Numbers) -> Figure:
    history = runs["v1"].history
    distance, radius = history["distance"], np.sqrt(history["area_contact"] / np.pi)
    slows = Level(SLOWS_AFTER.value, "0.1 m", Look(figures.PRINTED, "dash", 0.8), axis="x")
    pressure = course(history, "pressure_mean", "mean pressure", Look(describe.MEAN_PRESSURE, "dot"))
    radii = Line(distance, radius, "radius √(A/π)", Look(describe.CONTACT))
    panels = []
    for line, label in ((radii, "radius, mm"), (pressure, "mean pressure, MPa")):
        panels.append(chart([line, slows], label))
        panels.append(chart([line, slows], Axis(label, "log"), Axis(DISTANCE, "log")))
    return Figure(panels, columns=2, legend=3, shared="x", height=1.9)


@figure
def cof_of_v1(runs: Runs, numbers: Numbers) -> Figure:
    history = runs["v1"].history
    root = figures.root_through_end(
        history["distance"], history["cof"], "square root through the end", figures.PRINTED
    )
    return Figure([chart([*versions(runs, "cof", "v1"), root], COF, Axis(DISTANCE, low=0.0))], legend=2)


@figure
def distance_factor(runs: Runs, numbers: Numbers) -> Figure:
    study = runs["v2"].study
    edge = worn_radius(study)
    y = np.linspace(-edge, edge, 401)
    ball = np.sqrt(1.0 - (y * study.counter.form.curvature) ** 2)
    lines: list[Line | Level] = [
        Level(1.0, "without (V1)", Look(describe.COUNTER, width=1.2)),
        Line(y, ball, "with, cos θ (V2)", Look(describe.DISC, "dash")),
    ]
    chord = np.sqrt(np.maximum(0.0, 1.0 - (y / edge) ** 2))
    of_chord = Line(y, chord, "chord of the contact, 2√(a² − y²)", Look(describe.HARDNESS, "dot"))
    factor = Axis("relative distance, –")
    panels = [
        chart(lines, factor, ACROSS),
        chart([*lines, of_chord], replace(factor, low=0.0, high=1.05), ACROSS),
    ]
    return Figure(panels, legend=3)


@figure
def volumes_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    first, second = runs["v1"].history, runs["v2"].history
    volumes, changes = [], []
    for body, colour in describe.BODIES.items():
        column = f"wear_volume_{body}"
        volumes.append(course(first, column, f"{body}, V1", Look(colour)))
        volumes.append(course(second, column, f"{body}, V2", Look(colour, "dash")))
        change = 100.0 * (second[column] / first[column] - 1.0)
        changes.append(Line(first["distance"], change, f"{body}, V2 against V1", Look(colour)))
    panels = [chart(volumes, "worn volume, mm³"), chart(changes, Axis("V2 against V1, %"))]
    return Figure(panels, legend=3)


@figure
def cof_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    first, second = runs["v1"].history, runs["v2"].history
    change = Line(first["distance"], 100.0 * (second["cof"] / first["cof"] - 1.0), look=Look(width=0.6))
    panels = [chart(versions(runs, "cof", "v1", "v2"), COF), chart([change], Axis("V2 against V1, %"))]
    return Figure(panels, legend=2)


@figure
def cof_of_all(runs: Runs, numbers: Numbers) -> Figure:
    lines, near = versions(runs, "cof", *VERSIONS), Axis(COF, low=0.0, high=1.5 * numbers["v1.cof_end"])
    panels = [chart(lines, COF, note="full scale"), chart(lines, near, note="scale of V1; V3 leaves it")]
    return Figure(panels, legend=4)


@figure
def relative_cof(runs: Runs, numbers: Numbers) -> Figure:
    lines = versions(runs, "cof", *VERSIONS, relative=True)
    label, logarithmic = "coefficient over its end value, –", Axis(DISTANCE, "log")
    panels = [
        chart(lines, Axis(label, low=0.0, high=1.05)),
        chart(lines, Axis(label, "log", 1e-3, 1.5), logarithmic),
    ]
    return Figure(panels, legend=4)


@figure
def straight_line(runs: Runs, numbers: Numbers) -> Figure:
    history, panels = runs["v3"].history, []
    distance = history["distance"]
    for area, key, colour, label in (
        ("cumulative", "sum", describe.SUM, "running sum of areas"),
        ("touched", "touched", describe.TOUCHED, "area ever touched"),
    ):
        values = history[f"area_{area}"]
        fit = np.polyval(np.polyfit(distance, values, 1), distance).astype(np.float64)
        lines: list[Line | Level] = [
            Line(distance, values, label, Look(colour, width=2.0)),
            Line(distance, fit, "straight line", Look(describe.HARDNESS, "dot")),
        ]
        note = f"{label}: R² = {numbers[f'v3.{key}_straightness_R2']:.4f}"
        panels.append(chart(lines, "area, mm²", note=note))
    return Figure(panels, legend=3)


@figure
def areas_of_all(runs: Runs, numbers: Numbers) -> Figure:
    of_load = Level(numbers["v3.load_over_hardness_mm2"], "F/H", Look(figures.PRINTED, "dot", 0.8))
    lines: list[Line | Level] = [*versions(runs, "area_contact", "v1", "v3", "fine"), of_load]
    return Figure([chart(lines, AREA), chart(lines, Axis(AREA, "log"), Axis(DISTANCE, "log"))], legend=4)


@figure
def stability(runs: Runs, numbers: Numbers) -> Figure:
    beyond, steady = runs["beyond"].history, runs["steady"].history
    near = np.abs(beyond["distance"] - 0.5 * beyond["distance"][-1]) <= 15.0
    stable = Look(describe.COUNTER)
    dots = Look(describe.DISC, width=0.7, marker=".", size=2.0)
    explicit, implicit = "explicit, beyond the limit", "stable: implicit"
    part, steady_part = ({name: v[near] for name, v in history.items()} for history in (beyond, steady))
    whole = [
        course(beyond, "area_contact", "", Look(describe.DISC, width=0.2)),
        course(steady, "area_contact", implicit, stable),
    ]
    middle = [course(part, "area_contact", explicit, dots), course(steady_part, "area_contact", "", stable)]
    panels = [chart(whole, AREA), chart(middle, AREA, note="30 mm in the middle, a dot a step")]
    return Figure(panels, legend=2)


@figure
def rough_patches(runs: Runs, numbers: Numbers) -> Figure:
    patches = runs.patches
    seeds = np.arange(len(patches), dtype=np.float64)
    lines: list[Line | Level] = [
        Level(PATCH_DIAMETERS["v3"].value, "printed, 1.37 mm", Look(describe.HARDNESS, width=0.8)),
        Level(numbers["closed_form_patch_mm"], "smooth, cap of K F L", Look(figures.PRINTED, "dash", 0.8)),
    ]
    for name, marker, size, colour, label, shift in (
        ("bound", "_", 12.0, describe.NEUTRAL, "a peak R_p at both ends", 0.0),
        ("farthest", "D", 3.0, describe.SUM, "twice the farthest cell", 0.0),
        ("along", "o", 4.0, describe.COUNTER, "along, V3", -0.12),
        ("predicted_along", "x", 4.0, describe.COUNTER, "along, geometry alone", -0.12),
        ("across", "o", 4.0, describe.DISC, "across, V3", 0.12),
        ("predicted_across", "x", 4.0, describe.DISC, "across, geometry alone", 0.12),
    ):
        extents = np.array([getattr(patch, name) for patch in patches])
        lines.append(Line(seeds + shift, extents, label, Look(colour, "", marker=marker, size=size)))
    places = tuple((float(place), str(patch.seed)) for place, patch in zip(seeds, patches, strict=True))
    over = Axis("seed of the rough surface", places=places)
    panel = chart(lines, Axis("extent of the patch, mm"), over)
    return Figure([panel], legend=4, width=describe.PAGE, height=2.9)


def _bars(label: str, names: list[str], values: list[float], written: str = "{:.3g}") -> Bars:
    """Make a bar a value, of each version and then of the experiment, with the value behind it."""
    colours = COLOURS[: len(values)]
    return Bars("", names, np.array(values), Axis(label), colours=colours, written=written)


@figure
def disc_volumes(runs: Runs, numbers: Numbers) -> Figure:
    values, names = [numbers[f"{name}.disc_volume_mm3"] for name in VERSIONS], [*VERSIONS.values()]
    change = [100.0 * (value / values[0] - 1.0) for value in values]
    volumes = _bars("worn volume of the disc, mm³", names, values, "{:.5f}")
    return Figure([volumes, _bars("against V1, %", names, change, "{:.3f}")])


@figure
def disc_depths(runs: Runs, numbers: Numbers) -> Figure:
    values = [*(numbers[f"{name}.disc_depth_um"] for name in VERSIONS), numbers["experiment.groove_depth_um"]]
    return Figure(
        [_bars("depth of the disc's wear, µm", [*VERSIONS.values(), "groove of\nTable 4.1"], values)]
    )


@figure
def patch_bars(runs: Runs, numbers: Numbers) -> Figure:
    ours = [numbers[f"{name}.patch_by_depth_mm"] for name in ("v1", "v2")]
    ours += [numbers[f"{name}.patch_along_mm"] for name in ("v3", "fine")]
    names = ["V1", "V2", "V3", "experiment"]
    printed = [PATCH_DIAMETERS[name].value for name in ("v1", "v2", "v3", "experiment")]
    label, grey = "diameter of the counter-body's patch, mm", [*[figures.PRINTED] * 3, figures.EXPERIMENT]
    axis = Axis(label, low=0.0, high=1.25 * max(*printed, *ours))
    panels = [
        replace(_bars(label, names, printed, "{:.2f}"), axis=axis, title="printed", colours=grey),
        replace(_bars(label, [*VERSIONS.values()], ours, "{:.2f}"), axis=axis, title="ours"),
    ]
    return Figure(panels)
