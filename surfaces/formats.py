"""What is in a file of heights, in its own units: arrays of NumPy, containers, text, and instrument formats.

A format stands in one place, `FORMATS`: how it is known, its reader, its endings and its name in sentences.
"""

import math
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError, explained
from warpwear.surfaces import container
from warpwear.surfaces.container import ORIGINAL, Member, check_archive, is_container
from warpwear.surfaces.files import gwyddion, layouts
from warpwear.surfaces.point_cloud import UNIT, gridded, spaced, unit_of, units_in
from warpwear.surfaces.text import NoTable, Table, read_table

h5py = lazy.module("h5py")

NPY, ZIP, GZIP = b"\x93NUMPY", b"PK", b"\x1f\x8b"  # that files of these kinds begin with
UTF16 = (b"\xff\xfe", b"\xfe\xff")
BLOCK = 2**20  # bytes of a file that are looked at together
START = 64  # bytes by which a format may be known
TEXT = (".xyz", ".txt", ".csv", ".asc", ".dat", ".tsv", ".hfm")
CUT = "the file's last line has no end: it may have been cut short, and its last value with it"
GWY_FIELD = re.compile(r"/\d+/data")  # part of a file of Gwyddion with the values of a channel
#: Begins the name of a column of places, in a table of several lines beside each other.
PLACE = re.compile(r"\W*(lateral|distance|position|x)\b", re.IGNORECASE)
#: Points that a file may declare for each of its bytes: packed zeros give 130.
POINTS_A_BYTE = 200
MOST_POINTS = 2**28  # 2 GiB of heights
HEIGHT_NAMES = ("heights", "height", "z", "surface", "topography")  # of the array in a .npz that has several


@dataclass(frozen=True, eq=False)
class Raw:
    """A file holds values in its own units; what it does not say is None."""

    heights: np.ma.MaskedArray | np.ndarray  # of a map with two axes, of a profile with one
    format: str
    pixel: Sequence[float] | None = None  # in the lateral unit
    lateral_unit: str | None = None
    height_unit: str | None = None
    notes: tuple[str, ...] = ()  # what was decided while reading, in sentences
    chosen: bool = False  # whether it is the one of several that was asked for


@dataclass(frozen=True)
class SurfaceFile:
    """A file is read with what the study says of it beside its name."""

    path: Path
    pixel: tuple[float, float] | None = None  # [mm]
    array: str | None = None  # the one to take where there are several
    channel: int | None = None  # of an instrument's file

    @property
    def ending(self) -> str:
        """Return the ending of the file's name, in small letters."""
        return self.path.suffix.lower()

    @cached_property
    def start(self) -> bytes:
        """Return the first bytes of the file."""
        with self.path.open("rb") as file:
            return file.read(START)

    @cached_property
    def is_text(self) -> bool:
        """Return whether the file may be text: it has no byte of value 0, or says that it is UTF-16."""
        with self.path.open("rb") as file:
            return self.start[:2] in UTF16 or all(
                b"\0" not in block for block in iter(lambda: file.read(BLOCK), b"")
            )


@dataclass(frozen=True)
class HeightFormat:
    """A format of heights has a name in sentences, endings, a test whether a file is of it, and a reader."""

    name: str
    endings: tuple[str, ...]
    fits: Callable[[SurfaceFile], bool]
    read: Callable[[SurfaceFile], Raw]


def read_raw(source: SurfaceFile) -> Raw:
    """Read what a file holds in the first of `FORMATS` that it fits.

    The ending decides what its content leaves open. Raises InputError, naming ``disc.surface``, for what
    cannot be read.
    """
    with explained(f"disc.surface '{source.path}' cannot be read"):
        format = next(format for format in FORMATS if format.fits(source))
    with _refused(source.path, f"as {format.endings[0]}"):
        raw = format.read(source)
    if source.array is not None and not raw.chosen:
        what = f"chooses among several, and disc.surface '{source.path}' ({raw.format}) holds one"
        raise InputError(f"disc.array = {source.array!r} {what}: leave it out")
    return raw


def refusal(path: Path, what: str) -> InputError:
    """Return the error for a file that holds no surface. what: the reason, to go on after its name."""
    return InputError(f"disc.surface '{path}' {what}: allowed is what 'warpwear surface --help' lists")


