"""The command `warpwear calibrate thesis`: its Table 4.1, and the worn patch that does not go with it."""

import math
from dataclasses import dataclass
from typing import Any

from warpwear.calibration import options
from warpwear.calibration.wear import WearCalibration, cap, diameter_of_cap, volume_given, wear_coefficient
from warpwear.thesis import printed as thesis

#: Digits to which the volumes are rounded before they are turned back into Table 4.1.
DIGITS = 4


@dataclass(frozen=True, kw_only=True)
class Patch:
    """The printed patch of the ball against the printed K. Diameters [mm], volumes [mm³], K [mm²/N].

    by_ellipsoid: of a full ellipsoid (4/3) π a² h, with the rim's radius a and the depth h; by_mean_as_rim:
    of the cap whose rim's radius is the whole mean diagonal, the letter of eq 3.1. asked, asked_small: the
    diameter that the printed K needs, by the cap and by π d⁴/(64 R).
    """

    diameter: float
    by_cap: WearCalibration
    by_ellipsoid: WearCalibration
    by_mean_as_rim: WearCalibration
    printed: float
    asked: float
    asked_small: float


def table() -> dict[str, tuple[thesis.Printed, WearCalibration]]:
    """Rows of Table 4.1: what is printed, and K of the volume that it implies, rounded to four digits.

    The text prints no volume: they are K F L, so that this checks units and arithmetic, not the measurement.
    """
    load, distance = thesis.LOAD.value, thesis.DISTANCE.value
    found = {}
    for name, printed in thesis.WEAR_COEFFICIENTS.items():
        volume = float(f"{1e-3 * printed.value * load * distance:.{DIGITS}g}")
        found[name] = (printed, wear_coefficient([volume_given(volume)], load=load, distance=distance))
    return found


def patch() -> Patch:
    """The 0.80 mm of figure 4.36 and Table 4.1's K of the ball, each turned into the other."""
    radius, diameter = thesis.SPHERE_RADIUS.value, thesis.PATCH_DIAMETERS["experiment"].value
    load, distance = thesis.LOAD.value, thesis.DISTANCE.value
    printed = 1e-3 * thesis.WEAR_COEFFICIENTS["sphere"].value
    flat = cap(diameter, radius=radius)
    ellipsoid = volume_given(4.0 / 3.0 * math.pi * (0.5 * diameter) ** 2 * (flat.depth or 0.0))
    volume = printed * load * distance
    by_cap, by_ellipsoid, by_mean = (
        wear_coefficient([worn], load=load, distance=distance)
        for worn in (flat, ellipsoid, cap(2.0 * diameter, radius=radius))
    )
    return Patch(
        diameter=diameter,
        by_cap=by_cap,
        by_ellipsoid=by_ellipsoid,
        by_mean_as_rim=by_mean,
        printed=printed,
        asked=diameter_of_cap(volume, radius=radius),
        asked_small=(64.0 * radius * volume / math.pi) ** 0.25,
    )


def calibrate_thesis(*, as_json: bool = False) -> str:
    """The text for people, or JSON."""
    rows, worn = table(), patch()
    return options.as_json(_record(rows, worn)) if as_json else _page(rows, worn)


def _record(rows: dict[str, tuple[thesis.Printed, WearCalibration]], worn: Patch) -> dict[str, Any]:
    return {
        "load_N": thesis.LOAD.value,
        "distance_mm": thesis.DISTANCE.value,
        "table_4_1": {
            name: {
                "printed_mm3_per_Nm": printed.value,
                "of": printed.note,
                "volume_mm3": found.volumes[0].volume,
                "volume_from": "K F L, rounded; the text prints no volume",
                "wear_coefficient_mm3_per_Nm": 1e3 * found.mean,
                "section_um2": 1e6 * found.volumes[0].volume / thesis.STROKE.value,
            }
            for name, (printed, found) in rows.items()
        },
        "patch": {
            "diameter_mm": worn.diameter,
            "place": thesis.PATCH_DIAMETERS["experiment"].place,
            "by_cap_mm3_per_Nm": 1e3 * worn.by_cap.mean,
            "by_ellipsoid_mm3_per_Nm": 1e3 * worn.by_ellipsoid.mean,
            "by_mean_diagonal_as_rim_mm3_per_Nm": 1e3 * worn.by_mean_as_rim.mean,
            "printed_mm3_per_Nm": 1e3 * worn.printed,
            "diameter_asked_for_mm": worn.asked,
            "diameter_asked_for_small_scar_mm": worn.asked_small,
            "agree": False,
        },
    }


def _page(rows: dict[str, tuple[thesis.Printed, WearCalibration]], worn: Patch) -> str:
    load, distance, stroke = thesis.LOAD.value, thesis.DISTANCE.value, thesis.STROKE.value
    lines = [
        f"Table 4.1 of the thesis, K in mm³/(N·m): {load:g} N over {distance:g} mm, F L = "
        f"{1e-3 * load * distance:g} N·m",
        f"  {'':<36} {'printed':>8} {'volume, mm³':>12} {'K of it':>8}   section of a {stroke:g} mm track",
    ]
    for name, (printed, found) in rows.items():
        volume, again = found.volumes[0].volume, _k(1e3 * found.mean)
        section = "" if name == "sphere" else f"   {1e6 * volume / stroke:.1f} µm²"
        lines.append(
            f"  {printed.note:<36} {_k(printed.value):>8} {volume:>12.{DIGITS}g} {again:>8}{section}"
        )
    cap_volume = worn.by_cap.volumes[0]
    place, printed_k = thesis.PATCH_DIAMETERS["experiment"].place, 1e3 * worn.printed
    ratio = worn.printed / worn.by_cap.mean
    lines += [
        "  The text prints no volumes: these are K F L to four digits. Units and arithmetic agree; it is no",
        "  check of the measurement.",
        "",
        f"The ball's patch of {worn.diameter:.2f} mm ({place}) and Table 4.1's {_k(printed_k)} do not agree "
        f"(radius {thesis.SPHERE_RADIUS.value:g} mm):",
        f"  flat cap, π h² (3R − h)/3            K {_k(1e3 * worn.by_cap.mean)}: "
        f"{cap_volume.volume:.4g} mm³, {1e3 * (cap_volume.depth or 0.0):.3g} µm deep",
        f"  full ellipsoid, (4/3) π a² h         K {_k(1e3 * worn.by_ellipsoid.mean)}: Table 4.1's number "
        "looks like this one",
        f"  cap, a the whole mean diagonal       K {_k(1e3 * worn.by_mean_as_rim.mean)}: eq 3.1 to the "
        "letter",
        f"  Table 4.1 asks for a patch of        {worn.asked:.3f} mm by the cap, {worn.asked_small:.3f} mm "
        "by π d⁴/(64 R)",
        "  That it is the ellipsoid is an inference: the thesis prints no relation of volume to depth.",
        f"  Table 4.1's K of the ball is {ratio:.2f} times what the cap of the patch says.",
    ]
    return "\n".join(lines)


def _k(value: float) -> str:
    """A wear coefficient as the table prints them, in 1e-4."""
    return f"{1e4 * value:.3g}e-4"
