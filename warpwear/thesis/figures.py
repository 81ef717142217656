"""The table of all figures of the report of the thesis, each with the caption that stands below it.

Figures of a single run come from its `plot`, those of several from `curves`, `maps` and this
file.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpwear.figures import style as fs
from warpwear.thesis import curves as thesis_curves
from warpwear.thesis import maps as thesis_maps
from warpwear.thesis import printed as thesis
from warpwear.thesis.curves import EXPERIMENT, LINES, PRINTED
from warpwear.thesis.numbers import Numbers
from warpwear.thesis.runs import VERSIONS, Runs

Draw = Callable[[Runs, Numbers], Figure]


class Entry(NamedTuple):
    """A figure of the report and what stands below it."""

    draw: Draw
    caption: str


def _of_run(version: str, name: str) -> Draw:
    def draw(runs: Runs, numbers: Numbers) -> Figure:
        figure: Figure = getattr(runs[version].plot, name)()
        return figure

    return draw


def _bars(
    axes: Axes, labels: list[str], values: list[float], colours: list[str], text: str = "{:.3g}"
) -> None:
    bars = axes.bar(range(len(values)), values, color=colours, width=0.65)
    axes.bar_label(bars, [text.format(v) for v in values], fontsize=7, padding=2)
    axes.set_xticks(range(len(values)), labels)
    axes.margins(y=0.12)


def disc_volumes(runs: Runs, numbers: Numbers) -> Figure:
    values = [numbers[f"{name}.disc_volume_mm3"] for name in VERSIONS]
    colours = [LINES[name]["color"] for name in VERSIONS]

    def draw(axes: Any) -> None:
        _bars(axes[0], list(VERSIONS.values()), values, colours, "{:.5f}")
        axes[0].set_ylabel("worn volume of the disc, mm³")
        change = [100.0 * (value / values[0] - 1.0) for value in values]
        _bars(axes[1], list(VERSIONS.values()), change, colours, "{:.3f}")
        axes[1].axhline(0.0, color=fs.NEUTRAL, lw=0.6)
        axes[1].set_ylabel("against V1, %")
        axes[1].margins(y=0.2)

    return fs.new_figure(draw, columns=2)


def disc_depths(runs: Runs, numbers: Numbers) -> Figure:
    labels = [*VERSIONS.values(), "groove of\nTable 4.1"]
    values = [numbers[f"{name}.disc_depth_um"] for name in VERSIONS] + [numbers["experiment.groove_depth_um"]]

    def draw(axes: Any) -> None:
        _bars(axes, labels, values, [*(LINES[name]["color"] for name in VERSIONS), EXPERIMENT])
        axes.set_ylabel("depth of the disc's wear, µm")

    return fs.new_figure(draw)


def patch_bars(runs: Runs, numbers: Numbers) -> Figure:
    ours = [
        numbers["v1.patch_by_depth_mm"],
        numbers["v2.patch_by_depth_mm"],
        numbers["v3.patch_along_mm"],
        numbers["fine.patch_along_mm"],
    ]
    printed = [thesis.PATCH_DIAMETERS[name].value for name in ("experiment", "v1", "v2", "v3")]

    def draw(axes: Any) -> None:
        place = np.arange(4)
        for bars in (
            axes.bar(
                place - np.array([0.0, 0.19, 0.19, 0.19]),
                printed,
                0.36,
                color=[EXPERIMENT, *[PRINTED] * 3],
                label="printed in the thesis",
            ),
            axes.bar(place[1:] + 0.19, ours[:3], 0.36, color=[LINES[n]["color"] for n in ("v1", "v2", "v3")]),
            axes.bar([4.0], ours[3:], 0.36, color=LINES["fine"]["color"]),
        ):
            axes.bar_label(bars, fmt="{:.2f}", fontsize=7, padding=2)
        axes.set_xticks(range(5), ["experiment", "V1", "V2", "V3", "V3 fine"])
        axes.set_ylabel("diameter of the sphere's patch, mm")
        axes.margins(y=0.12)
        axes.set_title("grey and black: printed; coloured: ours")

    return fs.new_figure(draw, width=5.0)


FIGURES: dict[str, Entry] = {
    "pressure_of_v1": Entry(
        thesis_maps.pressure_of_v1,
        "Pressure (MPa) through the middle, along sliding. Left (µm): first step, Winkler and Hertz. Right "
        "(mm): at the end.",
    ),
    "radius_and_pressure": Entry(
        thesis_curves.radius_and_pressure,
        "Radius of the area in contact (mm, left scale) and mean pressure (MPa, right scale) of V1 over "
        "the sliding distance (mm); on linear and on logarithmic axes, where a power law is straight.",
    ),
    "disc_of_v1": Entry(
        thesis_maps.disc_of_v1,
        "V1: wear of the disc through the middle (µm) at four distances, and its deepest cell over the "
        "distance (mm) with a square root through the end.",
    ),
    "disc_3d_of_v1": Entry(
        _of_run("v1", "disc_3d"), "V1: the disc before and after, in mm, heights in µm and exaggerated."
    ),
    "sphere_3d_of_v1": Entry(
        _of_run("v1", "sphere_3d"), "V1: the sphere before and after, turned over, heights in µm."
    ),
    "volumes_of_v1": Entry(
        _of_run("v1", "volumes"), "V1: worn volumes (mm³) and deepest cells (µm) over the distance (mm)."
    ),
    "cof_of_v1": Entry(
        thesis_curves.cof_of_v1, "V1: coefficient of friction (–) over the sliding distance (mm)."
    ),
    "distance_factor": Entry(
        thesis_curves.distance_factor,
        "Sliding distance of a disc cell relative to the middle, across sliding (mm). Left: as in V2. "
        "Right: with the chord of the contact, which a swept cell slides.",
    ),
    "pressure_of_v2": Entry(
        thesis_maps.pressure_of_v2,
        "V2: pressure (MPa) through the middle. Left: first step, with Hertz. Right: at the end, across "
        "and along sliding, with the closed form.",
    ),
    "volumes_of_v2": Entry(
        thesis_curves.volumes_of_v2, "Worn volumes (mm³) of V1 and V2, and V2 against V1 (%)."
    ),
    "cof_of_v2": Entry(
        thesis_curves.cof_of_v2,
        "Coefficient of friction (–) of V1 and V2, and V2 against V1 (%); steps are single cells.",
    ),
    "disc_3d_of_v3": Entry(_of_run("v3", "disc_3d"), "V3: the rough disc before and after, heights in µm."),
    "sphere_3d_of_v3": Entry(
        _of_run("v3", "sphere_3d"), "V3: the sphere before and after, turned over, heights in µm."
    ),
    "disc_maps_of_v3": Entry(
        _of_run("v3", "disc_map"), "V3: heights of the disc (µm) unworn and at three distances."
    ),
    "pressure_maps": Entry(
        thesis_maps.pressure_maps,
        "Pressure (MPa) at the end. Scales differ: V1, V2 and V3 fine span 2 % about their mean, V3's "
        "starts at 0.",
    ),
    "disc_profiles": Entry(
        thesis_maps.disc_profiles,
        "The disc across sliding through the middle at the end (µm over mm), unworn in grey.",
    ),
    "sphere_patches": Entry(
        thesis_maps.sphere_patches,
        "Wear depth of the sphere at the end (µm); the extents along and across are of touched cells.",
    ),
    "disc_volumes": Entry(disc_volumes, "Worn volume of the disc (mm³) and against V1 (%)."),
    "cof_of_all": Entry(
        thesis_curves.cof_of_all,
        "Coefficient of friction (–) with one shear strength for all: V3, which sums its areas, is off the "
        "scale of the others.",
    ),
    "disc_depths": Entry(
        disc_depths,
        "Deepest cell of the disc (µm) of the models on a stationary footprint, and the groove that Table "
        "4.1's K_d makes of 30 mm × 0.80 mm.",
    ),
    "patch_bars": Entry(patch_bars, "Diameter of the sphere's worn patch (mm) as printed and of our runs."),
    "relative_cof": Entry(
        thesis_curves.relative_cof,
        "Our coefficients relative to their end value (–), linear and logarithmic. The thesis prints no "
        "values to set beside them.",
    ),
    "contact_areas": Entry(
        thesis_maps.contact_areas,
        "V1: cells in contact (dark) at the start, after 30 mm and at the end; Hertz's circle dashed.",
    ),
    "sphere_of_v2": Entry(
        thesis_maps.sphere_of_v2,
        "V2: wear of the sphere (µm) along and across sliding, and V2 minus V1 (µm).",
    ),
    "straight_line": Entry(
        thesis_curves.straight_line,
        "V3: running sum of the areas in contact and area ever touched (mm²) with straight lines.",
    ),
    "areas_of_all": Entry(
        thesis_curves.areas_of_all,
        "Area in contact (mm²) over the distance (mm) on linear and logarithmic axes; F/H is load over "
        "hardness.",
    ),
    "stability": Entry(
        thesis_curves.stability,
        "Area in contact (mm²) of V1 with the foundation that matches Hertz's area: explicit beyond its "
        "limit, and implicit.",
    ),
    "rough_patches": Entry(
        thesis_curves.rough_patches,
        "Extents of V3's patch (mm) on surfaces of different seeds: run (dots), the unworn surface cut by "
        "the worn sphere without a run (crosses), twice the farthest touched cell, and the bound by the "
        "highest peak near the rim.",
    ),
}
