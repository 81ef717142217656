"""Measured files as they are: heights, pixel and units out of instrument formats and .npy."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray

MILLIMETRES = {
    "km": 1e6,
    "m": 1e3,
    "cm": 10.0,
    "mm": 1.0,
    "µm": 1e-3,
    "um": 1e-3,
    "nm": 1e-6,
    "Å": 1e-7,
    "A": 1e-7,
    "pm": 1e-9,
    "fm": 1e-12,
}
SMALLEST_PIXEL, LARGEST_PIXEL = 1e-7, 1.0  # mm: what no instrument for roughness goes beyond
READABLE = (
    "allowed is an areal height map that SurfaceTopography reads (.al3d, .sur, .x3p, .opd, .plu, .mnt, .sdf, "
    "xyz text and others) or a 2-D .npy"
)


@dataclass(frozen=True, eq=False)
class Reading:
    """What a file holds: heights [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm]."""

    heights: FloatArray
    pixel: tuple[float, float]
    format: str
    unit: str
    pixel_given: bool
    unit_given: bool


def read(
    path: str | Path, *, pixel: float | tuple[float, float] | None = None, height_unit: str | None = None
) -> Reading:
    """Read one height map.

    pixel [mm] (one, or one per axis of the file) and height_unit override what the file says; a .npy, and a
    text file without them, needs both. Axis 0 is the file's x. InputError, naming ``disc.surface``,
    ``disc.pixel`` or ``disc.height_unit``, for whatever is no areal measurement or cannot be.
    """
    path = Path(path)
    if not path.exists():
        raise _refusal(path, "does not exist")
    if not path.is_file():
        raise _refusal(path, "is not a file")
    try:
        size = path.stat().st_size
    except OSError as error:
        raise _refusal(path, f"cannot be read ({error.strerror})") from error
    if size == 0:
        raise _refusal(path, "is empty")
    given = None if pixel is None else _given_pixel(pixel)
    if height_unit is not None and height_unit.strip().replace("μ", "µ") not in MILLIMETRES:
        raise InputError(f"disc.height_unit is {height_unit!r}: allowed is one of {', '.join(MILLIMETRES)}")
    if path.suffix.lower() == ".npy":
        raw, file_pixel, file_unit, kind = _read_npy(path), None, None, "npy"
    else:
        raw, file_pixel, file_unit, kind = _read_instrument(path, given)
    if raw.ndim != 2 or min(raw.shape) < 2:
        raise _refusal(path, f"holds a line scan or single values (shape {'×'.join(map(str, raw.shape))})")
    unit = height_unit if height_unit is not None else file_unit
    factor = _height_factor(path, unit)
    used = given if given is not None else _pixel_of_file(path, file_pixel, file_unit)
    heights = np.ma.filled(raw.astype(np.float64), np.nan) * factor
    heights[~np.isfinite(heights)] = np.nan
    if np.isnan(heights).all():
        raise _refusal(path, "has no valid point, all are missing")
    return Reading(
        heights=heights,
        pixel=used,
        format=kind,
        unit=str(unit).strip(),
        pixel_given=given is not None,
        unit_given=height_unit is not None,
    )


def _refusal(path: Path, what: str) -> InputError:
    return InputError(f"disc.surface '{path}' {what}: {READABLE}")


def _read_npy(path: Path) -> np.ma.MaskedArray | np.ndarray:
    try:
        array = np.load(path, allow_pickle=False)
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise _refusal(path, f"cannot be read as .npy ({_first_line(error)})") from error
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise _refusal(path, "is not an array of real numbers")
    if array.size == 0:
        raise _refusal(path, "is empty")
    return array


def _read_instrument(
    path: Path, given: tuple[float, float] | None
) -> tuple[np.ma.MaskedArray | np.ndarray, tuple[float, ...] | None, str | None, str]:
    """Heights and pixel in the file's unit (pixel None when it has none), the unit, the format."""
    try:
        from SurfaceTopography import open_topography  # 2 s, so only when needed
    except ImportError as error:
        raise InputError(
            f"disc.surface '{path}' needs SurfaceTopography, which is not installed: allowed without it is "
            '.npy, or run pip install "warpwear[io]"'
        ) from error
    try:
        with open_topography(str(path)) as reader:
            if reader.format() == "hgt":  # a headerless map of the Earth: any 2n² bytes pass for one
                raise ValueError("no reader knows the format")
            channels = [c for c in reader.channels if getattr(c, "is_height_channel", True)]
            if not channels:
                raise ValueError("no channel of heights")
            default = reader.default_channel
            channel = next((c for c in channels if c.index == default.index), channels[0])
            if channel.dim != 2:
                return np.zeros(channel.nb_grid_pts or 1), None, None, str(reader.format())
            sizes = None
            if channel.physical_sizes is None:
                # Only to get at the heights: the pixel used is the study's, or there is an error
                sizes = tuple(n * p for n, p in zip(channel.nb_grid_pts, given or (1.0, 1.0), strict=True))
            topography = channel.topography(physical_sizes=sizes)
            heights = topography.heights()
            if reader.format() == "asc" and min(heights.shape) == 3:
                # SurfaceTopography's issue 93: an incomplete list of points passes for a three-column matrix
                raise ValueError("a list of points x y z that is no complete regular grid")
            unit = topography.unit if isinstance(topography.unit, str) else None
            pixel = tuple(float(p) for p in topography.pixel_size) if sizes is None else None
            return heights, pixel, unit, str(reader.format())
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise _refusal(path, f"cannot be read as a surface ({_first_line(error)})") from error


