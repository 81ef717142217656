"""What the arrangement of a contact adds to a run's summary: track, half-space, patches, pieces, surfaces."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.history.distances import with_unit
from warpwear.history.quantities import BY_NAME, MEASURES, OF_A_CYCLE
from warpwear.laws.archard import BODIES, CALLED
from warpwear.laws.depth_profile import DepthProfile, of_materials
from warpwear.laws.fretting import HONEST_MEAN, regime_of
from warpwear.laws.passes import WHEN, mean_over
from warpwear.results.evolution import growth_of_view, settling, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.report import Row, entries, finite, record, shown
from warpwear.results.track import both_directions, course, groove, is_short, roughness_in_track, scar_length

#: Parts of the area in contact that the uppermost layer has no more when it is half worn through, and first.
HALF, LEAST = 0.5, 1.0e-9
below = lazy.module("warpwear.contact.stress.stresses")


def arrangement(result: ResultFile) -> list[Row]:
    """Declare half-space, pieces and patches, and what bodies yield without wear."""
    study = result.study
    stiffness = study.pair.bulk_stiffness if study.pair.uses_bulk_stiffness else study.pair.stiffness
    patches = _patches(result)
    on_springs = study.study.model == "macro" or bool(patches.value and patches.value["bulk"] == "spring")
    return [
        _half_space(result),
        *([_pieces(result)] if study.wear.sheds else []),
        patches,
        Row("foundation" * on_springs, "foundation_N_per_mm3", finite(stiffness), note="to begin with"),
        _hertz(result, is_line=on_springs),
    ]


def track(result: ResultFile) -> list[Row]:
    """Declare groove, passes and what was displaced, of a swept run."""
    study, history, layout = result.study, result.history, result.study.track
    first, last = (mean_over(history, history["area_contact"], when, study.laps) for when in WHEN)
    passes, displaced = study.passes_at(history["distance"][-1]), history["plastic_volume_disc"][-1]
    areas = {"first": first, "last": last}
    rows = [
        *entries({"length_mm": layout.cells * layout.cell, "pass_mm": layout.stroke}),
        Row("passes", "passes", passes, note=f", area in contact {shown(areas)} mm²"),
        *entries({"shift_cells": layout.shift, "area_contact_mm2_of_passes": areas}),
        Row("", "change_by_step", result.record.get("change_by_step")),
        *_directions(result),
        *_groove(result),
        Row("", "plastic", study.sliding.plastic),
        Row("displaced", "plastic_volume_mm3", float(displaced)),
        *_parts(history),
        *_jumps(result),
    ]
    return [Row("", "track", rows)]


def fretting(result: ResultFile) -> list[Row]:
    """Declare which places of a stroke had a contact, and the regime, force, energy and slip of cycles."""
    study, history = result.study, result.history
    rows = []
    if not study.sliding.drives_bodies:
        places, ratio = study.positions, study.stroke_ratio
        text = f"{'one contact for all places' if places == 'mean' else 'each cell'} of a stroke"
        text += f", which is {ratio:.2g} of the scar's width (mean: up to {HONEST_MEAN:g})"
        rows += [Row("positions", "positions", places, sentence=text), Row("", "stroke_over_width", ratio)]
    if study.fretting is None:
        return [Row("", "fretting", rows)]
    end = {name: finite(float(values[-1])) for name, values in history.items()}
    regime = regime_of(history["stick_area"], history["area_contact"])
    energy = float(history["friction_energy"][-1])
    alpha = {b: float(history[f"wear_volume_{b}"][-1]) / energy if energy else None for b in BODIES}
    force = f"Q {shown(end['tangential_force'])} N"
    if study.fretting.has_displacement:
        drive, border = (1.0e3 * history[name][-1] for name in ("displacement", "displacement_border"))
        force += f", Δ {drive:.4g} µm; all slips from {border:.4g} µm on"
    sticking = f"({shown(100.0 * sticks(history))} % of the area sticks)"
    rows += [
        Row("regime", "regime", regime, note=sticking),
        Row("last cycle", "tangential_force_N", end["tangential_force"], sentence=force),
        *entries({f"{name}_mm": end[name] for name in ("displacement", "displacement_border")}),
        Row("", "stick_area_mm2", end["stick_area"]),
        Row("energy of it", "energy_mJ", end["energy"], unit="mJ"),
        Row("", "energy_ratio", end["energy_ratio"]),
        Row("mean slip of it", "slip_mean_um", 1.0e3 * history["slip_mean"][-1]),
        Row("energy in all", "energy_total_J", energy),
        Row("wear by energy", "alpha_mm3_per_J", alpha, unit="mm³/J"),
    ]
    return [Row("", "fretting", rows)]


def sticks(history: Mapping[str, FloatArray]) -> float:
    """Return the part of the area in contact that does not slip in the last cycle."""
    return float(history["stick_area"][-1] / history["area_contact"][-1])


def _jumps(result: ResultFile) -> list[Row]:
    """Declare the contacts computed of a run whose cycles may stand for many, and the error told."""
    if (jumps := result.record.get("cycle_jump")) is None:
        return []
    percent = {body: 100.0 * error for body, error in jumps.pop("depth_error").items()}
    text = f"{jumps['contacts']} steps computed for the {jumps['contacts_of_every_cycle']} of "
    text += f"{jumps['cycles']:.6g} cycles; error of the depths {shown(percent, 2)} %"
    if result.history["cycles"].max() == 1.0:
        text = f"none: each of the {jumps['cycles']:.6g} cycles was computed"
        if result.study.contact.law == "local" and result.study.pair.stiffness == math.inf:
            text += "; by contact.law = 'local' without a stiffness the area goes with what a step wears"
    return [Row("jumps", "jumps", jumps | {"depth_error_percent": percent}, sentence=text)]


def _directions(result: ResultFile) -> list[Row]:
    """Declare area and friction of both directions of the last cycle; nothing where there is none."""
    numbers = {}
    for key, name in (("area_contact_mm2", "area_contact"), ("cof", "cof")):
        if (way := both_directions(result.study, result.history, name)) is None:
            return []
        numbers[key] = {"forward": way.forward, "backward": way.backward}
    text = f"area in contact {shown(numbers['area_contact_mm2'])} mm², friction {shown(numbers['cof'], 3)}"
    return [Row("directions", "last_cycle", numbers, sentence=text)]


def _groove(result: ResultFile) -> list[Row]:
    """Declare the mean section of the groove, its width, its deepest place and its roughness."""
    if not result.snapshot_distances.size:
        return []
    last = groove(result, result.snapshot_distances.size - 1)
    section, deepest = 1.0e6 * last.section, 1.0e3 * float(last.depth.max())
    sizes = {"mean_depth_um": 1.0e3 * last.mean_depth, "deepest_um": deepest}
    sizes |= {"width_mm": last.width, "section_um2": section}
    called, of_what, text = "groove", "mean", ""
    if is_short(result):
        called, of_what = "scar of the disc", "middle"
        sizes["length_mm"] = scar_length(result, result.snapshot_distances.size - 1)
        text = f"{sizes['length_mm']:.3g} mm long, "
    text += f"{of_what} section {section:.4g} µm², {last.width:.3g} mm wide"
    text += f", {of_what} profile {deepest:.3g} µm deep at most"
    roughness = {name: values for name, values in roughness_in_track(result).items() if name != "passes"}
    unworn, end = ({name: float(values[at]) for name, values in roughness.items()} for at in (0, -1))
    return [
        Row(called, "groove", sizes, sentence=text),
        Row("", "roughness_um", {"unworn": unworn, "end": end}),
    ]


def _parts(history: Mapping[str, FloatArray]) -> list[Row]:
    """Declare the parts that steps on the half-space were solved in, and what their length may do."""
    if "parts" not in history:
        return []
    number, known = int(history["parts"].sum()), history["area_error"][np.isfinite(history["area_error"])]
    least, most = int(history["parts"].min()), int(history["parts"].max())
    error = float(known.max()) if known.size else None
    numbers = {"number": number, "most_of_a_step": most, "estimated_error_at_most": error}
    text = f"{f'{least} to ' * (least < most)}{most}"  # a row of the history may stand for many steps
    if error is None:
        text += "; how much their length changes the area was not measured"
    else:
        text += f"; by estimate their length changes the area by at most {100.0 * error:.2g} %"
    return [Row("parts of a step", "parts", numbers, sentence=text)]


def _half_space(result: ResultFile) -> Row:
    """Declare what contacts of half-spaces were solved with, and what certificates say of their pressures."""
    study = result.study
    if study.contact.law != "half-space":
        return Row("", "half_space", None)
    transforms, modulus = float(np.median(result.history["evaluations"])), study.pair.effective_modulus
    numbers: dict[str, Any] = {"effective_modulus_MPa": modulus, "boundary": study.boundary}
    rows = entries(numbers | {"transforms": {"median": transforms}, **_certified(result.history)})
    text = f"E* {shown(1e-3 * (modulus or 0.0))} GPa, {study.boundary}"
    text += f"; {transforms:g} pairs of Fourier transforms a step in the median"
    return Row("half-space", "half_space", rows, sentence=text)


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


def _hertz(result: ResultFile, *, is_line: bool) -> Row:
    """Declare Hertz's contact of the same bodies before wear, if their elastic constants are known."""
    hertz = result.study.hertz
    if hertz is None:
        return Row("", "hertz", None)
    rows = [
        Row("", "effective_modulus_MPa", hertz.modulus),
        Row("half width" if hertz.is_line else "radius", "radius_um", 1.0e3 * hertz.radius, digits=3),
        Row("", "area_mm2", hertz.area),
        Row("peak", "peak_pressure_MPa", hertz.peak_pressure),
    ]
    if not hertz.is_line:  # whose approach has no absolute zero
        rows.append(Row("approach", "approach_um", 1.0e3 * hertz.approach, digits=3))
    if hertz.radius_across not in (None, hertz.counter_radius):  # a ball has one radius
        rows.append(Row("", "semi_axes_um", [1.0e3 * axis for axis in hertz.semi_axes]))
    return Row("Hertz, unworn", "hertz", rows) if is_line else Row("", "hertz", record(rows))


