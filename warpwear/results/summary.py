"""What a run amounts to, in one page of numbers."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.rows import Named
from warpwear.laws import friction
from warpwear.laws.film import Breaking, fit_breaking
from warpwear.results.evolution import settling, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import BODIES
from warpwear.results.track import by_pass, groove, roughness_in_track
from warpwear.study import text as render
from warpwear.study.study import Study

#: Columns that change along a track: of a swept run the last step says little.
OF_A_PASS = ("approach", "area_contact", "area_plastic", "pressure_mean", "pressure_std", "cof")
#: A last pass shorter than this part of one is left out of a course: it has not seen the whole track.
WHOLE = 0.9


def summarise(result: ResultFile) -> dict[str, Any]:
    """Scar, depths, volumes, areas, friction, residuals, conservation, assumptions. JSON-ready.

    What goes up and down along a track (approach, cof, areas in contact and at hardness, pressures) is of the
    last pass of a swept run, as `end_values` says: the means, and the largest pressure.
    """
    study, history = result.study, result.history
    end = Named({name: float(values[-1]) for name, values in history.items()})
    for name in OF_A_PASS:
        end[name] = friction.mean_over(history, history[name], "end", study.lap)
    end["pressure_max"] = float(history["pressure_max"][friction.within(history, "end", study.lap)].max())
    sphere, disc = study.wear_coefficients
    load, law = study.contact.load, study.friction.law
    asked = disc * load * end["distance"]
    stiffness = study.bulk_stiffness() if study.uses_bulk_stiffness else study.contact_law().stiffness
    return {
        "name": study.study.name,
        "model": study.study.model,
        **{name: np.asarray(value).item() for name, value in result.attributes.items() if name != "record"},
        "steps": int(history["distance"].size),
        "cell_um": 1.0e3 * study.grid.cell,
        "distance_mm": end["distance"],
        "end_values": "last pass" if study.is_swept else "last step",
        "load_N": load,
        "hardness_MPa": _finite(study.hardness),
        "wear_coefficient_mm3_per_Nm": {"sphere": 1.0e3 * sphere, "disc": 1.0e3 * disc},
        "wear_coefficient_per_Pa": {"sphere": 1.0e-6 * sphere, "disc": 1.0e-6 * disc},
        "scar_mm": {"along": end["patch_along"], "across": end["patch_across"]},
        "approach_um": 1.0e3 * end["approach"],
        "depth_um": {b: 1.0e3 * end[f"wear_depth_{b}"] for b in ("sphere", "disc")},
        "volume_mm3": {b: end[f"wear_volume_{b}"] for b in ("sphere", "disc")},
        "area_mm2": {a: end[f"area_{a}"] for a in ("contact", "plastic", "touched", "cumulative", "nominal")},
        "area_real_over_nominal": end["area_contact"] / end["area_nominal"],
        "pressure_MPa": {p: end[f"pressure_{p}"] for p in ("mean", "std", "max")},
        "pressure_mean_over_steps_MPa": {
            "smallest": float(history["pressure_mean"].min()),
            "largest": float(history["pressure_mean"].max()),
            "std": float(history["pressure_mean"].std()),
        },
        "cof": {
            "first": _finite(friction.mean_over(history, history["cof"], "initial", study.lap)),
            "end": _finite(end["cof"]),
        },
        "cof_input": study.friction.fitted,
        "shear_strength_MPa": _finite(
            law.final_strength(history, load=load, finished=result.finished, lap=study.lap)
        ),
        "shear_strength_of_softer_body_MPa": _finite(study.shear_limit),
        "cof_area": study.friction.area,
        "cof_shape": _shape(*course(result, "cof")),
        "area_shape": _shape(*course(result, f"area_{study.friction.area}")),
        "cof_reference": study.friction.coefficient,
        "shear_strength_MPa_for_reference": law.calibrations(
            history, load=load, hardness=study.indentation_hardness, lap=study.lap
        ),
        "hertz": _elastic(study),
        "foundation_N_per_mm3": _finite(stiffness),
        "half_space": _half_space(result),
        "patches": _patches(result),
        **({"pieces": _pieces(result)} if study.wear.sheds else {}),
        "junctions": {
            "critical_diameter_um": 1.0e3 * study.critical_junction if study.critical_junction else None,
            "strength_MPa": study.junction_strength,
            "share_above": _share_above(result),
        },
        "inner_scar": _inner_scar(result),
        "load_residual_N": {
            "largest": float(np.abs(history["load_residual"]).max()),
            "end": end["load_residual"],
        },
        "conservation_relative": {
            body: _relative(
                end[f"wear_volume_{body}"] + end.get(f"pending_volume_{body}", 0.0),
                end[f"archard_volume_{body}"],
            )
            for body in ("sphere", "disc")
        },
        "disc_volume_over_KFL": end["wear_volume_disc"] / asked if asked else None,
        **_film(result),
        **({"track": _track(result)} if study.is_swept else _on_a_track(result)),
        **_on_filled(result.load_on_filled),
        "notes": [],
        **result.record,
        **({"seconds": result.seconds} if result.seconds else {}),
        "assumptions": render.assumptions(study),
    }


def _on_a_track(result: ResultFile) -> dict[str, Any]:
    """The section of the groove that the disc's wear would be, were it spread over the track of the test.

    A disc that lies still has all of it under the sphere. Nothing where no more than one pass was slid.
    """
    lap, distance = result.study.sliding.lap, float(result.history["distance"][-1])
    if lap is None or distance <= lap:
        return {}
    volume = float(result.history["wear_volume_disc"][-1])
    return {"on_a_track": {"length_mm": lap, "section_um2": 1.0e6 * volume / lap}}


def _on_filled(shares: FloatArray) -> dict[str, Any]:
    """Shares of the load on points that were not measured, (snapshots,); nothing where there are none."""
    if not shares.size:
        return {}
    percent = 100.0 * shares
    return {"load_on_filled_percent": {"end": float(percent[-1]), "largest": float(percent.max())}}


def _film(result: ResultFile) -> dict[str, Any]:
    """What shear leaves of the hardness where junctions grow, and the course of what is bare of a film."""
    study, friction_of = result.study, result.study.friction
    found: dict[str, Any] = {}
    if friction_of.junction_growth:
        filmed, bare = study.caps
        found["junction_growth"] = {
            "alpha": friction_of.junction_growth,
            "indentation_hardness_MPa": study.indentation_hardness,
            "hardness_sheared_MPa": bare,
        } | ({"hardness_under_film_MPa": filmed} if friction_of.film else {})
    if friction_of.film is None:
        return found
    fit = bare_course(result)
    fitted: dict[str, Any] = {"fit": None, "no_fit": fit} if isinstance(fit, str) else {"fit": _of_fit(fit)}
    fraction = result.history["bare_fraction"]
    found["film"] = {
        "thickness_nm": 1.0e6 * friction_of.film.thickness,
        "bodies": friction_of.film.bodies,
        "shear_strength_MPa": {"film": friction_of.film.shear_strength, "bare": friction_of.shear_strength},
        "bare_fraction": {
            "first": friction.mean_over(result.history, fraction, "initial", study.lap),
            "end": friction.mean_over(result.history, fraction, "end", study.lap),
        },
        **fitted,
    }
    return found


def bare_course(result: ResultFile) -> Breaking | str:
    """The fitted course of the bare fraction, or half a sentence that says why there is none."""
    return fit_breaking(*course(result, "bare_fraction"))


def _of_fit(fit: Breaking) -> dict[str, float]:
    """A fitted course, its constants with their standard errors."""
    return {
        "e_folding_mm": fit.length,
        "e_folding_error_mm": fit.length_error,
        "start_mm": fit.start,
        "plateau": fit.plateau,
        "plateau_error": fit.plateau_error,
        "rms": fit.rms,
    }


def _track(result: ResultFile) -> dict[str, Any]:
    """Groove, passes and what was displaced, of a swept run."""
    study, history, track = result.study, result.history, result.study.track
    areas = history["area_contact"]
    found: dict[str, Any] = {
        "length_mm": track.cells * track.cell,
        "pass_mm": track.stroke,
        "passes": float(history["distance"][-1]) / track.stroke,
        "shift_cells": track.shift,
        **_parts(history),
        "plastic": study.sliding.plastic,
        "plastic_volume_mm3": float(history["plastic_volume_disc"][-1]),
        "area_contact_mm2_of_passes": {
            "first": friction.mean_over(history, areas, "initial", study.lap),
            "last": friction.mean_over(history, areas, "end", study.lap),
        },
    }
    if result.snapshot_distances.size:
        last = groove(result, result.snapshot_distances.size - 1)
        found["groove"] = {
            "mean_depth_um": 1.0e3 * last.mean_depth,
            "deepest_um": 1.0e3 * float(last.depth.max()),
            "width_mm": last.width,
            "section_um2": 1.0e6 * last.section,
        }
        roughness = roughness_in_track(result)
        found["roughness_um"] = {
            when: {name: float(values[at]) for name, values in roughness.items() if name != "passes"}
            for when, at in (("unworn", 0), ("end", -1))
        }
    return found


def _parts(history: Mapping[str, FloatArray]) -> dict[str, Any]:
    """The parts that steps on the half-space were solved in, and what their length may do to the area."""
    if "parts" not in history:
        return {}
    parts, error = history["parts"], history["area_error"]
    return {
        "parts": {
            "number": int(parts.sum()),
            "most_of_a_step": int(parts.max()),
            "estimated_error_at_most": float(error.max()),
        }
    }


def shape_of_growth(distance: FloatArray, values: FloatArray) -> dict[str, float]:
    """How a quantity grows with the distance slid.

    exponent: m = d ln(value) / d ln(distance) over the second half (least squares). levelling: λ, the slope
    over the second half by that over 1/80 to 1/10 of the distance (secants). A straight line from the origin
    has 1 and 1, a square root 0.5 and 0.25.
    """
    total = distance[-1]
    late = distance >= 0.5 * total
    far = np.log(distance[late]) - np.log(distance[late]).mean()
    exponent = float((far * np.log(values[late])).sum() / np.square(far).sum())

    def secant(start: float, end: float) -> float:
        low, high = np.interp([start * total, end * total], distance, values)
        return float((high - low) / ((end - start) * total))

    early = secant(1.0 / 80.0, 0.1)
    return {"exponent_m": exponent, "levelling_lambda": secant(0.5, 1.0) / early if early else math.nan}


def course(result: ResultFile, name: str) -> tuple[FloatArray, FloatArray]:
    """Distance [mm] and values of a column: of a swept run the means of its whole passes, whose ends differ
    from their middles, at the middles."""
    history, stroke = result.history, result.study.lap
    if stroke is None or history["distance"][-1] == 0.0:  # at rest, or a static contact
        return history["distance"], history[name]
    passes = by_pass(result, *(() if name == "distance" else (name,)))  # whose distances are its own
    slid = passes["distance"]
    places = np.cumsum(slid) - 0.5 * slid
    passes["distance"] = places
    whole = slice(None, -1 if slid.size > 1 and slid[-1] < WHOLE * stroke else None)
    return places[whole], passes[name][whole]


def _shape(distance: FloatArray, values: FloatArray) -> dict[str, float] | None:
    """How a quantity grows, as `shape_of_growth`.

    None for too few steps, for a late start, and for values that are not known or, late, not positive.
    """
    if distance.size < 20 or distance[0] > distance[-1] / 80.0:
        return None
    if not (np.isfinite(values).all() and np.all(values[distance >= 0.5 * distance[-1]] > 0.0)):
        return None
    found = shape_of_growth(distance, values)
    return {k: v for k, v in found.items() if math.isfinite(v)}


def _elastic(study: Study) -> dict[str, float] | None:
    """Hertz's contact of the same bodies before wear, if their elastic constants are known."""
    hertz = study.hertz
    if hertz is None:
        return None
    return {
        "effective_modulus_MPa": hertz.modulus,
        "radius_um": 1.0e3 * hertz.radius,
        "area_mm2": hertz.area,
        "peak_pressure_MPa": hertz.peak_pressure,
        "approach_um": 1.0e3 * hertz.approach,
    }


