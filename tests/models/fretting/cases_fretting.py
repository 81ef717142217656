"""Fretting of a steel ball of 5 mm on a steel disc under 20 N, and what closed forms say of it."""

import math
from typing import Any

import numpy as np

from warpwear import Study
from warpwear.grid import FloatArray

#: R [mm], P [N], μ, E [MPa], ν; alike bodies.
RADIUS, LOAD, FRICTION, YOUNG, POISSON = 5.0, 20.0, 0.6, 2.1e5, 0.3
MODULUS = YOUNG / (1.0 - POISSON**2) / 2.0  # E* [MPa]
SOFTNESS = 2.0 * (2.0 - POISSON) * 2.0 * (1.0 + POISSON) / YOUNG  # C = Σ (2 − ν)/G [1/MPa]
HERTZ = (0.75 * LOAD * RADIUS / MODULUS) ** (1.0 / 3.0)  # a [mm]
PEAK = 1.5 * LOAD / (math.pi * HERTZ**2)  # p0 [MPa]
#: Displacement amplitude from which on all of the contact slips (Mindlin) [mm].
BORDER = 3.0 * FRICTION * LOAD * SOFTNESS / (16.0 * HERTZ)


def study_of(**changes: Any) -> Study:
    """That study, of a stroke of 50 µm over cells of 5 µm; changes: section__key = value."""
    keys: dict[str, dict[str, Any]] = {
        "study": {"name": "fretting"},
        "counter": {"radius": "5 mm", "young": "210 GPa", "poisson": POISSON},
        "disc": {"young": "210 GPa", "poisson": POISSON, "synthetic": {"kind": "flat"}},
        "contact": {"load": "20 N", "law": "half-space", "hardness": "inf MPa"},
        "wear": {"counter": "1e-6 mm^3/N/m", "disc": "1e-6 mm^3/N/m"},
        "friction": {"law": "coulomb", "coefficient": FRICTION},
        "grid": {"cell": "5 um", "extent": "0.64 mm"},
        "sliding": {"kinematics": "fretting", "stroke": "50 um", "cycles": 100_000},
        "output": {"snapshots": []},
    }
    for name, value in changes.items():
        section, _, key = name.partition("__")
        keys.setdefault(section, {})[key] = value
        if value is None:
            del keys[section][key]
    return Study(**keys)


def sheared(cells: int, *, over: float = 2.6, **changes: Any) -> Study:
    """Those bodies under a force of 0.6 μP, unless changed, on so many cells over `over` Hertz radii."""
    cell = 1e3 * over * HERTZ / cells
    grid = {"grid__cell": f"{cell!r} um", "grid__extent": f"{cells * cell!r} um"}
    drive: dict[str, Any] = {"sliding__stroke": None, "sliding__kinematics": None}
    if "sliding__stroke" not in changes:
        drive["sliding__force"] = "7.2 N"
    return study_of(**(grid | drive | changes))


def energy_of_cycle(ratio: float) -> float:
    """Return what a cycle of partial slip dissipates under Q = ratio μP [mJ] (Mindlin and Deresiewicz)."""
    rest = 1.0 - ratio
    bracket = 1.0 - rest ** (5 / 3) - 5.0 * ratio / 6.0 * (1.0 + rest ** (2 / 3))
    return 0.9 * FRICTION**2 * LOAD**2 * SOFTNESS / HERTZ * bracket


def mean_along(cells: int, window: int) -> FloatArray:
    """Return the matrix of a mean along x over a window; of an even one the ends count half."""
    distance = np.abs(np.subtract.outer(np.arange(cells), np.arange(cells)))
    weights = np.where(2 * distance < window, 1.0, np.where(2 * distance == window, 0.5, 0.0))
    return np.asarray(weights / window)
