"""Files of instruments, written byte by byte, and profiles to write."""

import io
import struct
import zipfile
from pathlib import Path

import numpy as np

from warpwear.grid import FloatArray
from warpwear.surfaces.profiles.profile import Profile

MAIN = """<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">
<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>PRF</FeatureType><Axes>
<CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{step}</Increment><Offset>0</Offset></CX>
<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>1</Increment><Offset>0</Offset></CY>
<CZ><AxisType>A</AxisType><DataType>{kind}</DataType>{scale}<Offset>0</Offset></CZ></Axes></Record1>
<Record3><MatrixDimension><SizeX>{count}</SizeX><SizeY>1</SizeY><SizeZ>1</SizeZ></MatrixDimension>
<DataLink><PointDataLink>bindata/data.bin</PointDataLink>{valid}</DataLink></Record3></p:ISO5436_2>
"""


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


def rough(rng: np.random.Generator, count: int, spacing: float, *, hurst: float, roll_off: float, rq: float):
    """Return a Gaussian profile [mm], self-affine from 8 µm to a wavelength [mm]; its ends do not meet."""
    frequency = np.fft.rfftfreq(4 * count, spacing)
    density = np.maximum(frequency, 1.0 / roll_off) ** (-1.0 - 2.0 * hurst)
    density[(frequency > 1.0 / 0.008) | (frequency == 0.0)] = 0.0
    waves = rng.normal(size=frequency.size) + 1j * rng.normal(size=frequency.size)
    heights = np.fft.irfft(np.sqrt(density) * waves, 4 * count)
    return rq * heights[:count] / heights.std()


def profile(heights: FloatArray, spacing: float) -> Profile:
    """Return a profile that is from no file."""
    return Profile(spacing, np.asarray(heights, dtype=np.float64), {"file": "made", "notes": []})


def prf(heights: FloatArray, spacing: float) -> str:
    """Return a .prf of heights [mm], in steps of 1 pm."""
    lines = [
        *("1 2", "SG2004 0.000000e+000 PRF", f"CX M {heights.size:e} MM 1.000000e+000 D"),
        *(f"CZ M {heights.size:e} MM 1.000000e-009 L", "EOR", "STYLUS_RADIUS 2.000000e-003 MM"),
        *(f"SPACING CX {spacing:e}", "COMMENT a profile", "EOR"),
        *(f"{1e9 * z:.0f}" for z in heights),
        *("EOR", "EOF"),
    ]
    return "\r\n".join(lines) + "\r\n"


def x3p(
    path: Path, heights: FloatArray, spacing: float, *, kind: str = "D", missing: int | None = None
) -> None:
    """Write heights [mm] as a profile in an .x3p, as floats or, kind I, in steps of 1 nm."""
    values = (1e-3 * heights).astype("<f8") if kind == "D" else np.rint(1e6 * heights).astype("<i2")
    valid, link = np.ones(heights.size, np.uint8), ""
    if missing is not None:
        valid[missing], link = 0, "<ValidPointsLink>bindata/valid.bin</ValidPointsLink>"
    scale = "" if kind == "D" else "<Increment>1e-9</Increment>"
    main = MAIN.format(step=1e-3 * spacing, kind=kind, scale=scale, count=heights.size, valid=link)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("main.xml", main)
        archive.writestr("bindata/data.bin", values.tobytes())
        if link:
            archive.writestr("bindata/valid.bin", np.packbits(valid, bitorder="little").tobytes())
    path.write_bytes(buffer.getvalue())


def sdf(heights: FloatArray, spacing: float, *, name: str = "aISO-1.0") -> str:
    """Return an .sdf of text with one line of heights [mm]."""
    head = {"ManufacID": "test", "CreateDate": "010120261200", "ModDate": "010120261200"}
    head |= {"NumPoints": heights.size, "NumProfiles": 1, "Xscale": 1e-3 * spacing, "Yscale": 1e-6}
    head |= {"Zscale": 1e-6, "Zresolution": -1, "Compression": 0, "DataType": 7, "CheckType": 0}
    lines = [name, *(f"{key} = {value}" for key, value in head.items()), "*"]
    return "\n".join([*lines, " ".join(f"{1e3 * z:.6f}" for z in heights), "*", "*"]) + "\n"
