"""The table of all figures of the report of the thesis, each with the caption that stands below it.

Figures of a single run come from its `plot`, those of several from `thesis_curves`, `thesis_bars` and
`thesis_maps`.
"""

from collections.abc import Callable
from typing import NamedTuple

from matplotlib.figure import Figure

from warpwear import thesis_bars, thesis_curves, thesis_maps
from warpwear.thesis_numbers import Numbers
from warpwear.thesis_runs import Runs

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
    "disc_volumes": Entry(thesis_bars.disc_volumes, "Worn volume of the disc (mm³) and against V1 (%)."),
    "cof_of_all": Entry(
        thesis_curves.cof_of_all,
        "Coefficient of friction (–) with one shear strength for all: V3, which sums its areas, is off the "
        "scale of the others.",
    ),
    "disc_depths": Entry(
        thesis_bars.disc_depths,
        "Deepest cell of the disc (µm) of the models on a stationary footprint, and the groove that Table "
        "4.1's K_d makes of 30 mm × 0.80 mm.",
    ),
    "patch_bars": Entry(
        thesis_bars.patch_bars, "Diameter of the sphere's worn patch (mm) as printed and of our runs."
    ),
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
