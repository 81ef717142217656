"""Read measured surfaces, profiles and worn bodies, and say what is in them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypedDict, Unpack, get_args

import numpy as np
from pydantic import ValidationError

from warpwear.errors import InputError, named_in_python, reworded
from warpwear.measured import profile_report, surface_report
from warpwear.measured.options import Options, flag, optional, quantity, refuse, with_unit
from warpwear.measured.report import FileReport
from warpwear.measured.surface_figure import groove_figure, patch_figure, surface_figure, track_figure
from warpwear.measured.surface_report import LAMBDA_C, LAMBDA_S, MeasuredSurface
from warpwear.results.report import Row, lines
from warpwear.study.bodies import Disc
from warpwear.study.loading import value_of_text
from warpwear.study.surface import surface_of
from warpwear.study.text import sentence
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.preparation import degree_of
from warpwear.surfaces.profiles.profile import Parameters, Profile, far_off, parameters, profile_in
from warpwear.surfaces.reading import HoldsAProfile
from warpwear.surfaces.worn.ball import cap_of_diagonals, find_worn_ball
from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.registration import Difference, difference
from warpwear.surfaces.worn.track import find_groove, find_track
from warpwear.surfaces.worn.waviness import CHANGED, ROUGH

#: Keys of [disc] that are lengths, those that may hold several values, and those without a unit.
LENGTHS, LISTS, NUMBERS = ("pixel", "crop", "s_filter", "l_filter"), ("pixel", "crop"), ("outliers", "level")
#: Keys of [disc] that say how a profile is read, too.
LINE = ("pixel", "height_unit", "height_sign", "array", "level", "crop", "outliers")
#: Names of keys that sentences about [disc] name.
KEYS = re.compile(rf"\bdisc\.({'|'.join(Disc.model_fields)})\b")
#: Option -> the one that it needs, and pairs that exclude each other.
NEEDED = dict.fromkeys(("--diagonals", "--radius"), "--ball")
NEEDED |= dict.fromkeys(("--track-width", "--track-length"), "--track")
APART = {"--track": ("--ball",), "--line": ("--ball", "--scar", "--before"), "--before": ("--ball",)}
OF_MAPS = "is for a map of heights, and this is a profile"

#: A number in mm, or text with its unit.
Length: TypeAlias = float | str
Kind: TypeAlias = Literal["track", "scar", "ball"]
#: Keys of `HowToRead`, None for those not given.
Preparation: TypeAlias = Mapping[str, Any]


class HowToRead(TypedDict, total=False):
    """A measured file is read as keys of [disc] say. Lengths are numbers in mm, or text such as "8 um"."""

    pixel: Length | tuple[Length, Length]
    height_unit: Literal["m", "mm", "um", "µm", "nm"]
    array: str
    height_sign: Literal["up", "down"]
    crop: Length | tuple[Length, ...]
    sliding_axis: Literal["x", "y"]
    outliers: float
    level: int | Literal["none", "plane", "sphere", "cylinder"]
    s_filter: Length
    l_filter: Length
    extend: Literal["refuse", "mirror", "periodic"]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MeasuredProfile(FileReport):
    """A measured profile has heights over places, and parameters of ISO 21920.

    Attributes
    ----------
    profile : Profile
        Heights over places [mm], shape (n,).
    parameters : Parameters
        Of ISO 21920-2 [mm].
    """

    profile: Profile
    parameters: Parameters


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class WornBody(FileReport):
    """A worn body has lost a volume, or a groove in a profile a section; `numbers` has them with errors.

    Attributes
    ----------
    body : Track, Patch or WornBall
        By its arrays.
    source : Measured or Profile
        The map that it is in, or the profile.
    missing : array of bool
        Points that were not measured, shape (nx, ny).
    changed : Difference or None
        How an earlier measurement was laid over it.
    degree : int
        Of the polynomial taken off beside it.
    """

    body: Any
    source: Any
    missing: BoolArray
    changed: Difference | None = None
    degree: int = 0


@named_in_python()
def read_surface(
    path: str | Path, *, lambda_c: Length = LAMBDA_C, lambda_s: Length = LAMBDA_S, **how: Unpack[HowToRead]
) -> MeasuredSurface:
    """Read a measured surface and find its roughness, bearing curve and spectrum.

    Parameters
    ----------
    path
        A file of any format that a study takes.
    lambda_c, lambda_s
        Cut-offs of the roughness profiles [mm], or text with a unit.
    **how
        How it is read and prepared, by the keys of [disc]: pixel, height_unit, array, height_sign, crop,
        sliding_axis, outliers, level, s_filter, l_filter, extend. Lengths are numbers in mm, or text such as
        "8 um".

    Returns
    -------
    MeasuredSurface
        Heights, numbers, spectrum and a figure.

    Raises
    ------
    InputError
        Where the file holds no map of heights, or for a value that is not allowed; the sentence names its
        option.
    TypeError
        For an unknown option.

    References
    ----------
    ISO 25178-2 (parameters), ISO 16610 (filters); Jacobs, Junge and Pastewka 2017 (spectrum).

    Examples
    --------
    >>> np.save("disc.npy", np.random.default_rng(0).normal(0.0, 0.1, (128, 128)))
    >>> surface = warpwear.read_surface("disc.npy", pixel="2 um", height_unit="um", s_filter=0.008)
    >>> surface.heights.shape, surface.pixel, round(surface.numbers["sq_um"], 4)
    ((128, 128), (0.002, 0.002), 0.0382)
    """
    cut_off, short = quantity("--lambda-c", lambda_c, "mm"), quantity("--lambda-s", lambda_s, "mm")
    report = surface_report.examine(_read(path, how), cut_off=cut_off, short=short)
    return replace(report, text=with_options(report.text), draw=partial(surface_figure, report))


@named_in_python()
def read_profile(
    path: str | Path,
    *,
    line: str | None = None,
    lambda_c: Length | None = None,
    lambda_s: Length | None = None,
    **how: Unpack[HowToRead],
) -> MeasuredProfile:
    """Read a profile, or a line of a map, and find its parameters of ISO 21920-2.

    Parameters
    ----------
    path
        A file of any format that a study takes.
    line
        Of a map: the axis along the line and its place from the map's corner, "y, 0.5 mm".
    lambda_c, lambda_s
        Cut-offs [mm], or text with a unit; by default those of ISO 21920-3.
    **how
        As for `read_surface`; of a profile pixel, height_unit, array, height_sign, crop (from and to),
        outliers and level.

    Returns
    -------
    MeasuredProfile
        Heights, numbers and a figure.

    Raises
    ------
    InputError
        Where the file holds no profile, or one without roughness, or for a value that is not allowed.
    TypeError
        For an unknown option.

    References
    ----------
    ISO 21920-2 (parameters), ISO 21920-3 (cut-offs and lengths).

    Examples
    --------
    >>> np.save("profile.npy", np.sin(np.arange(2000) / 5.0))
    >>> profile = warpwear.read_profile("profile.npy", pixel=0.001, height_unit="um", lambda_c="0.25 mm")
    >>> round(profile.numbers["ra_um"], 3), round(1e3 * profile.parameters.rsm, 2)
    (0.633, 31.42)
    """
    cut_off, short = optional("--lambda-c", lambda_c, "mm"), optional("--lambda-s", lambda_s, "mm")
    if line is None:
        profile = _profile_in(path, how)
    else:
        profile = profile_report.line_of(_read(path, {**how, "level": "none"}), line)
    degree = _degree(how.get("level"))
    level = profile.levelled(degree)
    result = parameters(level, cut_off=cut_off, short=short)
    rows = [
        *profile_report.profile_rows(profile, degree),
        *profile_report.parameter_rows(result),
        Row("warning", "warning", far_off(level.heights)),
    ]
    return MeasuredProfile(
        text=with_options("\n".join(profile_report.profile_lines(rows))),
        rows=rows,
        draw=partial(profile_report.profile_figure, level, result),
        profile=profile,
        parameters=result,
    )


@named_in_python()
def read_worn(
    path: str | Path,
    kind: Kind,
    *,
    before: str | Path | None = None,
    track_width: Length | None = None,
    track_length: Length | None = None,
    radius: Length | None = None,
    line: str | None = None,
    **how: Unpack[HowToRead],
) -> WornBody:
    """Find the worn track, scar or ball in a measured surface, or a groove in a profile across it.

    Parameters
    ----------
    path
        A file of any format that a study takes.
    kind
        "track" along the sliding axis, "scar" or "ball".
    before
        The same place before it was worn, which is laid over it and taken off; not of a ball.
    track_width, track_length
        Of a track, with its pile-up, when it is not found; of the whole track, to which its volume is
        extended [mm], or text with a unit.
    radius
        Of a ball [mm], or text with a unit; by default fitted.
    line
        Of a map, which is taken as a profile across the track: "y, 0.5 mm".
    **how
        As for `read_surface`; level is of the unworn part beside the worn one.

    Returns
    -------
    WornBody
        Volume, section, width and depth with their errors, and a figure.

    Raises
    ------
    InputError
        Where nothing worn stands out, `before` shows another place, or a value is not allowed.
    TypeError
        For an unknown option.

    Examples
    --------
    >>> disc, y = np.random.default_rng(0).normal(0.0, 0.1, (128, 128)), np.linspace(-1.0, 1.0, 128)
    >>> np.save("worn.npy", disc - 2.0 * np.maximum(0.0, 1.0 - (3.0 * y) ** 2))  # 2 um deep
    >>> worn = warpwear.read_worn("worn.npy", "track", pixel="2 um", height_unit="um")
    >>> [round(1e9 * value) for value in worn.body.volume()]  # um³, and its error
    [28933, 101]
    """
    sizes: dict[str, Any] = {"track_width": track_width, "track_length": track_length, "radius": radius}
    if kind not in get_args(Kind):
        raise InputError(f"kind = {kind!r}: allowed is {', '.join(get_args(Kind))}")
    check_together(Options(sizes, line=line, before=before, **{kind: True}))
    width, length, radius = (optional(flag(name), value, "mm") for name, value in sizes.items())
    worn = worn_in(path, kind, how, before=before, width=width, radius=radius, line=line)
    body, missing, degree = worn.body, worn.missing, worn.degree
    if isinstance(worn.source, Profile):
        refuse({"--track-length": track_length}, OF_MAPS)
        beside = " through the profile beside the groove"
        rows = [*profile_report.profile_rows(worn.source, degree, beside), *profile_report.groove_rows(body)]
        text, draw = profile_report.profile_lines(rows), partial(groove_figure, body)
        return replace(worn, text=with_options("\n".join(text)), rows=rows, draw=draw)
    own, done = worn.source.record(), f"polynomial of degree {degree} through the surface beside the {kind} "
    done += "taken off"
    rows = [Row("", "surface", own), Row("warning", "", own["doubts"] or None)]
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
    text = [*surface_report.file_lines(own, *([] if kind == "ball" else [done])), *lines(rows)]
    figure: Any = track_figure if kind == "track" else patch_figure
    draw = partial(figure, body, filled=missing)
    return replace(worn, text=with_options("\n".join(text)), rows=rows, draw=draw)


@named_in_python()
def worn_cap(first: Length, second: Length, *, radius: Length) -> FileReport:
    """Find what a ball has lost from two diagonals of its worn patch, taken as flat.

    Parameters
    ----------
    first, second
        The diagonals [mm], or text with a unit.
    radius
        Of the ball [mm], or text with a unit.

    Returns
    -------
    FileReport
        Depth and volume of the cap; it has no figure.

    Raises
    ------
    InputError
        For lengths that are not positive, or diagonals wider than the ball.

    References
    ----------
    ASTM G99, for the volume of a flat cap.

    Examples
    --------
    >>> warpwear.worn_cap(0.80, "820 um", radius="3 mm")
    <worn ball by two diagonals: rim's radius 0.405 mm, depth 27.463 µm, volume 0.0070867 mm³ (a flat patch)>
    """
    each = (quantity("--diagonals", diagonal, "mm") for diagonal in (first, second))
    rows = surface_report.cap_rows(cap_of_diagonals(*each, radius=quantity("--radius", radius, "mm")))
    return FileReport(text=f"worn ball by two diagonals: {Row('', '', rows).text} (a flat patch)", rows=rows)


def check_together(o: Options) -> None:
    """Raise InputError where options exclude or need each other; track, scar and ball say the kind."""
    for one, others in APART.items():
        for other in others:
            if o[one] and o[other]:
                raise InputError(f"{one} and {other} exclude each other")
    for option, needed in NEEDED.items():
        if not o[needed]:
            o.refuse(option, why=f"needs {needed}")


def worn_in(
    file: str | Path,
    kind: Kind,
    preparation: Preparation,
    *,
    before: str | Path | None = None,
    width: float | None = None,
    radius: float | None = None,
    line: str | None = None,
) -> WornBody:
    """Find the worn track, scar or ball in a file, a track also in a profile across it.

    before: the same place before it was worn; width of a track, radius of a ball [mm], None to find them;
    line: of a map, which is taken as a profile. The form of a worn body is that of its unworn part. Raises
    InputError.
    """
    profile, degree = None, 0 if kind == "ball" else _degree(preparation.get("level"))
    try:
        surface = _read(file, {**preparation, "level": "none"})
    except HoldsAProfile:
        if kind != "track" or line is not None:
            raise
        profile = _profile_in(file, preparation)
    if line is not None:
        profile = profile_report.line_of(surface, line)
    if profile is not None:
        refuse({"--before": before}, OF_MAPS)
        groove = find_groove(profile, degree=degree, width=width)
        return WornBody(body=groove, source=profile, missing=profile.missing, degree=degree)
    heights, pixel, changed = surface.measured, surface.pixel, None
    if before is not None:
        earlier = _read(before, {**preparation, "level": "none", "crop": None})
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
    missing = np.isnan(heights)
    return WornBody(body=body, source=surface, missing=missing, changed=changed, degree=degree)


def _profile_in(file: str | Path, preparation: Preparation) -> Profile:
    """Read the profile in a file. Raises InputError, for options that are for maps, too."""
    of_maps = {flag(key): value for key, value in preparation.items() if key not in LINE}
    refuse(of_maps, "is for a map of heights, and FILE holds a profile")
    with reworded(with_options):
        disc = _disc(file, preparation)  # refuses what is not allowed
        return profile_in(
            file,
            spacing=optional("--pixel", preparation.get("pixel"), "mm"),
            height_unit=preparation.get("height_unit"),
            array=preparation.get("array"),
            down=preparation.get("height_sign") == "down",
            crop=disc.crop,
            deviations=disc.outliers,
        )


def _degree(level: Any) -> int:
    """Return the degree of --level for a worn disc. Raises InputError for a form."""
    degree = degree_of("plane" if level is None else value_of_text(str(level)))
    if isinstance(degree, str):
        raise InputError(f"--level {degree} is for a ball or a roller: allowed is none, plane or a degree")
    return degree


def _read(file: str | Path, preparation: Preparation) -> Measured:
    """Read a map of heights, prepared by keys of [disc]. Raises InputError."""
    with reworded(with_options):
        surface: Any = surface_of(_disc(file, preparation))
    if surface.is_profile:
        raise HoldsAProfile(f"the file '{file}' holds a profile (line scan), and no map of heights")
    return surface


def check_options(given: Preparation) -> None:
    """Raise TypeError, as Python does, for an option that no measured surface has."""
    for name in given.keys() - HowToRead.__annotations__.keys():
        raise TypeError(f"{name!r} is no option; allowed: {', '.join(HowToRead.__annotations__)}")


def _disc(file: str | Path, preparation: Preparation) -> Disc:
    """Return [disc] by the keys given. Raises InputError, and TypeError for others, as Python does."""
    check_options(preparation)
    values = {name: value for name, value in preparation.items() if value is not None}
    for name in values.keys() & set(LENGTHS):
        several = isinstance(values[name], str) and name in LISTS and "," in values[name]
        parts = [part.strip() for part in values[name].split(",")] if several else values[name]
        values[name] = with_unit(parts, "mm")
    for name in values.keys() & set(NUMBERS):
        values[name] = value_of_text(str(values[name]))
    try:
        return Disc(surface=str(file), **values)
    except ValidationError as error:
        raise InputError(f"disc.{sentence(error, Disc)}") from None


def with_options(text: str) -> str:
    """Say in a text about [disc] what its keys are called here: --height-unit for disc.height_unit."""
    text = text.replace("disc.surface '", "the file '").replace("disc.surface is", "the file is")
    return KEYS.sub(lambda match: flag(match[1]), text)
