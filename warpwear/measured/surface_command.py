"""The command `warpwear surface`: from its options to the text it prints and the figure it writes."""

import json
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from pydantic import ValidationError

from warpwear.errors import InputError
from warpwear.measured.surface_figure import ball_figure, save, surface_figure, track_figure
from warpwear.measured.surface_report import (
    LAMBDA_C,
    LAMBDA_S,
    ball_page,
    ball_record,
    cap_page,
    cap_record,
    examine,
    page,
    track_page,
    track_record,
)
from warpwear.study.bodies import Disc
from warpwear.study.surface import surface_of
from warpwear.study.text import sentence
from warpwear.study.units import POSITIVE, parse
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.preparation import degree_of
from warpwear.surfaces.worn.ball import cap_of_diagonals, find_worn_ball
from warpwear.surfaces.worn.track import Track, find_track

FORMATS = (".png", ".pdf", ".svg")
LISTS = ("pixel", "crop")


def describe(
    file: Path | None,
    *,
    as_json: bool = False,
    figure: Path | None = None,
    overwrite: bool = False,
    track: bool = False,
    track_width: str | None = None,
    track_length: str | None = None,
    ball: bool = False,
    radius: str | None = None,
    diagonals: tuple[str, str] | None = None,
    lambda_c: str = "2.5 mm",
    lambda_s: str = "8 um",
    **preparation: str | None,
) -> str:
    """The text for people, or JSON; writes the figure. Lengths are text with a unit. Raises InputError.

    preparation: keys of [disc], as text.
    """
    _check_together(file, track=track, ball=ball, diagonals=diagonals)
    for name, value in (("--track-width", track_width), ("--track-length", track_length)):
        if value is not None and not track:
            raise InputError(f"{name} needs --track")
    if radius is not None and not ball:
        raise InputError("--radius needs --ball")
    if diagonals is not None:
        return _by_diagonals(diagonals, radius, as_json=as_json)
    assert file is not None  # checked together
    kind = "track" if track else "ball" if ball else "surface"
    wanted = figure if figure is not None or as_json else Path(f"{file.stem}-{kind}.png")
    if wanted is not None:
        _check_figure(wanted, overwrite=overwrite)
    level = preparation.get("level")
    if track or ball:  # the form is that of the unworn part
        preparation = preparation | {"level": "none"}
    surface = read_surface(file, preparation)
    if track:
        text, record, drawn = _track(
            surface,
            level=level,
            width=_length("--track-width", track_width),
            length=_length("--track-length", track_length),
            draw=wanted is not None,
        )
    elif ball:
        text, record, drawn = _ball(surface, radius=_length("--radius", radius), draw=wanted is not None)
    else:
        text, record, drawn = _roughness(
            surface,
            cut_off=_length("--lambda-c", lambda_c),
            short=_length("--lambda-s", lambda_s),
            draw=wanted is not None,
        )
    if drawn is not None and wanted is not None:
        save(drawn, wanted)
    if as_json:
        return json.dumps(record, indent=2, ensure_ascii=False)
    return f"{text}\nwritten to {wanted}"


Outcome = tuple[str, dict[str, Any], "Figure | None"]


def _roughness(surface: "Measured", *, cut_off: float | None, short: float | None, draw: bool) -> Outcome:
    report = examine(surface, cut_off=cut_off or LAMBDA_C, short=short or LAMBDA_S)
    drawn = None
    if draw:
        drawn = surface_figure(report)
    return page(report.record), report.record, drawn


def _track(
    surface: "Measured", *, level: str | None, width: float | None, length: float | None, draw: bool
) -> Outcome:
    track, degree = track_in(surface, level=level, width=width)
    file, found = surface.record(), track_record(track, length=length)
    drawn = None
    if draw:
        drawn = track_figure(track)
    return track_page(file, found, degree=degree), {"surface": file, "track": found}, drawn


def track_in(surface: "Measured", *, level: str | None, width: float | None) -> tuple["Track", int]:
    """The worn track of a surface read with level none, and the degree taken off beside it.

    level: as in [disc], as text; width [mm], None to find it. Raises InputError.
    """
    degree = degree_of(_level(level) if level is not None else "plane")
    if isinstance(degree, str):
        raise InputError("--level sphere is for a ball: allowed with --track is none, plane or a degree")
    return find_track(surface.levelled, pixel=surface.pixel, degree=degree, width=width), degree


def _ball(surface: "Measured", *, radius: float | None, draw: bool) -> Outcome:
    ball = find_worn_ball(surface.levelled, pixel=surface.pixel, radius=radius)
    cap = cap_of_diagonals(ball.along, ball.across, radius=ball.sphere.radius)
    file, found = surface.record(), ball_record(ball)
    drawn = None
    if draw:
        drawn = ball_figure(ball, size=surface.size)
    record = {"surface": file, "ball": found, "by_two_diagonals": cap_record(cap)}
    return ball_page(file, found, cap), record, drawn


def _by_diagonals(diagonals: tuple[str, str], radius: str | None, *, as_json: bool) -> str:
    given = _length("--radius", radius)
    if given is None:
        raise InputError("--diagonals needs --radius, a length such as '3 mm'")
    first, second = (_length("--diagonals", d) or 0.0 for d in diagonals)
    cap = cap_of_diagonals(first, second, radius=given)
    return json.dumps(cap_record(cap), indent=2) if as_json else cap_page(cap)


def read_surface(file: Path, preparation: dict[str, str | None]) -> "Measured":
    """A measured file, prepared by keys of [disc] that are given as text. Raises InputError."""
    given: dict[str, Any] = {name: value for name, value in preparation.items() if value is not None}
    for name in LISTS:
        if name in given and "," in given[name]:
            given[name] = [part.strip() for part in given[name].split(",")]
    if "level" in given:
        given["level"] = _level(given["level"])
    if "outliers" in given:
        try:
            given["outliers"] = float(given["outliers"])
        except ValueError:
            raise InputError(
                f"--outliers is {given['outliers']!r}: allowed is a number of robust standard deviations, "
                "such as 6"
            ) from None
    try:
        disc = Disc(surface=str(file), **given)
    except ValidationError as error:
        raise InputError(f"disc.{sentence(error, Disc)}") from error
    surface: Any = surface_of(disc)
    return surface


def _level(text: str) -> str | int:
    return int(text) if text.strip().isdecimal() else text


def _length(option: str, value: str | None) -> float | None:
    if value is None:
        return None
    try:
        return POSITIVE.check(parse(value, "mm"), "mm")
    except ValueError as error:
        raise InputError(f"{option} = {value!r}: {error}") from error


def _check_together(file: Path | None, *, track: bool, ball: bool, diagonals: tuple[str, str] | None) -> None:
    if track and ball:
        raise InputError("--track and --ball exclude each other")
    if diagonals is not None and not ball:
        raise InputError("--diagonals needs --ball")
    if diagonals is not None and file is not None:
        raise InputError("--diagonals are for a ball without a FILE: leave one of them out")
    if diagonals is None and file is None:
        raise InputError("FILE is missing: a measured surface, or --ball with --radius and --diagonals")


def _check_figure(path: Path, *, overwrite: bool) -> None:
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"--figure is {path}: allowed endings are {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise InputError(f"--figure is {path}: the folder {path.parent} does not exist")
    if path.exists() and not overwrite:
        raise InputError(f"{path} is there already: give another --figure, or --overwrite")
