"""The summary of a run as a terminal shows it."""

from typing import Any

from warpwear.results.report import Row, lines

#: Behind a coefficient of friction that the study gives or assumes, and that the run says nothing of.
INPUT, ASSUMED = " (an input)", " (an input, assumed)"


def summary_text(summary: dict[str, Any]) -> str:
    """Say in lines for people what a run amounts to. summary: `Result.summary`, units in its keys."""
    s = summary
    slid = f"{s['distance_mm']:g} mm slid in {s['steps']} steps, {s['elapsed_s']:.1f} s"
    return "\n".join([f"{s['name']}: {slid}", *lines([*_contact(s), *_scar(s), *_models(s), *_friction(s)])])


def _contact(s: dict[str, Any]) -> list[Row]:
    """Declare scar, areas, pressures and wear. s: the summary."""
    of_pass, of_steps = ("(mean of the last pass), ", ", of the last pass") if "track" in s else (", ", "")
    nominal = f"{of_pass}{s['area_real_over_nominal']:.3g} of the nominal area (the scar as an ellipse)"
    areas = s["area_mm2"]
    filled = s.get("load_on_filled_percent")
    on_filled = filled and {"at the end": filled["end"], "at most": filled["largest"]}
    pressures = {"mean": s["pressure_MPa"]["mean"], "largest": s["pressure_MPa"]["max"]}
    names = {"at hardness": "plastic", "ever touched": "touched", "running sum": "cumulative"}
    return [
        Row("scar", "scar_mm", list(s["scar_mm"].values()), note="(along × across)"),
        Row("area in contact", "area_mm2", areas["contact"], note=nominal),
        Row("on filled points", "load_on_filled_percent", on_filled, digits=2, note="of the load"),
        Row("other areas", "area_mm2", {name: areas[key] for name, key in names.items()}),
        Row("pressure", "pressure_MPa", pressures, note=of_steps),
        Row("deepest wear", "depth_um", s["depth_um"]),
        Row("worn volume", "volume_mm3", s["volume_mm3"], digits=5),
        *_of_one_spot(s),
    ]


def _of_one_spot(s: dict[str, Any]) -> list[Row]:
    """Declare that scar and depths are not those of a track, and what the wear is on one."""
    if "track" in s or s["distance_mm"] == 0.0:
        return []
    told = "scar and depths are those of one spot, which stays under the sphere"
    if found := s.get("on_a_track"):
        told += f"; on a track of {found['length_mm']:.4g} mm: section {found['section_um2']:.4g} µm²"
    return [Row("disc at rest", "", told)]


def _models(s: dict[str, Any]) -> list[Row]:
    """Declare what the arrangement of the contact adds: track, half-space, patches, foundation."""
    rows = []
    if "track" in s:
        track = s["track"]
        areas = Row("", "", track["area_contact_mm2_of_passes"], unit="mm²")
        rows += [
            Row("passes", "", track["passes"], note=f", area in contact {areas.text}"),
            *_groove(track.get("groove")),
            Row("displaced", "plastic_volume_mm3", track["plastic_volume_mm3"]),
        ]
        if parts := track.get("parts"):
            error = 100.0 * parts["estimated_error_at_most"]
            told = f"contacts; by estimate their length changes the area by at most {error:.2g} %"
            rows.append(Row("steps divided into", "", parts["number"], note=told))
    if half_space := s["half_space"]:
        transforms = half_space["transforms"]["median"]
        modulus = 1e-3 * half_space["effective_modulus_MPa"]
        told = f", {half_space['boundary']}; {transforms:g} pairs of Fourier transforms a step in the median"
        rows.append(Row("half-space", "", [Row("E*", "", modulus, unit="GPa")], note=told))
    if pieces := s.get("pieces"):
        rows += _pieces(pieces)
    patches = s["patches"]
    if patches:
        rows += _patches(patches, of_half_space=half_space is not None)
    if s["model"] == "macro" or (patches and patches["bulk"] == "spring"):
        stiffness = s["foundation_N_per_mm3"]
        rows.append(Row("foundation", "foundation_N_per_mm3", stiffness, note="to begin with"))
        if hertz := s["hertz"]:
            of_unworn = [
                Row("radius", "radius_um", hertz["radius_um"], digits=3),
                Row("peak", "peak_pressure_MPa", hertz["peak_pressure_MPa"]),
                Row("approach", "approach_um", hertz["approach_um"], digits=3),
            ]
            rows.append(Row("Hertz, unworn", "", of_unworn))
    return rows


