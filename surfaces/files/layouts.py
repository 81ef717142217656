"""Layouts of files of heights that are read here, and checks of what files declare before they are read."""

import itertools
import math
import re
import struct
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.container import X3P, x3p_main
from warpwear.surfaces.point_cloud import UNIT
from warpwear.surfaces.text import lines_of, split

h5py = lazy.module("h5py")

TMD = b"Binary TrueMap Data File v2.0\r\n\0"  # begins a .tmd, some in other letters
TMD_COMMENT = 24  # bytes of the comment behind it that SurfaceTopography expects; any has a 0 at its end
IBW_VERSION = 5  # of an Igor wave whose header is known
IBW_DIMENSIONS = 132  # bytes before the numbers of its points along its four dimensions
#: Formats of SurfaceTopography that are not looked for: those without a mark, for which other files pass (of
#: hgt any 2n² bytes, of nms two small numbers), and what is read here.
NOT_SOUGHT = ("hgt", "npy", "npz")
BCR, ISO = b"BCR-1.0", b"ISO-1.0"  # behind the first letter of an .sdf
BY_ENDING = ("nms",)  # is looked for in files of this ending
#: Its formats of plain text, whose readers take a minute for a few MB of anything else.
PLAIN = ("asc", "xyz")
LENGTH = re.compile(rf"#[^:]+:\s*(\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?)\s*({UNIT})\s*")
NAMED_UNIT = re.compile(rf"#[^:]+:\s*({UNIT})\s*")
WYKO = b"Wyko ASCII Data File Format"  # begins such a file
WYKO_BLOCK, WYKO_LOST = "3", "Bad"  # kind of a block of numbers, and the word for a point that is missing
WYKO_HEIGHTS = ("RAW_DATA", "RAW DATA", "OPD", "SAMPLE_DATA")  # names of blocks of heights
PRF = b"1 2"  # the first line of a .prf
FEATURE = "{*}Record1/{*}FeatureType"
SIZES = "{*}Record3/{*}MatrixDimension/{*}"
LINK = "{*}Record3/{*}DataLink/"
LIST = "{*}Record3/{*}DataList/{*}Datum"
AXES = "{*}Record1/{*}Axes/"
#: Types of an .x3p's values, little endian: 16 and 32 bit integers and floats of 32 and 64 bit.
TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def gwyddion_header(header: Sequence[str]) -> tuple[tuple[float, str], tuple[float, str], str] | None:
    """Return width and height, each with its unit, and the unit of the values of a matrix of Gwyddion.

    Its comments say so in the user's language: width and height in two lines, then the unit alone. None
    where the header has no such lines.
    """
    lengths = [LENGTH.fullmatch(line.strip()) for line in header]
    units = [match for line in header if (match := NAMED_UNIT.fullmatch(line.strip()))]
    for width, height in itertools.pairwise(lengths):
        if width and height and len(units) == 1:
            width_of, height_of = ((float(m[1].replace(",", ".")), m[2]) for m in (width, height))
            return width_of, height_of, units[0][1]
    return None


def looked_into(path: Path) -> tuple[str | None, bool]:
    """Return what in a file of HDF5 is taken from another file, if anything, and whether it is a result."""
    away: list[str] = []

    def look(name: str, item: Any) -> None:
        link = isinstance(item, h5py.ExternalLink)
        if link or (isinstance(item, h5py.Dataset) and (item.is_virtual or item.external)):
            away.append(name)

    with h5py.File(path, "r") as file:
        is_result = "snapshots" in file and "study" in file.attrs
        file.visititems_links(look)
        file.visititems(look)
    return (away[0] if away else None), is_result