def _patches(result: ResultFile) -> Row:
    """Declare what the patches of a two-scale run are; None for another."""
    study, law = result.study, result.study.patches
    if study.study.model != "two-scale":
        return Row("", "patches", None)
    evaluations, cover = result.history["evaluations"], (law.patch_width / law.macro_cell) ** 2
    median, by_approach = float(np.median(evaluations)), law.coupling == "approach"
    number, bulk = int(result.load_share.shape[1]), law.bulk if by_approach else "spring"
    width, cell = 1.0e3 * law.patch_width, 1.0e3 * law.macro_cell
    patches: dict[str, Any] = {"number": number, "width_um": width, "macro_cell_um": cell}
    patches |= {
        "cover": cover,
        "coupling": law.coupling,
        "bulk": bulk,
        "carrying_at_the_end": int(np.count_nonzero(result.load_share[-1])),
        "evaluations": {"median": median, "most": float(evaluations.max())},
    }
    covered = "all" if cover == 1.0 else f"{100.0 * cover:.3g} %"
    spring = "a bulk spring each" if bulk == "spring" else "no bulk spring"
    shared = f"one approach, {spring}" if by_approach else "loads as a smooth contact says"
    iterations = "" if study.contact.law == "half-space" else f"; {median:g} iterations in the median"
    text = f"{number} of {width:g} µm in macro cells of {cell:g} µm "
    return Row("patches", "patches", patches, sentence=f"{text}({covered} of the area), {shared}{iterations}")


