"""What the report says of the thesis's models in its own words, each statement with a rule that can fail."""

from warpwear.thesis.printed import PATCH_DIAMETERS, WEAR_COEFFICIENTS
from warpwear.thesis.verdicts import (
    SAME_VOLUME,
    Kind,
    Known,
    Row,
    Table,
    Verdict,
    extremes,
    holds_if,
    is_root,
    number,
    of,
    of_all,
    patches,
    percent,
    shape_of,
)

FINDINGS = Table()
item = FINDINGS.item

#: The cure is there when the fine area starts this near to F/H and ends this near to V1's.
CURED = 0.03


@item(
    "volume",
    "The disc volume of V3 is not above that of V2",
    "V = K F L for any pressure field, times V2's factor.",
    of_all("disc volume", "mm³", "disc_volume_mm3"),
    of_all("disc volume over K F L", "–", "disc_volume_over_KFL"),
    Row("V3 against V2, over all surfaces", "%", extremes("surfaces.disc_volume_over_v2_{}")),
)
def _volume(n: Known) -> Verdict:
    low, high = n["surfaces.disc_volume_over_v2_smallest"], n["surfaces.disc_volume_over_v2_largest"]
    same = max(abs(low), abs(high), abs(n["v3.disc_volume_over_v2"])) < SAME_VOLUME
    return holds_if(
        same,
        f"Over {n['surfaces']:.0f} rough surfaces V3's disc volume differs from V2's by {percent(low)} to "
        f"{percent(high)}: the remainder is where the contacts lie across sliding. V2's and V3's are below "
        f"V1's by {percent(-n['v2.disc_volume_change'])}.",
        f"V3's disc volume differs from V2's by {percent(low)} to {percent(high)}.",
    )


@item(
    "patch",
    "The printed patch, the printed wear coefficients and the models cannot all be right",
    "0.80 mm measured; K_s = 9.4e-4; a stationary footprint worn by both bodies.",
    Row(
        "patch on the sphere",
        "mm",
        {
            "K_s alone, swept track": "experiment.patch_of_printed_K_mm",
            "both, stationary (cap of K F L)": "closed_form_patch_mm",
            "V1": "v1.patch_by_depth_mm",
        },
        patches("experiment", "v1"),
    ),
    Row(
        "K_s of 0.80 mm",
        "10⁻⁴ mm³/(N·m)",
        {"cap": "experiment.K_by_cap", "full ellipsoid": "experiment.K_by_ellipsoid"},
        {"Table 4.1": WEAR_COEFFICIENTS["sphere"]},
    ),
)
def _patch(n: Known) -> Verdict:
    measured = PATCH_DIAMETERS["experiment"].value
    alone, both = n["experiment.patch_of_printed_K_mm"], n["closed_form_patch_mm"]
    return holds_if(
        alone > 1.1 * measured and both > 1.1 * alone,
        f"With Table 4.1's K_s the sphere alone wears to {number(alone, 4)} mm on a swept track, where the "
        "disc hardly recedes. On a stationary footprint both bodies wear in one place and smooth models "
        f"must give {number(both, 4)} mm, ours and the thesis's. {measured:.2f} mm gives K_s = "
        f"{number(1e4 * n['experiment.K_by_cap'])}·10⁻⁴ by the cap.",
        f"K_s alone gives {number(alone, 4)} mm, both bodies {number(both, 4)} mm, measured were {measured} "
        "mm.",
    )


