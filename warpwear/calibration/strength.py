"""Shear strengths τ0 from a measured coefficient or course of friction, and the areas of a run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from warpwear.calibration.friction import FrictionFit, ShearFit, fit_friction
from warpwear.calibration.measurements import Tests
from warpwear.calibration.repeated import CalibratedTests, each_test
from warpwear.errors import InputError, named_in_python, prose
from warpwear.laws import friction, passes
from warpwear.laws.friction import FrictionLaw
from warpwear.measured.course import read_experiment
from warpwear.measured.options import COF, PLOUGHING, Options, number, optional, quantity
from warpwear.measured.report import Report
from warpwear.result import Run, opened
from warpwear.results.report import Row, lines, table
from warpwear.study.study import Study

#: Area of a run -> what it is called for people.
WORDS = prose("reports")["friction"]["areas"]
INDEPENDENT = "points would tell τ0 as well: the errors allow for scatter that goes together"
#: Key of a test -> option.
KEYS = {"friction": "cof", "record": "experiment", "load": "load", "area": "area"}
ADVICE = "τ0 belongs to its area and to the moment it was fixed at: choose both by the physics, not by τ0"


@dataclass(frozen=True, kw_only=True, repr=False)
class FrictionCalibration(Report):
    """Hold shear strengths τ0 of μ = μ_p + τ0 A/F.

    Attributes
    ----------
    shear_strengths : dict
        τ0 [MPa] by the name of its area; of a run ``contact_initial``, ``contact_end`` and so on, and
        ``hardness`` for H/(3√3).
    fit : FrictionFit or None
        Of a course of friction: `shear_strength`, `ploughing`, their standard errors, and `doubts`.
    main : str
        Name of that by which friction goes: of a run by its law's area, at the time that fixes it.
    title, rows, areas, after : str, tuple of Row, dict
        What is printed.
    """

    shear_strengths: Mapping[str, float]
    fit: FrictionFit | None = None
    main: str
    title: str
    rows: tuple[Row, ...]
    areas: Mapping[str, list[Row]] = field(default_factory=dict)
    after: tuple[Row, ...] = ()

    @property
    def headline(self) -> Row:
        """Declare τ0, of a course with its standard error."""
        error = None if self.fit is None else self.fit.shear_strength_error
        return Row("τ0", "shear_strength_MPa", self.shear_strengths[self.main], error=error)

    def _title(self) -> str:
        return self.title

    def __repr__(self) -> str:
        strengths = ", ".join(f"{name} {tau:.4g}" for name, tau in self.shear_strengths.items())
        return f"<shear strengths [MPa]: {strengths}>"

    def _rows(self) -> list[Row]:
        areas = [Row("", "areas", self.areas)] if self.areas else []
        return [*self.rows, *areas, *self.after]

    def _table(self) -> list[list[Row]]:
        named = [[Row("", "name", name), *rows[1:]] for name, rows in self.areas.items()]
        return named or [self._rows()]

    def __str__(self) -> str:
        if not self.areas:
            return super().__str__()
        areas = table([*self.areas.values()])
        return "\n".join([self.title, *lines(self.rows), *areas, *lines(self.after), f"  {ADVICE}"])


@named_in_python()
def calibrate_friction(
    tests: Tests | None = None,
    *,
    result: Run | None = None,
    cof: float | None = None,
    ploughing: float | None = None,
    area: Any = None,
    load: Any = None,
    experiment: str | Path | None = None,
    columns: str | None = None,
    stroke: Any = None,
    speed: Any = None,
) -> FrictionCalibration | CalibratedTests:
    """Find the shear strength τ0 of μ = μ_p + τ0 A/F from a measured coefficient or course.

    Parameters
    ----------
    tests : list of dict, or path, optional
        One a test: ``friction``, such as ``"0.6 +- 0.02"``, or ``record``, the file of a course, and without
        `result` ``load`` and ``area``. The keys are those of ``[[test]]``, which docs/reference/keys.md
        explains; a path is that of a TOML file with such a list, maybe in a study, whose load holds.
    result : Result or path, optional
        A run, or its folder, whose areas are taken.
    cof, ploughing : float, optional
        Measured coefficient of friction, and the part of it that does not shear.
    area : str, optional
        With `load` an area such as ``"1.254 mm^2"``; with `result` one of contact, touched, cumulative and
        nominal.
    load : str, optional
        Normal load without a run, such as ``"8 N"``.
    experiment : path, optional
        Record of a course of friction, which is fitted with an area of the run: τ0 and μ_p.
    columns, stroke, speed : str, optional
        Which columns of the record to take, and length of a pass and speed where it counts cycles or time.

    Returns
    -------
    FrictionCalibration or CalibratedTests
        Shear strengths [MPa]; of a course its fit. Of a list of tests each, their mean and scatter.

    Raises
    ------
    InputError
        For what is missing or does not go together, and for a course that cannot be fitted.

    References
    ----------
    F. P. Bowden and D. Tabor, The Friction and Lubrication of Solids, Oxford, 1950.

    Examples
    --------
    >>> warpwear.calibrate_friction(area="1.254 mm^2", load="8 N", cof=0.6)
    <shear strengths [MPa]: given 3.828>
    >>> repeats = [{"friction": "0.6 +- 0.02"}, {"friction": "0.63 +- 0.02"}]
    >>> warpwear.calibrate_friction(repeats, area="1.254 mm^2", load="8 N")
    <τ0 of 2 tests: 3.923 ± 0.096 MPa (standard uncertainty by their scatter)>
    """
    o = Options(result=result, cof=cof, ploughing=ploughing, area=area, load=load, experiment=experiment)
    o |= {"columns": columns, "stroke": stroke, "speed": speed}
    if tests is not None:
        return each_test(calibrate_friction, tests, KEYS, o)
    if result is not None:
        o.refuse("--load", why="and --result exclude each other: the run has its load")
        if area is not None and area not in WORDS:
            raise InputError(f"--area is {area!r}: allowed with --result is one of {', '.join(WORDS)}")
    if experiment is not None:
        if result is None:
            raise InputError("--experiment needs --result, the run folder whose areas it is fitted with")
        o.refuse("--cof", "--ploughing", why="and --experiment exclude each other: the fit finds it")
        reading = {"stroke": optional("--stroke", stroke, "mm"), "speed": optional("--speed", speed, "mm/s")}
        return _of_curve(Path(experiment), result, area, reading | {"columns": columns})
    o.refuse("--columns", "--stroke", "--speed", why="needs --experiment: it says how that file is read")
    if cof is None:
        raise InputError("--cof is missing: a measured coefficient of friction, or --experiment")
    measured = number("--cof", cof, COF)
    offset = number("--ploughing", ploughing or 0.0, PLOUGHING)
    if measured <= offset:
        raise InputError(f"--cof = {measured:g} must exceed --ploughing = {offset:g}")
    if result is not None:
        return _of_run(result, measured, None if ploughing is None else offset, area)
    if area is None or load is None:
        raise InputError("the area is missing: --result, or --area and --load such as '1.254 mm^2' '8 N'")
    return _of_area(area, load, measured, offset)


def _of_area(area: Any, load: Any, cof: float, ploughing: float) -> FrictionCalibration:
    """Declare τ0 from an area and a load given as text. Raises InputError."""
    size, force = quantity("--area", area, "mm^2"), quantity("--load", load, "N")
    tau = friction.fitted_strength(cof, ploughing, load=force, area=size)
    if not 0.0 < tau < math.inf:
        raise InputError(f"--area {area} and --load {load} make {tau:g} MPa: allowed is any positive number")
    strength = Row("", "shear_strength_MPa", tau)
    study = Row("in a study", "", f'[friction] shear_strength = "{strength.text}"')
    rows = *_test_rows(force, cof, ploughing), Row("area A", "area_mm2", size, digits=6), strength, study
    title = f"shear strength τ0 = (μ0 − μ_p) F/A = {strength.text} (thesis eq 4.19)"
    return FrictionCalibration(shear_strengths={"given": tau}, main="given", title=title, rows=rows)


def _test_rows(load: float, cof: float, ploughing: float) -> list[Row]:
    """Declare what τ0 is found from. load [N]."""
    return [
        Row("load F", "load_N", load, digits=6),
        Row("coefficient μ0", "cof", cof, digits=6),
        Row("ploughing μ_p", "ploughing", ploughing, digits=6),
    ]


def _of_run(run: Run, cof: float, ploughing: float | None, area: str | None) -> FrictionCalibration:
    """Declare τ0 from the areas of a run, at its start and at its end.

    ploughing: None for the run's. area: its name, None for all four.
    """
    with opened(run) as result:
        study, history, finished, folder = result.study, result.history, result.finished, result.name
    load, laps = study.contact.load, study.laps
    ploughing = study.friction.ploughing if ploughing is None else ploughing
    law = _law(study, folder, coefficient=cof, ploughing=ploughing)
    taus = law.calibrations(history, load=load, hardness=study.pair.indentation_hardness, laps=laps)
    sizes: dict[str, list[Row]] = {}
    for name in WORDS if area is None else (area,):
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
    head = (
        Row("", "result", folder),
        Row("", "finished", finished),
        Row("distance", "distance_mm", float(history["distance"][-1]), digits=6, note=ended),
        *_test_rows(load, cof, ploughing),
    )
    hardness = Row("from the hardness, H/(3√3):", "shear_strength_from_hardness_MPa", taus.get("hardness"))
    title = f"shear strength τ0 = (μ0 − μ_p) F/A of {folder} (thesis eq 4.19)"
    main = f"{area or law.area}_{study.friction.calibrate}"
    parts: Any = {"rows": head, "areas": sizes, "after": (hardness,)}
    return FrictionCalibration(shear_strengths=taus, main=main, title=title, **parts)


def _law(study: Study, folder: str, **measured: float) -> FrictionLaw:
    """Return a run's law of friction with a measured coefficient. Raises InputError where it has no such."""
    study._refuse_blocks("warpwear calibrate friction")
    keys = {"law": "shear-strength", "coefficient": study.friction.coefficient, **measured}
    try:
        return study.replace({f"friction.{key}": value for key, value in keys.items()}).friction.law_with()
    except InputError as error:
        raise InputError(f"{folder}: {error}") from None


def _of_curve(file: Path, run: Run, area: str | None, reading: dict[str, Any]) -> FrictionCalibration:
    """Declare the fit of a measured curve with an area of a run.

    area: its name, None for the one by which the run's friction goes. reading: what `read_experiment` takes
    about the file beside the run's load. Raises InputError.
    """
    with opened(run) as result:
        study, history, folder = result.study, result.history, result.name
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
        Row("run", "result", folder),
        Row("area A", "area", area, sentence=WORDS[area]),
        Row("load F", "load_N", load, digits=6),
    ]
    rows = *source, *_fit_rows(fit), Row("in a study", "", _in_study(fit, area=area))
    title, strengths = "least squares of μ = μ_p + τ0 A/F", {area: fit.shear_strength}
    return FrictionCalibration(shear_strengths=strengths, fit=fit, main=area, title=title, rows=rows)


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
