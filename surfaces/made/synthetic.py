"""What surfaces from formulae have in common: their parameters and notices; and the flat one."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray, spacing

LARGEST_MODE = 2048  # 17 million amplitudes; beyond, the spectrum no longer fits a small machine
POINTS_PER_CUT_OFF = 4  # of the reference grid on which Ra is defined
SLACK = 1e-9  # relative, so that 2.0/0.008 counts as 250 and a window of one period does not repeat


@dataclass(frozen=True, kw_only=True)
class Flat:
    """The plane z = 0."""

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Zeros [mm], shape (x.size, y.size)."""
        return np.zeros((x.size, y.size))

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """None."""
        return []

    def record(self) -> dict[str, Any]:
        """Kind, and the parameters every synthetic surface has."""
        return {"kind": "flat", "ra_um": 0.0, "sq_um": 0.0, "rms_slope": 0.0}


def check(name: str, value: float, allowed: bool, expected: str, *, unit: str = "mm") -> None:
    """Raises InputError, naming ``disc.synthetic.NAME``, for a value that is not allowed."""
    if not (math.isfinite(value) and allowed):
        shown = f"{value:g} {unit}".rstrip()
        raise InputError(f"disc.synthetic.{name} is {shown}: allowed is {expected}")


def check_roughness(ra: float | None, sq: float | None) -> None:
    """Raises InputError unless exactly one of Ra and Sq [mm] is given, and is positive."""
    if (ra is None) == (sq is None):
        given = "neither is given" if ra is None else f"both are given ({ra:g} mm and {sq:g} mm)"
        raise InputError(
            f"disc.synthetic.ra and disc.synthetic.sq: {given}, "
            "allowed is exactly one of the two, a positive length"
        )
    for name, value in (("ra", ra), ("sq", sq)):
        if value is not None:
            check(name, value, value > 0.0, "a positive length")


def check_spectrum(hurst: float, roll_off: float, cut_off: float, seed: int, period: float) -> None:
    """Raises InputError for a spectrum that cannot be: lengths in mm."""
    check("hurst", hurst, 0.0 < hurst <= 1.0, "more than 0 and at most 1", unit="")
    check("cut_off", cut_off, cut_off > 0.0, "a positive length")
    check("period", period, period > 0.0, "a positive length")
    check(
        "roll_off",
        roll_off,
        cut_off < roll_off < period,
        f"more than cut_off ({cut_off:g} mm) and less than period ({period:g} mm)",
    )
    check(
        "cut_off",
        cut_off,
        period / cut_off <= LARGEST_MODE * (1 + SLACK),
        f"at least period/{LARGEST_MODE} ({period / LARGEST_MODE:g} mm)",
    )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"disc.synthetic.seed is {seed!r}: allowed is a whole number from 0")


def points_along(side: float, count: int) -> FloatArray:
    """So many points of a side [mm], the first at 0, its end left out."""
    points = np.arange(count).astype(np.float64)
    points *= side / count
    return points


def asked(ra: float | None, sq: float | None) -> dict[str, float]:
    """The roughness that was asked for [µm], for the record."""
    return {name: value * 1e3 for name, value in (("ra_um", ra), ("sq_um", sq)) if value is not None}


def repeats(period: float, x: FloatArray, y: FloatArray) -> list[str]:
    """A notice where the grid is wider than the period [mm]."""
    widest = max(float(p[-1] - p[0]) + spacing(p) for p in (x, y))
    if widest <= period * (1 + SLACK):
        return []
    return [f"the random surface repeats: its period {period:g} mm is shorter than the grid, {widest:g} mm"]


def unresolved(cut_off: float, x: FloatArray, y: FloatArray) -> list[str]:
    """A notice where the grid is too coarse for the shortest waves [mm]."""
    coarsest = max(spacing(x), spacing(y))
    if coarsest <= cut_off / 2 * (1 + SLACK):
        return []
    return [
        f"cells of {coarsest * 1e3:.4g} µm do not resolve the shortest waves of the surface, "
        f"{cut_off * 1e3:.4g} µm: that takes cells of at most {cut_off * 500:.4g} µm"
    ]
