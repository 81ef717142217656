"""The command `warpwear calibrate friction`: from its options to the text it prints."""

import math
from pathlib import Path
from typing import Any

from warpwear.calibration import options
from warpwear.calibration.friction import FrictionFit, ShearFit, fit_friction
from warpwear.errors import InputError
from warpwear.measured.course import read_experiment
from warpwear.result import Result
from warpwear.results import friction
from warpwear.study.contact import Friction

AREAS = ("contact", "touched", "cumulative", "nominal")
WORDS = {
    "contact": "in contact",
    "touched": "ever touched",
    "cumulative": "running sum",
    "nominal": "nominal (the scar as an ellipse)",
}


def calibrate_friction(
    *,
    result: Path | None = None,
    cof: float | None = None,
    ploughing: float | None = None,
    area: str | None = None,
    load: str | None = None,
    experiment: Path | None = None,
    columns: str | None = None,
    stroke: str | None = None,
    speed: str | None = None,
    as_json: bool = False,
) -> str:
    """The text for people, or JSON: τ0 of a measured coefficient, or the fit of a curve. Raises InputError.

    area: a quantity with `load`, or the name of a run's area.
    """
    if result is not None and load is not None:
        raise InputError("--load and --result exclude each other: the run has its load")
    if experiment is not None:
        if result is None:
            raise InputError("--experiment needs --result, the run folder whose areas it is fitted with")
        for name, value in (("--cof", cof), ("--ploughing", ploughing)):
            if value is not None:
                raise InputError(f"{name} and --experiment exclude each other: the fit finds it")
        reading = {
            "columns": columns,
            "stroke": options.optional("--stroke", stroke, "mm"),
            "speed": options.optional("--speed", speed, "mm/s"),
        }
        record, text = _of_curve(experiment, result, _name(area or "contact"), reading)
    else:
        for option, given in (("--columns", columns), ("--stroke", stroke), ("--speed", speed)):
            if given is not None:
                raise InputError(f"{option} needs --experiment: it says how that file is read")
        if cof is None:
            raise InputError("--cof is missing: a measured coefficient of friction, or --experiment")
        measured = options.number("--cof", cof, options.COF)
        offset = options.number("--ploughing", ploughing or 0.0, options.PLOUGHING)
        if measured <= offset:
            raise InputError(f"--cof = {measured:g} must exceed --ploughing = {offset:g}")
        if result is not None:
            record, text = _of_run(result, measured, offset, None if area is None else _name(area))
        elif area is not None and load is not None:
            record, text = _of_area(area, load, measured, offset)
        else:
            raise InputError("the area is missing: --result, or --area and --load such as '1.254 mm^2' '8 N'")
    return options.as_json(record) if as_json else text


def _name(area: str) -> str:
    if area not in AREAS:
        raise InputError(f"--area is {area!r}: allowed with --result is one of {', '.join(AREAS)}")
    return area


def _of_area(area: str, load: str, cof: float, ploughing: float) -> tuple[dict[str, Any], str]:
    size, force = options.quantity("--area", area, "mm^2"), options.quantity("--load", load, "N")
    tau = (cof - ploughing) * force / size
    if not 0.0 < tau < math.inf:
        raise InputError(f"--area {area} and --load {load} make no finite shear strength")
    record = {
        "cof": cof,
        "ploughing": ploughing,
        "load_N": force,
        "area_mm2": size,
        "shear_strength_MPa": tau,
    }
    text = (
        f"shear strength τ0 = (μ0 − μ_p) F/A = {tau:.4g} MPa (thesis eq 4.19)\n"
        f"  μ0 {cof:g}, μ_p {ploughing:g}, F {force:g} N, A {size:g} mm²\n"
        f'  in a study       [friction] shear_strength = "{tau:.4g} MPa"'
    )
    return record, text


