"""The thesis's figures of V3 beside ours, with verdicts."""

from warpwear import thesis
from warpwear.thesis_terms import PRESSURE_TOLERANCE, of_all
from warpwear.thesis_verdicts import Kind, Known, Row, Table, Verdict, agrees_if, number, percent

TABLE = Table()
item = TABLE.item


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
        low >= printed[0] - PRESSURE_TOLERANCE and high <= printed[1] + PRESSURE_TOLERANCE,
        f"V3's mean pressure runs from {number(low)} to {number(high)} MPa, as printed.",
        f"(a) and (b) {'agree' if smooth else 'do not both agree'}. (c) is pinned, but not so narrowly as "
        f"printed: with its own load tolerance of 0.5 N the mean runs from {number(low)} to {number(high)} "
        f"MPa on {n['v3.fewest_cells']:.0f} to {n['v3.most_cells']:.0f} cells, and "
        f"{percent(n['v3.pressures_within_printed'])} of the steps are within 580 to 600 MPa. A hardness of "
        "590 MPa is our assumption, and a dichotomy with another start may stop nearer to the load.",
    )