def _pieces(result: ResultFile) -> Row:
    """Declare what bodies that wear in pieces have lost by them, and what decides its course."""
    study, law = result.study, result.study.pair.pieces
    assert law is not None
    diameter, thickness = 1.0e3 * law.diameter, 1.0e3 * law.thickness
    volume, pending = 1.0e9 * law.volume(study.grid.cell), study.wear.pending_start
    start = "nothing pending" if pending == "zero" else "pending at random"
    decides = (
        f"diameter d* {diameter:.3g} µm and thickness t {thickness:.3g} µm of a piece, "
        f"dust {100.0 * law.dust:.3g} %, start {pending} ({start}): inputs that move distances severalfold"
    )
    size = f"{diameter:.3g} µm wide and {thickness:.3g} µm thick, {volume:.3g} µm³"
    rows = [
        Row("pieces", "", size),
        *entries({"diameter_um": diameter, "thickness_um": thickness, "volume_um3": volume}),
        *entries({"dust_fraction": law.dust, "pending_start": pending}),
        *(_pieces_of(result, body) for body in BODIES),
        Row("decided by", "", decides),
    ]
    return Row("", "pieces", rows)


def _pieces_of(result: ResultFile, body: str) -> Row:
    """Declare how many pieces have left a body, how often, and how wide they were."""
    study, history, table = result.study, result.history, result.pieces
    speed, distance = study.sliding.speed, float(history["distance"][-1])
    cut = table["diameter"][table["body"] == BODIES.index(body)]
    part = study.track.track_fraction if body == "disc" and study.is_swept else 1.0
    per_mm = float(history[f"pieces_{body}"].sum()) / distance if distance else 0.0
    per_minute = 60.0 * speed * per_mm if speed else None
    numbers = {
        "number": int(cut.size),
        "track_fraction": part,
        "per_mm": per_mm,
        "per_minute": per_minute,
        "median_diameter_um": 1.0e3 * float(np.median(cut)) if cut.size else None,
        "pending_mm3": float(history[f"pending_volume_{body}"][-1]),
    }
    rate = "" if per_minute is None else f", {per_minute:.3g} a minute"
    on_a_part = "" if part == 1.0 else f" on {100.0 * part:.3g} % of the stroke"
    text = f"{cut.size}{on_a_part}, {per_mm:.3g} per mm of sliding{rate}{', on all of it' * bool(on_a_part)}"
    return Row(f"off the {CALLED[body]}", body, numbers, sentence=text)