def _patches(result: ResultFile) -> dict[str, Any] | None:
    """What the patches of a two-scale run are; None for another."""
    study = result.study
    if study.study.model != "two-scale":
        return None
    evaluations = result.history["evaluations"]
    return {
        "number": int(result.load_share.shape[1]),
        "width_um": 1.0e3 * study.patches.patch_width,
        "macro_cell_um": 1.0e3 * study.patches.macro_cell,
        "cover": (study.patches.patch_width / study.patches.macro_cell) ** 2,
        "coupling": study.patches.coupling,
        "bulk": study.patches.bulk if study.patches.coupling == "approach" else "spring",
        "carrying_at_the_end": int(np.count_nonzero(result.load_share[-1])),
        "evaluations": {"median": float(np.median(evaluations)), "most": float(evaluations.max())},
    }


def _pieces(result: ResultFile) -> dict[str, Any]:
    """What bodies that wear in pieces have lost by them, and what the course of such a run hangs on."""
    study, history, asked = result.study, result.history, result.study.pieces
    assert asked is not None
    table, speed, distance = result.pieces, study.sliding.speed, float(history["distance"][-1])
    found: dict[str, Any] = {
        "diameter_um": 1.0e3 * asked.diameter,
        "thickness_um": 1.0e3 * asked.thickness,
        "volume_um3": 1.0e9 * asked.volume(study.grid.cell),
        "dust_fraction": asked.dust,
        "pending_start": study.wear.pending_start,
    }
    for number, body in enumerate(("sphere", "disc")):
        per_mm = float(history[f"pieces_{body}"].sum()) / distance if distance else 0.0
        cut = table["diameter"][table["body"] == number]
        found[body] = {
            "number": int(cut.size),
            "track_fraction": study.track.track_fraction if body == "disc" and study.is_swept else 1.0,
            "per_mm": per_mm,
            "per_minute": 60.0 * speed * per_mm if speed else None,
            "median_diameter_um": 1.0e3 * float(np.median(cut)) if cut.size else None,
            "pending_mm3": float(history[f"pending_volume_{body}"][-1]),
        }
    return found