@item(
    "line",
    "V3's friction is a straight line, and its pressure pinned, by construction and not by the mesh",
    "p = H on every cell in contact makes the area F/H at any mesh; a running sum of equal areas is "
    "straight.",
    Row("R² of the running sum", "–", of("v3.sum_straightness_R2")),
    Row("running sum over V1's worn area", "–", of("v3.sum_over_worn_patch")),
    Row("scatter of the mean pressure", "MPa", of("v3.pressure_scatter_MPa")),
    Row("exponent of the area in contact", "–", of("v3.exponent_m")),
)
def _line(n: Known) -> Verdict:
    total = n["v3.sum_straightness_R2"]
    pinned = n["v3.pressure_largest_MPa"] / n["v3.pressure_smallest_MPa"] < 1.3
    return holds_if(
        total > 0.999 and n["v3.touched_straightness_R2"] < 0.99 and pinned,
        f"The running sum is straight (R² = {number(total, 5)}) and ends at "
        f"{number(n['v3.area_sum_mm2'], 4)} mm², {number(n['v3.sum_over_worn_patch'], 2)} times the worn "
        f"patch; the area ever touched is not (R² = {number(n['v3.touched_straightness_R2'])}). The summing "
        f"is an inference. The pressure scatters by {number(n['v3.pressure_scatter_MPa'], 2)} MPa, since "
        f"the load tolerance of 0.5 N allows {number(n['v3.pressure_least_allowed_MPa'])} to "
        f"{number(n['v3.pressure_most_allowed_MPa'])} MPa at any mesh.",
        f"The running sum has R² = {number(total, 5)}; the pressure runs from "
        f"{number(n['v3.pressure_smallest_MPa'])} to {number(n['v3.pressure_largest_MPa'])} MPa.",
    )


@item(
    "cure",
    "Converged, V3's equations level off, and reduce to V1",
    "Four parts: balance to one cell, fine cells, implicit steps, the area in contact at each moment.",
    Row("area at the start", "mm²", {"V3 fine": "fine.area_first_mm2", "F/H": "v3.load_over_hardness_mm2"}),
    of_all("area at 30 mm", "mm²", "area_30_mm2"),
    of_all("area at the end", "mm²", "area_end_mm2"),
    of_all("exponent m of the area in contact", "–", "exponent_m"),
    of_all("levelling index λ of the area in contact", "–", "levelling_lambda"),
    figures=("areas_of_all",),
)
def _cure(n: Known) -> Verdict:
    start, end = n["fine.area_first_over_F_H"], n["fine.area_over_v1"]
    return holds_if(
        abs(start - 1.0) < CURED and abs(end - 1.0) < CURED and is_root(n, "fine"),
        f"The area starts at {number(start)} of F/H, rises as a square root in the end "
        f"({shape_of(n, 'fine')}, against 1 and 1 for a straight line) and ends at {number(end)} of V1's. "
        "This shows what the equations imply on a stationary footprint, where at the end everything "
        f"touches at {number(n['fine.pressure_end_MPa'], 2)} MPa; it does not show what steel does.",
        f"The area starts at {number(start)} of F/H and ends at {number(end)} of V1's; "
        f"{shape_of(n, 'fine')}.",
    )


@item(
    "increments",
    "Implicit wear does not depend on the increment",
    "V1 with implicit wear ends at the same area and depth for every increment, within 1 %.",
)
def _increments(n: Known) -> Verdict:
    most = n["implicit.largest_deviation"]
    return holds_if(
        most < 0.01,
        f"Area and depth at the end differ from the explicit V1's by {percent(most)} at most.",
        f"Area or depth at the end differ from the explicit V1's by {percent(most)}.",
    )


