"""Run the command `warpwear surface`, from its options to the text it prints and the figure it writes."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from warpwear.errors import InputError
from warpwear.figures.describe import Figure
from warpwear.grid import FloatArray
from warpwear.measured import profile_report, surface_report
from warpwear.measured.options import optional, quantity, refuse
from warpwear.measured.surface_figure import ball_figure, save, scar_figure, surface_figure, track_figure
from warpwear.results.report import Row, lines, record, to_json
from warpwear.study.bodies import Disc
from warpwear.study.loading import value_of_text
from warpwear.study.surface import surface_of
from warpwear.study.text import sentence
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.preparation import degree_of
from warpwear.surfaces.profiles.profile import Profile, parameters, read_profile
from warpwear.surfaces.reading import HoldsAProfile
from warpwear.surfaces.worn.ball import cap_of_diagonals, find_worn_ball
from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.patch import Patch
from warpwear.surfaces.worn.registration import Difference, difference
from warpwear.surfaces.worn.track import Track, find_groove, find_track
from warpwear.surfaces.worn.waviness import CHANGED, ROUGH

#: Endings of files that a figure can be written to.
FORMATS = (".png", ".pdf", ".svg")
#: Keys of [disc] that may hold several values, separated by commas.
LISTS = ("pixel", "crop")
#: Keys that may hold a number without a unit.
NUMBERS = ("outliers", "level")
#: Keys of [disc] that say how a profile is read, too.
LINE = ("pixel", "height_unit", "height_sign", "array", "level")
#: Names of keys that sentences about [disc] name.
KEYS = re.compile(rf"\bdisc\.({'|'.join(Disc.model_fields)})\b")


@dataclass(frozen=True, kw_only=True)
class SurfaceOptions:
    """These are the options of `warpwear surface`, lengths as text with a unit.

    figure: where to draw, None for a name made from the file's. no_figure: whether nothing is drawn.
    track, ball: whether the file is a worn one. before: the same place before it was worn. line: axis and
    place of a line of a map, which is taken as a profile. lambda_c, lambda_s: None for the defaults.
    preparation: keys of [disc], as text, None for those not given.
    """

    as_json: bool = False
    figure: Path | None = None
    no_figure: bool = False
    overwrite: bool = False
    track: bool = False
    track_width: str | None = None
    track_length: str | None = None
    before: Path | None = None
    ball: bool = False
    radius: str | None = None
    diagonals: tuple[str, str] | None = None
    lambda_c: str | None = None
    lambda_s: str | None = None
    line: str | None = None
    preparation: Mapping[str, str | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """A file is described by rows, for JSON and for people, and by a figure."""

    file: dict[str, Any]  # the surface's own record
    rows: list[Row]
    draw: Callable[[], Figure]
    done: tuple[str, ...] = ()  # what was done to the surface after its own operations
    profile: tuple[Row, ...] = ()  # what was read, of a profile

    @property
    def text(self) -> list[str]:
        """Return the lines for people."""
        if self.profile:
            return profile_report.profile_lines([*self.profile], self.rows)
        return [*surface_report.file_lines(self.file, *self.done), *lines(self.rows)]


def describe(file: Path | None, options: SurfaceOptions) -> str:
    """Say what is in a measured file, as text for people or as JSON, and write its figure.

    file: None where the diagonals of a ball are given. Raises InputError.
    """
    _check_together(file, options)
    if options.diagonals is not None:
        return _by_diagonals(options.diagonals, options.radius, as_json=options.as_json)
    assert file is not None  # checked together
    kind = "track" if options.track else "ball" if options.ball else "scar" if options.before else "surface"
    figure, notice = options.figure, ""
    if figure is not None:
        _check_figure(figure, overwrite=options.overwrite)
    elif not (options.as_json or options.no_figure):
        figure = Path(f"{file.name}-{kind}.png")
        if figure.exists() and not options.overwrite:  # the numbers are asked for all the same
            notice = f"{figure} is there already and was not drawn again: --overwrite replaces it"
            figure = None
    outcome = _outcome(file, kind, options)
    if figure is not None:
        save(outcome.draw(), figure)
    if options.as_json:
        return _with_options(to_json(record([*outcome.profile, *outcome.rows])))
    end = notice if figure is None else f"written to {figure}"
    return "\n".join([_with_options("\n".join(outcome.text)), *([end] if end else [])])


def _outcome(file: Path, kind: str, options: SurfaceOptions) -> Outcome:
    """Examine what a file holds, a map or a profile. Raises InputError."""
    # The form of a worn body is that of its unworn part.
    level = {} if kind == "surface" and options.line is None else {"level": "none"}
    try:
        surface = read_surface(file, {**options.preparation, **level})
    except HoldsAProfile:
        if kind not in ("surface", "track") or options.line is not None:
            raise
        return _profile(_profile_in(file, options.preparation), kind, options)
    if options.line is not None:
        return _profile(profile_report.line_of(surface, options.line), kind, options)
    return {"surface": _roughness, "track": _track, "ball": _ball, "scar": _scar}[kind](surface, options)


def _profile_in(file: Path, preparation: Mapping[str, str | None]) -> Profile:
    """Read the profile in a file. Raises InputError, for options that are for maps, too."""
    options = {f"--{key.replace('_', '-')}": value for key, value in preparation.items() if key not in LINE}
    refuse(options, "is for a map of heights, and FILE holds a profile")
    try:
        return read_profile(
            file,
            spacing=optional("--pixel", preparation.get("pixel"), "mm"),
            height_unit=preparation.get("height_unit"),
            array=preparation.get("array"),
            down=preparation.get("height_sign") == "down",
        )
    except InputError as error:
        raise InputError(_with_options(str(error))) from error


def _profile(profile: Profile, kind: str, options: SurfaceOptions) -> Outcome:
    """Examine a profile, or the groove in it. Raises InputError."""
    of_maps = {"--track-length": options.track_length, "--before": options.before}
    refuse(of_maps, "is for a map of heights, and this is a profile")
    degree = _degree(options.preparation.get("level"))
    fitted_to = " through the profile beside the groove" if kind == "track" else ""
    head = tuple(profile_report.profile_rows(profile, degree, beside=fitted_to))
    if kind == "track":
        width = optional("--track-width", options.track_width, "mm")
        groove = find_groove(profile, degree=degree, width=width)
        rows = profile_report.groove_rows(groove)
        draw: Callable[[], Figure] = partial(profile_report.groove_figure, groove)
    else:
        cut_off = optional("--lambda-c", options.lambda_c, "mm")
        level = profile.levelled(degree)
        result = parameters(level, cut_off=cut_off, short=optional("--lambda-s", options.lambda_s, "mm"))
        rows, draw = (
            profile_report.parameter_rows(result),
            partial(profile_report.profile_figure, level, result),
        )
    return Outcome({}, rows, draw, profile=head)


def _roughness(surface: Measured, options: SurfaceOptions) -> Outcome:
    """Examine a surface as it is."""
    cut_off = optional("--lambda-c", options.lambda_c, "mm") or surface_report.LAMBDA_C
    short = optional("--lambda-s", options.lambda_s, "mm") or surface_report.LAMBDA_S
    report = surface_report.examine(surface, cut_off=cut_off, short=short)
    return Outcome(record(report.rows), report.rows, lambda: surface_figure(report))


def _track(surface: Measured, options: SurfaceOptions) -> Outcome:
    """Measure the worn track in a surface. Raises InputError."""
    width = optional("--track-width", options.track_width, "mm")
    length = optional("--track-length", options.track_length, "mm")
    track, changed, degree = track_in(surface, options.before, options.preparation, width=width)
    row = Row("", "track", surface_report.track_rows(track, length=length))
    return _worn(surface, options, changed, degree, row, lambda: track_figure(track, filled=track.missing))


def _scar(surface: Measured, options: SurfaceOptions) -> Outcome:
    """Measure the wear scar in a surface, of which the same place is known before. Raises InputError."""
    scar, changed, degree = scar_in(surface, options.before, options.preparation)
    assert changed is not None  # --before makes it a scar
    missing = np.isnan(changed.heights)
    row = Row("", "scar", surface_report.scar_rows(scar, filled=float(missing[scar.patch].mean())))
    return _worn(surface, options, changed, degree, row, lambda: scar_figure(scar, filled=missing))


def _worn(
    surface: Measured,
    options: SurfaceOptions,
    changed: Difference | None,
    degree: int,
    row: Row,
    draw: Callable[[], Figure],
) -> Outcome:
    """Describe a worn disc, which was levelled by a degree, with or without what it was before."""
    file, before = surface.record(), options.before
    done = f"polynomial of degree {degree} through the surface beside the {row.key} taken off"
    rows = [Row("", "surface", file), row]
    if changed is not None:
        done = f"{before} laid over it and taken off, {done}"
        rows.insert(1, Row("before", "before", surface_report.before_rows(changed, file=str(before))))
    return Outcome(file, rows, draw, (done,))


def scar_in(
    surface: Measured, before: Path | None, preparation: Mapping[str, str | None]
) -> tuple[Patch, Difference | None, int]:
    """Find the wear scar of a surface read with level none, and the degree taken off beside it.

    before: the same place before it was worn, None to level the surface alone; preparation: keys of [disc].
    Raises InputError.
    """
    heights, changed, degree = _less_before(surface, before, preparation)
    hurst = ROUGH if changed is None else CHANGED
    return find_scar(heights, pixel=surface.pixel, degree=degree, hurst=hurst), changed, degree


def track_in(
    surface: Measured, before: Path | None, preparation: Mapping[str, str | None], *, width: float | None
) -> tuple[Track, Difference | None, int]:
    """Find the worn track of a surface, as `scar_in`; width [mm], None to find it. Raises InputError."""
    heights, changed, degree = _less_before(surface, before, preparation)
    return find_track(heights, pixel=surface.pixel, degree=degree, width=width), changed, degree


def groove_in(
    file: Path, before: Path | None, preparation: Mapping[str, str | None], *, width: float | None
) -> tuple[Track, int]:
    """Find the worn track in a file with a map of heights, or with a profile across it, and its degree.

    Raises InputError.
    """
    try:
        surface = read_surface(file, {**preparation, "level": "none"})
    except HoldsAProfile:
        refuse({"--before": before}, "is for a map of heights, and this is a profile")
        degree = _degree(preparation.get("level"))
        return find_groove(_profile_in(file, preparation), degree=degree, width=width), degree
    track, _, degree = track_in(surface, before, preparation, width=width)
    return track, degree


def _less_before(
    surface: Measured, before: Path | None, preparation: Mapping[str, str | None]
) -> tuple[FloatArray, Difference | None, int]:
    """Take an earlier measurement, if there is one, off a surface; and find the degree to level by."""
    degree = _degree(preparation.get("level"))
    if before is None:
        return surface.measured, None, degree
    earlier = read_surface(before, {**preparation, "level": "none", "crop": None})
    changed = difference(surface.measured, earlier.measured, pixel=surface.pixel, earlier_pixel=earlier.pixel)
    return changed.heights, changed, degree


def _degree(level: str | None) -> int:
    """Return the degree of --level for a worn disc. Raises InputError for a form."""
    degree = degree_of("plane" if level is None else value_of_text(level))
    if isinstance(degree, str):
        raise InputError(f"--level {degree} is for a ball or a roller: allowed is none, plane or a degree")
    return degree


def _ball(surface: Measured, options: SurfaceOptions) -> Outcome:
    """Measure the worn patch of a ball. Raises InputError."""
    radius = optional("--radius", options.radius, "mm")
    ball = find_worn_ball(surface.measured, pixel=surface.pixel, radius=radius)
    flat = cap_of_diagonals(ball.along, ball.across, radius=ball.sphere.radius)
    two_diagonals = surface_report.cap_rows(flat)
    file = surface.record()
    rows = [
        Row("", "surface", file),
        Row("", "ball", surface_report.ball_rows(ball)),
        Row("by two diagonals", "by_two_diagonals", two_diagonals, note=", were the patch flat"),
    ]
    return Outcome(file, rows, lambda: ball_figure(ball, size=surface.size, filled=surface.filled))


def _by_diagonals(diagonals: tuple[str, str], radius: str | None, *, as_json: bool) -> str:
    """Say what two diagonals of a ball's worn patch mean. Raises InputError."""
    if radius is None:
        raise InputError("--diagonals needs --radius, a length such as '3 mm'")
    first, second = (quantity("--diagonals", diagonal, "mm") for diagonal in diagonals)
    rows = surface_report.cap_rows(cap_of_diagonals(first, second, radius=quantity("--radius", radius, "mm")))
    if as_json:
        return to_json(record(rows))
    return f"worn ball by two diagonals: {Row('', '', rows).text} (a flat patch)"


