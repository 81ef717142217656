"""The command `warpwear calibrate friction`: from its options to the text it prints."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from warpwear.calibration.friction import FrictionFit, ShearFit, fit_friction
from warpwear.errors import InputError
from warpwear.laws import friction, passes
from warpwear.laws.friction import FrictionLaw
from warpwear.measured.course import read_experiment
from warpwear.measured.options import COF, PLOUGHING, Options, number, quantity
from warpwear.result import Result
from warpwear.results.report import Row, lines, record, table, to_json
from warpwear.study.study import Study

#: Area of a run -> what it is called for people.
WORDS = {
    "contact": "in contact",
    "touched": "ever touched",
    "cumulative": "running sum",
    "nominal": "nominal (the scar as an ellipse)",
}
AREAS = tuple(WORDS)
INDEPENDENT = "points scatter as much: the errors allow for scatter that goes together"


def calibrate_friction(*, experiments: Sequence[Path] = (), as_json: bool = False, **options: Any) -> str:
    """Find τ0 of a measured coefficient, or fit a curve: the text for people, or JSON.

    options: result, the run's folder; cof, ploughing; load, stroke, speed: text with a unit; area: one too
    with `load`, else the name of a run's area; columns of an experiment. Raises InputError.
    """
    o = Options(options)
    result, cof, ploughing, area = (o[name] for name in ("--result", "--cof", "--ploughing", "--area"))
    if result is not None:
        o.refuse("--load", why="and --result exclude each other: the run has its load")
    if len(experiments) > 1:
        raise InputError(
            f"--experiment is given {len(experiments)} times, and one course is fitted at a time; "
            "`warpwear calibrate bayes` takes repeated tests together, with their scatter"
        )
    if experiments:
        if result is None:
            raise InputError("--experiment needs --result, the run folder whose areas it is fitted with")
        o.refuse("--cof", "--ploughing", why="and --experiment exclude each other: the fit finds it")
        reading = {"stroke": o.optional("--stroke", "mm"), "speed": o.optional("--speed", "mm/s")}
        rows, text = _of_curve(experiments[0], result, _name(area), reading | {"columns": o["--columns"]})
    else:
        why = "needs --experiment: it says how that file is read"
        o.refuse("--columns", "--stroke", "--speed", why=why)
        if cof is None:
            raise InputError("--cof is missing: a measured coefficient of friction, or --experiment")
        measured = number("--cof", cof, COF)
        offset = number("--ploughing", ploughing or 0.0, PLOUGHING)
        if measured <= offset:
            raise InputError(f"--cof = {measured:g} must exceed --ploughing = {offset:g}")
        if result is not None:
            rows, text = _of_run(result, measured, None if ploughing is None else offset, _name(area))
        elif area is not None and o["--load"] is not None:
            rows, text = _of_area(area, o["--load"], measured, offset)
        else:
            raise InputError("the area is missing: --result, or --area and --load such as '1.254 mm^2' '8 N'")
    return to_json(record(rows)) if as_json else "\n".join(text)


def _name(area: str | None) -> str | None:
    """Check the name of a run's area, if there is one. Raises InputError."""
    if area is not None and area not in AREAS:
        raise InputError(f"--area is {area!r}: allowed with --result is one of {', '.join(AREAS)}")
    return area


def _of_area(area: str, load: str, cof: float, ploughing: float) -> tuple[list[Row], list[str]]:
    """Declare τ0 from an area and a load given as text. Raises InputError."""
    size, force = quantity("--area", area, "mm^2"), quantity("--load", load, "N")
    tau = friction.fitted_strength(cof, ploughing, load=force, area=size)
    if not 0.0 < tau < math.inf:
        raise InputError(f"--area {area} and --load {load} make {tau:g} MPa: allowed is any positive number")
    strength = Row("", "shear_strength_MPa", tau)
    study = Row("in a study", "", f'[friction] shear_strength = "{strength.text}"')
    rows = [*_test_rows(force, cof, ploughing), Row("area A", "area_mm2", size, digits=6), strength, study]
    return rows, [f"shear strength τ0 = (μ0 − μ_p) F/A = {strength.text} (thesis eq 4.19)", *lines(rows)]


def _test_rows(load: float, cof: float, ploughing: float) -> list[Row]:
    """Declare what τ0 is found from. load [N]."""
    return [
        Row("load F", "load_N", load, digits=6),
        Row("coefficient μ0", "cof", cof, digits=6),
        Row("ploughing μ_p", "ploughing", ploughing, digits=6),
    ]


