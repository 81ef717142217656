"""The thesis's figures of its versions side by side and beside the experiment, with verdicts."""

from warpwear.thesis.printed import PATCH_DIAMETERS
from warpwear.thesis.verdicts import (
    DIAMETER_TOLERANCE,
    ROUGH_PATCHES,
    SAME_VOLUME,
    SMOOTH_PATCHES,
    VISIBLE,
    Kind,
    Known,
    Row,
    Table,
    Verdict,
    agrees_if,
    extremes,
    is_root,
    number,
    of,
    of_all,
    patches,
    percent,
    wrong_if,
)

TABLE = Table()
item = TABLE.item


@item(
    "figure-4.31",
    "Disc profiles of the three versions",
    "V3's wear is deeper and its contact larger than that of V1 and V2, because of its high "
    "constant pressure.",
    of_all("deepest cell of the disc", "µm", "disc_depth_um"),
    Row("mean depth in the scar", "µm", of("v1.mean_disc_depth_um", "v3.mean_disc_depth_um")),
    of_all("area ever touched", "mm²", "area_touched_mm2"),
    of_all("area in contact at the end", "mm²", "area_end_mm2"),
    figures=("disc_profiles",),
)
def _disc_profiles(n: Known) -> Verdict:
    deepest = n["v3.disc_depth_um"] / n["v1.disc_depth_um"] - 1.0
    mean = n["v3.mean_disc_depth_um"] / n["v1.mean_disc_depth_um"] - 1.0
    return wrong_if(
        mean < 0.02,
        f"The deepest cell is {percent(deepest)} deeper and the scar "
        f"{percent(n['v3.patch_along_mm'] / n['v1.patch_along_mm'] - 1.0)} longer, as a profile shows, but "
        "since peaks stood there and not for the reason given: "
        f"the mean depth differs by {percent(mean)} and the area ever touched by "
        f"{percent(n['v3.area_touched_mm2'] / n['v1.area_touched_mm2'] - 1.0)}. Wear is K p ΔL: a high "
        "pressure on few cells wears what a low pressure on many does.",
        f"V3's mean depth is {percent(mean)} above V1's.",
    )


@item(
    "figure-4.32",
    "Sphere patches of the three versions",
    "Diameters 1.28, 1.28 and 1.37 mm.",
    of_all("patch along sliding", "mm", "patch_along_mm", patches("v1", "v2", "v3")),
    of_all("patch across sliding", "mm", "patch_across_mm"),
    of_all("circle of the area ever touched", "mm", "patch_by_area_mm"),
    Row(
        "extent of V3, along and across, all surfaces", "mm", extremes("surfaces.patch_{}_mm"), patches("v3")
    ),
    Row(
        "twice the farthest touched cell, all surfaces",
        "mm",
        extremes("surfaces.farthest_{}_mm"),
        patches("v3"),
    ),
    figures=("sphere_patches",),
)
def _sphere_patches(n: Known) -> Verdict:
    ours = {v: n[f"{v}.patch_by_depth_mm"] for v in ("v1", "v2")}
    smooth = all(abs(d - PATCH_DIAMETERS[v].value) < DIAMETER_TOLERANCE for v, d in ours.items())
    printed = PATCH_DIAMETERS["v3"].value
    low, high = n["surfaces.patch_smallest_mm"], n["surfaces.patch_largest_mm"]
    rough = low - DIAMETER_TOLERANCE < printed < high + DIAMETER_TOLERANCE
    told = (
        f"V1 and V2 {'agree' if smooth else 'do not both agree'} ({number(ours['v1'], 4)} and "
        f"{number(ours['v2'], 4)} mm by their depths). V3's extents along and across run from "
        f"{number(low)} to {number(high)} mm over {n['surfaces']:.0f} surfaces and "
    )
    farthest = (
        "Twice the distance of the farthest touched cell from the middle, as one would draw a circle around "
        f"them all, is {number(n['surfaces.farthest_smallest_mm'], 4)} to "
        f"{number(n['surfaces.farthest_largest_mm'], 4)} mm: which of the two the thesis took, it does "
        "not say."
    )
    return agrees_if(
        smooth and rough,
        f"{told}take in the printed {printed} mm. {farthest}",
        f"{told}{'take in' if rough else 'do not reach'} the printed {printed} mm. {farthest}",
    )


