"""What the arrangement of a contact adds to a run's summary: track, half-space, patches, pieces, surfaces."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.history.quantities import MEASURES, OF_A_CYCLE
from warpwear.laws.archard import BODIES
from warpwear.laws.depth_profile import DepthProfile, of_materials
from warpwear.laws.fretting import regime_of
from warpwear.laws.passes import WHEN, mean_over
from warpwear.results.evolution import growth_of_view, settling, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.report import finite
from warpwear.results.track import both_directions, course, groove, is_short, roughness_in_track, scar_length

#: Parts of the area in contact that the uppermost layer has no more when it is half worn through, and first.
HALF, LEAST = 0.5, 1.0e-9
#: Rise of the temperature from which it is no longer small [K].
WARM = 20.0
below = lazy.module("warpwear.contact.stress.stresses")
joints = lazy.module("warpwear.history.joint")


def arrangement(result: ResultFile) -> dict[str, Any]:
    """Return what there is of half-space, pieces and patches, and what bodies yield without wear."""
    study = result.study
    stiffness = study.pair.bulk_stiffness if study.pair.uses_bulk_stiffness else study.pair.stiffness
    return {
        "half_space": _half_space(result),
        **({"pieces": _pieces(result)} if study.wear.sheds else {}),
        "patches": _patches(result),
        "foundation_N_per_mm3": finite(stiffness),
        "hertz": _hertz(result),
    }


def track(result: ResultFile) -> dict[str, Any]:
    """Return groove, passes and what was displaced, of a swept run."""
    study, history, layout = result.study, result.history, result.study.track
    first, last = (mean_over(history, history["area_contact"], when, study.laps) for when in WHEN)
    content = {
        "length_mm": layout.cells * layout.cell,
        "pass_mm": layout.stroke,
        "passes": study.passes_at(history["distance"][-1]),
        "shift_cells": layout.shift,
        "area_contact_mm2_of_passes": {"first": first, "last": last},
        "change_by_step": result.record.get("change_by_step"),
        **_directions(result),
        **_groove(result),
        "plastic": study.sliding.plastic,
        "plastic_volume_mm3": float(history["plastic_volume_disc"][-1]),
        **_parts(history),
        **_jumps(result),
    }
    return {"track": content}


def fretting(result: ResultFile) -> dict[str, Any]:
    """Return which places of a stroke had a contact, and the regime, force, energy and slip of cycles."""
    study, history, content = result.study, result.history, dict[str, Any]()
    if not study.sliding.drives_bodies:
        content = {"positions": study.positions, "stroke_over_width": study.stroke_ratio}
    if study.fretting is None:
        return {"fretting": content}
    end = {name: finite(float(values[-1])) for name, values in history.items()}
    energy = float(history["friction_energy"][-1])
    content |= {
        "regime": regime_of(history["stick_area"], history["area_contact"]),
        "tangential_force_N": end["tangential_force"],
        **{f"{name}_mm": end[name] for name in ("displacement", "displacement_border")},
        "stick_area_mm2": end["stick_area"],
        "energy_mJ": end["energy"],
        "energy_ratio": end["energy_ratio"],
        "slip_mean_um": 1.0e3 * history["slip_mean"][-1],
        "energy_total_J": energy,
        "alpha_mm3_per_J": {
            b: float(history[f"wear_volume_{b}"][-1]) / energy if energy else None for b in BODIES
        },
    }
    return {"fretting": content}


def _jumps(result: ResultFile) -> dict[str, Any]:
    """Return the contacts computed of a run whose cycles may stand for many, and the error told."""
    if (jumps := result.record.get("cycle_jump")) is None:
        return {}
    percent = {body: 100.0 * error for body, error in jumps.pop("depth_error").items()}
    return {"jumps": jumps | {"depth_error_percent": percent}}


def _directions(result: ResultFile) -> dict[str, Any]:
    """Return area and friction of both directions of the last cycle; nothing where there is none."""
    numbers = {}
    for key, name in (("area_contact_mm2", "area_contact"), ("cof", "cof")):
        if (way := both_directions(result.study, result.history, name)) is None:
            return {}
        numbers[key] = {"forward": way.forward, "backward": way.backward}
    return {"last_cycle": numbers}


def _groove(result: ResultFile) -> dict[str, Any]:
    """Return the mean section of the groove, its width, its deepest place and its roughness."""
    if not result.snapshot_distances.size:
        return {}
    index = result.snapshot_distances.size - 1
    last = groove(result, index)
    sizes = {"mean_depth_um": 1.0e3 * last.mean_depth, "deepest_um": 1.0e3 * float(last.depth.max())}
    sizes |= {"width_mm": last.width, "section_um2": 1.0e6 * last.section}
    if is_short(result):
        sizes["length_mm"] = scar_length(result, index)
    roughness = {name: values for name, values in roughness_in_track(result).items() if name != "passes"}
    unworn, end = ({name: float(values[at]) for name, values in roughness.items()} for at in (0, -1))
    return {"groove": sizes, "roughness_um": {"unworn": unworn, "end": end}}


def _parts(history: Mapping[str, FloatArray]) -> dict[str, Any]:
    """Return the parts that steps on the half-space were solved in, and what their length may do."""
    if "parts" not in history:
        return {}
    number, most = int(history["parts"].sum()), int(history["parts"].max())
    known = history["area_error"][np.isfinite(history["area_error"])]
    error = float(known.max()) if known.size else None
    return {"parts": {"number": number, "most_of_a_step": most, "estimated_error_at_most": error}}


def _half_space(result: ResultFile) -> dict[str, Any] | None:
    """Return what contacts of half-spaces were solved with, and what certificates say of their pressures."""
    study = result.study
    if study.contact.law != "half-space":
        return None
    transforms = {"median": float(np.median(result.history["evaluations"]))}
    numbers = {"effective_modulus_MPa": study.pair.effective_modulus, "boundary": study.boundary}
    return {**numbers, "transforms": transforms, **_certified(result.history)}


def _certified(history: Mapping[str, FloatArray]) -> dict[str, Any]:
    """Return what the certificates of the pressures say; nothing of a result without them."""
    if "violation" not in history:
        return {}
    known = ~np.isnan(history["violation"])
    certified: dict[str, Any] = {"steps": int(known.sum())}
    for name in ("violation", "energy_gap", "energy_gap_relative"):
        values = history[name][known]
        key = f"{name}_mJ" if name == "energy_gap" else name
        certified[key] = {"end": float(values[-1]), "largest": float(values.max())} if values.size else None
    return {"certified": certified}


def _hertz(result: ResultFile) -> dict[str, Any] | None:
    """Return Hertz's contact of the same bodies before wear, if their elastic constants are known."""
    hertz = result.study.hertz
    if hertz is None:
        return None
    numbers = {
        "effective_modulus_MPa": hertz.modulus,
        "radius_um": 1.0e3 * hertz.radius,
        "area_mm2": hertz.area,
        "peak_pressure_MPa": hertz.peak_pressure,
    }
    if not hertz.is_line:  # whose approach has no absolute zero
        numbers["approach_um"] = 1.0e3 * hertz.approach
    round_one = hertz.radius_across in (None, hertz.counter_radius)  # a ball has one radius
    return numbers | ({} if round_one else {"semi_axes_um": [1.0e3 * axis for axis in hertz.semi_axes]})