def open_topography(path: Path, *, plain: bool) -> Any:
    """Open a file with the first reader of SurfaceTopography that knows it. plain: those of text, too."""
    io = lazy.load("SurfaceTopography").IO  # 2 s, so only when needed
    with path.open("rb") as file:
        start = file.read(io.MAGIC_BUFFER_SIZE)
    content = b""  # where it is not as the file has it
    if start[1:8] == BCR:  # the layout of ISO 25178-71 under its older name
        start = start[:1] + ISO + start[8:]
        content = start + path.read_bytes()[len(start) :]
    elif start[:29].lower() == TMD[:29].lower():
        behind = path.read_bytes()[len(TMD) :].partition(b"\0")[2]
        start = TMD + start[len(TMD) :]
        content = TMD + bytes(TMD_COMMENT) + behind
    known: Exception | None = None
    for reader in io.readers:
        fit, name = reader.can_read(start), reader.format()
        if fit is io.MagicMatch.NO or name in NOT_SOUGHT or (name in PLAIN and not plain):
            continue
        if name in BY_ENDING and path.suffix.lower() != f".{name}":
            continue
        try:
            if name == "ibw":
                check_wave(path)
            return reader(BytesIO(content) if content else str(path))
        except Exception as error:  # the reader is foreign: whatever it raises, another may do
            known = error if fit is io.MagicMatch.YES else known
    raise known or ValueError("no reader knows the format")


def check_wave(path: Path) -> None:
    """Raise ValueError where an Igor wave declares more values than its file has bytes."""
    with path.open("rb") as file:
        start = file.read(IBW_DIMENSIONS + 16)
    if len(start) < IBW_DIMENSIONS + 16:
        return
    order = "<" if struct.unpack_from("<h", start)[0] == IBW_VERSION else ">"
    declared = struct.unpack_from(f"{order}4i", start, IBW_DIMENSIONS)
    if math.prod(max(number, 1) for number in declared) > path.stat().st_size:
        raise ValueError(f"{' × '.join(map(str, declared))} points in {path.stat().st_size} bytes")


def channels_of_heights(reader: Any) -> dict[int, Any]:
    """Return the channels of heights by their numbers. Raises ValueError without any."""
    channels = {c.index: c for c in reader.channels if getattr(c, "is_height_channel", True)}
    if not channels:
        raise ValueError("no channel of heights")
    return channels


def read_wyko(path: Path) -> tuple[FloatArray, tuple[float, float] | None, str | None, str]:
    """Return heights, shape (nx, ny), pixel [mm], unit and what was read of text of Wyko. Raises ValueError.

    Blocks of numbers follow values of single keys. A line has the points along y, the last one first; heights
    are in waves where the second flag says so, and then divided by Mult, which may be left out.
    """
    lines = lines_of(path)
    rows = [split(line.rstrip(), "\t") for line in lines]
    blocks = [at for at, row in enumerate(rows) if len(row) > 2 and row[1] == WYKO_BLOCK]
    start = next((at for at in blocks if rows[at][0] in WYKO_HEIGHTS), None)
    if start is None:
        raise ValueError("no block of heights")
    about = {row[0]: row[-1] for row in rows[:start] if len(row) > 1}
    nx, ny = (int(about.get(f"{axis} Size", 0)) for axis in "XY")
    body = [line.split() for line in lines[start + 1 : start + 1 + nx]]
    if {len(row) for row in body} != {ny} or len(body) != nx:
        raise ValueError(f"its block of heights is not one of {nx} lines of {ny} numbers")
    heights = np.array([[math.nan if word == WYKO_LOST else float(word) for word in row] for row in body])
    pixel = None
    if "Pixel_size" in about:
        pixel = (float(about["Pixel_size"]), float(about["Pixel_size"]) * float(about.get("Aspect", 1.0)))
    in_waves = rows[0][1:2] != ["1"]
    if in_waves:
        heights *= float(about.get("Wavelength", 1.0)) / float(about.get("Mult", 1.0))
    unit = None if in_waves and "Wavelength" not in about else "nm"
    note, others = f"block {rows[start][0]} of the file", [rows[at][0] for at in blocks if at != start]
    return heights[:, ::-1], pixel, unit, f"{note}; others: {', '.join(others)}" if others else note


