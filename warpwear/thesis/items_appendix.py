"""Figures of the thesis's appendix beside ours, with verdicts."""

from warpwear.thesis.verdicts import Kind, Known, Row, Table, Verdict, agrees_if, number, percent, wrong_if

TABLE = Table()
item = TABLE.item


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
