"""The command `warpwear calibrate wear`: from its options to the text it prints."""

import math
from pathlib import Path
from typing import Any

from warpwear.calibration import options
from warpwear.calibration.options import scientific
from warpwear.calibration.wear import (
    WearCalibration,
    WornVolume,
    cap,
    circular_track,
    groove,
    volume_given,
    wear_coefficient,
)
from warpwear.errors import InputError
from warpwear.measured.surface_command import read_surface, track_in
from warpwear.surfaces.worn.ball import find_worn_ball

#: Which lengths every source needs, and which it may have.
NEEDS = {
    "--volume": ((), ()),
    "--diagonals": (("--radius",), ()),
    "--scar": (("--radius",), ()),
    "--width": (("--radius", "--track-radius"), ()),
    "--section": ((), ("--length",)),
    "--track": ((), ("--length", "--track-width")),
    "--ball": ((), ("--radius",)),
}
#: What was worn, where the source tells it.
WORN = {"--diagonals": "sphere", "--scar": "sphere", "--ball": "sphere", "--width": "disc"}
WORN |= {"--section": "disc", "--track": "disc"}
RELATIONS = {
    "--volume": "a measured volume",
    "--diagonals": "two diameters of the worn patch; flat cap, a half their mean (thesis eq 3.1)",
    "--scar": "diameter of the worn patch; flat cap",
    "--width": "width of a circular track; an unworn ball's circular section",
    "--section": "cross-section of a groove × length",
    "--track": "topography of the track; mean net section × length",
    "--ball": "topography of the ball; lost below the sphere through what is unworn",
}
#: ASTM test methods: sources they go with, and what they take for granted.
STANDARDS = {
    "g99-ball": (("--scar", "--diagonals"), "ASTM G99, spherical pin end: no wear of the disc"),
    "g99-disc": (("--width",), "ASTM G99, disc: no wear of the ball"),
    "g133-ball": (("--diagonals", "--scar"), "ASTM G133, ball: a flat scar, its mean diameter"),
    "g133-flat": (("--section",), "ASTM G133, flat: mean cross-section × stroke"),
}


def calibrate_wear(
    *,
    volume: tuple[str, ...] = (),
    diagonals: tuple[tuple[str, str], ...] = (),
    scar: tuple[str, ...] = (),
    width: tuple[str, ...] = (),
    section: tuple[str, ...] = (),
    track: tuple[Path, ...] = (),
    ball: tuple[Path, ...] = (),
    radius: str | None = None,
    track_radius: str | None = None,
    track_width: str | None = None,
    length: str | None = None,
    uncertainty: str | None = None,
    standard: str | None = None,
    load: str | None = None,
    distance: str | None = None,
    passes: int | None = None,
    stroke: str | None = None,
    hardness: str | None = None,
    as_json: bool = False,
    **preparation: str | None,
) -> str:
    """The text for people, or JSON. Quantities are text with a unit. Raises InputError.

    preparation: keys of [disc], as text, for a measured file.
    """
    sources: dict[str, tuple[Any, ...]] = {
        "--volume": volume,
        "--diagonals": diagonals,
        "--scar": scar,
        "--width": width,
        "--section": section,
        "--track": track,
        "--ball": ball,
    }
    lengths = {
        "--radius": radius,
        "--track-radius": track_radius,
        "--length": length,
        "--track-width": track_width,
    }
    source = _source(sources)
    _check(source, standard, lengths, preparation, uncertainty)
    force = options.load_of(load)
    slid = options.distance_of(distance, passes, stroke)
    if stroke is not None and passes is None and source not in ("--section", "--track"):
        raise InputError("--stroke needs --passes")
    if source in ("--section", "--track") and length is None:
        if stroke is None:
            raise InputError(f"{source} needs --length, that of the whole track, such as '30 mm'")
        lengths["--length"] = stroke
    mm = {name: options.optional(name, value, "mm") for name, value in lengths.items()}
    if standard == "g133-flat" and stroke is not None:
        slid_once = options.quantity("--stroke", stroke, "mm")
        if not math.isclose(mm["--length"] or 0.0, slid_once, rel_tol=1e-9):
            raise InputError(
                f"--length is {mm['--length']:g} mm and --stroke {slid_once:g} mm: --standard g133-flat "
                "takes the mean cross-section × the stroke, so allowed is the stroke alone"
            )
    found = wear_coefficient(
        [_volume(source, value, mm, uncertainty, preparation) for value in sources[source]],
        load=force,
        distance=slid,
        hardness=options.optional("--hardness", hardness, "MPa"),
    )
    relation = RELATIONS[source] if standard is None else STANDARDS[standard][1]
    worn = WORN.get(source)
    if as_json:
        return options.as_json(record_of(found, relation=relation, worn=worn))
    return page(found, relation=relation, worn=worn)


