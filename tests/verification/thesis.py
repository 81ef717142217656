"""The reference test of the thesis, its closed forms, and studies of a smooth ball on a smooth disc."""

import math
from typing import Any

import numpy as np

from warpwear import Study

R = 3.0  # [mm]
F = 8.0  # [N]
H = 590.0  # [MPa]
K_COUNTER = 9.4e-7  # [mm²/N]
K_DISC = 12.7e-7
K = K_COUNTER + K_DISC
L = 2400.0  # [mm]


def patch_radius(coefficient: float, distance: float) -> float:
    """a = (4 R K F L/π)^¼ [mm]: the volume K F L as a cap of a paraboloid, π a⁴/4R."""
    return (4.0 * R * coefficient * F * distance / math.pi) ** 0.25


def cap(volume: float) -> tuple[float, float]:
    """Height h and base radius a [mm] of a cap of the counter-body, V = πh²(3R − h)/3, a² = 2Rh − h²."""
    h = math.sqrt(volume / (math.pi * R))
    for _ in range(50):
        h = math.sqrt(volume / (math.pi * (R - h / 3.0)))
    return h, math.sqrt(2.0 * R * h - h * h)


def smooth(**changes: Any) -> Study:
    """A smooth ball on a smooth disc, rigid but for wear: implicit, no cap, 10 µm cells."""
    study = Study(
        counter={"radius": f"{R} mm"},
        disc={"synthetic": {"kind": "flat"}},
        contact={"load": f"{F} N", "hardness": "inf MPa"},
        wear={"counter": "9.4e-4 mm^3/N/m", "disc": "12.7e-4 mm^3/N/m"},
        grid={"cell": "10 um", "extent": "1.5 mm"},
        sliding={"distance": f"{L} mm"},
        stepping={"scheme": "implicit", "first": "3 um", "growth": 1.02, "largest": "3 mm"},
    )
    return study.replace({name.replace("__", "."): value for name, value in changes.items()})


def observed_order(sizes: list[float], errors: list[float]) -> float:
    """Least-squares slope of log(error) against log(size)."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
