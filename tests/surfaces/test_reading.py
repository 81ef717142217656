"""Files as they are: formats, units, overrides, and every way a file can be wrong."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from fuzzing import watched

from warpwear.cli.surface import surface
from warpwear.errors import InputError
from warpwear.surfaces import formats
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.reading import read

REAL = Path(__file__).resolve().parents[3] / "shared" / "surfaces"
HEIGHTS = np.random.default_rng(0).normal(size=(20, 30))


@pytest.fixture
def save(tmp_path):
    def write(array, name="disc.npy"):
        np.save(tmp_path / name, array)
        return tmp_path / name

    return write


@pytest.fixture
def export(tmp_path):
    """Write an instrument-like file with sizes and unit in it."""
    topography = pytest.importorskip("SurfaceTopography").Topography

    def write(sizes, unit):
        path = tmp_path / "disc.nc"
        topography(HEIGHTS, sizes, unit=unit).to_netcdf(str(path))
        return path

    return write


@pytest.mark.parametrize(
    ("name", "grid", "pixel", "sq", "missing_percent"),
    [
        ("al3d-1.al3d", [200, 296], [0.438, 0.438], 0.290, 0.0),
        ("sur-2.sur", [563, 484], [3.484, 3.484], 0.0171, 0.04),
        ("x3p-2.x3p", [650, 650], [0.1277, 0.3146], 0.0772, 0.0),
    ],
)
def test_real_instrument_files(name, grid, pixel, sq, missing_percent):
    pytest.importorskip("SurfaceTopography")
    if not (REAL / name).is_file():
        pytest.skip("the measured files are not here")
    record = read_measured(REAL / name).record()
    assert record["format"] == name.split(".")[1]
    assert record["file_grid"] == grid
    assert record["file_pixel_um"] == pytest.approx(pixel, rel=5e-4)
    assert record["sq_um"] == pytest.approx(sq, rel=5e-3)
    assert record["missing_percent"] == pytest.approx(missing_percent, abs=0.005)
    assert record["pixel_from"] == record["unit_from"] == "file"


def test_a_real_file_sampled_to_its_edges():
    pytest.importorskip("SurfaceTopography")
    if not (REAL / "sur-2.sur").is_file():
        pytest.skip("the measured files are not here")
    surface = read_measured(REAL / "sur-2.sur")
    x, y = (np.linspace(-side / 2, side / 2, 500) for side in surface.size)
    found = surface.heights(x, y)
    assert found.std() * 1e3 == pytest.approx(surface.record()["sq_um"], rel=0.15)
    assert found.mean() == pytest.approx(0.0, abs=1e-6)


def test_file_with_unit_is_converted(export):
    reading = read(export((40.0, 90.0), "um"))
    np.testing.assert_allclose(reading.heights, HEIGHTS * 1e-3, rtol=1e-12)
    assert reading.pixel == pytest.approx((0.002, 0.003))
    assert not reading.pixel_given
    assert not reading.unit_given


def test_study_overrides_the_file(export):
    reading = read(export((40.0, 90.0), "um"), pixel=(0.004, 0.005), height_unit="nm")
    np.testing.assert_allclose(reading.heights, HEIGHTS * 1e-6, rtol=1e-12)
    assert reading.pixel == (0.004, 0.005)
    assert reading.pixel_given
    assert reading.unit_given


@pytest.mark.parametrize(
    ("unit", "factor"), [("m", 1e3), ("mm", 1.0), ("µm", 1e-3), ("μm", 1e-3), ("nm", 1e-6)]
)
def test_units_of_npy(save, unit, factor):
    reading = read(save(HEIGHTS), pixel=0.001, height_unit=unit)
    np.testing.assert_allclose(reading.heights, HEIGHTS * factor, rtol=1e-15)


def test_integers_are_heights_too(save):
    reading = read(save(np.arange(12, dtype=np.int16).reshape(3, 4)), pixel=0.001, height_unit="mm")
    assert np.array_equal(reading.heights, np.arange(12.0).reshape(3, 4))


def test_text_needs_pixel_and_unit(tmp_path):
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "disc.txt"
    np.savetxt(path, HEIGHTS)
    reading = read(path, pixel=0.001, height_unit="um")
    np.testing.assert_allclose(np.sort(reading.heights.ravel()), np.sort(HEIGHTS.ravel()) * 1e-3, rtol=1e-9)
    with pytest.raises(InputError, match=r"disc\.height_unit is not given"):
        read(path, pixel=0.001)
    with pytest.raises(InputError, match=r"disc\.pixel is not given"):
        read(path, height_unit="um")


def test_a_list_of_points_is_gridded_or_refused(tmp_path):
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "disc.xyz"
    points = np.stack(
        [*(0.002 * axis.ravel() for axis in np.indices(HEIGHTS.shape)), HEIGHTS.ravel()], axis=1
    )
    np.savetxt(path, points)
    assert read(path, pixel=0.002, height_unit="um").heights.shape == HEIGHTS.shape
    with pytest.raises(InputError, match=r"disc\.pixel is not given.* 0\.002 × 0\.002 apart, in a unit"):
        read(path, height_unit="um")
    np.savetxt(path, np.delete(points, [7, 100, 333], axis=0))
    assert np.isnan(read(path, pixel=0.002, height_unit="um").heights).sum() == 3
    np.savetxt(path, np.random.default_rng(1).random((500, 3)))
    with pytest.raises(InputError, match=r"disc\.surface .*disc\.xyz.*list of points"):
        read(path, pixel=0.002, height_unit="um")


GIVEN = {"pixel": 0.001, "height_unit": "um"}


@pytest.mark.parametrize(
    ("array", "what"),
    [
        (np.full((4, 4), np.nan), "no valid point"),
        (np.zeros((1, 50)), "line scan"),
        (np.zeros((50, 1)), "line scan"),
        (np.zeros(50), "line scan"),
        (np.zeros((3, 4, 5)), "no map"),
        (np.zeros((0, 4)), "empty"),
        (np.zeros((4, 4), dtype=complex), "not an array of real numbers"),
        (np.array([["a", "b"], ["c", "d"]]), "not an array of real numbers"),
    ],
)
def test_npy_that_is_no_surface(save, array, what):
    with pytest.raises(InputError, match=rf"disc\.surface .*disc\.npy.*{what}"):
        read(save(array), **GIVEN)


def test_npy_is_never_unpickled(tmp_path):
    path = tmp_path / "disc.npy"
    np.save(path, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match=r"disc\.surface .*cannot be read as \.npy"):
        read(path, **GIVEN)


def test_npy_without_pixel_or_unit(save):
    with pytest.raises(InputError, match=r"disc\.pixel is not given.*allowed is"):
        read(save(HEIGHTS), height_unit="um")
    with pytest.raises(InputError, match=r"disc\.height_unit is not given.*allowed is"):
        read(save(HEIGHTS), pixel=0.001)


@pytest.mark.parametrize(
    "pixel", [2.0, 0.5e-7, 0.0, -0.001, float("nan"), float("inf"), (0.001, 2.0), (0.1,) * 3]
)
def test_absurd_pixels_of_the_study(save, pixel):
    with pytest.raises(InputError, match=r"disc\.pixel is .*allowed is.*0\.1 nm to 1 mm"):
        read(save(HEIGHTS), pixel=pixel, height_unit="um")


def test_unknown_unit_of_the_study(save):
    with pytest.raises(InputError, match=r"disc\.height_unit is 'furlong': allowed is one of .*µm"):
        read(save(HEIGHTS), pixel=0.001, height_unit="furlong")


@pytest.mark.parametrize("sizes", [(40.0, 90.0), (1e-9, 1e-9)])
def test_absurd_pixel_of_the_file(export, sizes):
    with pytest.raises(InputError, match=r"disc\.surface .*pixel of .*allowed is.*or give disc\.pixel"):
        read(export(sizes, "m"))


def test_unknown_unit_of_the_file(export):
    with pytest.raises(InputError, match=r"disc\.surface .*unit 'parsec'.*allowed is.*disc\.height_unit"):
        read(export((40.0, 90.0), "parsec"))
    with pytest.raises(InputError, match=r"disc\.height_unit is not given"):
        read(export((40.0, 90.0), None))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("disc.sur", np.random.default_rng(0).bytes(5001)),
        ("disc.sur", np.random.default_rng(0).bytes(5000)),  # 2 × 50² bytes: a map of the Earth to one reader
        ("disc.al3d", b"AliconaImaging\x00\r\n" + bytes(40)),
        ("disc.x3p", b"PK\x03\x04 and no more"),
        ("disc.txt", b"Dear reader,\nthis is a letter.\n"),
        ("disc.npy", b"\x93NUMPY\x01\x00"),
        ("disc.npy", b"not an array"),
    ],
)
def test_files_that_are_no_surface(tmp_path, name, content):
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"disc\.surface .*{name}.*cannot be read.*--help. lists") as caught:
        read(path, **GIVEN)
    assert "\n" not in str(caught.value)
    assert caught.value.__cause__ is not None


def test_a_real_file_cut_short(tmp_path):
    pytest.importorskip("SurfaceTopography")
    if not (REAL / "sur-2.sur").is_file():
        pytest.skip("the measured files are not here")
    path = tmp_path / "half.sur"
    path.write_bytes((REAL / "sur-2.sur").read_bytes()[:500000])
    with pytest.raises(InputError, match=r"disc\.surface .*half\.sur.*cannot be read"):
        read(path)


def test_a_line_scan(tmp_path):
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "line.txt"
    np.savetxt(path, np.stack([np.arange(50.0), HEIGHTS.ravel()[:50]], axis=1))
    with pytest.raises(InputError, match=r"disc\.surface .*line\.txt.*line scan"):
        read(path, **GIVEN)


def test_files_that_are_not_there(tmp_path):
    (tmp_path / "empty.sur").touch()
    os.mkfifo(tmp_path / "pipe.sur")
    for name, what in {
        "none.sur": "does not exist",
        ".": "is not a file",
        "empty.sur": "is empty",
        "pipe.sur": "is not a file",
        300 * "x": "cannot be read: File name too long",
        "a\0b": "cannot be read",
    }.items():
        with watched(), pytest.raises(InputError, match=rf"disc\.surface '.*' {what}") as caught:
            read(tmp_path / name)
        assert "allowed" not in str(caught.value), "no list of formats helps here"


def test_without_surfacetopography_the_message_says_what_to_install(tmp_path, monkeypatch):
    path = tmp_path / "disc.sur"
    path.write_bytes(b"anything")
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(InputError, match=r'disc\.surface .*pip install "warpwear\[io\]"'):
        read(path)


#: Where a file of each format is read, by the first of its endings.
TESTED = {
    ".npy": "tests/surfaces/test_reading.py",
    ".npz": "tests/surfaces/test_reading.py",
    ".zip": "tests/surfaces/files/test_container.py",
    ".gz": "tests/surfaces/files/test_layouts.py",
    ".gwy": "tests/surfaces/files/test_several.py",
    ".prf": "tests/surfaces/profiles/test_profile.py",
    ".x3p": "tests/surfaces/profiles/test_profile.py",
    ".xyz": "tests/surfaces/test_point_cloud.py",
    ".al3d": "tests/surfaces/test_instrument_bytes.py",
}


@pytest.mark.parametrize("format", formats.FORMATS, ids=lambda format: format.endings[0])
def test_a_format_is_tested_and_on_the_page(format):
    root, ending = Path(__file__).parents[2], format.endings[0]
    page = (root / "docs" / "how-to" / "your-disc.md").read_text(encoding="utf-8")
    row = f"| {format.name} | {' '.join(f'`{one}`' for one in format.endings)} |"
    assert row in page, f"docs/how-to/your-disc.md lacks the row of a format: {row}"
    assert ending in CliRunner().invoke(surface, ["--help"]).output, "warpwear surface --help lacks a format"
    assert ending in TESTED, f"no test reads {format.name}: write one, and name its file in TESTED"
    assert (root / TESTED[ending]).is_file()


def test_no_ending_stands_for_two_formats():
    endings = [ending for format in formats.FORMATS for ending in format.endings]
    assert len(endings) == len(set(endings))
    assert formats.FORMATS[-1].fits(formats.SurfaceFile(Path("anything"))), "the last one reads what is left"


def test_a_format_is_added_in_one_place(tmp_path, monkeypatch):
    """Its entry is all that reading goes by."""
    entry = formats.HeightFormat(
        "heights of a test",
        (".test",),
        lambda source: source.start.startswith(b"TEST"),
        lambda source: formats.Raw(HEIGHTS, "test", (1.0, 1.0), "um", "um"),
    )
    monkeypatch.setattr(formats, "FORMATS", (entry, *formats.FORMATS))
    (tmp_path / "disc.dat").write_bytes(b"TEST and more")
    assert read(tmp_path / "disc.dat").format == "test"


def test_many_points_at_an_end_of_the_range_are_told(save):
    """A third at the two extremes had no word; rounded heights have as many there as roughness has."""
    heights = np.random.default_rng(1).normal(size=(120, 120))
    for end, which in ((0.8, "highest"), (-0.8, "lowest")):
        cut = np.minimum(heights, end) if end > 0.0 else np.maximum(heights, end)
        reading = read(save(cut), pixel=0.001, height_unit="um")
        assert f"% of the points hold exactly the {which} height, {end:g} um" in reading.doubts[0]
    clipped = save(np.clip(heights, -1.0, 1.0))
    notices = read_measured(clipped, pixel=0.001, height_unit="um").notices(*2 * [0.001 * np.arange(9)])
    assert sum("end of the instrument's range" in text for text in notices) == 2
    for honest in (heights, np.round(heights, 1), np.where(heights > 0.0, 1.0, 0.0), 0.0 * heights):
        assert not read(save(honest), pixel=0.001, height_unit="um").doubts
