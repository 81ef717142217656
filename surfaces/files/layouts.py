"""Layouts of files of heights that are read here, and checks of what files declare before they are read."""

import itertools
import math
import re
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray
from warpwear.surfaces.point_cloud import UNIT

h5py = lazy.module("h5py")

TMD = b"binary truemap data file v2.0"  # begins a .tmd, in small letters
TMD_START = 32  # bytes before its comment, which a byte of value 0 ends
TMD_SIZES = struct.Struct("<2I4f")  # points along x and y, lengths and offsets of both [mm]
IBW_VERSION = 5  # of an Igor wave whose header is known
IBW_DIMENSIONS = 132  # bytes before the numbers of its points along its four dimensions
LENGTH = re.compile(rf"#[^:]+:\s*(\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?)\s*({UNIT})\s*")
NAMED_UNIT = re.compile(rf"#[^:]+:\s*({UNIT})\s*")


def read_tmd(path: Path) -> tuple[FloatArray, tuple[float, float]]:
    """Return the heights [mm] of a .tmd, shape (nx, ny), and its pixel [mm]. Raises ValueError."""
    content = path.read_bytes()
    end = content.find(b"\0", TMD_START) + 1
    if not end or len(content) < end + TMD_SIZES.size:
        raise ValueError("its header is cut short")
    nx, ny, *sizes = TMD_SIZES.unpack_from(content, end)
    values = content[end + TMD_SIZES.size :]
    if not nx * ny or len(values) != 4 * nx * ny:
        raise ValueError(f"{nx} × {ny} points in {len(values)} bytes")
    heights = np.frombuffer(values, "<f4").reshape(ny, nx).T.astype(np.float64)
    return heights, (sizes[0] / nx, sizes[1] / ny)


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


def channel_of_heights(reader: Any, number: int | None) -> Any:
    """Return the channel of heights that has a number; without one the reader's own choice, or the first."""
    channels = [c for c in reader.channels if getattr(c, "is_height_channel", True)]
    if not channels:
        raise ValueError("no channel of heights")
    index = reader.default_channel.index if number is None else number
    fitting = [c for c in channels if c.index == index]
    if not fitting and number is not None:
        raise ValueError(f"no channel of heights number {number}")
    return (fitting or channels)[0]
