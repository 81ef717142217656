"""The command `warpwear calibrate wear`: from its options to the text it prints."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.calibration import wear as volumes
from warpwear.errors import InputError
from warpwear.measured.options import Options, optional, quantity
from warpwear.measured.surface import Kind, Preparation, worn_in
from warpwear.results.report import Row, lines, record, scientific, times, to_json
from warpwear.study.units import NOT_NEGATIVE


@dataclass(frozen=True)
class Source:
    """Describe a kind of measurement.

    relation: how a volume follows from it; worn: the body, where that is certain; unit: of what is measured;
    needs, may_have: options of the lengths that it must and can be given with; file: what is looked for in
    it, where it is a measured file.
    """

    relation: str
    worn: str | None = None
    unit: str = "mm"
    needs: tuple[str, ...] = ()
    may_have: tuple[str, ...] = ()
    file: Kind | None = None

    @property
    def is_groove(self) -> bool:
        """Return whether its volume is a section times a length."""
        return "--length" in self.may_have


_CAP = "two diameters of the worn patch; flat cap, its width their mean"
_SEGMENT = "width of a circular track; an unworn ball's circular section"
_TRACK = "topography of the track, or a profile across it; mean net section × length"
_AFTER = "topographies of the scar's place before and after; net volume lost"
_BALL = "topography of the ball; lost below the counter-body through what is unworn"
SOURCES = {
    "--volume": Source("a measured volume", unit="mm^3"),
    "--diagonals": Source(_CAP, "counter", needs=("--radius",)),
    "--scar": Source("diameter of the worn patch; flat cap", "counter", needs=("--radius",)),
    "--width": Source(_SEGMENT, "disc", needs=("--radius", "--track-radius")),
    "--section": Source("cross-section of a groove × length", "disc", "mm^2", may_have=("--length",)),
    "--track": Source(_TRACK, "disc", may_have=("--length", "--track-width"), file="track"),
    "--after": Source(_AFTER, "disc", file="scar"),
    "--ball": Source(_BALL, "counter", may_have=("--radius",), file="ball"),
}
#: A value with its standard uncertainty: 0.018 +- 0.001 mm^3.
_WITH_ERROR = re.compile(r"\(?\s*(?P<value>\S+)\s*(?:\+-|±)\s*(?P<error>[^\s)]+)\s*\)?(?P<unit>.*)")
LENGTHS = ("--radius", "--track-radius", "--length", "--track-width")
#: ASTM test methods: sources they go with, and what they take for granted.
STANDARDS = {
    "g99-ball": (("--scar", "--diagonals"), "ASTM G99, spherical pin end: no wear of the disc"),
    "g99-disc": (("--width",), "ASTM G99, disc: no wear of the ball"),
    "g133-ball": (("--diagonals", "--scar"), "ASTM G133, ball: a flat scar, its mean diameter"),
    "g133-flat": (("--section",), "ASTM G133, flat: mean cross-section × stroke"),
}


def calibrate_wear(preparation: Preparation, *, as_json: bool, **texts: Any) -> str:
    """Find a wear coefficient: the text for people, or JSON. Raises InputError.

    preparation: keys of [disc], as text, for a measured file. texts: options with a unit, None where left
    out; a source's by test.
    """
    options = Options(texts)
    if options["--diameter"] is not None:
        if options["--radius"] is not None:
            raise InputError("--radius and --diameter exclude each other: both say how large the ball is")
        options["radius"] = f"{0.5 * quantity('--diameter', options['--diameter'], 'mm')!r} mm"
    source, standard = _source(options), options["--standard"]
    _check(source, options, preparation)
    load, distance = options.load, options.distance
    lengths = _lengths(source, options)
    before = options["--before"] or [None] * len(options[source])
    tests = tuple(
        _volume(source, value, lengths, Options(options | {"before": earlier}), preparation)
        for value, earlier in zip(options[source], before, strict=True)
    )
    hardness = options.optional("--hardness", "MPa")
    wear = volumes.WearCalibration(volumes=tests, load=load, distance=distance, hardness=hardness)
    relation = SOURCES[source].relation if standard is None else STANDARDS[standard][1]
    rows = wear_rows(wear, relation=relation, worn=SOURCES[source].worn)
    if as_json:
        return to_json(record(rows))
    return "\n".join([f"wear coefficient K = V/(F L), F L = {1e-3 * load * distance:.5g} N·m", *lines(rows)])


def _source(options: Options) -> str:
    """Name the one source that was given. Raises InputError for none and for several."""
    names = [name for name in SOURCES if options[name]]
    if len(names) == 1:
        return names[0]
    if names:
        raise InputError(f"{' and '.join(names)} exclude each other: a wear coefficient has one source")
    raise InputError(f"what was measured is missing: one of {', '.join(SOURCES)}")


def _check(source: str, options: Options, preparation: Preparation) -> None:
    """Raise InputError for options that do not go with the source."""
    standard, kind = options["--standard"], SOURCES[source]
    if standard is not None and source not in STANDARDS[standard][0]:
        raise InputError(f"--standard {standard} is for {' or '.join(STANDARDS[standard][0])}, not {source}")
    for name in kind.needs:
        if options[name] is None:
            raise InputError(f"{source} needs {name}, a length such as '3 mm'")
    for name in LENGTHS:
        if options[name] is not None and name not in kind.needs + kind.may_have:
            allowed = ", ".join(kind.needs + kind.may_have) or "no length"
            raise InputError(f"{name} is not for {source}: allowed with it is {allowed}")
    prepared = [name.replace("_", "-") for name, value in preparation.items() if value is not None]
    if kind.file is None and prepared:
        raise InputError(f"--{prepared[0]} is not for {source}: it prepares a measured file")
    if kind.file is not None and options["--uncertainty"] is not None:
        raise InputError(f"--uncertainty is not for {source}: a topography brings its own standard error")
    if source == "--ball" and "level" in prepared:
        raise InputError("--level is not for --ball: its form is the sphere through what is unworn")
    before, tests = len(options["--before"] or ()), len(options[source])
    if before and source not in ("--track", "--after"):
        raise InputError(f"--before is not for {source}: allowed is it with --track and --after")
    if before != tests and (before or source == "--after"):
        raise InputError(f"--before is given {before} times, {source} {tests}: each needs its own")
    if not kind.is_groove and options["--stroke"] is not None and options["--passes"] is None:
        raise InputError("--stroke needs --passes")


def _lengths(source: str, options: Options) -> dict[str, float | None]:
    """Turn the lengths into mm: option -> length; a groove is as long as the stroke unless told otherwise."""
    texts = {name: options[name] for name in LENGTHS}
    if SOURCES[source].is_groove and options["--length"] is None:
        if options["--stroke"] is None:
            raise InputError(f"{source} needs --length, that of the whole track, such as '30 mm'")
        texts["--length"] = options["--stroke"]
    lengths = {name: optional(name, text, "mm") for name, text in texts.items()}
    if options["--standard"] == "g133-flat" and options["--stroke"] is not None:
        stroke, length = quantity("--stroke", options["--stroke"], "mm"), lengths["--length"] or 0.0
        if not math.isclose(length, stroke, rel_tol=1e-9):
            raise InputError(f"--length {length:g} mm is not --stroke {stroke:g} mm, which g133-flat takes")
    return lengths


def _volume(
    source: str, value: Any, lengths: dict[str, float | None], options: Options, preparation: Preparation
) -> volumes.WornVolume:
    """Find the volume of one test. value: of the source's option; lengths [mm]. Raises InputError."""
    kind, radius = SOURCES[source], lengths["--radius"] or 0.0
    if kind.file is not None:
        return _of_topography(kind.file, value, lengths, options["--before"], preparation)
    unit = kind.unit
    texts, uncertainties = zip(*map(_with_error, value if source == "--diagonals" else (value,)), strict=True)
    if any(uncertainties) and options["--uncertainty"] is not None:
        raise InputError(f"--uncertainty and {source} with +- exclude each other: both say the uncertainty")
    each = (optional(source, text, unit, allowed=NOT_NEGATIVE) for text in uncertainties)
    errors = [error for error in each if error is not None]
    # of two diagonals, which count alike
    error = math.sqrt(sum(e * e for e in errors) / len(errors)) if errors else None
    if error is None:
        error = options.optional("--uncertainty", unit, allowed=NOT_NEGATIVE)
    sizes = [quantity(source, text, unit) for text in texts]
    match source:
        case "--volume":
            return volumes.volume_given(*sizes, error=error)
        case "--section":
            return volumes.groove(*sizes, length=lengths["--length"] or 0.0, error=error)
        case "--width":
            track = lengths["--track-radius"] or 0.0
            return volumes.circular_track(*sizes, radius=radius, track_radius=track, error=error)
    return volumes.cap(*sizes, radius=radius, error=error)


