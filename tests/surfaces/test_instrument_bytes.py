"""Files of instruments that cannot be had freely, built byte by byte: .opd of Wyko, .plu of Sensofar, .dat of
Zygo. Which way is up in them, and in the maps, beside the instrument's own picture.
"""

import hashlib
import re
import struct
import zipfile
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from cases_instruments import MAIN, metropro, opd

from warpwear.errors import InputError
from warpwear.figures.paint_map import paint_map
from warpwear.measured.surface_figure import _map_of_heights
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.reading import read

pytest.importorskip("SurfaceTopography")

REAL = Path(__file__).resolve().parents[3] / "shared" / "surfaces"

#: Heights along x and y [µm], without a symmetry that would hide a wrong axis; one point is missing.
HEIGHTS = np.round(np.random.default_rng(4).normal(size=(5, 7)), 2)
HEIGHTS[1, 2] = np.nan


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


def test_x3p_whose_points_are_damaged(tmp_path: Path) -> None:
    """Its description gives the MD5 of the points; one of zeros, or none, is not compared."""
    path, whole = tmp_path / "disc.x3p", tmp_path / "whole.x3p"
    heights = np.where(np.isnan(HEIGHTS), 0.0, HEIGHTS) * 1e-6
    sizes = (5e-6, 7e-6)
    surface = pytest.importorskip("SurfaceTopography").Topography(heights, sizes, unit="m")
    surface.to_x3p(str(whole))
    with zipfile.ZipFile(whole) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    points = next(name for name in parts if name.endswith("data.bin"))
    digest = hashlib.md5(parts[points]).hexdigest().encode()
    description = re.sub(rb"(<\w*:?MD5ChecksumPointData>)[^<]*", rb"\g<1>" + digest, parts["main.xml"])
    assert digest in description
    damaged = bytearray(parts[points])
    damaged[13] ^= 64
    for text, content, is_read in (
        (description, parts[points], True),
        (description, bytes(damaged), False),
        (description.replace(digest, b"0" * 32), bytes(damaged), True),
    ):
        with zipfile.ZipFile(path, "w") as archive:
            for name, part in (parts | {"main.xml": text, points: content}).items():
                archive.writestr(name, part)
        if is_read:
            read(path)
            continue
        with pytest.raises(InputError, match=r"data\.bin is damaged, its MD5 is not the one"):
            read(path)


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


@pytest.mark.parametrize("missing", [0, 34, 60])
@pytest.mark.parametrize("name", ["disc.dat", "disc.xyz", "disc.txt", "DISC", "disc.sur"])
def test_metropro_is_known_by_its_content(tmp_path: Path, missing: int, name: str) -> None:
    """Much of it may look like text with zeros: letters, and bytes 0x7f 0xff for what is missing."""
    rough = np.random.default_rng(4).normal(size=(70, 90)) * 1e-7
    rough[:, :missing] = np.nan
    metropro(tmp_path / name, rough)
    reading = read(tmp_path / name)
    assert reading.format == "metropro"
    assert reading.pixel == pytest.approx((0.002, 0.002))
    np.testing.assert_allclose(reading.heights, 1e3 * rough, atol=1e-8)


@pytest.mark.parametrize("name", ["disc.sur", "disc.txt", "DISC", "disc.h5"])
def test_arrays_and_text_are_known_by_their_content(tmp_path: Path, name: str) -> None:
    given = {"pixel": 1e-3, "height_unit": "um"}
    whole = np.arange(90.0).reshape(9, 10)
    path = tmp_path / name
    for save in (np.save, np.savez, np.savetxt):
        with path.open("wb") as file:
            save(file, whole.T if save is np.savetxt else whole)
        np.testing.assert_allclose(read(path, **given).heights, 1e-3 * whole)


