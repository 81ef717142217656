"""Figures and tables of the thesis's results (sections 4.3 to 4.5, appendix) beside ours, with verdicts."""

from warpwear import thesis
from warpwear.thesis_verdicts import (
    Kind,
    Known,
    Row,
    Table,
    Verdict,
    agrees_if,
    number,
    percent,
    wrong_if,
)

TABLE = Table()
item = TABLE.item

#: Growth of the area as the square root of the distance, and how far from it still counts as that.
ROOT_EXPONENT, ROOT_LEVELLING, SHAPE_TOLERANCE = 0.5, 0.25, 0.05
#: Largest relative difference of two volumes that count as one.
SAME_VOLUME = 1e-3
#: Rounding of a printed diameter plus two cells of 10 µm [mm].
DIAMETER_TOLERANCE = 0.025
#: Part of a depth below which no figure shows a difference of shape.
VISIBLE = 0.01


def of_all(quantity: str, unit: str, key: str, *, factor: float = 1.0) -> Row:
    """One quantity of the four versions."""
    columns = {"V1": "v1", "V2": "v2", "V3": "v3", "V3 fine": "fine"}
    return Row(quantity, unit, {column: f"{name}.{key}" for column, name in columns.items()}, factor=factor)


def is_root(n: Known, name: str) -> bool:
    """Whether an area grows as the square root of the distance."""
    return (
        abs(n[f"{name}.exponent_m"] - ROOT_EXPONENT) < SHAPE_TOLERANCE
        and abs(n[f"{name}.levelling_lambda"] - ROOT_LEVELLING) < SHAPE_TOLERANCE
    )


def shape_of(n: Known, name: str) -> str:
    """m and λ in words."""
    return f"m = {number(n[f'{name}.exponent_m'])}, λ = {number(n[f'{name}.levelling_lambda'])}"


@item(
    "table-3.4",
    "Table 3.4",
    "The test",
    says="Four speeds, each with its time and a sliding distance of 2400 mm; Table 3.3: 8 N, 40 motions "
    "of 60 mm.",
    rows=(
        Row(
            "sliding distance",
            "mm",
            {"strokes × passes": "experiment.distance_by_strokes_mm"},
            {"thesis": thesis.DISTANCE},
        ),
    ),
)
def _test(n: Known) -> Verdict:
    by_strokes = n["experiment.distance_by_strokes_mm"]
    by_time = {s.value * t.value for s, t in zip(thesis.SPEEDS, thesis.TEST_TIMES, strict=True)}
    printed, elsewhere = thesis.DISTANCE.value, thesis.MISPRINTED_DISTANCE.value
    return agrees_if(
        by_strokes == printed and by_time == {printed},
        f"Strokes and times give the same {number(printed, 4)} mm; every run here slides as far. The "
        f"{number(elsewhere)} mm that section 4.3.1 gives to 80 strokes is a misprint.",
        f"Strokes give {number(by_strokes, 4)} mm, the table {number(printed, 4)} mm.",
    )


@item(
    "table-4.1",
    "Table 4.1",
    "Wear coefficients",
    says="K of the ball 9.4e-4, of the disc 12.7e-4 (focus variation) or 23.7e-4 mm³/(N·m) (confocal).",
    rows=(
        Row(
            "K of the ball from its 0.80 mm patch, by a cap",
            "10⁻⁴ mm³/(N·m)",
            {"from the patch": "experiment.K_by_cap"},
            {"thesis": thesis.WEAR_COEFFICIENTS["sphere"]},
            factor=1e4,
            printed_factor=1e4,
        ),
        Row(
            "the same, by a full ellipsoid (4/3)πa²h",
            "10⁻⁴ mm³/(N·m)",
            {"from the patch": "experiment.K_by_ellipsoid"},
            {"thesis": thesis.WEAR_COEFFICIENTS["sphere"]},
            factor=1e4,
            printed_factor=1e4,
        ),
        Row(
            "patch that the printed K alone wears",
            "mm",
            {"from K": "experiment.patch_of_printed_K_mm"},
            {"experiment": thesis.PATCH_DIAMETERS["experiment"]},
        ),
    ),
)
def _coefficients(n: Known) -> Verdict:
    over, ellipsoid = n["experiment.K_over_cap"], n["experiment.K_by_ellipsoid"]
    printed = thesis.WEAR_COEFFICIENTS["sphere"].value
    guess = (
        f" A full ellipsoid gives {number(1e4 * ellipsoid)}·10⁻⁴, near the printed value: probably that "
        "formula was used (an inference)."
        if abs(ellipsoid / printed - 1.0) < 0.02
        else ""
    )
    return wrong_if(
        abs(over - 1.0) > 0.2,
        "The printed patch of 0.80 mm holds a cap that gives "
        f"{number(1e4 * n['experiment.K_by_cap'])}·10⁻⁴, so the printed K is {number(over, 2)} times too "
        f"large, or the patch is not the whole wear.{guess}",
        "The printed patch and the printed K of the ball go together.",
    )


