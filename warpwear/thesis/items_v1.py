"""The thesis's test, its wear coefficients, and its figures of V1 beside ours, with verdicts."""

from warpwear.thesis.printed import (
    DISTANCE,
    MISPRINTED_DISTANCE,
    PATCH_DIAMETERS,
    SPEEDS,
    TEST_TIMES,
    WEAR_COEFFICIENTS,
)
from warpwear.thesis.verdicts import (
    DIAMETER_TOLERANCE,
    ROOT_EXPONENT,
    SHAPE_TOLERANCE,
    Known,
    Row,
    Table,
    Verdict,
    agrees_if,
    is_root,
    number,
    of,
    patches,
    percent,
    shape_of,
    wrong_if,
)

TABLE = Table()
item = TABLE.item


@item(
    "table-3.4",
    "The test",
    "Four speeds, each with its time and a sliding distance of 2400 mm; Table 3.3: 8 N, 40 motions of 60 mm.",
    Row(
        "sliding distance",
        "mm",
        {"strokes × passes": "experiment.distance_by_strokes_mm"},
        {"thesis": DISTANCE},
    ),
)
def _test(n: Known) -> Verdict:
    by_strokes = n["experiment.distance_by_strokes_mm"]
    by_time = {s.value * t.value for s, t in zip(SPEEDS, TEST_TIMES, strict=True)}
    printed, elsewhere = DISTANCE.value, MISPRINTED_DISTANCE.value
    return agrees_if(
        by_strokes == printed and by_time == {printed},
        f"Strokes and times give the same {number(printed, 4)} mm; every run here slides as far. The "
        f"{number(elsewhere)} mm that section 4.3.1 gives to 80 strokes is a misprint.",
        f"Strokes give {number(by_strokes, 4)} mm, the table {number(printed, 4)} mm.",
    )


@item(
    "table-4.1",
    "Wear coefficients",
    "K of the ball 9.4e-4, of the disc 12.7e-4 (focus variation) or 23.7e-4 mm³/(N·m) (confocal).",
    Row(
        "K of the ball from its 0.80 mm patch, by a cap",
        "10⁻⁴ mm³/(N·m)",
        {"from the patch": "experiment.K_by_cap"},
        {"thesis": WEAR_COEFFICIENTS["sphere"]},
    ),
    Row(
        "the same, by a full ellipsoid (4/3)πa²h",
        "10⁻⁴ mm³/(N·m)",
        {"from the patch": "experiment.K_by_ellipsoid"},
        {"thesis": WEAR_COEFFICIENTS["sphere"]},
    ),
    Row(
        "patch that the printed K alone wears",
        "mm",
        {"from K": "experiment.patch_of_printed_K_mm"},
        patches("experiment"),
    ),
)
def _coefficients(n: Known) -> Verdict:
    over, ellipsoid = n["experiment.K_over_cap"], n["experiment.K_by_ellipsoid"]
    printed = WEAR_COEFFICIENTS["sphere"].value
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
    "Pressure of V1 at the start and at the end",
    "Winkler's pressure is about Hertz's at the start and is flat over a wider contact at the end.",
    Row("peak at the start", "MPa", {"Hertz": "hertz_peak_MPa", "V1": "v1.pressure_first_max_MPa"}),
    Row("area at the start", "mm²", {"Hertz": "hertz_area_mm2", "V1": "v1.area_first_mm2"}),
    Row("mean pressure at the end", "MPa", of("v1.pressure_end_MPa")),
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
    "Pressure and radius of V1 over the distance",
    "Both change very fast at first and slowly after about 0.1 m.",
    Row("fall of the pressure done by 100 mm", "%", of("v1.pressure_fallen_early")),
    Row("radius at 100 mm over that at the end", "%", of("v1.radius_grown_early")),
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
    "Disc profiles of V1",
    "Depth and width of the disc's wear at 30, 600, 1200 and 2400 mm; the depth does not grow linearly.",
    Row("disc depth at the end", "µm", of("v1.disc_depth_um")),
    Row("exponent of depth over distance", "–", of("v1.depth_exponent")),
    place="Figures 4.19 and A.7",
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
    "Final track and patch of V1",
    "The worn disc and the worn sphere of V1 in 3-D.",
    Row("patch, from the two depths", "mm", of("v1.patch_by_depth_mm"), {"thesis": PATCH_DIAMETERS["v1"]}),
    Row(
        "patch of the volume K F L",
        "mm",
        {"cap of a sphere": "closed_form_patch_mm", "paraboloid, 2(4RKFL/π)^¼": "paraboloid_patch_mm"},
    ),
    figures=("disc_3d_of_v1", "sphere_3d_of_v1"),
)
def _shapes_of_v1(n: Known) -> Verdict:
    ours, printed = n["v1.patch_by_depth_mm"], PATCH_DIAMETERS["v1"].value
    return agrees_if(
        abs(ours - printed) < DIAMETER_TOLERANCE,
        f"The diameter is {number(ours, 4)} mm against {printed} mm printed. The disc's scar is as round as "
        "the sphere's: a stationary footprint, not a track.",
        f"The diameter is {number(ours, 4)} mm against {printed} mm printed.",
    )


@item(
    "figure-4.21",
    "Worn volumes of V1",
    "Both grow linearly.",
    Row("sphere", "mm³", of("v1.sphere_volume_mm3")),
    Row("disc", "mm³", of("v1.disc_volume_mm3")),
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
    "Coefficient of friction of V1",
    "It rises fast and then slowly, with the area in contact.",
    Row("exponent m of the late rise", "–", of("v1.exponent_m")),
    Row("levelling index λ", "–", of("v1.levelling_lambda")),
    figures=("cof_of_v1",),
)
def _cof_of_v1(n: Known) -> Verdict:
    return agrees_if(
        is_root(n, "v1"),
        f"The shape is that of a square root ({shape_of(n, 'v1')}; 0.50 and 0.25 by the closed form). The "
        "thesis prints no value of the coefficient.",
        f"The area does not grow as a square root: {shape_of(n, 'v1')}.",
    )