def _with_error(text: str) -> tuple[str, str | None]:
    """Split a text into its value and its standard uncertainty, each with the unit; None for none."""
    parts = _WITH_ERROR.fullmatch(text.strip())
    if parts is None:
        return text, None
    return f"{parts['value']} {parts['unit']}", f"{parts['error']} {parts['unit']}"


def _of_topography(
    kind: Kind, file: Path, lengths: dict[str, float | None], before: Path | None, preparation: Preparation
) -> volumes.WornVolume:
    """Find the volume that a track, a scar or a ball lost from a topography, or from a profile of a track.

    lengths [mm]; before: the file of the same place before the test, or None. Raises InputError.
    """
    sizes: Any = {"width": lengths["--track-width"], "radius": lengths["--radius"]}
    worn = worn_in(file, kind, preparation, before=before, **sizes)
    body, depth, more = worn.body, worn.body.depth, ""
    if kind == "track":
        length = lengths["--length"] or 0.0
        if length < body.length * (1.0 - 1e-9):
            raise InputError(
                f"--length is {length:g} mm: allowed is at least the piece in {file}, {body.length:g} mm"
            )
        if body.net.size == 1:
            more = ", but not how sections scatter along the track, which several profiles tell"
        elif body.length < 0.9 * length:
            more = f", and how sections scatter along the measured {body.length:.4g} mm"
        volume, error = body.volume(length)
        section = f"section {1e6 * body.net.mean():.5g} ± {1e6 * body.net_error:.2g} µm² × {length:g} mm"
        measured = f"{section}, degree {worn.degree} beside it"
    elif kind == "scar":
        volume, error = body.net, body.net_error
        measured = f"scar {body.along:.4g} × {body.across:.4g} mm, {before} laid over it and taken off"
    else:
        volume, error = body.volume, body.volume_error
        counter = f"{body.sphere.radius:.5g} mm ({'given' if lengths['--radius'] else 'fitted'})"
        measured = f"patch {body.along:.4g} × {body.across:.4g} mm on a radius of {counter}"
    if volume <= 0.0:
        raise InputError(f"{file} has lost no volume: {volume:.3g} ± {error:.2g} mm³; a loss is needed")
    origin, measured = f"what the same sum finds on unworn surface{more}", f"{file}: {measured}"
    return volumes.WornVolume(volume=volume, error=error, error_from=origin, depth=depth, measured=measured)