@item(
    "figure-4.17",
    "Figure 4.17",
    "Pressure of V1 at the start and at the end",
    says="Winkler's pressure is about Hertz's at the start and is flat over a wider contact at the end.",
    rows=(
        Row("peak at the start", "MPa", {"Hertz": "hertz_peak_MPa", "V1": "v1.pressure_first_max_MPa"}),
        Row("area at the start", "mm²", {"Hertz": "hertz_area_mm2", "V1": "v1.area_first_mm2"}),
        Row("mean pressure at the end", "MPa", {"V1": "v1.pressure_end_MPa"}),
    ),
    figures=("pressure_of_v1",),
)
def _pressure_of_v1(n: Known) -> Verdict:
    uneven, peak, area = n["v1.pressure_unevenness"], n["v1.peak_over_hertz"], n["v1.area_over_hertz"]
    return agrees_if(
        uneven < 0.01 and abs(peak - 1.0) < 0.05,
        f"At the end the pressure is flat (it scatters by {percent(uneven)} of its mean). At the start the "
        f"peak is {number(peak)} of Hertz's, but then the area is {number(area)} times his: a foundation "
        "matches one of the two. The thesis prints no elastic constants, so its values cannot be checked.",
        f"The end scatters by {percent(uneven)} of its mean, the first peak is {number(peak)} of Hertz's.",
    )


@item(
    "figure-4.18",
    "Figure 4.18",
    "Pressure and radius of V1 over the distance",
    says="Both change very fast at first and slowly after about 0.1 m.",
    rows=(
        Row("fall of the pressure done by 100 mm", "%", {"V1": "v1.pressure_fallen_early"}, factor=100.0),
        Row("radius at 100 mm over that at the end", "%", {"V1": "v1.radius_grown_early"}, factor=100.0),
    ),
    figures=("radius_and_pressure",),
)
def _radius_and_pressure(n: Known) -> Verdict:
    fallen, radius = n["v1.pressure_fallen_early"], n["v1.radius_grown_early"]
    return agrees_if(
        fallen > 0.9 and radius < 0.9,
        f"By 100 mm {percent(fallen)} of the fall in pressure is over. The radius is then at "
        f"{percent(radius)} of its end: it grows with the fourth root of the distance, without a knee at "
        "any place.",
        f"By 100 mm only {percent(fallen)} of the fall in pressure is over.",
    )


@item(
    "figure-4.19",
    "Figures 4.19 and A.7",
    "Disc profiles of V1",
    says="Depth and width of the disc's wear at 30, 600, 1200 and 2400 mm; the depth does not grow linearly.",
    rows=(
        Row("disc depth at the end", "µm", {"V1": "v1.disc_depth_um"}),
        Row("exponent of depth over distance", "–", {"V1": "v1.depth_exponent"}),
    ),
    figures=("disc_of_v1",),
)
def _disc_of_v1(n: Known) -> Verdict:
    exponent = n["v1.depth_exponent"]
    return agrees_if(
        abs(exponent - ROOT_EXPONENT) < SHAPE_TOLERANCE,
        f"The depth grows as the square root of the distance (exponent {number(exponent)}), to "
        f"{number(n['v1.disc_depth_um'])} µm. The text prints no depth.",
        f"The depth grows with an exponent of {number(exponent)}, not of one half.",
    )