def read_surface(file: Path, preparation: Mapping[str, str | None]) -> Measured:
    """Read a measured file, prepared by keys of [disc] that are given as text. Raises InputError."""
    values: dict[str, Any] = {name: value for name, value in preparation.items() if value is not None}
    for name in LISTS:
        if "," in values.get(name, ""):
            values[name] = [part.strip() for part in values[name].split(",")]
    for name in values.keys() & set(NUMBERS):
        values[name] = value_of_text(values[name])
    try:
        surface: Any = surface_of(Disc(surface=str(file), **values))
    except ValidationError as error:
        raise InputError(_with_options(f"disc.{sentence(error, Disc)}")) from error
    except InputError as error:
        raise InputError(_with_options(str(error))) from error
    if surface.is_profile:
        raise HoldsAProfile(f"the file '{file}' holds a profile (line scan), and no map of heights")
    return surface


def _with_options(text: str) -> str:
    """Say in a text about [disc] what its keys are called here: --height-unit for disc.height_unit."""
    text = text.replace("disc.surface '", "the file '").replace("disc.surface is", "the file is")
    return KEYS.sub(lambda match: f"--{match[1].replace('_', '-')}", text)


def _check_together(file: Path | None, options: SurfaceOptions) -> None:
    """Raise InputError where options exclude or need each other."""
    o = options
    if o.track and o.ball:
        raise InputError("--track and --ball exclude each other")
    if not o.ball:
        refuse({"--diagonals": o.diagonals}, "needs --ball")
    if o.diagonals is not None and file is not None:
        raise InputError("--diagonals are for a ball without a FILE: leave one of them out")
    if o.diagonals is None and file is None:
        raise InputError("FILE is missing: a measured surface, or --ball with --radius and --diagonals")
    if o.no_figure:
        refuse({"--figure": o.figure}, "is not for --no-figure")
    if not o.track:
        refuse({"--track-width": o.track_width, "--track-length": o.track_length}, "needs --track")
    if o.ball or o.before is not None:
        refuse({"--line": o.line}, "is not for --ball or --before")
    if o.ball:
        refuse({"--before": o.before}, "is not for a --ball, which is measured against its sphere")
    else:
        refuse({"--radius": o.radius}, "needs --ball")


def _check_figure(path: Path, *, overwrite: bool) -> None:
    """Raise InputError for a figure that cannot be written."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"--figure is {path}: allowed endings are {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise InputError(f"--figure is {path}: the folder {path.parent} does not exist")
    if path.exists() and not overwrite:
        raise InputError(f"{path} is there already: give another --figure, or --overwrite")
