"""Run the command `warpwear surface`, from its options to the text it prints and the figure it writes."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from pydantic import ValidationError

from warpwear.errors import InputError
from warpwear.figures.describe import Figure
from warpwear.measured import profile_report, surface_report
from warpwear.measured.options import Options, flag, optional, quantity, refuse
from warpwear.measured.surface_figure import groove_figure, patch_figure, save, surface_figure, track_figure
from warpwear.results.report import Row, lines, record, to_json
from warpwear.study.bodies import Disc
from warpwear.study.loading import value_of_text
from warpwear.study.surface import surface_of
from warpwear.study.text import sentence
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.preparation import degree_of
from warpwear.surfaces.profiles.profile import Profile, parameters, read_profile
from warpwear.surfaces.reading import HoldsAProfile
from warpwear.surfaces.worn.ball import cap_of_diagonals, find_worn_ball
from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.registration import Difference, difference
from warpwear.surfaces.worn.track import find_groove, find_track
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
#: Option -> the one that it needs, and pairs that exclude each other.
NEEDED = {"--diagonals": "--ball", "--radius": "--ball"} | dict.fromkeys(
    ("--track-width", "--track-length"), "--track"
)
APART = (
    ("--track", "--ball"),
    ("--line", "--ball"),
    ("--line", "--before"),
    ("--before", "--ball"),
    ("--figure", "--no-figure"),
)
OF_MAPS = "is for a map of heights, and this is a profile"

#: Keys of [disc] as text, None for those not given.
Preparation: TypeAlias = Mapping[str, str | None]
Kind: TypeAlias = Literal["track", "scar", "ball"]
#: What is said of a file: lines for people, rows for JSON, what makes the figure.
Outcome: TypeAlias = tuple[list[str], list[Row], Callable[[], Figure]]


def describe(file: Path | None, preparation: Preparation, **options: Any) -> str:
    """Say what is in a measured file, as text for people or as JSON, and write its figure.

    file: None where the diagonals of a ball are given. options: of `warpwear surface`, lengths as text with a
    unit: figure, where to draw, by default a name made from the file's; no_figure; overwrite; as_json;
    track, ball: whether the file is a worn one; before: the same place before it was worn; line: axis and
    place of a line of a map, which is taken as a profile; diagonals; track_width, track_length, radius,
    lambda_c, lambda_s. Raises InputError.
    """
    o = Options(options)
    _check_together(file, o)
    if file is None:
        return _by_diagonals(o)
    kind: Kind | None = "track" if o["--track"] else "ball" if o["--ball"] else None
    kind = "scar" if kind is None and o["--before"] else kind
    figure, notice = o["--figure"], ""
    if figure is not None:
        _check_figure(figure, overwrite=o["--overwrite"])
    elif not (o["as_json"] or o["--no-figure"]):
        figure = Path(f"{file.name}-{kind or 'surface'}.png")
        if figure.exists() and not o["--overwrite"]:  # the numbers are asked for all the same
            notice = f"{figure} is there already and was not drawn again: --overwrite replaces it"
            figure = None
    if kind is None:
        text, rows, draw = _as_it_is(file, preparation, o)
    else:
        text, rows, draw = _worn(file, kind, preparation, o)
    if figure is not None:
        save(draw(), figure)
        notice = f"written to {figure}"
    if o["as_json"]:
        return _with_options(to_json(record(rows)))
    return "\n".join([_with_options("\n".join(text)), *([notice] if notice else [])])


def _as_it_is(file: Path, preparation: Preparation, o: Options) -> Outcome:
    """Examine a surface, or a profile: a file's, or a line of a map. Raises InputError."""
    cut_off, short, line = o.optional("--lambda-c", "mm"), o.optional("--lambda-s", "mm"), o["--line"]
    try:
        surface = read_surface(file, preparation if line is None else {**preparation, "level": "none"})
    except HoldsAProfile:
        if line is not None:
            raise
        profile = _profile_in(file, preparation)
    else:
        if line is None:
            defaults = surface_report.LAMBDA_C, surface_report.LAMBDA_S
            filters = {"cut_off": cut_off or defaults[0], "short": short or defaults[1]}
            report = surface_report.examine(surface, **filters)
            return report.text, report.rows, partial(surface_figure, report)
        profile = profile_report.line_of(surface, line)
    degree = _degree(preparation.get("level"))
    level = profile.levelled(degree)
    result = parameters(level, cut_off=cut_off, short=short)
    rows = [*profile_report.profile_rows(profile, degree), *profile_report.parameter_rows(result)]
    return profile_report.profile_lines(rows), rows, partial(profile_report.profile_figure, level, result)


@dataclass(frozen=True, eq=False)
class Worn:
    """A worn body was found in a file.

    body: a Track, a Patch or a WornBall; source: the map that it is in, or the profile; missing: points that
    were not measured, shape (nx, ny); changed: what an earlier measurement was laid over, if there is one;
    degree: of the polynomial taken off beside it.
    """

    body: Any
    source: Any
    missing: BoolArray
    changed: Difference | None = None
    degree: int = 0


