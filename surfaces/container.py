"""Containers of contact.engineering: a .zip of measurements, of which one is taken out and read."""

import gzip
import hashlib
import re
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from warpwear import lazy
from warpwear.errors import InputError

containers = lazy.module("SurfaceTopography.Container.IO")

#: Files of a container that list what is in it: the second is read where the first is not there.
YAML = "meta.yml"
LISTS = ("index.json", YAML)
#: Keys of YAML that copy others: a few lines of them can fill any memory, and no container needs them.
MERGES = re.compile(rb"(?:^|[\s{,])<<['\"]?\s*:")
#: Names of a measurement's file in the list: as it was uploaded, and as the database keeps it, levelled.
ORIGINAL, SQUEEZED = "original", "squeezed-netcdf"
MOST_NAMED = 12  # of several, in a sentence
MOST_LIST = 2**24  # bytes of such a list
MOST_MEMBER = 2**32  # bytes of a measurement
#: Bytes that may come of one byte that is packed: heights give a few, zeros a thousand.
EXPANSION = 40
LEAST_UNPACKED = 2**24  # bytes that may come of any file, as of a small one of a surface that is flat
BLOCK = 2**20  # bytes that are unpacked together
#: The description in a .x3p, and its elements for a part's name and for the MD5 of this part.
X3P = "main.xml"
X3P_SUMS = (("PointDataLink", "MD5ChecksumPointData"), ("ValidPointsLink", "MD5ChecksumValidPoints"))


@dataclass(frozen=True)
class Member:
    """Describes a measurement that a container lists.

    label: its name, with that of its surface where there are several; about: what the list says of it.
    """

    number: int
    label: str
    about: dict[str, Any]

    @property
    def is_map(self) -> bool:
        """Return whether it is areal: a line scan has one size."""
        sizes = self.about.get("size")
        return not isinstance(sizes, list | tuple) or len(sizes) == 2

    @property
    def files(self) -> list[tuple[str, str]]:
        """Return which of its files are there, the original first: kind and name."""
        named = dict(self.about.get("datafile") or {})
        return [(kind, named[kind]) for kind in (ORIGINAL, SQUEEZED) if isinstance(named.get(kind), str)]


def is_container(path: Path) -> bool:
    """Return whether a file is a .zip with a list of measurements."""
    try:
        with zipfile.ZipFile(path) as archive:
            return any(name in archive.namelist() for name in LISTS)
    except (OSError, ValueError, zipfile.BadZipFile):
        return False


def most_unpacked(path: Path) -> int:
    """Return how many bytes may come of a packed file, or of one part of it."""
    return min(MOST_MEMBER, max(LEAST_UNPACKED, EXPANSION * path.stat().st_size))


def check_archive(path: Path) -> None:
    """Raise ValueError where a part of a .zip would be too large, or has not the MD5 that a .x3p states."""
    with zipfile.ZipFile(path) as archive:
        for part in archive.infolist():
            if part.file_size > most_unpacked(path):
                raise ValueError(
                    f"{part.file_size} bytes of {part.filename} in {path.stat().st_size} of a .zip"
                )
        place = x3p_main(archive)
        if place is None or archive.getinfo(place).file_size > MOST_LIST:
            return
        description = archive.read(place).decode("utf-8", errors="replace")
        for link, element in X3P_SUMS:
            parts = (re.search(rf"<(?:\w+:)?{tag}>\s*([^<]*?)\s*<", description) for tag in (link, element))
            name, stated = parts
            if name is None or stated is None or not stated[1].strip("0"):  # no MD5 is none
                continue
            content = archive.read(place.removesuffix(X3P) + name[1])
            digest = hashlib.md5(content, usedforsecurity=False).hexdigest()
            if digest != stated[1].lower():
                raise ValueError(f"its part {name[1]} is damaged, its MD5 is not the one that {X3P} states")


def x3p_main(archive: zipfile.ZipFile) -> str | None:
    """Return the name of the description in a .x3p, which may lie in a folder; None where there is none."""
    return next((name for name in archive.namelist() if name.rpartition("/")[2] == X3P), None)


def members_of(path: Path) -> list[Member]:
    """Return the measurements that a container lists.

    Raises ImportError without SurfaceTopography, and whatever its reader does for a list that is wrong.
    """
    with zipfile.ZipFile(path) as archive:
        lists = [name for name in LISTS if name in archive.namelist()]
        for name in lists:
            if archive.getinfo(name).file_size > MOST_LIST:
                raise ValueError(f"its list {name} has more than {MOST_LIST} bytes")
        if lists == [YAML] and MERGES.search(archive.read(YAML)):
            raise ValueError(f"its list {YAML} has merge keys, which may grow without end")
    reader = containers.CEReader(str(path))
    surfaces = [reader.container(number).info for number in range(reader.nb_containers)]
    members: list[Member] = []
    for surface in surfaces:
        for about in surface["topographies"]:
            label = _name(about, f"measurement {len(members)}")
            if len(surfaces) > 1:
                label = f"{_name(surface, 'surface')}/{label}"
            members.append(Member(len(members), label, dict(about)))
    return members


def _name(about: Any, otherwise: str) -> str:
    name = about.get("name")
    return name if isinstance(name, str) and name else otherwise


def choose(path: Path, members: list[Member], name: str | None, kind: str = "measurement") -> Member:
    """Return the measurement, channel or column that has this name or number; without one the only map.

    Raises InputError, naming ``disc.array``, where there is not one such.
    """
    maps = [member for member in members if member.is_map]
    fitting = maps
    if name is not None:
        fitting = [m for m in maps if m.label == name] or [m for m in maps if str(m.number) == name.strip()]
    if len(fitting) == 1:
        return fitting[0]
    if not maps:
        raise InputError(f"disc.surface '{path}' holds no areal measurement, only line scans or nothing")
    what = f"several {kind}s"
    if name is not None:
        what = f"{len(fitting) or 'no'} {kind}{'s' if fitting else ''} {name!r}"
    listed = ", ".join(f"{member.number} ({member.label})" for member in maps[:MOST_NAMED])
    if len(maps) > MOST_NAMED:
        listed += f" and {len(maps) - MOST_NAMED} more"
    raise InputError(f"disc.surface '{path}' holds {what}: disc.array gives a number or a name of: {listed}")


@contextmanager
def unpacked(path: Path, name: str | None = None) -> Iterator[Path]:
    """Unpack a .gz, or a file of a .zip, for as long as it is read. Raises ValueError for one too large."""
    most, size = most_unpacked(path), 0
    with ExitStack() as stack:
        if name is None:
            packed: IO[bytes] | gzip.GzipFile = stack.enter_context(gzip.open(path))
        else:
            packed = stack.enter_context(stack.enter_context(zipfile.ZipFile(path)).open(name))
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="warpwear-"))
        out = Path(folder) / f"member{Path(name or path.stem).suffix[:10]}"
        with out.open("wb") as file:
            while block := packed.read(BLOCK):
                size += len(block)
                if size > most:
                    packing = ".gz" if name is None else ".zip"
                    raise ValueError(f"more than {most} bytes in {path.stat().st_size} of a {packing}")
                file.write(block)
        yield out