@item(
    "stability",
    "Beyond the limit of explicit wear the area is wrong, and nothing else shows it",
    "V1 with the foundation that matches Hertz's area, explicit at 0.3 mm; the solver refuses it "
    "unless forced.",
    Row("limit of the increment", "mm", {"Hertz's area": "beyond.limit_mm", "V1": "v1.limit_mm"}),
    Row(
        "area against the stable run",
        "%",
        {
            "last step": "beyond.area_last",
            "mean": "beyond.area_mean",
            "lowest": "beyond.area_lowest",
            "highest": "beyond.area_highest",
        },
    ),
    Row("scatter of the pressure over its mean, last step", "%", {"unstable": "beyond.pressure_unevenness"}),
    Row(
        "patch, disc depth, disc volume against V1",
        "%",
        {"patch": "beyond.patch_change", "depth": "beyond.depth_change", "volume": "beyond.volume_change"},
    ),
    figures=("stability",),
)
def _stability(n: Known) -> Verdict:
    if n["beyond.increment_mm"] < n["beyond.limit_mm"]:
        return Verdict(Kind.NOT_COMPARABLE, "The increment of these studies is within the limit.")
    shapes = max(abs(n["beyond.patch_change"]), abs(n["beyond.depth_change"]), abs(n["beyond.volume_change"]))
    return holds_if(
        n["beyond.area_mean"] < -0.1 and n["beyond.area_lowest"] < -0.2 and shapes < 0.01,
        f"Patch, depth and volume are right to {percent(shapes, 1)}, but the area in contact is "
        f"{percent(-n['beyond.area_mean'])} low in the mean; single steps range from "
        f"{percent(n['beyond.area_lowest'])} to {percent(n['beyond.area_highest'])} and the last is "
        f"{percent(n['beyond.area_last'])}. The series is chaotic, so any one step, the last one too, is a "
        "number without meaning; friction follows this area.",
        f"The area is {percent(n['beyond.area_mean'])} from the stable one in the mean, shapes differ by "
        f"{percent(shapes)}.",
    )


@item(
    "surfaces",
    "V3's patch is as wide as the highest peaks at its rim allow",
    "Touched is where the disc stands above the sphere's worn shape: at most 2√(z(2R − z)) across, with "
    "z = R − √(R² − a²) + R_p.",
    Row(
        "patch, along and across, over all surfaces",
        "mm",
        {
            "smallest": "surfaces.patch_smallest_mm",
            "mean": "surfaces.patch_mean_mm",
            "largest": "surfaces.patch_largest_mm",
        },
        patches("v3"),
    ),
    Row("twice the farthest touched cell", "mm", extremes("surfaces.farthest_{}_mm")),
    Row("extent with peaks R_p at both ends, 2√(z(2R − z))", "mm", extremes("surfaces.bound_{}_mm")),
    Row(
        "highest peak near the rim, R_p",
        "µm",
        {
            "smallest": "surfaces.peak_smallest_um",
            "largest": "surfaces.peak_largest_um",
            "asked by 1.37 mm": "surfaces.peak_asked_um",
        },
    ),
    figures=("rough_patches",),
)
def _surfaces(n: Known) -> Verdict:
    printed = PATCH_DIAMETERS["v3"].value
    explained = (
        n["surfaces.prediction_error_mm"] < 4.0 * n["surfaces.cell_mm"]
        and n["surfaces.bound_exceeded_mm"] < n["surfaces.cell_mm"]
    )
    return holds_if(
        explained,
        f"Extents run from {number(n['surfaces.patch_smallest_mm'])} to "
        f"{number(n['surfaces.patch_largest_mm'])} mm. Cutting each unworn surface with V1's worn sphere, "
        f"without any run, gives them within {number(1e3 * n['surfaces.prediction_error_mm'], 2)} µm. The "
        f"printed {printed} mm asks for peaks of {number(n['surfaces.peak_asked_um'])} µm at both ends of a "
        f"diameter; peaks of {number(n['surfaces.peak_smallest_um'])} to "
        f"{number(n['surfaces.peak_largest_um'])} µm stand near the rim here, but seldom in line. Measured "
        "to the farthest touched cell on one side and doubled, the patch is "
        f"{number(n['surfaces.farthest_smallest_mm'])} to {number(n['surfaces.farthest_largest_mm'])} mm.",
        f"Geometry predicts the extents to {number(1e3 * n['surfaces.prediction_error_mm'], 2)} µm and the "
        f"largest is {number(1e3 * n['surfaces.bound_exceeded_mm'], 2)} µm beyond its bound.",
    )
