"""Coefficient of friction from an area: shear of junctions, with an offset for ploughing.

μ = μ_p + τ A / F (thesis eqs 4.18 to 4.20; the offset after eq 2.8). Which area A shears, and when a
measured coefficient fixes τ, are choices of the study. τ is constant, or runs in by an empirical fit:
τ0 (1 + (r − 1) e^(−L/L_τ)).
"""

import math
from collections.abc import Mapping

import numpy as np

from warpwear.grid import FloatArray
from warpwear.sections import Friction


def shear_strength(
    friction: Friction, history: Mapping[str, FloatArray], *, load: float, finished: bool
) -> FloatArray:
    """τ [MPa] of every step: as given, or from (μ0 − μ_p) F / A0 at the end or the start (eq 4.19).

    NaN while a τ that is calibrated at the end waits for it.
    """
    areas, run_in = history[f"area_{friction.area}"], _running_in(friction, history["distance"])
    if friction.shear_strength is not None:
        return friction.shear_strength * run_in
    if friction.calibrate == "end" and not finished:
        return np.full_like(areas, math.nan)
    row = -1 if friction.calibrate == "end" else 0
    measured = (friction.coefficient - friction.ploughing) * load / areas[row]
    return np.asarray(measured / run_in[row] * run_in)


def coefficient(
    friction: Friction, history: Mapping[str, FloatArray], *, load: float, finished: bool
) -> FloatArray:
    """Coefficient of friction of every step; NaN while τ waits for the end."""
    tau = shear_strength(friction, history, load=load, finished=finished)
    return np.asarray(friction.ploughing + tau * history[f"area_{friction.area}"] / load)


def _running_in(friction: Friction, distance: FloatArray) -> FloatArray:
    """τ/τ0 at sliding distances [mm]."""
    if friction.initial_ratio is None or friction.running_in is None:
        return np.ones_like(distance)
    return np.asarray(1.0 + (friction.initial_ratio - 1.0) * np.exp(-distance / friction.running_in))


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