def read_prf(path: Path) -> tuple[FloatArray, float]:
    """Return heights [mm], shape (n,), and spacing [mm] of a .prf. Raises ValueError.

    Its records are lines of text that end with EOR: axes with number of points, unit and scale, then keys
    such as the spacing, then whole numbers of steps (the softgauges of NPL write it so).
    """
    records = path.read_text(encoding="latin-1").split("EOR")
    if len(records) < 4:
        raise ValueError("it is cut short: fewer than three records that end with EOR")
    lines = {words[0]: words for line in "\n".join(records[:2]).splitlines() if (words := line.split())}
    axis, spacing = lines.get("CZ", []), lines.get("SPACING", [])
    if len(axis) < 5 or len(spacing) < 3 or spacing[1] != "CX":
        raise ValueError("it lacks the scale of its heights, CZ, or SPACING CX")
    if {axis[3], lines.get("CX", axis)[3]} != {"MM"}:
        raise ValueError(f"its unit is {axis[3]!r}: allowed is MM")
    values = np.array([float(word) for word in records[2].split()])
    if values.size != round(float(axis[2])):
        raise ValueError(f"it holds {values.size} heights, and says that there are {axis[2]}")
    return values * float(axis[4]), float(spacing[2])


def read_x3p(path: Path) -> tuple[FloatArray, tuple[float, ...]]:
    """Return heights [m] and distances of the points [m] of an .x3p: of a map (nx, ny), of a profile (n,).

    ISO 25178-72: evenly spaced, with the heights in a file of their own or as text. Raises ValueError,
    KeyError or zipfile.BadZipFile for what is damaged or not so.
    """
    with zipfile.ZipFile(path) as archive:
        place = x3p_main(archive)
        if place is None:
            raise ValueError(f"it has no {X3P}")
        main, folder = ElementTree.fromstring(archive.read(place)), place.removesuffix(X3P)
        sides = ("CX",) if _text(main, FEATURE) == "PRF" else ("CX", "CY")
        if any(_text(main, f"{AXES}{{*}}{axis}/{{*}}AxisType") != "I" for axis in sides):
            raise ValueError("its points are not evenly spaced")
        if link := main.findtext(f"{LINK}{{*}}PointDataLink"):
            kind = TYPES[_text(main, f"{AXES}{{*}}CZ/{{*}}DataType")]
            values = np.frombuffer(archive.read(folder + link.strip()), kind)
        else:
            texts = (one.text or "" for one in main.iterfind(LIST))
            values = np.array([float(text.strip() or "nan") for text in texts])
        mask = main.findtext(f"{LINK}{{*}}ValidPointsLink")
        packed = archive.read(folder + mask.strip()) if mask else b""
    sizes = [int(_text(main, f"{SIZES}Size{axis}")) for axis in "YXZ"]
    if values.size != math.prod(sizes) or sizes[2] != 1:
        raise ValueError(f"it holds {values.size} heights, and says that there are {math.prod(sizes)}")

    def number(axis: str, name: str) -> float:
        return float((main.findtext(f"{AXES}{{*}}{axis}/{{*}}{name}") or "").strip() or "0")

    heights = values * (number("CZ", "Increment") or 1.0) + number("CZ", "Offset")
    if packed:
        valid = np.unpackbits(np.frombuffer(packed, np.uint8), count=values.size, bitorder="little")
        heights = np.where(valid == 1, heights, np.nan)
    heights = heights.reshape(sizes[:2]).T
    return heights[:, 0] if len(sides) == 1 else heights, tuple(number(a, "Increment") or 1.0 for a in sides)


def _text(main: ElementTree.Element, place: str) -> str:
    """Return the text at a place of a main.xml. Raises ValueError where there is none."""
    text = (main.findtext(place) or "").strip()
    if not text:
        raise ValueError(f"its main.xml has no {place.rpartition('}')[2]}")
    return text