@item(
    "figure-4.20",
    "Figure 4.20",
    "Final track and patch of V1",
    says="The worn disc and the worn sphere of V1 in 3-D.",
    rows=(
        Row(
            "patch, from the two depths",
            "mm",
            {"V1": "v1.patch_by_depth_mm"},
            {"thesis": thesis.PATCH_DIAMETERS["v1"]},
        ),
        Row(
            "patch of the volume K F L",
            "mm",
            {"cap of a sphere": "closed_form_patch_mm", "paraboloid, 2(4RKFL/π)^¼": "paraboloid_patch_mm"},
        ),
    ),
    figures=("disc_3d_of_v1", "sphere_3d_of_v1"),
)
def _shapes_of_v1(n: Known) -> Verdict:
    ours, printed = n["v1.patch_by_depth_mm"], thesis.PATCH_DIAMETERS["v1"].value
    return agrees_if(
        abs(ours - printed) < DIAMETER_TOLERANCE,
        f"The diameter is {number(ours, 4)} mm against {printed} mm printed. The disc's scar is as round as "
        "the sphere's: a stationary footprint, not a track.",
        f"The diameter is {number(ours, 4)} mm against {printed} mm printed.",
    )


@item(
    "figure-4.21",
    "Figure 4.21",
    "Worn volumes of V1",
    says="Both grow linearly.",
    rows=(
        Row("sphere", "mm³", {"V1": "v1.sphere_volume_mm3"}),
        Row("disc", "mm³", {"V1": "v1.disc_volume_mm3"}),
    ),
    figures=("volumes_of_v1",),
)
def _volumes_of_v1(n: Known) -> Verdict:
    error = max(abs(n["v1.sphere_volume_error"]), abs(n["v1.disc_volume_error"]))
    return agrees_if(
        n["v1.volume_straightness_R2"] > 0.99999 and error < 1e-10,
        f"Straight lines that end at K F L to {number(error, 1)}. They are so for any pressure field: "
        "correct volumes prove nothing about a contact model.",
        f"The volumes are off K F L by {number(error, 2)}.",
    )


@item(
    "figure-4.22",
    "Figure 4.22",
    "Coefficient of friction of V1",
    says="It rises fast and then slowly, with the area in contact.",
    rows=(
        Row("exponent m of the late rise", "–", {"V1": "v1.exponent_m"}),
        Row("levelling index λ", "–", {"V1": "v1.levelling_lambda"}),
    ),
    figures=("cof_of_v1",),
)
def _cof_of_v1(n: Known) -> Verdict:
    return agrees_if(
        is_root(n, "v1"),
        f"The shape is that of a square root ({shape_of(n, 'v1')}; 0.50 and 0.25 by the closed form). The "
        "thesis prints no value of the coefficient.",
        f"The area does not grow as a square root: {shape_of(n, 'v1')}.",
    )


@item(
    "figure-4.24",
    "Figure 4.24",
    "Position-dependent sliding distance of V2",
    says="e = 2R cos θ: disc points beside the middle slide less. The text measures d radially.",
    rows=(
        Row(
            "factor at the edge of the patch",
            "–",
            {"V2": "v2.factor_at_edge", "chord of the contact": "v2.true_factor_at_edge"},
        ),
    ),
    figures=("distance_factor",),
)
def _factor(n: Known) -> Verdict:
    ours, true = n["v2.factor_at_edge"], n["v2.true_factor_at_edge"]
    return wrong_if(
        ours - true > 0.1,
        "2R cos θ is the chord of the ball, not of the contact, and 6 mm in the middle is no sliding "
        f"distance. Used relative to the middle it is {number(ours)} at the edge. A cell that the contact "
        f"passes over slides the contact's chord 2√(a² − y²), which falls to {number(true, 2)} in the "
        "outermost cell.",
        "The factor is that of the contact's chord.",
    )