@item(
    "figure-4.32-shape",
    "Worn shape of V2",
    "V2's worn shape is skewed instead of spherical.",
    Row("V2: along against across, largest difference", "µm", of("v2.skewness_um")),
    Row("deepest wear of the sphere", "µm", of("v2.sphere_depth_um")),
    place="Figure 4.32, V2",
)
def _shape_of_v2(n: Known) -> Verdict:
    skew, depth = n["v2.skewness_um"], n["v2.sphere_depth_um"]
    return wrong_if(
        skew < VISIBLE * depth,
        f"By its own equations V2's shape along and across differs by {number(skew, 2)} µm at most, "
        f"{percent(skew / depth)} of the depth: no figure shows that.",
        f"V2's shape along and across differs by {number(skew, 2)} µm, {percent(skew / depth)} of the depth.",
    )


@item(
    "figure-4.33",
    "Disc volumes of the three versions",
    "V2 slightly below V1; V3 above V2, because its pressure is high and constant.",
    of_all("worn volume of the disc", "mm³", "disc_volume_mm3"),
    Row("V3 against V2", "%", of("v3.disc_volume_over_v2")),
    figures=("disc_volumes",),
)
def _disc_volumes(n: Known) -> Verdict:
    against = n["v3.disc_volume_over_v2"]
    return wrong_if(
        against < SAME_VOLUME,
        f"V3's disc volume is V2's ({percent(against)}), and {percent(n['v3.disc_volume_over_v1'])} against "
        "V1's. Archard's law gives K F L for any pressure field, times the mean factor: a higher pressure "
        "acts on less area.",
        f"V3's disc volume is {percent(against)} above V2's.",
    )


@item(
    "figure-4.34",
    "Coefficients of friction of the three versions",
    "V1 and V2 level off; V3 rises in a straight line to very high, unrealistic values.",
    of_all("coefficient at the end", "–", "cof_end"),
    Row("V3 over V1 at the end", "–", of("v3.cof_over_v1")),
    figures=("cof_of_all",),
)
def _cof_of_all(n: Known) -> Verdict:
    over = n["v3.cof_over_v1"]
    return agrees_if(
        over > 10.0 and n["v3.sum_straightness_R2"] > 0.999 and is_root(n, "v1"),
        f"With one shear strength for all, V3's running sum of areas ends {number(over)} times as high as "
        "V1's area in contact. That V3 sums its areas is inferred from the straight line; the text does "
        "not say.",
        f"V3's coefficient ends at {number(over)} times V1's.",
    )


@item(
    "figure-4.35",
    "Worn height of the disc: models and experiment",
    "The three models lie within the error bars of 12 measured tracks. The text prints no value.",
    of_all("deepest cell of the disc", "µm", "disc_depth_um"),
    Row(
        "groove that Table 4.1's K_d makes, 30 mm long, 0.80 mm wide",
        "µm",
        {"experiment": "experiment.groove_depth_um"},
    ),
    figures=("disc_depths",),
)
def _disc_depths(n: Known) -> Verdict:
    model, groove = n["v1.disc_depth_um"], n["experiment.groove_depth_um"]
    return wrong_if(
        model > 5.0 * groove,
        f"The models wear one footprint to {number(model)} µm. The same volume along a track of 30 mm × "
        f"0.80 mm is a groove of {number(groove)} µm, {number(model / groove, 2)} times shallower: models "
        "and experiment cannot agree in height and in Table 4.1's volume at once. The figure's values "
        "themselves are not in the text.",
        f"The models' {number(model)} µm and the groove of Table 4.1 ({number(groove)} µm) go together.",
    )


