"""What a run amounts to, each number declared once: as JSON has it, and as people read it."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.distances import with_unit
from warpwear.history.end_values import Summary
from warpwear.history.quantities import BY_NAME
from warpwear.history.rows import Named
from warpwear.history.verdict import verdict_of
from warpwear.laws import passes
from warpwear.laws.archard import BODIES
from warpwear.laws.courses import Breaking, fit_breaking
from warpwear.results import summary_models
from warpwear.results.file import ResultFile
from warpwear.results.report import Row, entries, finite, lines, record, shown
from warpwear.results.track import course, shape_of_growth
from warpwear.study.study import Study

#: Columns that change along a track: of a swept run their last value says little.
OF_A_PASS = ("approach", "area_contact", "area_plastic", "pressure_mean", "pressure_std", "cof")
#: Stands behind a coefficient of friction that the study gives or assumes: it is no result of the run.
INPUT, ASSUMED = " (an input)", " (an input, assumed)"


def summarise(result: ResultFile) -> list[Row]:
    """Declare the verdict, scar, depths, volumes, areas, friction, residuals, conservation, assumptions.

    `record` makes summary.json of it, `summary_text` the lines of a terminal.

    Of a swept run, values that go up and down along the track (approach, cof, areas in contact and at
    hardness, pressures) are means over what `end_values` names, mostly the last cycle; the largest
    pressure is the largest there. All this is made once; the seconds that the run took come later.
    """
    rows = result.once(_rows)
    return [*rows[:-1], Row("", "seconds", result.seconds), rows[-1]] if result.seconds else rows


def _rows(result: ResultFile) -> list[Row]:
    """Declare all but the seconds; the last are the assumptions."""
    end = last_values(result)
    rows = [
        *_run(result, end),
        *_blocks(result),
        *_contact(result, end),
        *([] if result.study.is_swept or result.study.fretting else _of_one_spot(result)),
        *summary_models.surfaces(result),
        *(summary_models.track(result) if result.study.is_swept else []),
        *(summary_models.fretting(result) if result.study.sliding.frets else []),
        *summary_models.arrangement(result),
        *_friction(result, end),
        *_energy(result, end),
        *summary_models.stresses(result),
        *_film(result),
        *summary_models.layers(result),
        *_checks(result, end),
    ]
    verdict = verdict_of(result.study, Summary.of(record(rows)), result.history)
    return [Row("verdict", "verdict", vars(verdict), sentence=verdict.text), *rows]


def summary_text(rows: Sequence[Row]) -> str:
    """Say in lines for people what a run amounts to. rows: as of `summarise`."""
    s = record(rows)
    slid = f"{with_unit(s['distance_mm'])} slid in {s['steps']} steps, {s['elapsed_s']:.1f} s"
    return "\n".join([f"{s['name']}: {slid}", *lines(rows)])


def last_values(result: ResultFile) -> dict[str, float]:
    """Map columns of the history, and shear_strength, to end values; of a swept run maybe of a last cycle."""
    study, history, law = result.study, result.history, result.study.friction.law_with()
    end = Named({name: float(values[-1]) for name, values in history.items()})
    for name in OF_A_PASS:
        end[name] = passes.mean_over(history, history[name], "end", study.laps)
    end["pressure_max"] = float(history["pressure_max"][passes.within(history, "end", study.laps)].max())
    fit: Any = {"load": history["load"], "finished": result.finished, "laps": study.laps}
    end["shear_strength"] = law.final_strength(history, **fit)
    return end


def _end(result: ResultFile) -> str:
    """Return what the end values are of: both directions of a track, if it was slid over in both."""
    laps, distance = result.study.laps, float(result.history["distance"][-1])
    if laps is None:
        return "last step"
    return "last cycle" if laps.last(distance) > laps.length else "last pass"


def _run(result: ResultFile, end: dict[str, float]) -> list[Row]:
    """Declare what was run, and its main inputs."""
    study = result.study
    coefficients = dict(zip(BODIES, study.wear_coefficients, strict=True))
    return entries(
        {
            "name": study.study.name,
            "model": study.study.model,
            **{name: np.asarray(v).item() for name, v in result.attributes.items() if name != "record"},
            "steps": int(result.history["distance"].size),
            "cell_um": 1.0e3 * study.grid.cell,
            "distance_mm": end["distance"],
            "end_values": _end(result),
            "load_N": end["load"],
            "hardness_MPa": finite(study.hardness),
            "wear_coefficient_mm3_per_Nm": {body: 1.0e3 * k for body, k in coefficients.items()},
            "wear_coefficient_per_Pa": {body: 1.0e-6 * k for body, k in coefficients.items()},
            **({"wear_coefficient_mm3_per_J": study.wear.per_energy} if study.wear.law == "energy" else {}),
        }
    )


def _blocks(result: ResultFile) -> list[Row]:
    """Declare what each block of a programme wore, and its mean friction; nothing without a programme."""
    history, rows = result.history, []
    if result.study.block is None:
        return []
    for block in result.study.blocks:
        steps = np.flatnonzero(history["block"] == block.number)
        if not steps.size:  # of a run that was stopped before
            break
        before, last = steps[0] - 1, steps[-1]
        worn = {b: history[f"wear_volume_{b}"] for b in BODIES}
        volumes = {b: float(of[last] - (of[before] if before >= 0 else 0.0)) for b, of in worn.items()}
        depths = {b: 1.0e3 * float(history[f"wear_depth_{b}"][last]) for b in BODIES}
        mean = float(np.average(history["cof"][steps], weights=history["increment"][steps]))
        slid = min(block.end, float(history["distance"][last])) - block.start
        numbers: dict[str, Any] = {"load_N": block.load, "distance_mm": slid, "steps": int(steps.size)}
        numbers |= {"volume_mm3": volumes, "depth_um": depths, "cof_mean": finite(mean)}
        where = ""
        if circles := result.study.circles:
            numbers["track_radius_mm"] = radius = circles[result.study.circle_of(block)]
            where = f" on a track of {radius:.6g} mm radius"
        text = f"{block.load:.4g} N over {with_unit(slid)}{where}: worn {shown(volumes)} mm³; deepest "
        text += f"at its end {shown(depths)} µm; mean CoF {shown(finite(mean), 3)}"
        rows.append(Row(f"block {block.number}", "", numbers, sentence=text))
    return [*rows, Row("", "blocks", [{"number": n, **row.value} for n, row in enumerate(rows, 1)])]


def _contact(result: ResultFile, end: dict[str, float]) -> list[Row]:
    """Declare scar, areas, pressures and wear."""
    of_pass, of_steps = ", ", ""
    if result.study.is_swept:
        of_pass, of_steps = f"(mean of the {_end(result)}), ", f", of the {_end(result)}"
    size = {way: end[f"patch_{way}"] for way in ("along", "across")}
    real, means = end["area_contact"] / end["area_nominal"], result.history["pressure_mean"]
    outline = "a rectangle" if result.study.counter.form.is_line else "an ellipse"
    of_nominal = f"{of_pass}{real:.3g} of the nominal area (the scar as {outline})"
    names = ("plastic", "touched", "cumulative")
    others = [Row(BY_NAME[f"area_{name}"].short, name, end[f"area_{name}"]) for name in names]
    areas = [
        Row("area in contact", "contact", end["area_contact"], unit="mm²", note=of_nominal),
        Row("other areas", "", others, unit="mm²"),
        Row("", "nominal", end["area_nominal"]),
    ]
    labels = {"mean": "mean", "std": "", "max": "largest"}
    pressures = [Row(label, name, end[f"pressure_{name}"]) for name, label in labels.items()]
    volumes, strip = {b: end[f"wear_volume_{b}"] for b in BODIES}, result.study.strip
    note = f"(of the domain's {strip:.4g} mm across)" if strip else ""
    of_line = {body: volume / strip for body, volume in volumes.items()} if strip else None
    of_steps_all = {"smallest": float(means.min()), "largest": float(means.max()), "std": float(means.std())}
    return [
        Row("scar", "scar_mm", size, sentence=f"{shown([*size.values()])} mm (along × across)"),
        Row("", "approach_um", 1.0e3 * end["approach"]),
        Row("", "area_mm2", areas),
        Row("", "area_real_over_nominal", real),
        *_on_filled(result.load_on_filled),
        Row("pressure", "pressure_MPa", pressures, note=of_steps),
        *_above_hardness(result),
        *_by_scheme(result),
        Row("", "pressure_mean_over_steps_MPa", of_steps_all),
        Row("deepest wear", "depth_um", {b: 1.0e3 * end[f"wear_depth_{b}"] for b in BODIES}),
        Row("worn volume", "volume_mm3", volumes, digits=5, note=note),
        *([Row("of a mm of line", "volume_mm3_per_mm", of_line, digits=5, unit="mm³/mm")] if of_line else []),
    ]


def _above_hardness(result: ResultFile) -> list[Row]:
    """Declare how far pressures of a bearing area exceed the hardness, by the balance's tolerance."""
    study, most = result.study, float(result.history["pressure_max"].max())
    percent = 100.0 * (most / study.hardness - 1.0)
    if not study.uses_bearing_area or percent < 0.1:
        return []
    text = f"up to {most:.4g} MPa of {study.hardness:g}: the load is balanced to {study.load_tolerance:g} N"
    return [Row("above hardness", "pressure_above_hardness_percent", percent, sentence=text)]


