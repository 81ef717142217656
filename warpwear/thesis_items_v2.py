"""The thesis's figures of V2 beside ours, with verdicts."""

from warpwear.thesis_terms import shape_of
from warpwear.thesis_verdicts import Known, Row, Table, Verdict, agrees_if, number, percent, wrong_if

TABLE = Table()
item = TABLE.item


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
