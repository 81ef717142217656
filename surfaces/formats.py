"""What is in a file of heights, in its own units: instrument formats, text, .npy and .npz."""

import math
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.surfaces.container import ORIGINAL, Member, choose, is_container, members_of, unpacked
from warpwear.surfaces.point_cloud import gridded, units_in
from warpwear.surfaces.text import NoTable, read_table

h5py = lazy.module("h5py")

READABLE = (
    "allowed is an areal height map that SurfaceTopography reads (.al3d, .sur, .x3p, .opd, .plu, .mnt, .sdf "
    "and others), a container of contact.engineering (.zip), text of points x y z or of a matrix, or a 2-D "
    "array in .npy or .npz"
)
NPY, ZIP = b"\x93NUMPY", b"PK"  # that files of these kinds begin with
UTF16 = (b"\xff\xfe", b"\xfe\xff")
BLOCK = 2**20  # bytes of a file that are looked at together
TEXT = (".xyz", ".txt", ".csv", ".asc", ".dat", ".tsv", ".hfm")
CUT = "the file's last line has no end: it may have been cut short, and its last value with it"
#: Formats of SurfaceTopography that are not looked for: those without a mark, for which other files pass (of
#: hgt any 2n² bytes, of nms two small numbers), and what is read here.
NOT_SOUGHT = ("hgt", "nms", "npy", "npz")
#: Its formats of plain text, whose readers take a minute for a few MB of anything else.
PLAIN = ("asc", "xyz")
#: Points that a file may declare for each of its bytes: packed zeros give 130.
POINTS_A_BYTE = 200
MOST_POINTS = 2**28  # 2 GiB of heights
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


def read_raw(
    path: Path, *, pixel: tuple[float, float] | None, array: str | None, channel: int | None = None
) -> Raw:
    """Read what a file holds: .npy, .npz, text, a container or an instrument's format, by its content.

    The ending decides what its content leaves open. pixel: the one given [mm], if any; array: the one to take
    of a .npz or container that holds several; channel: of an instrument's file. Raises InputError, naming
    ``disc.surface``, for what cannot be read.
    """
    suffix = path.suffix.lower()
    try:
        with path.open("rb") as file:
            start = file.read(len(NPY))
    except OSError as error:
        raise InputError(f"disc.surface '{path}' cannot be read: {error.strerror}") from error
    if start == NPY or suffix == ".npy":
        return _read_npy(path)
    if suffix == ".npz" or (start.startswith(ZIP) and _is_npz(path)):
        return _read_npz(path, array)
    if start.startswith(ZIP) and is_container(path):
        return _read_container(path, pixel, array)
    is_text = _is_text(path)
    if is_text and suffix in TEXT:
        return _read_text(path, pixel)
    try:
        return _read_instrument(path, pixel, channel=channel)
    except InputError as error:
        if not is_text and suffix not in TEXT:
            raise
        return _read_text(path, pixel, otherwise=error)


def _is_text(path: Path) -> bool:
    """Return whether a file may be text: it has no byte of value 0, or says that it is UTF-16."""
    with path.open("rb") as file:
        if file.read(2) in UTF16:
            return True
        file.seek(0)
        return all(b"\0" not in block for block in iter(lambda: file.read(BLOCK), b""))


