"""Files of instruments, written byte by byte."""

import struct
from pathlib import Path

import numpy as np


def opd(path: Path, raster: np.ndarray, *, wavelength: float, multiplier: float | None) -> None:
    """Blocks after a directory of names, types and lengths; points along y first, the last one first.

    wavelength: [nm], to which a raster of multiplier 1 is relative.
    """
    nx, ny = raster.shape
    data = struct.pack("<3H", nx, ny, raster.itemsize) + raster[:, ::-1].tobytes()
    blocks = [
        (b"RAW_DATA", 3, data),
        (b"Wavelength", 7, struct.pack("<f", wavelength)),
        (b"Pixel_size", 7, struct.pack("<f", 0.002)),  # mm
        (b"Aspect", 7, struct.pack("<f", 1.5)),
    ]
    if multiplier is not None:
        blocks.append((b"Mult", 6, struct.pack("<h", round(multiplier))))
    entry = struct.Struct("<16shlH")
    directory = entry.pack(b"Directory", 1, entry.size * (len(blocks) + 1), 0xFFFF)
    directory += b"".join(entry.pack(name, kind, len(content), 0) for name, kind, content in blocks)
    path.write_bytes(b"\x01\x00" + directory + b"".join(content for *_, content in blocks))


def metropro(path: Path, heights: np.ndarray) -> None:
    """A header of 834 bytes, then lines along x of counts. heights [m], shape (nx, ny), NaN if missing."""
    header = bytearray(834)
    fields = {0: (">4s", b"\x88\x1b\x03\x6f"), 4: (">H", 1), 6: (">I", 834), 80: (">82s", b"a disc")}
    fields |= {68: (">H", heights.shape[0]), 70: (">H", heights.shape[1]), 72: (">I", 4 * heights.size)}
    # interferometer's factor, wavelength [m], obliquity, distance of the points [m]; a phase has 32768 parts
    fields |= {164: (">f", 0.5), 168: (">f", 600e-9), 176: (">f", 1.0), 184: (">f", 2e-6), 218: (">h", 1)}
    for at, (form, value) in fields.items():
        struct.pack_into(form, header, at, value)
    counts = np.where(np.isnan(heights), 2147483640, heights * 32768 / 300e-9).T.round().astype(">i4")
    path.write_bytes(bytes(header) + counts.tobytes())