def surfaces(result: ResultFile) -> list[Row]:
    """Declare how rough both bodies are in the inner scar, how that settles, and how large junctions are."""
    study, shares = result.study, surface_evolution(result).table["share_above_critical"]
    critical, diameter = study.pair.critical_junction, study.pair.critical_diameter
    above, text = None, ""
    if diameter is not None and shares.size and np.isfinite(shares[[0, -1]]).all():
        above = {"diameter_um": 1.0e3 * diameter, "first": float(shares[0]), "end": float(shares[-1])}
        text = f"{100.0 * above['end']:.3g} % of the area in contact (first {100.0 * above['first']:.3g} %)"
        text += f", d* {above['diameter_um']:.3g} µm"
    junctions = [
        Row("", "critical_diameter_um", 1.0e3 * critical if critical else None),
        Row("", "strength_MPa", study.pair.junction_strength),
        Row("junctions over d*", "share_above", above, sentence=text),
    ]
    return [Row("", "inner_scar", [_inner_scar(result, b) for b in BODIES]), Row("", "junctions", junctions)]


def _inner_scar(result: ResultFile, body: str) -> Row:
    """Declare the roughness of a body at the end and how its course settles."""
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
    if sq is None:
        return Row("", body, numbers)
    text = f"Sq {sq:.3g} µm" + (f" of {unworn:.3g} µm unworn" if unworn else "")
    text += f", Sdq {shown(sdq, 2)}"
    wear = result.study.wear
    if body == "counter" and result.study.is_swept and not (wear.sheds and wear.dust_fraction < 1.0):
        of = "the length of a step, which a counter-body that wears as dust is averaged over"
        numbers["rq_along_of"] = of
    else:
        text += f", along sliding Rq {shown(rq, 3)} µm"  # not known between patches
    if not isinstance(fit, str):
        way = f"({grown})" if grown else f"over {fit.length:.3g} ± {float(f'{fit.length_error:.2g}'):g} mm"
        text += f"; Sq settles at {fit.equilibrium:.3g} ± {fit.equilibrium_error:.1g} µm {way}"
    return Row(f"{body}, inner scar", body, numbers, sentence=text)


