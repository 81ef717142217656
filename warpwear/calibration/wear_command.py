"""The command `warpwear calibrate wear`: from its options to the text it prints."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from warpwear.calibration import options as given
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
from warpwear.measured.options import optional, quantity
from warpwear.measured.surface_command import read_surface, track_in
from warpwear.results.report import Row, lines, record, scientific, to_json
from warpwear.surfaces.worn.ball import find_worn_ball


@dataclass(frozen=True)
class Source:
    """A kind of measurement.

    relation: how a volume follows from it; worn: the body, where that is certain; needs, may_have: options of
    the lengths that it must and can be given with.
    """

    relation: str
    worn: str | None = None
    needs: tuple[str, ...] = ()
    may_have: tuple[str, ...] = ()


_CAP = "two diameters of the worn patch; flat cap, its width their mean"
_SEGMENT = "width of a circular track; an unworn ball's circular section"
_TRACK = "topography of the track; mean net section × length"
_BALL = "topography of the ball; lost below the sphere through what is unworn"
SOURCES = {
    "--volume": Source("a measured volume"),
    "--diagonals": Source(_CAP, "sphere", ("--radius",)),
    "--scar": Source("diameter of the worn patch; flat cap", "sphere", ("--radius",)),
    "--width": Source(_SEGMENT, "disc", ("--radius", "--track-radius")),
    "--section": Source("cross-section of a groove × length", "disc", may_have=("--length",)),
    "--track": Source(_TRACK, "disc", may_have=("--length", "--track-width")),
    "--ball": Source(_BALL, "sphere", may_have=("--radius",)),
}
#: Sources whose volume is a section times a length.
GROOVES = ("--section", "--track")
#: Sources that are files.
TOPOGRAPHIES = ("--track", "--ball")
LENGTHS = ("--radius", "--track-radius", "--length", "--track-width")
#: ASTM test methods: sources they go with, and what they take for granted.
STANDARDS = {
    "g99-ball": (("--scar", "--diagonals"), "ASTM G99, spherical pin end: no wear of the disc"),
    "g99-disc": (("--width",), "ASTM G99, disc: no wear of the ball"),
    "g133-ball": (("--diagonals", "--scar"), "ASTM G133, ball: a flat scar, its mean diameter"),
    "g133-flat": (("--section",), "ASTM G133, flat: mean cross-section × stroke"),
}


@dataclass(frozen=True, kw_only=True)
class WearOptions:
    """Options of `warpwear calibrate wear`: quantities are text with a unit, None for those not given.

    volume to ball: the sources, one of them with a value a test. preparation: keys of [disc], as text, for a
    measured file.
    """

    volume: tuple[str, ...] = ()
    diagonals: tuple[tuple[str, str], ...] = ()
    scar: tuple[str, ...] = ()
    width: tuple[str, ...] = ()
    section: tuple[str, ...] = ()
    track: tuple[Path, ...] = ()
    ball: tuple[Path, ...] = ()
    radius: str | None = None
    diameter: str | None = None
    track_radius: str | None = None
    track_width: str | None = None
    length: str | None = None
    uncertainty: str | None = None
    standard: str | None = None
    load: str | None = None
    distance: str | None = None
    passes: int | None = None
    stroke: str | None = None
    hardness: str | None = None
    as_json: bool = False
    preparation: Mapping[str, str | None] = field(default_factory=dict)

    def __getitem__(self, option: str) -> Any:
        """The value of an option by its name on the command line, such as --track-width."""
        return getattr(self, option.removeprefix("--").replace("-", "_"))


def calibrate_wear(options: WearOptions) -> str:
    """Find a wear coefficient: the text for people, or JSON. Raises InputError."""
    if options.diameter is not None:
        if options.radius is not None:
            raise InputError("--radius and --diameter exclude each other: both say how large the ball is")
        options = replace(options, radius=f"{0.5 * quantity('--diameter', options.diameter, 'mm')!r} mm")
    source = _source(options)
    _check(source, options)
    load = given.load_of(options.load)
    distance = given.distance_of(options.distance, options.passes, options.stroke)
    lengths = _lengths(source, options)
    volumes = [_volume(source, value, lengths, options) for value in options[source]]
    hardness = optional("--hardness", options.hardness, "MPa")
    found = wear_coefficient(volumes, load=load, distance=distance, hardness=hardness)
    relation = SOURCES[source].relation if options.standard is None else STANDARDS[options.standard][1]
    rows = wear_rows(found, relation=relation, worn=SOURCES[source].worn)
    if options.as_json:
        return to_json(record(rows))
    work = 1e-3 * found.load * found.distance
    return "\n".join([f"wear coefficient K = V/(F L), F L = {work:.5g} N·m", *lines(rows)])


def _source(options: WearOptions) -> str:
    """Name the one source that was given. Raises InputError for none and for several."""
    names = [name for name in SOURCES if options[name]]
    if len(names) == 1:
        return names[0]
    if names:
        raise InputError(f"{' and '.join(names)} exclude each other: a wear coefficient has one source")
    raise InputError(f"what was measured is missing: one of {', '.join(SOURCES)}")


def _check(source: str, options: WearOptions) -> None:
    """Raise InputError for options that do not go with the source."""
    standard, kind = options.standard, SOURCES[source]
    if standard is not None and source not in STANDARDS[standard][0]:
        raise InputError(
            f"--standard {standard} is for {' or '.join(STANDARDS[standard][0])}, not for {source}"
        )
    for name in kind.needs:
        if options[name] is None:
            raise InputError(f"{source} needs {name}, a length such as '3 mm'")
    for name in LENGTHS:
        if options[name] is not None and name not in kind.needs + kind.may_have:
            allowed = ", ".join(kind.needs + kind.may_have) or "no length"
            raise InputError(f"{name} is not for {source}: allowed with it is {allowed}")
    prepared = [name.replace("_", "-") for name, value in options.preparation.items() if value is not None]
    if source not in TOPOGRAPHIES and prepared:
        raise InputError(f"--{prepared[0]} is not for {source}: it prepares a measured file")
    if source in TOPOGRAPHIES and options.uncertainty is not None:
        raise InputError(f"--uncertainty is not for {source}: a topography brings its own standard error")
    if source == "--ball" and "level" in prepared:
        raise InputError("--level is not for --ball: its form is the sphere through what is unworn")
    if source not in GROOVES and options.stroke is not None and options.passes is None:
        raise InputError("--stroke needs --passes")


def _lengths(source: str, options: WearOptions) -> dict[str, float | None]:
    """Turn the lengths into mm: option -> length; a groove is as long as the stroke unless told otherwise."""
    texts = {name: options[name] for name in LENGTHS}
    if source in GROOVES and options.length is None:
        if options.stroke is None:
            raise InputError(f"{source} needs --length, that of the whole track, such as '30 mm'")
        texts["--length"] = options.stroke
    lengths = {name: optional(name, text, "mm") for name, text in texts.items()}
    if options.standard == "g133-flat" and options.stroke is not None:
        stroke, length = quantity("--stroke", options.stroke, "mm"), lengths["--length"] or 0.0
        if not math.isclose(length, stroke, rel_tol=1e-9):
            raise InputError(
                f"--length is {length:g} mm and --stroke {stroke:g} mm: --standard g133-flat takes the mean "
                "cross-section × the stroke, so allowed is the stroke alone"
            )
    return lengths


def _volume(source: str, value: Any, lengths: dict[str, float | None], options: WearOptions) -> WornVolume:
    """Find the volume of one test. value: of the source's option; lengths [mm]. Raises InputError."""
    radius, length = lengths["--radius"] or 0.0, lengths["--length"] or 0.0
    match source:
        case "--volume":
            error = given.uncertainty(options.uncertainty, "mm^3")
            return volume_given(quantity(source, value, "mm^3"), error=error)
        case "--section":
            error = given.uncertainty(options.uncertainty, "mm^2")
            return groove(quantity(source, value, "mm^2"), length=length, error=error)
        case "--track":
            return _of_track(value, options.preparation, length=length, width=lengths["--track-width"])
        case "--ball":
            return _of_ball(value, options.preparation, radius=lengths["--radius"])
    error = given.uncertainty(options.uncertainty, "mm")
    if source == "--width":
        width, track = quantity(source, value, "mm"), lengths["--track-radius"] or 0.0
        return circular_track(width, radius=radius, track_radius=track, error=error)
    across = [quantity(source, v, "mm") for v in ((value,) if source == "--scar" else value)]
    if max(across) > 2.0 * radius:
        raise InputError(
            f"{source} has {max(across):g} mm: allowed is up to the ball's diameter, {2 * radius:g} mm"
        )
    return cap(*across, radius=radius, error=error)