def _groove(groove: dict[str, Any] | None) -> list[Row]:
    """Declare the mean section of the groove, its width and its deepest place."""
    if groove is None:
        return []
    size = f"{groove['width_mm']:.3g} mm wide, mean profile {groove['deepest_um']:.3g} µm deep at most"
    return [Row("groove", "", f"mean section {groove['section_um2']:.4g} µm², {size}")]


def _pieces(pieces: dict[str, Any]) -> list[Row]:
    """Declare the pieces in which bodies have worn, and what decides the course of such a run."""
    p = pieces
    told = f"{p['diameter_um']:.3g} µm wide and {p['thickness_um']:.3g} µm thick, {p['volume_um3']:.3g} µm³"
    rows = [Row("pieces", "", told)]
    for body in ("sphere", "disc"):
        rate = "" if p[body]["per_minute"] is None else f", {p[body]['per_minute']:.3g} a minute"
        part = p[body]["track_fraction"]
        counted = "" if part == 1.0 else f" on {100.0 * part:.3g} % of the stroke"
        told = f"{p[body]['number']}{counted}, {p[body]['per_mm']:.3g} per mm of sliding{rate}"
        rows.append(Row(f"off the {body}", "", told + (", on all of it" if counted else "")))
    start = "nothing pending" if p["pending_start"] == "zero" else "pending at random"
    decides = (
        f"diameter d* {p['diameter_um']:.3g} µm and thickness t {p['thickness_um']:.3g} µm of a piece, "
        f"dust {100.0 * p['dust_fraction']:.3g} %, start {p['pending_start']} ({start}): "
        "inputs that move distances severalfold"
    )
    return [*rows, Row("decided by", "", decides)]


def _scar(s: dict[str, Any]) -> list[Row]:
    """Declare how rough both bodies are in the inner scar, how that settles, and how large junctions are."""
    rows = []
    for body, found in s["inner_scar"].items():
        if found["sq_um"] is None:
            continue
        unworn = f" of {found['sq_unworn_um']:.3g} µm unworn" if found["sq_unworn_um"] else ""
        told = f"{unworn}, Sdq {found['sdq']:.2g}, along sliding Rq {found['rq_along_um']:.3g} µm"
        if fit := found["settling"]:
            level = f"{fit['equilibrium_um']:.3g} ± {fit['equilibrium_error_um']:.1g} µm"
            error = f"{fit['running_in_length_error_mm']:.2g}"
            length = f"{fit['running_in_length_mm']:.3g} ± {float(error):g} mm"
            told += f"; Sq settles at {level} over {length}"
        rows.append(Row(f"{body}, inner scar", "", f"Sq {found['sq_um']:.3g} µm{told}"))
    if above := s["junctions"]["share_above"]:
        first = f"of the area in contact (first {100.0 * above['first']:.3g} %)"
        note = f"{first}, d* {above['diameter_um']:.3g} µm"
        rows.append(Row("junctions over d*", "share_percent", 100.0 * above["end"], digits=3, note=note))
    return rows