@item(
    "figure-4.25",
    "Figure 4.25",
    "Pressure of V2 at the end",
    says="The pressure is no longer flat: the factor changes it across sliding.",
    rows=(
        Row(
            "pressure at the edge above the middle",
            "%",
            {"V2": "v2.edge_pressure_excess", "closed form": "v2.edge_pressure_excess_expected"},
            factor=100.0,
        ),
    ),
    figures=("pressure_of_v2",),
)
def _pressure_of_v2(n: Known) -> Verdict:
    ours, expected = n["v2.edge_pressure_excess"], n["v2.edge_pressure_excess_expected"]
    return agrees_if(
        ours > 0.0 and abs(ours - expected) < 0.003,
        f"Across sliding the edge carries {percent(ours)} more than the middle; the closed form (K_s + "
        f"K_d)/(K_s + K_d cos θ) − 1 gives {percent(expected)}. Along sliding it is flat.",
        f"The edge carries {percent(ours)} more than the middle; the closed form gives {percent(expected)}.",
    )


@item(
    "figure-4.26",
    "Figure 4.26",
    "Worn volumes of V2",
    says="The sphere's volume is that of V1, the disc's a little less.",
    rows=(
        Row("disc against V1", "%", {"V2": "v2.disc_volume_change"}, factor=100.0),
        Row("sphere against V1", "%", {"V2": "v2.sphere_volume_change"}, factor=100.0),
    ),
    figures=("volumes_of_v2",),
)
def _volumes_of_v2(n: Known) -> Verdict:
    disc, sphere = n["v2.disc_volume_change"], n["v2.sphere_volume_change"]
    return agrees_if(
        -0.01 < disc < 0.0 and abs(sphere) < 1e-9,
        f"The sphere's is the same, the disc's {percent(disc)}.",
        f"The disc's differs by {percent(disc)}, the sphere's by {percent(sphere)}.",
    )


@item(
    "figure-4.27",
    "Figure 4.27",
    "Coefficient of friction of V2",
    says="The factor has a major impact on the curve of the coefficient, whose trend is that of V1.",
    rows=(
        Row("largest change against V1 after 30 mm", "%", {"V2": "v2.cof_change_largest"}, factor=100.0),
        Row("change at the end", "%", {"V2": "v2.cof_change_end"}, factor=100.0),
    ),
    figures=("cof_of_v2",),
)
def _cof_of_v2(n: Known) -> Verdict:
    largest, end = n["v2.cof_change_largest"], n["v2.cof_change_end"]
    return wrong_if(
        largest < 0.03,
        f"By its own equations the factor changes the coefficient by {percent(largest)} at most (the count "
        f"of cells at the rim) and by {percent(end)} at the end: no curve shows that. The trend is that of "
        f"V1 ({shape_of(n, 'v2')}). A larger difference would be the scatter of an unstable step (an "
        "inference; see the finding on stability).",
        f"The factor changes the coefficient by up to {percent(largest)}.",
    )


@item(
    "figure-4.28",
    "Figure 4.28",
    "Final track and patch of V3",
    says="The sphere is marked where high peaks of the disc met it.",
    rows=(
        Row(
            "pattern on the sphere (root mean square)",
            "µm",
            {"V1": "v1.sphere_pattern_um", "V3": "v3.sphere_pattern_um"},
        ),
    ),
    figures=("disc_3d_of_v3", "sphere_3d_of_v3"),
)
def _shapes_of_v3(n: Known) -> Verdict:
    rough, smooth = n["v3.sphere_pattern_um"], n["v1.sphere_pattern_um"]
    return agrees_if(
        rough > 0.1 and rough > 10.0 * smooth,
        f"The sphere bears a pattern of {number(rough)} µm about its worn bowl. On a real track the sphere "
        "meets ever new peaks, which would smear the pattern into grooves: it is owed to the stationary "
        "footprint.",
        f"The sphere bears a pattern of only {number(rough)} µm.",
    )


@item(
    "figure-4.29",
    "Figure 4.29",
    "Topography of V3 and its wear in stages",
    says="The measured topography, the part used, and its worn patch at several distances.",
    figures=("disc_maps_of_v3",),
)
def _topography(n: Known) -> Verdict:
    return Verdict(
        Kind.NOT_COMPARABLE,
        "The measured topography is not published; ours is synthetic, with the printed Ra. The course is "
        f"the same: peaks go first, and at the end {number(n['v3.area_touched_mm2'])} mm² have been touched.",
    )


