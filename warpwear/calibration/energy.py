"""Dissipated energy ∫ μ F dL, frictional power and PV at one or several sliding speeds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.calibration import options
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.result import Result


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


RATE = (
    "the model is rate-independent: the energy is the same at every speed; only time, power and PV change "
    "with it"
)


def calibrate_energy(
    *,
    result: Path | None = None,
    load: str | None = None,
    distance: str | None = None,
    cof: float | None = None,
    area: str | None = None,
    speed: tuple[str, ...] = (),
    usual_speeds: Sequence[Any] = (),
    as_json: bool = False,
) -> str:
    """The text for people, or JSON. Raises InputError.

    usual_speeds: each with a value and a unit, where no speed is given.
    """
    texts = speed or tuple(f"{s.value:g} {s.unit}" for s in usual_speeds)
    speeds = [options.quantity("--speed", text, "mm/s") for text in texts]
    if result is not None:
        for name, value in (("--load", load), ("--distance", distance), ("--cof", cof), ("--area", area)):
            if value is not None:
                raise InputError(f"{name} and --result exclude each other: the run has its own")
        found, source = _of_run(result, speeds)
    else:
        force = options.load_of(load)
        slid = options.distance_of(distance, None, None)
        if cof is None:
            raise InputError("--cof is missing: the coefficient of friction, such as 0.6, or --result")
        mu = options.number("--cof", cof, options.COF)
        size = options.optional("--area", area, "mm^2")
        found = dissipation(
            energy=1e-3 * mu * force * slid,
            distance=slid,
            load=force,
            cof_end=mu,
            pressures={} if size is None else {"given": force / size},
            speeds=speeds,
        )
        source = f"a constant coefficient of {mu:g}"
    return options.as_json(_record(found, source)) if as_json else _page(found, source)


def _of_run(folder: Path, speeds: list[float]) -> tuple[Dissipation, str]:

    with Result.open(folder) as result:
        history, finished = result.history, result.finished
    slid, cof = float(history["distance"][-1]), history["cof"]
    if slid == 0.0:
        raise InputError(f"{folder} is a static contact: nothing slides, and no energy is dissipated")
    if not np.isfinite(cof).all():
        raise InputError(
            f"{folder} has no coefficient of friction: it was interrupted before its τ0 was fixed"
        )
    load = float(history["load"][-1])
    found = dissipation(
        energy=friction_work(history["distance"], cof * history["load"]),
        distance=slid,
        load=load,
        cof_end=float(cof[-1]),
        pressures={
            "nominal": load / float(history["area_nominal"][-1]),
            "contact": load / float(history["area_contact"][-1]),
        },
        speeds=speeds,
    )
    return found, f"the run {folder}, {'whole' if finished else 'interrupted'}"


def _record(found: Dissipation, source: str) -> dict[str, Any]:
    return {
        "source": source,
        "energy_J": found.energy,
        "distance_mm": found.distance,
        "load_N": found.load,
        "cof_mean": found.cof,
        "cof_end": found.cof_end,
        "pressure_MPa": found.pressures,
        "rate_independent": True,
        "speeds": [
            {
                "speed_mm_per_min": 60.0 * row.speed,
                "time_s": row.time,
                "power_mean_W": row.power,
                "power_end_W": row.power_end,
                "pv_MPa_m_per_s": row.pv,
            }
            for row in found.speeds
        ],
    }


def _page(found: Dissipation, source: str) -> str:
    names = {"nominal": "PV nominal", "contact": "PV in contact", "given": "PV"}
    lines = [
        f"dissipated energy ∫ μ F dL = {found.energy:.5g} J: {found.load:g} N over {found.distance:g} mm, "
        f"{source}",
        f"  coefficient      {found.cof:.4g} mean over the distance, {found.cof_end:.4g} at the end",
    ]
    if found.pressures:
        words = {"nominal": " nominal", "contact": " in contact", "given": ""}
        shown = ", ".join(f"{value:.4g} MPa{words[name]}" for name, value in found.pressures.items())
        lines.append(f"  mean pressure    {shown}, at the end")
    else:
        lines.append("  mean pressure    not known: --area gives PV too")
    head = f"  {'speed':>14} {'time':>11} {'mean power':>13} {'power at end':>14}"
    lines.append(head + "".join(f" {names[name]:>16}" for name in found.pressures))
    units = f"  {'mm/min':>14} {'min':>11} {'W':>13} {'W':>14}"
    lines.append(units + "".join(f" {'MPa·m/s':>16}" for _ in found.pressures))
    for row in found.speeds:
        lines.append(
            f"  {60.0 * row.speed:>14.5g} {row.time / 60.0:>11.5g} {row.power:>13.4g} {row.power_end:>14.4g}"
            + "".join(f" {value:>16.4g}" for value in row.pv.values())
        )
    return "\n".join([*lines, f"  {RATE}"])
