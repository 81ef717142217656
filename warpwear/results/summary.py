"""What a run amounts to, each number declared once: as JSON has it, and as people read it."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.distances import with_unit
from warpwear.history.end_values import Summary
from warpwear.history.rows import Named
from warpwear.history.verdict import sides_of, verdict_of
from warpwear.laws import passes
from warpwear.laws.archard import BODIES
from warpwear.laws.courses import Breaking, fit_breaking
from warpwear.laws.elastic import asperities
from warpwear.results import summary_models
from warpwear.results.evolution import surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.report import finite, shown
from warpwear.results.track import course, shape_of_growth

#: Columns that change along a track: of a swept run their last value says little.
OF_A_PASS = ("approach", "area_contact", "area_plastic", "pressure_mean", "pressure_std", "cof")
#: What the details leave to summary.json: sentences, told elsewhere, and what made the run.
UNTOLD = ("verdict", "warnings", "notes", "assumptions", "surface", "files", "made_with", "seconds")


def summarise(result: ResultFile) -> dict[str, Any]:
    """Return what summary.json says: verdict, scar, depths, volumes, areas, friction, checks, assumptions.

    Of a swept run, values that go up and down along the track (approach, cof, areas in contact and at
    hardness, pressures) are means over what `end_values` names, mostly the last cycle; the largest
    pressure is the largest there. All this is made once; the seconds that the run took come later.
    """
    content = result.once(_content)
    return content | {"seconds": result.seconds} if result.seconds else content


def summary_text(content: Mapping[str, Any]) -> str:
    """Write all numbers for people, a line a name of summary.json. content: as of `summarise`."""
    slid = f"{with_unit(content['distance_mm'])} slid in {content['steps']} steps"
    told = {key: value for key, value in content.items() if key not in UNTOLD}
    told |= {f"block {block['number']}": block for block in content.get("blocks", ())}
    verdict, assumed = content["verdict"]["text"], len(content["assumptions"])
    lines = [f"{content['name']}: {slid}, {content['elapsed_s']:.1f} s", f"  verdict: {verdict}"]
    return "\n".join([*lines, *_lines(told), f"  assumptions: {assumed}, see 'warpwear show'"])


def _lines(content: Mapping[str, Any], above: str = "") -> Iterator[str]:
    """Write a line for each mapping of numbers, and one for those beside them."""
    deep = {key: value for key, value in content.items() if isinstance(value, Mapping)}
    flat = {k: v for k, v in content.items() if k not in deep and v is not None and not isinstance(v, list)}
    if flat:
        yield f"  {above.removesuffix('.') or 'run'}: {shown(flat)}"
    for key, value in deep.items():
        yield from _lines(value, f"{above}{key}.")


def _content(result: ResultFile) -> dict[str, Any]:
    """Make all but the seconds."""
    study, end = result.study, last_values(result)
    content = {
        **_run(result, end),
        **_blocks(result),
        **_contact(result, end),
        **({} if study.is_swept or study.fretting else _of_one_spot(result)),
        "asperities": _asperities(result),
        **summary_models.surfaces(result),
        **(summary_models.track(result) if study.is_swept else {}),
        **(summary_models.fretting(result) if study.sliding.frets else {}),
        **summary_models.arrangement(result),
        **_friction(result, end),
        **summary_models.heat(result, end["cof"]),
        **summary_models.stresses(result),
        **_film(result),
        **summary_models.layers(result),
        **_checks(result, end),
    }
    if (rise := content.get("flash_K", {}).get("largest", 0.0)) >= summary_models.WARM:
        hot = f"The contact gets {rise:.2g} K hotter at most, which is no longer small"
        content["warnings"].append(f"{hot}: hardness, friction and wear are those of room temperature.")
    return {"verdict": vars(verdict_of(study, Summary.of(content), result.history)), **content}


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


def _run(result: ResultFile, end: dict[str, float]) -> dict[str, Any]:
    """Return what was run, and its main inputs."""
    study = result.study
    coefficients = dict(zip(BODIES, study.wear_coefficients, strict=True))
    return {
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


def _blocks(result: ResultFile) -> dict[str, Any]:
    """Return what each block of a programme wore, and its mean friction; nothing without a programme."""
    history, rows = result.history, list[dict[str, Any]]()
    if result.study.block is None:
        return {}
    for block in result.study.blocks:
        steps = np.flatnonzero(history["block"] == block.number)
        if not steps.size:  # of a run that was stopped before
            break
        before, last = steps[0] - 1, steps[-1]
        worn = {b: history[f"wear_volume_{b}"] for b in BODIES}
        mean = float(np.average(history["cof"][steps], weights=history["increment"][steps]))
        row = {
            "number": len(rows) + 1,
            "load_N": block.load,
            "distance_mm": min(block.end, float(history["distance"][last])) - block.start,
            "steps": int(steps.size),
            "volume_mm3": {b: float(v[last] - (v[before] if before >= 0 else 0.0)) for b, v in worn.items()},
            "depth_um": {b: 1.0e3 * float(history[f"wear_depth_{b}"][last]) for b in BODIES},
            "cof_mean": finite(mean),
        }
        if circles := result.study.circles:
            row["track_radius_mm"] = circles[result.study.circle_of(block)]
        rows.append(row)
    return {"blocks": rows}


def _contact(result: ResultFile, end: dict[str, float]) -> dict[str, Any]:
    """Return scar, areas, pressures and wear."""
    means, strip, areas = result.history["pressure_mean"], result.study.strip, {}
    for name in ("contact", "plastic", "touched", "cumulative", "nominal"):
        areas[name] = end[f"area_{name}"]
    volumes = {b: end[f"wear_volume_{b}"] for b in BODIES}
    of_steps = {"smallest": float(means.min()), "largest": float(means.max()), "std": float(means.std())}
    content = {
        "scar_mm": {way: end[f"patch_{way}"] for way in ("along", "across")},
        "approach_um": 1.0e3 * end["approach"],
        "area_mm2": areas,
        "area_real_over_nominal": areas["contact"] / areas["nominal"],
        "contact_sides": _sides(result),
        **_on_filled(result.load_on_filled),
        "pressure_MPa": {name: end[f"pressure_{name}"] for name in ("mean", "std", "max")},
        **_above_hardness(result),
        "pressure_mean_over_steps_MPa": of_steps,
        "depth_um": {b: 1.0e3 * end[f"wear_depth_{b}"] for b in BODIES},
        "volume_mm3": volumes,
    }
    of_line = {body: volume / strip for body, volume in volumes.items()} if strip else None
    return content | ({"volume_mm3_per_mm": of_line} if of_line else {})


def _sides(result: ResultFile) -> int | None:
    """Count the sides of the last contact; None where it is no set of cells, or was not kept."""
    study, distances = result.study, result.snapshot_distances
    if study.study.model == "two-scale" or study.uses_bearing_area or not distances.size:
        return None
    if distances[-1] != result.history["distance"][-1]:
        return None
    return sides_of(result.snapshot(-1).pressure > 0.0)


def _above_hardness(result: ResultFile) -> dict[str, Any]:
    """Return how far pressures of a bearing area exceed the hardness, by the balance's tolerance."""
    study, most = result.study, float(result.history["pressure_max"].max())
    percent = 100.0 * (most / study.hardness - 1.0)
    return {"pressure_above_hardness_percent": percent} if study.uses_bearing_area and percent >= 0.1 else {}