def _first_line(error: Exception) -> str:
    if type(error).__name__ == "CannotDetectFileFormat":  # its text is what every reader had to say
        return "no reader knows the format"
    text = str(error).strip() or type(error).__name__
    return text.splitlines()[0].strip().rstrip(".:")[:120]


def _given_pixel(pixel: float | tuple[float, float]) -> tuple[float, float]:
    pair = (pixel, pixel) if isinstance(pixel, (int, float)) else tuple(pixel)
    if len(pair) != 2 or not all(SMALLEST_PIXEL <= p <= LARGEST_PIXEL for p in pair):
        raise InputError(
            f"disc.pixel is {' × '.join(f'{p:g}' for p in pair)} mm: allowed is one length or one per axis, "
            f"from 0.1 nm to 1 mm"
        )
    return float(pair[0]), float(pair[1])


def _height_factor(path: Path, unit: str | None) -> float:
    if unit is None:
        raise InputError(
            f"disc.height_unit is not given and disc.surface '{path}' names no unit: allowed is one of "
            f"{', '.join(MILLIMETRES)}"
        )
    factor = MILLIMETRES.get(unit.strip().replace("μ", "µ"))
    if factor is None:
        raise InputError(
            f"disc.surface '{path}' has the unit {unit!r}: allowed is one of {', '.join(MILLIMETRES)}, or "
            "give disc.height_unit and disc.pixel"
        )
    return factor


def _pixel_of_file(path: Path, pixel: tuple[float, ...] | None, unit: str | None) -> tuple[float, float]:
    if pixel is None or unit is None:
        lacks = "names none" if pixel is None else "gives its own without a unit"
        raise InputError(
            f"disc.pixel is not given and disc.surface '{path}' {lacks}: allowed is one length or one per "
            "axis, from 0.1 nm to 1 mm"
        )
    factor = _height_factor(path, unit)
    along, across = (p * factor for p in pixel)
    if not all(math.isfinite(p) and SMALLEST_PIXEL <= p <= LARGEST_PIXEL for p in (along, across)):
        raise InputError(
            f"disc.surface '{path}' has a pixel of {along:g} × {across:g} mm: allowed is from 0.1 nm to "
            "1 mm, or give disc.pixel"
        )
    return along, across
