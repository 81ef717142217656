"""Measured files as they are: heights, pixel and units out of instrument formats, text, .npy and .npz."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from warpwear.errors import InputError
from warpwear.surfaces.base import FloatArray
from warpwear.surfaces.point_cloud import gridded, units_in
from warpwear.surfaces.text_table import Table, read_table

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
    "allowed is an areal height map that SurfaceTopography reads (.al3d, .sur, .x3p, .opd, .plu, .mnt, .sdf "
    "and others), text of points x y z or of a matrix, or a 2-D array in .npy or .npz"
)
UNITS = "m, mm, um, µm, nm"  # that a study may give; a file may state any of MILLIMETRES
HDF5 = (".h5", ".hdf5")
FARTHEST = 1.0e4  # mm: no height is beyond it
TEXT = (".xyz", ".txt", ".csv", ".asc", ".dat", ".tsv", ".hfm")
CUT = "the file's last line has no end: it may have been cut short, and its last value with it"
HEIGHT_NAMES = ("heights", "height", "z", "surface", "topography")  # of the array in a .npz that has several


@dataclass(frozen=True, eq=False)
class Reading:
    """What a file holds: heights [mm], shape (nx, ny), NaN where missing; pixel (px, py) [mm].

    unit is that of the heights; notes say what was decided while reading.
    """

    heights: FloatArray
    pixel: tuple[float, float]
    format: str
    unit: str
    pixel_given: bool
    unit_given: bool
    notes: tuple[str, ...] = ()
    overrides: tuple[str, ...] = ()  # where the study contradicts the file, in sentences


@dataclass(frozen=True, eq=False)
class _Raw:
    """A file's values in its own units; pixel None where it has none, unit None where it names none."""

    heights: np.ma.MaskedArray | np.ndarray
    format: str
    pixel: tuple[float, ...] | None = None
    lateral_unit: str | None = None
    height_unit: str | None = None
    notes: tuple[str, ...] = ()