def _of_track(
    file: Path, preparation: Mapping[str, str | None], *, length: float, width: float | None
) -> WornVolume:
    """Find the volume of a track of a length [mm] from a topography of it, or of a piece of it.

    width: of the track [mm], None to find it. Raises InputError.
    """
    surface = read_surface(file, {**preparation, "level": "none"})
    found, degree = track_in(surface, level=preparation.get("level"), width=width)
    if length < found.length * (1.0 - 1e-9):
        raise InputError(
            f"--length is {length:g} mm: allowed is at least the piece in {file}, {found.length:g} mm"
        )
    section = f"section {1e6 * found.net.mean():.5g} ± {1e6 * found.net_error:.2g} µm² × {length:g} mm"
    source = "what the same sum finds on unworn surface"
    if found.length < 0.9 * length:
        source += f", and how sections scatter along the measured {found.length:.4g} mm"
    volume, error = found.volume(length)
    measured = f"{section}, degree {degree} beside it"
    return _of_topography(file, volume, error, depth=found.depth, measured=measured, source=source)


def _of_ball(file: Path, preparation: Mapping[str, str | None], *, radius: float | None) -> WornVolume:
    """Find what a ball lost, from its topography. radius [mm], None to fit it. Raises InputError."""
    surface = read_surface(file, {**preparation, "level": "none"})
    found = find_worn_ball(surface.measured, pixel=surface.pixel, radius=radius)
    sphere = f"a radius of {found.sphere.radius:.5g} mm ({'fitted' if radius is None else 'given'})"
    measured = f"patch {found.along:.4g} × {found.across:.4g} mm on {sphere}"
    source = "what the same sum finds on unworn surface"
    volume, error = found.volume, found.volume_error
    return _of_topography(file, volume, error, depth=found.depth, measured=measured, source=source)