def _of_run(folder: Path, cof: float, ploughing: float, area: str | None) -> tuple[dict[str, Any], str]:
    with Result.open(folder) as result:
        load, history, finished = result.study.contact.load, result.history, result.finished
        taus = friction.calibrations(
            Friction(coefficient=cof, ploughing=ploughing),
            history,
            load=load,
            hardness=result.study.hardness,
            lap=result.study.lap,
        )
        slid = float(history["distance"][-1])
        sizes = {
            name: [
                friction.mean_over(history, history[f"area_{name}"], when, result.study.lap)
                for when in friction.WHEN
            ]
            for name in AREAS
        }
    names = AREAS if area is None else (area,)
    record = {
        "result": str(folder),
        "finished": finished,
        "distance_mm": slid,
        "load_N": load,
        "cof": cof,
        "ploughing": ploughing,
        "areas": {
            name: {
                "area_initial_mm2": sizes[name][0],
                "area_end_mm2": sizes[name][1],
                "shear_strength_initial_MPa": taus[f"{name}_initial"],
                "shear_strength_end_MPa": taus[f"{name}_end"],
            }
            for name in names
        },
        "shear_strength_from_hardness_MPa": taus.get("hardness"),
    }
    lines = [
        f"shear strength τ0 = (μ0 − μ_p) F/A of {folder} (thesis eq 4.19): μ0 {cof:g}, μ_p {ploughing:g}, "
        f"F {load:g} N",
        f"  {'area':<34} {'at the end, mm²':>16} {'τ0, MPa':>10} {'at the start, mm²':>19} {'τ0, MPa':>10}",
    ]
    lines += [
        f"  {WORDS[name]:<34} {sizes[name][1]:>16.4g} {taus[f'{name}_end']:>10.4g} {sizes[name][0]:>19.4g} "
        f"{taus[f'{name}_initial']:>10.4g}"
        for name in names
    ]
    if "hardness" in taus:
        lines.append(f"  from the hardness, H/(3√3): {taus['hardness']:.4g} MPa")
    if not finished:
        lines.append(f"  note: the run was interrupted: its end is {slid:g} mm")
    lines.append(
        "  τ0 belongs to its area and to the moment it was fixed at: choose both by the physics, not by τ0"
    )
    return record, "\n".join(lines)


def _of_curve(file: Path, folder: Path, area: str, reading: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """reading: what `read_experiment` is told about the file beside the run's load."""
    with Result.open(folder) as result:
        load = result.study.contact.load
        measured = read_experiment(file, load=load, **reading)
        found = _fit(measured.distance, measured.cof, result, area)
    record = {
        "experiment": str(file),
        "notes": [*measured.warnings, *measured.notes],
        "result": str(folder),
        "area": area,
        "load_N": load,
        **fit_record(found),
    }
    text = fit_page(found, f"{file} with the area {WORDS[area]} of {folder}, F {load:g} N", area=area)
    return record, "\n".join([text, *(f"  note: {note}" for note in (*measured.warnings, *measured.notes))])


def _fit(distance: Any, cof: Any, result: "Result", area: str) -> FrictionFit:
    history = result.history
    if history["distance"].size < 2:
        raise InputError("the run is a static contact: one area is no course to fit")
    return fit_friction(
        distance,
        cof,
        run_distance=history["distance"],
        run_area=history[f"area_{area}"],
        load=result.study.contact.load,
    )


def fit_record(fit: FrictionFit) -> dict[str, Any]:
    """A fit, JSON-ready."""
    return {
        **_shear_record(fit),
        "ploughing": fit.ploughing,
        "ploughing_error": fit.ploughing_error,
        "distance_used_mm": [fit.first, fit.last],
        "points_used": fit.points,
        "points_left_out": fit.left_out,
        "points_effective": fit.effective_points,
        "condition_index": fit.condition,
        "area_variation": fit.area_variation,
        "without_ploughing": _shear_record(fit.without_ploughing),
        "doubts": list(fit.doubts),
    }


def _shear_record(fit: FrictionFit | ShearFit) -> dict[str, Any]:
    return {
        "shear_strength_MPa": fit.shear_strength,
        "shear_strength_error_MPa": fit.shear_strength_error,
        "rms_residual": fit.rms,
        "r_squared": fit.r_squared,
    }


def fit_page(fit: FrictionFit, title: str, *, area: str) -> str:
    """A fit for people. title: what was fitted with what; area: its name in a study."""
    alone = fit.without_ploughing
    lines = [
        f"least squares of μ = μ_p + τ0 A/F: {title}",
        f"  used             {fit.points} points from {fit.first:g} to {fit.last:g} mm"
        + (f", {fit.left_out} beyond the run's distances left out" if fit.left_out else ""),
        f"  τ0               {fit.shear_strength:.4g} ± {fit.shear_strength_error:.2g} MPa (standard error)",
        f"  μ_p              {fit.ploughing:.4g} ± {fit.ploughing_error:.2g}",
        f"  fit              RMS residual {fit.rms:.3g}, R² {_r_squared(fit.r_squared)}",
        f"  with μ_p = 0     τ0 {alone.shear_strength:.4g} ± {alone.shear_strength_error:.2g} MPa, RMS "
        f"residual {alone.rms:.3g}, R² {_r_squared(alone.r_squared)}",
        f"  errors           allow for scatter that goes together: {fit.effective_points:.3g} independent "
        "points",
    ]
    lines += [f"  warning: {doubt}" for doubt in fit.doubts]
    tau, offset = fit.shear_strength, fit.ploughing
    if offset < 0.0:
        tau, offset = alone.shear_strength, 0.0
    if tau > 0.0:
        lines.append(
            f'  in a study       [friction] area = "{area}", shear_strength = "{tau:.4g} MPa", '
            f"ploughing = {offset:.4g}"
        )
    return "\n".join(lines)


def _r_squared(value: float | None) -> str:
    return "undefined (a constant coefficient)" if value is None else f"{value:.4f}"