def _share_above(result: ResultFile) -> dict[str, float] | None:
    """The part of the area in contact in junctions above d*, at the first and the last snapshot, and d*."""
    diameter, shares = (
        result.study.critical_diameter,
        surface_evolution(result).table["share_above_critical"],
    )
    if diameter is None or not shares.size or not np.isfinite(shares[[0, -1]]).all():
        return None
    return {"diameter_um": 1.0e3 * diameter, "first": float(shares[0]), "end": float(shares[-1])}


def _inner_scar(result: ResultFile) -> dict[str, Any]:
    """Roughness of both bodies at the end and how its course settles."""
    last = {
        name: _finite(column[-1]) for name, column in surface_evolution(result).table.items() if column.size
    }
    found: dict[str, Any] = {}
    for body in BODIES:
        fit = settling(result, body)
        unworn = last.get("sq_disc_unworn") if body == "disc" else 0.0
        ends = {"sq_um": f"sq_{body}", "sdq": f"sdq_{body}", "rq_along_um": f"rq_{body}"}
        found[body] = (
            {key: last.get(name) for key, name in ends.items()}
            | {"sq_unworn_um": unworn}
            | (
                {"settling": None, "not_settling": fit}
                if isinstance(fit, str)
                else {
                    "settling": {
                        "equilibrium_um": fit.equilibrium,
                        "equilibrium_error_um": fit.equilibrium_error,
                        "running_in_length_mm": fit.length,
                        "running_in_length_error_mm": fit.length_error,
                        "initial_um": fit.initial,
                        "rms_um": fit.rms,
                    }
                }
            )
        )
    return found


def _half_space(result: ResultFile) -> dict[str, Any] | None:
    """What contacts of half-spaces were solved with; None for another law."""
    study = result.study
    if study.contact.law != "half-space":
        return None
    return {
        "effective_modulus_MPa": study.effective_modulus,
        "boundary": study.boundary,
        "transforms": {"median": float(np.median(result.history["evaluations"]))},
        **_certified(result.history),
    }


def _certified(history: Mapping[str, FloatArray]) -> dict[str, Any]:
    """What the certificates of the pressures say; nothing of a result without them."""
    if "violation" not in history:
        return {}
    there = ~np.isnan(history["violation"])
    found: dict[str, Any] = {"steps": int(there.sum())}
    for name in ("violation", "energy_gap", "energy_gap_relative"):
        values = history[name][there]
        key = f"{name}_mJ" if name == "energy_gap" else name
        found[key] = {"end": float(values[-1]), "largest": float(values.max())} if values.size else None
    return {"certified": found}


def _relative(value: float, expected: float) -> float:
    return (value - expected) / expected if expected else value


def _finite(value: float) -> float | None:
    """JSON has no infinity and no NaN."""
    return float(value) if math.isfinite(value) else None