def read(
    path: str | Path,
    *,
    pixel: float | tuple[float, float] | None = None,
    height_unit: str | None = None,
    array: str | None = None,
) -> Reading:
    """Read one height map.

    pixel [mm] (one, or one per axis of the file) and height_unit override what the file says; .npy, .npz and
    text without them need both. array: the one to take of a .npz that holds several. Axis 0 is the file's x:
    the columns of a text matrix, whose lines follow y. InputError, naming ``disc.surface``, ``disc.pixel`` or
    ``disc.height_unit``, for whatever is no areal measurement or cannot be.
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
        raise InputError(f"disc.height_unit is {height_unit!r}: allowed is one of {UNITS}")
    suffix = path.suffix.lower()
    if suffix == ".npy":
        raw = _read_npy(path)
    elif suffix == ".npz":
        raw = _read_npz(path, array)
    elif suffix in TEXT:
        raw = _read_text(path, given)
    else:
        raw = _read_instrument(path, given)
    if raw.heights.ndim != 2 or min(raw.heights.shape) < 2:
        shape = "×".join(map(str, raw.heights.shape))
        raise _refusal(path, f"holds a line scan or single values (shape {shape})")
    unit = height_unit if height_unit is not None else raw.height_unit
    factor = _height_factor(path, unit)
    used = given if given is not None else _pixel_of_file(path, raw.pixel, raw.lateral_unit)
    overrides = _overrides(raw, unit=height_unit, pixel=given)
    heights = np.ma.filled(raw.heights.astype(np.float64), np.nan) * factor
    heights[~np.isfinite(heights)] = np.nan
    if np.isnan(heights).all():
        raise _refusal(path, "has no valid point, all are missing")
    if float(np.nanmax(np.abs(heights))) > FARTHEST:
        raise _refusal(path, f"has heights beyond {FARTHEST:g} mm (unit {unit}), which is no topography")
    return Reading(
        heights=heights,
        pixel=used,
        format=raw.format,
        unit=str(unit).strip(),
        pixel_given=given is not None,
        unit_given=height_unit is not None,
        notes=raw.notes,
        overrides=overrides,
    )


def _overrides(raw: _Raw, *, unit: str | None, pixel: tuple[float, float] | None) -> tuple[str, ...]:
    """Where what is given differs from what the file says, in sentences."""
    told = []
    of_file = MILLIMETRES.get((raw.height_unit or "").strip().replace("μ", "µ"))
    if unit is not None and of_file is not None and MILLIMETRES[unit.strip().replace("μ", "µ")] != of_file:
        told.append(f"disc.height_unit = {unit} overrides the unit that the file states, {raw.height_unit}")
    lateral = MILLIMETRES.get((raw.lateral_unit or "").strip().replace("μ", "µ"))
    if pixel is not None and raw.pixel is not None and lateral is not None:
        stated = [p * lateral for p in raw.pixel]
        if any(abs(a - b) > 1e-6 * b for a, b in zip(pixel, stated, strict=True)):
            given, own = (" × ".join(f"{1e3 * p:.4g}" for p in pair) for pair in (pixel, stated))
            told.append(f"disc.pixel = {given} µm overrides the pixel that the file states, {own} µm")
    return tuple(told)


def _refusal(path: Path, what: str) -> InputError:
    return InputError(f"disc.surface '{path}' {what}: {READABLE}")


def _read_npy(path: Path) -> _Raw:
    try:
        with path.open("rb") as file:
            array = np.load(file, allow_pickle=False)
            if file.read(1):
                raise ValueError("there is more in it than its array")
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise _refusal(path, f"cannot be read as .npy ({_first_line(error)})") from error
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise _refusal(path, "is not an array of real numbers")
    if array.size == 0:
        raise _refusal(path, "is empty")
    return _Raw(heights=array, format="npy")


def _read_npz(path: Path, name: str | None) -> _Raw:
    try:
        with np.load(path, allow_pickle=False) as content:
            names = list(content.files)
            if name is not None:
                chosen = name if name in names else None
            elif len(names) == 1:
                chosen = names[0]
            else:
                usual = [n for n in names if n.lower() in HEIGHT_NAMES]
                chosen = usual[0] if len(usual) == 1 else None
            array = None if chosen is None else content[chosen]
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise _refusal(path, f"cannot be read as .npz ({_first_line(error)})") from error
    if array is None:
        held = ", ".join(names) or "none"
        asked = f"no array {name!r}" if name is not None else "several arrays"
        raise InputError(f"disc.surface '{path}' holds {asked}: disc.array names one of: {held}")
    if array.dtype.kind not in "fiu":
        raise _refusal(path, "is not an array of real numbers")
    if array.size == 0:
        raise _refusal(path, "is empty")
    return _Raw(heights=array, format="npz", notes=(f"array {chosen!r} of the file",))


def _read_text(path: Path, given: tuple[float, float] | None) -> _Raw:
    try:
        table = read_table(path)
    except ValueError as error:
        if str(error) in ("no text", "no table of numbers"):  # an instrument's own format by that name
            return _read_instrument(path, given)
        raise _refusal(path, f"cannot be read as text ({error})") from error
    columns = table.values.shape[1]
    lateral, height = units_in(table.header)
    told = () if table.ended else (CUT,)
    if columns < 3:
        return _Raw(heights=table.values[:, 0], format="text")
    if columns == 3 or 3 < columns <= 7 < table.values.shape[0]:
        try:
            cloud = gridded(table.values)
        except ValueError as error:
            if columns == 3:
                raise _refusal(path, f"cannot be read as a list of points x y z ({error})") from error
        else:
            extra = (f"columns after the third ignored, {columns - 3}",) if columns > 3 else ()
            return _Raw(
                heights=cloud.heights,
                format="xyz",
                pixel=cloud.pixel,
                lateral_unit=lateral,
                height_unit=height,
                notes=cloud.notes + extra + told,
            )
    return _read_matrix(path, table, given)


def _read_matrix(path: Path, table: Table, given: tuple[float, float] | None) -> _Raw:
    """A matrix in text; where it has a header, sizes and units as SurfaceTopography understands them."""
    told = () if table.ended else (CUT,)
    if table.header:
        try:
            found = _read_instrument(path, given)
        except InputError:
            pass  # a header it does not know, or the package is not here: the numbers are read all the same
        else:
            if found.heights.shape == table.values.T.shape:
                return replace(found, notes=found.notes + told)
    lateral, height = units_in(table.header)
    return _Raw(heights=table.values.T, format="text", lateral_unit=lateral, height_unit=height, notes=told)


def _refuse_results(path: Path) -> None:
    """A result of ours holds many fields, none of them a measurement."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            is_result = "snapshots" in file and "study" in file.attrs
    except OSError:
        return  # no HDF5 after all: the reader says so
    if is_result:
        raise _refusal(path, "is a result of warpwear; 'warpwear export' writes its worn surfaces")


def _read_instrument(path: Path, given: tuple[float, float] | None) -> _Raw:
    try:
        from SurfaceTopography import open_topography  # 2 s, so only when needed
    except ImportError as error:
        raise InputError(
            f"disc.surface '{path}' needs SurfaceTopography, which is not installed: allowed without it is "
            '.npy, or run pip install "warpwear[io]"'
        ) from error
    if path.suffix.lower() in HDF5:
        _refuse_results(path)
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
                return _Raw(heights=np.zeros(channel.nb_grid_pts or 1), format=str(reader.format()))
            sizes = None
            if channel.physical_sizes is None:
                # Only to get at the heights: the pixel used is the study's, or there is an error
                sizes = tuple(n * p for n, p in zip(channel.nb_grid_pts, given or (1.0, 1.0), strict=True))
            topography = channel.topography(physical_sizes=sizes)
            heights = topography.heights()
            if reader.format() == "asc" and min(heights.shape) == 3:
                # the reader takes an incomplete list of points for a matrix of three columns
                raise ValueError("a list of points x y z that is no complete regular grid")
            unit = topography.unit if isinstance(topography.unit, str) else None
            pixel = tuple(float(p) for p in topography.pixel_size) if sizes is None else None
            return _Raw(
                heights=heights,
                format=str(reader.format()),
                pixel=pixel,
                lateral_unit=unit,
                height_unit=unit,
            )
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
            f"{UNITS}"
        )
    factor = MILLIMETRES.get(unit.strip().replace("μ", "µ"))
    if factor is None:
        raise InputError(
            f"disc.surface '{path}' has the unit {unit!r}: allowed is one of {UNITS}, or "
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
