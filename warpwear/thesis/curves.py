"""Figures of the report of the thesis that show its versions side by side, most over the distance."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from warpwear.figures import style as fs
from warpwear.thesis.figures import EXPERIMENT, LINES, PRINTED, Gallery, over_distance, versions
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.printed import PATCH_DIAMETERS, SLOWS_AFTER
from warpwear.thesis.runs import VERSIONS, Runs, worn_radius

FIGURES = Gallery()
figure = FIGURES.figure


@figure(columns=2)
def radius_and_pressure(axes: Any, runs: Runs, numbers: Numbers) -> None:
    history = runs["v1"].history
    distance = history["distance"]
    radius = np.sqrt(history["area_contact"] / np.pi)
    for left, scale in zip(axes, ("linear", "log"), strict=True):
        fs.over_distance(left, distance, radius, color=fs.CONTACT, label="radius √(A/π) (left)")
        right = left.twinx()
        right.spines["right"].set_visible(True)
        pressure = {"color": fs.MEAN_PRESSURE, "ls": ":", "label": "mean pressure (right)"}
        right.plot(distance, history["pressure_mean"], **pressure)
        left.axvline(SLOWS_AFTER.value, color=PRINTED, lw=0.8, ls="--", label="0.1 m")
        left.set_xscale(scale)
        if scale == "log":
            fs.logarithmic(left)
            fs.logarithmic(right)
        left.set_ylabel("radius, mm")
        right.set_ylabel("mean pressure, MPa")
        if scale == "linear":
            left.set_ylim(bottom=0.0)
            right.set_ylim(bottom=0.0)
    fs.legend_above(axes[0], right, columns=3)


@figure()
def cof_of_v1(axes: Any, runs: Runs, numbers: Numbers) -> None:
    history = runs["v1"].history
    distance = history["distance"]
    versions(axes, runs, "cof", "v1")
    root = history["cof"][-1] * np.sqrt(distance / distance[-1])
    axes.plot(distance, root, color=PRINTED, ls=":", label="square root through the end")
    axes.set_ylabel("coefficient of friction, –")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    fs.legend_above(axes, columns=2)


@figure(columns=2)
def distance_factor(axes: Any, runs: Runs, numbers: Numbers) -> None:
    study = runs["v2"].study
    edge = worn_radius(study)
    y = np.linspace(-edge, edge, 401)
    ball = np.sqrt(1.0 - (y * study.sphere.curvature) ** 2)
    for panel, contact in zip(axes, (False, True), strict=True):
        panel.axhline(1.0, color=LINES["v1"]["color"], label="without (V1)")
        panel.plot(y, ball, label="with, cos θ (V2)", color=LINES["v3"]["color"], ls="--")
        if contact:
            chord = np.sqrt(np.maximum(0.0, 1.0 - (y / edge) ** 2))
            panel.plot(y, chord, color=fs.HARDNESS, ls=":", label="chord of the contact, 2√(a² − y²)")
        panel.set_xlabel("across sliding, y, mm")
        panel.set_ylabel("relative distance, –")
    axes[1].set_ylim(0.0, 1.05)
    fs.legend_above(axes[1], columns=3)


@figure(columns=2)
def volumes_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for body, color in (("sphere", fs.SPHERE), ("disc", fs.DISC)):
        for name, line in (("v1", "-"), ("v2", "--")):
            history = runs[name].history
            told = f"{body}, {VERSIONS[name]}"
            over_distance(axes[0], history, f"wear_volume_{body}", color=color, ls=line, label=told)
        first, second = (runs[name].history[f"wear_volume_{body}"] for name in ("v1", "v2"))
        change = 100.0 * (second / first - 1.0)
        fs.over_distance(axes[1], history["distance"], change, color=color, label=f"{body}, V2 against V1")
    axes[0].set_ylabel("worn volume, mm³")
    axes[1].set_ylabel("V2 against V1, %")
    axes[0].set_ylim(bottom=0.0)
    fs.legend_above(*axes, columns=3)


@figure(columns=2)
def cof_of_v2(axes: Any, runs: Runs, numbers: Numbers) -> None:
    first, second = (runs[name].history for name in ("v1", "v2"))
    versions(axes[0], runs, "cof", "v1", "v2")
    axes[0].set_ylabel("coefficient of friction, –")
    axes[0].set_ylim(bottom=0.0)
    change = 100.0 * (second["cof"] / first["cof"] - 1.0)
    fs.over_distance(axes[1], first["distance"], change, color=fs.NEUTRAL, lw=0.6)
    axes[1].set_ylabel("V2 against V1, %")
    fs.legend_above(axes[0], columns=2)


@figure(columns=2)
def cof_of_all(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        versions(panel, runs, "cof", *VERSIONS)
        panel.set_ylabel("coefficient of friction, –")
    axes[1].set_ylim(0.0, 1.5 * numbers["v1.cof_end"])
    axes[0].set_ylim(bottom=0.0)
    axes[0].set_title("full scale")
    axes[1].set_title("scale of V1; V3 leaves it")
    fs.legend_above(axes[0], columns=4)


@figure(columns=2)
def relative_cof(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        for name, told in VERSIONS.items():
            history = runs[name].history
            relative = history["cof"] / history["cof"][-1]
            fs.over_distance(panel, history["distance"], relative, label=told, **LINES[name])
        panel.set_ylabel("coefficient over its end value, –")
    axes[0].set_ylim(0.0, 1.05)
    axes[1].set_xscale("log")
    axes[1].set_yscale("log")
    axes[1].set_ylim(1e-3, 1.5)
    fs.legend_above(axes[0], columns=4)


@figure(columns=2)
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
        panel.set_ylabel("area, mm²")
        panel.set_ylim(bottom=0.0)
    fs.legend_above(*axes, columns=3)


@figure(columns=2)
def areas_of_all(axes: Any, runs: Runs, numbers: Numbers) -> None:
    for panel in axes:
        versions(panel, runs, "area_contact", "v1", "v3", "fine")
        panel.axhline(numbers["v3.load_over_hardness_mm2"], color=PRINTED, lw=0.8, ls=":", label="F/H")
        panel.set_ylabel("area in contact, mm²")
    axes[0].set_ylim(bottom=0.0)
    axes[1].set_xscale("log")
    fs.logarithmic(axes[1])
    fs.legend_above(axes[0], columns=4)


@figure(columns=2)
def stability(axes: Any, runs: Runs, numbers: Numbers) -> None:
    beyond, steady = runs.beyond.history, runs.steady.history
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
        panel.set_ylabel("area in contact, mm²")
        panel.set_ylim(bottom=0.0)
    fs.legend_above(*axes, columns=2)


@figure(width=fs.PAGE, height=2.9)
def rough_patches(axes: Any, runs: Runs, numbers: Numbers) -> None:
    patches = runs.patches
    seeds = np.arange(len(patches))
    axes.axhline(PATCH_DIAMETERS["v3"].value, color=fs.HARDNESS, lw=0.8, label="printed, 1.37 mm")
    smooth = numbers["closed_form_patch_mm"]
    axes.axhline(smooth, color=PRINTED, lw=0.8, ls="--", label="smooth, cap of K F L")

    def dots(attribute: str, marker: str, size: int, color: str, label: str, shift: float = 0.0) -> None:
        extents = [getattr(patch, attribute) for patch in patches]
        axes.plot(seeds + shift, extents, marker, ms=size, color=color, label=label)

    dots("largest", "_", 12, fs.NEUTRAL, "a peak R_p at both ends")
    dots("farthest", "D", 3, fs.SUM, "twice the farthest cell")
    for side, color, shift in (("along", fs.SPHERE, -0.12), ("across", fs.DISC, 0.12)):
        dots(side, "o", 4, color, f"{side}, V3", shift)
        dots(f"predicted_{side}", "x", 4, color, f"{side}, geometry alone", shift)
    axes.set_xticks(seeds, [str(p.seed) for p in patches])
    axes.set_xlabel("seed of the rough surface")
    axes.set_ylabel("extent of the patch, mm")
    fs.legend_above(axes, columns=4)


def _bars(
    axes: Axes, labels: list[str], values: list[float], colours: list[str], text: str = "{:.3g}"
) -> None:
    """Draw a bar a value, with the value over it. text: its format."""
    bars = axes.bar(range(len(values)), values, color=colours, width=0.65)
    axes.bar_label(bars, [text.format(v) for v in values], fontsize=7, padding=2)
    axes.set_xticks(range(len(values)), labels)
    axes.margins(y=0.12)


@figure(columns=2)
def disc_volumes(axes: Any, runs: Runs, numbers: Numbers) -> None:
    values = [numbers[f"{name}.disc_volume_mm3"] for name in VERSIONS]
    colours = [LINES[name]["color"] for name in VERSIONS]
    _bars(axes[0], list(VERSIONS.values()), values, colours, "{:.5f}")
    axes[0].set_ylabel("worn volume of the disc, mm³")
    change = [100.0 * (value / values[0] - 1.0) for value in values]
    _bars(axes[1], list(VERSIONS.values()), change, colours, "{:.3f}")
    axes[1].axhline(0.0, color=fs.NEUTRAL, lw=0.6)
    axes[1].set_ylabel("against V1, %")
    axes[1].margins(y=0.2)


@figure()
def disc_depths(axes: Any, runs: Runs, numbers: Numbers) -> None:
    labels = [*VERSIONS.values(), "groove of\nTable 4.1"]
    values = [numbers[f"{name}.disc_depth_um"] for name in VERSIONS] + [numbers["experiment.groove_depth_um"]]
    _bars(axes, labels, values, [*(LINES[name]["color"] for name in VERSIONS), EXPERIMENT])
    axes.set_ylabel("depth of the disc's wear, µm")


@figure(width=5.0)
def patch_bars(axes: Any, runs: Runs, numbers: Numbers) -> None:
    ours = [numbers[f"{name}.patch_by_depth_mm"] for name in ("v1", "v2")]
    ours += [numbers[f"{name}.patch_along_mm"] for name in ("v3", "fine")]
    printed = [PATCH_DIAMETERS[name].value for name in ("experiment", "v1", "v2", "v3")]
    places, colours = np.arange(4), [line["color"] for line in LINES.values()]
    beside = places - np.array([0.0, 0.19, 0.19, 0.19])
    for bars in (
        axes.bar(beside, printed, 0.36, color=[EXPERIMENT, *[PRINTED] * 3], label="printed in the thesis"),
        axes.bar(places[1:] + 0.19, ours[:3], 0.36, color=colours[:3]),
        axes.bar([4.0], ours[3:], 0.36, color=colours[3]),
    ):
        axes.bar_label(bars, fmt="{:.2f}", fontsize=7, padding=2)
    axes.set_xticks(range(5), ["experiment", "V1", "V2", "V3", "V3 fine"])
    axes.set_ylabel("diameter of the sphere's patch, mm")
    axes.margins(y=0.12)
    axes.set_title("grey and black: printed; coloured: ours")