@item(
    "figure-4.30",
    "Figure 4.30",
    "Pressure maps at the end",
    says="(a) V1 constant, (b) V2 varying across sliding, (c) V3 always between 580 and 600 MPa on the "
    "same number of points.",
    rows=(
        of_all("mean pressure at the end", "MPa", "pressure_end_MPa"),
        Row(
            "smallest mean of a step",
            "MPa",
            {"V3": "v3.pressure_smallest_MPa"},
            {"thesis V3": thesis.V3_PRESSURES[0]},
        ),
        Row(
            "largest mean of a step",
            "MPa",
            {"V3": "v3.pressure_largest_MPa"},
            {"thesis V3": thesis.V3_PRESSURES[1]},
        ),
        Row("steps within the printed limits", "%", {"V3": "v3.pressures_within_printed"}, factor=100.0),
    ),
    figures=("pressure_maps",),
)
def _pressure_maps(n: Known) -> Verdict:
    low, high = n["v3.pressure_smallest_MPa"], n["v3.pressure_largest_MPa"]
    printed = [p.value for p in thesis.V3_PRESSURES]
    smooth = n["v1.pressure_unevenness"] < 0.01 and n["v2.edge_pressure_excess"] > 0.0
    return agrees_if(
        low >= printed[0] - 5.0 and high <= printed[1] + 5.0,
        f"V3's mean pressure runs from {number(low)} to {number(high)} MPa, as printed.",
        f"(a) and (b) {'agree' if smooth else 'do not both agree'}. (c) is pinned, but not so narrowly as "
        f"printed: with its own load tolerance of 0.5 N the mean runs from {number(low)} to {number(high)} "
        f"MPa on {n['v3.fewest_cells']:.0f} to {n['v3.most_cells']:.0f} cells, and "
        f"{percent(n['v3.pressures_within_printed'])} of the steps are within 580 to 600 MPa. A hardness of "
        "590 MPa is our assumption, and a dichotomy with another start may stop nearer to the load.",
    )