def stresses(result: ResultFile) -> list[Row]:
    """Declare the largest stresses below the disc at the last snapshot, and what lies beyond its limits."""
    study = result.study
    if not study.has_stresses or not result.snapshot_distances.size:
        return []
    table = {name: of[-1] for name, of in result.stresses.items()}
    limit, fatigue = study.pair.yield_strength, study.fatigue
    known = np.isfinite(result.history["cof"][-1])
    rows = []
    for name in (*MEASURES, *(OF_A_CYCLE if fatigue else ())):
        at, number = int(table[name].argmax()), {"value_MPa": float(table[name].max())}
        place = {"x_mm": float(table[f"{name}_x"][at]), "y_mm": float(table[f"{name}_y"][at])}
        place["z_mm"] = float(table["depth"][at])
        places = ", ".join(f"{value:.3g}" for value in place.values())
        text = f"{shown(number['value_MPa'])} MPa at x, y, z = {places} mm"
        if name in OF_A_CYCLE and fatigue:
            text += f"; {number['value_MPa'] / fatigue.torsion:.3g} of the limit in torsion"
            text += f" (means of {1e3 * fatigue.length:g} µm)"
        elif not known:
            text += ", without friction, whose coefficient is not known"
        rows.append(Row(BY_NAME[name].short, name, number | place, sentence=text))
    if limit is not None:
        volume = float(np.trapezoid(table["yielding"], table["depth"])) * study.cells.area
        deep = below.deepest(table["depth"], table["mises"], limit)
        source = "as given" if study.disc.yield_strength is not None else "a third of the hardness"
        where = f"to a depth of {deep:.3g} mm, in {volume:.3g} mm³" if deep else "nowhere"
        text = f"{where}; yield strength {limit:.4g} MPa, {source}"
        beyond = {"yield_strength_MPa": limit, "depth_mm": deep, "volume_mm3": volume}
        rows.append(Row("beyond yield", "beyond_yield", beyond, sentence=text))
    return [Row("", "stress_below_disc", rows)]


def layers(result: ResultFile) -> list[Row]:
    """Declare the layers of both bodies; nothing where there are none."""
    rows = [_layers_of(result, *pair) for pair in zip(BODIES, result.study.pair.profiles or (), strict=False)]
    return [row for row in rows if row is not None]


def _layers_of(result: ResultFile, body: str, profile: DepthProfile) -> Row | None:
    history, names = result.history, of_materials(body, profile)
    if not names:
        return None
    bare = 1.0 - history[names[0][1]] / history["area_contact"]
    first = float(history["distance"][np.argmax(bare > LEAST)]) if bare.max() > LEAST else None
    distance, contact = course(result, "area_contact")
    half = _first(distance, 1.0 - course(result, names[0][1])[1] / contact)
    named = [*zip(profile.materials, names, strict=True)]
    losses = {material.name: float(history[columns[2]][-1]) for material, columns in named}
    carried = result.study.load_distance(body, float(history["distance"][-1]))
    worn = sum(losses[m.name] / m.wear if m.wear else math.nan for m in profile.materials)
    numbers: dict[str, Any] = {
        "breakthrough_mm": first,
        "half_breakthrough_mm": half,
        "wear_volume_mm3": losses,
        "load_share": {material.name: float(history[columns[0]][-1]) for material, columns in named},
        "volumes_over_K_less_FL": finite(worn / carried - 1.0) if carried else None,
    }
    through = "none worn through" if first is None else f"first worn through after {with_unit(first, 4)}"
    through += "" if half is None else f", half of the contact after {with_unit(half, 4)}"
    parts = ", ".join(f"{name} {shown(volume)} mm³" for name, volume in losses.items())
    return Row(f"{CALLED[body]}'s layers", f"layers_{body}", numbers, sentence=f"{through}; lost: {parts}")


def _first(distance: FloatArray, bare: FloatArray) -> float | None:
    """Return the first distance [mm], between those given, at which half is bare; None where none is."""
    after = int(np.argmax(bare > HALF))
    near = slice(max(after - 1, 0), after + 1)
    return float(np.interp(HALF, bare[near], distance[near])) if bare[after] > HALF else None