def wear_rows(wear: volumes.WearCalibration, *, relation: str, worn: str | None) -> list[Row]:
    """Declare a wear coefficient. relation: how the volumes were found; worn: the body, if it is certain."""
    count, deviation, error = len(wear.volumes), wear.deviation, wear.uncertainty
    note, scatter, by_hardness = "; its uncertainty is unknown", "", ""
    if error is not None:
        note = f"(standard {'error' if count > 1 else 'uncertainty'}, {error / wear.mean:.2g} of K)"
    if deviation is not None:
        scatter = f"standard deviation of {count} tests ({deviation / wear.mean:.2g} of the mean)"
    if wear.hardness:
        by_hardness = f"dimensionless, with the hardness {wear.hardness:g} MPa (V = k F L/H)"
    spread, k = times(1e3, deviation), wear.dimensionless
    in_study = f'[wear] {worn or "counter or disc"} = "{scientific(1e3 * wear.mean)} mm^3/N/m"'
    return [
        Row("from", "relation", relation),
        Row("", "worn", worn),
        Row("load F", "load_N", wear.load, digits=6),
        Row("distance L", "distance_mm", wear.distance, digits=6),
        _k("K", wear.mean, error, note=note),
        Row("  or", "wear_coefficient_per_Pa", 1e-6 * wear.mean, scientific=True),
        Row("", "hardness_MPa", wear.hardness),
        Row("  or", "wear_coefficient_dimensionless", k, note=by_hardness, scientific=True),
        Row("", "count", count),
        Row("scatter", "standard_deviation_mm3_per_Nm", spread, digits=2, note=scatter, scientific=True),
        Row("", "standard_error_mm3_per_Nm", times(1e3, error) if count > 1 else None),
        Row("", "uses", "exact"),
        Row("in a study", "", in_study),
        Row("", "tests", [_test_rows(wear, test) for test in range(count)]),
    ]


def _test_rows(wear: volumes.WearCalibration, test: int) -> list[Row]:
    """Declare one of the tests."""
    worn, note, worn_too = wear.volumes[test], "", ""
    per_work = 1.0 / (wear.load * wear.distance)
    small, bulging = (times(1e3, times(per_work, v)) for v in (worn.approximate, worn.bulging))
    if small is not None and worn.approximate is not None:
        change = f"{worn.approximate / worn.volume - 1.0:+.2%}"
        note = f"for a small scar: K {scientific(small)}, {change}; not used, K is of the exact volume"
    if bulging is not None:
        worn_too = (
            f"by π d₁³ d₂/(64 R): K {scientific(bulging)}, if the longer diameter d₂ lies across sliding: "
            "the scar is then no cap"
        )
    doubted = worn.error is not None and worn.error > worn.volume / 3.0
    warning = "the volume is within three standard uncertainties of nothing" if doubted else None
    return [
        Row("measured", "measured", worn.measured),
        Row("  depth", "depth_um", times(1e3, worn.depth)),
        Row("  volume", "volume_mm3", worn.volume, digits=5, error=("volume_uncertainty_mm3", worn.error)),
        Row("  uncertainty", "uncertainty_from", worn.error_from),
        Row("  approximation", "volume_by_approximation_mm3", worn.approximate, digits=5, note=note),
        _k("  K", wear.values[test], wear.errors[test]),
        Row("", "by_approximation_mm3_per_Nm", small),
        Row("  disc worn, too", "volume_of_bulging_scar_mm3", worn.bulging, digits=5, note=worn_too),
        Row("", "of_bulging_scar_mm3_per_Nm", bulging),
        Row("  warning", "", warning),
    ]


def _k(label: str, value: float, error: float | None, *, note: str = "") -> Row:
    """Declare a wear coefficient and its standard uncertainty [mm²/N]."""
    key, uncertainty = "wear_coefficient_mm3_per_Nm", ("uncertainty_mm3_per_Nm", times(1e3, error))
    return Row(label, key, 1e3 * value, error=uncertainty, note=note, scientific=True)
