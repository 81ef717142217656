"""The command `warpwear calibrate thesis`: its Table 4.1, and the worn patch that does not go with it."""

import math

from warpwear.calibration.wear import cap, diameter_of_cap
from warpwear.results.report import Row, lines, record, table, to_json
from warpwear.thesis import printed as thesis

#: Diameter of the worn patch of the ball [mm].
DIAMETER = thesis.PATCH_DIAMETERS["experiment"]
#: K of the ball in Table 4.1 [mm²/N].
K_OF_BALL = 1e-3 * thesis.WEAR_COEFFICIENTS["counter"].value
#: Load times distance of the printed test [N·mm].
WORK = thesis.LOAD.value * thesis.DISTANCE.value
#: Digits to which the volumes are rounded before they are turned back into Table 4.1.
DIGITS = 4


def table_4_1() -> dict[str, list[Row]]:
    """List rows of Table 4.1: what is printed, and K of the volume that it implies, rounded to four digits.

    The text prints no volume: they are K F L, so that this checks units and arithmetic, not the measurement.
    """
    rows, stroke = {}, thesis.STROKE.value
    for name, printed in thesis.WEAR_COEFFICIENTS.items():
        volume = float(f"{1e-3 * printed.value * WORK:.{DIGITS}g}")
        again = 1e3 * volume / WORK
        rows[name] = [
            Row("of", "of", printed.note),
            Row("printed", "", _k(printed.value)),
            Row("", "printed_mm3_per_Nm", printed.value),
            Row("volume", "volume_mm3", volume, digits=DIGITS),
            Row("", "volume_from", "K F L, rounded; the text prints no volume"),
            Row("K of it", "", _k(again)),
            Row("", "wear_coefficient_mm3_per_Nm", again),
            Row(f"section over {stroke:g} mm", "section_um2", 1e6 * volume / stroke),
        ]
    return rows


def patch() -> dict[str, float]:
    """Turn the 0.80 mm of figure 4.36 and Table 4.1's K of the ball each into the other.

    K [mm³/(N·m)] of the flat cap and of a full ellipsoid (4/3) π a² h, with the rim's radius a and the cap's
    depth h; the diameter [mm] of the cap that the printed K needs.
    """
    radius, diameter = thesis.COUNTER_RADIUS.value, DIAMETER.value
    flat = cap(diameter, radius=radius)
    ellipsoid = 4.0 / 3.0 * math.pi * (0.5 * diameter) ** 2 * (flat.depth or 0.0)
    return {
        "by_cap_mm3_per_Nm": 1e3 * flat.volume / WORK,
        "by_ellipsoid_mm3_per_Nm": 1e3 * ellipsoid / WORK,
        "printed_mm3_per_Nm": 1e3 * K_OF_BALL,
        "diameter_asked_for_mm": diameter_of_cap(K_OF_BALL * WORK, radius=radius),
    }


def calibrate_thesis(*, as_json: bool = False) -> str:
    """Set Table 4.1 beside the patch that does not go with it: the text for people, or JSON."""
    groups, worn = table_4_1(), patch()
    head = [
        Row("load", "load_N", thesis.LOAD.value, digits=6),
        Row("distance", "distance_mm", thesis.DISTANCE.value, digits=6),
        Row("F L", "", 1e-3 * WORK, digits=6, unit="N·m"),
    ]
    names = {
        "by_cap_mm3_per_Nm": ("flat cap", "by π h² (3R − h)/3"),
        "by_ellipsoid_mm3_per_Nm": (
            "full ellipsoid",
            "by (4/3) π a² h, as Table 4.1's number looks",
        ),
        "printed_mm3_per_Nm": ("printed", "in Table 4.1"),
    }
    rows = [
        Row("diameter", "diameter_mm", DIAMETER.value),
        Row("printed in", "place", DIAMETER.place),
        *(Row(label, key, worn[key], 3, note, scientific=True) for key, (label, note) in names.items()),
        Row("patch asked for", "diameter_asked_for_mm", worn["diameter_asked_for_mm"], note="by the cap"),
        Row("", "agree", False),
    ]
    if as_json:
        return to_json(record([*head, Row("", "table_4_1", groups), Row("", "patch", rows)]))
    ratio = worn["printed_mm3_per_Nm"] / worn["by_cap_mm3_per_Nm"]
    text = [
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
    return "\n".join(text)


def _k(value: float) -> str:
    """Write a wear coefficient as the table prints it, in 1e-4."""
    return f"{1e4 * value:.3g}e-4"