@contextmanager
def _refused(path: Path, what: str) -> Iterator[None]:
    """Take whatever a foreign reader raises as a bad file. what: in which way it cannot be read."""
    try:
        yield
    except InputError:
        raise
    except ImportError as error:
        raise InputError(
            f"disc.surface '{path}' needs SurfaceTopography, which is not installed: allowed without it is "
            '.npy, or run pip install "warpwear[io]"'
        ) from error
    except Exception as error:
        said = str(error).strip() or type(error).__name__
        raise refusal(path, f"cannot be read {what} ({said.splitlines()[0].rstrip(' .:')[:120]})") from error


def _read_npy(source: SurfaceFile) -> Raw:
    with source.path.open("rb") as file:
        array = np.load(file, allow_pickle=False)
        if file.read(1):
            raise ValueError("there is more in it than its array")
    return Raw(heights=_real(source.path, array), format="npy")


def _is_npz(source: SurfaceFile) -> bool:
    if source.ending == ".npz" or not source.start.startswith(ZIP):
        return source.ending == ".npz"
    try:
        with zipfile.ZipFile(source.path) as archive:
            return all(name.endswith(".npy") for name in archive.namelist())
    except zipfile.BadZipFile:
        return False


def _read_npz(source: SurfaceFile) -> Raw:
    check_archive(source.path)
    with np.load(source.path, allow_pickle=False) as content:
        names = dict(enumerate(content.files))
        known = [number for number, name in names.items() if name.lower() in HEIGHT_NAMES]
        number, note = _choose(source, names, "array", otherwise=known[0] if len(known) == 1 else None)
        array = content[names[number]]
    return Raw(heights=_real(source.path, array), format="npz", notes=(note,), chosen=True)


def _real(path: Path, array: Any) -> np.ndarray:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise refusal(path, "is not an array of real numbers")
    if array.size == 0:
        raise refusal(path, "is empty")
    return array


def _read_text(source: SurfaceFile, *, otherwise: InputError | None = None) -> Raw:
    """Read points x y z of a grid, or a matrix whose lines follow y.

    otherwise: what an instrument's reader has refused the file for, if it was tried.
    """
    path = source.path
    if source.start.startswith(layouts.WYKO):
        return _read_wyko(source)
    try:
        table = read_table(path)
        values = table.numbers()
    except NoTable:  # an instrument's own format by that name
        if otherwise is None:
            return _read_topography(source)
        raise otherwise from otherwise.__cause__
    except ValueError as error:
        raise refusal(path, f"cannot be read as text ({error})") from error
    notes = () if table.ended else (CUT,)
    lateral, height = units_in(table.header)
    names = table.names()
    if np.isnan(values[:, 2:]).all():  # separators may end rows twice
        values = values[:, :2]
    if names and source.array is not None:
        return _column(source, table, values, names)
    if values.shape[1] == 1:
        return Raw(values[:, 0], "text of one column", None, lateral, height, notes)
    if values.shape[1] == 2:
        try:
            heights, step = spaced(values)
        except ValueError as error:
            raise refusal(path, f"holds two columns that are no profile ({error})") from error
        return Raw(heights, "text of two columns", (step,), lateral, height, notes)
    if sizes := layouts.gwyddion_header(table.header):
        (width, lateral), (length, other), unit = sizes
        if lateral == other:
            pixel = (width / values.shape[1], length / values.shape[0])
            return Raw(values.T, "text", pixel, lateral, unit, notes)
    if table.width == 3 or 3 < table.width <= 7 < values.shape[0]:
        try:
            cloud = gridded(values)
        except ValueError as error:
            if table.width == 3:
                raise refusal(path, f"cannot be read as a list of points x y z ({error})") from error
        else:
            extra = (f"columns after the third ignored, {table.width - 3}",) if table.width > 3 else ()
            return Raw(cloud.heights, "xyz", cloud.pixel, lateral, height, cloud.notes + extra + notes)
    if names:
        return _column(source, table, values, names)
    if table.header:  # sizes and units as SurfaceTopography understands them
        # a header it does not know, or the package is not here: the numbers are read all the same
        with suppress(InputError):
            raw = _read_topography(source, plain=True)
            if raw.heights.shape == values.T.shape:
                return replace(raw, notes=raw.notes + notes)
    return Raw(values.T, "text", None, lateral, height, notes)


def _column(source: SurfaceFile, table: Table, values: np.ndarray, names: list[str]) -> Raw:
    """Return the column of a table that is asked for by its name: a profile over the places in the first."""
    number, note = _choose(source, {at: name for at, name in enumerate(names) if name}, "named column")
    notes = (note,) if table.ended else (note, CUT)
    pixel, heights = None, values[:, number]
    if PLACE.match(names[0]):
        heights, *pixel = spaced(values[:, [0, number]])
    lateral, unit = unit_of(names[0]), unit_of(names[number])
    return Raw(heights, "a column of text", pixel, lateral, unit, notes, chosen=True)