def _of_topography(
    file: Path, volume: float, error: float, *, depth: float, measured: str, source: str
) -> WornVolume:
    """Make a worn volume [mm³] of what a file holds. depth [mm]. Raises InputError where nothing was lost."""
    if volume <= 0.0:
        raise InputError(
            f"{file} has lost no volume: {volume:.3g} ± {error:.2g} mm³; a wear coefficient needs a loss"
        )
    measured = f"{file}: {measured}"
    return WornVolume(volume=volume, error=error, error_from=source, depth=depth, measured=measured)


def wear_rows(found: WearCalibration, *, relation: str, worn: str | None) -> list[Row]:
    """Declare a wear coefficient. relation: how the volumes were found; worn: the body, if it is told."""
    count, deviation, known = len(found.volumes), found.deviation, found.uncertainty
    told = "; its uncertainty is unknown"
    if known is not None:
        told = f"(standard {'error' if count > 1 else 'uncertainty'}, {known / found.mean:.2g} of K)"
    scatter = by_hardness = ""
    if deviation is not None:
        scatter = f"standard deviation of {count} tests ({deviation / found.mean:.2g} of the mean)"
    if found.hardness:
        by_hardness = f"dimensionless, with the hardness {found.hardness:g} MPa (V = k F L/H)"
    spread, k = _times(1e3, deviation), found.dimensionless
    in_study = f'[wear] {worn or "sphere or disc"} = "{scientific(1e3 * found.mean)} mm^3/N/m"'
    return [
        Row("from", "relation", relation),
        Row("", "worn", worn),
        Row("load F", "load_N", found.load, digits=6),
        Row("distance L", "distance_mm", found.distance, digits=6),
        _k("K", 1e3 * found.mean, _times(1e3, known), note=told),
        Row("  or", "wear_coefficient_per_Pa", 1e-6 * found.mean, scientific=True),
        Row("", "hardness_MPa", found.hardness),
        Row("  or", "wear_coefficient_dimensionless", k, note=by_hardness, scientific=True),
        Row("", "count", count),
        Row("scatter", "standard_deviation_mm3_per_Nm", spread, digits=2, note=scatter, scientific=True),
        Row("", "standard_error_mm3_per_Nm", _times(1e3, found.standard_error)),
        Row("", "uses", "exact"),
        Row("in a study", "", in_study),
        Row("", "tests", [_test_rows(found, test) for test in range(count)]),
    ]


def _test_rows(found: WearCalibration, test: int) -> list[Row]:
    """Declare one of the tests."""
    worn, value, error = found.volumes[test], found.values[test], found.errors[test]
    small, bulging, note, worn_too = None, None, "", ""
    if worn.approximate is not None:
        small = 1e3 * (worn.approximate * (1.0 / (found.load * found.distance)))
        change = f"{worn.approximate / worn.volume - 1.0:+.2%}"
        note = f"for a small scar: K {scientific(small)}, {change}; not used, K is of the exact volume"
    if worn.bulging is not None:
        bulging = 1e3 * (worn.bulging * (1.0 / (found.load * found.distance)))
        worn_too = (
            f"by π d₁³ d₂/(64 R): K {scientific(bulging)}, if the longer diameter d₂ lies across sliding: "
            "the scar is then no cap"
        )
    doubted = worn.error is not None and worn.error > worn.volume / 3.0
    warning = "the volume is within three standard uncertainties of nothing" if doubted else None
    return [
        Row("measured", "measured", worn.measured),
        Row("  depth", "depth_um", _times(1e3, worn.depth)),
        Row("  volume", "volume_mm3", worn.volume, digits=5, error=("volume_uncertainty_mm3", worn.error)),
        Row("  uncertainty", "uncertainty_from", worn.error_from),
        Row("  approximation", "volume_by_approximation_mm3", worn.approximate, digits=5, note=note),
        _k("  K", 1e3 * value, _times(1e3, error)),
        Row("", "by_approximation_mm3_per_Nm", small),
        Row("  disc worn, too", "volume_of_bulging_scar_mm3", worn.bulging, digits=5, note=worn_too),
        Row("", "of_bulging_scar_mm3_per_Nm", bulging),
        Row("  warning", "", warning),
    ]


def _k(label: str, value: float, error: float | None, *, note: str = "") -> Row:
    """Declare a wear coefficient [mm³/(N·m)] and its standard uncertainty."""
    key, uncertainty = "wear_coefficient_mm3_per_Nm", ("uncertainty_mm3_per_Nm", error)
    return Row(label, key, value, error=uncertainty, note=note, scientific=True)


def _times(factor: float, value: float | None) -> float | None:
    """Multiply a value that may be unknown."""
    return None if value is None else factor * value