def _by_scheme(result: ResultFile) -> list[Row]:
    """Declare which area explicit and implicit steps give a rough contact that yields by wear alone."""
    study, pair = result.study, result.study.pair
    yields = study.study.model != "micro" or study.contact.law != "local" or pair.stiffness < math.inf
    if yields or study.wear.sheds or not (study.is_rough and study.sliding.total and pair.caps_pressure):
        return []
    explicit, area = study.stepping.scheme == "explicit", result.history["load"][-1] / study.hardness
    text = f"explicit: the area stays near load over hardness, {area:.3g} mm²; by implicit ones it grows"
    if not explicit:
        text = f"implicit: bodies yield by their wear; by explicit ones the area stays near {area:.3g} mm²"
    return [Row("steps", "load_over_hardness_mm2", area, sentence=text)]


def _on_filled(fractions: FloatArray) -> list[Row]:
    """Declare the part of the load on points that were not measured. fractions: one a snapshot, or none."""
    if not fractions.size:
        return []
    percent = 100.0 * fractions
    end, largest = float(percent[-1]), float(percent.max())
    text = f"at the end {shown(end, 2)}, at most {shown(largest, 2)} % of the load"
    numbers = {"end": end, "largest": largest}
    return [Row("on filled points", "load_on_filled_percent", numbers, sentence=text)]


