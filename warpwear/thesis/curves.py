"""Figures of the report of the thesis that show its versions side by side, most over the distance."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.figures.axes import ACROSS
from warpwear.thesis.figures import EXPERIMENT, LINES, PRINTED, Gallery, over_distance, versions
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import PATCH_DIAMETERS, SLOWS_AFTER
from warpwear.thesis.runs import VERSIONS, Runs, worn_radius

FIGURES = Gallery()
figure = FIGURES.figure
AREA, COF = "area in contact, mm²", "coefficient of friction, –"
#: Colour of each version.
COLOURS = [line["color"] for line in LINES.values()]


@figure(columns=2, legend=3, ylabel="radius, mm")
def radius_and_pressure(axes: Any, runs: Runs, numbers: Numbers) -> None:
    history = runs["v1"].history
    distance = history["distance"]
    radius = np.sqrt(history["area_contact"] / np.pi)
    pressure = {"color": fs.MEAN_PRESSURE, "ls": ":", "label": "mean pressure (right)"}
    for left, finish in zip(axes, (_from_zero, fs.logarithmic), strict=True):
        fs.over_distance(left, distance, radius, color=fs.CONTACT, label="radius √(A/π) (left)")
        right = left.twinx()
        right.spines["right"].set_visible(True)
        right.plot(distance, history["pressure_mean"], **pressure)
        right.set_ylabel("mean pressure, MPa")
        left.axvline(SLOWS_AFTER.value, color=PRINTED, lw=0.8, ls="--", label="0.1 m")
        finish(left)
        finish(right)
    axes[1].set_xscale("log")
    fs.plain_numbers(axes[1].xaxis)


def _from_zero(axes: Axes) -> None:
    """Let values begin at zero; call it after the lines are drawn."""
    axes.set_ylim(bottom=0.0)


@figure(legend=2, ylabel=COF)
def cof_of_v1(axes: Any, runs: Runs, numbers: Numbers) -> None:
    history = runs["v1"].history
    distance = history["distance"]
    versions(axes, runs, "cof", "v1")
    root = history["cof"][-1] * np.sqrt(distance / distance[-1])
    axes.plot(distance, root, color=PRINTED, ls=":", label="square root through the end")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))


@figure(columns=2, legend=3, xlabel=ACROSS, ylabel="relative distance, –")
def distance_factor(axes: Any, runs: Runs, numbers: Numbers) -> None:
    study = runs["v2"].study
    edge = worn_radius(study)
    y = np.linspace(-edge, edge, 401)
    ball = np.sqrt(1.0 - (y * study.sphere.curvature) ** 2)
    for panel in axes:
        panel.axhline(1.0, color=LINES["v1"]["color"], label="without (V1)")
        panel.plot(y, ball, label="with, cos θ (V2)", color=LINES["v3"]["color"], ls="--")
    chord = np.sqrt(np.maximum(0.0, 1.0 - (y / edge) ** 2))
    axes[1].plot(y, chord, color=fs.HARDNESS, ls=":", label="chord of the contact, 2√(a² − y²)")
    axes[1].set_ylim(0.0, 1.05)


@figure(columns=2, legend=3, ylabel=("worn volume, mm³", "V2 against V1, %"))
def volumes_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    first, second = runs["v1"].history, runs["v2"].history
    for body, color in (("sphere", fs.SPHERE), ("disc", fs.DISC)):
        column = f"wear_volume_{body}"
        for history, told, line in ((first, "V1", "-"), (second, "V2", "--")):
            over_distance(axes[0], history, column, color=color, ls=line, label=f"{body}, {told}")
        change = 100.0 * (second[column] / first[column] - 1.0)
        fs.over_distance(axes[1], first["distance"], change, color=color, label=f"{body}, V2 against V1")
    _from_zero(axes[0])


@figure(columns=2, legend=2, ylabel=(COF, "V2 against V1, %"))
def cof_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    first, second = runs["v1"].history, runs["v2"].history
    versions(axes[0], runs, "cof", "v1", "v2")
    _from_zero(axes[0])
    change = 100.0 * (second["cof"] / first["cof"] - 1.0)
    fs.over_distance(axes[1], first["distance"], change, color=fs.NEUTRAL, lw=0.6)


@figure(columns=2, legend=4, ylabel=COF)
def cof_of_all(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        versions(panel, runs, "cof", *VERSIONS)
    axes[0].set(ylim=(0.0, None), title="full scale")
    axes[1].set(ylim=(0.0, 1.5 * numbers["v1.cof_end"]), title="scale of V1; V3 leaves it")


@figure(columns=2, legend=4, ylabel="coefficient over its end value, –")
def relative_cof(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        versions(panel, runs, "cof", *VERSIONS, relative=True)
    axes[0].set_ylim(0.0, 1.05)
    axes[1].set(xscale="log", yscale="log", ylim=(1e-3, 1.5))
    fs.plain_numbers(axes[1].xaxis)
    fs.plain_numbers(axes[1].yaxis)


@figure(columns=2, legend=3, ylabel="area, mm²")
def straight_line(axes: Any, runs: Runs, numbers: Numbers) -> None:
    history = runs["v3"].history
    distance = history["distance"]
    kinds = (
        ("cumulative", "sum", fs.SUM, "running sum of areas"),
        ("touched", "touched", fs.TOUCHED, "area ever touched"),
    )
    for panel, (area, key, color, label) in zip(axes, kinds, strict=True):
        values = history[f"area_{area}"]
        line = np.polyval(np.polyfit(distance, values, 1), distance)
        fs.over_distance(panel, distance, values, color=color, label=label, lw=2.0)
        panel.plot(distance, line, color=fs.HARDNESS, ls=":", label="straight line")
        panel.set_title(f"{label}: R² = {numbers[f'v3.{key}_straightness_R2']:.4f}")
        _from_zero(panel)


@figure(columns=2, legend=4, ylabel=AREA)
def areas_of_all(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        versions(panel, runs, "area_contact", "v1", "v3", "fine")
        panel.axhline(numbers["v3.load_over_hardness_mm2"], color=PRINTED, lw=0.8, ls=":", label="F/H")
    _from_zero(axes[0])
    axes[1].set_xscale("log")
    fs.plain_numbers(axes[1].xaxis)
    fs.logarithmic(axes[1])


@figure(columns=2, legend=2, ylabel=AREA)
def stability(axes: Any, runs: Runs, numbers: Numbers) -> None:
    beyond, steady = runs["beyond"].history, runs["steady"].history
    middle = 0.5 * beyond["distance"][-1]
    near = np.abs(beyond["distance"] - middle) <= 15.0
    stable, unstable = {"color": LINES["v1"]["color"]}, {"color": LINES["v3"]["color"]}
    over_distance(axes[0], beyond, "area_contact", lw=0.2, **unstable)
    over_distance(axes[0], steady, "area_contact", label="stable: implicit", **stable)
    dots: dict[str, Any] = {"lw": 0.7, "marker": ".", "ms": 2, "label": "explicit, beyond the limit"}
    fs.over_distance(axes[1], beyond["distance"][near], beyond["area_contact"][near], **dots, **unstable)
    axes[1].plot(steady["distance"][near], steady["area_contact"][near], **stable)
    axes[1].set_title("30 mm in the middle, a dot a step")
    for panel in axes:
        _from_zero(panel)


@figure(width=fs.PAGE, height=2.9, legend=4, ylabel="extent of the patch, mm")
def rough_patches(axes: Any, runs: Runs, numbers: Numbers) -> None:
    patches = runs.patches
    seeds = np.arange(len(patches))
    axes.axhline(PATCH_DIAMETERS["v3"].value, color=fs.HARDNESS, lw=0.8, label="printed, 1.37 mm")
    smooth = numbers["closed_form_patch_mm"]
    axes.axhline(smooth, color=PRINTED, lw=0.8, ls="--", label="smooth, cap of K F L")
    for name, marker, size, color, label, shift in (
        ("bound", "_", 12, fs.NEUTRAL, "a peak R_p at both ends", 0.0),
        ("farthest", "D", 3, fs.SUM, "twice the farthest cell", 0.0),
        ("along", "o", 4, fs.SPHERE, "along, V3", -0.12),
        ("predicted_along", "x", 4, fs.SPHERE, "along, geometry alone", -0.12),
        ("across", "o", 4, fs.DISC, "across, V3", 0.12),
        ("predicted_across", "x", 4, fs.DISC, "across, geometry alone", 0.12),
    ):
        extents = [getattr(patch, name) for patch in patches]
        axes.plot(seeds + shift, extents, marker, ms=size, color=color, label=label)
    axes.set_xticks(seeds, [str(p.seed) for p in patches])
    axes.set_xlabel("seed of the rough surface")


def _bars(axes: Axes, labels: list[str], values: list[float], text: str = "{:.3g}") -> None:
    """Draw a bar a value, with the value over it: of each version and then of the experiment.

    text: format of the values.
    """
    bars = axes.bar(labels, values, color=[*COLOURS, EXPERIMENT][: len(values)], width=0.65)
    axes.bar_label(bars, [text.format(v) for v in values], fontsize=7, padding=2)
    axes.margins(y=0.12)


@figure(columns=2, ylabel=("worn volume of the disc, mm³", "against V1, %"))
def disc_volumes(axes: Any, runs: Runs, numbers: Numbers) -> None:
    values = [numbers[f"{name}.disc_volume_mm3"] for name in VERSIONS]
    _bars(axes[0], list(VERSIONS.values()), values, "{:.5f}")
    change = [100.0 * (value / values[0] - 1.0) for value in values]
    _bars(axes[1], list(VERSIONS.values()), change, "{:.3f}")
    axes[1].axhline(0.0, color=fs.NEUTRAL, lw=0.6)
    axes[1].margins(y=0.2)


@figure(ylabel="depth of the disc's wear, µm")
def disc_depths(axes: Any, runs: Runs, numbers: Numbers) -> None:
    values = [numbers[f"{name}.disc_depth_um"] for name in VERSIONS]
    labels = [*VERSIONS.values(), "groove of\nTable 4.1"]
    _bars(axes, labels, [*values, numbers["experiment.groove_depth_um"]])


@figure(width=5.0, ylabel="diameter of the sphere's patch, mm")
def patch_bars(axes: Any, runs: Runs, numbers: Numbers) -> None:
    ours = [numbers[f"{name}.patch_by_depth_mm"] for name in ("v1", "v2")]
    ours += [numbers[f"{name}.patch_along_mm"] for name in ("v3", "fine")]
    printed = [PATCH_DIAMETERS[name].value for name in ("experiment", "v1", "v2", "v3")]
    for bars in (
        axes.bar([0.0, 0.81, 1.81, 2.81], printed, 0.36, color=[EXPERIMENT, *[PRINTED] * 3]),
        axes.bar([1.19, 2.19, 3.19, 4.0], ours, 0.36, color=COLOURS),
    ):
        axes.bar_label(bars, fmt="{:.2f}", fontsize=7, padding=2)
    axes.set_xticks(range(5), ["experiment", *VERSIONS.values()])
    axes.margins(y=0.12)
    axes.set_title("grey and black: printed; coloured: ours")
