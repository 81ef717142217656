"""The command `warpwear calibrate energy`: from its options to the text it prints."""

from pathlib import Path
from typing import Any

from warpwear import calibrate_options as options
from warpwear import thesis
from warpwear.energy import Dissipation, dissipation, friction_work
from warpwear.errors import InputError

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
    as_json: bool = False,
) -> str:
    """The text for people, or JSON. Raises InputError."""
    texts = speed or tuple(f"{s.value:g} {s.unit}" for s in thesis.SPEEDS)
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
    import numpy as np

    from warpwear.results import Result

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