def _source(sources: dict[str, tuple[Any, ...]]) -> str:
    names = options.given(sources)
    if len(names) == 1:
        return names[0]
    if names:
        raise InputError(f"{' and '.join(names)} exclude each other: a wear coefficient has one source")
    raise InputError(f"what was measured is missing: one of {', '.join(sources)}")


def _check(
    source: str,
    standard: str | None,
    lengths: dict[str, str | None],
    preparation: dict[str, str | None],
    uncertainty: str | None,
) -> None:
    if standard is not None and source not in STANDARDS[standard][0]:
        raise InputError(
            f"--standard {standard} is for {' or '.join(STANDARDS[standard][0])}, not for {source}"
        )
    needed, possible = NEEDS[source]
    for name in needed:
        if lengths[name] is None:
            raise InputError(f"{source} needs {name}, a length such as '3 mm'")
    for name in options.given(lengths):
        if name not in needed + possible:
            raise InputError(f"{name} is not for {source}")
    if source in ("--track", "--ball"):
        if uncertainty is not None:
            raise InputError(f"--uncertainty is not for {source}: a topography brings its own standard error")
        if source == "--ball" and preparation.get("level") is not None:
            raise InputError("--level is not for --ball: its form is the sphere through what is unworn")
    elif options.given(preparation):
        name = options.given(preparation)[0].replace("_", "-")
        raise InputError(f"--{name} is not for {source}: it prepares a measured file")


def _volume(
    source: str,
    value: Any,
    mm: dict[str, float | None],
    uncertainty: str | None,
    preparation: dict[str, str | None],
) -> WornVolume:
    radius, length = mm["--radius"] or 0.0, mm["--length"] or 0.0
    match source:
        case "--volume":
            error = options.uncertainty(uncertainty, "mm^3")
            return volume_given(options.quantity(source, value, "mm^3"), error=error)
        case "--section":
            error = options.uncertainty(uncertainty, "mm^2")
            return groove(options.quantity(source, value, "mm^2"), length=length, error=error)
        case "--track":
            return _of_track(value, length=length, width=mm["--track-width"], preparation=preparation)
        case "--ball":
            return _of_ball(value, radius=mm["--radius"], preparation=preparation)
    error = options.uncertainty(uncertainty, "mm")
    if source == "--width":
        wide = options.quantity(source, value, "mm")
        return circular_track(wide, radius=radius, track_radius=mm["--track-radius"] or 0.0, error=error)
    across = [options.quantity(source, v, "mm") for v in ((value,) if source == "--scar" else value)]
    if max(across) > 2.0 * radius:
        raise InputError(
            f"{source} has {max(across):g} mm: allowed is up to the ball's diameter, {2 * radius:g} mm"
        )
    return cap(*across, radius=radius, error=error)


def _of_track(
    file: Path, *, length: float, width: float | None, preparation: dict[str, str | None]
) -> WornVolume:
    surface = read_surface(file, preparation | {"level": "none"})
    found, degree = track_in(surface, level=preparation.get("level"), width=width)
    if length < found.length * (1.0 - 1e-9):
        raise InputError(
            f"--length is {length:g} mm: allowed is at least the piece in {file}, {found.length:g} mm"
        )
    volume, error = found.volume(length)
    section = f"section {1e6 * found.net.mean():.5g} ± {1e6 * found.net_error:.2g} µm² × {length:g} mm"
    measured = f"{file}: {section}, degree {degree} beside it"
    source = "standard error of roughness and reference"
    if found.length < 0.9 * length:
        source += f", were the whole track like the measured {found.length:.4g} mm"
    return _measured(file, volume, error, depth=found.depth, measured=measured, source=source)


def _of_ball(file: Path, *, radius: float | None, preparation: dict[str, str | None]) -> WornVolume:
    surface = read_surface(file, preparation | {"level": "none"})
    found = find_worn_ball(surface.levelled, pixel=surface.pixel, radius=radius)
    told = "fitted" if radius is None else "given"
    measured = (
        f"{file}: patch {found.along:.4g} × {found.across:.4g} mm on a radius of "
        f"{found.sphere.radius:.5g} mm ({told})"
    )
    source = "standard error of roughness and of the sphere's fit"
    return _measured(
        file, found.volume, found.volume_error, depth=found.depth, measured=measured, source=source
    )


