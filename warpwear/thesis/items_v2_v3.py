"""The thesis's figures of V2 and V3 beside ours, with verdicts."""

from warpwear.thesis.printed import V3_PRESSURES
from warpwear.thesis.verdicts import (
    PRESSURE_TOLERANCE,
    Kind,
    Known,
    Row,
    Table,
    Verdict,
    agrees_if,
    number,
    of,
    of_all,
    percent,
    shape_of,
    wrong_if,
)

TABLE = Table()
item = TABLE.item


@item(
    "figure-4.24",
    "Position-dependent sliding distance of V2",
    "e = 2R cos θ: disc points beside the middle slide less. The text measures d radially.",
    Row(
        "factor at the edge of the patch",
        "–",
        {"V2": "v2.factor_at_edge", "chord of the contact": "v2.true_factor_at_edge"},
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
    "Pressure of V2 at the end",
    "The pressure is no longer flat: the factor changes it across sliding.",
    Row(
        "pressure at the edge above the middle",
        "%",
        {"V2": "v2.edge_pressure_excess", "closed form": "v2.edge_pressure_excess_expected"},
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
    "Worn volumes of V2",
    "The sphere's volume is that of V1, the disc's a little less.",
    Row("disc against V1", "%", of("v2.disc_volume_change")),
    Row("sphere against V1", "%", of("v2.sphere_volume_change")),
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
    "Coefficient of friction of V2",
    "The factor has a major impact on the curve of the coefficient, whose trend is that of V1.",
    Row("largest change against V1 after 30 mm", "%", of("v2.cof_change_largest")),
    Row("change at the end", "%", of("v2.cof_change_end")),
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
    "Final track and patch of V3",
    "The sphere is marked where high peaks of the disc met it.",
    Row("pattern on the sphere (root mean square)", "µm", of("v1.sphere_pattern_um", "v3.sphere_pattern_um")),
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
    "Topography of V3 and its wear in stages",
    "The measured topography, the part used, and its worn patch at several distances.",
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
    "Pressure maps at the end",
    "(a) V1 constant, (b) V2 varying across sliding, (c) V3 always between 580 and 600 MPa on the "
    "same number of points.",
    of_all("mean pressure at the end", "MPa", "pressure_end_MPa"),
    Row("smallest mean of a step", "MPa", of("v3.pressure_smallest_MPa"), {"thesis V3": V3_PRESSURES[0]}),
    Row("largest mean of a step", "MPa", of("v3.pressure_largest_MPa"), {"thesis V3": V3_PRESSURES[1]}),
    Row("steps within the printed limits", "%", of("v3.pressures_within_printed")),
    figures=("pressure_maps",),
)
def _pressure_maps(n: Known) -> Verdict:
    low, high = n["v3.pressure_smallest_MPa"], n["v3.pressure_largest_MPa"]
    printed = [p.value for p in V3_PRESSURES]
    smooth = n["v1.pressure_unevenness"] < 0.01 and n["v2.edge_pressure_excess"] > 0.0
    return agrees_if(
        low >= printed[0] - PRESSURE_TOLERANCE and high <= printed[1] + PRESSURE_TOLERANCE,
        f"V3's mean pressure runs from {number(low)} to {number(high)} MPa, as printed.",
        f"(a) and (b) {'agree' if smooth else 'do not both agree'}. (c) is pinned, but not so narrowly as "
        f"printed: with its own load tolerance of 0.5 N the mean runs from {number(low)} to {number(high)} "
        f"MPa on {n['v3.fewest_cells']:.0f} to {n['v3.most_cells']:.0f} cells, and "
        f"{percent(n['v3.pressures_within_printed'])} of the steps are within 580 to 600 MPa. A hardness of "
        "590 MPa is our assumption, and a dichotomy with another start may stop nearer to the load.",
    )