@item(
    "figure-4.31",
    "Figure 4.31",
    "Disc profiles of the three versions",
    says="V3's wear is deeper and its contact larger than that of V1 and V2, because of its high "
    "constant pressure.",
    rows=(
        of_all("deepest cell of the disc", "µm", "disc_depth_um"),
        Row("mean depth in the scar", "µm", {"V1": "v1.mean_disc_depth_um", "V3": "v3.mean_disc_depth_um"}),
        of_all("area ever touched", "mm²", "area_touched_mm2"),
        of_all("area in contact at the end", "mm²", "area_end_mm2"),
    ),
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
    "Figure 4.32",
    "Sphere patches of the three versions",
    says="Diameters 1.28, 1.28 and 1.37 mm.",
    rows=(
        Row(
            "patch along sliding",
            "mm",
            {
                "V1": "v1.patch_along_mm",
                "V2": "v2.patch_along_mm",
                "V3": "v3.patch_along_mm",
                "V3 fine": "fine.patch_along_mm",
            },
            {f"thesis {v.upper()}": thesis.PATCH_DIAMETERS[v] for v in ("v1", "v2", "v3")},
        ),
        of_all("patch across sliding", "mm", "patch_across_mm"),
        of_all("circle of the area ever touched", "mm", "patch_by_area_mm"),
        Row(
            "extent of V3, along and across, all surfaces",
            "mm",
            {"smallest": "surfaces.patch_smallest_mm", "largest": "surfaces.patch_largest_mm"},
            {"thesis V3": thesis.PATCH_DIAMETERS["v3"]},
        ),
        Row(
            "twice the farthest touched cell, all surfaces",
            "mm",
            {"smallest": "surfaces.farthest_smallest_mm", "largest": "surfaces.farthest_largest_mm"},
            {"thesis V3": thesis.PATCH_DIAMETERS["v3"]},
        ),
    ),
    figures=("sphere_patches",),
)
def _sphere_patches(n: Known) -> Verdict:
    ours = {v: n[f"{v}.patch_by_depth_mm"] for v in ("v1", "v2")}
    smooth = all(abs(d - thesis.PATCH_DIAMETERS[v].value) < DIAMETER_TOLERANCE for v, d in ours.items())
    printed = thesis.PATCH_DIAMETERS["v3"].value
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
    "Figure 4.32, V2",
    "Worn shape of V2",
    says="V2's worn shape is skewed instead of spherical.",
    rows=(
        Row("V2: along against across, largest difference", "µm", {"V2": "v2.skewness_um"}),
        Row("deepest wear of the sphere", "µm", {"V2": "v2.sphere_depth_um"}),
    ),
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
    "Figure 4.33",
    "Disc volumes of the three versions",
    says="V2 slightly below V1; V3 above V2, because its pressure is high and constant.",
    rows=(
        of_all("worn volume of the disc", "mm³", "disc_volume_mm3"),
        Row("V3 against V2", "%", {"V3": "v3.disc_volume_over_v2"}, factor=100.0),
    ),
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
    "Figure 4.34",
    "Coefficients of friction of the three versions",
    says="V1 and V2 level off; V3 rises in a straight line to very high, unrealistic values.",
    rows=(
        of_all("coefficient at the end", "–", "cof_end"),
        Row("V3 over V1 at the end", "–", {"V3": "v3.cof_over_v1"}),
    ),
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
    "Figure 4.35",
    "Worn height of the disc: models and experiment",
    says="The three models lie within the error bars of 12 measured tracks. The text prints no value.",
    rows=(
        of_all("deepest cell of the disc", "µm", "disc_depth_um"),
        Row(
            "groove that Table 4.1's K_d makes, 30 mm long, 0.80 mm wide",
            "µm",
            {"experiment": "experiment.groove_depth_um"},
        ),
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
    "Figure 4.36",
    "Sphere patch: models and experiment",
    says="0.80 mm measured, 1.28, 1.28 and 1.37 mm modelled; called comparable.",
    rows=(
        Row(
            "patch diameter",
            "mm",
            {
                "V1": "v1.patch_by_depth_mm",
                "V2": "v2.patch_by_depth_mm",
                "V3": "v3.patch_along_mm",
                "V3 fine": "fine.patch_along_mm",
            },
            {
                "experiment": thesis.PATCH_DIAMETERS["experiment"],
                "thesis V1": thesis.PATCH_DIAMETERS["v1"],
                "thesis V2": thesis.PATCH_DIAMETERS["v2"],
                "thesis V3": thesis.PATCH_DIAMETERS["v3"],
            },
        ),
    ),
    figures=("patch_bars",),
)
def _patch_bars(n: Known) -> Verdict:
    ours, measured = n["v1.patch_by_depth_mm"], thesis.PATCH_DIAMETERS["experiment"].value
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
    "Figure 4.37",
    "Coefficients of friction: models and experiment",
    says="V1 and V2 are very close to the experiment, except at the start.",
    rows=(of_all("coefficient at the start over that at the end", "–", "cof_first_over_end"),),
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
    "Figure A.8",
    "Area in contact at 0, 30 and 2400 mm",
    says="The first area is Hertz's.",
    rows=(
        Row("area at the start", "mm²", {"Hertz": "hertz_area_mm2", "V1": "v1.area_first_mm2"}),
        Row("area at 30 mm", "mm²", {"V1": "v1.area_30_mm2"}),
        Row("area at 2400 mm", "mm²", {"V1": "v1.area_end_mm2"}),
    ),
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
    "Figure A.9",
    "Sphere patch of V2",
    says="The factor has only a minor effect on the sphere.",
    rows=(
        Row("sphere depth against V1", "%", {"V2": "v2.sphere_depth_change"}, factor=100.0),
        Row("largest change of a cell", "µm", {"V2": "v2.sphere_change_um"}),
    ),
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
    "Figure A.10",
    "The straight line of V3",
    says="V3's coefficient rises in a straight line because the mesh is too coarse.",
    rows=(
        Row("R² of a straight line: running sum of areas", "–", {"V3": "v3.sum_straightness_R2"}),
        Row("R²: area ever touched", "–", {"V3": "v3.touched_straightness_R2"}),
        Row(
            "area in contact: load over hardness",
            "mm²",
            {"V3": "v3.area_first_mm2", "F/H": "v3.load_over_hardness_mm2"},
        ),
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