def _of_one_spot(result: ResultFile) -> list[Row]:
    """Declare that scar and depths are not those of a track.

    Where more than one pass was slid, also the section of the groove that the disc's wear would be, were it
    spread over the track of the test: a disc that lies still has all of it under the counter-body.
    """
    laps, distance = {p.sliding.lap for p in result.study.parts}, float(result.history["distance"][-1])
    lap = laps.pop() if len(laps) == 1 else None  # blocks may differ in it
    if distance == 0.0:
        return []
    text = "scar and depths are those of one spot, which stays under the counter-body"
    if lap is None or distance <= lap:
        return [Row("disc at rest", "", text)]
    section = 1.0e6 * float(result.history["wear_volume_disc"][-1]) / lap
    groove = {"length_mm": lap, "section_um2": section}
    text += f"; on a track of {lap:.4g} mm: section {section:.4g} µm²"
    return [Row("disc at rest", "on_a_track", groove, sentence=text)]


def _friction(result: ResultFile, end: dict[str, float]) -> list[Row]:
    """Declare friction: its course, its shear strength, and the strengths that other areas would need."""
    study, history, section = result.study, result.history, result.study.friction
    law, load, laps = section.law_with(), history["load"], study.laps
    first, last = finite(passes.mean_over(history, history["cof"], "initial", laps)), finite(end["cof"])
    shapes = {"cof_shape": _shape(result, "cof"), "area_shape": _shape(result, f"area_{section.area}")}
    others = law.calibrations(history, load=load, hardness=study.pair.indentation_hardness, laps=laps)
    return [
        _cof(study, first, last),
        Row("", "cof_input", section.fitted),
        _strength(study, finite(end["shear_strength"])),
        Row("", "shear_strength_of_softer_body_MPa", finite(study.pair.shear_limit)),
        *entries({"cof_area": section.area if law.strengths else None, **shapes}),
        Row("", "cof_reference", section.coefficient if section.fitted != "states" else None),
        _strengths(section.coefficient, others),
    ]