def heat(result: ResultFile, cof: float) -> dict[str, Any]:
    """Return how much hotter than the bodies the last contact is, or what is not known of it."""
    distances, slid = result.snapshot_distances, result.history["distance"][-1]
    if not slid:
        return {}
    last = result.snapshot(-1) if distances.size and distances[-1] == slid else None
    hot = joints.flash_of(result.study, last, cof=cof)
    if isinstance(hot, str):
        return {"flash_unknown": hot}
    return {"flash_K": {"largest": hot.largest, "mean": hot.mean}}


def _patches(result: ResultFile) -> dict[str, Any] | None:
    """Return what the patches of a two-scale run are; None for another."""
    study, law = result.study, result.study.patches
    if study.study.model != "two-scale":
        return None
    evaluations = result.history["evaluations"]
    return {
        "number": int(result.load_share.shape[1]),
        "width_um": 1.0e3 * law.patch_width,
        "macro_cell_um": 1.0e3 * law.macro_cell,
        "cover": (law.patch_width / law.macro_cell) ** 2,
        "coupling": law.coupling,
        "bulk": law.bulk if law.coupling == "approach" else "spring",
        "carrying_at_the_end": int(np.count_nonzero(result.load_share[-1])),
        "evaluations": {"median": float(np.median(evaluations)), "most": float(evaluations.max())},
    }


def _pieces(result: ResultFile) -> dict[str, Any]:
    """Return what bodies that wear in pieces have lost by them, and what decides its course."""
    study, law = result.study, result.study.pair.pieces
    assert law is not None
    return {
        "diameter_um": 1.0e3 * law.diameter,
        "thickness_um": 1.0e3 * law.thickness,
        "volume_um3": 1.0e9 * law.volume(study.grid.cell),
        "dust_fraction": law.dust,
        "pending_start": study.wear.pending_start,
        **{body: _pieces_of(result, body) for body in BODIES},
    }


def _pieces_of(result: ResultFile, body: str) -> dict[str, Any]:
    """Return how many pieces have left a body, how often, and how wide they were."""
    study, history, table = result.study, result.history, result.pieces
    speed, distance = study.sliding.speed, float(history["distance"][-1])
    cut = table["diameter"][table["body"] == BODIES.index(body)]
    per_mm = float(history[f"pieces_{body}"].sum()) / distance if distance else 0.0
    return {
        "number": int(cut.size),
        "track_fraction": study.track.track_fraction if body == "disc" and study.is_swept else 1.0,
        "per_mm": per_mm,
        "per_minute": 60.0 * speed * per_mm if speed else None,
        "median_diameter_um": 1.0e3 * float(np.median(cut)) if cut.size else None,
        "pending_mm3": float(history[f"pending_volume_{body}"][-1]),
    }


