"""The summary of a run as a terminal shows it."""

from typing import Any


def summary_text(summary: dict[str, Any]) -> str:
    """A line a quantity, of `Result.summary`."""
    s = summary
    cof = s["cof"]
    of_pass, of_steps = (" (mean of the last pass)", ", of the last pass") if "track" in s else ("", "")
    lines = [
        f"{s['name']}: {s['distance_mm']:g} mm slid in {s['steps']} steps, {s['elapsed_s']:.1f} s",
        f"  scar              {s['scar_mm']['along']:.4g} × {s['scar_mm']['across']:.4g} mm (along × across)",
        f"  area in contact   {s['area_mm2']['contact']:.4g} mm²{of_pass}, "
        f"{s['area_real_over_nominal']:.3g} of the nominal area (the scar as an ellipse)",
        f"  other areas       at hardness {s['area_mm2']['plastic']:.4g}, ever touched "
        f"{s['area_mm2']['touched']:.4g}, running sum {s['area_mm2']['cumulative']:.4g} mm²",
        f"  pressure          mean {s['pressure_MPa']['mean']:.4g}, "
        f"largest {s['pressure_MPa']['max']:.4g} MPa{of_steps}",
        f"  deepest wear      sphere {s['depth_um']['sphere']:.4g}, disc {s['depth_um']['disc']:.4g} µm",
        f"  worn volume       sphere {s['volume_mm3']['sphere']:.5g}, disc {s['volume_mm3']['disc']:.5g} mm³",
    ]
    if "track" in s:
        t = s["track"]
        areas = t["area_contact_mm2_of_passes"]
        depth = f"{t['groove']['mean_depth_um']:.3g} µm deep, " if "groove" in t else ""
        lines.append(
            f"  track             {t['passes']:.4g} passes; groove {depth}displaced "
            f"{t['plastic_volume_mm3']:.4g} mm³; area {areas['first']:.4g} mm² in the first pass, "
            f"{areas['last']:.4g} in the last"
        )
    if h := s["half_space"]:
        lines.append(
            f"  half-space        E* = {1e-3 * h['effective_modulus_MPa']:.4g} GPa, {h['boundary']}; "
            f"{h['transforms']['median']:g} pairs of Fourier transforms a step in the median"
        )
    if s["patches"]:
        lines.append(_patches(s["patches"], of_half_space=s["half_space"] is not None))
    if s["model"] == "macro" or (s["patches"] and s["patches"]["bulk"] == "spring"):
        stiffness = s["foundation_N_per_mm3"]
        lines.append(f"  foundation        {stiffness:.4g} N/mm³ to begin with{_beside_hertz(s)}")
    if cof["end"] is not None:
        lines.append(
            f"  friction          {cof['first']:.3g} at first, {cof['end']:.3g} at the end "
            f"(area: {s['cof_area']}; relative to the end: {cof['first'] / cof['end']:.3g})"
        )
    tau = s["shear_strength_MPa_for_reference"]
    if tau:
        by_hardness = f"; H/(3√3) is {tau['hardness']:.3g}" if "hardness" in tau else ""
        lines.append(
            f"  shear strength    {tau['contact_end']:.3g} MPa makes {s['cof_reference']:g} of the area in "
            f"contact at the end, {tau['contact_initial']:.3g} of that at the start{by_hardness}"
        )
    lines.append(
        f"  checks            load residual {s['load_residual_N']['largest']:.2g} N at most, volumes off "
        f"Archard's by {max(abs(v) for v in s['conservation_relative'].values()):.1g}"
    )
    if s["assumptions"]:
        lines.append(f"  {len(s['assumptions'])} assumptions: see summary.json or 'warpwear show'")
    return "\n".join(lines)


def _patches(p: dict[str, Any], *, of_half_space: bool) -> str:
    covered = "all" if p["cover"] == 1.0 else f"{100.0 * p['cover']:.3g} %"
    spring = "a bulk spring each" if p["bulk"] == "spring" else "no bulk spring"
    shared = f"one approach, {spring}" if p["coupling"] == "approach" else "loads as a smooth contact says"
    iterations = "" if of_half_space else f"; {p['evaluations']['median']:g} iterations in the median"
    return (
        f"  patches           {p['number']} of {p['width_um']:g} µm in macro cells of {p['macro_cell_um']:g} "
        f"µm ({covered} of the area), {shared}{iterations}"
    )


def _beside_hertz(summary: dict[str, Any]) -> str:
    hertz = summary["hertz"]
    if hertz is None:
        return ""
    return (
        f"; Hertz, unworn: radius {hertz['radius_um']:.3g} µm, peak {hertz['peak_pressure_MPa']:.4g} MPa, "
        f"approach {hertz['approach_um']:.3g} µm"
    )
