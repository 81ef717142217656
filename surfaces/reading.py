"""Height maps in mm: what a file holds, in the units that it states or that are given."""

import hashlib
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError, explained
from warpwear.grid import FloatArray
from warpwear.surfaces.base import refused
from warpwear.surfaces.outliers import STEPS, at_ends, marks_of_loss

if TYPE_CHECKING:
    from warpwear.surfaces.formats import Raw

# reads tables, containers and clouds of points: a surface that is made needs none of it
formats = lazy.module("warpwear.surfaces.formats")

MILLIMETRES = {"km": 1e6, "m": 1e3, "cm": 10.0, "mm": 1.0, "µm": 1e-3, "um": 1e-3, "nm": 1e-6}
MILLIMETRES |= {"Å": 1e-7, "A": 1e-7, "pm": 1e-9, "fm": 1e-12}
UNITS = "m, mm, um, µm, nm"  # that a study may give; a file may state any of MILLIMETRES
SMALLEST_PIXEL = 1e-7  # mm: no instrument for roughness goes below
LARGEST_PIXEL = 1.0  # mm: nor beyond
FARTHEST = 1.0e4  # mm: no height is beyond it
PIXELS_ALLOWED = "allowed is one length or one per axis, from 0.1 nm to 1 mm"


#: Path of a file -> digests of what was read of it, for who asked with `noted`.
_NOTED: ContextVar[dict[str, set[str]] | None] = ContextVar("noted", default=None)


class HoldsAProfile(InputError):
    """A file holds a profile where a map of heights is expected."""


@dataclass(frozen=True, eq=False)
class Reading:
    """A height map or profile in mm says what a file holds, and where its pixel and unit are from."""

    heights: FloatArray  # [mm], shape (nx, ny), or (n,) of a profile, NaN where missing
    pixel: tuple[float, float]  # (px, py) [mm], alike of a profile
    format: str
    unit: str  # of the heights in the file
    pixel_given: bool
    unit_given: bool
    notes: tuple[str, ...] = ()  # what was decided while reading, in sentences
    doubts: tuple[str, ...] = ()  # where the study contradicts the file, or heights end, in sentences
    digest: str = ""  # SHA-256 of the file, as `digest_of` gives it


def read(
    path: str | Path,
    *,
    pixel: float | tuple[float, float] | None = None,
    height_unit: str | None = None,
    array: str | None = None,
    profile: bool = False,
) -> Reading:
    """Read one height map, or one profile.

    pixel [mm] (one, or one per axis of the file) and height_unit override what the file says; .npy, .npz and
    text without them need both. array: which of several in the file, by name or number. Axis 0 is the file's
    x: the columns of a text matrix, whose lines follow y. A map of one line is a profile. Raises InputError,
    naming ``disc.surface``, ``disc.pixel`` or ``disc.height_unit``, for whatever is neither, or the other
    one: `HoldsAProfile` for a profile instead of a map.
    """
    path = Path(path)
    try:
        size, is_file = path.stat().st_size, path.is_file()  # a pipe would be waited for without end
    except FileNotFoundError as error:
        raise InputError(f"disc.surface '{path}' does not exist") from error
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"disc.surface '{path}' cannot be read: {why}") from error
    if size == 0 or not is_file:
        raise InputError(f"disc.surface '{path}' {'is empty' if is_file else 'is not a file'}")
    pair = None if pixel is None else _pixel_pair(pixel)
    if height_unit is not None and _millimetres(height_unit) is None:
        raise InputError(f"disc.height_unit is {height_unit!r}: allowed is one of {UNITS}")
    with copied(path) as (copy, digest):
        try:
            raw = formats.read_raw(formats.SurfaceFile(copy, pixel=pair, array=array))
        except InputError as error:
            raise InputError(str(error).replace(str(copy), str(path))) from error
    if digest_of(path) != digest:
        raise InputError(f"disc.surface '{path}' changed while it was read")
    if (all_read := _NOTED.get()) is not None:
        all_read.setdefault(str(path), set()).add(digest)
    raw = _squeezed(raw)
    axes = 1 if profile else 2
    if raw.heights.ndim == 1 < axes:
        what = f"holds a profile (line scan) of {raw.heights.size} points, and no map of heights"
        raise HoldsAProfile(str(formats.refusal(path, what)))
    if raw.heights.ndim != axes or min(raw.heights.shape) < 2:
        shape = "×".join(map(str, raw.heights.shape))
        raise formats.refusal(path, f"holds no {'profile' if profile else 'map'} (shape {shape})")
    unit = height_unit if height_unit is not None else raw.height_unit
    factor = _height_factor(path, unit, raw)
    values = np.ma.filled(raw.heights.astype(np.float64), np.nan)
    values[~np.isfinite(values)] = np.nan
    if np.isnan(values).all():
        raise InputError(f"disc.surface '{path}' has no valid point, all are missing")
    notes = list(raw.notes)
    for mark in marks_of_loss(values[~np.isnan(values)]):
        lost = values == mark
        values[lost] = np.nan
        why = "which repeats far outside of all others: taken as a mark of lost points"
        notes.append(f"{int(lost.sum())} points hold {mark:g} {unit}, {why}")
    heights = values * factor
    doubts = _overrides(raw, unit=height_unit, pixel=None if pair is None else pair[:axes])
    known = values[~np.isnan(values)]
    ends = at_ends(known)
    for end in ends if ends and np.unique(known).size > STEPS else []:
        which = "lowest" if end == known.min() else "highest"
        held = f"{100.0 * np.mean(known == end):.2g} % of the points hold exactly the {which} height"
        doubts += (f"{held}, {end:g} {unit}: the end of the instrument's range, or lost points?",)
    if float(np.nanmax(np.abs(heights))) > FARTHEST:
        raise refused("far_heights", path=path, most=FARTHEST, unit=unit)
    return Reading(
        heights=heights,
        pixel=_pixel_of_file(path, raw) if pair is None else pair,
        format=raw.format,
        unit=str(unit).strip(),
        pixel_given=pixel is not None,
        unit_given=height_unit is not None,
        notes=tuple(notes),
        doubts=doubts,
        digest=digest,
    )