@item(
    "figure-4.36",
    "Sphere patch: models and experiment",
    "0.80 mm measured, 1.28, 1.28 and 1.37 mm modelled; called comparable.",
    Row("patch diameter", "mm", SMOOTH_PATCHES | ROUGH_PATCHES, patches("experiment", "v1", "v2", "v3")),
    figures=("patch_bars",),
)
def _patch_bars(n: Known) -> Verdict:
    ours, measured = n["v1.patch_by_depth_mm"], PATCH_DIAMETERS["experiment"].value
    return wrong_if(
        ours > 1.2 * measured,
        f"Our models give what the thesis's give, and both are {percent(ours / measured - 1.0)} above the "
        "experiment, which is not comparable: they wear K_s F L off the sphere, "
        f"{number(n['experiment.K_over_cap'], 2)} times the volume of the measured patch's cap, and they do "
        "so on a stationary footprint.",
        f"The models' {number(ours)} mm are near the measured {measured} mm.",
    )


@item(
    "figure-4.37",
    "Coefficients of friction: models and experiment",
    "V1 and V2 are very close to the experiment, except at the start.",
    of_all("coefficient at the start over that at the end", "–", "cof_first_over_end"),
    figures=("relative_cof",),
)
def _relative_cof(n: Known) -> Verdict:
    return Verdict(
        Kind.NOT_COMPARABLE,
        "The thesis prints no coefficient, measured or modelled, and ours hang on an assumed shear "
        "strength, so only shapes relative to the end are drawn. V1 starts at "
        f"{number(n['v1.cof_first_over_end'], 2)} of its end; a contact area that grows a hundredfold "
        "cannot start near the end's value, which is the offset that the text mentions.",
    )


@item(
    "figure-A.8",
    "Area in contact at 0, 30 and 2400 mm",
    "The first area is Hertz's.",
    Row("area at the start", "mm²", {"Hertz": "hertz_area_mm2", "V1": "v1.area_first_mm2"}),
    Row("area at 30 mm", "mm²", of("v1.area_30_mm2")),
    Row("area at 2400 mm", "mm²", of("v1.area_end_mm2")),
    figures=("contact_areas",),
)
def _contact_areas(n: Known) -> Verdict:
    ratio, limit, step = n["v1.area_over_hertz"], n["beyond.limit_mm"], n["beyond.increment_mm"]
    if abs(ratio - 1.0) < 0.05:
        return Verdict(Kind.AGREES, f"The first area is {number(ratio)} of Hertz's.")
    return Verdict(
        Kind.DISAGREES,
        f"Ours starts at {number(ratio)} of Hertz's area, since its foundation matches his peak pressure "
        "(figure 4.17). "
        f"With the foundation that matches his area the explicit step of {number(step)} mm is "
        + (f"beyond the limit of stability, {number(limit)} mm." if step >= limit else "stable."),
    )


@item(
    "figure-A.9",
    "Sphere patch of V2",
    "The factor has only a minor effect on the sphere.",
    Row("sphere depth against V1", "%", of("v2.sphere_depth_change")),
    Row("largest change of a cell", "µm", of("v2.sphere_change_um")),
    figures=("sphere_of_v2",),
)
def _sphere_of_v2(n: Known) -> Verdict:
    depth, cell = n["v2.sphere_depth_change"], n["v2.sphere_change_um"]
    return agrees_if(
        abs(depth) < 0.01,
        f"The depth changes by {percent(depth)}, no cell by more than {number(cell, 2)} µm.",
        f"The depth changes by {percent(depth)}.",
    )


@item(
    "figure-A.10",
    "The straight line of V3",
    "V3's coefficient rises in a straight line because the mesh is too coarse.",
    Row("R² of a straight line: running sum of areas", "–", of("v3.sum_straightness_R2")),
    Row("R²: area ever touched", "–", of("v3.touched_straightness_R2")),
    Row(
        "area in contact: load over hardness",
        "mm²",
        {"V3": "v3.area_first_mm2", "F/H": "v3.load_over_hardness_mm2"},
    ),
    figures=("straight_line",),
)
def _straight_line(n: Known) -> Verdict:
    total, touched = n["v3.sum_straightness_R2"], n["v3.touched_straightness_R2"]
    return wrong_if(
        total > 0.999 and touched < 0.99,
        f"The line is there (R² = {number(total, 5)} for the running sum of areas, {number(touched)} for "
        "the area ever touched), but its cause is not the mesh: p = H makes the area F/H at every mesh, "
        "and a sum of equal areas is a straight line. That areas are summed is an inference.",
        f"R² is {number(total, 5)} for the running sum and {number(touched)} for the area ever touched.",
    )