def _choose(
    source: SurfaceFile,
    names: dict[int, str],
    what: str,
    *,
    otherwise: int | None = None,
    others: Iterable[str] = (),
) -> tuple[int, str]:
    """Return the number of what is asked for, by number or name, and a sentence that says what else is there.

    names: by number; otherwise: the one taken where nothing is asked for; others: what cannot be taken.
    """
    number = otherwise
    if number is None or source.array is not None:
        members = [Member(number, name, {}) for number, name in names.items()]
        number = container.choose(source.path, members, source.array, what).number
    beside = [f"{other} ({name})" for other, name in names.items() if other != number]
    listed = ", ".join([*beside, *others])
    return number, f"{what} {number} ({names[number]}) of the file; others: {listed or 'none'}"


def _read_wyko(source: SurfaceFile) -> Raw:
    """Read the first block of heights in text of Wyko."""
    heights, pixel, unit, note = layouts.read_wyko(source.path)
    return Raw(heights, "Wyko ASCII", pixel, "mm" if pixel else None, unit, (note,))


def _read_gwy(source: SurfaceFile) -> Raw:
    """Read a channel of a file of Gwyddion: by itself the first in a unit of length, or without a unit."""
    parts = gwyddion.parts_of(source.path)
    fields = {int(key.split("/")[1]): parts[key] for key in sorted(parts) if GWY_FIELD.fullmatch(key)}
    units = {n: field.get("si_unit_z", {}).get("unitstr") or None for n, field in fields.items()}
    names = {n: parts.get(f"/{n}/data/title", "without a name") for n in fields}
    heights = {n: names[n] for n, unit in units.items() if unit is None or re.fullmatch(UNIT, unit)}
    if not heights:
        raise ValueError("no channel of heights")
    others = (f"{names[n]} in {units[n]}" for n in fields if n not in heights)
    first = min(heights, key=lambda n: (units[n] is None, n))
    number, *notes = _choose(source, heights, "channel", otherwise=first, others=others)
    field, mask = fields[number], parts.get(f"/{number}/mask")
    shape = (field["yres"], field["xres"])
    values = field["data"].reshape(shape).T
    if mask is not None:
        masked = mask["data"].reshape(shape).T > 0.5
        values = np.ma.masked_array(values, masked)
        notes.append(
            f"{masked.sum()} points under the file's mask taken as missing: it may mark grains as well"
        )
    pixel = [abs(field.get(f"{x}real", 1.0)) / field[f"{x}res"] for x in "xy"]
    lateral = field.get("si_unit_xy", {}).get("unitstr") or None
    return Raw(values, "gwy", pixel, lateral, units[number], tuple(notes), chosen=True)


def _read_prf(source: SurfaceFile) -> Raw:
    """Read a .prf of text, which a stylus instrument's program exports."""
    heights, step = layouts.read_prf(source.path)
    return Raw(heights, "prf", (step,), "mm", "mm")


def _read_x3p(source: SurfaceFile) -> Raw:
    """Read the profile in an .x3p, or the map."""
    check_archive(source.path)
    heights, steps = layouts.read_x3p(source.path)
    return Raw(heights, "x3p", steps, "m", "m")


def _read_packed(source: SurfaceFile) -> Raw:
    """Read any of these that gzip has packed."""
    with container.unpacked(source.path) as file:
        if SurfaceFile(file).start.startswith(GZIP):
            raise ValueError("a packed file in a packed one")
        try:
            return read_raw(replace(source, path=file))
        except InputError as error:
            raise InputError(str(error).replace(str(file), str(source.path))) from error


def _check_hdf5(path: Path) -> None:
    """Refuse HDF5 that takes values from other files, and a result of warpwear, which is no measurement."""
    with _refused(path, "as HDF5"):
        away, is_result = layouts.looked_into(path)
    if away is not None:
        raise InputError(f"disc.surface '{path}' takes '{away}' from another file, which is not followed")
    if is_result:
        raise refusal(path, "is a result of warpwear; 'warpwear export' writes its worn surfaces")