def _is_npz(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return all(name.endswith(".npy") for name in archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


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


def _read_text(path: Path, given: tuple[float, float] | None, *, otherwise: InputError | None = None) -> Raw:
    """Read points x y z of a grid, or a matrix whose lines follow y.

    otherwise: what an instrument's reader has refused the file for, if it was asked.
    """
    try:
        table = read_table(path)
        values = table.numbers()
    except NoTable:  # an instrument's own format by that name
        if otherwise is None:
            return _read_instrument(path, given)
        raise otherwise from otherwise.__cause__
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
            found = _read_instrument(path, given, plain=True)
        except InputError:
            pass  # a header it does not know, or the package is not here: the numbers are read all the same
        else:
            if found.heights.shape == values.T.shape:
                return replace(found, notes=found.notes + told)
    return Raw(values.T, "text", None, lateral, height, told)


def _check_hdf5(path: Path) -> None:
    """Refuse HDF5 that takes values from other files, and a result of warpwear, which is no measurement."""
    away: list[str] = []

    def look(name: str, item: Any) -> None:
        link = isinstance(item, h5py.ExternalLink)
        if link or (isinstance(item, h5py.Dataset) and (item.is_virtual or item.external)):
            away.append(name)

    try:
        with h5py.File(path, "r") as file:
            is_result = "snapshots" in file and "study" in file.attrs
            file.visititems_links(look)
            file.visititems(look)
    except Exception as error:  # the library raises whatever a damaged file leads to
        raise refusal(path, f"cannot be read as HDF5 ({_first_line(error)})") from error
    if away:
        raise InputError(f"disc.surface '{path}' takes '{away[0]}' from another file, which is not followed")
    if is_result:
        raise refusal(path, "is a result of warpwear; 'warpwear export' writes its worn surfaces")


def _open_topography(path: Path, *, plain: bool) -> Any:
    """Open a file with the first reader of SurfaceTopography that knows it. plain: those of text, too."""
    io = lazy.load("SurfaceTopography").IO  # 2 s, so only when needed
    with path.open("rb") as file:
        start = file.read(io.MAGIC_BUFFER_SIZE)
    known: Exception | None = None
    for reader in io.readers:
        fit, name = reader.can_read(start), reader.format()
        if fit is io.MagicMatch.NO or name in NOT_SOUGHT or (name in PLAIN and not plain):
            continue
        try:
            return reader(str(path))
        except Exception as error:  # the reader is foreign: whatever it raises, another may do
            known = error if fit is io.MagicMatch.YES else known
    raise known or ValueError("no reader knows the format")


def _read_container(path: Path, given: tuple[float, float] | None, array: str | None) -> Raw:
    """Read one measurement of a container; what its file leaves open the container's list may say."""
    try:
        members = members_of(path)
    except ImportError as error:
        raise _needs_package(path) from error
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise refusal(path, f"cannot be read as a container ({_first_line(error)})") from error
    member = choose(path, members, array)
    refused = refusal(path, f"lists no file of {member.label!r}")
    for kind, name in member.files:
        try:
            with unpacked(path, name) as file:
                if is_container(file):
                    raise ValueError("a container in a container")
                try:
                    channel = member.about.get("data_source")
                    raw = read_raw(file, pixel=given, array=None, channel=channel)
                except InputError as error:
                    raise InputError(str(error).replace(str(file), f"{path}: {name}")) from error
            return _as_listed(raw, member, kind)
        except InputError as error:
            refused = error
        except Exception as error:  # a name that is not there, a wrong checksum, sizes that are no numbers
            refused = refusal(path, f"cannot be read at {name!r} ({_first_line(error)})")
    raise refused


def _as_listed(raw: Raw, member: Member, kind: str) -> Raw:
    """Complete what a container's file says with what its list does: sizes, unit, factor of the heights."""
    about, notes = member.about, (*raw.notes, f"measurement {member.label!r} of the container")
    unit = about["unit"] if isinstance(about.get("unit"), str) else None
    pixel, sizes = raw.pixel, about.get("size")
    if sizes and len(sizes) == 2:
        listed = tuple(float(size) / n for size, n in zip(sizes, raw.heights.shape, strict=True))
        pixel = pixel or listed
        if unit == raw.lateral_unit and any(
            abs(a / b - 1.0) > 1e-4 for a, b in zip(pixel, listed, strict=True)
        ):
            notes = (*notes, f"its file gives another size than the list, {sizes[0]:g} × {sizes[1]:g} {unit}")
    heights = raw.heights
    if kind == ORIGINAL:
        heights = heights * float(about.get("height_scale") or 1.0)
    else:
        notes = (*notes, "heights as the database prepared them: levelled and filled as its list says")
    return replace(
        raw,
        heights=heights,
        pixel=pixel,
        lateral_unit=raw.lateral_unit or unit,
        height_unit=raw.height_unit or unit,
        notes=notes,
    )


def _needs_package(path: Path) -> InputError:
    return InputError(
        f"disc.surface '{path}' needs SurfaceTopography, which is not installed: allowed without it is "
        '.npy, or run pip install "warpwear[io]"'
    )


def _read_instrument(
    path: Path, given: tuple[float, float] | None, *, plain: bool = False, channel: int | None = None
) -> Raw:
    """Read the channel of heights that SurfaceTopography takes, or the one of a number.

    given: pixel [mm] where the file has none; plain: whether its readers of text are asked too.
    """
    if h5py.is_hdf5(path):
        _check_hdf5(path)
    try:
        with _open_topography(path, plain=plain) as reader:
            channels = [c for c in reader.channels if getattr(c, "is_height_channel", True)]
            if not channels:
                raise ValueError("no channel of heights")
            wanted = reader.default_channel.index if channel is None else channel
            taken = next((c for c in channels if c.index == wanted), channels[0] if channel is None else None)
            if taken is None:
                raise ValueError(f"no channel of heights number {channel}")
            if taken.dim != 2:
                return Raw(heights=np.zeros(taken.nb_grid_pts or 1), format=str(reader.format()))
            points, room = math.prod(taken.nb_grid_pts), path.stat().st_size
            if points > min(MOST_POINTS, BLOCK + POINTS_A_BYTE * room):
                raise ValueError(f"{points} points in {room} bytes, which is more than can be there")
            sizes = None
            if taken.physical_sizes is None:
                # Only to get at the heights: the pixel used is the study's, or there is an error
                sizes = tuple(n * p for n, p in zip(taken.nb_grid_pts, given or (1.0, 1.0), strict=True))
            topography = taken.topography(physical_sizes=sizes)
            heights = topography.heights()
            if reader.format() == "asc" and min(heights.shape) == 3:
                # the reader takes an incomplete list of points for a matrix of three columns
                raise ValueError("a list of points x y z that is no complete regular grid")
            unit = topography.unit if isinstance(topography.unit, str) else None
            pixel = tuple(float(p) for p in topography.pixel_size) if sizes is None else None
            return Raw(heights, str(reader.format()), pixel, lateral_unit=unit, height_unit=unit)
    except ImportError as error:
        raise _needs_package(path) from error
    except Exception as error:  # the reader is foreign: whatever it raises is a bad file
        raise refusal(path, f"cannot be read as a surface ({_first_line(error)})") from error


def _first_line(error: Exception) -> str:
    """Return the beginning of what a foreign reader says, to stand in brackets."""
    text = str(error).strip() or type(error).__name__
    return text.splitlines()[0].strip().rstrip(".:")[:120]
