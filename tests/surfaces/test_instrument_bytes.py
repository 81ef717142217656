"""Files of instruments that cannot be had freely, built here byte by byte: Wyko's .opd, Sensofar's .plu."""

import struct
from pathlib import Path

import numpy as np
import pytest

from warpwear.surfaces.reading import read

pytest.importorskip("SurfaceTopography")

#: Heights along x and y [µm], without a symmetry that would hide a wrong axis; one point is missing.
HEIGHTS = np.round(np.random.default_rng(4).normal(size=(5, 7)), 2)
HEIGHTS[1, 2] = np.nan


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


def test_opd_of_integers(tmp_path: Path) -> None:
    """Heights in parts of a wavelength: 600 nm over 6000, so 0.1 nm each."""
    raster = np.where(np.isnan(HEIGHTS), 32767, 1e4 * HEIGHTS).round().astype("<i2")
    opd(tmp_path / "disc.opd", raster, wavelength=600.0, multiplier=6000.0)
    reading = read(tmp_path / "disc.opd")
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, rtol=1e-6, atol=1e-12)
    assert reading.pixel == pytest.approx((0.002, 0.003))
    assert not reading.pixel_given
    assert not reading.unit_given


def test_opd_of_floats(tmp_path: Path) -> None:
    raster = np.where(np.isnan(HEIGHTS), 1e38, HEIGHTS / 0.6).astype("<f4")
    opd(tmp_path / "disc.opd", raster, wavelength=600.0, multiplier=None)
    np.testing.assert_allclose(read(tmp_path / "disc.opd").heights, 1e-3 * HEIGHTS, rtol=1e-6)


def test_plu(tmp_path: Path) -> None:
    """One layer of a confocal topography, lines along x, in µm; an image in colour behind it."""
    nx, ny = HEIGHTS.shape
    header = b"Mon Mar 02 10:11:12 2020".ljust(128, b"\0") + struct.pack("<I", 0) + b"disc".ljust(256, b"\0")
    calibration = struct.pack("<3I7f", ny, nx, 1, 1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0)
    topography = struct.pack("<5I", 3, 0, 0, 5, 0)
    scan = struct.pack("<5IdfII", nx, ny, nx, ny, 0, 0.1, 1.0, 1, 0)
    layers = struct.pack("<5B3xI", 0, 1, 0xFB, 9, 1, 1)
    raster = np.where(np.isnan(HEIGHTS), 1000001.0, HEIGHTS).T.astype("<f4")
    layer = struct.pack("<2I", ny, nx) + raster.tobytes() + struct.pack("<2f", -3.0, 3.0) + bytes(3 * nx * ny)
    (tmp_path / "disc.plu").write_bytes(header + calibration + topography + scan + layers + layer)
    reading = read(tmp_path / "disc.plu")
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, rtol=1e-6)
    assert reading.pixel == pytest.approx((0.002, 0.003))
    assert not reading.unit_given