def _cof(study: Study, first: float | None, last: float | None) -> Row:
    """Declare the coefficient of friction at first and at the end; no line where it is not known."""
    ends = {"first": first, "end": last}
    if first is None or last is None:
        return Row("", "cof", ends)
    source = ASSUMED if "friction.coefficient" in study.assumptions else INPUT
    if study.friction.fitted == "coulomb":
        return Row("friction", "cof", ends, sentence=f"{shown(last, 3)}{source}, at every distance")
    if study.friction.fitted == "states":
        return Row(
            "friction", "cof", ends, sentence=f"{shown(first, 3)} to {shown(last, 3)}{INPUT}, by states"
        )
    marks = {when: source if when == study.friction.fitted else "" for when in passes.WHEN}
    text = shown({f"at first{marks['initial']}": first, f"at the end{marks['end']}": last}, 3)
    area = f"(area: {study.friction.area}; relative to the end: {first / last:.3g})"
    return Row("friction", "cof", ends, sentence=f"{text} {area}")


def _energy(result: ResultFile, end: dict[str, float]) -> list[Row]:
    """Declare what friction has dissipated, and by the energy law what it wears."""
    law, energy = result.study.wear, finite(end["friction_energy"])
    note = f", wears {shown(law.per_energy)} mm³/J" if law.law == "energy" else ""
    note += f" (of the domain's {strip:.4g} mm across)" if (strip := result.study.strip) else ""
    return [Row("friction energy", "friction_energy_J", energy, note=note)] if end["distance"] else []


def _strength(study: Study, strength: float | None) -> Row:
    """Declare the shear strength: as given, or fitted, and whether the softer body bears it."""
    note, limit = f"{study.pair.other_shear}, as given", study.pair.shear_limit
    if study.friction.fitted is not None:
        note = f", fitted to {study.friction.coefficient:g}"
        if study.block is not None:
            note += f" under {study.blocks[-1 if study.friction.fitted == 'end' else 0].load:g} N"
        note += ": give it as friction.shear_strength to runs to compare"
    if strength is not None and math.isfinite(limit) and strength > limit:
        formula = "H/√α" if study.friction.junction_growth else "H/(3√3)"
        note += f"; beyond what the softer body bears, {formula} = {limit:.3g} MPa"
    return Row("shear strength", "shear_strength_MPa", strength, digits=3, note=note)


def _strengths(coefficient: float, strengths: dict[str, float]) -> Row:
    """Declare the shear strengths that would give the coefficient with other areas."""
    key = "shear_strength_MPa_for_reference"
    if not strengths:
        return Row("", key, strengths)
    text = shown({"at the end": strengths["contact_end"], "at the start": strengths["contact_initial"]}, 3)
    text += " MPa of the area in contact"
    if "hardness" in strengths:
        text += f"; of contact.hardness, H/(3√3), {strengths['hardness']:.3g} MPa"
    return Row(f"that for CoF {coefficient:g}", key, strengths, sentence=text)