def _of_run(
    folder: Path, cof: float, ploughing: float | None, area: str | None
) -> tuple[list[Row], list[str]]:
    """Declare τ0 from the areas of a run, at its start and at its end.

    ploughing: None for the run's. area: its name, None for all four.
    """
    with Result.open(folder) as result:
        study, history, finished = result.study, result.history, result.finished
    load, laps = study.contact.load, study.laps
    ploughing = study.friction.ploughing if ploughing is None else ploughing
    law = _law(study, folder, coefficient=cof, ploughing=ploughing)
    taus = law.calibrations(history, load=load, hardness=study.indentation_hardness, laps=laps)
    sizes: dict[str, list[Row]] = {}
    for name in AREAS if area is None else (area,):
        columns = history, history[f"area_{name}"]
        start, end = (passes.mean_over(*columns, when, laps) for when in passes.WHEN)
        sizes[name] = [
            Row("area", "", WORDS[name]),
            Row("at the start", "area_initial_mm2", start),
            Row("at the end", "area_end_mm2", end),
            Row("τ0 of the start", "shear_strength_initial_MPa", taus[f"{name}_initial"]),
            Row("τ0 of the end", "shear_strength_end_MPa", taus[f"{name}_end"]),
        ]
    ended = "" if finished else ", where it was interrupted"
    head = [
        Row("", "result", str(folder)),
        Row("", "finished", finished),
        Row("distance", "distance_mm", float(history["distance"][-1]), digits=6, note=ended),
        *_test_rows(load, cof, ploughing),
    ]
    hardness = Row("from the hardness, H/(3√3):", "shear_strength_from_hardness_MPa", taus.get("hardness"))
    advice = "τ0 belongs to its area and to the moment it was fixed at: choose both by the physics, not by τ0"
    title = f"shear strength τ0 = (μ0 − μ_p) F/A of {folder} (thesis eq 4.19)"
    text = [title, *lines(head), *table(list(sizes.values())), *lines([hardness]), f"  {advice}"]
    return [*head, Row("", "areas", sizes), hardness], text


def _law(study: Study, folder: Path, **measured: float) -> FrictionLaw:
    """Return a run's law of friction with a measured coefficient. Raises InputError where it has no such."""
    study.refuse_blocks("warpwear calibrate friction")
    keys = {"law": "shear-strength", "coefficient": study.friction.coefficient, **measured}
    try:
        return study.replace({f"friction.{key}": value for key, value in keys.items()}).friction.law_with()
    except InputError as error:
        raise InputError(f"{folder}: {error}") from None


def _of_curve(
    file: Path, folder: Path, area: str | None, reading: dict[str, Any]
) -> tuple[list[Row], list[str]]:
    """Declare the fit of a measured curve with an area of a run.

    area: its name, None for the one by which the run's friction goes. reading: what `read_experiment` takes
    about the file beside the run's load. Raises InputError.
    """
    with Result.open(folder) as result:
        study, history = result.study, result.history
    load, law = study.contact.load, _law(study, folder, ploughing=0.0)
    area = law.area if area is None else area
    measured = read_experiment(file, load=load, radius=study.same_radius, **reading)
    if history["distance"].size < 2:
        raise InputError(f"{folder} is a static contact: one area is no course to fit")
    distance, size = history["distance"], history[f"area_{area}"] * law.factor(history)
    fit = fit_friction(measured.distance, measured.cof, run_distance=distance, run_area=size, load=load)
    source = [
        Row("experiment", "experiment", str(file)),
        Row("note", "notes", [*measured.warnings, *measured.notes]),
        Row("run", "result", str(folder)),
        Row("area A", "area", area, sentence=WORDS[area]),
        Row("load F", "load_N", load, digits=6),
    ]
    rows = [*source, *_fit_rows(fit)]
    in_study = Row("in a study", "", _in_study(fit, area=area))
    return rows, ["least squares of μ = μ_p + τ0 A/F", *lines([*rows, in_study])]


def _fit_rows(fit: FrictionFit) -> list[Row]:
    """Declare a fit."""
    used = f"from {fit.first:g} to {fit.last:g} mm"
    if fit.left_out:
        used += f", {fit.left_out} beyond the run's distances left out"
    return [
        *_shear_rows(fit),
        Row("μ_p", "ploughing", fit.ploughing, error=fit.ploughing_error),
        Row("", "distance_used_mm", [fit.first, fit.last]),
        Row("points used", "points_used", fit.points, note=used),
        Row("", "points_left_out", fit.left_out),
        Row("independent", "points_effective", fit.effective_points, digits=3, note=INDEPENDENT),
        Row("condition index", "condition_index", fit.condition, digits=3),
        Row("area varies by", "area_variation", fit.area_variation, digits=3, note="of its mean"),
        Row("with μ_p = 0", "without_ploughing", _shear_rows(fit.without_ploughing)),
        Row("warning", "doubts", list(fit.doubts)),
    ]


def _shear_rows(fit: FrictionFit | ShearFit) -> list[Row]:
    """Declare what a fit with and one without ploughing have in common."""
    error = fit.shear_strength_error
    return [
        Row("τ0", "shear_strength_MPa", fit.shear_strength, error=error, note="(standard error)"),
        Row("RMS residual", "rms_residual", fit.rms, digits=3),
        Row("R²", "r_squared", fit.r_squared),
    ]


def _in_study(fit: FrictionFit, *, area: str) -> str | None:
    """Write a fit as keys of a study, without a negative ploughing; None for no positive shear strength."""
    tau, offset = fit.shear_strength, fit.ploughing
    if offset < 0.0:
        tau, offset = fit.without_ploughing.shear_strength, 0.0
    if tau <= 0.0:
        return None
    return f'[friction] area = "{area}", shear_strength = "{tau:.4g} MPa", ploughing = {offset:.4g}'
