"""The command `warpwear calibrate wear`: from its options to the text it prints."""

import math
from pathlib import Path
from typing import Any

from warpwear import calibrate_options as options
from warpwear.calibrate_wear_text import page, record_of
from warpwear.calibration import (
    WornVolume,
    cap,
    circular_track,
    groove,
    volume_given,
    wear_coefficient,
)
from warpwear.errors import InputError

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
    from warpwear.surface_command import read_surface, track_in

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
    from warpwear.surface_command import read_surface
    from warpwear.surfaces.worn_ball import find_worn_ball

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