def _film(result: ResultFile) -> list[Row]:
    """Declare what shear leaves of the hardness where junctions grow, and how a film wore through."""
    study, law, rows = result.study, result.study.friction, []
    if alpha := law.junction_growth:
        (filmed, bare), hardness = study.pair.caps, study.pair.indentation_hardness
        sheared = [
            *entries({"alpha": alpha, "indentation_hardness_MPa": hardness}),
            *([Row("under the film", "hardness_under_film_MPa", filmed)] if law.film else []),
            Row("bare", "hardness_sheared_MPa", bare),
        ]
        text = ", ".join(f"{row.label} {row.number}" for row in sheared if row.label)
        text += f" MPa, of {hardness:g} MPa, by junction growth α = {alpha:g}"
        rows.append(Row("sheared hardness", "junction_growth", sheared, sentence=text))
    if law.film is None:
        return rows
    fraction = result.history["bare_fraction"]
    first, last = (passes.mean_over(result.history, fraction, when, study.laps) for when in passes.WHEN)
    text = f"{shown({'at first': first, 'at the end': last}, 3)} of the area in contact"
    film = [
        *entries({"thickness_nm": 1.0e6 * law.film.thickness, "bodies": law.film.bodies}),
        Row("", "shear_strength_MPa", {"film": law.film.shear_strength, "bare": law.shear_strength}),
        Row("bare of film", "bare_fraction", {"first": first, "end": last}, sentence=text),
        *_fitted(bare_course(result)),
    ]
    return [*rows, Row("", "film", film)]


def _fitted(fit: Breaking | str) -> list[Row]:
    """Declare the fitted course of the bare fraction, with standard errors, or why there is none."""
    if isinstance(fit, str):
        return [Row("", "fit", None), Row("", "no_fit", fit), Row("fitted course", "", f"none: {fit}")]
    constants = [
        Row("plateau", "plateau", fit.plateau, digits=3, error=fit.plateau_error),
        Row("e-folding", "e_folding_mm", fit.length, digits=3, error=fit.length_error),
        Row("from", "start_mm", fit.start, digits=3, note="on"),
        Row("", "rms", fit.rms),
    ]
    return [Row("fitted course", "fit", constants)]


def _checks(result: ResultFile, end: dict[str, float]) -> list[Row]:
    """Declare residuals, conservation, and what the run's own record and its assumptions are."""
    study, residuals = result.study, np.abs(result.history["load_residual"])
    expected = sum(study.wear_coefficients[1] * b.load * b.slides(end["distance"]) for b in study.blocks)
    expected *= study.pair.profiles is None  # K of a layered body is that of no depth alone
    off = {body: _off_archard(end, body) for body in BODIES}
    largest, assumed = float(residuals.max()), study.assumptions
    all_of_them = f"{len(assumed)} in summary.json and 'warpwear show'"
    checks = [
        Row("load residual at most", "", largest, digits=2, unit="N"),
        Row("volumes off Archard's by", "", max(map(abs, off.values())), digits=1),
    ]
    return [
        Row("", "load_residual_N", {"largest": largest, "end": end["load_residual"]}),
        Row("", "conservation_relative", off),
        Row("", "disc_volume_over_KFL", end["wear_volume_disc"] / expected if expected else None),
        Row("checks", "", checks),
        *entries({"notes": [], **result.record}),
        *([Row("", "seconds", result.seconds)] if result.seconds else []),
        Row("assumptions", "assumptions", assumed, sentence=all_of_them),
    ]


def _off_archard(end: dict[str, float], body: str) -> float:
    """Return the relative deviation of worn and pending volume from Archard's; the volume where his is 0."""
    volume = end[f"wear_volume_{body}"] + end.get(f"pending_volume_{body}", 0.0)
    expected = end[f"archard_volume_{body}"]
    return (volume - expected) / expected if expected else volume


def bare_course(result: ResultFile) -> Breaking | str:
    """Return the fitted course of the bare fraction, or half a sentence that says why there is none."""
    return fit_breaking(*course(result, "bare_fraction"))


def _shape(result: ResultFile, name: str) -> dict[str, float] | None:
    """Return how a column grows, as `shape_of_growth`; None under loads that change."""
    return None if result.study.same_load is None else shape_of_growth(*course(result, name)) or None