@contextmanager
def noted(files: dict[str, set[str]]) -> Iterator[None]:
    """Add to files, by its path, the digest of what is read of each meanwhile."""
    token = _NOTED.set(files)
    try:
        yield
    finally:
        _NOTED.reset(token)


@contextmanager
def copied(path: Path, *, key: str = "disc.surface") -> Iterator[tuple[Path, str]]:
    """Copy a file for as long as it is read, and give the digest of the copy: nobody exchanges that.

    Raises InputError, naming the key.
    """
    with tempfile.TemporaryDirectory(prefix="warpwear-") as folder:
        copy = Path(folder) / path.name
        with explained(f"{key} '{path}' cannot be read"):
            shutil.copyfile(path, copy)
        yield copy, digest_of(copy)


def digest_of(path: str | Path, *, key: str = "disc.surface") -> str:
    """Return the SHA-256 of a file as hexadecimal text. Raises InputError, naming the key."""
    with explained(f"{key} '{path}' cannot be read"), Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _millimetres(unit: str | None) -> float | None:
    """Return a unit's length in mm, None for none and for one that is not known."""
    return MILLIMETRES.get((unit or "").strip().replace("μ", "µ"))


def _overrides(raw: "Raw", *, unit: str | None, pixel: tuple[float, ...] | None) -> tuple[str, ...]:
    """Say, in sentences, where what is given differs from what the file says."""
    notices = []
    of_file = _millimetres(raw.height_unit)
    if unit is not None and of_file is not None and _millimetres(unit) != of_file:
        notices.append(
            f"disc.height_unit = {unit} overrides the unit that the file states, {raw.height_unit}"
        )
    lateral = _millimetres(raw.lateral_unit)
    if pixel is not None and raw.pixel is not None and lateral is not None:
        stated = [p * lateral for p in raw.pixel]
        if any(abs(a - b) > 1e-6 * b for a, b in zip(pixel, stated, strict=True)):
            own, other = (" × ".join(f"{1e3 * p:.4g}" for p in pair) for pair in (stated, pixel))
            notices.append(f"disc.pixel = {other} µm overrides the pixel that the file states, {own} µm")
    return tuple(notices)


def _pixel_pair(pixel: float | tuple[float, float]) -> tuple[float, float]:
    pair = (pixel, pixel) if isinstance(pixel, (int, float)) else tuple(pixel)
    if len(pair) != 2 or not all(map(_is_pixel, pair)):
        raise InputError(f"disc.pixel is {' × '.join(f'{p:g}' for p in pair)} mm: {PIXELS_ALLOWED}")
    return float(pair[0]), float(pair[1])


def _is_pixel(length: float) -> bool:
    return SMALLEST_PIXEL <= length <= LARGEST_PIXEL


def _height_factor(path: Path, unit: str | None, raw: "Raw") -> float:
    if unit is None:
        raise refused("no_unit", path=path, step=_step(raw), units=UNITS)
    factor = _millimetres(unit)
    if factor is None:
        raise refused("unknown_unit", path=path, unit=unit, units=UNITS)
    return factor


def _squeezed(raw: "Raw") -> "Raw":
    """Return a map of one line as the profile that it is, and all else as it is."""
    shape = raw.heights.shape
    if len(shape) != 2 or min(shape) != 1 or max(shape) == 1:
        return raw
    pixel = None if raw.pixel is None else (raw.pixel[shape.index(max(shape))],)
    return replace(raw, heights=raw.heights.reshape(-1), pixel=pixel)


def _step(raw: "Raw") -> str:
    """Say the distance of the points where a file gives it without a unit, to go on after the file's name."""
    if raw.pixel is None or raw.lateral_unit is not None:
        return ""
    steps = " × ".join(f"{p:.6g}" for p in raw.pixel)
    return f"; its points are {steps} apart, in a unit that it does not say"


def _pixel_of_file(path: Path, raw: "Raw") -> tuple[float, float]:
    if raw.pixel is None or raw.lateral_unit is None:
        lacks = _step(raw) or " names none"
        raise InputError(f"disc.pixel is not given and disc.surface '{path}'{lacks}: {PIXELS_ALLOWED}")
    factor = _height_factor(path, raw.lateral_unit, raw)
    pixel = tuple(p * factor for p in raw.pixel)
    if not all(map(_is_pixel, pixel)):
        raise refused("odd_pixel", path=path, sizes=" × ".join(f"{p:g}" for p in pixel))
    return pixel[0], pixel[-1]