def _read_container(source: SurfaceFile) -> Raw:
    """Read one measurement of a container; what its file leaves open the container's list may say."""
    path = source.path
    with _refused(path, "as a container"):
        members = container.members_of(path)
    member = container.choose(path, members, source.array)
    refused = refusal(path, f"lists no file of {member.label!r}")
    for kind, name in member.files:
        try:
            with _refused(path, f"at {name!r}"), container.unpacked(path, name) as file:
                if is_container(file):
                    raise ValueError("a container in a container")
                try:
                    raw = read_raw(SurfaceFile(file, source.pixel, channel=member.about.get("data_source")))
                except InputError as error:
                    raise InputError(str(error).replace(str(file), f"{path}: {name}")) from error
                return _as_listed(raw, member, kind)
        except InputError as error:
            refused = error
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
        chosen=True,
    )


def _read_instrument(source: SurfaceFile) -> Raw:
    """Read a height map that SurfaceTopography knows, or the numbers of a text that it does not."""
    try:
        return _read_topography(source)
    except InputError as error:
        if not source.is_text and source.ending not in TEXT:
            raise
        return _read_text(source, otherwise=error)


def _read_topography(source: SurfaceFile, *, plain: bool = False) -> Raw:
    """Read the channel of heights that SurfaceTopography takes, or the one of a number.

    plain: whether its readers of text are asked, too.
    """
    path = source.path
    if h5py.is_hdf5(path):
        _check_hdf5(path)
    if source.start.startswith(ZIP):
        with _refused(path, "as an archive"):
            check_archive(path)
    with _refused(path, "as a surface"), layouts.open_topography(path, plain=plain) as reader:
        name, heights_of = str(reader.format()), layouts.channels_of_heights(reader)
        number, names = source.channel, {index: one.name for index, one in heights_of.items()}
        notes: tuple[str, ...] = ()
        if number is None:
            others = (one.name for one in reader.channels if one.index not in names)
            otherwise = reader.default_channel.index
            otherwise = otherwise if otherwise in names else min(names)
            number, note = _choose(source, names, "channel", otherwise=otherwise, others=others)
            if len(reader.channels) > 1 or not names[number].lower().startswith(("channel", "default")):
                notes = (note,)
        if number not in names:
            raise ValueError(f"no channel of heights number {number}")
        channel = heights_of[number]
        shape, room = channel.nb_grid_pts, path.stat().st_size
        if math.prod(shape) > min(MOST_POINTS, BLOCK + POINTS_A_BYTE * room):
            raise ValueError(f"{math.prod(shape)} points in {room} bytes, which is more than can be there")
        sizes = None
        if channel.physical_sizes is None:
            # Only to get at the heights: the pixel used is the study's, or there is an error
            sizes = tuple(n * p for n, p in zip(shape, source.pixel or (1.0, 1.0), strict=False))
        topography = channel.topography(physical_sizes=sizes)
        heights = topography.heights()
        if name == "asc" and min(heights.shape) == 3:
            # the reader takes an incomplete list of points for a matrix of three columns
            raise ValueError("a list of points x y z that is no complete regular grid")
        unit = topography.unit if isinstance(topography.unit, str) else None
        if channel.dim == 1:
            places = np.ravel(topography.positions())
            heights, *steps = spaced(np.column_stack([places, np.ma.filled(heights, np.nan)]))
        else:
            steps = topography.pixel_size
        pixel = tuple(float(p) for p in steps) if sizes is None else None
        return Raw(heights, name, pixel, unit, unit, notes, chosen=len(reader.channels) > 1)


#: What can be read, in the order in which it is tried; the last takes all that no other one knows.
FORMATS = (
    HeightFormat("an array", (".npy",), lambda s: s.start.startswith(NPY) or s.ending == ".npy", _read_npy),
    HeightFormat("an archive of arrays", (".npz",), _is_npz, _read_npz),
    HeightFormat(
        "a container of contact.engineering",
        (".zip",),
        lambda s: s.start.startswith(ZIP) and is_container(s.path),
        _read_container,
    ),
    HeightFormat("a packed one of these", (".gz",), lambda s: s.start.startswith(GZIP), _read_packed),
    HeightFormat("a file of Gwyddion", (".gwy",), lambda s: s.start.startswith(gwyddion.GWY), _read_gwy),
    HeightFormat("a profile", (".prf",), lambda s: s.start.split(b"\n")[0].strip() == layouts.PRF, _read_prf),
    HeightFormat("an archive of ISO 25178-72", (".x3p",), lambda s: s.ending == ".x3p", _read_x3p),
    HeightFormat(
        "text of points x y z or of a matrix", TEXT, lambda s: s.is_text and s.ending in TEXT, _read_text
    ),
    HeightFormat(
        "any height map or profile that SurfaceTopography reads",
        (".al3d", ".sur", ".opd", ".plu", ".mnt", ".sdf", ".tmd"),
        lambda s: True,
        _read_instrument,
    ),
)
