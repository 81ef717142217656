"""Figures of the report of the thesis that show its versions side by side, most over the distance."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.thesis import printed as thesis
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.runs import VERSIONS, Runs, worn_radius

#: Colour and line of each version in every figure; the thesis's printed values and the experiment are grey.
LINES: dict[str, dict[str, Any]] = {
    "v1": {"color": "#0072B2", "ls": "-", "lw": 3.0, "alpha": 0.5},  # wide: others lie on it
    "v2": {"color": "#56B4E9", "ls": "--"},
    "v3": {"color": "#D55E00", "ls": "-."},
    "fine": {"color": "#009E73", "ls": "-"},
}
PRINTED, EXPERIMENT = "#999999", "#000000"


def _versions(runs: Runs, axes: Axes, column: str, *names: str) -> None:
    for name in names:
        history = runs[name].history
        fs.over_distance(axes, history["distance"], history[column], label=VERSIONS[name], **LINES[name])


def radius_and_pressure(runs: Runs, numbers: Numbers) -> Figure:
    history = runs["v1"].history
    distance = history["distance"]
    radius = np.sqrt(history["area_contact"] / np.pi)

    def draw(axes: Any) -> None:
        for left, scale in zip(axes, ("linear", "log"), strict=True):
            fs.over_distance(left, distance, radius, color=fs.CONTACT, label="radius √(A/π) (left)")
            right = left.twinx()
            right.spines["right"].set_visible(True)
            right.plot(
                distance,
                history["pressure_mean"],
                color=fs.MEAN_PRESSURE,
                ls=":",
                label="mean pressure (right)",
            )
            left.axvline(thesis.SLOWS_AFTER.value, color=PRINTED, lw=0.8, ls="--", label="0.1 m")
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

    return fs.new_figure(draw, columns=2)


def cof_of_v1(runs: Runs, numbers: Numbers) -> Figure:
    history = runs["v1"].history
    distance = history["distance"]

    def draw(axes: Any) -> None:
        _versions(runs, axes, "cof", "v1")
        root = history["cof"][-1] * np.sqrt(distance / distance[-1])
        axes.plot(distance, root, color=PRINTED, ls=":", label="square root through the end")
        axes.set_ylabel("coefficient of friction, –")
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        fs.legend_above(axes, columns=2)

    return fs.new_figure(draw)


def distance_factor(runs: Runs, numbers: Numbers) -> Figure:
    study = runs["v2"].study
    edge = worn_radius(study)
    y = np.linspace(-edge, edge, 401)
    ball = np.sqrt(1.0 - (y * study.sphere.curvature) ** 2)

    def draw(axes: Any) -> None:
        for panel, contact in zip(axes, (False, True), strict=True):
            panel.axhline(1.0, color=LINES["v1"]["color"], label="without (V1)")
            panel.plot(y, ball, label="with, cos θ (V2)", color=LINES["v3"]["color"], ls="--")
            if contact:
                panel.plot(
                    y,
                    np.sqrt(np.maximum(0.0, 1.0 - (y / edge) ** 2)),
                    color=fs.HARDNESS,
                    ls=":",
                    label="chord of the contact, 2√(a² − y²)",
                )
            panel.set_xlabel("across sliding, y, mm")
            panel.set_ylabel("relative distance, –")
        axes[1].set_ylim(0.0, 1.05)
        fs.legend_above(axes[1], columns=3)

    return fs.new_figure(draw, columns=2)


def volumes_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    def draw(axes: Any) -> None:
        for body, color in (("sphere", fs.SPHERE), ("disc", fs.DISC)):
            for name, line in (("v1", "-"), ("v2", "--")):
                history = runs[name].history
                fs.over_distance(
                    axes[0],
                    history["distance"],
                    history[f"wear_volume_{body}"],
                    color=color,
                    ls=line,
                    label=f"{body}, {VERSIONS[name]}",
                )
            first, second = (runs[name].history[f"wear_volume_{body}"] for name in ("v1", "v2"))
            fs.over_distance(
                axes[1],
                history["distance"],
                100.0 * (second / first - 1.0),
                color=color,
                label=f"{body}, V2 against V1",
            )
        axes[0].set_ylabel("worn volume, mm³")
        axes[1].set_ylabel("V2 against V1, %")
        axes[0].set_ylim(bottom=0.0)
        fs.legend_above(*axes, columns=3)

    return fs.new_figure(draw, columns=2)


def cof_of_v2(runs: Runs, numbers: Numbers) -> Figure:
    first, second = (runs[name].history for name in ("v1", "v2"))

    def draw(axes: Any) -> None:
        _versions(runs, axes[0], "cof", "v1", "v2")
        axes[0].set_ylabel("coefficient of friction, –")
        axes[0].set_ylim(bottom=0.0)
        fs.over_distance(
            axes[1], first["distance"], 100.0 * (second["cof"] / first["cof"] - 1.0), color=fs.NEUTRAL, lw=0.6
        )
        axes[1].set_ylabel("V2 against V1, %")
        fs.legend_above(axes[0], columns=2)

    return fs.new_figure(draw, columns=2)


def cof_of_all(runs: Runs, numbers: Numbers) -> Figure:
    def draw(axes: Any) -> None:
        for panel in axes:
            _versions(runs, panel, "cof", *VERSIONS)
            panel.set_ylabel("coefficient of friction, –")
        axes[1].set_ylim(0.0, 1.5 * numbers["v1.cof_end"])
        axes[0].set_ylim(bottom=0.0)
        axes[0].set_title("full scale")
        axes[1].set_title("scale of V1; V3 leaves it")
        fs.legend_above(axes[0], columns=4)

    return fs.new_figure(draw, columns=2)


def relative_cof(runs: Runs, numbers: Numbers) -> Figure:
    def draw(axes: Any) -> None:
        for panel in axes:
            for name in VERSIONS:
                history = runs[name].history
                fs.over_distance(
                    panel,
                    history["distance"],
                    history["cof"] / history["cof"][-1],
                    label=VERSIONS[name],
                    **LINES[name],
                )
            panel.set_ylabel("coefficient over its end value, –")
        axes[0].set_ylim(0.0, 1.05)
        axes[1].set_xscale("log")
        axes[1].set_yscale("log")
        axes[1].set_ylim(1e-3, 1.5)
        fs.legend_above(axes[0], columns=4)

    return fs.new_figure(draw, columns=2)


def straight_line(runs: Runs, numbers: Numbers) -> Figure:
    history = runs["v3"].history
    distance = history["distance"]

    def draw(axes: Any) -> None:
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

    return fs.new_figure(draw, columns=2)


def areas_of_all(runs: Runs, numbers: Numbers) -> Figure:
    def draw(axes: Any) -> None:
        for panel in axes:
            _versions(runs, panel, "area_contact", "v1", "v3", "fine")
            panel.axhline(numbers["v3.load_over_hardness_mm2"], color=PRINTED, lw=0.8, ls=":", label="F/H")
            panel.set_ylabel("area in contact, mm²")
        axes[0].set_ylim(bottom=0.0)
        axes[1].set_xscale("log")
        fs.logarithmic(axes[1])
        fs.legend_above(axes[0], columns=4)

    return fs.new_figure(draw, columns=2)


def stability(runs: Runs, numbers: Numbers) -> Figure:
    beyond, steady = runs.beyond.history, runs.steady.history
    middle = 0.5 * beyond["distance"][-1]
    near = np.abs(beyond["distance"] - middle) <= 15.0

    def draw(axes: Any) -> None:
        unstable = {"color": LINES["v3"]["color"]}
        fs.over_distance(axes[0], beyond["distance"], beyond["area_contact"], lw=0.2, **unstable)
        fs.over_distance(
            axes[0],
            steady["distance"],
            steady["area_contact"],
            color=LINES["v1"]["color"],
            label="stable: implicit",
        )
        fs.over_distance(
            axes[1],
            beyond["distance"][near],
            beyond["area_contact"][near],
            lw=0.7,
            marker=".",
            ms=2,
            label="explicit, beyond the limit",
            **unstable,
        )
        axes[1].plot(steady["distance"][near], steady["area_contact"][near], color=LINES["v1"]["color"])
        axes[1].set_title("30 mm in the middle, a dot a step")
        for panel in axes:
            panel.set_ylabel("area in contact, mm²")
            panel.set_ylim(bottom=0.0)
        fs.legend_above(*axes, columns=2)

    return fs.new_figure(draw, columns=2)


def rough_patches(runs: Runs, numbers: Numbers) -> Figure:
    patches = runs.patches
    seeds = np.arange(len(patches))

    def draw(axes: Any) -> None:
        axes.axhline(thesis.PATCH_DIAMETERS["v3"].value, color=fs.HARDNESS, lw=0.8, label="printed, 1.37 mm")
        axes.axhline(
            numbers["closed_form_patch_mm"], color=PRINTED, lw=0.8, ls="--", label="smooth, cap of K F L"
        )
        axes.plot(
            seeds, [p.largest for p in patches], "_", ms=12, color=fs.NEUTRAL, label="a peak R_p at both ends"
        )
        axes.plot(
            seeds, [p.farthest for p in patches], "D", ms=3, color=fs.SUM, label="twice the farthest cell"
        )
        for side, color, shift in (("along", fs.SPHERE, -0.12), ("across", fs.DISC, 0.12)):
            axes.plot(
                seeds + shift,
                [getattr(p, side) for p in patches],
                "o",
                ms=4,
                color=color,
                label=f"{side}, V3",
            )
            axes.plot(
                seeds + shift,
                [getattr(p, f"predicted_{side}") for p in patches],
                "x",
                ms=4,
                color=color,
                label=f"{side}, geometry alone",
            )
        axes.set_xticks(seeds, [str(p.seed) for p in patches])
        axes.set_xlabel("seed of the rough surface")
        axes.set_ylabel("extent of the patch, mm")
        fs.legend_above(axes, columns=4)

    return fs.new_figure(draw, width=fs.PAGE, height=2.9)
