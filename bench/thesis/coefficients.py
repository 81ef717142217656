"""Table 4.1 of the thesis, and the worn patch that does not go with it: as numbers and as text."""

import math
from typing import Any

import printed as thesis

#: Diameter of the worn patch of the ball [mm].
DIAMETER = thesis.PATCH_DIAMETERS["experiment"]
#: K of the ball in Table 4.1 [mm²/N].
K_OF_BALL = 1e-3 * thesis.WEAR_COEFFICIENTS["counter"].value
#: Load times distance of the printed test [N·mm].
WORK = thesis.LOAD.value * thesis.DISTANCE.value
#: Digits to which the volumes are rounded before they are turned back into Table 4.1.
DIGITS = 4


def depth_of_rim(rim: float, *, radius: float) -> float:
    """Find the height of a cap from its rim's radius, R − √(R² − a²) [mm], without its cancellation."""
    return rim * rim / (radius + math.sqrt(radius * radius - rim * rim))


def rim_at(depth: float, *, radius: float) -> float:
    """Find the rim's radius of a cap of a height, √(z(2R − z)) [mm]: the inverse of `depth_of_rim`."""
    return math.sqrt(depth * (2.0 * radius - depth))


def volume_of_cap(diameter: float, *, radius: float) -> float:
    """Find the volume π h² (3R − h)/3 [mm³] of the cap with a rim of a diameter [mm], on a ball."""
    depth = depth_of_rim(0.5 * diameter, radius=radius)
    return math.pi * depth**2 * (3.0 * radius - depth) / 3.0


def diameter_of_cap(volume: float, *, radius: float) -> float:
    """Find the diameter [mm] of the rim of the cap of a volume [mm³], by Newton: the inverse."""
    depth = math.sqrt(volume / (math.pi * radius))
    for _ in range(50):
        excess = math.pi * depth**2 * (3.0 * radius - depth) / 3.0 - volume
        depth -= excess / (math.pi * depth * (2.0 * radius - depth))
    return 2.0 * rim_at(depth, radius=radius)


def table_4_1() -> dict[str, dict[str, Any]]:
    """List rows of Table 4.1: what is printed, and K of the volume that it implies, rounded to four digits.

    The text prints no volume: they are K F L, so that this checks units and arithmetic, not the measurement.
    """
    rows = {}
    for name, printed in thesis.WEAR_COEFFICIENTS.items():
        volume = float(f"{1e-3 * printed.value * WORK:.{DIGITS}g}")
        rows[name] = {
            "of": printed.note,
            "printed_mm3_per_Nm": printed.value,
            "volume_mm3": volume,
            "volume_from": "K F L, rounded; the text prints no volume",
            "wear_coefficient_mm3_per_Nm": 1e3 * volume / WORK,
            "section_um2": 1e6 * volume / thesis.STROKE.value,
        }
    return rows


def patch() -> dict[str, float]:
    """Turn the 0.80 mm of figure 4.36 and Table 4.1's K of the ball each into the other.

    K [mm³/(N·m)] of the flat cap and of a full ellipsoid (4/3) π a² h, with the rim's radius a and the cap's
    depth h; the diameter [mm] of the cap that the printed K needs.
    """
    radius, diameter = thesis.COUNTER_RADIUS.value, DIAMETER.value
    depth = depth_of_rim(0.5 * diameter, radius=radius)
    return {
        "by_cap_mm3_per_Nm": 1e3 * volume_of_cap(diameter, radius=radius) / WORK,
        "by_ellipsoid_mm3_per_Nm": 1e3 * 4.0 / 3.0 * math.pi * (0.5 * diameter) ** 2 * depth / WORK,
        "printed_mm3_per_Nm": 1e3 * K_OF_BALL,
        "diameter_asked_for_mm": diameter_of_cap(K_OF_BALL * WORK, radius=radius),
    }


def record() -> dict[str, Any]:
    """Collect what `text` says, as names and values."""
    return {
        "load_N": thesis.LOAD.value,
        "distance_mm": thesis.DISTANCE.value,
        "table_4_1": table_4_1(),
        "patch": {"diameter_mm": DIAMETER.value, "place": DIAMETER.place, **patch(), "agree": False},
    }


def text() -> str:
    """Set Table 4.1 beside the patch that does not go with it, for people."""
    stroke, worn = thesis.STROKE.value, patch()
    head = ("of", "printed", "volume, mm³", "K of it", f"section over {stroke:g} mm, µm²")
    cells = [
        (
            row["of"],
            _k(row["printed_mm3_per_Nm"]),
            f"{row['volume_mm3']:.{DIGITS}g}",
            _k(row["wear_coefficient_mm3_per_Nm"]),
            f"{row['section_um2']:.4g}",
        )
        for row in table_4_1().values()
    ]
    first, *widths = (max(map(len, column)) for column in zip(head, *cells, strict=True))
    table = [
        "  ".join([f"  {name:<{first}}", *(f"{cell:>{w}}" for cell, w in zip(row, widths, strict=True))])
        for name, *row in (head, *cells)
    ]
    by_cap, ratio = worn["by_cap_mm3_per_Nm"], worn["printed_mm3_per_Nm"] / worn["by_cap_mm3_per_Nm"]
    return "\n".join(
        [
            "Table 4.1 of the thesis, K in mm³/(N·m)",
            f"  load             {thesis.LOAD.value:g} N",
            f"  distance         {thesis.DISTANCE.value:g} mm",
            f"  F L              {1e-3 * WORK:g} N·m",
            *table,
            "  The text prints no volumes: these are K F L to four digits. Units and arithmetic agree; it",
            "  is no check of the measurement.",
            "",
            f"The ball's patch of {DIAMETER.value:.2f} mm and Table 4.1's {_k(1e3 * K_OF_BALL)} do not agree "
            f"(radius {thesis.COUNTER_RADIUS.value:g} mm):",
            f"  diameter         {DIAMETER.value:g} mm",
            f"  printed in       {DIAMETER.place}",
            f"  flat cap         {_k(by_cap, 2)} mm³/(N·m) by π h² (3R − h)/3",
            f"  full ellipsoid   {_k(worn['by_ellipsoid_mm3_per_Nm'], 2)} mm³/(N·m) by (4/3) π a² h, as "
            "Table 4.1's number looks",
            f"  printed          {_k(worn['printed_mm3_per_Nm'], 2)} mm³/(N·m) in Table 4.1",
            f"  patch asked for  {worn['diameter_asked_for_mm']:.4g} mm by the cap",
            "  That it is the ellipsoid is an inference: the thesis prints no relation of volume to depth.",
            f"  Table 4.1's K of the ball is {ratio:.2f} times what the cap of the patch says.",
        ]
    )


def _k(value: float, decimals: int | None = None) -> str:
    """Write a wear coefficient as the table prints it, in 1e-4. decimals: by default three digits."""
    return f"{1e4 * value:.3g}e-4" if decimals is None else f"{1e4 * value:.{decimals}f}e-4"