def worn_in(
    file: Path,
    kind: Kind,
    preparation: Preparation,
    *,
    before: Path | None = None,
    width: float | None = None,
    radius: float | None = None,
    line: str | None = None,
) -> Worn:
    """Find the worn track, scar or ball in a file, a track also in a profile across it.

    before: the same place before it was worn; width of a track, radius of a ball [mm], None to find them;
    line: of a map, which is taken as a profile. The form of a worn body is that of its unworn part. Raises
    InputError.
    """
    profile, degree = None, 0 if kind == "ball" else _degree(preparation.get("level"))
    try:
        surface = read_surface(file, {**preparation, "level": "none"})
    except HoldsAProfile:
        if kind != "track" or line is not None:
            raise
        profile = _profile_in(file, preparation)
    if line is not None:
        profile = profile_report.line_of(surface, line)
    if profile is not None:
        refuse({"--before": before}, OF_MAPS)
        return Worn(find_groove(profile, degree=degree, width=width), profile, profile.missing, None, degree)
    heights, pixel, changed = surface.measured, surface.pixel, None
    if before is not None:
        earlier = read_surface(before, {**preparation, "level": "none", "crop": None})
        changed = difference(heights, earlier.measured, pixel=pixel, earlier_pixel=earlier.pixel)
        heights = changed.heights
    body: Any
    if kind == "ball":
        body = find_worn_ball(heights, pixel=pixel, radius=radius)
    elif kind == "track":
        body = find_track(heights, pixel=pixel, degree=degree, width=width)
    else:
        hurst = ROUGH if changed is None else CHANGED
        body = find_scar(heights, pixel=pixel, degree=degree, hurst=hurst)
    return Worn(body, surface, np.isnan(heights), changed, degree)


def _worn(file: Path, kind: Kind, preparation: Preparation, o: Options) -> Outcome:
    """Measure a worn body. Raises InputError."""
    before, length = o["--before"], o.optional("--track-length", "mm")
    sizes: Any = {"width": o.optional("--track-width", "mm"), "radius": o.optional("--radius", "mm")}
    worn = worn_in(file, kind, preparation, before=before, line=o["--line"], **sizes)
    body, missing, degree = worn.body, worn.missing, worn.degree
    if isinstance(worn.source, Profile):
        o.refuse("--track-length", why=OF_MAPS)
        beside = " through the profile beside the groove"
        rows = [*profile_report.profile_rows(worn.source, degree, beside), *profile_report.groove_rows(body)]
        return profile_report.profile_lines(rows), rows, partial(groove_figure, body)
    own, done = worn.source.record(), f"polynomial of degree {degree} through the surface beside the {kind} "
    done += "taken off"
    rows = [Row("", "surface", own)]
    if worn.changed is not None:
        done = f"{before} laid over it and taken off, {done}"
        rows.append(Row("before", "before", surface_report.before_rows(worn.changed, file=str(before))))
    if kind == "track":
        rows.append(Row("", kind, surface_report.track_rows(body, length=length)))
    else:
        filled = float(missing[body.patch].mean())
        rows.append(Row("", kind, surface_report.patch_rows(body, filled=filled)))
    if kind == "ball":
        flat = cap_of_diagonals(body.along, body.across, radius=body.sphere.radius)
        cap = surface_report.cap_rows(flat)
        rows.append(Row("by two diagonals", "by_two_diagonals", cap, note=", were the patch flat"))
    draw = track_figure if kind == "track" else patch_figure
    text = surface_report.file_lines(own, *([] if kind == "ball" else [done]))
    return [*text, *lines(rows)], rows, lambda: draw(body, filled=missing)


def _profile_in(file: Path, preparation: Preparation) -> Profile:
    """Read the profile in a file. Raises InputError, for options that are for maps, too."""
    of_maps = {flag(key): value for key, value in preparation.items() if key not in LINE}
    refuse(of_maps, "is for a map of heights, and FILE holds a profile")
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


def _degree(level: str | None) -> int:
    """Return the degree of --level for a worn disc. Raises InputError for a form."""
    degree = degree_of("plane" if level is None else value_of_text(level))
    if isinstance(degree, str):
        raise InputError(f"--level {degree} is for a ball or a roller: allowed is none, plane or a degree")
    return degree


def _by_diagonals(o: Options) -> str:
    """Say what two diagonals of a ball's worn patch mean. Raises InputError."""
    radius = o.optional("--radius", "mm")
    if radius is None:
        raise InputError("--diagonals needs --radius, a length such as '3 mm'")
    first, second = (quantity("--diagonals", diagonal, "mm") for diagonal in o["--diagonals"])
    rows = surface_report.cap_rows(cap_of_diagonals(first, second, radius=radius))
    if o["as_json"]:
        return to_json(record(rows))
    return f"worn ball by two diagonals: {Row('', '', rows).text} (a flat patch)"


def read_surface(file: Path, preparation: Preparation) -> Measured:
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
    return KEYS.sub(lambda match: flag(match[1]), text)


def _check_together(file: Path | None, o: Options) -> None:
    """Raise InputError where options exclude or need each other."""
    for one, other in APART:
        if o[one] and o[other]:
            raise InputError(f"{one} and {other} exclude each other")
    for option, needed in NEEDED.items():
        if not o[needed]:
            o.refuse(option, why=f"needs {needed}")
    if (file is None) != (o["--diagonals"] is not None):
        what = "FILE is missing" if file is None else "--diagonals stand for FILE"
        raise InputError(f"{what}: allowed is a measured surface, or --ball with --radius and --diagonals")


def _check_figure(path: Path, *, overwrite: bool) -> None:
    """Raise InputError for a figure that cannot be written."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"--figure is {path}: allowed endings are {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise InputError(f"--figure is {path}: the folder {path.parent} does not exist")
    if path.exists() and not overwrite:
        raise InputError(f"{path} is there already: give another --figure, or --overwrite")
