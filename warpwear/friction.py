"""Coefficient of friction from an area: shear of junctions, with an offset for ploughing.

μ = μ_p + τ0 A / F (thesis eqs 4.18 to 4.20; the offset after eq 2.8). Which area A shears, and when a
measured coefficient fixes τ0, are choices of the study.
"""

import math
from collections.abc import Mapping

from warpwear.grid import FloatArray
from warpwear.sections import Friction


def shear_strength(
    friction: Friction, areas: FloatArray, *, load: float, area_end: float | None = None
) -> float:
    """τ0 [MPa]: as given, or (μ0 − μ_p) F / A0 with the area of the end or of the start (eq 4.19).

    areas: history of the area that shears [mm²]. area_end: its value at the end, None while the run is under
    way; then a τ0 that is calibrated at the end is not known: NaN.
    """
    if friction.shear_strength is not None:
        return friction.shear_strength
    if friction.calibrate == "initial":
        area = float(areas[0])
    elif area_end is not None:
        area = area_end
    else:
        return math.nan
    return (friction.coefficient - friction.ploughing) * load / area


def coefficient(
    friction: Friction, history: Mapping[str, FloatArray], *, load: float, finished: bool
) -> FloatArray:
    """Coefficient of friction of every step; NaN while τ0 waits for the end."""
    areas = history[f"area_{friction.area}"]
    tau = shear_strength(friction, areas, load=load, area_end=float(areas[-1]) if finished else None)
    return friction.ploughing + tau * areas / load


def calibrations(
    friction: Friction, history: Mapping[str, FloatArray], *, load: float, hardness: float
) -> dict[str, float]:
    """τ0 [MPa] that each area would ask for at `friction.coefficient`, at the start and at the end.

    What "the" shear strength is depends on the area that it was calibrated with; H/(3√3) is the usual
    estimate from hardness.
    """
    found: dict[str, float] = {}
    if friction.coefficient <= friction.ploughing:  # nothing is left to shear
        return found
    for name in ("contact", "touched", "cumulative", "nominal"):
        areas = history[f"area_{name}"]
        for when, area in (("initial", areas[0]), ("end", areas[-1])):
            found[f"{name}_{when}"] = (friction.coefficient - friction.ploughing) * load / float(area)
    if math.isfinite(hardness):
        found["hardness"] = hardness / (3.0 * math.sqrt(3.0))
    return found