def _patches(patches: dict[str, Any], *, of_half_space: bool) -> list[Row]:
    """Declare the patches of a two-scale run."""
    p = patches
    covered = "all" if p["cover"] == 1.0 else f"{100.0 * p['cover']:.3g} %"
    spring = "a bulk spring each" if p["bulk"] == "spring" else "no bulk spring"
    shared = f"one approach, {spring}" if p["coupling"] == "approach" else "loads as a smooth contact says"
    iterations = "" if of_half_space else f"; {p['evaluations']['median']:g} iterations in the median"
    cells = f"in macro cells of {p['macro_cell_um']:g} µm ({covered} of the area)"
    return [Row("patches", "", f"{p['number']} of {p['width_um']:g} µm {cells}, {shared}{iterations}")]


def _film(s: dict[str, Any]) -> list[Row]:
    """Declare what shear leaves of the hardness, and how a film wore through."""
    rows = []
    if grown := s.get("junction_growth"):
        left = {"bare": grown["hardness_sheared_MPa"]}
        if "hardness_under_film_MPa" in grown:
            left = {"under the film": grown["hardness_under_film_MPa"]} | left
        note = f", of {grown['indentation_hardness_MPa']:g} MPa, by junction growth α = {grown['alpha']:g}"
        rows.append(Row("sheared hardness", "", left, note=note, unit="MPa"))
    if film := s.get("film"):
        bare = film["bare_fraction"]
        course = {"at first": bare["first"], "at the end": bare["end"]}
        rows.append(Row("bare of film", "", course, digits=3, note="of the area in contact"))
        if fit := film["fit"]:
            constants = [
                Row("plateau", "plateau", fit["plateau"], digits=3, error=("", fit["plateau_error"])),
                Row(
                    "e-folding", "e_folding_mm", fit["e_folding_mm"], 3, error=("", fit["e_folding_error_mm"])
                ),
                Row("from", "start_mm", fit["start_mm"], digits=3, note="on"),
            ]
            rows.append(Row("fitted course", "", constants))
        else:
            rows.append(Row("fitted course", "", f"none: {film['no_fit']}"))
    return rows


def _friction(s: dict[str, Any]) -> list[Row]:
    """Declare friction, and what checks and assumptions say."""
    cof, tau = s["cof"], s["shear_strength_MPa_for_reference"]
    rows = []
    given, limit, strength = s["cof_input"], s["shear_strength_of_softer_body_MPa"], s["shear_strength_MPa"]
    if cof["end"] is not None:
        relative = f"(area: {s['cof_area']}; relative to the end: {cof['first'] / cof['end']:.3g})"
        told = ASSUMED if "friction.coefficient" in s["assumptions"] else INPUT
        marks = {when: told if when == given else "" for when in ("initial", "end")}
        course = {f"at first{marks['initial']}": cof["first"], f"at the end{marks['end']}": cof["end"]}
        rows.append(Row("friction", "cof", course, digits=3, note=relative))
    if strength is not None:
        told = "as given"
        if given is not None:
            told = f"fitted to {s['cof_reference']:g}: give it as friction.shear_strength to runs to compare"
        if limit is not None and strength > limit:
            formula = "H/√α" if "junction_growth" in s else "H/(3√3)"
            told += f"; beyond what the softer body bears, {formula} = {limit:.3g} MPa"
        rows.append(Row("shear strength", "shear_strength_MPa", strength, digits=3, note=f", {told}"))
    if tau:
        strengths = {"at the end": tau["contact_end"], "at the start": tau["contact_initial"]}
        asked = "of the area in contact"
        if "hardness" in tau:
            asked += f"; of contact.hardness, H/(3√3), {tau['hardness']:.3g} MPa"
        rows.append(
            Row(f"that for CoF {s['cof_reference']:g}", "", strengths, digits=3, note=asked, unit="MPa")
        )
    rows += _film(s)
    off = max(abs(v) for v in s["conservation_relative"].values())
    checks = [
        Row("load residual at most", "load_residual_N", s["load_residual_N"]["largest"], digits=2),
        Row("volumes off Archard's by", "", off, digits=1),
    ]
    assumed = len(s["assumptions"]) or None
    return [
        *rows,
        Row("checks", "", checks),
        Row("assumptions", "", assumed, note="in summary.json and 'warpwear show'"),
    ]
