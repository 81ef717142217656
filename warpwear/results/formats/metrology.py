"""Write worn bodies as files of metrology: .sdf (ISO 25178-71) and .x3p (ISO 5436-2, ISO 25178-72)."""

import hashlib
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError, printable
from warpwear.results.formats.bodies import ExportedBody
from warpwear.results.formats.forms import filled
from warpwear.version import __version__

sdfio = lazy.module("sdfio")

#: Metres of a millimetre: the unit of both formats.
METRES = 1.0e-3
#: Names in the archive of a .x3p file.
MAIN, SUMS, POINTS, VALID = "main.xml", "md5checksum.hex", "bindata/data.bin", "bindata/valid.bin"


def _spacing(body: ExportedBody) -> tuple[float, float]:
    """Return the distances of the points along x and y [m]. Raises InputError where they are no numbers."""
    x, y = ((side[-1] - side[0]) / max(side.size - 1, 1) * METRES for side in (body.x, body.y))
    if not np.isfinite([x, y]).all():
        raise InputError(f"{body.title}: the places of its cells are no numbers; the result is damaged.")
    return float(x), float(y)


def write_sdf(path: Path, body: ExportedBody) -> None:
    """Write the heights of a body as ASCII .sdf; a profile of the file runs along the sliding direction."""
    x, y = _spacing(body)
    metadata = sdfio.Metadata(revision=sdfio.Revision.ISO_1_0, manufacturer_id="warpwear")
    data = METRES * body.heights.T
    with path.open("wb") as file:
        sdfio.write(file, data, x_scale=x, y_scale=y, format=sdfio.FileFormat.ASCII, metadata=metadata)


def write_x3p(path: Path, body: ExportedBody) -> None:
    """Write the heights of a body as .x3p: float64 in metres, x along the sliding direction and fastest.

    Points that are not there are NaN, and marked in the archive's list of valid points. Offsets of the axes
    are the place of the first point from the middle of the contact.
    """
    heights = METRES * body.heights.T
    known = np.isfinite(heights)
    parts = {POINTS: np.where(known, heights, np.nan).astype("<f8").tobytes()}
    if not known.all():
        parts[VALID] = np.packbits(known.ravel(), bitorder="little").tobytes()
    main = _main_xml(body, {name: _md5(content) for name, content in parts.items()})
    parts = {MAIN: main, SUMS: f"{_md5(main)} *{MAIN}\n".encode(), **parts}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)


def _md5(content: bytes) -> str:
    return hashlib.md5(content, usedforsecurity=False).hexdigest()


def _main_xml(body: ExportedBody, sums: dict[str, str]) -> bytes:
    """Describe a .x3p file in the order of its schema. sums: MD5 by name of the binary parts."""
    firsts = (METRES * float(side[0]) for side in (body.x, body.y))
    content: Any = {"body": body, "version": __version__, "sums": sums}
    content |= {"points": POINTS, "valid": VALID, "checksums": SUMS}
    main = filled(
        "x3p.xml",
        axes=zip(("CX", "CY"), _spacing(body), firsts, strict=True),
        now=datetime.now(UTC).isoformat(timespec="seconds"),
        title=printable(body.title),
        **content,
    )
    return main.encode("utf-8", "backslashreplace")