def _on_filled(fractions: FloatArray) -> dict[str, Any]:
    """Return the part of the load on points that were not measured. fractions: one a snapshot, or none."""
    percent = 100.0 * fractions
    ends = {"end": float(percent[-1]), "largest": float(percent.max())} if percent.size else {}
    return {"load_on_filled_percent": ends} if ends else {}


def _of_one_spot(result: ResultFile) -> dict[str, Any]:
    """Return the groove that wear of more than one pass would be, were it spread over the test's track.

    A disc that lies still has all of it under the counter-body.
    """
    laps, distance = {p.sliding.lap for p in result.study.parts}, float(result.history["distance"][-1])
    lap = laps.pop() if len(laps) == 1 else None  # blocks may differ in it
    if lap is None or distance <= lap:
        return {}
    section = 1.0e6 * float(result.history["wear_volume_disc"][-1]) / lap
    return {"on_a_track": {"length_mm": lap, "section_um2": section}}


def _asperities(result: ResultFile) -> dict[str, Any] | None:
    """Return H/(E*·rms slope) of the disc, and how its asperities yield; None where it is smooth."""
    slope, hardness = result.record["surface"].get("on_the_grid", {}).get("rms_slope"), result.study.hardness
    if not slope or hardness == math.inf:
        return None
    ratio, kind = asperities(hardness, result.study.pair.effective_modulus, slope)
    return {"slope_ratio": ratio, "kind": kind}


