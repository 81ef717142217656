"""The command `warpwear calibrate thesis`: its Table 4.1, and the worn patch that does not go with it."""

import math
from dataclasses import dataclass

from warpwear.calibration import wear as volumes
from warpwear.results.report import Row, lines, record, table, to_json
from warpwear.thesis import printed as thesis
from warpwear.thesis.printed import Printed

#: Diameter of the worn patch of the ball [mm].
DIAMETER = thesis.PATCH_DIAMETERS["experiment"]
#: K of the ball in Table 4.1 [mm²/N].
K_OF_BALL = 1e-3 * thesis.WEAR_COEFFICIENTS["counter"].value
#: Digits to which the volumes are rounded before they are turned back into Table 4.1.
DIGITS = 4
ELLIPSOID = "by (4/3) π a² h: Table 4.1's number looks like this one"
WIDE_CAP = "with the whole mean diagonal for a: eq 3.1 to the letter"


@dataclass(frozen=True, kw_only=True)
class Patch:
    """The printed patch of the ball is set against the printed K. Diameters [mm], volumes [mm³], K [mm²/N].

    by_ellipsoid: of a full ellipsoid (4/3) π a² h, with the rim's radius a and the depth h; by_mean_as_rim:
    of the cap whose rim's radius is the whole mean diagonal, the letter of eq 3.1. needed, needed_small: the
    diameter that the printed K needs, by the cap and by π d⁴/(64 R).
    """

    by_cap: volumes.WearCalibration
    by_ellipsoid: volumes.WearCalibration
    by_mean_as_rim: volumes.WearCalibration
    needed: float
    needed_small: float


def _of_test(worn: volumes.WornVolume) -> volumes.WearCalibration:
    """Find K of a worn volume after the printed test."""
    return volumes.WearCalibration(volumes=(worn,), load=thesis.LOAD.value, distance=thesis.DISTANCE.value)


def table_4_1() -> dict[str, tuple[Printed, volumes.WearCalibration]]:
    """List rows of Table 4.1: what is printed, and K of the volume that it implies, rounded to four digits.

    The text prints no volume: they are K F L, so that this checks units and arithmetic, not the measurement.
    """
    rows = {}
    for name, printed in thesis.WEAR_COEFFICIENTS.items():
        volume = 1e-3 * printed.value * thesis.LOAD.value * thesis.DISTANCE.value
        rows[name] = (printed, _of_test(volumes.volume_given(float(f"{volume:.{DIGITS}g}"))))
    return rows


def patch() -> Patch:
    """Turn the 0.80 mm of figure 4.36 and Table 4.1's K of the ball each into the other."""
    radius, diameter = thesis.COUNTER_RADIUS.value, DIAMETER.value
    volume = K_OF_BALL * thesis.LOAD.value * thesis.DISTANCE.value
    flat = volumes.cap(diameter, radius=radius)
    ellipsoid = volumes.volume_given(4.0 / 3.0 * math.pi * (0.5 * diameter) ** 2 * (flat.depth or 0.0))
    return Patch(
        by_cap=_of_test(flat),
        by_ellipsoid=_of_test(ellipsoid),
        by_mean_as_rim=_of_test(volumes.cap(2.0 * diameter, radius=radius)),
        needed=volumes.diameter_of_cap(volume, radius=radius),
        needed_small=(64.0 * radius * volume / math.pi) ** 0.25,
    )


def calibrate_thesis(*, as_json: bool = False) -> str:
    """Set Table 4.1 beside the patch that does not go with it: the text for people, or JSON."""
    load, distance = thesis.LOAD.value, thesis.DISTANCE.value
    groups = {name: _row_of_table(*row) for name, row in table_4_1().items()}
    head = [
        Row("load", "load_N", load, digits=6),
        Row("distance", "distance_mm", distance, digits=6),
        Row("F L", "", 1e-3 * load * distance, digits=6, unit="N·m"),
    ]
    worn = patch()
    rows = _patch_rows(worn)
    if as_json:
        return to_json(record([*head, Row("", "table_4_1", groups), Row("", "patch", rows)]))
    ratio = K_OF_BALL / worn.by_cap.mean
    return "\n".join(
        [
            "Table 4.1 of the thesis, K in mm³/(N·m)",
            *lines(head),
            *table(list(groups.values())),
            "  The text prints no volumes: these are K F L to four digits. Units and arithmetic agree; it",
            "  is no check of the measurement.",
            "",
            f"The ball's patch of {DIAMETER.value:.2f} mm and Table 4.1's {_k(1e3 * K_OF_BALL)} do not "
            f"agree (radius {thesis.COUNTER_RADIUS.value:g} mm):",
            *lines(rows),
            "  That it is the ellipsoid is an inference: the thesis prints no relation of volume to depth.",
            f"  Table 4.1's K of the ball is {ratio:.2f} times what the cap of the patch says.",
        ]
    )


def _row_of_table(printed: Printed, calibration: volumes.WearCalibration) -> list[Row]:
    """Declare a row of Table 4.1. calibration: of the volume that it implies."""
    volume, again = calibration.volumes[0].volume, 1e3 * calibration.mean
    section = 1e6 * volume / thesis.STROKE.value
    return [
        Row("of", "of", printed.note),
        Row("printed", "", _k(printed.value)),
        Row("", "printed_mm3_per_Nm", printed.value),
        Row("volume", "volume_mm3", volume, digits=DIGITS),
        Row("", "volume_from", "K F L, rounded; the text prints no volume"),
        Row("K of it", "", _k(again)),
        Row("", "wear_coefficient_mm3_per_Nm", again),
        Row(f"section over {thesis.STROKE.value:g} mm", "section_um2", section),
    ]


def _patch_rows(worn: Patch) -> list[Row]:
    """Declare what the printed patch and the printed K of the ball say of each other."""
    flat = worn.by_cap.volumes[0]
    cap_told = f"by π h² (3R − h)/3: {flat.volume:.4g} mm³, {1e3 * (flat.depth or 0.0):.3g} µm deep"
    by_both = f"by the cap, {worn.needed_small:.3f} mm by π d⁴/(64 R)"
    return [
        Row("diameter", "diameter_mm", DIAMETER.value),
        Row("printed in", "place", DIAMETER.place),
        _coefficient("flat cap", "by_cap", worn.by_cap.mean, cap_told),
        _coefficient("full ellipsoid", "by_ellipsoid", worn.by_ellipsoid.mean, ELLIPSOID),
        _coefficient("wide cap", "by_mean_diagonal_as_rim", worn.by_mean_as_rim.mean, WIDE_CAP),
        _coefficient("printed", "printed", K_OF_BALL, "in Table 4.1"),
        Row("patch asked for", "diameter_asked_for_mm", worn.needed, note=by_both),
        Row("", "diameter_asked_for_small_scar_mm", worn.needed_small),
        Row("", "agree", False),
    ]


def _coefficient(label: str, key: str, value: float, note: str) -> Row:
    """Declare a wear coefficient. value [mm²/N]."""
    return Row(label, f"{key}_mm3_per_Nm", 1e3 * value, digits=3, note=note, scientific=True)


def _k(value: float) -> str:
    """Write a wear coefficient as the table prints it, in 1e-4."""
    return f"{1e4 * value:.3g}e-4"