def _measured(
    file: Path, volume: float, error: float, *, depth: float, measured: str, source: str
) -> WornVolume:
    if volume <= 0.0:
        raise InputError(
            f"{file} has lost no volume: {volume:.3g} ± {error:.2g} mm³; a wear coefficient needs a loss"
        )
    return WornVolume(
        volume=volume,
        error=error,
        error_from=source,
        depth=depth,
        measured=measured,
    )


def record_of(found: WearCalibration, *, relation: str, worn: str | None) -> dict[str, Any]:
    """A wear coefficient, JSON-ready. relation: how the volumes were found; worn: the body, if it is told."""

    def per_nm(value: float | None) -> float | None:
        return None if value is None else 1e3 * value

    factor = 1.0 / (found.load * found.distance)
    return {
        "relation": relation,
        "worn": worn,
        "load_N": found.load,
        "distance_mm": found.distance,
        "wear_coefficient_mm3_per_Nm": per_nm(found.mean),
        "uncertainty_mm3_per_Nm": per_nm(found.uncertainty),
        "wear_coefficient_per_Pa": 1e-6 * found.mean,
        "hardness_MPa": found.hardness,
        "wear_coefficient_dimensionless": found.dimensionless,
        "count": len(found.volumes),
        "standard_deviation_mm3_per_Nm": per_nm(found.deviation),
        "standard_error_mm3_per_Nm": per_nm(found.standard_error),
        "uses": "exact",
        "tests": [
            {
                "measured": v.measured,
                "depth_um": None if v.depth is None else 1e3 * v.depth,
                "volume_mm3": v.volume,
                "volume_uncertainty_mm3": v.error,
                "uncertainty_from": v.error_from,
                "volume_by_approximation_mm3": v.approximate,
                "wear_coefficient_mm3_per_Nm": per_nm(value),
                "uncertainty_mm3_per_Nm": per_nm(error),
                "by_approximation_mm3_per_Nm": per_nm(
                    None if v.approximate is None else v.approximate * factor
                ),
            }
            for v, value, error in zip(found.volumes, found.values, found.errors, strict=True)
        ],
    }


def page(found: WearCalibration, *, relation: str, worn: str | None) -> str:
    """The same for people."""
    work = 1e-3 * found.load * found.distance
    lines = [
        f"wear coefficient K = V/(F L): {found.load:g} N over {found.distance:g} mm, F L = {work:.5g} N·m",
        f"  from             {relation}",
    ]
    for worn_volume, value, error in zip(found.volumes, found.values, found.errors, strict=True):
        lines += _test_lines(worn_volume, value=value, error=error, work=work)
    count, many = len(found.volumes), len(found.volumes) > 1
    if found.deviation is not None:
        lines.append(
            f"  of {count} tests       standard deviation {scientific(1e3 * found.deviation, digits=2)} "
            f"({found.deviation / found.mean:.2g} of the mean); below ± the standard error of the mean"
        )
    known = found.uncertainty
    plus = (
        f" (standard {'error' if many else 'uncertainty'}, {known / found.mean:.2g} of K)"
        if known is not None
        else "; its uncertainty is unknown"
    )
    lines += [
        f"  K                {scientific(1e3 * found.mean, None if known is None else 1e3 * known)} "
        f"mm³/(N·m){plus}",
        f"                   {scientific(1e-6 * found.mean)} m²/N (Pa⁻¹)",
    ]
    if found.dimensionless is not None:
        lines.append(
            f"                   {scientific(found.dimensionless)} dimensionless, with the hardness "
            f"{found.hardness:g} MPa (V = k F L/H)"
        )
    lines.append(
        f'  in a study       [wear] {worn or "sphere or disc"} = "{scientific(1e3 * found.mean)} mm^3/N/m"'
    )
    return "\n".join(lines)


def _test_lines(worn: WornVolume, *, value: float, error: float | None, work: float) -> list[str]:
    plus = f" ± {worn.error:.2g}" if worn.error is not None else ""
    depth = "" if worn.depth is None else f", {1e3 * worn.depth:.4g} µm deep"
    of_k = scientific(1e3 * value, None if error is None else 1e3 * error)
    lines = [
        f"  measured         {worn.measured}{depth}",
        f"    volume         {worn.volume:.5g}{plus} mm³: K {of_k}",
        f"    uncertainty    {worn.error_from}",
    ]
    if worn.approximate is not None:
        lines.append(
            f"    approximation  {worn.approximate:.5g} mm³ for a small scar: K "
            f"{scientific(worn.approximate / work)}, {worn.approximate / worn.volume - 1.0:+.2%}; "
            "not used, K is of the exact volume"
        )
    if worn.error is not None and worn.error > worn.volume / 3.0:
        lines.append("    warning        the volume is within three standard uncertainties of nothing")
    return lines
