"""Kinds of measurement from which a worn volume follows, and the volume of each."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.calibration import wear as volumes
from warpwear.calibration.measurements import MeasuredTest, size_and_error
from warpwear.errors import InputError, prose
from warpwear.measured.surface import Kind, Preparation, worn_in


@dataclass(frozen=True)
class Source:
    """Describe a kind of measurement.

    relation: how a volume follows from it; worn: the body, where that is certain; needs, may_have: lengths
    that it must and can be given with; file: what is looked for in it, where it is a measured file.
    """

    relation: str
    worn: str | None = None
    needs: Sequence[str] = ()
    may_have: Sequence[str] = ()
    file: Kind | None = None


#: Kinds of measurement and ASTM test methods, see there.
TEXTS = prose("worn")
#: Key of a test -> what a worn volume follows from.
SOURCES = {key: Source(**said) for key, said in TEXTS["sources"].items()}


def sources_of(test: MeasuredTest) -> list[str]:
    """Name what the worn volume of a test may follow from."""
    return [name for name in SOURCES if getattr(test, name) is not None]


def worn_volume(
    test: MeasuredTest, source: str, named: str, *, preparation: Preparation
) -> volumes.WornVolume:
    """Find the volume that was worn in a test.

    source: of `SOURCES`; named: what sentences call the test; preparation: keys of [disc], as text, for a
    measured file. Raises InputError.
    """
    kind, value = SOURCES[source], getattr(test, source)
    _check(test, source, named, preparation)
    if kind.file is not None:
        return _of_file(kind.file, value, test, preparation)
    (size, error), needed = size_and_error(value), {name: _needed(test, name) for name in kind.needs}
    match source:
        case "scar":
            known = any(each.error is not None for each in value)
            return volumes.cap(*(d.value for d in value), **needed, error=error if known else None)
        case "section":
            return volumes.groove(size, **needed, error=error)
        case "width":
            return volumes.circular_track(size, **needed, error=error)
    return volumes.volume_given(size, error=error)


def _needed(test: MeasuredTest, name: str) -> Any:
    """Return a length that a source needs."""
    return test.way_of_groove if name == "track_length" else getattr(test, name)


def _check(test: MeasuredTest, source: str, named: str, preparation: Preparation) -> None:
    """Raise InputError for keys of a test, or a preparation, that do not go with what was measured."""
    kind, label = SOURCES[source], f"{named}.{source}"
    for name in kind.needs:
        if _needed(test, name) is None:
            which = (
                "that of the whole track, such as '30 mm', or track_radius"
                if name == "track_length"
                else "such as '3 mm'"
            )
            raise InputError(f"{label} needs {named}.{name}, {which}")
    prepared = [name.replace("_", "-") for name, value in preparation.items() if value is not None]
    if kind.file is None and prepared:
        raise InputError(f"--{prepared[0]} is not for {label}: it prepares a measured file")
    if source == "ball" and "level" in prepared:
        raise InputError(f"--level is not for {label}: its form is the sphere through what is unworn")
    if test.before is None and source == "after":
        raise InputError(f"{label} needs {named}.before, the same place before the test")


def _of_file(kind: Kind, file: Any, test: MeasuredTest, preparation: Preparation) -> volumes.WornVolume:
    """Find the volume that a track, a scar or a ball lost from a topography, or from a profile of a track.

    Raises InputError.
    """
    before = None if test.before is None else Path(test.before)
    sizes: Any = {"width": test.track_width, "radius": test.radius}
    worn = worn_in(Path(file), kind, preparation, before=before, **sizes)
    body, depth, more = worn.body, worn.body.depth, ""
    if kind == "track":
        length = test.way_of_groove or 0.0
        if length < body.length * (1.0 - 1e-9):
            raise InputError(
                f"track_length is {length:g} mm: allowed is at least the piece in {file}, {body.length:g} mm"
            )
        if body.net.size == 1:
            more = ", but not how sections scatter along the track: list more profiles of it under one name"
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
        counter = f"{body.sphere.radius:.5g} mm ({'given' if test.radius else 'fitted'})"
        measured = f"patch {body.along:.4g} × {body.across:.4g} mm on a radius of {counter}"
    if volume <= 0.0:
        raise InputError(f"{file} has lost no volume: {volume:.3g} ± {error:.2g} mm³; a loss is needed")
    origin, measured = f"what the same sum finds on unworn surface{more}", f"{file}: {measured}"
    return volumes.WornVolume(volume=volume, error=error, error_from=origin, depth=depth, measured=measured)
