"""What is in a file of heights, in its own units: instrument formats, text, .npy and .npz."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.surfaces.point_cloud import gridded, units_in
from warpwear.surfaces.text import NoTable, read_table

h5py = lazy.module("h5py")

READABLE = (
    "allowed is an areal height map that SurfaceTopography reads (.al3d, .sur, .x3p, .opd, .plu, .mnt, .sdf "
    "and others), text of points x y z or of a matrix, or a 2-D array in .npy or .npz"
)
HDF5 = (".h5", ".hdf5")
TEXT = (".xyz", ".txt", ".csv", ".asc", ".dat", ".tsv", ".hfm")
CUT = "the file's last line has no end: it may have been cut short, and its last value with it"
HEIGHT_NAMES = ("heights", "height", "z", "surface", "topography")  # of the array in a .npz that has several


@dataclass(frozen=True, eq=False)
class Raw:
    """A file holds values in its own units; what it does not say is None."""

    heights: np.ma.MaskedArray | np.ndarray
    format: str
    pixel: tuple[float, ...] | None = None  # in the lateral unit
    lateral_unit: str | None = None
    height_unit: str | None = None
    notes: tuple[str, ...] = ()  # what was decided while reading, in sentences


def read_raw(path: Path, *, pixel: tuple[float, float] | None, array: str | None) -> Raw:
    """Read what a file holds, by its ending: .npy, .npz, text, or an instrument's format.

    pixel: the one given [mm], if any; array: the one to take of a .npz that holds several. Raises InputError,
    naming ``disc.surface``, for what cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix == ".npy":
        return _read_npy(path)
    if suffix == ".npz":
        return _read_npz(path, array)
    if suffix in TEXT:
        return _read_text(path, pixel)
    return _read_instrument(path, pixel)


def refusal(path: Path, what: str) -> InputError:
    """Return the error for a file that holds no surface. what: the reason, to go on after its name."""
    return InputError(f"disc.surface '{path}' {what}: {READABLE}")


def _read_npy(path: Path) -> Raw:
    try:
        with path.open("rb") as file:
            array = np.load(file, allow_pickle=False)
            if file.read(1):
                raise ValueError("there is more in it than its array")
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise refusal(path, f"cannot be read as .npy ({_first_line(error)})") from error
    return Raw(heights=_real(path, array), format="npy")


def _read_npz(path: Path, name: str | None) -> Raw:
    try:
        with np.load(path, allow_pickle=False) as content:
            names = list(content.files)
            usual = [n for n in names if n.lower() in HEIGHT_NAMES]
            chosen = names[0] if len(names) == 1 else usual[0] if len(usual) == 1 else None
            if name is not None:
                chosen = name if name in names else None
            array = None if chosen is None else content[chosen]
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise refusal(path, f"cannot be read as .npz ({_first_line(error)})") from error
    if array is None:
        held = ", ".join(names) or "none"
        asked = f"no array {name!r}" if name is not None else "several arrays"
        raise InputError(f"disc.surface '{path}' holds {asked}: disc.array names one of: {held}")
    return Raw(heights=_real(path, array), format="npz", notes=(f"array {chosen!r} of the file",))


def _real(path: Path, array: Any) -> np.ndarray:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise refusal(path, "is not an array of real numbers")
    if array.size == 0:
        raise refusal(path, "is empty")
    return array


def _read_text(path: Path, given: tuple[float, float] | None) -> Raw:
    """Read points x y z of a grid, or a matrix whose lines follow y."""
    try:
        table = read_table(path)
        values = table.numbers()
    except NoTable:  # an instrument's own format by that name
        return _read_instrument(path, given)
    except ValueError as error:
        raise refusal(path, f"cannot be read as text ({error})") from error
    told = () if table.ended else (CUT,)
    lateral, height = units_in(table.header)
    if table.width < 3:
        return Raw(heights=values[:, 0], format="text")
    if table.width == 3 or 3 < table.width <= 7 < values.shape[0]:
        try:
            cloud = gridded(values)
        except ValueError as error:
            if table.width == 3:
                raise refusal(path, f"cannot be read as a list of points x y z ({error})") from error
        else:
            extra = (f"columns after the third ignored, {table.width - 3}",) if table.width > 3 else ()
            return Raw(cloud.heights, "xyz", cloud.pixel, lateral, height, cloud.notes + extra + told)
    if table.header:  # sizes and units as SurfaceTopography understands them
        try:
            found = _read_instrument(path, given)
        except InputError:
            pass  # a header it does not know, or the package is not here: the numbers are read all the same
        else:
            if found.heights.shape == values.T.shape:
                return replace(found, notes=found.notes + told)
    return Raw(values.T, "text", None, lateral, height, told)


def _refuse_results(path: Path) -> None:
    """Refuse a result of warpwear, which holds many fields, none of them a measurement."""
    try:
        with h5py.File(path, "r") as file:
            is_result = "snapshots" in file and "study" in file.attrs
    except OSError:
        return  # no HDF5 after all: the reader says so
    if is_result:
        raise refusal(path, "is a result of warpwear; 'warpwear export' writes its worn surfaces")


def _read_instrument(path: Path, given: tuple[float, float] | None) -> Raw:
    """Read the channel of heights that SurfaceTopography takes; given: pixel [mm] where the file has none."""
    try:
        open_topography = lazy.load("SurfaceTopography").open_topography  # 2 s, so only when needed
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
                return Raw(heights=np.zeros(channel.nb_grid_pts or 1), format=str(reader.format()))
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
            return Raw(heights, str(reader.format()), pixel, lateral_unit=unit, height_unit=unit)
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise refusal(path, f"cannot be read as a surface ({_first_line(error)})") from error


def _first_line(error: Exception) -> str:
    """Return the beginning of what a foreign reader says, to stand in brackets."""
    if type(error).__name__ == "CannotDetectFileFormat":  # its text is what every reader had to say
        return "no reader knows the format"
    text = str(error).strip() or type(error).__name__
    return text.splitlines()[0].strip().rstrip(".:")[:120]
