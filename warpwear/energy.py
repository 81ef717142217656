"""Dissipated energy ∫ μ F dL, frictional power and PV at one or several sliding speeds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray


@dataclass(frozen=True, kw_only=True)
class AtSpeed:
    """One sliding speed [mm/s]: time [s], mean and final frictional power [W], PV [MPa·m/s] by pressure."""

    speed: float
    time: float
    power: float
    power_end: float
    pv: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class Dissipation:
    """energy [J] over a distance [mm] under a load [N]; cof: mean over the distance, and at the end.

    pressures: name -> MPa, at the end. speeds: what depends on the speed; the energy does not.
    """

    energy: float
    distance: float
    load: float
    cof: float
    cof_end: float
    pressures: dict[str, float]
    speeds: tuple[AtSpeed, ...]


def friction_work(distance: FloatArray, force: FloatArray) -> float:
    """∫ friction force dL [J] of a run's rows: distance [mm] at the end of each step, force [N] in it, (n,).

    Trapezoids between the ends of the steps; before the end of the first there is no other row, so its force
    holds from the start. N·mm = 1e-3 J.
    """
    between = 0.5 * (force[1:] + force[:-1]) * np.diff(distance)
    return 1e-3 * (float(force[0] * distance[0]) + float(between.sum()))


def dissipation(
    *,
    energy: float,
    distance: float,
    load: float,
    cof_end: float,
    pressures: dict[str, float],
    speeds: Sequence[float],
) -> Dissipation:
    """What an energy [J] over a distance [mm] means at several speeds [mm/s]. Raises InputError."""
    for name, value, unit in (("distance", distance, "mm"), ("load", load, "N"), ("energy", energy, "J")):
        if not 0.0 < value < math.inf:
            raise InputError(f"{name} is {value:g} {unit}: allowed is any positive number")
    for speed in speeds:
        if not 0.0 < speed < math.inf:
            raise InputError(f"speed is {speed:g} mm/s: allowed is any positive number")
    return Dissipation(
        energy=energy,
        distance=distance,
        load=load,
        cof=1e3 * energy / (load * distance),
        cof_end=cof_end,
        pressures=dict(pressures),
        speeds=tuple(
            AtSpeed(
                speed=speed,
                time=distance / speed,
                power=energy * speed / distance,
                power_end=1e-3 * cof_end * load * speed,
                pv={name: 1e-3 * pressure * speed for name, pressure in pressures.items()},
            )
            for speed in speeds
        ),
    )