def surfaces(result: ResultFile) -> dict[str, Any]:
    """Return how rough both bodies are in the inner scar, how that settles, and how large junctions are."""
    study, shares = result.study, surface_evolution(result).table["share_above_critical"]
    critical, diameter, above = study.pair.critical_junction, study.pair.critical_diameter, None
    if diameter is not None and shares.size and np.isfinite(shares[[0, -1]]).all():
        above = {"diameter_um": 1.0e3 * diameter, "first": float(shares[0]), "end": float(shares[-1])}
    junctions = {
        "critical_diameter_um": 1.0e3 * critical if critical else None,
        "strength_MPa": study.pair.junction_strength,
        "share_above": above,
    }
    return {"inner_scar": {b: _inner_scar(result, b) for b in BODIES}, "junctions": junctions}


def _inner_scar(result: ResultFile, body: str) -> dict[str, Any]:
    """Return the roughness of a body at the end and how its course settles."""
    table = surface_evolution(result).table
    last = {name: finite(column[-1]) for name, column in table.items() if column.size}
    sq, sdq, rq = (last.get(f"{name}_{body}") for name in ("sq", "sdq", "rq"))
    unworn, fit = last.get("sq_disc_unworn") if body == "disc" else 0.0, settling(result, body)
    numbers: dict[str, Any] = {"sq_um": sq, "sdq": sdq, "rq_along_um": rq, "sq_unworn_um": unworn}
    grown = growth_of_view(table)
    if isinstance(fit, str):
        numbers |= {"settling": None, "not_settling": fit}
    else:
        length, off = (None, None) if grown else (fit.length, fit.length_error)
        settled: dict[str, Any] = {
            "equilibrium_um": fit.equilibrium,
            "equilibrium_error_um": fit.equilibrium_error,
        }
        settled |= {"running_in_length_mm": length, "running_in_length_error_mm": off}
        settled |= {"no_length": grown} if grown else {}
        numbers["settling"] = settled | {"initial_um": fit.initial, "rms_um": fit.rms}
    wear = result.study.wear
    averaged = body == "counter" and result.study.is_swept and not (wear.sheds and wear.dust_fraction < 1.0)
    if sq is not None and averaged:
        numbers["rq_along_of"] = (
            "the length of a step, which a counter-body that wears as dust is averaged over"
        )
    return numbers


def stresses(result: ResultFile) -> dict[str, Any]:
    """Return the largest stresses below the disc at the last snapshot, and what lies beyond its limits."""
    study = result.study
    if not study.has_stresses or not result.snapshot_distances.size:
        return {}
    table, limit, content = (
        {name: of[-1] for name, of in result.stresses.items()},
        study.pair.yield_strength,
        {},
    )
    for name in (*MEASURES, *(OF_A_CYCLE if study.fatigue else ())):
        at = int(table[name].argmax())
        place = {f"{axis}_mm": float(table[f"{name}_{axis}"][at]) for axis in "xy"}
        place["z_mm"] = float(table["depth"][at])
        content[name] = {"value_MPa": float(table[name].max()), **place}
    if limit is not None:
        content["beyond_yield"] = {
            "yield_strength_MPa": limit,
            "depth_mm": below.deepest(table["depth"], table["mises"], limit),
            "volume_mm3": float(np.trapezoid(table["yielding"], table["depth"])) * study.cells.area,
        }
    return {"stress_below_disc": content}


def layers(result: ResultFile) -> dict[str, Any]:
    """Return the layers of both bodies; nothing where there are none."""
    named = zip(BODIES, result.study.pair.profiles or (), strict=False)
    layered = {f"layers_{body}": _layers_of(result, body, profile) for body, profile in named}
    return {key: numbers for key, numbers in layered.items() if numbers}


def _layers_of(result: ResultFile, body: str, profile: DepthProfile) -> dict[str, Any]:
    history, names = result.history, of_materials(body, profile)
    if not names:
        return {}
    bare = 1.0 - history[names[0][1]] / history["area_contact"]
    distance, contact = course(result, "area_contact")
    named = [*zip(profile.materials, names, strict=True)]
    losses = {material.name: float(history[columns[2]][-1]) for material, columns in named}
    carried = result.study.load_distance(body, float(history["distance"][-1]))
    worn = sum(losses[m.name] / m.wear if m.wear else math.nan for m in profile.materials)
    return {
        "breakthrough_mm": float(history["distance"][np.argmax(bare > LEAST)])
        if bare.max() > LEAST
        else None,
        "half_breakthrough_mm": _first(distance, 1.0 - course(result, names[0][1])[1] / contact),
        "wear_volume_mm3": losses,
        "load_share": {material.name: float(history[columns[0]][-1]) for material, columns in named},
        "volumes_over_K_less_FL": finite(worn / carried - 1.0) if carried else None,
    }


def _first(distance: FloatArray, bare: FloatArray) -> float | None:
    """Return the first distance [mm], between those given, at which half is bare; None where none is."""
    after = int(np.argmax(bare > HALF))
    near = slice(max(after - 1, 0), after + 1)
    return float(np.interp(HALF, bare[near], distance[near])) if bare[after] > HALF else None