def test_a_map_is_the_instruments_picture_mirrored_top_to_bottom(tmp_path: Path) -> None:
    """Pictures begin with their first line at the top; a map has y = 0 below, as every map of a run has."""
    rough = np.random.default_rng(4).normal(size=(70, 90)) * 1e-7
    metropro(tmp_path / "disc.dat", rough)
    heights = read(tmp_path / "disc.dat").heights
    np.testing.assert_allclose(heights[:, 0], 1e3 * rough[:, 0], atol=1e-8)  # the file's first line: lowest y
    axes = mpl.figure.Figure().add_subplot()
    paint_map(axes, _map_of_heights(heights, (0.14, 0.18), None))
    (image,) = axes.images
    assert image.origin == "lower"
    assert axes.get_xlim()[0] < axes.get_xlim()[1]
    assert axes.get_ylim()[0] < axes.get_ylim()[1]
    np.testing.assert_array_equal(image.get_array()[0], 1e3 * heights[:, 0])  # its lowest row


def test_the_first_line_of_a_real_file_is_that_of_its_picture() -> None:
    """A file of Alicona holds the instrument's own picture, whose light follows the slopes of the surface."""
    path = REAL / "al3d-1.al3d"
    if not path.is_file():
        pytest.skip("the measured files are not here")
    content = path.read_bytes()
    tags = {
        content[at : at + 20].rstrip(b"\0"): content[at + 20 : at + 50] for at in range(17, 17 + 19 * 52, 52)
    }
    start, nx, ny = (int(tags[name].split(b"\0")[0]) for name in (b"TextureImageOffset", b"Cols", b"Rows"))
    picture = (
        np.frombuffer(content, np.uint8, count=3 * nx * ny, offset=start).reshape(3, ny, nx).mean(axis=0)
    )
    picture = without_polynomial(picture, degree=8)
    heights = read(path).heights.T  # a line a y, as the picture
    for axis in (0, 1):
        slopes = without_polynomial(np.gradient(heights, axis=axis), degree=8).ravel()
        turned = (picture, picture[::-1], picture[:, ::-1], picture[::-1, ::-1])
        alike, *others = (abs(np.corrcoef(slopes, one.ravel())[0, 1]) for one in turned)
        assert alike > 0.2
        assert alike > 3.0 * max(others)


@pytest.mark.parametrize("how", ["plain", "dash", "offset", "folder", "text", "integers"])
def test_x3p_as_instruments_write_it(tmp_path: Path, how: str) -> None:
    """A dash in Revision, an empty Offset, a folder on top, heights as text, steps on an incremental axis."""
    heights = np.random.default_rng(0).integers(-900, 900, size=(9, 7))
    main = MAIN.replace("PRF", "SUR").replace("<SizeY>1<", "<SizeY>7<")
    kind = "L" if how == "integers" else "D"
    scale = "<Increment>1e-9</Increment>" if how == "integers" else ""
    main = main.format(step=2e-6, kind=kind, scale=scale, count=9, valid="")
    main = main.replace("<Increment>1</Increment>", "<Increment>3e-6</Increment>")
    data, folder, lost = (1e-9 * heights).T.astype("<f8").tobytes(), "", how == "text"
    if how == "dash":
        main = main.replace("ISO5436 - 2000", "ISO5436 – 2000")
    elif how == "offset":
        main = main.replace("<Offset>0</Offset></CZ>", "<Offset></Offset></CZ>")
    elif how == "folder":
        folder = "scan 7/"
    elif how == "text":
        texts = [f"<Datum>{1e-9 * z:.9e}</Datum>" for z in heights.T.ravel()]
        texts[10] = "<Datum></Datum>"
        start = main.index("<DataLink>")
        main = f"{main[:start]}<DataList>{''.join(texts)}</DataList></Record3></p:ISO5436_2>"
    elif how == "integers":
        main = main.replace("<CZ><AxisType>A", "<CZ><AxisType>I")
        data = heights.T.astype("<i4").tobytes()
    with zipfile.ZipFile(tmp_path / "disc.x3p", "w") as archive:
        archive.writestr(f"{folder}main.xml", main.encode())
        archive.writestr(f"{folder}bindata/data.bin", data)
    found = read(tmp_path / "disc.x3p")
    expected = 1e-6 * heights
    if lost:
        expected[1, 1] = np.nan
    np.testing.assert_allclose(found.heights, expected, atol=1e-15)
    assert found.pixel == pytest.approx((2e-3, 3e-3))