def _friction(result: ResultFile, end: dict[str, float]) -> dict[str, Any]:
    """Return friction: its course and energy, its shear strength, and those that other areas would need."""
    study, history, section = result.study, result.history, result.study.friction
    law, load, laps = section.law_with(), history["load"], study.laps
    first = finite(passes.mean_over(history, history["cof"], "initial", laps))
    others = law.calibrations(history, load=load, hardness=study.pair.indentation_hardness, laps=laps)
    return {
        "cof": {"first": first, "end": finite(end["cof"])},
        "cof_input": section.fitted,
        "shear_strength_MPa": finite(end["shear_strength"]),
        "shear_strength_of_softer_body_MPa": finite(study.pair.shear_limit),
        "cof_area": section.area if law.strengths else None,
        "cof_shape": _shape(result, "cof"),
        "area_shape": _shape(result, f"area_{section.area}"),
        "cof_reference": section.coefficient if section.fitted != "states" else None,
        "shear_strength_MPa_for_reference": others,
        **({"friction_energy_J": finite(end["friction_energy"])} if end["distance"] else {}),
    }


def _film(result: ResultFile) -> dict[str, Any]:
    """Return what shear leaves of the hardness where junctions grow, and how a film wore through."""
    study, law, content = result.study, result.study.friction, dict[str, Any]()
    if alpha := law.junction_growth:
        (filmed, bare), hardness = study.pair.caps, study.pair.indentation_hardness
        content["junction_growth"] = {
            "alpha": alpha,
            "indentation_hardness_MPa": hardness,
            **({"hardness_under_film_MPa": filmed} if law.film else {}),
            "hardness_sheared_MPa": bare,
        }
    if law.film is None:
        return content
    fraction = result.history["bare_fraction"]
    first, last = (passes.mean_over(result.history, fraction, when, study.laps) for when in passes.WHEN)
    content["film"] = {
        "thickness_nm": 1.0e6 * law.film.thickness,
        "bodies": law.film.bodies,
        "shear_strength_MPa": {"film": law.film.shear_strength, "bare": law.shear_strength},
        "bare_fraction": {"first": first, "end": last},
        **_fitted(bare_course(result)),
    }
    return content


def _fitted(fit: Breaking | str) -> dict[str, Any]:
    """Return the fitted course of the bare fraction, with standard errors, or why there is none."""
    if isinstance(fit, str):
        return {"fit": None, "no_fit": fit}
    numbers = {"plateau": fit.plateau, "plateau_error": fit.plateau_error}
    numbers |= {"e_folding_mm": fit.length, "e_folding_error_mm": fit.length_error}
    return {"fit": numbers | {"start_mm": fit.start, "rms": fit.rms}}


def _checks(result: ResultFile, end: dict[str, float]) -> dict[str, Any]:
    """Return residuals, conservation, and what the run's own record and its assumptions are."""
    study, residuals = result.study, np.abs(result.history["load_residual"])
    expected = sum(study.wear_coefficients[1] * b.load * b.slides(end["distance"]) for b in study.blocks)
    expected *= study.pair.profiles is None  # K of a layered body is that of no depth alone
    return {
        "load_residual_N": {"largest": float(residuals.max()), "end": end["load_residual"]},
        "conservation_relative": {body: _off_archard(end, body) for body in BODIES},
        "disc_volume_over_KFL": end["wear_volume_disc"] / expected if expected else None,
        "notes": [],
        **result.record,
        "warnings": [*result.record["warnings"], *surface_evolution(result).warnings],
        "assumptions": study.assumptions,
    }


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
